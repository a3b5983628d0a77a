"""Checks for the notebook on adaptive resonance: match, choose, and the norm of r."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.art import match_norm
from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, numbers

Rng = np.random.Generator | int | None
Bits = NDArray[np.int64]
Floats = NDArray[np.float64]


def check_match(match: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``match(pattern, template)``: the part of the input that was expected.

    Parameters
    ----------
    match : callable
        Takes a pattern and a template of zeros and ones, shape (m,); returns a number.
    rng : numpy.random.Generator or int, optional
        Where the random patterns and templates come from.

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
    Thesis, sections 2.4 and 2.4.1.

    Examples
    --------
    >>> check_match(lambda pattern, template: (pattern & template).sum())
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you count the shared points: the match is a part of \
the input, from 0 to 1
    """
    rng = np.random.default_rng(rng)
    cases = [(_bits(rng, m), _bits(rng, m)) for m in rng.integers(6, 26, 30).tolist()]
    answers = _each("match", match, cases)
    if np.allclose(answers, [(x & z).sum() / x.sum() for x, z in cases]):
        return "Right: it asks how much of what is there was expected, and of nothing else."
    _recognize(answers, cases, WRONG_MATCH)
    x, z = cases[0]
    raise ExerciseError(
        f"of {x.sum()} active inputs {(x & z).sum()} are in the template, so the match is "
        f"{(x & z).sum() / x.sum():.3f}; yours is {answers[0]:.3f}"
    )


def check_choose(choose: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``choose(pattern, templates, reset)``: F2's choice among nodes not reset.

    Parameters
    ----------
    choose : callable
        Takes a pattern, shape (m,), templates, shape (n, m), and the list of nodes that were
        reset; returns the node of largest signal ``2 |I and z_j| / (1 + |z_j|)`` among the others.
    rng : numpy.random.Generator or int, optional
        Where the random patterns and templates come from.

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
    Thesis, section 2.4.3.2, equations 2.36 and 2.37.

    Examples
    --------
    >>> check_choose(lambda pattern, templates, reset: 2 * (templates @ pattern)
    ...     / (1 + templates.sum(axis=1)))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: choose should return the index of a node, a whole \
number: which one it is, not how large its signal
    """
    rng = np.random.default_rng(rng)
    cases = [_search_case(rng, resets) for resets in (0, 1, 2, 3) for _ in range(12)]
    answers = [_node(ask(choose, *case), case) for case in cases]
    wanted = [_chosen(_signals(x, Z), reset) for x, Z, reset in cases]
    if answers == wanted:
        return "Right: the strongest first, and never the same node twice for one pattern."
    _recognize(np.array(answers), cases, WRONG_CHOICE)
    for answer, (_, _, reset) in zip(answers, cases, strict=True):
        if answer in reset:
            raise ExerciseError(
                f"you chose node {answer}, which had been reset: {reset} are blocked while the "
                "pattern lasts, or the search would never end"
            )
    k = next(k for k, pair in enumerate(zip(answers, wanted, strict=True)) if pair[0] != pair[1])
    signals = _signals(*cases[k][:2])
    raise ExerciseError(
        f"you chose node {answers[k]} with signal {signals[answers[k]]:.2f}, but there is one with "
        f"{signals[wanted[k]]:.2f} that has not been reset"
    )


def check_norm_r(norm_r: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``norm_r(u, z, c, d)``: what ART2 compares with the vigilance.

    Parameters
    ----------
    norm_r : callable
        Takes `u`, of norm 1, the expectation `z`, both of shape (m,), and `c` and `d`; returns the
        norm of ``r = (u + c p) / (norm(u) + norm(c p))`` with ``p = u + d z``.
    rng : numpy.random.Generator or int, optional
        Where the random activities come from.

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
    Thesis, section 2.4.3.4, equations 2.38, 2.43 and 2.47.

    Examples
    --------
    >>> check_norm_r(lambda u, z, c, d: 1.0)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: yours is 1 whatever is expected: below stand the norms \
of u and of c p, added, not the norm of their sum
    """
    rng = np.random.default_rng(rng)
    cases = [_reset_case(rng) for _ in range(30)]
    answers = _each("norm_r", norm_r, cases)
    wanted = []
    for u, z, c, d in cases:
        size = np.linalg.norm(z)
        wanted.append(float(match_norm(u @ z / size, c * d * size, c)))
    if not np.allclose(answers, wanted):
        _recognize(answers, cases, WRONG_NORM_R)
        raise ExerciseError(
            f"with c = {cases[0][2]:.2f} and d = {cases[0][3]:.2f} you have {answers[0]:.4f} where "
            f"{wanted[0]:.4f} should be"
        )
    u, z, c, d = cases[0]
    if not np.isclose(_each("norm_r", norm_r, [(u, 0 * z, c, d)])[0], 1):
        raise ExerciseError(
            "a node that expects nothing, z = 0, should give 1: an uncommitted node is never reset"
        )
    return "Right: 1 where input and expectation agree, less where they do not."


# What is often done instead, and what to say of it.
WRONG_MATCH: list[Rule] = [
    (
        lambda x, z: (x & z).sum(),
        "you count the shared points: the match is a part of the input, from 0 to 1",
    ),
    (
        lambda x, z: (x & z).sum() / len(x),
        "you divide by the number of all points: then a letter would not even match itself. "
        "Divide by the active inputs",
    ),
    (
        lambda x, z: (x & z).sum() / z.sum(),
        "you divide by the size of the template: that asks how much of the expectation is there, "
        "not how much of the input was expected",
    ),
    (
        lambda x, z: (x == z).mean(),
        "you count points that are white in both as well: only active inputs matter",
    ),
    (
        lambda x, z: (x & z).sum() / (x | z).sum(),
        "you divide by the points active in either: an expected point that is missing costs nothing"
        " here",
    ),
]
WRONG_CHOICE: list[Rule] = [
    (
        lambda x, Z, reset: int(_signals(x, Z).argmax()),
        "you choose the strongest of all nodes: those in reset are blocked while the pattern lasts,"
        " or the search would never end",
    ),
    (
        lambda x, Z, reset: int(np.delete(_signals(x, Z), reset).argmax()),
        "your index counts only the nodes that are left: it should count all of them",
    ),
    (
        lambda x, Z, reset: _chosen(Z @ x, reset),
        "you choose by the shared points alone: a template with many points shares some with "
        "everything, so divide by 1 + |z_j|",
    ),
    (
        lambda x, Z, reset: _chosen((Z @ x) / Z.sum(axis=1), reset),
        "you divide by |z_j| alone: then a single shared point is as good as a whole letter. "
        "Divide by 1 + |z_j|",
    ),
    (
        lambda x, Z, reset: _chosen(-_signals(x, Z), reset),
        "you choose the weakest signal",
    ),
]
WRONG_NORM_R: list[Rule] = [
    (
        lambda u, z, c, d: 1.0,
        "yours is 1 whatever is expected: below stand the norms of u and of c p, added, not the "
        "norm of their sum",
    ),
    (
        lambda u, z, c, d: _norm_r(u, u + d * z, -c, abs(c)),
        "you take c with a minus: u and c p are added",
    ),
    (
        lambda u, z, c, d: _norm_r(u, u + d * z, -c, -c),
        "you take c with a minus: u and c p are added",
    ),
    (
        lambda u, z, c, d: _norm_r(u, u + z, c, c),
        "you forgot d in p: F2 sends down d z",
    ),
    (
        lambda u, z, c, d: _norm_r(u, d * z, c, c),
        "your p is d z alone: p is u and what is expected, added",
    ),
    (
        lambda u, z, c, d: _norm_r(u, u + d * z, c, 1),
        "below, the norm is that of c p, not of p",
    ),
    (
        lambda u, z, c, d: _norm_r(u, u + d * z, c, c) ** 2,
        "that is the square of it: a root is missing",
    ),
    (
        lambda u, z, c, d: u @ z / np.linalg.norm(z),
        "that is the cosine of u and z, from which the norm of r is still to be made",
    ),
]


def _norm_r(u: Floats, p: Floats, above: float, below: float) -> float:
    return float(np.linalg.norm(u + above * p) / (1 + below * np.linalg.norm(p)))


def _bits(rng: np.random.Generator, m: int) -> Bits:
    """Return zeros and ones, of each at least one."""
    bits = rng.integers(0, 2, m)
    bits[rng.choice(m, 2, replace=False)] = 0, 1
    return bits


def _search_case(rng: np.random.Generator, resets: int) -> tuple[Bits, Bits, list[int]]:
    """Return a pattern, templates of which no two have the same signal, and the nodes reset."""
    while True:
        pattern = _bits(rng, 25)
        # Templates of very different sizes tell the rules apart.
        templates = (rng.random((6, 25)) < rng.uniform(0.05, 0.8, (6, 1))).astype(int)
        templates[:, int(pattern.argmax())] = 1
        signals = np.sort(_signals(pattern, templates))
        if np.diff(signals).min() > 1e-9:
            break
    strongest = np.argsort(-_signals(pattern, templates))
    return pattern, templates, sorted(strongest[:resets].tolist())


def _reset_case(rng: np.random.Generator) -> tuple[Floats, Floats, float, float]:
    u, z = rng.uniform(0.05, 1, (2, int(rng.integers(2, 7))))
    c, d = rng.uniform(0.05, 0.3), rng.uniform(0.5, 0.75)
    z *= rng.uniform(0.3, 0.95) / (1 - d) / np.linalg.norm(z)
    return u / np.linalg.norm(u), z, float(c), float(d)


def _signals(pattern: Bits, templates: Bits) -> Floats:
    return 2 * (templates @ pattern) / (1 + templates.sum(axis=1))


def _chosen(signals: NDArray[Any], reset: list[int]) -> int:
    left = signals.astype(float)
    left[reset] = -np.inf
    return int(left.argmax())


def _each(name: str, function: Callable[..., Any], cases: list[Any]) -> Floats:
    """Return what the student's function answers to each case, one number each."""
    answers = []
    for case in cases:
        answer = ask(function, *case)
        if np.shape(answer) != ():
            raise ExerciseError(
                f"{name} should return one number, not an array of shape {np.shape(answer)}"
            )
        answers.append(float(numbers(name, answer, ())))
    return np.array(answers)


def _node(answer: Any, case: tuple[Bits, Bits, list[int]]) -> int:
    value = np.asarray(answer)
    if value.shape != () or not np.issubdtype(value.dtype, np.integer):
        raise ExerciseError(
            "choose should return the index of a node, a whole number: which one it is, not how "
            "large its signal"
        )
    if not 0 <= value < len(case[1]):
        raise ExerciseError(f"choose returned {value}, but nodes have indices 0 to 5")
    return int(value)


def _recognize(answers: NDArray[Any], cases: list[Any], rules: list[Rule]) -> None:
    """Say which of the usual mistakes was made, if it is one of them."""
    for rule, words in rules:
        if np.allclose(answers, [rule(*case) for case in cases]):
            raise ExerciseError(words)
