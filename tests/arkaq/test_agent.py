"""Arkaq: its arguments, and its actions."""

import math
import pickle

import numpy as np
import pytest

from arkaq_edu.arkaq import Arkaq, Estimator, Sarsa, Sensing, TrainingSettings
from tests.arkaq.brief import BRIEF, SENSINGS, brief_agent, brief_scorer, digest, near_task


@pytest.mark.parametrize("sensing", ["thesis", "consistent"])
def test_either_sensing_learns_by_name_or_by_value(sensing):
    by_name = Arkaq(0.2, sensing=sensing, learning=BRIEF, rng=4).learn(near_task(), progress=False)
    by_value = Arkaq(0.2, sensing=SENSINGS[sensing], learning=BRIEF, rng=4)
    assert digest(by_value.learn(near_task(), progress=False)) == digest(by_name)


def test_the_two_sensings_see_the_world_differently(brief):
    other = Arkaq(0.2, sensing="thesis", learning=BRIEF, rng=4).learn(near_task(), progress=False)
    assert digest(other) != digest(brief)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"vigilance": 0}, "vigilance"),
        ({"vigilance": 2.5}, "vigilance"),
        ({"sensing": "kalman"}, "sensing.*kalman"),
        ({"task": "dance"}, "task must be 'approach' or 'goal', got 'dance'"),
        ({"rng": -1}, "rng"),
        ({"rng": 0.5}, "rng"),
        ({"rng": "0"}, "rng must be an integer"),
        ({"vigilance": "0.1"}, "vigilance"),
        ({"vigilance": None}, "vigilance"),
        ({"task": ["goal"]}, "task must be"),
        ({"task": None}, "task must be"),
        ({"sensing": {}}, "sensing must be of the class Sensing, got {}"),
        ({"sensing": 0}, "sensing must be of the class Sensing, got 0"),
        ({"learning": {}}, "learning must be of the class TrainingSettings, got {}"),
        ({"learning": {"patterns": 5}}, "learning must be of the class TrainingSettings"),
        ({"segmenter": 0}, "segmenter must have the methods"),
        ({"learner": {}}, "learner must have the methods"),
        ({"learner": Sarsa}, "learner must be an object, got the class Sarsa"),
        ({"learner": np.zeros((99, 99))}, "learner must have the methods .{,200}$"),
    ],
)
def test_bad_arguments_are_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        Arkaq(**arguments)


def test_one_class_learns_both_tasks_each_with_its_own_senses_and_schedule(brief):
    scorer = brief_scorer()
    assert (brief.task, scorer.task) == ("approach", "goal")
    assert scorer.sensing == Sensing.goal() and brief.sensing == Sensing.consistent()
    assert Arkaq(task="goal").learning == TrainingSettings.goal()
    assert Arkaq().learning == TrainingSettings()
    assert scorer.art.cluster_centers_.shape[1] == 1
    assert digest(scorer) == digest(brief_scorer())


def test_a_generator_gives_one_seed_and_none_gives_any():
    seeds = [Arkaq(rng=np.random.default_rng(3)).seed for _ in range(2)]
    assert seeds[0] == seeds[1]
    assert Arkaq().seed != Arkaq().seed


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


def test_a_list_is_an_observation_too(brief):
    brief.reset()
    action = brief.act(np.array([900.0, 0.1, 1.0]))
    brief.reset()
    assert brief.act([900.0, 0.1, 1.0]) == action


def test_an_agent_can_travel_to_another_process(brief):
    twin = pickle.loads(pickle.dumps(brief))
    assert digest(twin) == digest(brief)
    for agent in (brief, twin):
        agent.reset()
    assert twin.act([900.0, 0.1, 1.0]) == brief.act([900.0, 0.1, 1.0])


def test_an_agent_that_has_not_learned_cannot_act():
    with pytest.raises(RuntimeError, match="learn"):
        Arkaq().act(np.zeros(3))


def test_learning_leaves_no_episode_behind(saved):
    """An agent just trained and the same one from its file see a first look alike."""
    fresh, loaded = brief_agent(), Arkaq.load(saved)
    env = near_task()
    for seed in range(4):
        observation, _ = env.reset(seed=seed)
        for _ in range(4):
            assert fresh.act(observation) == loaded.act(observation)
            assert np.array_equal(fresh.estimator.kalman.x, loaded.estimator.kalman.x)
            observation, *_ = env.step(0)
