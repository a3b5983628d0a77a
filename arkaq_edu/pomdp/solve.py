"""Exact value iteration over beliefs, by incremental pruning."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import integer, number
from arkaq_edu.pomdp._points import improve
from arkaq_edu.pomdp.graph import PolicyGraph
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.pruning import gain, needed_sums
from arkaq_edu.pomdp.value import ValueFunction

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]

# What pruning may leave out, relative to the rewards, where nothing coarser is asked for.
FINE = 1e-11


class Backup(NamedTuple):
    """One exact step of value iteration: the vectors of H V and how they came about."""

    alphas: Floats
    actions: Ints
    branches: Ints
    beliefs: Floats


def solve_pomdp(pomdp: POMDP, horizon: int | None = None, tol: float = 1e-6) -> ValueFunction:
    """Return the optimal value function over beliefs, exactly or to a certified tolerance.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    horizon : int, optional
        The number of steps still to go, at least 1; without it the future has no end.
    tol : float, default 1e-6
        With no horizon: the values returned are this close to V* at every belief, certified by
        linear programs. With a horizon they are exact up to the rounding of floats.

    Returns
    -------
    ValueFunction
        With a horizon, `shorter` leads through all the shorter ones. Without it, the value of a
        policy graph, which earns exactly these values, where one was found; `error` says how far
        from V* they are at most.

    Raises
    ------
    ValueError
        If `horizon` is not an integer >= 1 or `tol` is not above 0.

    Notes
    -----
    One step H of value iteration gives, at a belief, the best action's reward and what the best
    vector of V earns after each observation. As a set of vectors this is, for each action, the
    sum over the observations of all choices of a vector; incremental pruning adds one observation
    at a time and leaves out what is needed nowhere before the next is added.

    Without a horizon the iteration starts from policies that never change their action, so from
    below V*. Between two exact steps cheap ones look only at the beliefs where the last exact
    step found its vectors needed, and a policy graph that no longer changes is evaluated by its
    linear system (E. Hansen, UAI 1998; N. Zhang, W. Zhang, JAIR 14, 2001). They need no proof:
    the exact step after them measures what they came to. With r the largest |H V - V| over the
    simplex, H V is within r gamma / (1 - gamma) of V*.

    References
    ----------
    Thesis 2.3.4 and 2.3.5. A. Cassandra, M. Littman, N. Zhang, "Incremental pruning: a simple,
    fast, exact method for partially observable Markov decision processes", UAI 1997.

    Examples
    --------
    The ball is left or right of the robot and stays there. A look errs in one of ten cases; a kick
    to the right side earns 1, to the wrong side costs 1.

    >>> any_state = np.full((2, 2), 0.5)
    >>> pomdp = POMDP(T=[np.eye(2), any_state, any_state],
    ...               O=[[[0.9, 0.1], [0.1, 0.9]], any_state, any_state],
    ...               R=[[0, 1, -1], [0, -1, 1]], gamma=0.9)
    >>> V = solve_pomdp(pomdp, horizon=2)
    >>> round(V.value([0.5, 0.5]), 9), V.action([0.5, 0.5])
    (0.72, 0)
    >>> print(V.tree(V.best([0.5, 0.5])))
    0
      0: 1
      1: 2
    """
    tol = number("tol", tol, 0, open_low=True)
    if horizon is None:
        return _endless(pomdp, tol)
    V = _one_step(pomdp)
    for _ in range(integer("horizon", horizon, 1) - 1):
        step, lost = backup(pomdp, V.alphas, 0.0)
        error = lost + pomdp.gamma * V.error
        V = ValueFunction(step.alphas, step.actions, step.branches, V, error)
    return V


def bellman_error(pomdp: POMDP, V: ValueFunction) -> float:
    """Return a certified bound on |H V - V| over the whole simplex.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    V : ValueFunction
        Any value function over its beliefs.

    Returns
    -------
    float
        V is within this over 1 - gamma of V*.

    Notes
    -----
    H V and V are both upper surfaces of finitely many vectors, a_i and c_j. The largest of
    (H V - V)(b) = max_i a_i . b - max_j c_j . b over the simplex is the largest, over i, of
    max_b min_j (a_i - c_j) . b: a linear program for each a_i, and likewise the other way round.
    Each is bounded by its dual, so no belief is overlooked, as samples of beliefs would.

    Examples
    --------
    >>> pomdp = POMDP(T=[np.eye(2)], O=[[[1], [1]]], R=[[1], [3]], gamma=0.5)
    >>> V = solve_pomdp(pomdp, horizon=1)
    >>> round(bellman_error(pomdp, V), 9)
    1.5
    """
    step, lost = backup(pomdp, V.alphas, 0.0)
    return float(distance(step.alphas, V.alphas)[0] + lost)


def distance(A: Floats, C: Floats) -> tuple[float, Floats]:
    """Return a certified bound on |max_i b . A[i] - max_j b . C[j]|, and the belief where it is."""
    largest, where = 0.0, np.full(A.shape[1], 1 / A.shape[1])
    for over, under in ((A, C), (C, A)):
        for w in over:
            gained, belief, _ = gain(w, under, low=largest)
            if gained > largest:
                largest, where = gained, belief
    return largest, where


def backup(
    pomdp: POMDP, alphas: Floats, tol: float, seeds: Floats | None = None
) -> tuple[Backup, float]:
    """Return H V for the upper surface V of some vectors, up to `tol`, and what may be lost."""
    scale = np.abs(pomdp.R).max() + pomdp.gamma * np.abs(alphas).max()
    Z = pomdp.n_observations
    # Each observation is pruned alone and joined to those before; then the actions.
    prunings = 2 * Z
    eps = max(tol / prunings, FINE * scale)
    sets = []
    for a in range(pomdp.n_actions):
        # What vector k is worth before a, if z follows: gamma sum_t T(s, a, t) O(t, a, z) V_k(t).
        ahead = pomdp.gamma * (pomdp.O[a].T[:, np.newaxis] * alphas) @ pomdp.T[a].T
        sets.append(_join(pomdp.R[:, a], ahead, eps, seeds))
    everything = np.concatenate([s[0] for s in sets])
    actions = np.repeat(np.arange(pomdp.n_actions), [len(s[0]) for s in sets])
    branches = np.concatenate([s[1] for s in sets])
    zero = np.zeros((1, pomdp.n_states))
    pairs, beliefs = needed_sums(everything, zero, eps, seeds)
    order = pairs[:, 0].argsort()
    rows = pairs[order, 0]
    step = Backup(everything[rows], actions[rows], branches[rows], beliefs[order])
    return step, eps * prunings


def _join(rewards: Floats, ahead: Floats, eps: float, seeds: Floats | None) -> tuple[Floats, Ints]:
    """Return the needed sums of a vector for each observation, and which each took."""
    zero = np.zeros((1, len(rewards)))
    parts = []
    for vectors in ahead:
        rows = needed_sums(vectors, zero, eps, seeds)[0][:, 0]
        parts.append((vectors[rows], rows))
    # The smallest first, so that there are few sums for long.
    order = sorted(range(len(parts)), key=lambda z: len(parts[z][1]))
    sums: Floats = rewards.reshape(1, -1)
    taken = np.zeros((1, len(parts)), np.int64)
    for z in order:
        vectors, rows = parts[z]
        if len(rows) == 1 or len(sums) == 1:
            pairs = np.argwhere(np.ones((len(sums), len(rows))))
        else:
            pairs = needed_sums(sums, vectors, eps, seeds)[0]
        sums, taken = sums[pairs[:, 0]] + vectors[pairs[:, 1]], taken[pairs[:, 0]]
        taken[:, z] = rows[pairs[:, 1]]
    return sums, taken


def _one_step(pomdp: POMDP) -> ValueFunction:
    alphas = np.ascontiguousarray(pomdp.R.T)
    pairs, _ = needed_sums(alphas, np.zeros((1, pomdp.n_states)), FINE * np.abs(alphas).max())
    actions = np.sort(pairs[:, 0])
    return ValueFunction(alphas[actions], actions, np.empty((len(actions), 0), np.int64))


def _endless(pomdp: POMDP, tol: float) -> ValueFunction:
    """Iterate until the certified bound is within `tol`."""
    gamma, Z = pomdp.gamma, pomdp.n_observations
    n, corners = np.arange(pomdp.n_actions), np.eye(pomdp.n_states)
    alphas: Floats = PolicyGraph(n, np.repeat(n[:, np.newaxis], Z, axis=1)).values(pomdp)
    wanted = tol * (1 - gamma)
    residual, seeds = float(np.ptp(pomdp.R)), corners
    while True:
        # Pruning need not be finer than what the iteration still lacks.
        coarse = max(wanted / 4, residual / 20)
        step, lost = backup(pomdp, alphas, coarse, seeds)
        residual, where = distance(step.alphas, alphas)
        error = (gamma * residual + lost) / (1 - gamma)
        if error <= tol:
            break
        seeds = np.concatenate([step.beliefs, corners, where[np.newaxis]])
        better = improve(pomdp, step.alphas, seeds, max(residual, wanted) * (1 - gamma) / 10)
        both = np.concatenate([step.alphas, better])
        pairs, _ = needed_sums(both, np.zeros((1, pomdp.n_states)), coarse / 10, seeds)
        alphas = both[np.sort(pairs[:, 0])]
    closed = _close(pomdp, step, alphas, tol)
    if closed is not None:
        return closed
    before = ValueFunction(alphas, np.full(len(alphas), -1), np.empty((len(alphas), 0), np.int64))
    return ValueFunction(step.alphas, step.actions, step.branches, before, error)


def _close(pomdp: POMDP, step: Backup, alphas: Floats, tol: float) -> ValueFunction | None:
    """Return the value of the policy graph that H V and V make together, if it is good enough."""
    # Where a plan goes on with vector j of V, the graph goes on with the nearest of H V.
    nearest = np.array([np.abs(step.alphas - alpha).max(axis=1).argmin() for alpha in alphas])
    graph = PolicyGraph(step.actions, nearest[step.branches])
    if len(graph) * pomdp.n_states > 3000:
        return None
    V = ValueFunction(graph.values(pomdp), graph.actions, graph.branches)
    again, lost = backup(pomdp, V.alphas, 0.0, step.beliefs)
    error = (distance(again.alphas, V.alphas)[0] + lost) / (1 - pomdp.gamma)
    return ValueFunction(V.alphas, V.actions, V.branches, None, error) if error <= tol else None
