"""Exercises of chapter 11: states on a line, what a turn is worth, and luck."""

from typing import Any

import numpy as np

from arkaq_edu.exercises.exercise import Draws, ExerciseError, Part, Rule, ask, exercise, judgement


def _whole(things: str) -> Rule:
    """Return an `answer` that refuses numbers with a fraction."""

    def answer(function: Rule, *case: Any) -> Any:
        found = ask(function, *case)
        value = np.asarray(found)
        if value.dtype.kind == "f" and (value % 1 != 0).any():
            fraction = value[value % 1 != 0].flat[0]
            raise ExerciseError(f"a number of {things} is whole, and {fraction:.4g} is not")
        return found

    return answer


def _kick(chance: float, cost: float) -> float:
    return 200 * chance - 100 + cost


def _chances(rng: np.random.Generator) -> Draws:
    draws = rng.uniform([0, 0, 0.8, -9], [1, 1, 0.99, -1], (12, 4)).tolist()
    return [tuple(draw) for draw in draws]


@exercise(kick=Part(_chances), turn=Part())
def worth(now, then, gamma, cost):
    """Return the worth of kicking at once, and of turning and then kicking.

    Thesis, section 5.3 (+100 for a goal, -100 for a miss) and equation 2.12.
    """
    kick_now = 100 * now - 100 * (1 - now) + cost
    kick_then = 100 * then - 100 * (1 - then) + cost
    return kick_now, cost + gamma * kick_then


def _intervals(rng: np.random.Generator) -> Draws:
    """Draw intervals where neither a rounding error nor a tie would decide."""
    cases: Draws = []
    while len(cases) < 12:
        vigilance, width = rng.uniform([0.03, 0.8], [0.15, 2.0])
        if all(0.1 < width / vigilance / k % 1 < 0.9 for k in (1, 2)):
            cases.append((vigilance, width))
    return cases


@exercise(
    between=Part(_intervals, answer=_whole("centers")),
    # Binary fractions: here the gaps fit whole.
    border=Part(lambda rng: [(0.25, 1.0), (0.125, 1.5)], answer=_whole("centers")),
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


def _robots(rng: np.random.Generator) -> Draws:
    """Draw chances for which rounding up and rounding down differ clearly."""
    cases: Draws = [(0.6, 0.35, 2.0), (0.5, 0.25, 2.0)]
    while len(cases) < 12:
        p, q, sigmas = rng.uniform([0.05, 0.05, 1.5], [0.95, 0.95, 3.5])
        if abs(p - q) > 0.05 and 0.1 < _enough(p, q, sigmas) % 1 < 0.9:
            cases.append((p, q, sigmas))
    return cases


@exercise(Part(_robots, answer=_whole("kicks")))
def kicks_needed(p, q, sigmas):
    """Return the smallest number of kicks, of each, that tells two shares apart.

    Thesis, section 5.3.2, figures 5.40 and 5.41.
    """
    variance = p * (1 - p) + q * (1 - q)
    return int(np.ceil(sigmas**2 * variance / (p - q) ** 2))


@exercise(judgement(4))
def what_to_improve():
    """Return the number of the right answer."""
    return 4
