"""Planning: the best actions, computed from a known model."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integer, integers, number
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
        Without a horizon, the values are within `tol` of V* in every state (up to the rounding of
        floats).
    horizon : int, optional
        The number of steps left, at least 1; without it the future has no end.

    Returns
    -------
    values : ndarray, shape (S,)
        V*, or the best discounted sum of `horizon` rewards.
    policy : ndarray of int, shape (S,)
        The first action in each state: the lowest of those that are equally good within `tol`. With
        a horizon it is the best only when that many steps are left; `finite_horizon` also gives the
        best actions for fewer steps.

    Raises
    ------
    ValueError
        If `tol` is not above 0 or `horizon` is not an integer >= 1.

    See Also
    --------
    policy_iteration : exact, and faster if gamma is near 1.
    error_bound : how far given values can be from V*.

    Notes
    -----
    Each sweep reduces the distance from V* at least by the factor gamma. So after a sweep that
    changed V by at most d, V is within d gamma / (1 - gamma) of V*. And after n sweeps from V = 0,
    V is within gamma^n max|R| / (1 - gamma) of V*. The iteration ends when one of these two bounds
    is below `tol`. A policy that is greedy for values within e of V* earns at most
    2 gamma e / (1 - gamma) less than V*.

    Corrections to the thesis: the argument x of 2.6 and 2.7 is the state s. Equation 2.6, the best
    immediate reward, is the policy for one remaining step. Equation 2.7, V_1 = gamma max_a R(s, a),
    is not what 2.8 gives from V_0 = 0: the first reward is not discounted. In 2.8 the maximum is
    over a, and V converges to V*, not V* to V.

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
    """Return a number of sweeps after which V is always within `tol` of V*."""
    furthest = np.abs(mdp.R).max() / (1 - mdp.gamma)
    if mdp.gamma == 0 or furthest <= tol:
        return 1
    return math.ceil(math.log(tol / furthest) / math.log(mdp.gamma))


def finite_horizon(mdp: MDP, horizon: int, gamma: float = 1.0) -> NDArray[np.float64]:
    """Return what each first action earns with a known number of steps left (equation 2.1).

    Parameters
    ----------
    mdp : MDP
        The model. Its own discount rate is not used.
    horizon : int
        The number of steps h, at least 1.
    gamma : float, default 1.0
        The discount rate, in [0, 1]. 1 gives the plain sum of the finite-horizon model.

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
    2.1.1 names two ways to act on this. With k steps left, take the best action of ``Q[k - 1]``,
    for k, k - 1, ... 1. Or take the best action of ``Q[-1]`` at every step (a receding horizon).
    Equation 2.1 sums over t = 0 ... k, which is one reward too many. The sums for h = 5 under
    figure 2.2 (6, 0 and 0) have five terms, t = 0 ... h - 1.

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
    """Return for each state the lowest action within `slack` of the best."""
    return best_actions(Q, slack).argmax(axis=1)


def best_actions(Q: ArrayLike, slack: float = 1e-9) -> NDArray[np.bool_]:
    """Return which actions are the best of their state: the argmax of equations 2.9 and 3.1.

    Parameters
    ----------
    Q : array_like, shape (S, A)
        The value of each action.
    slack : float, default 1e-9
        An action this far below the best still counts as equally good; at least 0.

    Returns
    -------
    ndarray of bool, shape (S, A)
        At least one is true in each row.

    Raises
    ------
    ValueError
        If `Q` is not a matrix of finite numbers or `slack` is below 0.

    Examples
    --------
    >>> best_actions([[1, 3, 3], [2, 0, 1]])
    array([[False,  True,  True],
           [ True, False, False]])
    """
    Q = array("Q", Q, (None, None))
    return Q.max(axis=1, keepdims=True) - number("slack", slack, 0) <= Q


def error_bound(mdp: MDP, values: ArrayLike) -> float:
    """Return a bound on the distance of `values` from V* in any state.

    Parameters
    ----------
    mdp : MDP
        The model.
    values : array_like, shape (S,)
        Any values.

    Returns
    -------
    float
        The largest change by one sweep, divided by 1 - gamma.

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
    """Solve V = R_policy + gamma T_policy V: the exact values of a policy.

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
        If the shape does not fit, an action does not exist, or a row is not a distribution.

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
    """Evaluate a policy, improve it for those values, and repeat until nothing improves.

    Parameters
    ----------
    mdp : MDP
        The model.

    Returns
    -------
    values : ndarray, shape (S,)
        V*, up to the rounding of floats.
    policy : ndarray of int, shape (S,)
        The action of each state: the lowest of those that are equally good.

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
    # A few cheap sweeps give a good first policy; each evaluation costs O(S^3).
    _, policy = value_iteration(mdp, horizon=20)
    V = policy_evaluation(mdp, policy)
    while True:
        Q = mdp.action_values(V)
        rounding = 1e-14 * np.abs(V).max()
        better = Q.max(axis=1) > Q[states, policy] + rounding
        policy = np.where(better, Q.argmax(axis=1), policy)
        previous, V = V, policy_evaluation(mdp, policy)
        # What is only better by rounding earns no more, so equal actions cannot alternate for ever.
        if not V.sum() > previous.sum():
            return previous, _first_best(Q, rounding)


def policy_model(mdp: MDP, policy: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the Markov chain that an MDP becomes under a policy.

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
        If the shape does not fit, an action does not exist, or a row is not a distribution.

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
    """Return a policy as the probabilities of the actions in each state.

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
        If the shape does not fit, an action does not exist, or a row is not a distribution.

    Examples
    --------
    >>> policy_chances(MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5), [1])
    array([[0., 1.]])
    """
    if np.ndim(policy) != 1:
        return distribution("policy", array("policy", policy, mdp.R.shape))
    actions = integers("policy", policy, 0, mdp.n_actions - 1)
    if len(actions) != mdp.n_states:
        raise ValueError(f"policy must have shape ({mdp.n_states},), got {actions.shape}")
    return np.eye(mdp.n_actions)[actions]
