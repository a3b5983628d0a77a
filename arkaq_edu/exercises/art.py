"""Exercises of chapter 6: match, choose, and the norm of r."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Draws, Part, exercise, index, judgement


def _bits(rng: np.random.Generator, m: int) -> NDArray[np.int64]:
    """Draw zeros and ones, at least one of each."""
    bits = rng.integers(0, 2, m)
    bits[rng.choice(m, 2, replace=False)] = 0, 1
    return bits


@exercise(
    Part(lambda rng: [(_bits(rng, m), _bits(rng, m)) for m in rng.integers(6, 26, 30).tolist()])
)
def match(pattern, template):
    """Return the match, from 0 to 1, of two arrays of zeros and ones.

    Thesis, sections 2.4 and 2.4.1.
    """
    return (pattern & template).sum() / pattern.sum()


def _signals(pattern: NDArray[np.int64], templates: NDArray[np.int64]) -> NDArray[np.float64]:
    return 2 * (templates @ pattern) / (1 + templates.sum(axis=1))


def _strongest_left(signals: NDArray[Any], reset: list[int]) -> int:
    left = signals.astype(float)
    left[reset] = -np.inf
    return int(left.argmax())


def _searches(rng: np.random.Generator) -> Draws:
    """Draw patterns, templates of which no two have the same signal, and the nodes in reset."""
    cases: Draws = []
    while len(cases) < 48:
        pattern = _bits(rng, 25)
        # Templates of very different sizes tell the rules apart.
        templates = (rng.random((6, 25)) < rng.uniform(0.05, 0.8, (6, 1))).astype(int)
        templates[:, int(pattern.argmax())] = 1
        signals = _signals(pattern, templates)
        if np.diff(np.sort(signals)).min() > 1e-9:
            strongest = np.argsort(-signals)[: len(cases) // 12]
            cases.append((pattern, templates, sorted(strongest.tolist())))
    return cases


@exercise(
    Part(
        _searches,
        answer=index(
            "a node", lambda x, Z, reset: len(Z), "which one it is, not how large its signal"
        ),
    )
)
def choose(pattern, templates, reset):
    """Return the node that F2 chooses; templates has shape (n, m), reset is a list of indices.

    Thesis, section 2.4.3.2, equations 2.36 and 2.37.
    """
    signals = 2 * (templates @ pattern) / (1 + templates.sum(axis=1))
    signals[reset] = -1
    return signals.argmax()


def _resets(rng: np.random.Generator) -> Draws:
    cases = []
    for m in rng.integers(2, 7, 30).tolist():
        u, z = rng.uniform(0.05, 1, (2, m))
        c, d, length = rng.uniform([0.05, 0.5, 0.3], [0.3, 0.75, 0.95]).tolist()
        z *= length / (1 - d) / np.linalg.norm(z)
        cases.append((u / np.linalg.norm(u), z, c, d))
    return cases


def _norm_r(u: NDArray[np.float64], p: NDArray[np.float64], above: float, below: float) -> float:
    return float(np.linalg.norm(u + above * p) / (1 + below * np.linalg.norm(p)))


@exercise(
    usual=Part(_resets),
    unexpected=Part(lambda rng: [(u, 0 * z, c, d) for u, z, c, d in _resets(rng)]),
)
def norm_r(u, z, c, d):
    """Return the norm of r, one number; u and z are arrays of one length.

    Thesis, section 2.4.3.4, equations 2.38, 2.43 and 2.47, with e = 0.
    """
    p = u + d * z
    r = (u + c * p) / (np.linalg.norm(u) + np.linalg.norm(c * p))
    return np.linalg.norm(r)


@exercise(judgement(4))
def finer_categories():
    """Return the number of the right answer."""
    return 2
