"""Checks for the notebook on scoring goals: how likely a kick scores, and what a turn is worth."""

from __future__ import annotations

from collections.abc import Callable
from math import atan, floor
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from ._ask import ExerciseError, Rule, ask, judge, numbers

Rng = np.random.Generator | int | None

_HALF = 400.0  # of the goal (mm)


def check_scoring(scoring: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``scoring(distance, orientation, sigma)``: the chance that a kick scores.

    Parameters
    ----------
    scoring : callable
        Takes how far before the middle of an 800 mm goal the robot stands (mm), the goal's
        orientation (rad) and the standard deviation of the kick's bearing (rad).
    rng : numpy.random.Generator or int, optional
        Where the random kicks come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 5.3.

    Examples
    --------
    >>> check_scoring(lambda distance, orientation, sigma: 0.6)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: the answer does not change with what is given
    """
    rng = np.random.default_rng(rng)
    cases = [
        (rng.uniform(900, 3000), side * rng.uniform(0.1, 0.3), rng.uniform(0.15, 0.4))
        for side in (1, -1) * 6
    ]
    answers = [float(numbers("scoring", ask(scoring, *case), ())) for case in cases]
    if np.ptp(answers) < 1e-9:
        why = ", it is always 1: do degrees meet radians?" if np.isclose(answers[0], 1) else ""
        raise ExerciseError("the answer does not change with what is given" + why)
    judge("scoring", scoring, cases, _scoring, WRONG_SCORING)
    return "Right: the goal is an interval of bearings, and the kick fills part of it."


def _between(low: float, high: float, sigma: float) -> float:
    return float(norm.cdf(high / sigma) - norm.cdf(low / sigma))


def _scoring(distance: float, orientation: float, sigma: float) -> float:
    half = atan(_HALF / distance)
    return _between(orientation - half, orientation + half, sigma)


# What is often done instead, and what to say of it.
WRONG_SCORING: list[Rule] = [
    (
        lambda d, o, s: _between(-atan(_HALF / d), atan(_HALF / d), s),
        "your robot always looks straight at the goal: where does the orientation come in?",
    ),
    (
        lambda d, o, s: _between(o - atan(2 * _HALF / d), o + atan(2 * _HALF / d), s),
        "your goal is twice too wide: its posts stand 400 mm to either side of its middle",
    ),
    (
        lambda d, o, s: _between(o - atan(_HALF / 2 / d), o + atan(_HALF / 2 / d), s),
        "your goal is half too narrow: its posts stand 400 mm to either side of its middle",
    ),
    (
        lambda d, o, s: _between(o - _HALF / d, o + _HALF / d, s),
        "400 / distance is the tangent of the angle from the middle to a post, not the angle",
    ),
    (
        lambda d, o, s: float(norm.cdf((o + atan(_HALF / d)) / s)),
        "you count every ball to the right of the left post: those right of the right post miss",
    ),
    (
        lambda d, o, s: float(norm.cdf((o - atan(_HALF / d)) / s)),
        "you count the balls to the right of the right post: these miss",
    ),
    (
        lambda d, o, s: 1 - _scoring(d, o, s),
        "that is the chance of a miss",
    ),
    (
        lambda d, o, s: _between(o - atan(_HALF / d), o + atan(_HALF / d), s**2),
        "you divide by the variance: an angle is counted in standard deviations",
    ),
    (
        lambda d, o, s: _between(o - atan(_HALF / d), o + atan(_HALF / d), 1.0),
        "the kick's sigma does not come in: how many sigmas away is each post?",
    ),
    (
        lambda d, o, s: 100 * _scoring(d, o, s),
        "a chance lies between 0 and 1: yours is in per cent",
    ),
]


def check_worth(worth: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``worth(now, then, gamma, cost)``: of a kick, and of a turn and a kick.

    Parameters
    ----------
    worth : callable
        Takes the chance that a kick scores now, that it scores after a turn, the discount and
        what each cycle is worth besides; returns what it is worth to kick at once, and to turn
        and then kick.
    rng : numpy.random.Generator or int, optional
        Where the random chances come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 5.3 (+100 for a goal, -100 for a miss) and equation 2.12.

    Examples
    --------
    >>> check_worth(lambda now, then, gamma, cost: [100 * now + cost, gamma * 100 * then])
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: a miss is not worth 0: it is punished by -100
    """
    rng = np.random.default_rng(rng)
    cases = [
        (rng.uniform(), rng.uniform(), rng.uniform(0.8, 0.99), -rng.uniform(1, 9))
        for _ in range(12)
    ]
    for case in cases:
        numbers("worth", ask(worth, *case), (2,))
    judge("worth", lambda *case: worth(*case)[0], cases, lambda *case: _worth(*case)[0], WRONG_KICK)
    judge("worth", worth, cases, _worth, WRONG_TURN)
    return "Right: a turn pays when it gains more than the cycle costs and the wait takes away."


def _kick(chance: float, cost: float) -> float:
    return 100 * chance - 100 * (1 - chance) + cost


def _worth(now: float, then: float, gamma: float, cost: float) -> NDArray[np.float64]:
    return np.array([_kick(now, cost), cost + gamma * _kick(then, cost)])


WRONG_KICK: list[Rule] = [
    (
        lambda now, then, gamma, cost: _worth(now, then, gamma, cost)[1],
        "what you return first should be the kick at once, and the turn second",
    ),
    (
        lambda now, then, gamma, cost: 100 * now + cost,
        "a miss is not worth 0: it is punished by -100",
    ),
    (
        lambda now, then, gamma, cost: 100 * now,
        "a miss is not worth 0: it is punished by -100; and a kick takes a cycle, at its cost",
    ),
    (
        lambda now, then, gamma, cost: _kick(now, 0.0),
        "a kick takes a cycle too: it has its cost",
    ),
    (
        lambda now, then, gamma, cost: _kick(now, -cost),
        "the cost is given as a negative number: it is added",
    ),
    (
        lambda now, then, gamma, cost: gamma * _kick(now, cost),
        "what comes at once is not discounted: gamma weighs what comes a cycle later",
    ),
]

WRONG_TURN: list[Rule] = [
    (
        lambda now, then, gamma, cost: _worth(now, then, 1.0, cost),
        "what comes after the turn comes a cycle later: it is discounted",
    ),
    (
        lambda now, then, gamma, cost: _worth(now, then, gamma, cost) - [0.0, cost],
        "the turn itself takes a cycle, which has its cost",
    ),
    (
        lambda now, then, gamma, cost: _worth(now, then, gamma, cost) - [0.0, gamma * cost],
        "after the turn comes a kick, which takes a cycle too",
    ),
    (
        lambda now, then, gamma, cost: _worth(now, then, gamma, cost) - [0.0, cost - gamma * cost],
        "the turn's own cost is due at once: it is not discounted",
    ),
    (
        lambda now, then, gamma, cost: _worth(now, now, gamma, cost),
        "after the turn the kick has another chance: the second one that you are given",
    ),
    (
        lambda now, then, gamma, cost: _worth(now, max(now, then), gamma, cost),
        "after the turn there is no choice left: it kicks, with the second chance",
    ),
]


def check_state_bounds(state_bounds: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``state_bounds(vigilance, width)``: how many states there can be.

    Parameters
    ----------
    state_bounds : callable
        Takes a vigilance and the width of the interval that patterns fill; returns the fewest
        and the most centres that do not move.
    rng : numpy.random.Generator or int, optional
        Where the random intervals come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, sections 4.2.2 and 5.3.1.

    Examples
    --------
    >>> check_state_bounds(lambda vigilance, width: [width // vigilance, 2 * width // vigilance])
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: both are off by a factor of two or so: a centre \
reaches one vigilance to the left and one to the right, and no other may stand within
    """
    rng = np.random.default_rng(rng)
    cases: list[tuple[float, float]] = []
    while len(cases) < 12:
        vigilance, width = rng.uniform(0.03, 0.15), rng.uniform(0.8, 2.0)
        # Far from where a rounding error, or a tie, would decide.
        if all(0.1 < width / vigilance / k % 1 < 0.9 for k in (1, 2)):
            cases.append((vigilance, width))
    for case in cases:
        found = numbers("state_bounds", ask(state_bounds, *case), (2,))
        if (found != found.round()).any():
            raise ExerciseError(f"centres are whole: {found.max():.4g} of them cannot be")
        if found[0] > found[1]:
            raise ExerciseError("your fewest are more than your most: the fewest come first")
    judge("state_bounds", state_bounds, cases, _state_bounds, WRONG_STATE_BOUNDS)
    return "Right: the order of the patterns may double the states, and no more than double them."


def _state_bounds(vigilance: float, width: float) -> NDArray[np.float64]:
    return np.array([floor(width / (2 * vigilance)) + 1.0, floor(width / vigilance) + 1.0])


WRONG_STATE_BOUNDS: list[Rule] = [
    (
        lambda v, w: np.array([floor(w / (2 * v)), floor(w / v)], dtype=float),
        "both are one too few: try an interval shorter than the vigilance",
    ),
    (
        lambda v, w: np.array([floor(w / v), floor(2 * w / v)], dtype=float),
        "both are off by a factor of two or so: a centre reaches one vigilance to the left and one "
        "to the right, and no other may stand within",
    ),
    (
        lambda v, w: np.array([floor(w / v) + 1, floor(2 * w / v) + 1], dtype=float),
        "both are off by a factor of two or so: a centre reaches one vigilance to the left and one "
        "to the right, and no other may stand within",
    ),
    (
        lambda v, w: np.array([floor(w / (2 * v)) + 1, floor(w / v)], dtype=float),
        "your most are one too few: of n centres there are n - 1 gaps between",
    ),
    (
        lambda v, w: np.array([floor(w / (2 * v)), floor(w / v) + 1], dtype=float),
        "your fewest are one too few: they must reach every pattern, to the end of the interval",
    ),
    (
        lambda v, w: np.array([floor(w / v) + 1, floor(w / v) + 1], dtype=float),
        "your two bounds are the same: can centres not stand farther apart than one vigilance?",
    ),
]
