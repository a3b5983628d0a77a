"""Exercises of chapter 7: scale a sighting, find the nearest center, learn from a pattern."""

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.art import EuclideanART
from arkaq_edu.exercises.exercise import Draws, Part, Rule, ask, exercise, index, judgement


def _sightings(rng: np.random.Generator) -> Draws:
    landmarks = [(200.0, 0.0), (4100.0, 0.0), (2150.0, 0.0), (2150.0, 0.5), (2150.0, -0.5)]
    return landmarks + [tuple(s) for s in rng.uniform([200, -0.5], [4100, 0.5], (20, 2)).tolist()]


@exercise(distance=Part(_sightings), orientation=Part())
def scale(distance, orientation):
    """Return the pattern [scaled distance, scaled orientation] of one sighting.

    Thesis, section 5.2.1.
    """
    return np.array([(distance - 2150) / 1950, orientation * 2])


@exercise(
    Part(
        lambda rng: [(rng.uniform(-1, 1, 2), rng.uniform(-1, 1, (n, 2))) for n in range(2, 42)],
        answer=index("a center", lambda x, m: len(m), "which one it is, not how far or where"),
    )
)
def nearest(pattern, centers):
    """Return the index of the center nearest to the pattern; centers has shape (n, 2).

    Thesis, section 4.2.2, equations 4.4 and 4.5.
    """
    return np.linalg.norm(centers - pattern, axis=1).argmin()


def _spread(rng: np.random.Generator, gap: float) -> NDArray[np.float64]:
    """Return some centers in random order, each more than `gap` from the others."""
    grid = np.stack(np.meshgrid(np.arange(3.0), np.arange(2.0)), axis=-1).reshape(-1, 2)
    return rng.permutation(grid) * 1.5 * gap + rng.uniform(-0.2, 0.2, (6, 2)) * gap


def _near_patterns(rng: np.random.Generator) -> Draws:
    cases = []
    for vigilance, eta, angle in rng.uniform([0.1, 0.1, 0], [0.3, 0.4, 6.28], (20, 3)).tolist():
        centers = _spread(rng, 3 * vigilance)
        step = 0.8 * vigilance * np.array([np.cos(angle), np.sin(angle)])
        cases.append((centers[rng.integers(len(centers))] + step, centers, vigilance, eta))
    return cases


def _far_patterns(rng: np.random.Generator) -> Draws:
    cases = []
    for vigilance in rng.uniform(0.1, 0.3, 20).tolist():
        centers = _spread(rng, 3 * vigilance)
        far = centers.max(axis=0) + rng.uniform(1, 2, 2) * vigilance
        cases.append((far, centers, vigilance, 0.5))
    return cases


def _moved(found, centers):
    return np.flatnonzero(np.abs(found - centers).max(axis=1) > 1e-12).tolist()


def _share(found, pattern, centers):
    """Return how much of the way to the pattern its center went, or None if not straight."""
    j = nearest(pattern, centers)
    step, went = pattern - centers[j], found[j] - centers[j]
    share = went @ step / (step @ step)
    return share if np.allclose(went, share * step) else None


def _after(function: Rule, *case: Any) -> NDArray[np.float64]:
    n = len(case[1])
    return present.numbers(ask(function, *case), (n, 2), (n + 1, 2))


def _count(function: Rule, *case: Any) -> int:
    return len(_after(function, *case))


def _right_count(*case: Any) -> int:
    return len(present(*case))


_counted = functools.partial(Part, answer=_count, right=_right_count)


def _summary(centers: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([len(centers), *centers.sum(axis=0), (centers**2).sum()])


def _after_stream(
    function: Rule, stream: NDArray[np.float64], vigilance: float, eta: float
) -> NDArray[np.float64]:
    centers = stream[:1]
    for pattern in stream[1:]:
        centers = _after(function, pattern, centers, vigilance, eta)
    return _summary(centers)


@exercise(
    kept=_counted(_near_patterns),
    moved=Part(),
    founded=_counted(_far_patterns),
    placed=Part(),
    # Binary fractions: this distance is the vigilance to the last bit.
    border=_counted(lambda rng: [(np.array([0.25, 0.5]), np.array([[0.0, 0.5]]), 0.25, 0.5)]),
    stream=Part(
        lambda rng: [(rng.uniform(-1, 1, (150, 2)), 0.3, 0.5)],
        answer=_after_stream,
        right=lambda stream, *given: _summary(EuclideanART(*given).fit(stream).cluster_centers_),
    ),
)
def present(pattern, centers, vigilance, eta):
    """Return the centers after one more pattern: one of them moved, or one more founded.

    Thesis, section 4.2.2, equation 4.6.
    """
    i = np.linalg.norm(centers - pattern, axis=1).argmin()
    if np.linalg.norm(pattern - centers[i]) >= vigilance:
        return np.vstack([centers, pattern])
    centers = centers.copy()
    centers[i] += eta * (pattern - centers[i])
    return centers


@exercise(judgement(4))
def too_fine():
    """Return the number of the right answer."""
    return 4
