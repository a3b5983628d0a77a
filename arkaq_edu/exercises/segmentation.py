"""Exercises of chapter 7: scale a sighting, find the nearest center, learn from a pattern."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.art import EuclideanART
from arkaq_edu.exercises.exercise import ExerciseError, Part, ask, exercise, index


def _sightings(rng: np.random.Generator) -> list[tuple[float, ...]]:
    landmarks = [(200.0, 0.0), (4100.0, 0.0), (2150.0, 0.0), (2150.0, 0.5), (2150.0, -0.5)]
    return landmarks + [tuple(s) for s in rng.uniform([200, -0.5], [4100, 0.5], (20, 2)).tolist()]


def _tell_scale(name: str, unit: str, place: int) -> Callable[..., str]:
    def tell(found, wanted, *sighting):
        value = f"{name} {sighting[place]:.4g} {unit}"
        if wanted in (-1, 0, 1):
            return f"{value} should become {wanted:g}, yours becomes {found:.3g}"
        return (
            f"the ends and the middle of {name} are right, but between them it should run "
            f"straight: {value} is off, yours becomes {found:.3g}"
        )

    return tell


@exercise(
    "Right: near and far, left and right, all of the view now lies between -1 and 1.",
    "The middle of each interval should become 0. Where are the two middles?",
    "Subtract the middle, then divide by half the length of the interval.",
    "Distances run from 200 to 4100: the middle is 2150, half the length 1950.",
    returns=("distance", "orientation"),
    cases=_sightings,
    of="distance",
    wrong={
        "2 * orientation": "the two numbers are in the wrong order: distance comes first",
    },
    tell=_tell_scale("distance", "mm", 0),
    then=(
        Part(
            of="orientation",
            wrong={
                "-2 * orientation": "the orientation has changed its sign: left stays positive",
            },
            tell=_tell_scale("orientation", "rad", 1),
        ),
    ),
)
def scale(distance, orientation):
    """Return the pattern [scaled distance, scaled orientation] of one sighting.

    Thesis, section 5.2.1.
    """
    return np.array([(distance - 2150) / 1950, orientation * 2])


def _tell_nearest(found, wanted, pattern, centers):
    yours, ours = np.linalg.norm(centers[[int(found), int(wanted)]] - pattern, axis=1)
    return (
        f"among {len(centers)} centers you chose one at a distance of {yours:.3f}, but there is "
        f"one at {ours:.3f}"
    )


@exercise(
    "Right: whatever the robot sees, you know which center it belongs to.",
    "How far is the pattern from each of the centers? Only then ask which one is nearest.",
    "np.linalg.norm(centers - pattern, axis=1) is the distance to each center.",
    "argmin says where the smallest of them is.",
    returns="the index of a center",
    cases=lambda rng: [(rng.uniform(-1, 1, 2), rng.uniform(-1, 1, (n, 2))) for n in range(1, 41)],
    answer=index("center", lambda x, m: len(m), "which one it is, not how far or where"),
    wrong={
        "np.linalg.norm(centers - pattern, axis=1).argmax()": "you found the farthest center",
        "np.abs(centers - pattern)[:, 0].argmin()": "you compare the first coordinate alone: a "
        "center may be right in distance and far off in orientation",
        "np.abs(centers - pattern)[:, 1].argmin()": "you compare the second coordinate alone: a "
        "center may be right in orientation and far off in distance",
        "np.abs(centers - pattern).sum(axis=1).argmin()": "you add the two differences as they "
        "are: that is the path round the corner, not the straight line",
        "(centers - pattern).sum(axis=1).argmin()": "you add the two differences with their signs, "
        "so that they may cancel",
        "(centers @ pattern).argmax()": "you take the largest dot product: it favors centers far "
        "from the origin, however far they are from the pattern",
        "0": "you always answer 0: is a distance rounded, or does a loop stop too early?",
    },
    tell=_tell_nearest,
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


def _near_patterns(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    cases = []
    for vigilance, eta, angle in rng.uniform([0.1, 0.1, 0], [0.3, 0.4, 6.28], (20, 3)).tolist():
        centers = _spread(rng, 3 * vigilance)
        step = 0.8 * vigilance * np.array([np.cos(angle), np.sin(angle)])
        cases.append((centers[rng.integers(len(centers))] + step, centers, vigilance, eta))
    return cases


def _far_patterns(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    cases = []
    for vigilance in rng.uniform(0.1, 0.3, 20).tolist():
        centers = _spread(rng, 3 * vigilance)
        far = centers.max(axis=0) + rng.uniform(1, 2, 2) * vigilance
        cases.append((far, centers, vigilance, 0.5))
    return cases


def _after(function: Callable[..., Any], *case: Any) -> NDArray[np.float64]:
    n = len(case[1])
    return present.numbers(ask(function, *case), (n, 2), (n + 1, 2))


def _founding(new: int, words: str) -> Callable[..., NDArray[np.float64]]:
    """Return an `answer` that refuses, with these words, another number of new centers."""

    def answer(function: Callable[..., Any], *case: Any) -> NDArray[np.float64]:
        centers = _after(function, *case)
        if len(centers) != len(case[1]) + new:
            raise ExerciseError(words)
        return centers

    return answer


def _tell_move(found, wanted, pattern, centers, vigilance, eta):
    moved = np.flatnonzero(np.abs(found - centers).max(axis=1) > 1e-12)
    j = nearest(pattern, centers)
    if len(moved) == 0:
        return "a pattern within the vigilance of a center left every center in place"
    if len(moved) > 1:
        return f"{len(moved)} centers moved at once: only the nearest one should"
    if moved[0] != j:
        return "one center moved, but not the one nearest to the pattern"
    step, went = pattern - centers[j], found[j] - centers[j]
    along = went @ step / (step @ step)
    if not np.allclose(went, along * step):
        return "the center should move along the straight line to the pattern"
    if np.isclose(along, -eta):
        return "the center moved away from the pattern: look at the sign"
    return f"with eta {eta:.2f} the center went {along:.2f} of the way to the pattern"


def _tell_founding(found, wanted, pattern, centers, *_):
    if not np.allclose(found[:-1], centers):
        return (
            "when a center is founded the others should stay as they are, and the new one come last"
        )
    return "a new center should be where its pattern is"


def _summary(centers: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([len(centers), *centers.sum(axis=0), (centers**2).sum()])


def _after_stream(
    function: Callable[..., Any], stream: NDArray[np.float64], vigilance: float, eta: float
) -> NDArray[np.float64]:
    centers = stream[:1]
    for pattern in stream[1:]:
        centers = _after(function, pattern, centers, vigilance, eta)
    return _summary(centers)


@exercise(
    "Right: this is the whole of the learning. One pass over the stream, and there is a map.",
    "Find the nearest center first. Its distance decides which of two things happens.",
    "At the vigilance or farther: np.vstack([centers, pattern]). Otherwise move a copy.",
    "To move: centers[i] += eta * (pattern - centers[i]), after centers = centers.copy().",
    points=4,
    returns="the centers, one in each row",
    cases=_near_patterns,
    answer=_founding(
        0,
        "a pattern within the vigilance of a center founded another one: here a center should have "
        "moved",
    ),
    tell=_tell_move,
    then=(
        Part(
            cases=_far_patterns,
            answer=_founding(
                1,
                "a "
                "pattern farther than the vigilance from every center should found one of its own",
            ),
            tell=_tell_founding,
        ),
        Part(
            # Binary fractions: this distance is the vigilance to the last bit.
            cases=lambda rng: [(np.array([0.25, 0.5]), np.array([[0.0, 0.5]]), 0.25, 0.5)],
            answer=_founding(
                1,
                "a pattern at a distance of exactly the vigilance should found a center: only a "
                "smaller distance is near enough",
            ),
        ),
        Part(
            cases=lambda rng: [(rng.uniform(-1, 1, (150, 2)), 0.3, 0.5)],
            answer=_after_stream,
            right=lambda stream, *given: _summary(
                EuclideanART(*given).fit(stream).cluster_centers_
            ),
            tell=lambda found, wanted, stream, *_: (
                f"single patterns are right, but after {len(stream)} in a row you have "
                f"{found[0]:.0f} centers where {wanted[0]:.0f} should be: does anything depend on "
                "the centers' number or order?"
            ),
        ),
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
