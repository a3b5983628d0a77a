"""Exercises of chapter 11: states on a line, what a turn is worth, and luck."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from arkaq_edu.exercises.exercise import ExerciseError, Part, ask, exercise


def _whole(things: str) -> Callable[..., Any]:
    """Return an `answer` that refuses numbers with a fraction."""

    def answer(function: Callable[..., Any], *case: Any) -> Any:
        found = ask(function, *case)
        value = np.asarray(found)
        if value.dtype.kind == "f" and (value % 1 != 0).any():
            fraction = value[value % 1 != 0].flat[0]
            raise ExerciseError(f"a number of {things} is whole, and {fraction:.4g} is not")
        return found

    return answer


def _kick(chance: float, cost: float) -> float:
    return 200 * chance - 100 + cost


def _chances(rng: np.random.Generator) -> list[tuple[float, ...]]:
    draws = rng.uniform([0, 0, 0.8, -9], [1, 1, 0.99, -1], (12, 4)).tolist()
    return [tuple(draw) for draw in draws]


@exercise(
    "Right: a turn pays when it gains more than the cycle costs and the wait takes away.",
    "A kick scores or misses. What is it worth on average, with its cost?",
    "It is worth 100 * now - 100 * (1 - now) + cost.",
    "The turn costs a cycle, then comes a kick a cycle later: cost + gamma * (that kick).",
    points=3,
    returns=("kick", "turn"),
    cases=_chances,
    of="kick",
    wrong={
        "worth(now, then, gamma, cost)[1]": "return the kick at once first, and the turn second",
        "100 * now + cost": "a miss is not worth 0: it is punished by -100",
        "100 * now": "a miss is not worth 0: it is punished by -100; and a kick takes a cycle, so "
        "add cost",
        "_kick(now, 0.0)": "a kick takes a cycle too: it has its cost",
        "_kick(now, -cost)": "the cost is given as a negative number: it is added",
        "gamma * _kick(now, cost)": "what comes at once is not discounted: only what comes later "
        "is",
    },
    then=(
        Part(
            of="turn",
            wrong={
                "cost + _kick(then, cost)": "what follows the turn comes a cycle later: it is "
                "discounted",
                "gamma * _kick(then, cost)": "the turn itself takes a cycle, at its cost",
                "cost + gamma * _kick(then, 0.0)": "the kick after the turn takes a cycle too",
                "gamma * (cost + _kick(then, cost))": "the turn's cost is due at once: not "
                "discounted",
                "cost + gamma * _kick(now, cost)": "after the turn the kick has another chance: "
                "the second one that you are given",
                "cost + gamma * _kick(max(now, then), cost)": "after the turn there is no choice "
                "left: it kicks, with the second chance",
            },
        ),
    ),
)
def worth(now, then, gamma, cost):
    """Return the worth of kicking at once, and of turning and then kicking.

    Thesis, section 5.3 (+100 for a goal, -100 for a miss) and equation 2.12.
    """
    kick_now = 100 * now - 100 * (1 - now) + cost
    kick_then = 100 * then - 100 * (1 - then) + cost
    return kick_now, cost + gamma * kick_then


def _intervals(rng: np.random.Generator) -> list[tuple[float, ...]]:
    """Draw intervals where neither a rounding error nor a tie would decide."""
    cases: list[tuple[float, ...]] = []
    while len(cases) < 12:
        vigilance, width = rng.uniform([0.03, 0.8], [0.15, 2.0])
        if all(0.1 < width / vigilance / k % 1 < 0.9 for k in (1, 2)):
            cases.append((vigilance, width))
    return cases


def _tell_bounds(found, wanted, vigilance, width):
    if found[0] > found[1]:
        return "your fewest are more than your most: the fewest come first"
    return None


@exercise(
    "Right: the order of the patterns may double the states, and no more than double them.",
    "How close can two centers be? And how far apart, with no room for another between?",
    "Most: gaps of one vigilance. Fewest: each center reaches one vigilance to both sides.",
    "Count the gaps that fit whole, of one or of two vigilances, and add 1 for the last center.",
    points=3,
    returns=("fewest", "most"),
    cases=_intervals,
    answer=_whole("centers"),
    wrong={
        "(width // (2 * vigilance), width // vigilance)": "both are one too few: try an interval "
        "shorter than the vigilance",
        "(width // vigilance, 2 * width // vigilance)": "both are off by a factor of about two: a "
        "center reaches one vigilance to the left and one to the right, and no other may be "
        "within",
        "(width // vigilance + 1, 2 * width // vigilance + 1)": "both are off by a factor of about "
        "two: a center reaches one vigilance to the left and one to the right, and no other may "
        "be within",
        "(width // (2 * vigilance) + 1, width // vigilance)": "your most are one too few: between "
        "n centers there are n - 1 gaps",
        "(width // (2 * vigilance), width // vigilance + 1)": "your fewest are one too few: they "
        "must reach every pattern, to the end of the interval",
        "(width // vigilance + 1, width // vigilance + 1)": "your two bounds are the same: can "
        "centers not be farther apart than one vigilance?",
    },
    tell=_tell_bounds,
)
def state_bounds(vigilance, width):
    """Return the fewest and the most centers that can be founded.

    Thesis, sections 4.2.2 and 5.3.1.
    """
    fewest = int(width / (2 * vigilance)) + 1
    most = int(width / vigilance) + 1
    return fewest, most


def _enough(p: float, q: float, sigmas: float) -> float:
    return sigmas**2 * (p * (1 - p) + q * (1 - q)) / (p - q) ** 2


def _robots(rng: np.random.Generator) -> list[tuple[float, ...]]:
    """Draw chances for which rounding up and rounding down differ clearly."""
    cases: list[tuple[float, ...]] = [(0.6, 0.35, 2.0)]
    while len(cases) < 12:
        p, q, sigmas = rng.uniform([0.05, 0.05, 1.5], [0.95, 0.95, 3.5])
        if abs(p - q) > 0.05 and 0.1 < _enough(p, q, sigmas) % 1 < 0.9:
            cases.append((p, q, sigmas))
    return cases


@exercise(
    "Right: half the difference takes four times as many kicks to tell apart.",
    "How large is the standard error of the difference, after n kicks of each robot?",
    "Its square is (p * (1 - p) + q * (1 - q)) / n: the variances are added.",
    "Set sigmas times that standard error equal to |p - q|, solve for n, and round up.",
    points=3,
    cases=_robots,
    answer=_whole("kicks"),
    wrong={
        "np.floor(_enough(p, q, sigmas))": "you round down: that many are not quite enough",
        "2 * kicks_needed(p, q, sigmas)": "those are the kicks of both robots together: halve it",
        "np.ceil(sigmas**2 * p * (1 - p) / (p - q)**2)": "only the first robot varies: both do",
        "np.ceil(sigmas**2 * q * (1 - q) / (p - q)**2)": "only the second robot varies: both do",
        "np.ceil(_enough(p, q, sigmas) / sigmas)": "the error falls with the root of n: `sigmas` "
        "must be squared",
        "np.ceil(_enough(p, q, sigmas) * abs(p - q))": "the error falls with the root of n: the "
        "difference must be squared",
        "np.ceil(sigmas**2 * (np.sqrt(p * (1 - p)) + np.sqrt(q * (1 - q)))**2 / "
        "(p - q)**2)": "you add standard errors: if two are independent, add their variances",
        "np.ceil(sigmas**2 * (p + q) / (p - q)**2)": "the variance of one kick, which scores or "
        "does not, is p (1 - p), not p",
    },
)
def kicks_needed(p, q, sigmas):
    """Return the smallest number of kicks, of each, that tells two shares apart.

    Thesis, section 5.3.2, figures 5.40 and 5.41.
    """
    variance = p * (1 - p) + q * (1 - q)
    return int(np.ceil(sigmas**2 * variance / (p - q) ** 2))
