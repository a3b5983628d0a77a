"""Planning: the best actions from a model that is known."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integer, number
from arkaq_edu.mdp._indices import indices
from arkaq_edu.mdp.model import MDP


def value_iteration(
    mdp: MDP, tol: float = 1e-9, horizon: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Iterate V(s) = max_a (R(s, a) + gamma sum_t T(s, a, t) V(t)), equation 2.8, from V = 0.

    Parameters
    ----------
    mdp : MDP
        The model.
    tol : float, default 1e-9
        With no horizon: the values returned are this close to V*, in every state (up to the
        rounding of floats).
    horizon : int, optional
        The number of steps still to go, at least 1; without it the future has no end.

    Returns
    -------
    values : ndarray, shape (S,)
        V*, or the best discounted sum of `horizon` rewards.
    policy : ndarray of int, shape (S,)
        The action to take first in each state; the lowest of those that are equally good as far as
        `tol` can tell. With a horizon it holds for that many steps to go; `finite_horizon` gives
        all the shorter ones.

    Raises
    ------
    ValueError
        If `tol` is not above 0 or `horizon` is not an integer >= 1.

    See Also
    --------
    policy_iteration : exact, and faster where gamma is near 1.
    error_bound : how far any values can be from V*.

    Notes
    -----
    A sweep brings any values closer to V* by a factor gamma at least. So after a sweep that changed
    V by at most d, V is within d gamma / (1 - gamma) of V*; and n sweeps from V = 0 end within
    gamma^n max|R| / (1 - gamma) of it. Whichever is first below `tol` ends the iteration. A policy
    that is greedy for values within e of V* earns at most 2 gamma e / (1 - gamma) less than V*.

    Where the thesis prints otherwise: the argument x of 2.6 and 2.7 is the state s, and 2.6, the
    best immediate reward, is the policy for one step to go. Equation 2.7, V_1 = gamma max_a R(s,
    a), is not what 2.8 gives from V_0 = 0: the first reward is not discounted. In 2.8 the maximum
    is over a, and it is V that converges to V*, not the other way round.

    References
    ----------
    Thesis 2.2.1 (equations 2.6-2.9). R. Bellman, Dynamic Programming, Princeton, 1957.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1], [0, 1]], [[1, 0], [1, 0]]], R=[[0, 1], [2, 0]], gamma=0.5)
    >>> values, policy = value_iteration(mdp)
    >>> values.round(6), policy
    (array([2., 4.]), array([0, 0]))
    >>> value_iteration(mdp, horizon=1)
    (array([1., 2.]), array([1, 0]))
    """
    tol = number("tol", tol, 0, open_low=True)
    if horizon is not None:
        Q = finite_horizon(mdp, horizon, mdp.gamma)[-1]
        return Q.max(axis=1), _first_best(Q, 1e-12 * np.abs(Q).max())
    V = np.zeros(mdp.n_states)
    for _ in range(_sweeps(mdp, tol)):
        previous, V = V, mdp.action_values(V).max(axis=1)
        if np.abs(V - previous).max() * mdp.gamma / (1 - mdp.gamma) <= tol:
            break
    return V, _first_best(mdp.action_values(V), 2 * mdp.gamma * tol)


def _sweeps(mdp: MDP, tol: float) -> int:
    """Return the number of sweeps after which V is within `tol` of V*, whatever happens."""
    furthest = np.abs(mdp.R).max() / (1 - mdp.gamma)
    if mdp.gamma == 0 or furthest <= tol:
        return 1
    return math.ceil(math.log(tol / furthest) / math.log(mdp.gamma))


def finite_horizon(mdp: MDP, horizon: int, gamma: float = 1.0) -> NDArray[np.float64]:
    """Return what each first action earns when a known number of steps is left (equation 2.1).

    Parameters
    ----------
    mdp : MDP
        The model; its own discount rate is not used.
    horizon : int
        The number of steps h, at least 1.
    gamma : float, default 1.0
        The discount rate, in [0, 1]; 1 gives the plain sum of the finite-horizon model.

    Returns
    -------
    Q : ndarray, shape (horizon, S, A)
        ``Q[k - 1, s, a]``: the best sum of k rewards that begins with action `a` in state `s`.

    Raises
    ------
    ValueError
        If `horizon` is not an integer >= 1 or `gamma` is outside [0, 1].

    Notes
    -----
    Both ways of 2.1.1 to act on it are here: with k steps left, the best action of ``Q[k - 1]``
    (k steps, then k - 1, until one remains), or at every step that of ``Q[-1]`` (a horizon that
    recedes). Equation 2.1 sums over t = 0 ... k, which is one reward too many: with h = 5 the
    sums under figure 2.2, 6, 0 and 0, have five terms, t = 0 ... h - 1.

    References
    ----------
    Thesis 2.1.1 (equation 2.1) and 2.2.1.

    Examples
    --------
    >>> mdp = MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5)
    >>> finite_horizon(mdp, 2)
    array([[[1., 3.]],
           [[4., 6.]]])
    """
    horizon = integer("horizon", horizon, 1)
    gamma = number("gamma", gamma, 0, 1)
    Q = np.empty((horizon, *mdp.R.shape))
    V = np.zeros(mdp.n_states)
    for k in range(horizon):
        Q[k] = mdp.R + gamma * (mdp.T @ V).T
        V = Q[k].max(axis=1)
    return Q


def _first_best(Q: NDArray[np.float64], slack: float) -> NDArray[np.intp]:
    """Return the lowest action of each state that is no more than `slack` below the best."""
    return best_actions(Q, slack).argmax(axis=1)


def best_actions(Q: ArrayLike, slack: float = 1e-9) -> NDArray[np.bool_]:
    """Return which actions are the best of their state: the set under equations 2.9 and 3.1.

    Parameters
    ----------
    Q : array_like, shape (S, A)
        The value of each action.
    slack : float, default 1e-9
        How far below the best an action may be and still count as equally good, at least 0.

    Returns
    -------
    ndarray of bool, shape (S, A)
        At least one true in each row.

    Raises
    ------
    ValueError
        If `Q` is no matrix of finite numbers or `slack` is below 0.

    Examples
    --------
    >>> best_actions([[1, 3, 3], [2, 0, 1]])
    array([[False,  True,  True],
           [ True, False, False]])
    """
    Q = array("Q", Q, (None, None))
    return Q.max(axis=1, keepdims=True) - number("slack", slack, 0) <= Q


def error_bound(mdp: MDP, values: ArrayLike) -> float:
    """Return a number no smaller than the distance of `values` from V*, in any state.

    Parameters
    ----------
    mdp : MDP
        The model.
    values : array_like, shape (S,)
        Any values.

    Returns
    -------
    float
        By how much one sweep changes them, over 1 - gamma.

    Raises
    ------
    ValueError
        If `values` has another shape or holds a number that is not finite.

    References
    ----------
    M. Puterman, Markov Decision Processes, Wiley, 1994, section 6.3.

    Examples
    --------
    >>> mdp = MDP(T=[[[1]]], R=[[1]], gamma=0.5)  # V* = 2
    >>> error_bound(mdp, [2.0]), error_bound(mdp, [0.0])
    (0.0, 2.0)
    """
    change = mdp.action_values(values).max(axis=1) - np.asarray(values)
    return float(np.abs(change).max() / (1 - mdp.gamma))


def policy_evaluation(mdp: MDP, policy: ArrayLike) -> NDArray[np.floating]:
    """Solve V = R_policy + gamma T_policy V: what a policy earns, exactly.

    Parameters
    ----------
    mdp : MDP
        The model.
    policy : array_like, shape (S,) or (S, A)
        The action of each state, or the probabilities of the actions in each state.

    Returns
    -------
    ndarray, shape (S,)

    Raises
    ------
    ValueError
        If the shape does not fit, an action does not exist, or a row is no distribution.

    References
    ----------
    Thesis 2.2.1 ("the discounted sum of rewards of the related policy").

    Examples
    --------
    >>> mdp = MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5)
    >>> policy_evaluation(mdp, [1]), policy_evaluation(mdp, [[0.5, 0.5]])
    (array([6.]), array([4.]))
    """
    T, R = policy_model(mdp, policy)
    return np.linalg.solve(np.eye(mdp.n_states) - mdp.gamma * T, R)


def policy_iteration(mdp: MDP) -> tuple[NDArray[np.floating], NDArray[np.intp]]:
    """Evaluate a policy, take the best action for those values, and so on until none is better.

    Parameters
    ----------
    mdp : MDP
        The model.

    Returns
    -------
    values : ndarray, shape (S,)
        V*, up to the rounding of floats.
    policy : ndarray of int, shape (S,)
        The action of each state, the lowest of those that are equally good.

    References
    ----------
    R. Howard, Dynamic Programming and Markov Processes, MIT Press, 1960.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1], [0, 1]], [[1, 0], [1, 0]]], R=[[0, 1], [2, 0]], gamma=0.5)
    >>> policy_iteration(mdp)
    (array([2., 4.]), array([0, 0]))
    """
    states = np.arange(mdp.n_states)
    # A few cheap sweeps give a good policy to begin with: each evaluation costs S^3.
    _, policy = value_iteration(mdp, horizon=20)
    V = policy_evaluation(mdp, policy)
    while True:
        Q = mdp.action_values(V)
        rounding = 1e-14 * np.abs(V).max()
        better = Q.max(axis=1) > Q[states, policy] + rounding
        policy = np.where(better, Q.argmax(axis=1), policy)
        previous, V = V, policy_evaluation(mdp, policy)
        # What is better by rounding alone earns no more: equal actions do not take turns for ever.
        if not V.sum() > previous.sum():
            return previous, _first_best(Q, rounding)


def policy_model(mdp: MDP, policy: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the chain that is left of an MDP when a policy makes its choices.

    Parameters
    ----------
    mdp : MDP
        The model.
    policy : array_like, shape (S,) or (S, A)
        The action of each state, or the probabilities of the actions in each state.

    Returns
    -------
    T : ndarray, shape (S, S)
        The probability of going from one state to another.
    R : ndarray, shape (S,)
        The reward expected in each state.

    Raises
    ------
    ValueError
        If the shape does not fit, an action does not exist, or a row is no distribution.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1], [0, 1]], [[1, 0], [1, 0]]], R=[[0, 1], [2, 0]], gamma=0.5)
    >>> T, R = policy_model(mdp, [0, 1])
    >>> T, R
    (array([[0., 1.],
           [1., 0.]]), array([0., 0.]))
    """
    chances = policy_chances(mdp, policy)
    return np.einsum("sa,ast->st", chances, mdp.T), (chances * mdp.R).sum(axis=1)


def policy_chances(mdp: MDP, policy: ArrayLike) -> NDArray[np.float64]:
    """Return a policy of either form as the probabilities of the actions in each state.

    Parameters
    ----------
    mdp : MDP
        The model.
    policy : array_like, shape (S,) or (S, A)
        The action of each state, or the probabilities of the actions in each state.

    Returns
    -------
    ndarray, shape (S, A)

    Raises
    ------
    ValueError
        If the shape does not fit, an action does not exist, or a row is no distribution.

    Examples
    --------
    >>> policy_chances(MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5), [1])
    array([[0., 1.]])
    """
    if np.ndim(policy) != 1:
        return distribution("policy", array("policy", policy, mdp.R.shape))
    actions = indices("policy", policy, 0, mdp.n_actions - 1)
    if len(actions) != mdp.n_states:
        raise ValueError(f"policy must have shape ({mdp.n_states},), got {actions.shape}")
    return np.eye(mdp.n_actions)[actions]
