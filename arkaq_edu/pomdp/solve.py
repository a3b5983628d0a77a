"""Exact value iteration over beliefs, by incremental pruning."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import integer, number
from arkaq_edu.pomdp._points import improve
from arkaq_edu.pomdp.graph import PolicyGraph, settle
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.pruning import distance, needed_sums
from arkaq_edu.pomdp.value import ValueFunction

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]


class Backup(NamedTuple):
    """One exact step of value iteration: the vectors of H V and how they came about."""

    alphas: Floats
    actions: Ints
    branches: Ints  # for each observation the row of V
    beliefs: Floats  # where each vector is needed
    lost: float  # what pruning may have left out


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
        With a horizon, `shorter` leads through all the shorter ones. Without it, where the plans
        close to a policy graph, what that graph earns, exactly; in any case `error` says how far
        from V* it is at most.

    Raises
    ------
    ValueError
        If `pomdp` is none, `horizon` is not an integer >= 1 or `tol` is not above 0.

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
    simplex, H V is within r gamma / (1 - gamma) of V*; what pruning leaves out is counted too.

    How many vectors are needed depends on the problem, and can grow beyond any patience: then
    `solve_point_based` gives bounds. The first call compiles the loops of pruning, which takes some
    ten seconds, once.

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
    if not isinstance(pomdp, POMDP):
        raise ValueError(f"pomdp must be a POMDP, got {pomdp!r}")
    tol = number("tol", tol, 0, open_low=True)
    if horizon is None:
        return _endless(pomdp, tol)
    horizon = integer("horizon", horizon, 1)
    alphas = np.ascontiguousarray(pomdp.R.T)
    pairs, beliefs, lost = needed_sums(alphas, np.zeros((1, pomdp.n_states)), 0.0)
    actions = np.sort(pairs[:, 0])
    V = ValueFunction(
        alphas[actions], actions, np.empty((len(actions), 0), np.int64), None, lost, 1
    )
    for steps in range(2, horizon + 1):
        step = backup(pomdp, V.alphas, 0.0, beliefs)
        beliefs = step.beliefs
        error = step.lost + pomdp.gamma * V.error
        V = ValueFunction(step.alphas, step.actions, step.branches, V, error, steps)
    return V


def _endless(pomdp: POMDP, tol: float) -> ValueFunction:
    """Iterate until the certified bound is within `tol`."""
    gamma, corners = pomdp.gamma, np.eye(pomdp.n_states)
    # What each action earns if it is taken for ever: V = R + gamma T V.
    alphas = np.linalg.solve(corners - gamma * pomdp.T, pomdp.R.T[:, :, np.newaxis])[:, :, 0]
    finest = tol * (1 - gamma) / 4
    residual, beliefs = float(np.ptp(pomdp.R)), corners
    part = 1 / 20
    while True:
        # Pruning need not be finer than a part of what the iteration still lacks.
        coarse = max(part * residual, finest)
        step = backup(pomdp, alphas, coarse, beliefs)
        before = residual
        residual, where = distance(step.alphas, alphas)
        if residual > 0.9 * before:
            part /= 2
        error = (gamma * residual + step.lost) / (1 - gamma)
        rounding = max(step.lost, 1e-13 * np.abs(alphas).max())
        in_vain = rounding > max(1.01 * coarse, residual, 2 * finest)
        if error <= tol or in_vain:
            break
        beliefs = np.concatenate([step.beliefs, corners, where[np.newaxis]])
        enough = max(residual, finest) * (1 - gamma) / 10
        both = np.concatenate([step.alphas, improve(pomdp, step.alphas, beliefs, enough)])
        pairs, _, _ = needed_sums(both, np.zeros((1, pomdp.n_states)), coarse / 10, beliefs)
        alphas = both[np.sort(pairs[:, 0])]
    # Where the iteration came to rest a graph can be proved as finely as floats allow.
    tol_of_graph = 0.0 if residual < finest / 100 else finest
    V = _close(pomdp, step, alphas, tol_of_graph)
    if V.error > max(tol, error):
        V = ValueFunction(step.alphas, step.actions, step.branches[:, :0], None, error)
    if V.error > tol:
        warnings.warn(
            f"tol={tol:g} is finer than rounding lets be proved here: error={V.error:.2g}",
            RuntimeWarning,
            stacklevel=3,
        )
    return V


def _close(pomdp: POMDP, step: Backup, alphas: Floats, tol: float) -> ValueFunction:
    """Return what a policy graph on the plans of H V earns, and how far from V* that is at most."""
    # Where a plan went on with a vector of V, the graph goes on with the nearest of H V.
    nearest = np.array([np.abs(step.alphas - alpha).max(axis=1).argmin() for alpha in alphas])
    graph = PolicyGraph(step.actions, nearest[step.branches])
    earned = settle(pomdp, graph, step.alphas)
    again = backup(pomdp, earned, tol, step.beliefs)
    error = (distance(again.alphas, earned)[0] + again.lost) / (1 - pomdp.gamma)
    return ValueFunction(earned, graph.actions, graph.branches, None, error)


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

    Raises
    ------
    ValueError
        If `V` is over another number of states.

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
    n_states = V.alphas.shape[1]
    if n_states != pomdp.n_states:
        raise ValueError(f"V must be over {pomdp.n_states} states, got one over {n_states}")
    step = backup(pomdp, V.alphas, 0.0)
    return distance(step.alphas, V.alphas)[0] + step.lost


def backup(pomdp: POMDP, alphas: Floats, tol: float, beliefs: Floats | None = None) -> Backup:
    """Return H V for the upper surface V of some vectors; pruning may leave out `tol` in all.

    `beliefs` are where needed vectors are likely to be found.
    """
    # Each observation is pruned alone and joined to those before; then the actions.
    eps = tol / (2 * pomdp.n_observations)
    parts = []
    for a in range(pomdp.n_actions):
        # What vector k is worth before a, if z follows: gamma sum_t T(s, a, t) O(t, a, z) V_k(t).
        ahead = pomdp.gamma * (pomdp.O[a].T[:, np.newaxis] * alphas) @ pomdp.T[a].T
        parts.append(_join(pomdp.R[:, a], ahead, eps, beliefs))
    vectors = np.concatenate([part[0] for part in parts])
    actions = np.repeat(np.arange(pomdp.n_actions), [len(part[0]) for part in parts])
    branches = np.concatenate([part[1] for part in parts])
    zero = np.zeros((1, pomdp.n_states))
    pairs, where, lost = needed_sums(vectors, zero, eps, beliefs)
    order = pairs[:, 0].argsort()
    rows = pairs[order, 0]
    lost += max(part[2] for part in parts)
    return Backup(vectors[rows], actions[rows], branches[rows], where[order], lost)


def _join(
    rewards: Floats, ahead: Floats, eps: float, beliefs: Floats | None
) -> tuple[Floats, Ints, float]:
    """Return the needed sums of one vector for each observation, which they took, what is lost."""
    zero = np.zeros((1, len(rewards)))
    total = 0.0
    parts = []
    for vectors in ahead:
        pairs, _, lost = needed_sums(vectors, zero, eps, beliefs)
        parts.append((vectors[pairs[:, 0]], pairs[:, 0]))
        total += lost
    sums: Floats = rewards.reshape(1, -1)
    taken = np.zeros((1, len(parts)), np.int64)
    # The smallest first, so that there are few sums for long.
    for z in sorted(range(len(parts)), key=lambda z: len(parts[z][1])):
        vectors, rows = parts[z]
        if len(rows) == 1 or len(sums) == 1:  # nothing to choose: all are needed
            pairs = np.argwhere(np.ones((len(sums), len(rows))))
        else:
            pairs, _, lost = needed_sums(sums, vectors, eps, beliefs)
            total += lost
        sums, taken = sums[pairs[:, 0]] + vectors[pairs[:, 1]], taken[pairs[:, 0]]
        taken[:, z] = rows[pairs[:, 1]]
    return sums, taken, total
