"""Exercises of chapter 6: match, choose, and the norm of r."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Part, exercise, index


def _bits(rng: np.random.Generator, m: int) -> NDArray[np.int64]:
    """Draw zeros and ones, at least one of each."""
    bits = rng.integers(0, 2, m)
    bits[rng.choice(m, 2, replace=False)] = 0, 1
    return bits


@exercise(
    "Right: it asks how much of what is there was expected, and of nothing else.",
    "Which points are active in both, and of what number should they be a part?",
    "pattern & template is 1 where both are. Its sum counts the shared points.",
    "Divide that by the number of active inputs, pattern.sum().",
    cases=lambda rng: [(_bits(rng, m), _bits(rng, m)) for m in rng.integers(6, 26, 30).tolist()],
    wrong={
        "(pattern & template).sum()": "you count the shared points: the match is a share, from 0 "
        "to 1",
        "(pattern & template).sum() / len(pattern)": "you divide by the number of all points: then "
        "a letter would not even match itself. Divide by the active inputs",
        "(pattern & template).sum() / template.sum()": "you divide by the size of the template: "
        "that asks how much of the expectation is there, not how much of the input was expected",
        "(pattern == template).mean()": "you also count points white in both: only active inputs "
        "matter",
        "(pattern & template).sum() / (pattern | template).sum()": "you divide by the points "
        "active in either: an expected point that is missing costs nothing here",
    },
    tell=lambda found, wanted, x, z: (
        f"of {x.sum()} active inputs {(x & z).sum()} are in the template, so the match is "
        f"{wanted:.3f}; yours is {found:.3f}"
    ),
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


def _searches(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    """Draw patterns, templates of which no two have the same signal, and the nodes in reset."""
    cases: list[tuple[Any, ...]] = []
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


def _tell_choice(found, wanted, pattern, templates, reset):
    if found in reset:
        return (
            f"you chose node {int(found)}, which had been reset: {reset} are blocked while the "
            "pattern lasts, or the search would never end"
        )
    yours, ours = _signals(pattern, templates)[[int(found), int(wanted)]]
    return (
        f"you chose node {int(found)} with signal {yours:.2f}, but there is one with {ours:.2f} "
        "that has not been reset"
    )


@exercise(
    "Right: the strongest first, and never the same node twice for one pattern.",
    "Compute the signals of all nodes first. Which of them may still be chosen?",
    "The signals are 2 * (templates @ pattern) / (1 + templates.sum(axis=1)).",
    "Set the signals in reset to -1, signals[reset] = -1, and return signals.argmax().",
    points=3,
    returns="the index of a node",
    cases=_searches,
    answer=index("node", lambda x, Z, reset: len(Z), "which one it is, not how large its signal"),
    wrong={
        "_signals(pattern, templates).argmax()": "you choose the strongest of all nodes: those in "
        "reset are blocked while the pattern lasts, or the search would never end",
        "np.delete(_signals(pattern, templates), reset).argmax()": "your index counts only the "
        "nodes that are left: it should count all of them",
        "_strongest_left(templates @ pattern, reset)": "you choose by the shared points alone: a "
        "template with many points shares some with everything, so divide by 1 + |z_j|",
        "_strongest_left(templates @ pattern / templates.sum(axis=1), reset)": "you divide by "
        "|z_j| alone: then a single shared point is as good as a whole letter. Divide by 1 + "
        "|z_j|",
        "_strongest_left(-_signals(pattern, templates), reset)": "you choose the weakest signal",
    },
    tell=_tell_choice,
)
def choose(pattern, templates, reset):
    """Return the node that F2 chooses; templates has shape (n, m), reset is a list of indices.

    Thesis, section 2.4.3.2, equations 2.36 and 2.37.
    """
    signals = 2 * (templates @ pattern) / (1 + templates.sum(axis=1))
    signals[reset] = -1
    return signals.argmax()


def _resets(rng: np.random.Generator) -> list[tuple[Any, ...]]:
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
    "Right: 1 where input and expectation agree, less where they do not.",
    "Compute p first: in it the expectation z is mixed into u.",
    "p = u + d * z. Below the fraction are two norms, that of u and that of c * p, added.",
    "r = (u + c * p) / (norm(u) + norm(c * p)), with np.linalg.norm. Return the norm of r.",
    points=3,
    cases=_resets,
    wrong={
        "1.0": "yours is 1 whatever is expected: below are the norms of u and of c p, added, not "
        "the norm of their sum",
        "_norm_r(u, u + d * z, -c, c)": "you take c with a minus: u and c p are added",
        "_norm_r(u, u + d * z, -c, -c)": "you take c with a minus: u and c p are added",
        "norm_r(u, z, c, 1)": "you forgot d in p: F2 sends down d z",
        "_norm_r(u, d * z, c, c)": "your p is only d z: p is the sum of u and what is expected",
        "_norm_r(u, u + d * z, c, 1)": "below, the norm is that of c p, not of p",
        "norm_r(u, z, c, d)**2": "that is the square of it: take the square root",
        "u @ z / np.linalg.norm(z)": "that is the cosine of u and z: compute the norm of r from it",
    },
    tell=lambda found, wanted, u, z, c, d: (
        f"with c = {c:.2f} and d = {d:.2f} yours is {found:.4f}: it should be {wanted:.4f}"
    ),
    then=(
        Part(
            cases=lambda rng: [(u, 0 * z, c, d) for u, z, c, d in _resets(rng)],
            tell=lambda *_: (
                "a node that expects nothing, z = 0, should give 1: an uncommitted node is never "
                "reset"
            ),
        ),
    ),
)
def norm_r(u, z, c, d):
    """Return the norm of r, one number; u and z are arrays of one length.

    Thesis, section 2.4.3.4, equations 2.38, 2.43 and 2.47, with e = 0.
    """
    p = u + d * z
    r = (u + c * p) / (np.linalg.norm(u) + np.linalg.norm(c * p))
    return np.linalg.norm(r)
