"""Exercises of chapter 9: decide, a grid of cells, the target of SARSA, a clear difference."""

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Draws, Part, exercise, index


def _robots(rng: np.random.Generator) -> Draws:
    return [
        (rng.uniform(-1, 1, 2), rng.uniform(-1, 1, (n, 2)), rng.uniform(0, 150, (n, 3)))
        for n in range(2, 32)
    ]


@exercise(Part(_robots, answer=index("an action", lambda x, m, Q: Q.shape[1], "not a value of Q")))
def decide(pattern, centers, Q):
    """Return the best action for a pattern: the nearest center's row of Q decides.

    Thesis, chapter 3, figure 3.1.
    """
    state = np.linalg.norm(centers - pattern, axis=1).argmin()
    return Q[state].argmax()


def _inside(rng: np.random.Generator) -> Draws:
    return [
        (rng.uniform(-1, 1, 2), rows, rows + more)
        for rows, more in rng.integers([2, 1], [9, 4], (40, 2)).tolist()
    ]


def _borders(rng: np.random.Generator) -> Draws:
    rows, columns = rng.integers(2, 12, 2).tolist()
    return [(np.array(corner), rows, columns) for corner in ([1.0, 1], [1.0, -1], [-1.0, 1])]


@exercise(inside=Part(_inside), border=Part(_borders))
def cell(pattern, rows, columns):
    """Return the index of the grid cell that holds a pattern, from 0 to rows * columns - 1."""
    row = min(int((pattern[0] + 1) / 2 * rows), rows - 1)
    column = min(int((pattern[1] + 1) / 2 * columns), columns - 1)
    return row * columns + column


def _holds(rng: np.random.Generator) -> Draws:
    return [
        (r, int(n), gamma, rng.uniform(0, 150, 3), int(rng.integers(3)), False)
        for r, n, gamma in rng.uniform([0, 2, 0.8], [100, 9, 0.99], (30, 3)).tolist()
    ]


def _last_holds(rng: np.random.Generator) -> Draws:
    return [(*case[:-1], True) for case in _holds(rng)]


@exercise(goes_on=Part(_holds), ended=Part(_last_holds))
def sarsa_target(r, n, gamma, next_values, a_next, ended):
    """Return the target of SARSA for an action that was held for n cycles.

    R. Sutton, A. Barto, "Reinforcement Learning", 2nd edition, 2018, section 6.4.
    """
    if ended:
        return r
    return r + gamma**n * next_values[a_next]


def _beyond(a: NDArray[np.float64], b: NDArray[np.float64], errors: float) -> bool:
    return bool(abs(a.mean() - b.mean()) >= errors)


def _groups(rng: np.random.Generator) -> Draws:
    cases = []
    for gap in (0.0, 0.5, 0.9, 1.0, 1.1, 1.5, 2.0, 3.0, 8.0) * 5:
        n, m = rng.integers(4, 30, 2)
        a, b = rng.normal(0.7, 0.1, n), rng.normal(0.7, 0.25, m)
        error = np.sqrt(a.var(ddof=1) / n + b.var(ddof=1) / m)
        b += a.mean() - b.mean() + rng.choice([-1, 1]) * gap * 1.9 * error
        cases.append((a, b))
    return cases


@exercise(Part(_groups))
def is_clear(a, b):
    """Return whether two groups of seeds differ by at least two standard errors."""
    error = np.sqrt(np.var(a, ddof=1) / len(a) + np.var(b, ddof=1) / len(b))
    return bool(abs(np.mean(a) - np.mean(b)) >= 2 * error)
