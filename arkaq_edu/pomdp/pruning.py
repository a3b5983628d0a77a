"""Pruning: which vectors form the upper surface, and which of them dominate the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, number
from arkaq_edu._compiled import word_before_compiling
from arkaq_edu.pomdp import linear_program

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]

# Gains below this share of the largest difference between the vectors may be rounding errors.
ROUNDING = 1e-12
# Two intervals of beliefs are disjoint if the gap between them is wider than this.
APART = 1e-9
# The smallest difference that is divided by: it only avoids 0 / 0.
TINY = 1e-300


def prune(alphas: ArrayLike, tol: float = 1e-9) -> NDArray[np.intp]:
    """Return the vectors that form the upper surface max_k b . alpha_k.

    Parameters
    ----------
    alphas : array_like, shape (K, S)
        The vectors.
    tol : float, default 1e-9
        No vector that is left out adds more than this at any belief, in the units of `alphas`.

    Returns
    -------
    ndarray of int
        The rows that are needed, in ascending order. Of equal rows the first is kept.

    Raises
    ------
    ValueError
        If `alphas` has another shape or is not finite, or `tol` is negative or infinite.

    See Also
    --------
    dominated : which vectors make the others superfluous.

    Notes
    -----
    Comparing two vectors at a time is not enough. A vector can lie below the upper surface of two
    others even if neither of the two is above it everywhere. A linear program tells whether a
    vector adds to the others at some belief.

    References
    ----------
    Thesis 2.3.6. C. White, "A survey of solution techniques for the partially observed Markov
    decision process", Annals of Operations Research 32, 1991.

    Examples
    --------
    The third is below the upper surface of the first two, the fourth below the third:

    >>> prune([[4, 0], [0, 4], [1.8, 1.8], [1.5, 1.5]])
    array([0, 1])
    """
    A = array("alphas", alphas, (None, None))
    if not A.size:
        raise ValueError(f"alphas must have at least one row and one column, got {A.shape}")
    pairs, _, _ = needed_sums(A, np.zeros((1, A.shape[1])), number("tol", tol, 0, open_high=True))
    return np.sort(pairs[:, 0])


def needed_sums(
    A: Floats, B: Floats, tol: float, seeds: Floats | None = None
) -> tuple[Ints, Floats, float]:
    """Return the pairs (i, j) whose sums A[i] + B[j] form the upper surface of all sums.

    Parameters
    ----------
    A, B : ndarray, shape (N, S) and (M, S)
        The vectors.
    tol : float
        No sum that is left out adds more than this at any belief.
    seeds : ndarray, shape (P, S), optional
        Beliefs where needed sums are likely to be found.

    Returns
    -------
    pairs : ndarray of int, shape (K, 2)
    beliefs : ndarray, shape (K, S)
        A belief at which each is needed.
    lost : float
        No sum that is left out adds more than this: `tol`, or the rounding error if that is larger.
    """
    S = A.shape[1]
    # Only differences matter, and only in states where the vectors differ at all.
    A, B = A - A[0], B - B[0]
    decides = np.flatnonzero((A != 0).any(axis=0) | (B != 0).any(axis=0))
    if not len(decides):
        return np.zeros((1, 2), np.int64), np.full((1, S), 1 / S), 0.0
    A, B = np.ascontiguousarray(A[:, decides]), np.ascontiguousarray(B[:, decides])
    scale = float(np.abs(A).max() + np.abs(B).max())
    A /= scale
    B /= scale
    points = np.eye(len(decides))
    if seeds is not None:
        inside = seeds[:, decides]
        mass = inside.sum(axis=1)
        points = np.concatenate([points, inside[mass > 0] / mass[mass > 0, np.newaxis]])
    eps = max(tol / scale, ROUNDING)
    word_before_compiling(linear_program.prune_sums, "the loops of pruning")
    apart = _apart(A, B)
    room = 2 * (len(A) + len(B)) + 64
    while True:
        pairs, beliefs = np.empty((room, 2), np.int64), np.empty((room, len(decides)))
        count = linear_program.prune_sums(A, B, eps, points, apart, pairs, beliefs)
        if count >= 0:
            break
        points = np.concatenate([points, beliefs])
        room *= 4
    witnesses = np.zeros((count, S))
    witnesses[:, decides] = beliefs[:count]
    return pairs[:count], witnesses, eps * scale


def _apart(A: Floats, B: Floats) -> NDArray[np.bool_]:
    """Return, for each pair (i, j), whether A[i] and B[j] are certainly not best at one belief."""
    apart = np.zeros((len(A), len(B)), np.bool_)
    if 1 in (len(A), len(B), A.shape[1]):
        return apart
    (low_A, high_A), (low_B, high_B) = _box(A), _box(B)
    for s in range(A.shape[1]):
        apart |= np.subtract.outer(low_A[:, s], high_B[:, s]) > APART
        apart |= np.subtract.outer(high_A[:, s], low_B[:, s]) < -APART
    return apart


def _box(A: Floats) -> tuple[Floats, Floats]:
    """Return bounds low <= b <= high on the beliefs where each vector is the best of all.

    Each bound compares two vectors at a time. With two states the bounds are exact: they are the
    ends of an interval.
    """
    low, high = np.zeros(A.shape), np.ones(A.shape)
    for i, a in enumerate(A):
        lead = np.delete(a - A, i, axis=0)
        order = np.sort(lead, axis=1)
        # In a state where `a` is behind, its largest lead elsewhere has to make up for it.
        behind, most = np.minimum(lead, -TINY), np.maximum(order[:, -1:], 0)
        high[i] = np.where(lead < 0, most / (most - behind), 1).min(axis=0)
        # If `a` is ahead in one state only, that state makes up for the smallest lag elsewhere.
        only = order[:, -2] < 0
        state, next_best = lead[only].argmax(axis=1), order[only, -2]
        np.maximum.at(low[i], state, -next_best / (np.maximum(order[only, -1], 0) - next_best))
    return low, high


def distance(A: Floats, C: Floats) -> tuple[float, Floats]:
    """Return a bound on |max_i b . A[i] - max_j b . C[j]| over all beliefs b, and where it is met.

    The upper surface of A is above that of C by at most the gain of A over C, and the other way
    round.
    """
    over, belief, _ = gain(A, C, low=0.0)
    under, other, _ = gain(C, A, low=over)
    return (under, other) if under > over else (over, belief)


def gain(A: Floats, C: Floats, low: float = -np.inf) -> tuple[float, Floats, Floats]:
    """Return the most that some vectors add to others: max_i max_b min_k b . (a_i - c_k).

    Parameters
    ----------
    A, C : ndarray, shape (N, S) and (K, S)
        The vectors, and the others.
    low : float
        Gains below this are of no interest.

    Returns
    -------
    gain : float
        An upper bound that the mixture proves, equal to the gain up to rounding; `low` if the gain
        is not larger. It is negative if all of A lie below the upper surface of C everywhere.
    belief : ndarray, shape (S,)
        Where the gain is greatest.
    mixture : ndarray, shape (K,)
        Weights that sum to 1: ``A[i] - mixture @ C`` is at most the gain in every state.
    """
    K, S = C.shape
    A, C = A - C[0], C - C[0]
    scale = float(max(np.abs(A).max(), np.abs(C).max(), np.finfo(float).tiny))
    belief, mixture = np.full(S, 1 / S), np.zeros(K)
    bound = linear_program.greatest_gain(
        A / scale, np.ascontiguousarray(C.T / scale), low / scale, belief, mixture
    )
    return float(bound * scale) if mixture.any() else low, belief, mixture


@dataclass(frozen=True)
class Domination:
    """A vector that is needed nowhere, and the vectors that dominate it.

    Attributes
    ----------
    index : int
        The dominated vector.
    by : tuple of int
        The vectors that dominate it: a single one if that is enough, else several jointly.
    weights : ndarray, shape (len(by),)
        The proof. The weights sum to 1, and with them the mixture of `by` earns at least as much
        in every state. So at every belief one of `by` does.
    lead : ndarray, shape (len(by), S)
        By how much each of `by` is ahead of the dominated vector in each state. At a belief b the
        leads are ``lead @ b``.
    """

    index: int
    by: tuple[int, ...]
    weights: Floats
    lead: Floats

    def at(self, b: ArrayLike) -> int:
        """Return which of `by` is furthest ahead at a belief.

        Parameters
        ----------
        b : array_like, shape (S,)
            The belief.

        Returns
        -------
        int

        Raises
        ------
        ValueError
            If `b` is not a distribution over the states.
        """
        b = distribution("b", b, (self.lead.shape[1],))
        return self.by[int((self.lead @ b).argmax())]


def dominated(alphas: ArrayLike, tol: float = 1e-9) -> list[Domination]:
    """Return every vector that is needed nowhere, with the vectors that dominate it.

    Parameters
    ----------
    alphas : array_like, shape (K, S)
        The vectors.
    tol : float, default 1e-9
        A vector that adds no more than this anywhere is dominated, in the units of `alphas`.

    Returns
    -------
    list of Domination
        One for each row that `prune` leaves out, in ascending order.

    Raises
    ------
    ValueError
        If `alphas` has another shape or is not finite, or `tol` is negative or infinite.

    Notes
    -----
    In figure 2.17 p_c alone dominates p_d. The thesis says that p_a and p_b dominate p_c
    "similarly", but neither of them is above p_c everywhere. They dominate it only jointly, p_a on
    one side and p_b on the other. A comparison of pairs never finds this. The linear program does,
    and its dual is the proof: a mixture of p_a and p_b that is above p_c everywhere.

    References
    ----------
    Thesis 2.3.6 (figure 2.17).

    Examples
    --------
    >>> pc, pd = dominated([[4, 0], [0, 4], [1.8, 1.8], [1.5, 1.5]])
    >>> pc.index, pc.by, pc.weights
    (2, (0, 1), array([0.5, 0.5]))
    >>> pc.at([0.9, 0.1]), pc.at([0.1, 0.9])
    (0, 1)
    >>> pd.index, pd.by
    (3, (2,))
    """
    A, tol = array("alphas", alphas, (None, None)), number("tol", tol, 0, open_high=True)
    needed = prune(A, tol)
    found = []
    for k in np.setdiff1d(np.arange(len(A)), needed):
        ahead = A - A[k]
        ahead[k] = -np.inf
        alone = np.flatnonzero(ahead.min(axis=1) >= -tol)
        if len(alone):  # take the lowest of those that are above it everywhere
            by = alone[[ahead[alone].sum(axis=1).argmin()]]
            weights: Floats = np.ones(1)
        else:
            _, _, mixture = gain(A[[k]], A[needed])
            by, weights = needed[mixture > 0], mixture[mixture > 0]
        found.append(Domination(int(k), tuple(map(int, by)), weights, A[by] - A[k]))
    return found
