"""Exercises of chapter 3: predict, correct, and what will be observed and earned."""

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Draws, Part, exercise, judgement


def any_belief(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Draw a belief over n states in which nothing is impossible."""
    return _normed(rng.uniform(0.1, 1, n))


def _belief(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Draw a belief over n states. Of three or more, one is impossible."""
    return _normed(any_belief(rng, n) * (rng.permutation(n) + (n < 3) > 0))


def _moves(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Draw a T_a of n states. Of three or more, one is never reached."""
    T_a = rng.dirichlet(np.ones(n), n) * (rng.permutation(n) + (n < 3) > 0)
    return T_a / T_a.sum(axis=1, keepdims=True)


def _normed(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    return weights / weights.sum()


def _even(belief: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spread a belief evenly over what it says is possible."""
    return _normed(np.sign(belief))


def _sizes(rng: np.random.Generator) -> list[int]:
    return rng.integers(2, 6, 20).tolist()


@exercise(Part(lambda rng: [(_belief(rng, n), _moves(rng, n)) for n in _sizes(rng)]))
def predict(b, T_a):
    """Return the belief after an action, before anything is observed.

    Thesis, section 2.3.2: the sum in equation 2.15.
    """
    return b @ T_a


@exercise(Part(lambda rng: [(_belief(rng, n), rng.uniform(0.05, 0.95, n)) for n in _sizes(rng)]))
def correct(b, likelihood):
    """Return the belief after an observation.

    Thesis, section 2.3.2, equations 2.14 and 2.15.
    """
    weights = b * likelihood
    return weights / weights.sum()


def _models(rng: np.random.Generator) -> Draws:
    return [
        (_belief(rng, n), _moves(rng, n), rng.dirichlet(np.ones(n + 1), n)) for n in _sizes(rng)
    ]


@exercise(Part(_models))
def observation_chances(b, T_a, O_a):
    """Return how likely each observation is after an action.

    Thesis, sections 2.3.2 and 2.3.3: the denominator of equation 2.15, and part of 2.16.
    """
    return b @ T_a @ O_a


@exercise(
    Part(lambda rng: [(_belief(rng, n), rng.uniform(-5, 10, (n, n + 1))) for n in _sizes(rng)])
)
def expected_reward(b, R):
    """Return the reward that each action earns on average.

    Thesis, section 2.3.3, equation 2.17.
    """
    return b @ R


@exercise(judgement(4))
def what_is_wrong():
    """Return the number of the right answer."""
    return 4
