"""Exercises of chapter 13: a variance from a swing, an even spread, actions that tie."""

import numpy as np

from arkaq_edu.exercises.exercise import Draws, Part, exercise


@exercise(Part(lambda rng: [tuple(c) for c in rng.uniform([20, 1.5], [200, 4], (20, 2)).tolist()]))
def variance_of(swing, sigmas):
    """Return the variance of a noise whose largest swing is so many standard deviations.

    Thesis, section 5.2; errata row 34.
    """
    return (swing / sigmas) ** 2


@exercise(Part(lambda rng: [(u, z) for u, z in rng.uniform([0, 900], [1, 5000], (30, 2)).tolist()]))
def even_depth(u, z_max):
    """Return the depth of a ball that is spread evenly over a triangle, from a uniform u in [0, 1].

    Thesis, equation 5.1; errata row 36.
    """
    return z_max * np.sqrt(u)


def _ties(rng: np.random.Generator) -> Draws:
    cases = []
    for n in rng.integers(2, 7, 30):
        q = rng.uniform(0, 50, n).round()
        q[rng.permutation(n)[: rng.integers(1, n + 1)]] = 60.0
        cases.append((q,))
    return cases


@exercise(Part(_ties))
def coldest(q):
    """Return the probability of each action as the temperature falls to zero, shape (A,).

    Thesis, equation 3.3; errata row 29.
    """
    best = q == q.max()
    return best / best.sum()
