"""Exercises of chapter 1: two sums of rewards, a choice, the regret."""

import functools

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import (
    Draws,
    ExerciseError,
    Part,
    Rule,
    exercise,
    index,
    judgement,
)

#: How often each machine is pulled is counted over so many calls.
PULLS = 2000


def _horizons(rng: np.random.Generator) -> Draws:
    cases = [(rng.uniform(0.5, 9, 12).round(1), int(h)) for h in rng.integers(2, 10, 19)]
    return [*cases, (rng.uniform(0.5, 9, 6).round(1), 6)]


@exercise(Part(_horizons))
def finite_sum(rewards, h):
    """Return the sum of the first h rewards.

    Thesis, equation 2.1.
    """
    return sum(rewards[:h])


def _discounts(rng: np.random.Generator) -> Draws:
    return [(rng.uniform(0.5, 9, 8).round(1), float(rng.uniform(0.3, 0.95))) for _ in range(20)]


@exercise(Part(_discounts))
def discounted_sum(rewards, gamma):
    """Return the sum of all rewards, the one at t multiplied by gamma to the power of t.

    Thesis, equation 2.2.
    """
    G = 0.0
    for r in reversed(rewards):
        G = r + gamma * G
    return G


def _four_machines(rng: np.random.Generator, epsilon: float) -> Draws:
    means = rng.uniform(0.1, 0.5, 4)
    means[rng.integers(4)] = 0.8
    return [(means, epsilon, int(rng.integers(2**32)))]


_machine = index("a machine", lambda means, epsilon, rng: len(means))


def _shares(
    function: Rule, means: NDArray[np.float64], epsilon: float, seed: int
) -> NDArray[np.float64]:
    """Return how often each machine is pulled."""

    def pulls(n: int) -> list[int]:
        rng = np.random.default_rng(seed)
        return [_machine(function, means, epsilon, rng) for _ in range(n)]

    if pulls(20) != pulls(20):
        raise ExerciseError(
            "with equal generators yours chooses differently: draw from rng and nothing else"
        )
    return np.bincount(pulls(PULLS), minlength=len(means)) / PULLS


def _due(means: NDArray[np.float64], epsilon: float, seed: int) -> NDArray[np.float64]:
    best = means == means.max()
    return (1 - epsilon) * best / best.sum() + epsilon / len(means)


def _within_chance(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Compare shares at five standard errors."""
    return np.abs(found - wanted) <= 5 * np.sqrt(wanted * (1 - wanted) / PULLS)


_pulled = functools.partial(Part, answer=_shares, right=_due, close=_within_chance)


@exercise(
    greedy=_pulled(lambda rng: _four_machines(rng, 0.0)),
    exploring=_pulled(lambda rng: _four_machines(rng, 1.0)),
    mixed=_pulled(lambda rng: _four_machines(rng, 0.4)),
    tied=_pulled(lambda rng: [(np.array([0.5, 0.2, 0.5, 0.5]), 0.0, int(rng.integers(2**32)))]),
)
def epsilon_greedy(means, epsilon, rng):
    """Return the index of the machine to pull.

    Thesis, section 2.1.3; ties as in equation 3.3.
    """
    if rng.random() < epsilon:
        return rng.integers(len(means))
    return rng.choice(np.flatnonzero(means == means.max()))


def _pulls(rng: np.random.Generator) -> Draws:
    """Draw cases whose best machine is not pulled first, and in some never."""
    arms = rng.integers(0, 4, (20, 9))
    arms[:, 0] = 0
    arms[:5][arms[:5] == 2] = 3
    chances = rng.uniform(0.1, 0.6, (20, 4)).round(2)
    chances[:, 2] = 0.9
    return list(zip(chances, arms, strict=True))


@exercise(Part(_pulls))
def regret(p, arms):
    """Return the regret after each pull, an array as long as arms.

    Thesis, section 2.1.2, the third measure.
    """
    return np.cumsum(p.max() - p[arms])


@exercise(judgement(4))
def which_best():
    """Return the number of the right answer."""
    return 3
