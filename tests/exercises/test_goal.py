"""The checks of the goal problem's exercises: right passes, wrong is told in what way."""

import math
import re

import numpy as np
import pytest

from arkaq_edu import exercises
from arkaq_edu.art import EuclideanART


def kicks_needed(p, q, sigmas):
    n = 1
    while abs(p - q) < sigmas * math.sqrt(p * (1 - p) / n + q * (1 - q) / n):
        n += 1
    return n


def worth(now, then, gamma, cost):
    kick, later = (200 * chance - 100 + cost for chance in (now, then))
    return [kick, cost + gamma * later]


def state_bounds(vigilance, width):
    return width // (2 * vigilance) + 1, width // vigilance + 1


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [
        (exercises.kicks_needed, kicks_needed),
        (exercises.worth, worth),
        (exercises.state_bounds, state_bounds),
    ],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def of_each(variance):
    """An answer in which a kick has another variance, or two of them add up otherwise."""
    return lambda p, q, z: math.ceil(z**2 * variance(p, q) / (p - q) ** 2)


def turning(rule):
    """An answer that is right about the kick at once."""
    return lambda now, then, g, c: [worth(now, then, g, c)[0], rule(now, then, g, c)]


def kicking(rule):
    """An answer that is wrong about a kick, and right otherwise."""
    return lambda now, then, g, c: [rule(now, g, c), c + g * rule(then, 1.0, c)]


def not_written(*_):
    raise NotImplementedError


WRONG = [
    (
        exercises.kicks_needed,
        lambda p, q, z: (z**2 * (p * (1 - p) + q * (1 - q)) / (p - q) ** 2) // 1,
        "you round down",
    ),
    (exercises.kicks_needed, lambda p, q, z: 2 * kicks_needed(p, q, z), "both robots together"),
    (exercises.kicks_needed, of_each(lambda p, q: p * (1 - p)), "only the first robot"),
    (exercises.kicks_needed, of_each(lambda p, q: q * (1 - q)), "only the second robot"),
    (exercises.kicks_needed, of_each(lambda p, q: p + q), "not p$"),
    (
        exercises.kicks_needed,
        of_each(lambda p, q: (math.sqrt(p - p * p) + math.sqrt(q - q * q)) ** 2),
        "add their variances",
    ),
    (
        exercises.kicks_needed,
        lambda p, q, z: math.ceil(z * (p * (1 - p) + q * (1 - q)) / (p - q) ** 2),
        "`sigmas` must be squared",
    ),
    (
        exercises.kicks_needed,
        lambda p, q, z: math.ceil(z**2 * (p * (1 - p) + q * (1 - q)) / abs(p - q)),
        "the difference must be squared",
    ),
    (exercises.kicks_needed, lambda p, q, z: z**2 / (p - q) ** 2, "a number of kicks is whole"),
    (exercises.kicks_needed, lambda p, q, z: kicks_needed(p, q, 2 * z), "0 of 12 tries"),
    (exercises.kicks_needed, not_written, "still empty"),
    (exercises.worth, lambda *case: worth(*case)[::-1], "first the kick, then"),
    (exercises.worth, kicking(lambda p, g, c: 100 * p + c), "not worth 0: it is punished by -100$"),
    (exercises.worth, kicking(lambda p, g, c: 100 * p), "and a kick takes a cycle"),
    (exercises.worth, kicking(lambda p, g, c: 200 * p - 100), "a kick takes a cycle too"),
    (exercises.worth, kicking(lambda p, g, c: 200 * p - 100 - c), "it is added"),
    (exercises.worth, kicking(lambda p, g, c: g * (200 * p - 100 + c)), "what comes at once"),
    (exercises.worth, turning(lambda n, t, g, c: c + worth(t, 0, g, c)[0]), "it is discounted"),
    (exercises.worth, turning(lambda n, t, g, c: g * worth(t, 0, g, c)[0]), "the turn itself"),
    (exercises.worth, turning(lambda n, t, g, c: c + g * worth(t, 0, g, 0)[0]), "a cycle too$"),
    (exercises.worth, turning(lambda n, t, g, c: g * (c + worth(t, 0, g, c)[0])), "due at once"),
    (exercises.worth, turning(lambda n, t, g, c: c + g * worth(n, 0, g, c)[0]), "another chance"),
    (
        exercises.worth,
        turning(lambda n, t, g, c: c + g * worth(max(n, t), 0, g, c)[0]),
        "no choice left",
    ),
    (exercises.worth, lambda n, t, g, c: worth(n, t, g, c)[0], "two numbers: .*not one"),
    (exercises.worth, not_written, "still empty"),
    (exercises.state_bounds, lambda v, w: (w // (2 * v), w // v), "both are one too few"),
    (exercises.state_bounds, lambda v, w: (w // v, 2 * w // v), "a factor of about two"),
    (exercises.state_bounds, lambda v, w: (w // v + 1, 2 * w // v + 1), "a factor of about two"),
    (exercises.state_bounds, lambda v, w: (w // (2 * v) + 1, w // v), "n - 1 gaps"),
    (exercises.state_bounds, lambda v, w: (w // (2 * v), w // v + 1), "to the end of the interval"),
    (exercises.state_bounds, lambda v, w: (w // v + 1, w // v + 1), "the same"),
    (
        exercises.state_bounds,
        lambda v, w: (math.ceil(w / v / 2), math.ceil(w / v)),
        "forget the last center",
    ),
    (exercises.state_bounds, lambda v, w: (w / (2 * v), w / v), "a number of centers is whole"),
    (exercises.state_bounds, lambda v, w: state_bounds(v, w)[::-1], "first the fewest"),
    (exercises.state_bounds, lambda v, w: state_bounds(2 * v, w), "0 of 12 tries"),
    (exercises.state_bounds, not_written, "still empty"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "words"), WRONG)
def test_a_wrong_answer_is_told_in_what_way(exercise, answer, words, seed):
    assert re.search(words, exercise.problem(answer, rng=seed))


@pytest.mark.parametrize("seed", range(5))
def test_the_bounds_hold_for_the_network_and_are_met_by_it(seed):
    rng = np.random.default_rng(seed)
    vigilance, width = rng.uniform(0.05, 0.2), rng.uniform(0.5, 2.0)
    fewest, most = state_bounds(vigilance, width)
    dense = np.linspace(0.0, width, 2000)

    def count(patterns):
        # A rate this small leaves the centers where they were founded.
        return EuclideanART(vigilance, 1e-12).fit(np.reshape(patterns, (-1, 1))).n_clusters_

    assert fewest <= count(rng.permutation(dense)) <= most
    assert count(dense) == most
    spaced = width / fewest * (np.arange(fewest) + 0.5)
    assert count(np.concatenate([spaced, dense])) == fewest


def test_so_many_kicks_leave_the_worse_ahead_as_seldom_as_the_sigmas_say():
    rng = np.random.default_rng(0)
    p, q = 0.6, 0.35
    n = kicks_needed(p, q, 2.0)
    better, worse = rng.binomial(n, [[p], [q]], (2, 50_000))
    # Two sigmas below: .023 of a normal distribution; ties are split.
    behind = (better < worse).mean() + (better == worse).mean() / 2
    assert behind == pytest.approx(0.023, abs=0.004)
