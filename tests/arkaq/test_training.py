"""The phases: what is learned, the same again for the same seed, and what is not seen."""

import os
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from arkaq_edu.arkaq import Arkaq, Sensing, TrainingSettings
from tests.arkaq.brief import BRIEF, TASK, brief_agent, digest, near_task


def approaches(choose, begin, starts=80, far=2500.0):
    """Whether the ball is reached, and what is earned, from fresh starts."""
    env = gymnasium.make(TASK, far=far)
    reached, earned = [], []
    for k in range(starts):
        observation, _ = env.reset(seed=10**6 + k)
        begin(k)
        over, total = False, 0.0
        while not over:
            observation, reward, terminated, truncated, _ = env.step(choose(observation))
            total += reward
            over = terminated or truncated
        reached.append(terminated)
        earned.append(total)
    return np.mean(reached), np.mean(earned)


def test_a_small_agent_learns_to_walk_to_the_ball():
    training = TrainingSettings(patterns=1200, exploration=3500, exploitation=3500)
    env = gymnasium.make(TASK, far=2500.0)
    learned = Arkaq(0.2, learning=training, rng=1).learn(env, progress=False)
    reached, earned = approaches(learned.act, lambda k: learned.reset())
    draws = np.random.default_rng(0)
    by_chance, earned_by_chance = approaches(lambda _: int(draws.integers(3)), lambda k: None)
    assert by_chance < 0.75
    assert reached >= 0.95
    assert earned > earned_by_chance + 40
    # The account of what happened adds up.
    phases = [row[0] for row in learned.history]
    assert phases == sorted(phases, key=["segmentation", "Q-learning"].index)
    assert learned.cycles == sum(row[1] for row in learned.history)
    assert learned.art.counts_.sum() == 1200
    assert learned.q.Q.shape == (learned.art.n_clusters_, 3)
    in_q_learning = [row for row in learned.history if row[0] == "Q-learning"]
    assert 7000 <= sum(row[1] for row in in_q_learning) < 7150
    for _, cycles, reward, success in learned.history:
        assert success is (reward >= 100) and cycles <= 150
    later = np.mean([row[3] for row in in_q_learning[-60:]])
    assert later > np.mean([row[3] for row in in_q_learning[:60]])


@pytest.mark.thesis("errata row 4")
def test_without_rewards_the_segmentation_is_the_same_and_nothing_else_is_learned(brief):
    unpaid = gymnasium.wrappers.TransformReward(near_task(), lambda reward: 0.0)
    agent = Arkaq(brief.vigilance, learning=BRIEF, rng=brief.seed).learn(unpaid, progress=False)
    assert (agent.art.cluster_centers_ == brief.art.cluster_centers_).all()
    assert not agent.q.Q.any() and brief.q.Q.any()


def test_the_vigilance_is_a_distance_between_patterns(brief):
    centers = brief.art.cluster_centers_
    assert np.abs(centers).max() <= 1
    finer = Arkaq(0.1, learning=BRIEF, rng=4).learn(near_task(), progress=False)
    assert finer.art.n_clusters_ > 1.5 * len(centers)


class Corridor(gymnasium.Env):
    """A ball straight ahead in a row of places 200 mm apart; the robot ends before it.

    Actions: a place forward, a place back (the wall at 4000 mm hurts), look away (all is lost).
    """

    observation_space = gymnasium.spaces.Box(
        np.float32([0, -1, 0]), np.float32([5000, 1, 1]), dtype=np.float32
    )
    action_space = gymnasium.spaces.Discrete(3)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.place, self.cycles = int(self.np_random.integers(1, 18)), 0
        return self.look(True), {}

    def look(self, visible):
        return np.array([600 + 200 * self.place, 0, 1], np.float32) * visible

    def step(self, action):
        self.cycles += 1
        reward = -1.0 if action == 1 and self.place == 17 else 0.0
        self.place = min(self.place + (-1, 1, 0)[action], 17)
        done = self.place == 0
        cut_short = self.cycles >= 4 and action != 1  # never while an action is held
        reward += 100.0 * done
        return self.look(action != 2), reward, done, action == 2 or cut_short, {"is_success": done}


@pytest.mark.parametrize("hold", [1, 4])
@pytest.mark.parametrize("exploration", [6000, 400])
def test_values_are_those_of_the_process_where_nothing_is_random(hold, exploration):
    """Each place is a category and alpha is 1: what is learned is worked out beside it."""
    sharp = Sensing(
        low=(200.0, -0.5),
        high=(4100.0, 0.5),
        A=np.eye(2),
        H=np.eye(2),
        Q=np.eye(2) * 1e6,
        R=np.eye(2) * 1e-6,
        P0=np.eye(2) * 1e6,
    )
    training = TrainingSettings(
        patterns=600, exploration=exploration, exploitation=6000 - exploration, hold=hold,
        gamma=0.9, alpha_power=0.0, hot=1000.0, cold=1000.0, lost_reward=-50.0,
    )  # fmt: skip
    learned = Arkaq(0.02, sensing=sharp, learning=training, rng=0).learn(Corridor(), progress=False)
    places = (sharp.unscale(learned.art.cluster_centers_)[:, 0] - 600) / 200
    assert sorted(places.round(3)) == list(range(1, 18))
    forward = {n: 100 * 0.9 ** (n - 1) for n in range(1, 18)}
    back = {n: 0.9 * forward[n + 1] for n in range(1, 17)}
    hurt = sum(0.9**k for k in range(hold))
    back[17] = 0.9**hold * forward[17] - hurt
    for row, place in enumerate(places.round().astype(int)):
        ideal = [forward[place], back[place], -50.0]
        assert learned.q.Q[row] == pytest.approx(ideal, abs=1e-6), place


class Turret(gymnasium.Env):
    """A goal in one of seven orientations .14 rad apart; only straight ahead does a kick score."""

    observation_space = gymnasium.spaces.Box(
        np.float32([-1, 0]), np.float32([1, 1]), dtype=np.float32
    )
    action_space = gymnasium.spaces.Discrete(3)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.place = int(self.np_random.integers(-3, 4))
        return self.look(), {}

    def look(self):
        return np.array([0.14 * self.place, 1], np.float32)

    def step(self, action):
        over, goal = action == 2, action == 2 and self.place == 0
        self.place = int(np.clip(self.place + (-1, 1, 0)[action], -3, 3))
        reward = (100.0 if goal else -100.0) if over else 0.0
        return self.look(), reward, over, False, {"is_success": goal}


@pytest.mark.parametrize(("task", "other"), [("approach", Turret), ("goal", Corridor)])
def test_an_environment_of_the_other_task_is_refused(task, other):
    agent = Arkaq(0.06, task=task, rng=0)
    for learn in (agent.segment, agent.learn):
        with pytest.raises(ValueError, match="env must have an observation_space of shape"):
            learn(other(), progress=False)


def test_values_of_the_goal_problem_are_those_of_the_process_where_nothing_is_random():
    training = TrainingSettings.goal(
        patterns=200, exploration=6000, exploitation=0, gamma=0.9, alpha_power=0.0,
        cycle_reward=-4.0,
    )  # fmt: skip
    sharp = Sensing(low=(-0.5,), high=(0.5,), A=[[1]], H=[[1]], Q=[[100]], R=[[1e-9]], P0=[[100]])
    learned = Arkaq(0.06, task="goal", sensing=sharp, learning=training, rng=0)
    learned.learn(Turret(), progress=False)
    places = np.rint(learned.art.cluster_centers_[:, 0] / 0.28).astype(int)
    assert sorted(places) == list(range(-3, 4))
    best = {0: 96.0}
    for n in (1, 2, 3):
        best[n] = best[-n] = -4 + 0.9 * best[n - 1]
    for row, place in enumerate(places.tolist()):
        turned = [-4 + 0.9 * best[int(np.clip(place + by, -3, 3))] for by in (-1, 1)]
        ideal = [*turned, 96.0 if place == 0 else -104.0]
        assert learned.q.Q[row] == pytest.approx(ideal, abs=1e-3), place
    seen = [learned.act(np.array([0.14 * n, 1.0])) for n in (0,)]
    assert seen == [2]


def test_segmenting_first_and_learning_then_is_learning(brief):
    in_two = Arkaq(0.2, learning=BRIEF, rng=4).segment(near_task(), progress=False)
    assert in_two.q is None and in_two.art.counts_.sum() == BRIEF.patterns
    centers = in_two.art.cluster_centers_.copy()
    in_two.segment(near_task(), progress=False)
    assert np.array_equal(in_two.art.cluster_centers_, centers), "segmented once"
    assert digest(in_two.learn(near_task(), progress=False)) == digest(brief)


def test_an_action_is_held_while_the_state_stays_but_not_for_ever():
    class Noted(gymnasium.Wrapper):
        episodes: list

        def reset(self, **options):
            self.episodes.append([])
            return self.env.reset(**options)

        def step(self, action):
            self.episodes[-1].append(action)
            return self.env.step(action)

    def longest_run(hold):
        env = Noted(near_task(far=2500.0))
        env.episodes = []
        training = TrainingSettings(patterns=1, exploration=1500, exploitation=0, hold=hold)
        # One pattern and a wide vigilance: one category, which nothing can leave.
        one = Arkaq(2.0, learning=training, rng=0).learn(env, progress=False)
        assert one.art.n_clusters_ == 1
        # Every action is held to the end: each backup but an episode's last stands for `hold`.
        backups = sum(-(-len(actions) // hold) for actions in env.episodes[1:])
        assert one.q.visits.sum() == backups
        for actions in env.episodes[1:]:
            for k in range(0, len(actions), hold):
                assert len(set(actions[k : k + hold])) == 1
        return one

    for hold in (1, 3, 10):
        longest_run(hold)


def test_the_same_seed_learns_the_same_in_any_process(brief):
    assert digest(brief_agent()) == digest(brief)
    assert digest(brief_agent(seed=5)) != digest(brief)
    script = "from tests.arkaq import brief as t; print(t.digest(t.brief_agent()))"
    here = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        timeout=240,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(here)},
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == digest(brief)


def test_what_the_environment_did_before_does_not_matter(brief):
    env = near_task()
    env.reset(seed=99)
    for _ in range(30):
        env.step(env.action_space.sample())
    assert digest(brief_agent(env=env)) == digest(brief)


def test_progress_bars_change_nothing(brief, capsys):
    learned = Arkaq(0.2, learning=BRIEF, rng=4).learn(near_task(), progress=True)
    assert digest(learned) == digest(brief)
    shown = capsys.readouterr().err
    assert "segmentation" in shown and "150/150" in shown
    assert "Q-learning" in shown and "400/400" in shown


class Blindfold(gymnasium.Wrapper):
    """Hides the ball in the first look of some episodes, and counts the episodes."""

    def __init__(self, env, hides, most):
        super().__init__(env)
        self.hides, self.most, self.resets = hides, most, 0

    def reset(self, **options):
        self.resets += 1
        assert self.resets < self.most, "it asks for ever"
        observation, info = self.env.reset(**options)
        return observation * (not self.hides(self.resets)), info


def test_a_ball_not_seen_at_first_only_costs_the_episode():
    env = Blindfold(near_task(), hides=lambda k: k % 3 != 0, most=2000)
    learned = brief_agent(env=env)
    segmentation = [row for row in learned.history if row[0] == "segmentation"]
    empty = sum(row[1] == 0 for row in segmentation)
    assert empty == pytest.approx(2 / 3 * len(segmentation), abs=2)
    assert learned.art.counts_.sum() == 150
    assert learned.q.visits.sum() > 0
    # Each episode has draws of its own, so a blind start is not met again and again.
    assert len({row[1] for row in segmentation}) > 3


def test_a_ball_that_is_never_seen_is_said_to_be_so():
    env = Blindfold(near_task(), hides=lambda k: True, most=3000)
    with pytest.raises(RuntimeError, match="seen"):
        brief_agent(env=env)
