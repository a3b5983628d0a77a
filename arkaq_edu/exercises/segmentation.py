"""Checks for the notebook on state segmentation: scale a sighting, find a center, learn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.art import EuclideanART
from arkaq_edu.exercises._ask import ExerciseError, ask, numbers

Rng = np.random.Generator | int | None


def check_scale(scale: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``scale(distance, orientation)``: millimeters and radians to [-1, 1].

    Parameters
    ----------
    scale : callable
        Takes a distance in mm and an orientation in rad, returns the two scaled numbers.
    rng : numpy.random.Generator or int, optional
        Where the random sightings come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 5.2.1.

    Examples
    --------
    >>> check_scale(lambda distance, orientation: [distance / 4100, orientation * 2])
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: distance 200 mm should become -1, yours becomes 0.0488
    """
    rng = np.random.default_rng(rng)
    landmarks = [(200.0, 0.0), (4100.0, 0.0), (2150.0, 0.0), (2150.0, 0.5), (2150.0, -0.5)]
    fresh = rng.uniform([200, -0.5], [4100, 0.5], (20, 2)).tolist()
    cases = landmarks + [(distance, orientation) for distance, orientation in fresh]
    answers = np.array([numbers("scale", ask(scale, *case), (2,)) for case in cases])
    right = np.array([[(d - 2150) / 1950, 2 * o] for d, o in cases])
    if np.allclose(answers[:, ::-1], right):
        raise ExerciseError("both numbers are right, in the wrong order: distance comes first")
    if np.allclose(answers, right * [1, -1]):
        raise ExerciseError(
            "orientation came out with its sign turned: left is positive, before and after"
        )
    for column, (name, unit) in enumerate([("distance", "mm"), ("orientation", "rad")]):
        for case, answer, wanted in zip(cases, answers[:, column], right[:, column], strict=True):
            if not np.isclose(answer, wanted, rtol=0, atol=1e-9):
                got = f"yours becomes {answer:.3g}"
                if wanted in (-1, 0, 1):
                    raise ExerciseError(
                        f"{name} {case[column]:g} {unit} should become {wanted:g}, {got}"
                    )
                raise ExerciseError(
                    f"the ends and the middle of {name} are right, but between them it should run "
                    f"straight: {case[column]:.4g} {unit} is off, {got}"
                )
    return "Right: near and far, left and right, all of the view now lies between -1 and 1."


def check_nearest(nearest: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``nearest(pattern, centers)``: the index of the nearest center.

    Parameters
    ----------
    nearest : callable
        Takes a pattern, shape (2,), and centers, shape (n, 2); returns an index.
    rng : numpy.random.Generator or int, optional
        Where the random patterns and centers come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 4.2.2, equations 4.4 and 4.5.

    Examples
    --------
    >>> import numpy as np
    >>> check_nearest(lambda x, m: np.argmax(np.linalg.norm(m - x, axis=1)))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you found the farthest center of all
    """
    rng = np.random.default_rng(rng)
    cases = [(rng.uniform(-1, 1, 2), rng.uniform(-1, 1, (n, 2))) for n in range(1, 41)]
    answers = [_index(ask(nearest, pattern, centers), len(centers)) for pattern, centers in cases]
    gaps = [np.linalg.norm(centers - pattern, axis=1) for pattern, centers in cases]
    if all(gap[answer] == gap.min() for gap, answer in zip(gaps, answers, strict=True)):
        return "Right: whatever the robot sees, you know which center it belongs to."
    for rule, words in WRONG_NEAREST:
        if answers == [rule(pattern, centers) for pattern, centers in cases]:
            raise ExerciseError(words)
    gap, answer = next(
        (gap, answer) for gap, answer in zip(gaps, answers, strict=True) if gap[answer] > gap.min()
    )
    raise ExerciseError(
        f"among {len(gap)} centers you chose one at a distance of {gap[answer]:.3f}, "
        f"but there is one at {gap.min():.3f}"
    )


# What is often done instead, and what to say of it.
WRONG_NEAREST: list[tuple[Callable[[NDArray[Any], NDArray[Any]], int], str]] = [
    (
        lambda x, m: int(np.argmax(np.linalg.norm(m - x, axis=1))),
        "you found the farthest center of all",
    ),
    (
        lambda x, m: int(np.argmin(np.abs(m - x)[:, 0])),
        "you compare the first coordinate alone: a center may be right in distance and far off in "
        "orientation",
    ),
    (
        lambda x, m: int(np.argmin(np.abs(m - x)[:, 1])),
        "you compare the second coordinate alone: a center may be right in orientation and far off "
        "in distance",
    ),
    (
        lambda x, m: int(np.argmin(np.abs(m - x).sum(axis=1))),
        "you add the two differences as they are: that is the way round the corner, not the "
        "straight line",
    ),
    (
        lambda x, m: int(np.argmin((m - x).sum(axis=1))),
        "you add the two differences with their signs, so that they may cancel",
    ),
    (
        lambda x, m: int(np.argmax(m @ x)),
        "you take the largest dot product: it favors centers far from the origin, however far "
        "they are from the pattern",
    ),
    (
        lambda x, m: 0,
        "you always answer 0: is it a distance that is rounded, or a loop that stops too early?",
    ),
]


def check_present(present: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``present(pattern, centers, vigilance, eta)``: found a center or move one.

    Parameters
    ----------
    present : callable
        Takes a pattern, shape (2,), centers, shape (n, 2), the vigilance and the update factor;
        returns the centers after the pattern was presented, shape (n, 2) or (n + 1, 2).
    rng : numpy.random.Generator or int, optional
        Where the random patterns and centers come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 4.2.2, equation 4.6.

    Examples
    --------
    >>> import numpy as np
    >>> check_present(lambda x, m, vigilance, eta: np.vstack([m, x]))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: a pattern within the vigilance of a center founded \
another one: here a center should have moved
    """
    rng = np.random.default_rng(rng)
    for _ in range(20):
        _check_move(present, rng)
        _check_founding(present, rng)
    # Binary fractions: this distance is the vigilance to the last bit.
    edge = _after(present, np.array([0.25, 0.5]), np.array([[0.0, 0.5]]), 0.25, 0.5)
    if len(edge) != 2:
        raise ExerciseError(
            "a pattern at a distance of exactly the vigilance should found a center: "
            "only a smaller distance is near enough"
        )
    stream = rng.uniform(-1, 1, (150, 2))
    centers = stream[:1]
    for pattern in stream[1:]:
        centers = _after(present, pattern, centers, 0.3, 0.5)
    wanted = EuclideanART(0.3, 0.5).fit(stream).cluster_centers_
    if centers.shape != wanted.shape or not np.allclose(centers, wanted):
        raise ExerciseError(
            f"single patterns are right, but after 150 in a row you have {len(centers)} centers "
            f"where {len(wanted)} should be: does anything depend on the centers' number or order?"
        )
    return "Right: this is the whole of the learning. One pass over the stream, and there is a map."


def _index(answer: Any, n: int) -> int:
    value = np.asarray(answer)
    if value.shape != () or not np.issubdtype(value.dtype, np.integer):
        raise ExerciseError(
            f"nearest should return the index of a center, a whole number, not {answer!r}: "
            "which one it is, not how far or where"
        )
    if not 0 <= value < n:
        raise ExerciseError(f"nearest returned {value}, but the centers have indices 0 to {n - 1}")
    return int(value)


def _after(
    present: Callable[..., Any],
    pattern: NDArray[np.float64],
    centers: NDArray[np.float64],
    vigilance: float,
    eta: float,
) -> NDArray[np.float64]:
    """Return the student's centers after one pattern, with only their number left to judge."""
    n = len(centers)
    answer = ask(present, pattern, centers, vigilance, eta)
    more = n + 1 if np.shape(answer)[:1] == (n + 1,) else n
    return numbers("present", answer, (more, 2))


def _check_move(present: Callable[..., Any], rng: np.random.Generator) -> None:
    vigilance, eta = rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.4)
    centers = _spread(rng, 3 * vigilance)
    j = int(rng.integers(len(centers)))
    angle = rng.uniform(0, 2 * np.pi)
    step = 0.8 * vigilance * np.array([np.cos(angle), np.sin(angle)])
    after = _after(present, centers[j] + step, centers, vigilance, eta)
    if len(after) > len(centers):
        raise ExerciseError(
            "a pattern within the vigilance of a center founded another one: "
            "here a center should have moved"
        )
    moved = np.flatnonzero(np.abs(after - centers).max(axis=1) > 1e-12)
    if len(moved) == 0:
        raise ExerciseError("a pattern within the vigilance of a center left every center in place")
    if len(moved) > 1:
        raise ExerciseError(f"{len(moved)} centers moved at once: only the nearest one should")
    if moved[0] != j:
        raise ExerciseError("one center moved, but not the one nearest to the pattern")
    went = after[j] - centers[j]
    along = went @ step / (step @ step)
    if not np.allclose(went, along * step):
        raise ExerciseError("the center should move along the straight line to the pattern")
    if np.isclose(along, -eta):
        raise ExerciseError("the center moved away from the pattern: look at the sign")
    if not np.isclose(along, eta):
        raise ExerciseError(
            f"with eta {eta:.2f} the center went {along:.2f} of the way to the pattern"
        )


def _check_founding(present: Callable[..., Any], rng: np.random.Generator) -> None:
    vigilance = rng.uniform(0.1, 0.3)
    centers = _spread(rng, 3 * vigilance)
    pattern = centers.max(axis=0) + rng.uniform(1, 2, 2) * vigilance
    after = _after(present, pattern, centers, vigilance, 0.5)
    if len(after) == len(centers):
        raise ExerciseError(
            "a pattern farther than the vigilance from every center should found one of its own"
        )
    if not np.allclose(after[:-1], centers):
        raise ExerciseError(
            "when a center is founded the others should stay as they are, and the new one come last"
        )
    if not np.allclose(after[-1], pattern):
        raise ExerciseError("a new center should stand where its pattern is")


def _spread(rng: np.random.Generator, gap: float) -> NDArray[np.float64]:
    """Return some centers, each more than `gap` from the others, in a random order."""
    grid = np.stack(np.meshgrid(np.arange(3.0), np.arange(2.0)), axis=-1).reshape(-1, 2)
    return rng.permutation(grid) * 1.5 * gap + rng.uniform(-0.2, 0.2, (6, 2)) * gap
