"""Beliefs along a history, and how well their claims are kept."""

import numpy as np
import pytest

from arkaq_edu.pomdp import (
    belief_update,
    calibration,
    entropy,
    predict,
    problem,
    successors,
    trajectory,
)


def test_claims_are_sorted_and_counted():
    claims = [[0.5, 0.55, 0.8, 0.9], [0.95, 0.95, 0.85, 0.99]]
    true = [[True, False, True, False], [True, True, False, True]]
    claimed, held = calibration(claims, true, edges=[0.6, 0.8, 0.9])
    assert claimed == pytest.approx([0.525, (0.8 + 0.85) / 2, (0.9 + 0.95 + 0.95 + 0.99) / 4])
    np.testing.assert_array_equal(held, [[0.5, 1, 0], [np.nan, 0, 1]])


def test_where_nothing_was_claimed_there_is_no_bin():
    assert calibration([[0.5]], [[True]], edges=[0.1, 0.2, 0.9, 0.95]).claimed.tolist() == [0.5]


def test_a_belief_with_the_right_model_keeps_its_word():
    pomdp, look, rng = problem("ball_side"), 0, np.random.default_rng(1)
    claims, true = np.empty((20, 300)), np.empty((20, 300))
    for seed in range(20):
        state, b = rng.integers(0, 2), pomdp.start
        for k in range(300):
            state = rng.choice(2, p=pomdp.T[look, state])
            b = belief_update(pomdp, b, look, rng.choice(3, p=pomdp.O[look, state]))
            claims[seed, k], true[seed, k] = b[0], state == 0
    claimed, held = calibration(claims, true, edges=[0.1, 0.3, 0.7, 0.9])
    assert len(claimed) == 5
    error = held.std(axis=0) / np.sqrt(20)
    assert (np.abs(held.mean(axis=0) - claimed) < 4 * error + 0.01).all()


@pytest.mark.parametrize(
    ("claims", "true", "message"),
    [
        ([[0.5, 1.5]], [[1, 0]], "claims must be probabilities"),
        ([[0.5]], [[1, 0]], "true must have shape"),
        ([0.5], [1], "claims must have shape"),
    ],
)
def test_what_are_no_claims_is_refused(claims, true, message):
    with pytest.raises(ValueError, match=message):
        calibration(claims, true, edges=[0.5])


def test_a_trajectory_predicts_and_corrects():
    pomdp = problem("three_places")
    beliefs, steps, pending = trajectory(pomdp, ["look", "seen-left", "look"])
    corrected = belief_update(pomdp, pomdp.start, 0, 0)
    by_hand = [pomdp.start, predict(pomdp, pomdp.start, 0), corrected, predict(pomdp, corrected, 0)]
    assert np.array(beliefs) == pytest.approx(np.array(by_hand))
    assert (steps, pending) == ([(0, 0)], 0)


def test_observations_are_drawn_by_the_seed_and_with_the_chances_of_the_belief():
    pomdp = problem("ball_side")
    history = ["look", None] * 3
    assert trajectory(pomdp, history, 3).steps == trajectory(pomdp, history, 3).steps
    drawn = [trajectory(pomdp, history, seed).steps for seed in range(1500)]
    assert len(set(map(tuple, drawn))) > 20
    shares = np.bincount([steps[0][1] for steps in drawn], minlength=3) / len(drawn)
    assert shares == pytest.approx(successors(pomdp, pomdp.start, 0).chances, abs=0.04)
    after_left = [steps[1][1] for steps in drawn if steps[0][1] == 0]
    after = belief_update(pomdp, pomdp.start, 0, 0)
    shares = np.bincount(after_left, minlength=3) / len(after_left)
    assert shares == pytest.approx(successors(pomdp, after, 0).chances, abs=0.06)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None])
def test_a_seed_of_a_trajectory_is_a_number(seed):
    with pytest.raises(ValueError, match="seed must be an integer >= 0"):
        trajectory(problem("tiger"), ["listen", None], seed)


def test_the_entropy_of_what_is_no_belief_is_refused():
    for b in ([0.5, 0.6], [1.5, -0.5], [np.nan], [[0.5, 0.5]], []):
        with pytest.raises(ValueError, match="b must"):
            entropy(b)


@pytest.mark.parametrize(
    ("b", "bits"), [([1, 0, 0], 0), ([0.5, 0.5, 0], 1), ([0.25] * 4, 2), ([0.9, 0.1], 0.468996)]
)
def test_the_entropy_is_shannons(b, bits):
    assert entropy(b) == pytest.approx(bits, abs=1e-6)
