"""The Kalman filter's settings, and the patterns that come out of it."""

import json

import gymnasium
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu.arkaq import Estimator, Sensing
from tests.arkaq.brief import SENSINGS, TASK


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


def test_settings_are_equal_by_value():
    assert Sensing.thesis() == Sensing.thesis() != Sensing.consistent()
    assert hash(Sensing.thesis()) == hash(Sensing.thesis())
    assert Sensing.from_json(Sensing.consistent().to_json()) == Sensing.consistent()
