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
        ({"range_noise": np.nan}, "range_noise"),
        ({"range_noise": "1"}, "range_noise"),
        ({"range_noise": 1e99}, "range_noise"),
        ({"low": (200.0, np.nan)}, "low"),
        ({"low": ("200", "-1")}, "low"),
        ({"high": (4100.0, 1e308)}, "high"),
        ({"high": np.ma.masked_equal([4100.0, 0.5], 0.5)}, "high"),
        ({"low": (), "high": ()}, "high must be above low"),
        ({"A": [[1.0]], "H": [[1.0], [1.0]]}, "A must have a state for each of 2"),
        ({"A": np.full((2, 2), np.nan)}, "A must hold finite numbers"),
        ({"H": [[1.0, 0.0]]}, r"H must have shape \(2, 2\)"),
        ({"B": [[np.nan] * 3] * 2}, "B must hold finite numbers"),
        ({"P0": [[1e308, 0.0], [0.0, 1.0]]}, "P0"),
        ({"P0": np.ma.masked_equal([[9.0, 0.0], [0.0, 1.0]], 9.0)}, "P0"),
    ],
)
def test_bad_settings_are_refused(change, words):
    good = vars(Sensing.consistent())
    with pytest.raises(ValueError, match=words):
        Sensing(**good | change)


def test_settings_are_copied_and_cannot_be_edited():
    low, B = [200.0, -0.5], [[-96.0, -96.0, -96.0], [0.0, -0.1, 0.1]]
    A = np.eye(2)
    sensing = Sensing(**vars(Sensing.consistent()) | {"low": low, "A": A, "B": B})
    low[0], A[0, 0], B[0][0] = 0.0, 5.0, 5.0
    assert sensing == Sensing.consistent() and sensing.low == (200.0, -0.5)
    for array in (sensing.A, sensing.H, sensing.Q, sensing.R, sensing.P0, sensing.B):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1.0


@pytest.mark.parametrize(
    "z", [[np.nan, 0.0], [np.inf, 0.0], ["1", "2"], [1.0], 1.0, None, [[1, 2], [3]]]
)
def test_what_is_no_measurement_is_refused_by_name(z):
    with pytest.raises(ValueError, match=r"^z must"):
        Sensing.consistent().scale(z)
    with pytest.raises(ValueError, match=r"^z must"):
        Sensing.consistent().noise(z)
    with pytest.raises(ValueError, match=r"^patterns must"):
        Sensing.consistent().unscale(z)


def test_a_distance_whose_noise_would_overflow_is_refused():
    with pytest.raises(ValueError, match=r"z\[0\] must be a number in \[-1e\+20, 1e\+20\]"):
        Sensing.consistent().noise([1e30, 0.0])


LOOK = [2000.0, 0.1, 1.0]


@pytest.mark.parametrize(
    "look", [LOOK, tuple(LOOK), np.float32(LOOK), np.array(LOOK)[::1], np.array(LOOK, ">f8")]
)
@pytest.mark.parametrize("action", [1, np.int64(1), np.array(1), np.array([1])])
def test_looks_are_lists_too_and_actions_arrays_of_one(look, action):
    senses, expected = Estimator(Sensing.consistent()), Estimator(Sensing.consistent())
    for k in (None, 1):
        pattern = senses.observe(look, k and action)
        assert pattern == pytest.approx(expected.observe(np.array(LOOK), k), abs=1e-6)
    assert list(look) == pytest.approx(LOOK)


@pytest.mark.parametrize(
    ("look", "action", "words"),
    [
        ([2000.0, 0.1], 0, r"observation must have shape \(3,\)"),
        ([np.nan, 0.1, 1.0], 0, "observation must hold finite"),
        (np.ma.masked_equal(LOOK, 0.1), 0, "observation must hold finite"),
        (["2000", "0", "1"], 0, "observation must be an array of numbers"),
        (None, 0, "observation must"),
        ([1e30, 0.1, 1.0], 0, r"z\[0\] must be"),
        (LOOK, -1, r"action must be an integer in \[0, 2\], got -1"),
        (LOOK, 3, r"action must be an integer in \[0, 2\], got 3"),
        (LOOK, 1.0, "action must be an integer"),
        (LOOK, "1", "action must be an integer"),
    ],
)
def test_a_bad_look_or_action_is_refused_by_name_and_changes_nothing(look, action, words):
    senses = Estimator(Sensing.consistent())
    senses.observe(LOOK, None)
    x, P = senses.kalman.x, senses.kalman.P
    with pytest.raises(ValueError, match=words):
        senses.observe(look, action)
    assert np.array_equal(senses.kalman.x, x) and np.array_equal(senses.kalman.P, P)


def test_a_filter_that_does_not_know_the_actions_takes_any():
    senses = Estimator(Sensing.thesis())
    senses.observe(LOOK, None)
    senses.observe(LOOK, 7)
    with pytest.raises(ValueError, match="action must be an integer >= 0, got -1"):
        senses.observe(LOOK, -1)


def test_a_noise_of_its_own_is_refused_rather_than_ignored():
    with pytest.raises(TypeError, match="no subclasses"):
        type("Other", (Sensing,), {"noise": lambda self, z: np.eye(2)})


@pytest.mark.parametrize("sensing", [None, {}, "consistent"])
def test_an_estimator_of_no_sensing_is_refused(sensing):
    with pytest.raises(ValueError, match="sensing must be of the class Sensing"):
        Estimator(sensing)


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
