"""The ball-approach task as Gymnasium sees it, and against its own printed rules."""

import json
import math
import os
import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.field import Camera, Legs, pitch

TASK = "arkaq_edu:BallApproach-v0"


def play(env, choose, seed=None, options=None):
    """One episode: its observations, rewards, infos, and how it ended."""
    observation, info = env.reset(seed=seed, options=options)
    observations, rewards, infos, over = [observation], [], [info], False
    while not over:
        action = choose(observation, info)
        observation, reward, terminated, truncated, info = env.step(action)
        observations.append(observation)
        rewards.append(reward)
        infos.append(info)
        over = terminated or truncated
    return np.array(observations), np.array(rewards), infos, terminated, truncated


def always(action):
    return lambda observation, info: action


def towards_the_ball(observation, info):
    """Turn by a tenth of a radian where that helps."""
    return 0 if abs(info["orientation"]) < 0.06 else 1 if info["orientation"] > 0 else 2


def at_random(seed):
    rng = np.random.default_rng(seed)
    return lambda observation, info: int(rng.integers(3))


@pytest.mark.parametrize("options", [{}, {"render_mode": "rgb_array"}, {"near": 200, "far": 250}])
def test_gymnasium_has_nothing_to_complain_of(options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(TASK, **options).unwrapped)


def test_spaces():
    env = gymnasium.make(TASK)
    assert env.action_space == gymnasium.spaces.Discrete(3)
    box = env.observation_space
    assert (box.shape, box.dtype) == ((3,), np.float32)
    assert np.all(box.low <= [0, -0.5, 0]) and np.all(box.high >= [4100, 0.5, 1])
    assert (box.low[2], box.high[2]) == (0, 1)
    assert env.spec.max_episode_steps == 150


def test_importing_the_package_is_enough_to_register_it():
    import arkaq_edu  # noqa: F401

    assert "BallApproach-v0" in gymnasium.registry


def truth(world):
    """Distance and orientation of the ball, in the robot's own frame."""
    x, y, heading = world.pose
    turn = np.array(
        [[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]]
    )
    ahead, left = turn @ (np.array(world.ball) - (x, y))
    return math.hypot(ahead, left), math.atan2(left, ahead)


def test_every_episode_keeps_the_rules():
    env = gymnasium.make(TASK, patience=6)
    endings = {"reached straight": 0, "reached": 0, "lost": 0}
    for seed in range(80):
        choose = at_random(seed) if seed % 2 else towards_the_ball
        observation, info = env.reset(seed=seed)
        visible, over = [observation[2]], False
        while not over:
            observation, reward, terminated, truncated, info = env.step(choose(observation, info))
            visible.append(observation[2])
            over = terminated or truncated
            distance, orientation = truth(env.unwrapped.world)
            assert (info["distance"], info["orientation"]) == pytest.approx((distance, orientation))
            assert observation in env.observation_space and observation.dtype == np.float32
            if observation[2]:
                assert observation[2] == 1
                assert observation[0] == pytest.approx(distance, rel=0.25)
                assert observation[1] == pytest.approx(orientation, abs=0.02)
            else:
                assert not observation.any()
            close, straight = distance < 500, abs(orientation) <= 0.05
            assert reward == 100 * close + 50 * (close and straight)
            assert terminated is info["is_success"] is close
            assert truncated is (not close and not any(visible[1:][-6:]) and len(visible) > 6)
        ending = "reached straight" if reward == 150 else "reached" if terminated else "lost"
        endings[ending] += 1
        assert len(visible) <= 100
    assert min(endings.values()) >= 5, endings


@pytest.mark.parametrize("patience", [1, 4, 10])
def test_a_ball_out_of_view_for_good_truncates_after_the_patience(patience):
    env = gymnasium.make(TASK, patience=patience)
    start = {"distance": 3000, "orientation": -0.3}
    observations, rewards, infos, terminated, truncated = play(env, always(1), 0, start)
    assert truncated and not terminated and not rewards.any()
    visible = observations[:, 2].tolist()
    assert visible[0] == 1
    assert visible[-patience:] == [0] * patience
    assert visible[-patience - 1] == 1
    assert not infos[-1]["is_success"]


def test_a_ball_seen_again_is_not_lost():
    env = gymnasium.make(TASK, patience=4, legs=Legs(0, 0, 0))
    env.reset(seed=0, options={"distance": 3500, "orientation": -0.4})
    visible, ends = [], []
    for action in [1, 1, 2, 2, 1, 1, 1, 1]:
        observation, _, _, truncated, _ = env.step(action)
        visible.append(int(observation[2]))
        ends.append(truncated)
    assert visible == [0, 0, 0, 1, 0, 0, 0, 0]
    assert ends == [False] * 7 + [True]


def test_a_ball_reached_unseen_is_reached():
    env = gymnasium.make(TASK, patience=3, camera=Camera(min_pixels=10**6))
    observations, rewards, _, terminated, truncated = play(
        env, always(0), 0, {"distance": 750, "orientation": 0.0}
    )
    assert len(rewards) == 3 and not observations.any()
    assert (rewards[-1], terminated, truncated) == (150, True, False)


def test_the_time_limit_truncates():
    env = gymnasium.make(TASK, patience=1000)
    _, rewards, infos, terminated, truncated = play(
        env, always(1), 0, {"distance": 4000, "orientation": 0.0}
    )
    assert (len(rewards), truncated, terminated) == (150, True, False)
    assert not infos[-1]["is_success"]


def test_the_true_state_leads_to_the_ball():
    env = gymnasium.make(TASK)
    earned = []
    for seed in range(15):
        _, rewards, infos, terminated, truncated = play(env, towards_the_ball, seed)
        earned.append(rewards[-1])
        assert terminated and not truncated
        assert infos[-1]["is_success"] and not infos[-2]["is_success"]
        assert not rewards[:-1].any()
        assert len(rewards) == pytest.approx((infos[0]["distance"] - 450) / 98, abs=3)
    assert 130 < np.mean(earned) <= 150


@pytest.mark.parametrize(("action", "turn"), [(0, 0.0), (1, 0.1), (2, -0.1)])
def test_actions_walk_a_footstep_and_turn_to_their_side(action, turn):
    env = gymnasium.make(TASK, legs=Legs(0, 0, 0))
    env.reset(seed=0, options={"distance": 4000, "orientation": 0.0})
    env.step(action)
    before = env.unwrapped.world.pose
    env.step(action)
    after = env.unwrapped.world.pose
    assert math.dist(before[:2], after[:2]) == pytest.approx(100, abs=0.1)
    assert after[2] - before[2] == pytest.approx(turn, abs=1e-9)


# The same again ---------------------------------------------------------------------------------


def recorded(env, seed, actions_seed, episodes=2):
    """The bytes of some episodes, the first of them seeded."""
    said = []
    for k in range(episodes):
        choose = at_random(actions_seed + k)
        observations, rewards, infos, *_ = play(env, choose, seed if k == 0 else None)
        told = [(i["distance"], i["orientation"], i["is_success"]) for i in infos]
        said.append((observations.tobytes(), rewards.tobytes(), np.array(told).tobytes()))
    return said


def test_the_same_seed_gives_the_same_bytes():
    env = gymnasium.make(TASK)
    first = recorded(env, 5, 0)
    assert recorded(gymnasium.make(TASK), 5, 0) == first
    assert recorded(env, 5, 0) == first, "reset(seed) then reset() can be had again"
    assert recorded(env, 6, 0) != first
    assert first[0] != first[1]


def test_a_reset_without_a_seed_goes_on_with_the_stream():
    env = gymnasium.make(TASK)
    starts = [env.reset(seed=5)[1]["distance"], *(env.reset()[1]["distance"] for _ in range(5))]
    assert len(set(starts)) == 6
    again = [env.reset(seed=5)[1]["distance"], *(env.reset()[1]["distance"] for _ in range(5))]
    assert again == starts


def test_a_vector_of_tasks_is_the_tasks_side_by_side():
    def make():
        return gymnasium.make(TASK)

    together = gymnasium.vector.SyncVectorEnv([make, make])
    observations, infos = together.reset(seed=[3, 4])
    for row, seed in enumerate((3, 4)):
        alone, info = make().reset(seed=seed)
        assert np.array_equal(observations[row], alone)
        assert infos["distance"][row] == info["distance"]
    together.close()


# Starts -----------------------------------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(distance=st.floats(200, 4100), orientation=st.floats(-0.49, 0.49))
def test_the_ball_can_be_put_at_a_place(distance, orientation):
    env = gymnasium.make(TASK)
    _, info = env.reset(seed=0, options={"distance": distance, "orientation": orientation})
    assert info["distance"] == pytest.approx(distance, abs=1e-6)
    assert info["orientation"] == pytest.approx(orientation, abs=1e-9)
    assert info["is_success"] is (info["distance"] < 500)


@pytest.mark.parametrize("placement", ["area", "thesis"])
def test_starts_lie_between_near_and_far_and_are_seen(placement):
    env = gymnasium.make(TASK, near=900, far=1500, placement=placement)
    env.reset(seed=0)
    starts = [env.reset() for _ in range(200)]
    distances = [info["distance"] for _, info in starts]
    assert 900 <= min(distances) < 950 and 1450 < max(distances) <= 1500
    assert np.mean([observation[2] for observation, _ in starts]) > 0.97
    sides = [info["orientation"] for _, info in starts]
    assert min(sides) < -0.35 and max(sides) > 0.35


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"distance": 900}, "distance and orientation"),
        ({"orientation": 0.1}, "distance and orientation"),
        ({"distance": 900, "orientation": 0, "x": 1}, "options.*'x'"),
        ({"distance": 100, "orientation": 0}, "distance.*100"),
        ({"distance": 5000, "orientation": 0}, "distance.*5000"),
        ({"distance": math.nan, "orientation": 0}, "distance.*nan"),
        ({"distance": 900, "orientation": 0.6}, "orientation.*0.6"),
    ],
)
def test_bad_places_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        gymnasium.make(TASK).reset(seed=0, options=options)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"near": 100}, "near.*100"),
        ({"far": 5000}, "far.*5000"),
        ({"near": 2000, "far": 1000}, "far.*1000"),
        ({"placement": "anywhere"}, "placement.*anywhere"),
        ({"patience": 0}, "patience.*0"),
        ({"patience": 2.5}, "patience.*2.5"),
    ],
)
def test_bad_arguments_are_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        gymnasium.make(TASK, **arguments)


def test_bad_modes_and_actions_are_refused():
    env = gymnasium.make(TASK).unwrapped
    with pytest.raises(ValueError, match=r"render_mode.*human"):
        type(env)(render_mode="human")
    env.reset(seed=0)
    for action in (-1, 3):
        with pytest.raises(ValueError, match=f"action.*{action}"):
            env.step(action)


def test_a_camera_of_ones_own_is_used():
    env = gymnasium.make(TASK, camera=Camera(min_pixels=500))
    observation, _ = env.reset(seed=0, options={"distance": 3000, "orientation": 0.0})
    assert not observation.any()
    observation, _ = env.reset(seed=0, options={"distance": 450, "orientation": 0.0})
    assert observation[2] == 1


# Pictures ---------------------------------------------------------------------------------------


def test_the_picture_shows_the_ball_and_follows_the_robot():
    env = gymnasium.make(TASK, render_mode="rgb_array")
    env.reset(seed=0, options={"distance": 2000, "orientation": 0.3})
    first = env.render()
    assert (first.shape, first.dtype) == ((600, 900, 3), np.uint8)
    bx, by = env.unwrapped.world.ball
    orange = np.abs(first.astype(int) - pitch.PALETTE[pitch.ORANGE]).sum(axis=-1) < 40
    rows, columns = np.nonzero(orange)
    assert columns.mean() == pytest.approx((bx + 3000) * 0.15, abs=1.5)
    assert rows.mean() == pytest.approx((2000 - by) * 0.15, abs=1.5)
    for _ in range(5):
        env.step(0)
    later = env.render()
    changed = np.nonzero((first != later).any(axis=-1))
    x, y, _ = env.unwrapped.world.pose
    column, row = (x + 3000) * 0.15, (2000 - y) * 0.15
    assert changed[1].min() < 75 and changed[0].min() <= row <= changed[0].max()
    # The head is white, and was not there before.
    head = (int(row), int(column + 10))
    assert later[head].min() > 200 > first[head].min()
    assert (later[rows, columns] == first[rows, columns]).all(), "the ball lies where it lay"


def test_without_a_render_mode_nothing_is_drawn():
    env = gymnasium.make(TASK).unwrapped
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert env.render() is None


# Without numba ----------------------------------------------------------------------------------


def some_steps():
    """A short run as text, to compare processes to the last bit."""
    import arkaq_edu._compiled as compiled

    env = gymnasium.make(TASK)
    observation, info = env.reset(seed=2)
    said = [observation.tolist(), info["distance"], info["orientation"]]
    for action in [0, 1, 2, 2, 0, 1]:
        observation, reward, *_, info = env.step(action)
        said.append([observation.tolist(), reward, info["distance"], info["orientation"]])
    return {"numba": compiled.HAVE_NUMBA, "said": repr(said)}


def test_the_task_runs_the_same_without_numba():
    script = (
        "import sys, json; sys.modules['numba'] = None; from tests.envs import test_approach; "
        "print(json.dumps(test_approach.some_steps()))"
    )
    here = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        timeout=240,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(here)},
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == some_steps() | {"numba": False}
