"""Exercises of chapter 5: two rulers, one turn of the filter, the NIS."""

import numpy as np

from arkaq_edu.exercises.exercise import Draws, Part, exercise, judgement


def _rulers(rng: np.random.Generator) -> Draws:
    low, high = [500, 5, 20, 25], [3000, 20, 90, 60]
    draws = rng.uniform(low, high, (20, 4)).tolist()
    return [(a, sigma_a**2, a + gap, sigma_b**2) for a, sigma_a, gap, sigma_b in draws]


@exercise(mean=Part(_rulers), variance=Part())
def combine(a, var_a, b, var_b):
    """Return the best mean of two measurements of one thing, and its variance.

    Thesis, section 2.5.1, equations 2.53 and 2.54, with A = H = 1.
    """
    precision = 1 / var_a + 1 / var_b
    return (a / var_a + b / var_b) / precision, 1 / precision


def _steps(rng: np.random.Generator) -> Draws:
    low, high = [500, 400, -120, 20, 100, 900], [3000, 2500, -60, 90, 1600, 9000]
    draws = rng.uniform(low, high, (20, 6)).tolist()
    return [(x, P, u, x + u + gap, Q, R) for x, P, u, gap, Q, R in draws]


@exercise(
    estimate=Part(_steps),
    variance=Part(),
    unseen=Part(lambda rng: [(x, P, u, None, Q, R) for x, P, u, _, Q, R in _steps(rng)]),
    zero=Part(lambda rng: [(x, P, u, 0.0, Q, R) for x, P, u, _, Q, R in _steps(rng)]),
)
def turn(x, P, u, z, Q, R):
    """Return estimate and variance after a step u and a sighting z, or None.

    Thesis, equations 2.55 to 2.59, with A = B = H = 1.
    """
    x, P = x + u, P + Q
    if z is None:
        return x, P
    K = P / (P + R)
    return x + K * (z - x), (1 - K) * P


def _innovations(rng: np.random.Generator) -> Draws:
    roots = [rng.normal(size=(m, m)) + 2 * np.eye(m) for m in (2, 3) * 4]
    return [(rng.normal(size=len(root)) * 4, root @ root.T) for root in roots]


@exercise(Part(_innovations))
def nis(innovation, S):
    """Return the normalized innovation squared.

    Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and
    Navigation", 2001, section 5.4. Not in the thesis.
    """
    return innovation @ np.linalg.inv(S) @ innovation


@exercise(judgement(4))
def what_to_change():
    """Return the number of the right answer."""
    return 3
