"""The checks of the goal problem's exercises: right passes, wrong is told in what way."""

import math
from statistics import NormalDist

import numpy as np
import pytest

from arkaq_edu.art import EuclideanART
from arkaq_edu.exercises import ExerciseError, check_scoring, check_state_bounds, check_worth


def between(low, high, sigma):
    bearing = NormalDist(0.0, sigma)
    return bearing.cdf(high) - bearing.cdf(low)


def scoring(distance, orientation, sigma):
    half = math.atan2(400, distance)
    return between(orientation - half, orientation + half, sigma)


def worth(now, then, gamma, cost):
    kick, later = (200 * chance - 100 + cost for chance in (now, then))
    return [kick, cost + gamma * later]


def state_bounds(vigilance, width):
    return math.ceil(width / vigilance / 2), math.ceil(width / vigilance)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("check", "answer"),
    [(check_scoring, scoring), (check_worth, worth), (check_state_bounds, state_bounds)],
)
def test_a_right_answer_is_praised(check, answer, seed):
    assert check(answer, rng=seed).startswith("Right")


def within(half, measure=lambda sigma: sigma):
    return lambda d, o, s: between(o - half(d), o + half(d), measure(s))


def angle(d):
    return math.atan(400 / d)


def turning(rule):
    """An answer that is right about the kick at once."""
    return lambda now, then, g, c: [worth(now, then, g, c)[0], rule(now, then, g, c)]


def kicking(rule):
    """An answer that is wrong about a kick, and right otherwise."""
    return lambda now, then, g, c: [rule(now, g, c), c + g * rule(then, 1.0, c)]


def not_written(*_):
    raise NotImplementedError


WRONG = [
    (check_scoring, lambda d, o, s: scoring(d, 0.0, s), "where does the orientation"),
    (check_scoring, within(lambda d: math.atan(800 / d)), "twice too wide"),
    (check_scoring, within(lambda d: math.atan(200 / d)), "half too narrow"),
    (check_scoring, within(lambda d: 400 / d), "the tangent"),
    (check_scoring, lambda d, o, s: NormalDist(0, s).cdf(o + angle(d)), "left post"),
    (check_scoring, lambda d, o, s: NormalDist(0, s).cdf(o - angle(d)), "right post: these"),
    (check_scoring, lambda d, o, s: 1 - scoring(d, o, s), "of a miss"),
    (check_scoring, within(angle, lambda s: s * s), "the variance"),
    (check_scoring, within(angle, lambda s: 1.0), "sigma does not come in"),
    (check_scoring, within(lambda d: math.degrees(angle(d))), "always 1: do degrees"),
    (check_scoring, lambda d, o, s: 100 * scoring(d, o, s), "per cent"),
    (check_scoring, lambda d, o, s: 0.5, "what is given$"),
    (check_scoring, lambda d, o, s: scoring(d, o, 2 * s), "0 of 12 tries"),
    (check_scoring, lambda d, o, s: [scoring(d, o, s)], r"shape \(\), not \(1,\)"),
    (check_scoring, not_written, "still empty"),
    (check_worth, lambda *case: worth(*case)[::-1], "the turn second"),
    (check_worth, kicking(lambda p, g, c: 100 * p + c), "not worth 0: it is punished by -100$"),
    (check_worth, kicking(lambda p, g, c: 100 * p), "and a kick takes a cycle"),
    (check_worth, kicking(lambda p, g, c: 200 * p - 100), "a kick takes a cycle too"),
    (check_worth, kicking(lambda p, g, c: 200 * p - 100 - c), "it is added"),
    (check_worth, kicking(lambda p, g, c: g * (200 * p - 100 + c)), "what comes at once"),
    (check_worth, turning(lambda n, t, g, c: c + worth(t, 0, g, c)[0]), "it is discounted"),
    (check_worth, turning(lambda n, t, g, c: g * worth(t, 0, g, c)[0]), "the turn itself"),
    (check_worth, turning(lambda n, t, g, c: c + g * worth(t, 0, g, 0)[0]), "a cycle too$"),
    (check_worth, turning(lambda n, t, g, c: g * (c + worth(t, 0, g, c)[0])), "due at once"),
    (check_worth, turning(lambda n, t, g, c: c + g * worth(n, 0, g, c)[0]), "another chance"),
    (
        check_worth,
        turning(lambda n, t, g, c: c + g * worth(max(n, t), 0, g, c)[0]),
        "no choice left",
    ),
    (check_worth, lambda n, t, g, c: worth(n, t, g, c)[0], r"shape \(2,\), not \(\)"),
    (check_worth, not_written, "still empty"),
    (check_state_bounds, lambda v, w: (w // (2 * v), w // v), "both are one too few"),
    (check_state_bounds, lambda v, w: (w // v, 2 * w // v), "a factor of two"),
    (check_state_bounds, lambda v, w: (w // v + 1, 2 * w // v + 1), "a factor of two"),
    (check_state_bounds, lambda v, w: (w // (2 * v) + 1, w // v), "n - 1 gaps"),
    (check_state_bounds, lambda v, w: (w // (2 * v), w // v + 1), "to the end of the interval"),
    (check_state_bounds, lambda v, w: (w // v + 1, w // v + 1), "the same"),
    (check_state_bounds, lambda v, w: (w / (2 * v), w / v), "centres are whole"),
    (check_state_bounds, lambda v, w: state_bounds(v, w)[::-1], "the fewest come first"),
    (check_state_bounds, lambda v, w: state_bounds(2 * v, w), "0 of 12 tries"),
    (check_state_bounds, not_written, "still empty"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("check", "answer", "words"), WRONG)
def test_a_wrong_answer_is_told_in_what_way(check, answer, words, seed):
    with pytest.raises(ExerciseError, match=words):
        check(answer, rng=seed)


@pytest.mark.parametrize("seed", range(5))
def test_the_bounds_hold_for_the_network_and_are_met_by_it(seed):
    rng = np.random.default_rng(seed)
    vigilance, width = rng.uniform(0.05, 0.2), rng.uniform(0.5, 2.0)
    fewest, most = state_bounds(vigilance, width)
    dense = np.linspace(0.0, width, 2000)

    def count(patterns):
        # A rate this small leaves the centres where they were founded.
        return EuclideanART(vigilance, 1e-12).fit(np.reshape(patterns, (-1, 1))).n_clusters_

    assert fewest <= count(rng.permutation(dense)) <= most
    assert count(dense) == most
    spaced = width / fewest * (np.arange(fewest) + 0.5)
    assert count(np.concatenate([spaced, dense])) == fewest


def test_kicks_drawn_at_random_score_as_often_as_the_formula_says():
    rng = np.random.default_rng(0)
    distance, orientation, sigma = 1850.0, 0.2, 0.25
    bearing = -orientation + sigma * rng.standard_normal(100_000)  # from straight at the line
    share = (np.abs(distance * np.tan(bearing)) < 400).mean()
    assert share == pytest.approx(scoring(distance, orientation, sigma), abs=0.006)
