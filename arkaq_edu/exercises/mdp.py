"""Exercises of chapter 2: a backup, greedy actions, TD(0), a learning rate."""

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import (
    Cases,
    Draws,
    ExerciseError,
    Part,
    Rule,
    ask,
    exercise,
    judgement,
)

#: A rate is tried on so many visits. Then at most so much may be left of the first value, and of
#: the standard deviation of a single target, and the rate must be so many times 1/n: n^-p passes
#: with p from 0.55 to 0.9.
VISITS, START_LEFT, SCATTER_LEFT, SLOWER = 100_000, 0.01, 0.035, 3.0


def _q(T, R, gamma, V):
    return R + gamma * (T @ V).T


def _models(rng: np.random.Generator) -> Draws:
    """Draw T, R, gamma and V of small models in which no two actions are nearly equal."""
    models: Draws = []
    while len(models) < 20:
        n_states, n_actions = int(rng.integers(3, 6)), int(rng.integers(2, 5))
        T = rng.dirichlet(np.ones(n_states), size=(n_actions, n_states))
        R, V = rng.uniform(-5, 20, (n_states, n_actions)), rng.uniform(0, 60, n_states)
        gamma = float(rng.uniform(0.6, 0.95))
        gaps = np.diff(np.sort(_q(T, R, gamma, V), axis=1), axis=1)
        if gaps.min() > 0.1 and n_states != n_actions:
            models.append((T, R, gamma, V))
    return models


@exercise(Part(lambda rng: [(*model, int(rng.integers(3))) for model in _models(rng)]))
def bellman(T, R, gamma, V, s):
    """Return the value of state s, if V are the values one step later.

    Thesis, section 2.2.1, equation 2.8.
    """
    return max(R[s, a] + gamma * T[a, s] @ V for a in range(len(T)))


@exercise(Part(_models))
def greedy(T, R, gamma, V):
    """Return the best action of each state, if V are the values one step later.

    Thesis, section 2.2.1, equations 2.6 and 2.9.
    """
    return (R + gamma * (T @ V).T).argmax(axis=1)


def _steps(ended: bool) -> Cases:
    low, high = [10, 1, 10, 0.1, 0.7], [90, 40, 90, 0.4, 0.95]
    return lambda rng: [
        (v, r, v_next, ended, alpha, gamma)
        for v, r, v_next, alpha, gamma in rng.uniform(low, high, (20, 5)).tolist()
    ]


@exercise(going_on=Part(_steps(False)), ended=Part(_steps(True)))
def td(v, r, v_next, ended, alpha, gamma):
    """Return the new value of a state, from its old one and what a single step brought.

    Thesis, section 2.2.2, equation 2.11.
    """
    target = r if ended else r + gamma * v_next
    return v + alpha * (target - v)


def _after_many_visits(function: Rule) -> NDArray[np.float64]:
    """Return what is left of the first value, of a target's scatter, and 1/n by the last rate."""
    for n in (1, 2, 3):
        rate.numbers(ask(function, n), ())
    start, variance, alpha = 1.0, 0.0, 0.0
    for n in range(1, VISITS + 1):
        alpha = float(function(n))
        if not 0 <= alpha <= 1:
            raise ExerciseError(f"rate({n}) is {alpha:.4g}: a learning rate lies between 0 and 1")
        start *= 1 - alpha
        variance = (1 - alpha) ** 2 * variance + alpha**2
    return np.array([start, variance**0.5, 1 / max(VISITS * alpha, 1e-9)])


@exercise(
    Part(
        lambda rng: [()],
        answer=_after_many_visits,
        right=lambda: [START_LEFT, SCATTER_LEFT, 1 / SLOWER],
        close=np.less_equal,
    )
)
def rate(n):
    """Return the learning rate for the n-th visit.

    Thesis, sections 2.2.3 and 4.3; H. Robbins, S. Monro, "A stochastic approximation method", 1951.
    """
    return n**-0.7


@exercise(judgement(4))
def smallest_state():
    """Return the number of the right answer."""
    return 1
