"""Exercises of chapter 12: pairs of runs, the worst runs, looks that are not enough, ten parts."""

import numpy as np

from arkaq_edu.exercises.exercise import Draws, Part, exercise, judgement


def _twins(rng: np.random.Generator) -> Draws:
    cases = []
    for n in rng.integers(5, 31, 20):
        luck = rng.normal(60, 15, n)  # of the seed: both runs have it
        cases.append((luck + rng.normal(0, 3, n), luck + rng.normal(2, 6, n)))
    return cases


@exercise(difference=Part(_twins), error=Part())
def paired(a, b):
    """Return the mean of b - a over the same seeds, and its standard error.

    D. Freedman, R. Pisani, R. Purves, "Statistics", 4th edition, 2007.
    """
    gain = b - a
    return gain.mean(), gain.std(ddof=1) / np.sqrt(len(gain))


def _runs(rng: np.random.Generator) -> Draws:
    return [
        (rng.permutation(rng.uniform(10, 70, n)), int(rng.integers(2, n // 2 + 1)))
        for n in rng.integers(6, 31, 20)
    ]


@exercise(Part(_runs))
def worst(values, k):
    """Return the mean of the k smallest values."""
    return np.sort(values)[:k].mean()


def _worlds(rng: np.random.Generator) -> Draws:
    return [
        (rng.integers(0, 5, n), rng.integers(0, 3, n)) for n in rng.integers(3, 12, 40).tolist()
    ]


def _shared(looks: np.ndarray) -> int:
    """Return how many looks belong to several states."""
    return int((np.unique(looks, return_counts=True)[1] > 1).sum())


@exercise(Part(_worlds))
def torn(looks, best):
    """Return how many looks come from states whose best actions differ.

    State s gives the look looks[s], and its best action is best[s].
    """
    return sum(len(set(best[looks == look])) > 1 for look in set(looks))


@exercise(judgement(4))
def one_of_twenty():
    """Return the number of the right answer."""
    return 3
