"""A checkpoint belongs to one run: its settings, its environment, and one process at a time."""

import itertools
import json
import os
import resource
import tempfile
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from arkaq_edu.arkaq import Arkaq, Sensing, TrainingSettings, storage, training
from arkaq_edu.experiments import goal
from arkaq_edu.experiments.goal import make_look_around
from arkaq_edu.field import Camera, Kick, Legs
from tests.arkaq.brief import BRIEF, BRIEF_GOAL, GOAL_TASK, brief_agent, digest, near_task


def interrupted(env, step, happens=None):
    """The environment, in which Ctrl-C, or what else happens, comes at the k-th step."""
    go_on, left = env.unwrapped.step, itertools.count(step - 1, -1)

    def count(action):
        if next(left) == 0:
            if happens is None:
                raise KeyboardInterrupt
            happens()
        return go_on(action)

    env.unwrapped.step = count
    return env


@pytest.fixture(autouse=True)
def often(monkeypatch):
    monkeypatch.setattr(storage, "SECONDS_BETWEEN_CHECKPOINTS", -1.0)


@pytest.fixture
def begun(tmp_path):
    """Return the path of a run that was interrupted after so many steps."""

    def interrupt(step, **options):
        path = tmp_path / f"{step}.npz"
        with pytest.raises(KeyboardInterrupt):
            brief_agent(env=interrupted(near_task(**options), step), checkpoint=path)
        return path

    return interrupt


# The environment --------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [60, 300], ids=["segmentation", "Q-learning"])
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"far": 4000.0}, r"another \S*\.far: 1200\.0, not 4000\.0"),
        ({"near": 700.0}, r"another \S*\.near: 600\.0, not 700\.0"),
        ({"placement": "thesis"}, r"another \S*\.placement: 'area', not 'thesis'"),
        ({"patience": 3}, r"another \S*\.patience: 10, not 3"),
        ({"legs": Legs(slide=0.0)}, r"another \S*\.legs\.slide: 0\.07, not 0\.0"),
        ({"camera": Camera(tilt=0.1)}, r"another \S*\.camera\.tilt: 0\.2, not 0\.1"),
        ({"max_episode_steps": 20}, r"another \S*\.max_episode_steps: 150, not 20"),
    ],
)
def test_a_run_in_another_environment_is_refused_and_left_alone(begun, step, options, words):
    path = begun(step)
    before = path.read_bytes()
    agent = Arkaq(0.2, learning=BRIEF, rng=4)
    with pytest.raises(ValueError, match=words) as caught:
        agent.learn(near_task(**options), path, progress=False)
    assert str(path) in str(caught.value)
    assert path.read_bytes() == before and agent.q is None and agent.environments == {}


def test_a_finished_run_is_not_passed_off_as_one_in_another_environment(tmp_path):
    path = tmp_path / "agent.npz"
    brief_agent(checkpoint=path)
    with pytest.raises(ValueError, match=r"far: 1200\.0, not 4000\.0"):
        brief_agent(env=near_task(far=4000.0), checkpoint=path)
    same = near_task(render_mode="rgb_array")  # pictures change nothing
    assert digest(brief_agent(env=same, checkpoint=path)) == digest(Arkaq.load(path))


def test_an_agent_trained_near_the_goal_is_not_taken_up_for_far(tmp_path):
    path = tmp_path / "scorer.npz"
    goal.train(4, 0.06, goal_distance="near", learning=BRIEF_GOAL, checkpoint=path, progress=False)
    with pytest.raises(ValueError, match=r"goal_distance: 1850\.0, not 2300\.0"):
        goal.train(
            4, 0.06, goal_distance="far", learning=BRIEF_GOAL, checkpoint=path, progress=False
        )
    again = goal.train(4, 0.06, learning=BRIEF_GOAL, checkpoint=path, progress=False)
    assert set(again.environments) == {"segmentation", "Q-learning"}
    assert again.environments["segmentation"]["actions"] == "Discrete(2)"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"kick": Kick(spread=0.0)}, r"kick\.spread: 9\.0, not 0\.0"),
        ({"patience": 5}, r"patience: 30, not 5"),
        ({"goal_distance": 1850.5}, r"goal_distance: 1850\.0, not 1850\.5"),
    ],
)
def test_so_are_the_settings_of_the_goal(tmp_path, options, words):
    path = tmp_path / "scorer.npz"
    scorer = Arkaq(0.06, task="goal", learning=BRIEF_GOAL, rng=4)
    scorer.learn(gymnasium.make(GOAL_TASK), path, progress=False)
    with pytest.raises(ValueError, match=words):
        Arkaq(0.06, task="goal", learning=BRIEF_GOAL, rng=4).learn(
            gymnasium.make(GOAL_TASK, **options), path, progress=False
        )


def test_an_agent_in_memory_is_not_taken_up_in_another_environment_either():
    agent = Arkaq(0.2, learning=BRIEF, rng=4)
    with pytest.raises(KeyboardInterrupt):
        agent.learn(interrupted(near_task(), 300), progress=False)
    with pytest.raises(ValueError, match=r"this agent holds .*far: 1200\.0, not 4000\.0"):
        agent.learn(near_task(far=4000.0), progress=False)
    assert digest(agent.learn(near_task(), progress=False)) == digest(brief_agent())


def test_what_has_not_begun_may_begin_elsewhere(tmp_path, monkeypatch):
    monkeypatch.setattr(training, "MISSES_BEFORE_GIVING_UP", 10)
    path = tmp_path / "agent.npz"
    agent = Arkaq(0.2, learning=BRIEF, rng=4)
    blind = near_task(camera=Camera(min_pixels=10_000))
    with pytest.raises(RuntimeError, match="not seen"):
        agent.learn(blind, path, progress=False)
    agent.learn(near_task(), path, progress=False)
    assert agent.environments["segmentation"]["camera"]["min_pixels"] == 10


def test_segmenting_in_one_and_learning_in_another_environment_is_resumed(tmp_path):
    path = tmp_path / "scorer.npz"

    def train(env):
        agent = Arkaq(0.06, task="goal", learning=BRIEF_GOAL, rng=4)
        agent.segment(make_look_around(), path, progress=False)
        return agent.learn(env, path, progress=False)

    with pytest.raises(KeyboardInterrupt):
        train(interrupted(gymnasium.make(GOAL_TASK), 30))
    resumed = train(gymnasium.make(GOAL_TASK))
    alone = Arkaq(0.06, task="goal", learning=BRIEF_GOAL, rng=4)
    alone.segment(make_look_around(), progress=False)
    alone.learn(gymnasium.make(GOAL_TASK), progress=False)
    assert digest(resumed) == digest(alone)


def test_a_file_from_before_environments_were_kept_is_resumed(begun, brief):
    path = begun(300)
    with np.load(path) as file:
        contents = dict(file)
    settings = json.loads(str(contents["settings"]))
    assert settings.pop("environments").keys() == {"segmentation", "Q-learning"}
    np.savez(path, **contents | {"settings": np.array(json.dumps(settings))})
    assert Arkaq.load(path).environments == {}
    assert digest(brief_agent(checkpoint=path)) == digest(brief)


class Doubled(gymnasium.RewardWrapper):
    def reward(self, reward):
        return 2 * reward


class Hurried(gymnasium.Wrapper):
    def __init__(self, env, cost):
        super().__init__(env)
        self.cost = cost


class Thing:
    """Its representation holds its address."""


def test_environments_that_are_not_ours_are_described_by_what_they_were_made_with():
    described = storage.describe_environment(Doubled(near_task()))
    assert described["wrappers"] == [{"wrapper": "Doubled"}]
    assert described["environment"] == "BallApproach-v0"
    dear, cheap = (storage.describe_environment(Hurried(near_task(), cost)) for cost in (50, 1))
    assert dear["wrappers"] == [{"wrapper": "Hurried", "cost": 50}] != cheap["wrappers"]

    class Other(gymnasium.Env):
        observation_space = gymnasium.spaces.Box(-1, 1, (3,))
        action_space = gymnasium.spaces.Discrete(2)

        def __init__(self, thing=None, size=None, render_mode=None):
            pass

    assert storage.describe_environment(Other())["environment"] == "Other"
    gymnasium.register("Other-v0", entry_point=Other)
    try:
        made = gymnasium.make("Other-v0", thing=Thing(), size=np.float32(2), render_mode=None)
        described = storage.describe_environment(made)
    finally:
        del gymnasium.registry["Other-v0"]
    assert described == {
        "environment": "Other-v0", "actions": "Discrete(2)", "max_episode_steps": None,
        "wrappers": [], "thing": "Thing", "size": 2.0,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"learning": TrainingSettings(patterns=151)}, r"learning\.patterns: 150, not 151"),
        ({"sensing": Sensing.thesis()}, r"sensing\.A: \[\[1\.0, 0\.0\].*, not \[\[1\.0, 0"),
    ],
)
def test_the_setting_that_differs_is_named_with_both_values(begun, other, words):
    agent = Arkaq(0.2, **{"learning": BRIEF, "rng": 4} | other)
    with pytest.raises(ValueError, match=words) as caught:
        agent.learn(near_task(), begun(60), progress=False)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize("env", [None, "BallApproach-v0", gymnasium.spaces.Discrete(2)])
def test_what_is_no_environment_is_refused_by_name(env):
    with pytest.raises(ValueError, match="env must be of the class Env"):
        Arkaq().learn(env, progress=False)


def test_a_reward_that_is_no_number_is_refused_by_name():
    class Broken(gymnasium.RewardWrapper):
        def reward(self, reward):
            return np.nan

    with pytest.raises(ValueError, match="reward must be a finite number, got nan"):
        brief_agent(env=Broken(near_task()))


# One process at a time --------------------------------------------------------------------------


def test_a_checkpoint_in_use_is_refused_by_name(tmp_path, brief):
    path, refused = tmp_path / "agent.npz", []

    def begin_another():
        for seed in (4, 5):
            with pytest.raises(ValueError, match="is in use by another run") as caught:
                brief_agent(seed=seed, checkpoint=path)
            refused.append(str(path) in str(caught.value))

    env = interrupted(near_task(), 200, begin_another)
    assert digest(brief_agent(env=env, checkpoint=path)) == digest(brief)
    assert refused == [True, True]
    assert os.listdir(tmp_path) == ["agent.npz"]


def test_an_interrupted_run_gives_its_checkpoint_free(begun):
    path = begun(60)
    assert os.listdir(path.parent) == [path.name]
    brief_agent(checkpoint=path)


# A disk that is full, a folder that cannot be written to -----------------------------------------


def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path, brief):
    path = tmp_path / "agent.npz"
    brief.save(path)
    before = path.read_bytes()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(OSError):
            brief.save(path)
        with pytest.raises(OSError):
            brief.save(tmp_path / "new.npz")
        with pytest.raises(OSError):
            brief_agent(checkpoint=tmp_path / "run.npz")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["agent.npz"]


def test_a_read_only_folder_leaves_the_old_file(brief):
    with tempfile.TemporaryDirectory() as folder:
        path, user = Path(folder) / "agent.npz", os.geteuid()
        brief.save(path)
        before = path.read_bytes()
        os.chmod(folder, 0o555)
        if user == 0:
            os.seteuid(65534)  # root may write everywhere, nobody may not
        try:
            with pytest.raises(PermissionError):
                brief.save(path)
            with pytest.raises(PermissionError):
                brief_agent(checkpoint=path)
        finally:
            os.seteuid(user)
            os.chmod(folder, 0o755)
        assert path.read_bytes() == before and os.listdir(folder) == ["agent.npz"]


def test_a_folder_that_does_not_exist_is_made(tmp_path):
    path = tmp_path / "new" / "folder" / "agent.npz"
    brief_agent(checkpoint=path)
    assert Arkaq.load(path).seed == 4


@pytest.mark.parametrize("path", [5, 1.5, ["agent.npz"]])
def test_what_is_no_path_is_refused_by_name(brief, path):
    for call in (brief.save, Arkaq.load, lambda path: brief_agent(checkpoint=path)):
        with pytest.raises(ValueError, match="path must be a path, got"):
            call(path)
