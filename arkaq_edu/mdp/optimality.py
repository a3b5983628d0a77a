"""What "optimal" means: three models of how much the future counts (thesis 2.1.1)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from arkaq_edu._checks import affordable, array, integers, number
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.planning import finite_horizon, policy_iteration, policy_model

#: The chains of figure 2.2, from the top: the number of steps without a reward, and the reward of
#: each later step.
CHAINS = {"upper": (2, 2.0), "middle": (5, 10.0), "lower": (6, 11.0)}
_DELAYS = tuple(delay for delay, _ in CHAINS.values())
_REWARDS = tuple(reward for _, reward in CHAINS.values())


def delayed_rewards(
    delays: Sequence[int] = _DELAYS,
    rewards: Sequence[float] = _REWARDS,
    gamma: float = 0.9,
) -> MDP:
    """Return the world of figure 2.2: choose once, wait, then earn the same at every step.

    Parameters
    ----------
    delays : sequence of int, default (2, 5, 6)
        The number of steps without a reward after each choice, including the choice itself; each
        at least 1.
    rewards : sequence of float, default (2, 10, 11)
        The reward of each later step.
    gamma : float, default 0.9
        The discount rate. The thesis does not name it, but its results, 16.2, 59 and 58.5, are
        those of 0.9.

    Returns
    -------
    MDP
        The choice is made in state 0; action i leads along chain i.

    Raises
    ------
    ValueError
        If the lengths differ or a delay is not an integer >= 1.

    References
    ----------
    Thesis 2.1.1, figure 2.2. L. Kaelbling, M. Littman, A. Moore, "Reinforcement learning: a
    survey", Journal of Artificial Intelligence Research 4, 1996, figure 2.

    Examples
    --------
    >>> world = delayed_rewards()
    >>> finite_horizon(world, 5)[-1, 0]
    array([6., 0., 0.])
    >>> discounted(world)[0].round(1)
    array([16.2, 59. , 58.5])
    >>> average_reward(world)[0]
    array([ 2., 10., 11.])
    """
    waits = integers("delays", delays, 1)
    if waits.ndim != 1:
        raise ValueError(f"delays must have shape (n,), got {waits.shape}")
    n = len(waits)
    earned = array("rewards", rewards, (n,))
    n_states = 1 + int(waits.sum())
    T = np.zeros(affordable("delays", (n, n_states, n_states)))
    R = np.zeros((n_states, n))
    last = waits.cumsum()
    for a in range(n):
        first = last[a] - waits[a] + 1
        T[a, 0, first] = 1
        for s in range(first, last[a]):
            T[:, s, s + 1] = 1
        T[:, last[a], last[a]] = 1
        R[last[a]] = earned[a]
    return MDP(T, R, number("gamma", gamma, 0, 1, open_high=True), np.eye(n_states)[0])


def earnings(horizon: int, gamma: float) -> NDArray[np.float64]:
    """Return what the chains of figure 2.2 earn by each of the three models.

    Parameters
    ----------
    horizon : int
        The number of steps that the finite-horizon model counts, at least 1.
    gamma : float
        The discount rate, in [0, 1).

    Returns
    -------
    ndarray, shape (3, 3)
        A row for each model, in the order of equations 2.1 to 2.3; a column for each chain.

    References
    ----------
    Thesis, equations 2.1 to 2.3.

    Examples
    --------
    >>> earnings(5, 0.9).round(1)
    array([[ 6. ,  0. ,  0. ],
           [16.2, 59. , 58.5],
           [ 2. , 10. , 11. ]])
    """
    world = delayed_rewards(gamma=gamma)
    return np.array(
        [finite_horizon(world, horizon)[-1, 0], discounted(world)[0], average_reward(world)[0]]
    )


def best_chains(earned: ArrayLike) -> list[str]:
    """Return the names of the chains that earn most, several if they earn the same.

    Parameters
    ----------
    earned : array_like, shape (3,)
        What each chain earns by one model.

    Returns
    -------
    list of str
        Names of `CHAINS`.

    Examples
    --------
    >>> best_chains([100.0, 110.0, 110.0])
    ['middle', 'lower']
    """
    earned = array("earned", earned, (len(CHAINS),))
    best = np.isclose(earned, earned.max())
    return [name for name, is_best in zip(CHAINS, best, strict=True) if is_best]


@lru_cache(maxsize=4)
def chain_curves(
    longest: int, gammas: tuple[float, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return what each chain earns per step, for all horizons and for all discounts.

    The sum of h rewards is divided by h, and the discounted sum is multiplied by 1 - gamma.

    Parameters
    ----------
    longest : int
        The longest horizon, at least 1.
    gammas : tuple of float
        Discount rates in [0, 1).

    Returns
    -------
    finite : ndarray, shape (longest, 3)
        For the horizons 1, 2, ...
    geometric : ndarray, shape (len(gammas), 3)

    Examples
    --------
    >>> finite, geometric = chain_curves(5, (0.9,))
    >>> finite[-1], geometric.round(2)
    (array([1.2, 0. , 0. ]), array([[1.62, 5.9 , 5.85]]))
    """
    steps = np.arange(1, longest + 1)
    finite = finite_horizon(delayed_rewards(), longest)[:, 0] / steps[:, np.newaxis]
    geometric = [(1 - gamma) * discounted(delayed_rewards(gamma=gamma))[0] for gamma in gammas]
    return finite, np.array(geometric)


def chosen_chains(x: ArrayLike, curves: ArrayLike) -> tuple[NDArray[np.float64], list[int]]:
    """Return where the best chain changes along an axis, and which is the best in between.

    Parameters
    ----------
    x : array_like, shape (n,)
        Places on the axis, for example horizons.
    curves : array_like, shape (n, 3)
        What each chain earns there.

    Returns
    -------
    ends : ndarray, shape (k + 1,)
        The first place, the changes halfway between two places, the last place.
    chosen : list of k int
        The index of the best chain, or 3 where several are best.

    Examples
    --------
    >>> chosen_chains([1, 2, 3], [[1, 0, 0], [1, 0, 0], [1, 2, 2]])
    (array([1. , 2.5, 3. ]), [0, 3])
    """
    x, curves = np.asarray(x, dtype=float), np.asarray(curves, dtype=float)
    best = np.isclose(curves, curves.max(axis=1, keepdims=True))
    chosen = np.where(best.sum(axis=1) == 1, best.argmax(axis=1), len(CHAINS))
    changes = np.flatnonzero(np.diff(chosen))
    ends = np.concatenate([x[:1], (x[changes] + x[changes + 1]) / 2, x[-1:]])
    return ends, chosen[[0, *(changes + 1)]].tolist()


def coins(x: float) -> str:
    """Return what was earned in three digits, or without decimals if it is a thousand or more.

    Examples
    --------
    >>> coins(58.46), coins(1035.6)
    ('58.5', '1036')
    """
    return f"{x:.3g}" if x < 999.5 else f"{x:.0f}"


def models_fact(horizon: int, gamma: float, earned: ArrayLike) -> str:
    """Say which chains the three models choose, and what each chain earns.

    Examples
    --------
    >>> models_fact(5, 0.9, earnings(5, 0.9))
    'h = 5: upper (6, 0, 0); gamma = 0.9: middle (16.2, 59, 58.5); average: lower (2, 10, 11)'
    """
    told = []
    for row in np.asarray(earned):
        best = best_chains(row)
        chosen = "any" if len(best) == len(CHAINS) else " or ".join(best)
        told.append(f"{chosen} ({', '.join(map(coins, row))})")
    return f"h = {horizon}: {told[0]}; gamma = {gamma:g}: {told[1]}; average: {told[2]}"


def discounted(mdp: MDP) -> NDArray[np.float64]:
    """Return what each first action earns in the discounted infinite-horizon model (2.2).

    Parameters
    ----------
    mdp : MDP
        The model, with its discount rate.

    Returns
    -------
    ndarray, shape (S, A)
        Q*: the discounted sum of all rewards, for the action and then the best actions for ever.

    Notes
    -----
    What is best depends on gamma here, on h in the finite-horizon model, and on neither in the
    average-reward model. (Under figure 2.2 the thesis says that both other models are "dependent
    on the horizon length".)

    References
    ----------
    Thesis 2.1.1 (equation 2.2).

    Examples
    --------
    >>> discounted(MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5))
    array([[4., 6.]])
    """
    return mdp.action_values(policy_iteration(mdp)[0])


def average_reward(mdp: MDP) -> NDArray[np.float64]:
    """Return what each first action earns per step in the long run (equation 2.3).

    Parameters
    ----------
    mdp : MDP
        The model, of any structure: it may have several sets of states that are never left. Its
        discount rate is not used.

    Returns
    -------
    ndarray, shape (S, A)
        The long-run average of the rewards if the best actions follow. The reward of the first
        action does not matter, because it comes only once. An action that is not allowed has -inf.

    Notes
    -----
    This is Howard's policy iteration for several recurrent classes. A state's action is replaced
    by one that leads to a higher average. Where there is none, it is replaced by one with the same
    average that earns more on the way (a higher bias).

    References
    ----------
    Thesis 2.1.1 (equation 2.3). M. Puterman, Markov Decision Processes, Wiley, 1994, section 9.2.

    Examples
    --------
    >>> swap, stay = [[0, 1], [1, 0]], [[1, 0], [0, 1]]
    >>> average_reward(MDP(T=[swap, stay], R=[[3, 0], [0, 1]], gamma=0.9))
    array([[1.5, 1.5],
           [1.5, 1.5]])
    """
    states = np.arange(mdp.n_states)
    policy = mdp.R.argmax(axis=1)
    while True:
        gain, bias = _gain_and_bias(*policy_model(mdp, policy))
        average = np.where(mdp.allowed, mdp.expected(gain), -np.inf)
        onward = mdp.R + mdp.expected(bias)
        # Rounding must not count as an improvement, or two equal actions alternate for ever.
        rounding = 1e-11 * (np.abs(mdp.R[mdp.allowed]).max() + np.abs(bias).max())
        best = average.max(axis=1)
        higher = best > average[states, policy] + rounding
        onward[average < best[:, None] - rounding] = -np.inf
        sooner = ~higher & (onward.max(axis=1) > onward[states, policy] + rounding)
        if not (higher | sooner).any():
            return average
        policy = np.where(higher, average.argmax(axis=1), policy)
        policy = np.where(sooner, onward.argmax(axis=1), policy)


def _gain_and_bias(
    T: Any, R: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.floating]]:
    """Return the average reward per step from each state of a chain, and the bias of each."""
    if sparse.issparse(T):
        T = T.toarray()  # the limiting matrix is dense anyway
    limit = _limiting_matrix(T)
    gain = limit @ R
    bias = np.linalg.solve(np.eye(len(T)) - T + limit, R - gain)
    return gain, bias


def _limiting_matrix(T: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the long-run share of time in each state, for each start: shape (S, S)."""
    n = len(T)
    paths = np.eye(n) + (T > 0)
    for _ in range(n.bit_length()):
        paths = np.minimum(paths @ paths, 1.0)
    reach = paths > 0
    recurrent = (reach == (reach & reach.T)).all(axis=1)
    share = np.zeros((n, n))
    for s in np.flatnonzero(recurrent):
        if not share[s].any():
            members = np.flatnonzero(reach[s])
            share[np.ix_(members, members)] = _stationary(T[np.ix_(members, members)])
    passing = ~recurrent
    leave = np.eye(passing.sum()) - T[np.ix_(passing, passing)]
    share[passing] = np.linalg.solve(leave, T[np.ix_(passing, recurrent)] @ share[recurrent])
    return share


def _stationary(T: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the stationary distribution of an irreducible chain: x T = x, sum x = 1."""
    balance = np.eye(len(T)) - T.T
    balance[-1] = 1
    return np.linalg.solve(balance, np.eye(len(T))[-1])
