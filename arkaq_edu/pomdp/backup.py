"""One step of value iteration, H: the best action now, then the best vector of V (equation 2.19).

`backup` makes all vectors of H V, by incremental pruning. `point_backup` makes only those that are
best at some given beliefs, which is much cheaper. `candidates` makes the vectors from which the
pruning chooses.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.pruning import needed_sums
from arkaq_edu.pomdp.value import ValueFunction

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]


class Backup(NamedTuple):
    """The vectors of H V, and how they came about.

    Attributes
    ----------
    alphas : ndarray, shape (K, S)
        The vectors.
    actions : ndarray of int, shape (K,)
        The first action of each.
    branches : ndarray of int, shape (K, Z)
        The row of V that follows each observation.
    beliefs : ndarray, shape (K, S)
        A belief at which each is needed.
    lost : float
        At no belief did pruning lose more than this.
    """

    alphas: Floats
    actions: Ints
    branches: Ints
    beliefs: Floats
    lost: float


def backup(pomdp: POMDP, alphas: Floats, tol: float, beliefs: Floats | None = None) -> Backup:
    """Return H V for the upper surface V of some vectors, by incremental pruning.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    alphas : ndarray, shape (N, S)
        The vectors of V.
    tol : float
        Pruning may lose this much at any belief.
    beliefs : ndarray, shape (P, S), optional
        Beliefs where needed vectors are likely to be found.

    Returns
    -------
    Backup

    Examples
    --------
    >>> pomdp = POMDP(T=[np.eye(2)] * 2, O=[[[1], [1]]] * 2, R=[[1, 0], [0, 1]], gamma=0.5)
    >>> step = backup(pomdp, pomdp.R.T, 0.0)
    >>> step.alphas, step.actions
    (array([[1.5, 0. ], [0. , 1.5]]), array([0, 1]))
    """
    R, T, O, gamma = pomdp.R, pomdp.T, pomdp.O, pomdp.gamma  # noqa: E741
    eps = tol / (2 * pomdp.n_observations)  # at most 2 Z prunings add up to tol
    parts = []
    for a in range(pomdp.n_actions):
        # Equation 2.19 for each z alone: gamma sum_s' T(s, a, s') O(s', a, z) V_z(s').
        later = gamma * (O[a].T[:, np.newaxis] * alphas) @ T[a].T  # (Z, N, S)
        parts.append(_sums(R[:, a], later, eps, beliefs))
    vectors = np.concatenate([part[0] for part in parts])
    actions = np.repeat(np.arange(pomdp.n_actions), [len(part[0]) for part in parts])
    branches = np.concatenate([part[1] for part in parts])
    rows, where, lost = _needed(vectors, eps, beliefs)
    order = rows.argsort()
    rows = rows[order]
    lost += max(part[2] for part in parts)
    return Backup(vectors[rows], actions[rows], branches[rows], where[order], lost)


def _sums(
    rewards: Floats, later: Floats, eps: float, beliefs: Floats | None
) -> tuple[Floats, Ints, float]:
    """Return the needed sums of the rewards and one vector for each observation.

    Incremental pruning: each observation is pruned alone, then added to the sums of those before.
    Return also which vectors each sum takes, and what was lost.
    """
    parts = [_needed(vectors, eps, beliefs) for vectors in later]
    lost = sum(part[2] for part in parts)
    sums: Floats = rewards.reshape(1, -1)
    taken = np.zeros((1, len(parts)), np.int64)
    # The observations with the fewest vectors come first, which keeps the sums few for long.
    for z in sorted(range(len(parts)), key=lambda z: len(parts[z][0])):
        rows = parts[z][0]
        vectors = later[z][rows]
        if len(rows) == 1 or len(sums) == 1:  # then every sum is needed
            pairs = np.argwhere(np.ones((len(sums), len(rows))))
        else:
            pairs, _, more = needed_sums(sums, vectors, eps, beliefs)
            lost += more
        sums, taken = sums[pairs[:, 0]] + vectors[pairs[:, 1]], taken[pairs[:, 0]]
        taken[:, z] = rows[pairs[:, 1]]
    return sums, taken, lost


def _needed(vectors: Floats, eps: float, beliefs: Floats | None) -> tuple[Ints, Floats, float]:
    """Return which vectors are needed, beliefs at which they are, and what was lost."""
    pairs, where, lost = needed_sums(vectors, np.zeros((1, vectors.shape[1])), eps, beliefs)
    return pairs[:, 0], where, lost


def point_backup(pomdp: POMDP, alphas: Floats, points: Floats) -> tuple[Floats, Ints, Ints]:
    """Return the vector of H V that is best at each point, its action, and its branches.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    alphas : ndarray, shape (K, S)
        The vectors of V.
    points : ndarray, shape (N, S)
        The beliefs.

    Returns
    -------
    vectors : ndarray, shape (N, S)
    actions : ndarray of int, shape (N,)
    branches : ndarray of int, shape (N, Z)
    """
    N = len(points)
    vectors = np.empty((pomdp.n_actions, N, pomdp.n_states))
    branches = np.empty((pomdp.n_actions, N, pomdp.n_observations), np.int64)
    for a, (T, O, R) in enumerate(zip(pomdp.T, pomdp.O, pomdp.R.T, strict=True)):  # noqa: E741
        joint = (points @ T)[:, np.newaxis] * O.T  # (N, Z, S): Pr(s', z | b, a)
        branches[a] = (joint @ alphas.T).argmax(axis=2)
        # Equation 2.19 with the best branch of each observation.
        later = (O.T * alphas[branches[a]]).sum(axis=1)
        vectors[a] = R + pomdp.gamma * later @ T.T
    actions = (vectors * points).sum(axis=2).argmax(axis=0)
    rows = np.arange(N)
    return vectors[actions, rows], actions, branches[actions, rows]


def n_candidates(pomdp: POMDP, V: ValueFunction) -> int:
    """Return from how many plans those of a value function with a horizon were chosen.

    A candidate is an action, and for each observation a plan that is needed with a step less to go.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    V : ValueFunction
        Its value function, with a horizon.

    Returns
    -------
    int

    Examples
    --------
    >>> from arkaq_edu.pomdp import problem, solve_pomdp
    >>> pomdp = problem("two_state")
    >>> [n_candidates(pomdp, solve_pomdp(pomdp, horizon)) for horizon in (1, 2, 3)]
    [2, 16, 128]
    """
    return pomdp.n_actions * (len(V.shorter) ** pomdp.n_observations if V.shorter else 1)


def candidates(pomdp: POMDP, V: ValueFunction, at_most: int) -> Floats:
    """Return the vectors of the plans from which those of V were chosen, or a part of them.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    V : ValueFunction
        Its value function, with a horizon.
    at_most : int
        If there are more candidates than this, take so many, evenly spread.

    Returns
    -------
    ndarray, shape (N, S)

    Examples
    --------
    >>> from arkaq_edu.pomdp import problem, solve_pomdp
    >>> pomdp = problem("two_state")
    >>> [candidates(pomdp, solve_pomdp(pomdp, horizon), 128).shape for horizon in (2, 4)]
    [(16, 2), (128, 2)]
    """
    if V.shorter is None:
        return pomdp.R.T
    total, shorter = n_candidates(pomdp, V), V.shorter.alphas
    chosen = np.linspace(0, total - 1, min(total, at_most)).astype(int)
    sizes = (pomdp.n_actions, *[len(shorter)] * pomdp.n_observations)
    a, *branches = np.unravel_index(chosen, sizes)
    # Equation 2.19.
    later = sum(pomdp.O[a, :, z] * shorter[k] for z, k in enumerate(branches))
    return pomdp.R.T[a] + pomdp.gamma * np.einsum("ast,at->as", pomdp.T[a], later)
