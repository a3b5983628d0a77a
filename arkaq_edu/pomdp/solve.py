"""Exact value iteration over beliefs."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from arkaq_edu._checks import integer, number, shown
from arkaq_edu.pomdp.backup import Backup, backup, point_backup
from arkaq_edu.pomdp.files import problem
from arkaq_edu.pomdp.graph import PolicyGraph, follow, settle, steps_and_rewards
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.pruning import distance, needed_sums
from arkaq_edu.pomdp.value import ValueFunction

Floats = NDArray[np.floating]

# The certified error is (gamma residual + lost) / (1 - gamma). Pruning may use up this share of the
# tolerance in the end; the larger rest is for the residual.
PRUNING_SHARE = 1 / 4
# Until then pruning may lose this share of the last residual: what it loses now matters little
# beside what is still to come, and fewer vectors are faster.
COARSE = 1 / 20
# If a step leaves more than this share of the residual, pruning was too coarse: halve its share.
TOO_LITTLE = 0.9
# Pruning loses what it is allowed, up to rounding of 1 %. If it loses more, floats are too coarse.
ROUNDED_UP = 1.01
# Values are sums of many terms, each rounded to 1e-16: they may be off by this share.
ROUNDING = 1e-13
# Improvement at points ends at this share of the change that the next exact step could still see;
# merging what it found prunes finer than the exact step by the same factor.
FINER = 1 / 10
# A residual below this share of the finest pruning counts as zero: the vectors no longer change.
AT_REST = 1 / 100
# A point is moved this far to the middle of all beliefs, so that of equal choices the one is taken
# that is also good in the states which the point excludes.
TO_THE_MIDDLE = 1e-6


# A longer horizon takes days, and its value functions more memory than there is.
MOST_STEPS = 10**6


def solve_pomdp(pomdp: POMDP, horizon: int | None = None, tol: float = 1e-6) -> ValueFunction:
    """Return the optimal value function over beliefs, exactly or to a certified tolerance.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    horizon : int, optional
        The number of steps to go, at least 1. Without it the future has no end.
    tol : float, default 1e-6
        Without a horizon, the values are this close to V* at every belief, certified by linear
        programs. With a horizon they are exact up to rounding.

    Returns
    -------
    ValueFunction
        With a horizon, `shorter` leads to the value functions of all shorter ones. Without a
        horizon it is what a policy graph earns, if the plans form one. In any case `error` bounds
        the distance from V*.

    Raises
    ------
    ValueError
        If `pomdp` is not a POMDP, `horizon` is not an integer from 1 to a million, `tol` is not
        above 0, or the discount is 1 and there is no horizon.

    Notes
    -----
    One step H of value iteration adds, at a belief, the best action's reward and what the best
    vector of V earns after each observation. As a set of vectors this is, for each action, the
    sum over the observations of all choices of a vector. Incremental pruning adds one observation
    at a time, and leaves out what is needed nowhere before it adds the next.

    Without a horizon the iteration starts from policies that never change their action, and so
    from below V*. Between two exact steps, cheap steps improve the vectors only at the beliefs
    where the last exact step needed them. They prove nothing; the next exact step measures
    what they achieved. With r the largest |H V - V| over the simplex, H V is within
    r gamma / (1 - gamma) of V*, and what pruning lost comes on top. In the end the plans are closed
    to a policy graph, which is evaluated exactly.

    The number of vectors depends on the problem and can grow without limit. Then
    `solve_point_based` gives bounds. The first call compiles the loops of pruning, which takes
    some ten seconds, once. A progress bar shows after two seconds.

    References
    ----------
    Thesis 2.3.4 and 2.3.5. A. Cassandra, M. Littman, N. Zhang, "Incremental pruning: a simple,
    fast, exact method for partially observable Markov decision processes", UAI 1997. E. Hansen,
    "Solving POMDPs by searching in policy space", UAI 1998. N. Zhang, W. Zhang, "Speeding up the
    convergence of value iteration in partially observable Markov decision processes", Journal of
    Artificial Intelligence Research 14, 2001.

    Examples
    --------
    The ball is left or right of the robot and stays there. A look errs in one of ten cases. A kick
    to the right side earns 1, a kick to the wrong side costs 1.

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
        raise ValueError(f"pomdp must be a POMDP, got {shown(pomdp)}")
    tol = number("tol", tol, 0, open_low=True, open_high=True)
    if horizon is not None:
        return _finite(pomdp.dense(), integer("horizon", horizon, 1, MOST_STEPS))
    if pomdp.gamma == 1:
        raise ValueError(
            "horizon must be an integer >= 1, because gamma is 1: without an end the values are "
            "not finite"
        )
    return _endless(pomdp.dense(), tol)


@lru_cache(maxsize=32)
def solved(name: str, horizon: int) -> ValueFunction:
    """Return the value function of one of the course's problems; each is solved only once.

    Parameters
    ----------
    name : str
        The problem, as `problem` knows it.
    horizon : int
        The number of steps to go.

    Returns
    -------
    ValueFunction

    Examples
    --------
    >>> [len(solved("two_state", horizon)) for horizon in (1, 2, 3)]
    [2, 4, 7]
    """
    return solve_pomdp(problem(name), horizon)


def _finite(pomdp: POMDP, horizon: int) -> ValueFunction:
    """Return the value function of a horizon: one exact step after the other."""
    alphas = np.ascontiguousarray(pomdp.R.T)  # equation 2.18
    pairs, beliefs, lost = needed_sums(alphas, np.zeros((1, pomdp.n_states)), 0.0)
    actions = np.sort(pairs[:, 0])
    branches = np.empty((len(actions), 0), np.int64)
    V = ValueFunction(alphas[actions], actions, branches, None, lost, 1)
    for steps in tqdm(range(2, horizon + 1), "steps", delay=2, disable=None, leave=False):
        step = backup(pomdp, V.alphas, 0.0, beliefs)
        beliefs = step.beliefs
        error = step.lost + pomdp.gamma * V.error
        V = ValueFunction(step.alphas, step.actions, step.branches, V, error, steps)
    return V


def _endless(pomdp: POMDP, tol: float) -> ValueFunction:
    """Iterate until the certified error is within `tol`."""
    gamma, corners = pomdp.gamma, np.eye(pomdp.n_states)
    # What each action earns if it is taken for ever: V = R + gamma T V.
    alphas = np.linalg.solve(corners - gamma * pomdp.T, pomdp.R.T[:, :, np.newaxis])[:, :, 0]
    finest = PRUNING_SHARE * tol * (1 - gamma)
    residual, beliefs, share = float(np.ptp(pomdp.R)), corners, COARSE
    bar = tqdm(desc="steps", unit="step", delay=2, disable=None, leave=False)
    while True:
        bar.update()
        allowed = max(share * residual, finest)
        step = backup(pomdp, alphas, allowed, beliefs)
        before = residual
        residual, where = distance(step.alphas, alphas)
        if residual > TOO_LITTLE * before:
            share /= 2
        error = (gamma * residual + step.lost) / (1 - gamma)
        bar.set_postfix(error=f"{error:.2g}", refresh=False)
        rounding = max(step.lost, ROUNDING * np.abs(alphas).max())
        if error <= tol or rounding > max(ROUNDED_UP * allowed, residual, 2 * finest):
            break
        beliefs = np.concatenate([step.beliefs, corners, where[np.newaxis]])
        enough = max(residual, finest) * (1 - gamma) * FINER
        both = np.concatenate([step.alphas, _improve(pomdp, step.alphas, beliefs, enough)])
        zero = np.zeros((1, pomdp.n_states))
        pairs, _, _ = needed_sums(both, zero, allowed * FINER, beliefs)
        alphas = both[np.sort(pairs[:, 0])]
    bar.close()
    V = _close(pomdp, step, alphas, 0.0 if residual < AT_REST * finest else finest)
    if V.error > max(tol, error):
        V = ValueFunction(step.alphas, step.actions, step.branches[:, :0], None, error)
    if V.error > tol:
        warnings.warn(
            f"tol={tol:g} is finer than rounding allows to prove here: error={V.error:.2g}",
            RuntimeWarning,
            stacklevel=3,
        )
    return V


def _improve(pomdp: POMDP, alphas: Floats, points: Floats, enough: float) -> Floats:
    """Return a vector for each point, at least as good there as the best of `alphas`.

    Policy iteration at the points: choose an action and branches at each, follow the choices, until
    no value rises by more than `enough`. A vector that would lower the value of its point is not
    taken.
    """
    steps, rewards = steps_and_rewards(pomdp)
    points = (1 - TO_THE_MIDDLE) * points + TO_THE_MIDDLE / pomdp.n_states
    alphas = alphas[(points @ alphas.T).argmax(axis=1)]
    values = (points * alphas).sum(axis=1)
    rows = np.arange(len(points))
    enough = max(enough, 0.1 * ROUNDING * np.abs(alphas).max())  # less may be rounding
    while True:
        once, actions, branches = point_backup(pomdp, alphas, points)
        always = once.copy()
        follow(steps, rewards, actions, branches, enough * FINER, 1000, always)
        improved = np.concatenate([once, always])
        now = points @ improved.T
        best = now.argmax(axis=1)
        rise = now[rows, best] - values
        up = rise > 0
        alphas[up], values[up] = improved[best[up]], now[rows, best][up]
        if not rise.max() > enough:
            return alphas


def _close(pomdp: POMDP, step: Backup, alphas: Floats, tol: float) -> ValueFunction:
    """Return what a policy graph on the plans of H V earns, with its certified error."""
    # Where a plan went on with a vector of V, the graph goes on with the nearest one of H V.
    nearest = np.array([np.abs(step.alphas - alpha).max(axis=1).argmin() for alpha in alphas])
    graph = PolicyGraph(step.actions, nearest[step.branches])
    earned = settle(pomdp, graph, step.alphas)
    V = ValueFunction(earned, graph.actions, graph.branches)
    return replace(V, error=bellman_error(pomdp, V, tol, step.beliefs) / (1 - pomdp.gamma))


def bellman_error(
    pomdp: POMDP, V: ValueFunction, tol: float = 0.0, beliefs: Floats | None = None
) -> float:
    """Return a certified bound on |H V - V| over the whole simplex.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    V : ValueFunction
        Any value function over its beliefs.
    tol : float, default 0
        The bound may be this much too large. A coarser one is faster.
    beliefs : ndarray, shape (P, S), optional
        Beliefs where vectors of H V are likely to be needed. They only save time.

    Returns
    -------
    float
        V is within this over 1 - gamma of V*.

    Raises
    ------
    ValueError
        If `V` is over another number of states, or `tol` is negative or infinite.

    Notes
    -----
    H V and V are both upper surfaces of finitely many vectors. The largest distance between them
    is found by a linear program for each vector, which proves it for every belief. Samples of
    beliefs could miss it.

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
    tol = number("tol", tol, 0, open_high=True)
    step = backup(pomdp.dense(), V.alphas, tol, beliefs)
    return distance(step.alphas, V.alphas)[0] + step.lost
