"""Checks for the notebook on scoring goals: states on a line, what a turn is worth, and luck."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, judge, numbers

Rng = np.random.Generator | int | None


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
        and the most centers that do not move.
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
    arkaq_edu.exercises._ask.ExerciseError: both are off by a factor of two or so: a center \
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
            raise ExerciseError(f"centers are whole: {found.max():.4g} of them cannot be")
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
        "both are off by a factor of two or so: a center reaches one vigilance to the left and one "
        "to the right, and no other may stand within",
    ),
    (
        lambda v, w: np.array([floor(w / v) + 1, floor(2 * w / v) + 1], dtype=float),
        "both are off by a factor of two or so: a center reaches one vigilance to the left and one "
        "to the right, and no other may stand within",
    ),
    (
        lambda v, w: np.array([floor(w / (2 * v)) + 1, floor(w / v)], dtype=float),
        "your most are one too few: of n centers there are n - 1 gaps between",
    ),
    (
        lambda v, w: np.array([floor(w / (2 * v)), floor(w / v) + 1], dtype=float),
        "your fewest are one too few: they must reach every pattern, to the end of the interval",
    ),
    (
        lambda v, w: np.array([floor(w / v) + 1, floor(w / v) + 1], dtype=float),
        "your two bounds are the same: can centers not stand farther apart than one vigilance?",
    ),
]


def check_kicks_needed(kicks_needed: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``kicks_needed(p, q, sigmas)``: kicks until two shares can be told apart.

    Parameters
    ----------
    kicks_needed : callable
        Takes the chances with which two robots score, and how many standard errors are to lie
        between their shares; returns the smallest number of kicks, of each of them, that does.
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
    Thesis, section 5.3.2, figures 5.40 and 5.41.

    Examples
    --------
    >>> check_kicks_needed(lambda p, q, sigmas: 29.4)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: kicks are whole, 29.4 of them cannot be: how many are \
enough?
    """
    rng = np.random.default_rng(rng)
    cases = [(0.6, 0.35, 2.0)]
    while len(cases) < 12:
        p, q, sigmas = rng.uniform(0.05, 0.95), rng.uniform(0.05, 0.95), rng.uniform(1.5, 3.5)
        # Where the whole numbers above and below are far apart in what they say.
        if abs(p - q) > 0.05 and 0.1 < _enough(p, q, sigmas) % 1 < 0.9:
            cases.append((p, q, sigmas))
    for case in cases:
        found = float(numbers("kicks_needed", ask(kicks_needed, *case), ()))
        if found != round(found):
            raise ExerciseError(
                f"kicks are whole, {found:.4g} of them cannot be: how many are enough?"
            )
    judge("kicks_needed", kicks_needed, cases, _kicks_needed, WRONG_KICKS_NEEDED)
    return "Right: what is twice as near takes four times as many kicks to tell apart."


def _enough(p: float, q: float, sigmas: float) -> float:
    return sigmas**2 * (p * (1 - p) + q * (1 - q)) / (p - q) ** 2


def _kicks_needed(p: float, q: float, sigmas: float) -> int:
    return ceil(_enough(p, q, sigmas))


WRONG_KICKS_NEEDED: list[Rule] = [
    (
        lambda p, q, sigmas: floor(_enough(p, q, sigmas)),
        "you round down: that many are not quite enough",
    ),
    (
        lambda p, q, sigmas: 2 * _kicks_needed(p, q, sigmas),
        "that is the kicks of both robots together: each needs half of them",
    ),
    (
        lambda p, q, sigmas: ceil(sigmas**2 * p * (1 - p) / (p - q) ** 2),
        "only the first robot has luck in your formula: both have",
    ),
    (
        lambda p, q, sigmas: ceil(sigmas**2 * q * (1 - q) / (p - q) ** 2),
        "only the second robot has luck in your formula: both have",
    ),
    (
        lambda p, q, sigmas: ceil(_enough(p, q, sigmas) / sigmas),
        "the standard error falls with the root of n: so the number of them comes in squared",
    ),
    (
        lambda p, q, sigmas: ceil(_enough(p, q, sigmas) * abs(p - q)),
        "the standard error falls with the root of n: so the difference comes in squared",
    ),
    (
        lambda p, q, sigmas: ceil(
            sigmas**2 * (np.sqrt(p * (1 - p)) + np.sqrt(q * (1 - q))) ** 2 / (p - q) ** 2
        ),
        "you add standard errors: of two that are independent the variances are added",
    ),
    (
        lambda p, q, sigmas: ceil(sigmas**2 * (p + q) / (p - q) ** 2),
        "the variance of one kick, which scores or does not, is p (1 - p), not p",
    ),
]
