"""The agent: its senses, its automata, what it learns, and what it keeps through interruptions."""

import hashlib
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import (
    GOAL_Q_LEARNING,
    GOAL_SEGMENTATION,
    Q_LEARNING,
    SEGMENTATION,
    Arkaq,
    Automaton,
    Estimator,
    Sensing,
    TrainingSettings,
    agent,
)

TASK = "arkaq_edu:BallApproach-v0"
BRIEF = TrainingSettings(patterns=150, exploration=200, exploitation=200)
GOAL_TASK = "arkaq_edu:ScoreGoal-v0"
BRIEF_GOAL = TrainingSettings.goal(patterns=100, exploration=60, exploitation=60)
SENSINGS = {"thesis": Sensing.thesis(), "consistent": Sensing.consistent()}


def near_task(**options):
    return gymnasium.make(TASK, **{"far": 1200.0, **options})


def arrays(agent):
    """All that an agent has learned, by name."""
    return {
        "centers": agent.art.cluster_centers_,
        "counts": agent.art.counts_,
        "Q": agent.q.Q,
        "visits": agent.q.visits,
        "history": np.array([row[1:] for row in agent.history], dtype=float),
        "phases": np.array([row[0] for row in agent.history]),
        "cycles": np.array(agent.cycles),
    }


def digest(agent):
    said = hashlib.sha256()
    for name, values in arrays(agent).items():
        said.update(f"{name} {values.shape} {values.dtype}".encode() + values.tobytes())
    return said.hexdigest()


def brief_agent(seed=4, env=None, **options):
    learner = Arkaq(0.2, learning=BRIEF, rng=seed)
    return learner.learn(env or near_task(), progress=False, **options)


def brief_scorer(seed=4, env=None, **options):
    learner = Arkaq(0.06, task="goal", learning=BRIEF_GOAL, rng=seed)
    return learner.learn(env or gymnasium.make(GOAL_TASK), progress=False, **options)


@pytest.fixture(scope="module")
def brief():
    return brief_agent()


@pytest.fixture(scope="module")
def kept(brief, tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "agent.npz"
    brief.save(path)
    return path


# Senses -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SENSINGS)
@given(distance=st.floats(200, 4100), orientation=st.floats(-0.5, 0.5))
def test_scale_is_the_thesis_and_unscale_its_inverse(name, distance, orientation):
    sensing = SENSINGS[name]
    pattern = sensing.scale([distance, orientation])
    assert pattern == pytest.approx([(distance - 2150) / 1950, 2 * orientation], abs=1e-12)
    assert sensing.unscale(pattern) == pytest.approx([distance, orientation], abs=1e-9)


def test_scale_clips_to_the_interval_and_takes_many_rows():
    patterns = Sensing.thesis().scale([[[100.0, -0.7], [2150.0, 0.0]], [[9000.0, 0.7], [200, 0.5]]])
    assert patterns.tolist() == [[[-1, -1], [0, 0]], [[1, 1], [-1, 1]]]


@pytest.mark.parametrize("name", SENSINGS)
def test_settings_survive_json(name):
    sensing = SENSINGS[name]
    text = json.dumps(sensing.to_json())
    again = Sensing.from_json(json.loads(text))
    assert json.dumps(again.to_json()) == text
    senses, senses_again = Estimator(sensing), Estimator(again)
    for k, action in enumerate([None, 0, 1, 2, 0]):
        look = np.array([2000.0 - 90 * k, 0.1, k != 2])
        assert np.array_equal(senses.observe(look, action), senses_again.observe(look, action))


def test_the_thesis_settings_are_those_it_prints():
    sensing = Sensing.thesis()
    assert np.array_equal(sensing.R, np.diag([100, 0.05]))
    assert np.array_equal(sensing.Q, np.diag([0.001, 0.0001, 0.0001, 0.000001]))
    assert (sensing.low, sensing.high) == ((200, -0.5), (4100, 0.5))
    assert sensing.B is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"high": (4100.0, -0.5)}, "high"),
        ({"low": (200.0,)}, "high"),
        ({"R": [[1.0]]}, "R"),
        ({"Q": -np.eye(2)}, "Q"),
        ({"range_noise": -1.0}, "range_noise"),
    ],
)
def test_bad_settings_are_refused(change, words):
    good = vars(Sensing.consistent())
    with pytest.raises(ValueError, match=words):
        Sensing(**good | change)


def walks(senses, episodes, seed):
    """What filters say and the truth is, along walks half at random and half to the ball."""
    env, rng = gymnasium.make(TASK), np.random.default_rng(seed)
    nis, errors = [], []
    for _ in range(episodes):
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        senses.reset()
        senses.observe(observation, None)
        over = False
        while not over:
            side = info["orientation"]
            action = int(rng.integers(3))
            if rng.random() < 0.5:
                action = 0 if abs(side) < 0.1 else 1 if side > 0 else 2
            observation, _, terminated, truncated, info = env.step(action)
            senses.observe(observation, action)
            if observation[2]:
                nis.append(senses.kalman.nis)
            errors.append(senses.kalman.x[:2] - (info["distance"], side))
            over = terminated or truncated
    return np.array(nis), np.array(errors)


def test_innovations_are_as_large_as_the_consistent_filter_believes():
    nis, _ = walks(Estimator(Sensing.consistent()), episodes=80, seed=0)
    n = len(nis)
    assert n > 1000
    # The errors of whole pixels are not drawn from a normal distribution, nor quite independent:
    # four times the width of the band that a perfect filter would keep.
    low, high = stats.chi2.ppf([0.025, 0.975], 2 * n) / n
    assert 2 - 4 * (2 - low) < nis.mean() < 2 + 4 * (high - 2)
    assert 0.015 < np.mean(nis > stats.chi2.ppf(0.95, 2)) < 0.10
    of_the_thesis, _ = walks(Estimator(Sensing.thesis()), episodes=80, seed=0)
    assert of_the_thesis.mean() > 2 + 20 * (high - 2)


def test_the_estimate_of_the_thesis_lags_behind_the_turning_robot():
    env = gymnasium.make(TASK)
    lags = {name: [] for name in SENSINGS}
    for seed in range(12):
        for name, sensing in SENSINGS.items():
            senses = Estimator(sensing)
            observation, _ = env.reset(seed=seed, options={"distance": 2500, "orientation": 0.3})
            senses.observe(observation, None)
            for action in [1, 1, 1, 1, 1]:  # the ball moves to the right in the robot's view
                observation, _, _, _, info = env.step(action)
                assert observation[2] == 1
                senses.observe(observation, action)
                lags[name].append(senses.kalman.x[1] - info["orientation"])
    assert np.mean(lags["thesis"]) > 0.05
    assert abs(np.mean(lags["consistent"])) < 0.01


def cycles_to_catch_up(sensing, before, after):
    """Updates until nine tenths of a jump of the sightings are made, in a filter long settled."""
    kalman = sensing.filter()
    for _ in range(600):
        kalman.predict()
        kalman.update(before)
    n = 0
    entry = int(np.argmax(np.not_equal(before, after)))
    while abs(kalman.x[entry] - after[entry]) > 0.1 * abs(before[entry] - after[entry]):
        kalman.predict()
        kalman.update(after)
        n += 1
    return n


def test_the_estimate_of_the_thesis_lags_behind_a_jump():
    # A cell of vigilance .15: 300 mm.
    assert 25 <= cycles_to_catch_up(Sensing.thesis(), [2000.0, 0.0], [2300.0, 0.0]) <= 35
    assert cycles_to_catch_up(Sensing.consistent(), [2000.0, 0.0], [2300.0, 0.0]) <= 3


def test_an_unseen_ball_is_where_the_footsteps_have_brought_it():
    senses = Estimator(Sensing.consistent())
    start = Sensing.consistent().unscale(senses.observe(np.array([2000.0, 0.0, 1.0]), None))
    assert start == pytest.approx([2000, 0], abs=2)
    unseen = np.zeros(3)
    for _ in range(3):
        pattern = senses.observe(unseen, 1)
    distance, orientation = Sensing.consistent().unscale(pattern)
    assert distance == pytest.approx(1700, abs=30)
    assert orientation == pytest.approx(-0.3, abs=0.02)
    senses.reset()
    assert senses.observe(unseen, None) == pytest.approx([0.0, 0.0])


# Automata ---------------------------------------------------------------------------------------


def reachable(automaton):
    found, new = set(), {automaton.start}
    while new:
        found |= new
        new = {after for (state, _), after in automaton.table.items() if state in found} - found
    return found


@pytest.mark.parametrize(
    "automaton", [SEGMENTATION, Q_LEARNING, GOAL_SEGMENTATION, GOAL_Q_LEARNING]
)
def test_every_state_can_be_reached_and_can_reach_the_end(automaton):
    assert reachable(automaton) == {*automaton.states, "done"}
    for state in automaton.states:
        assert "done" in reachable(Automaton(state, automaton.table))


class Blinking(gymnasium.Wrapper):
    """Shows nothing in every ninth look."""

    looks = 0

    def blink(self, observation):
        self.looks += 1
        return observation * (self.looks % 9 > 0)

    def reset(self, **options):
        observation, info = self.env.reset(**options)
        return self.blink(observation), info

    def step(self, action):
        observation, *rest = self.env.step(action)
        return self.blink(observation), *rest


def test_the_tables_hold_just_what_can_happen(monkeypatch):
    tables = (SEGMENTATION, Q_LEARNING, GOAL_SEGMENTATION, GOAL_Q_LEARNING)
    happened = {id(automaton): set() for automaton in tables}
    run = Automaton.run

    def run_and_tell(self, work):
        def telling(state):
            def tell():
                event = work[state]()
                happened[id(self)].add((state, event))
                return event

            return tell

        run(self, {state: telling(state) for state in work})

    monkeypatch.setattr(Automaton, "run", run_and_tell)
    brief_agent(env=near_task(patience=4))
    brief_scorer(env=Blinking(gymnasium.make(GOAL_TASK)))
    for automaton in tables:
        assert happened[id(automaton)] == set(automaton.table)


# Learning ---------------------------------------------------------------------------------------


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
    law = TrainingSettings(patterns=1200, exploration=3500, exploitation=3500)
    env = gymnasium.make(TASK, far=2500.0)
    learned = Arkaq(0.2, learning=law, rng=1).learn(env, progress=False)
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


def test_the_vigilance_is_a_distance_between_patterns(brief):
    centers = brief.art.cluster_centers_
    assert np.abs(centers).max() <= 1
    finer = Arkaq(0.1, learning=BRIEF, rng=4).learn(near_task(), progress=False)
    assert finer.art.n_clusters_ > 1.5 * len(centers)


@pytest.mark.parametrize("sensing", ["thesis", "consistent"])
def test_either_sensing_learns_by_name_or_by_value(sensing):
    by_name = Arkaq(0.2, sensing=sensing, learning=BRIEF, rng=4).learn(near_task(), progress=False)
    by_value = Arkaq(0.2, sensing=SENSINGS[sensing], learning=BRIEF, rng=4)
    assert digest(by_value.learn(near_task(), progress=False)) == digest(by_name)


def test_the_two_sensings_see_the_world_differently(brief):
    other = Arkaq(0.2, sensing="thesis", learning=BRIEF, rng=4).learn(near_task(), progress=False)
    assert digest(other) != digest(brief)


def test_schedules():
    law = TrainingSettings(hot=8.0, cold=0.5, alpha_power=0.5, alpha_least=0.25)
    assert [law.alpha(n) for n in (1, 4, 9, 16, 1000)] == [1, 0.5, 1 / 3, 0.25, 0.25]
    assert [law.temperature(p) for p in (0.0, 0.5, 1.0)] == pytest.approx([8.0, 2.0, 0.5])


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("learning_rate", 0), ("patterns", 0), ("period", 0), ("exploration", -1),
        ("exploitation", 2.5), ("hold", 0), ("gamma", 1), ("alpha_power", 2), ("alpha_least", -1),
        ("cold", 0), ("hot", 0.1), ("lost_reward", math.nan), ("cycle_reward", math.inf),
    ],
)  # fmt: skip
def test_bad_parameters_of_learning_are_refused(name, value):
    with pytest.raises(ValueError, match=f"{name}.*{value}"):
        TrainingSettings(**{name: value})


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"vigilance": 0}, "vigilance"),
        ({"vigilance": 2.5}, "vigilance"),
        ({"sensing": "kalman"}, "sensing.*kalman"),
        ({"task": "dance"}, "task must be 'approach' or 'goal', got 'dance'"),
        ({"rng": -1}, "rng"),
        ({"rng": 0.5}, "rng"),
    ],
)
def test_bad_arguments_are_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        Arkaq(**arguments)


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
    law = TrainingSettings(
        patterns=600, exploration=exploration, exploitation=6000 - exploration, hold=hold,
        gamma=0.9, alpha_power=0.0, hot=1000.0, cold=1000.0, lost_reward=-50.0,
    )  # fmt: skip
    learned = Arkaq(0.02, sensing=sharp, learning=law, rng=0).learn(Corridor(), progress=False)
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
        with pytest.raises(ValueError, match="env must give observations of shape"):
            learn(other(), progress=False)


def test_values_of_the_goal_problem_are_those_of_the_process_where_nothing_is_random():
    law = TrainingSettings.goal(
        patterns=200, exploration=6000, exploitation=0, gamma=0.9, alpha_power=0.0,
        cycle_reward=-4.0,
    )  # fmt: skip
    sharp = Sensing(low=(-0.5,), high=(0.5,), A=[[1]], H=[[1]], Q=[[100]], R=[[1e-9]], P0=[[100]])
    learned = Arkaq(0.06, task="goal", sensing=sharp, learning=law, rng=0)
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


def test_one_class_learns_both_tasks_each_with_its_own_senses_and_schedule(brief):
    scorer = brief_scorer()
    assert (brief.task, scorer.task) == ("approach", "goal")
    assert scorer.sensing == Sensing.goal() and brief.sensing == Sensing.consistent()
    assert Arkaq(task="goal").learning == TrainingSettings.goal()
    assert Arkaq().learning == TrainingSettings()
    assert scorer.art.cluster_centers_.shape[1] == 1
    assert digest(scorer) == digest(brief_scorer())


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
        law = TrainingSettings(patterns=1, exploration=1500, exploitation=0, hold=hold)
        # One pattern and a wide vigilance: one category, which nothing can leave.
        one = Arkaq(2.0, learning=law, rng=0).learn(env, progress=False)
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


# The same again ---------------------------------------------------------------------------------


def test_the_same_seed_learns_the_same_in_any_process(brief):
    assert digest(brief_agent()) == digest(brief)
    assert digest(brief_agent(seed=5)) != digest(brief)
    script = "from tests.arkaq import test_agent as t; print(t.digest(t.brief_agent()))"
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


def test_a_generator_gives_one_seed_and_none_gives_any():
    seeds = [Arkaq(rng=np.random.default_rng(3)).seed for _ in range(2)]
    assert seeds[0] == seeds[1]
    assert Arkaq().seed != Arkaq().seed


def test_progress_bars_change_nothing(brief, capsys):
    learned = Arkaq(0.2, learning=BRIEF, rng=4).learn(near_task(), progress=True)
    assert digest(learned) == digest(brief)
    shown = capsys.readouterr().err
    assert "segmentation" in shown and "150/150" in shown
    assert "Q-learning" in shown and "400/400" in shown


# Acting -----------------------------------------------------------------------------------------


def test_act_is_the_greedy_action_of_the_state_that_is_estimated(brief):
    env = near_task()
    senses = Estimator(brief.sensing)
    for seed in range(5):
        observation, _ = env.reset(seed=seed)
        brief.reset()
        senses.reset()
        action, over = None, False
        while not over:
            pattern = senses.observe(observation, action)
            state = np.linalg.norm(brief.art.cluster_centers_ - pattern, axis=1).argmin()
            action = brief.act(observation)
            assert isinstance(action, int)
            assert action == np.argmax(brief.q.Q[state])
            observation, _, terminated, truncated, _ = env.step(action)
            over = terminated or truncated


def test_acting_teaches_nothing(brief):
    before = digest(brief)
    brief.reset()
    brief.act(np.array([900.0, 0.1, 1.0], np.float32))
    brief.act(np.array([0.0, 0.0, 0.0], np.float32))
    assert digest(brief) == before


@pytest.mark.parametrize(
    "observation",
    [[900.0, 0.1], [900.0, 0.1, 1.0, 0.0], [[900.0, 0.1, 1.0]], [math.nan, 0.0, 1.0], None, "ball"],
)
def test_act_refuses_bad_observations(brief, observation):
    with pytest.raises(ValueError, match="observation"):
        brief.act(observation)
    brief.reset()


def test_an_agent_that_has_not_learned_cannot_act():
    with pytest.raises(RuntimeError, match="learn"):
        Arkaq().act(np.zeros(3))


def test_learning_leaves_no_episode_behind(kept):
    """An agent just trained and the same one from its file see a first look alike."""
    fresh, loaded = brief_agent(), Arkaq.load(kept)
    env = near_task()
    for seed in range(4):
        observation, _ = env.reset(seed=seed)
        for _ in range(4):
            assert fresh.act(observation) == loaded.act(observation)
            assert np.array_equal(fresh._senses.kalman.x, loaded._senses.kalman.x)
            observation, *_ = env.step(0)


# Files ------------------------------------------------------------------------------------------


def test_a_saved_agent_is_the_same_agent(brief, kept):
    loaded = Arkaq.load(kept)
    assert digest(loaded) == digest(brief)
    for name, values in arrays(brief).items():
        assert np.array_equal(arrays(loaded)[name], values), name
        assert arrays(loaded)[name].dtype == values.dtype, name
    assert (loaded.vigilance, loaded.seed) == (brief.vigilance, brief.seed)
    assert loaded.learning == brief.learning
    assert loaded.sensing.to_json() == brief.sensing.to_json()
    assert loaded.history == brief.history


def test_a_file_is_the_same_bytes_each_time_and_holds_no_code(brief, kept, tmp_path):
    again = tmp_path / "again.npz"
    Arkaq.load(kept).save(again)
    assert again.read_bytes() == kept.read_bytes()
    assert os.listdir(tmp_path) == ["again.npz"]
    with np.load(kept, allow_pickle=False) as file:
        assert json.loads(str(file["settings"]))["format"] == 1
        assert np.array_equal(file["Q"], brief.q.Q)


def test_a_scorer_is_kept_as_what_it_is(tmp_path):
    scorer, path = brief_scorer(), tmp_path / "scorer.npz"
    scorer.save(path)
    loaded = Arkaq.load(path)
    assert digest(loaded) == digest(scorer)
    assert (loaded.task, loaded.learning) == ("goal", BRIEF_GOAL)
    walker = Arkaq(0.06, sensing="goal", learning=BRIEF_GOAL, rng=4)
    with pytest.raises(ValueError, match="another task"):
        walker.learn(near_task(), path, progress=False)


def test_the_file_of_the_ball_is_what_it_was_before_there_was_a_goal(tmp_path):
    course = data_file("ball_approach.npz")
    Arkaq.load(course).save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == course.read_bytes()


def test_an_agent_that_has_not_learned_can_be_kept_too(tmp_path):
    path = tmp_path / "young.npz"
    Arkaq(0.2, learning=BRIEF, rng=4).save(path)
    assert digest(Arkaq.load(path).learn(near_task(), progress=False)) == digest(brief_agent())


@pytest.mark.parametrize("kind", [np.int64, np.int32])
def test_numpy_numbers_are_settings_too(tmp_path, kind):
    path = tmp_path / "agent.npz"
    law = TrainingSettings(
        patterns=kind(150), exploration=kind(200), exploitation=200, gamma=np.float32(0.5)
    )
    Arkaq(np.float64(0.2), learning=law, rng=kind(4)).save(path)
    assert Arkaq.load(path).learning == law


def test_a_save_that_fails_leaves_the_old_file(brief, tmp_path, monkeypatch):
    path = tmp_path / "agent.npz"
    brief.save(path)
    before = path.read_bytes()

    def broken(file, **arrays):
        file.write(b"half a fi")
        raise OSError("no space left on device")

    monkeypatch.setattr(np, "savez_compressed", broken)
    with pytest.raises(OSError, match="no space"):
        brief.save(path)
    assert path.read_bytes() == before


def refused(path):
    with pytest.raises(ValueError, match="not an agent") as caught:
        Arkaq.load(path)
    return str(path) in str(caught.value)


def test_a_truncated_file_is_refused(kept, tmp_path):
    data, path = kept.read_bytes(), tmp_path / "short.npz"
    for length in [0, 1, 10, *range(50, len(data), 97), len(data) - 1]:
        path.write_bytes(data[:length])
        assert refused(path)


def test_a_damaged_file_is_refused_or_unharmed(brief, kept, tmp_path):
    """A flipped byte is noticed, unless it lies where nothing is kept, as in a file's date."""
    data, path, rng = kept.read_bytes(), tmp_path / "damaged.npz", np.random.default_rng(0)
    caught = 0
    for place in [
        *range(0, 200, 3),
        *range(200, len(data) - 600, 23),
        *range(len(data) - 600, len(data), 5),
    ]:
        damaged = bytearray(data)
        damaged[place] ^= int(rng.integers(1, 256))
        path.write_bytes(damaged)
        try:
            assert digest(Arkaq.load(path)) == digest(brief)
        except ValueError as error:
            assert str(path) in str(error)
            caught += 1
    assert caught > 150


def altered(kept, path, settings=None, **changes):
    """Write the agent's file again with other contents; None takes an array out."""
    with np.load(kept) as file:
        contents = {name: file[name] for name in file.files}
    changed = json.loads(str(contents["settings"])) | (settings or {})
    contents["settings"] = np.array(json.dumps(changed))
    contents |= changes
    np.savez(path, **{name: values for name, values in contents.items() if values is not None})


def test_an_altered_file_is_refused(brief, kept, tmp_path):
    path = tmp_path / "altered.npz"
    altered(kept, path)
    assert digest(Arkaq.load(path)) == digest(brief)
    Q, visits, centers = brief.q.Q, brief.q.visits, brief.art.cluster_centers_
    contents = [
        {"Q": Q * math.nan},
        {"Q": Q[:-1]},
        {"Q": Q[0]},
        {"Q": None, "visits": None, "centers": None, "counts": None, "history": None},
        {"visits": visits[0]},
        {"visits": -1 - visits},
        {"visits": visits[:, :2]},
        {"visits": None},
        {"centers": None},
        {"centers": centers * math.inf},
        {"centers": np.hstack([centers, centers])},
        {"counts": brief.art.counts_[1:]},
        {"counts": -brief.art.counts_},
        {"history": None},
        {"history": np.full((3, 4), math.nan)},
        {"history": np.zeros((3, 5))},
        {"centers": np.array([{"a": 1}], dtype=object)},
    ]
    for changes in contents:
        altered(kept, path, **changes)
        assert refused(path), changes
    settings = [
        {"format": 2}, {"format": None}, {"phase": "asleep"}, {"done_in_phase": -1},
        {"done_in_phase": "x"}, {"cycles": None}, {"seed": 1.5}, {"seed": -1}, {"vigilance": 0},
        {"vigilance": "x"}, {"learning": {"gamma": 2}}, {"learning": {"patience": 2}},
        {"learning": []}, {"sensing": []}, {"sensing": {"low": [0], "high": [1]}},
    ]  # fmt: skip
    for changes in settings:
        altered(kept, path, settings=changes)
        assert refused(path), changes


def test_what_is_no_agent_at_all_is_refused(tmp_path):
    text, array, folder = tmp_path / "a.txt", tmp_path / "a.npy", tmp_path / "a"
    text.write_text("good morning")
    np.save(array, np.zeros(3))
    folder.mkdir()
    other = tmp_path / "other.npz"
    np.savez(other, settings=np.array("[1, 2]"))
    assert all(map(refused, (text, array, folder, other)))
    with pytest.raises(FileNotFoundError):
        Arkaq.load(tmp_path / "nowhere.npz")


# Interruptions ----------------------------------------------------------------------------------


class Interrupted(gymnasium.Wrapper):
    """Ctrl-C at the k-th step, or at the k-th reset."""

    def __init__(self, env, step=-1, reset=-1):
        super().__init__(env)
        self.steps, self.resets = step, reset

    def step(self, action):
        self.steps -= 1
        if self.steps == 0:
            raise KeyboardInterrupt
        return self.env.step(action)

    def reset(self, **options):
        self.resets -= 1
        if self.resets == 0:
            raise KeyboardInterrupt
        return self.env.reset(**options)


@pytest.fixture
def often(monkeypatch):
    monkeypatch.setattr(agent, "_SECONDS_BETWEEN_FILES", -1.0)


@pytest.mark.parametrize(
    "when",
    [
        {"step": 1}, {"step": 20}, {"step": 77}, {"step": 150}, {"step": 190}, {"step": 260},
        {"step": 420}, {"step": 540}, {"reset": 1}, {"reset": 2}, {"reset": 15}, {"reset": 60},
    ],
)  # fmt: skip
@pytest.mark.parametrize("same", [True, False], ids=["same agent", "new agent"])
def test_an_interrupted_run_comes_to_the_same_result(brief, tmp_path, often, when, same):
    path = tmp_path / "run.npz"
    learner = Arkaq(0.2, learning=BRIEF, rng=4)
    with pytest.raises(KeyboardInterrupt):
        learner.learn(Interrupted(near_task(), **when), path, progress=False)
    assert Arkaq.load(path).seed == 4
    if not same:
        learner = Arkaq(0.2, learning=BRIEF, rng=4)
    learner.learn(near_task(), path, progress=False)
    assert digest(learner) == digest(brief)
    assert digest(Arkaq.load(path)) == digest(brief)


def test_both_phases_are_interrupted_above(brief):
    segmentation = sum(row[1] for row in brief.history if row[0] == "segmentation")
    assert 77 < segmentation < 260 < 540 < brief.cycles


def test_a_run_interrupted_again_and_again_comes_to_the_same_result(brief, tmp_path, often):
    path, interruptions = tmp_path / "run.npz", 0
    while True:
        learner = Arkaq(0.2, learning=BRIEF, rng=4)
        try:
            learner.learn(Interrupted(near_task(), step=45), path, progress=False)
            break
        except KeyboardInterrupt:
            interruptions += 1
    assert interruptions > 8
    assert digest(learner) == digest(brief)


def test_even_the_first_moments_leave_a_file(tmp_path):
    path = tmp_path / "run.npz"
    with pytest.raises(KeyboardInterrupt):
        brief_agent(env=Interrupted(near_task(), step=30), checkpoint=path)
    assert Arkaq.load(path).learning == BRIEF


def test_a_finished_run_is_not_run_again(brief, tmp_path):
    path = tmp_path / "run.npz"
    assert digest(brief_agent(checkpoint=path)) == digest(brief)
    before = path.read_bytes()
    untouchable = Interrupted(near_task(), step=1, reset=1)
    assert digest(brief_agent(env=untouchable, checkpoint=path)) == digest(brief)
    assert path.read_bytes() == before


def test_a_checkpoint_of_another_run_is_refused_and_left_alone(kept):
    before = kept.read_bytes()
    others = {
        "seed": Arkaq(0.2, learning=BRIEF, rng=5),
        "vigilance": Arkaq(0.25, learning=BRIEF, rng=4),
        "sensing": Arkaq(0.2, sensing="thesis", learning=BRIEF, rng=4),
        "learning": Arkaq(0.2, learning=TrainingSettings(patterns=151), rng=4),
    }
    for what, other in others.items():
        with pytest.raises(ValueError, match=f"another {what}") as caught:
            other.learn(near_task(), kept, progress=False)
        assert str(kept) in str(caught.value)
        assert other.q is None
    assert kept.read_bytes() == before


def test_a_damaged_checkpoint_is_refused_and_left_alone(tmp_path):
    path = tmp_path / "run.npz"
    path.write_bytes(b"PK\x03\x04 no more than that")
    with pytest.raises(ValueError, match="not an agent"):
        brief_agent(checkpoint=path)
    assert path.read_bytes() == b"PK\x03\x04 no more than that"


# A ball that is not seen ------------------------------------------------------------------------


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


def test_settings_are_equal_by_value():
    assert Sensing.thesis() == Sensing.thesis() != Sensing.consistent()
    assert hash(Sensing.thesis()) == hash(Sensing.thesis())
    assert Sensing.from_json(Sensing.consistent().to_json()) == Sensing.consistent()
