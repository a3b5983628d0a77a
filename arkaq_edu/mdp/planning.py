"""Planning: the best actions, computed from a known model, dense or sparse.

With gamma = 1, values without a horizon are those of the proper policies: the policies that lead to
an end with certainty, from every state (stochastic shortest paths).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from arkaq_edu._checks import affordable, array, distribution, integer, integers, n_axes, number
from arkaq_edu.mdp.model import MDP

#: A longer horizon is refused: more sweeps than anybody means, or waits for.
MOST_SWEEPS = 10**6

#: Sweeps that follow a policy before it is improved again: from 5 to 20 take about the same time.
SWEEPS = 8

#: Improvements before the first exact evaluation in `policy_iteration`.
IMPROVEMENTS = 2


def value_iteration(
    mdp: MDP, tol: float = 1e-9, horizon: int | None = None
) -> tuple[NDArray[np.floating], NDArray[np.intp]]:
    """Iterate V(s) = max_a (R(s, a) + gamma sum_t T(s, a, t) V(t)), equation 2.8, from V = 0.

    Parameters
    ----------
    mdp : MDP
        The model.
    tol : float, default 1e-9
        Without a horizon, the values are within `tol` of V* in every state (up to the rounding of
        floats).
    horizon : int, optional
        The number of steps left, from 1 to 1,000,000; without it the future has no end.

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
        If `tol` or `horizon` is out of range. If gamma is 1, as `policy_iteration` does.

    See Also
    --------
    modified_policy_iteration : the same values, sooner if gamma is near 1.
    policy_iteration : exact.
    error_bound : how far given values can be from V*.

    Notes
    -----
    Each sweep reduces the distance from V* at least by the factor gamma. It does so from above and
    from below: after a sweep that changed V by at least d and at most D, V* lies between
    V + d gamma / (1 - gamma) and V + D gamma / (1 - gamma) in every state. The iteration ends when
    these bounds are 2 `tol` apart, and returns their middle. That D - d becomes small is enough,
    and it does so long before D does. Besides, after n sweeps from V = 0, V is within
    gamma^n max|R| / (1 - gamma) of V*, which limits the number of sweeps. A policy that is greedy
    for values within e of V* earns at most 2 gamma e / (1 - gamma) less than V*.

    With gamma = 1, no number of sweeps tells how near V* is. Then the values are those of
    `policy_iteration`.

    Corrections to the thesis: the argument x of 2.6 and 2.7 is the state s. Equation 2.6, the best
    immediate reward, is the policy for one remaining step. Equation 2.7, V_1 = gamma max_a R(s, a),
    is not what 2.8 gives from V_0 = 0: the first reward is not discounted. In 2.8 the maximum is
    over a, and V converges to V*, not V* to V.

    References
    ----------
    Thesis 2.2.1 (equations 2.6-2.9). R. Bellman, Dynamic Programming, Princeton, 1957.
    J. MacQueen, "A modified dynamic programming method for Markovian decision problems", Journal of
    Mathematical Analysis and Applications 14, 1966 (the bounds). M. Puterman, Markov Decision
    Processes, Wiley, 1994, section 6.6.

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
        V = np.zeros(mdp.n_states)
        for _ in range(integer("horizon", horizon, 1, MOST_SWEEPS)):
            Q = mdp.action_values(V)
            V = Q.max(axis=1)
        return V, _first_best(Q, 1e-12 * np.abs(V).max())
    if mdp.gamma == 1:
        return policy_iteration(mdp)
    V = np.zeros(mdp.n_states)
    for _ in range(_sweeps(mdp, tol)):
        previous, V = V, mdp.action_values(V).max(axis=1)
        low, high = _bounds(mdp, V - previous)
        if high - low <= 2 * tol:
            V = np.where(mdp.ends, 0.0, V + (low + high) / 2)
            break
    return V, _first_best(mdp.action_values(V), 2 * mdp.gamma * tol)


def _bounds(mdp: MDP, change: NDArray[np.float64]) -> tuple[float, float]:
    """Return how far V* lies at least and at most above values that a sweep has just changed."""
    ahead = mdp.gamma / (1 - mdp.gamma)
    return float(change.min()) * ahead, float(change.max()) * ahead


def _sweeps(mdp: MDP, tol: float) -> int:
    """Return a number of sweeps after which V is always within `tol` of V*."""
    furthest = np.abs(mdp.R[mdp.allowed]).max() / (1 - mdp.gamma)
    if mdp.gamma == 0 or furthest <= tol:
        return 1
    return math.ceil(math.log(tol / furthest) / math.log(mdp.gamma))


def modified_policy_iteration(
    mdp: MDP, tol: float = 1e-9, sweeps: int = SWEEPS
) -> tuple[NDArray[np.floating], NDArray[np.intp]]:
    """Take the best actions for V, follow them for some sweeps, and repeat.

    Parameters
    ----------
    mdp : MDP
        The model.
    tol : float, default 1e-9
        The values are within `tol` of V* in every state (up to the rounding of floats).
    sweeps : int, default 8
        The number of sweeps V = R_policy + gamma T_policy V after each improvement of the policy,
        at least 0. With none this is value iteration.

    Returns
    -------
    values : ndarray, shape (S,)
        V*.
    policy : ndarray of int, shape (S,)
        The action of each state: the lowest of those that are equally good within `tol`.

    Raises
    ------
    ValueError
        If `tol` or `sweeps` is out of range. If gamma is 1, as `policy_iteration` does.

    Notes
    -----
    A sweep that follows a policy looks at one action of each state, an improvement at all of them.
    The bounds are those of `value_iteration`.

    References
    ----------
    M. Puterman, Markov Decision Processes, Wiley, 1994, sections 6.5 and 6.6.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1], [0, 1]], [[1, 0], [1, 0]]], R=[[0, 1], [2, 0]], gamma=0.5)
    >>> values, policy = modified_policy_iteration(mdp)
    >>> values.round(6), policy
    (array([2., 4.]), array([0, 0]))
    """
    tol, sweeps = number("tol", tol, 0, open_low=True), integer("sweeps", sweeps, 0, MOST_SWEEPS)
    if mdp.gamma == 1:
        return policy_iteration(mdp)
    V = np.zeros(mdp.n_states)
    # From V = 0 an improvement can begin by lowering V, so three times as far from V* as a sweep.
    for _ in range(_sweeps(mdp, tol / 3)):
        Q = mdp.action_values(V)
        previous, V = V, Q.max(axis=1)
        low, high = _bounds(mdp, V - previous)
        if high - low <= 2 * tol:
            V = np.where(mdp.ends, 0.0, V + (low + high) / 2)
            break
        T, R = _chain(mdp, Q.argmax(axis=1))
        for _ in range(sweeps):
            V = R + mdp.gamma * (T @ V)
    return V, _first_best(mdp.action_values(V), 2 * mdp.gamma * tol)


def finite_horizon(mdp: MDP, horizon: int, gamma: float = 1.0) -> NDArray[np.float64]:
    """Return what each first action earns with a known number of steps left (equation 2.1).

    Parameters
    ----------
    mdp : MDP
        The model. Its own discount rate is not used.
    horizon : int
        The number of steps h, from 1 to 1,000,000.
    gamma : float, default 1.0
        The discount rate, in [0, 1]. 1 gives the plain sum of the finite-horizon model.

    Returns
    -------
    Q : ndarray, shape (horizon, S, A)
        ``Q[k - 1, s, a]``: the best sum of k rewards that begins with action `a` in state `s`.

    Raises
    ------
    ValueError
        If `horizon` or `gamma` is out of range, or the table would need too many bytes.

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
    horizon = integer("horizon", horizon, 1, MOST_SWEEPS)
    gamma = number("gamma", gamma, 0, 1)
    Q = np.empty(affordable("horizon", (horizon, *mdp.R.shape)))
    V = np.zeros(mdp.n_states)
    for k in range(horizon):
        Q[k] = mdp.R + gamma * mdp.expected(V)
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
        The value of each action; -inf for one that is not allowed.
    slack : float, default 1e-9
        An action this far below the best still counts as equally good; at least 0.

    Returns
    -------
    ndarray of bool, shape (S, A)
        At least one is true in each row.

    Raises
    ------
    ValueError
        If `Q` is not a matrix of numbers or `slack` is below 0.

    Examples
    --------
    >>> best_actions([[1, 3, 3], [2, 0, 1]])
    array([[False,  True,  True],
           [ True, False, False]])
    """
    Q = array("Q", Q, (None, None), allow_minus_infinity=True)
    if not Q.size:
        raise ValueError(f"Q must have shape (S, A), each at least 1, got {Q.shape}")
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
        If `values` has another shape or holds a number that is not finite, or gamma is 1.

    References
    ----------
    M. Puterman, Markov Decision Processes, Wiley, 1994, section 6.3.

    Examples
    --------
    >>> mdp = MDP(T=[[[1]]], R=[[1]], gamma=0.5)  # V* = 2
    >>> error_bound(mdp, [2.0]), error_bound(mdp, [0.0])
    (0.0, 2.0)
    """
    gamma = number("gamma", mdp.gamma, 0, 1, open_high=True)
    V = array("values", values, (mdp.n_states,))
    change = mdp.action_values(V).max(axis=1) - V
    return float(np.abs(change).max() / (1 - gamma))


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
        If the shape does not fit, an action does not exist or is not allowed, or a row is not a
        distribution. If gamma is 1 and some state may never reach an end.

    Notes
    -----
    An end is worth 0. So the equation has one solution if gamma is below 1, and also if gamma is 1
    and the policy is proper: it leads to an end with certainty.

    References
    ----------
    Thesis 2.2.1 ("the discounted sum of rewards of the related policy").

    Examples
    --------
    >>> mdp = MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5)
    >>> policy_evaluation(mdp, [1]), policy_evaluation(mdp, [[0.5, 0.5]])
    (array([6.]), array([4.]))
    """
    chances = policy_chances(mdp, policy)
    if mdp.gamma == 1:
        lost = np.flatnonzero(_toward_ends(mdp, chances > 0) < 0)
        if len(lost):
            raise ValueError(
                "policy must be proper when gamma is 1 (lead to an end from every state), "
                f"got one that reaches none from state {lost[0]}"
            )
    T, R = policy_model(mdp, chances)
    return _evaluate(mdp, T, R)


def _evaluate(mdp: MDP, T: Any, R: NDArray[np.float64]) -> NDArray[np.float64]:
    """Solve V = R + gamma T V, with V = 0 at the ends."""
    onward = (mdp.gamma * ~mdp.ends)[:, np.newaxis] * T
    if sparse.issparse(T):
        from scipy.sparse.linalg import spsolve  # takes a while to import

        V = spsolve(sparse.csc_array(sparse.eye_array(mdp.n_states) - onward), R)
    else:
        V = np.linalg.solve(np.eye(mdp.n_states) - onward, R)
    # What is only rounding of its terms, or -0.0, is 0.0 with every linear algebra library.
    terms = np.abs(R) + onward @ np.abs(V)
    return np.where(np.abs(V) > 1e-13 * terms, V, 0.0)


def _toward_ends(mdp: MDP, usable: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return for each state the first usable action that can lead nearer to an end, or else -1."""
    policy = np.where(mdp.ends, usable.argmax(axis=1), -1)
    while True:
        nearer = usable & (mdp.expected((policy >= 0).astype(float)) > 0)
        found = (policy < 0) & nearer.any(axis=1)
        if not found.any():
            return policy
        policy[found] = nearer[found].argmax(axis=1)


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
        The action of each state: the lowest of those that are equally good. With gamma = 1, the
        lowest of them that can lead nearer to an end.

    Raises
    ------
    ValueError
        If gamma is 1 and some state reaches no end under any policy, or can earn without end.

    Notes
    -----
    With gamma = 1, the first policy is proper, and so is each that follows: an action is replaced
    only by a better one, so that a new loop would have to earn something in each round.

    References
    ----------
    R. Howard, Dynamic Programming and Markov Processes, MIT Press, 1960. D. Bertsekas,
    J. Tsitsiklis, "An analysis of stochastic shortest path problems", Mathematics of Operations
    Research 16, 1991.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1], [0, 1]], [[1, 0], [1, 0]]], R=[[0, 1], [2, 0]], gamma=0.5)
    >>> policy_iteration(mdp)
    (array([2., 4.]), array([0, 0]))
    """
    states = np.arange(mdp.n_states)
    policy = _first_policy(mdp)
    V = _evaluate(mdp, *_chain(mdp, policy))
    while True:
        Q = mdp.action_values(V)
        rounding = 1e-14 * np.abs(V).max()
        better = Q.max(axis=1) > Q[states, policy] + rounding
        if not better.any():
            break
        policy = np.where(better, Q.argmax(axis=1), policy)
        if mdp.gamma == 1 and (_toward_ends(mdp, np.eye(mdp.n_actions)[policy] > 0) < 0).any():
            raise ValueError(
                "R must let no loop earn without end when gamma is 1, got one that does"
            )
        previous, V = V, _evaluate(mdp, *_chain(mdp, policy))
        # What is only better by rounding earns no more, so equal actions cannot alternate for ever.
        if not V.sum() > previous.sum():
            V = previous
            break
    if mdp.gamma == 1:
        return V, _toward_ends(mdp, best_actions(Q, rounding))
    return V, _first_best(Q, rounding)


def _first_policy(mdp: MDP) -> NDArray[np.intp]:
    """Return a good policy, and with gamma = 1 a proper one: each evaluation costs O(S^3)."""
    if mdp.gamma == 1:
        policy = _toward_ends(mdp, mdp.allowed)
        if (policy < 0).any():
            raise ValueError(
                "mdp must reach an end from every state when gamma is 1, "
                f"got no path from state {policy.argmin()}"
            )
        return policy
    V = np.zeros(mdp.n_states)
    for _ in range(IMPROVEMENTS):
        T, R = _chain(mdp, mdp.action_values(V).argmax(axis=1))
        for _ in range(SWEEPS):
            V = R + mdp.gamma * (T @ V)
    return mdp.action_values(V).argmax(axis=1)


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
    T : ndarray or sparse matrix, shape (S, S)
        The probability of going from one state to another, sparse if the model is.
    R : ndarray, shape (S,)
        The reward expected in each state.

    Raises
    ------
    ValueError
        If the shape does not fit, an action does not exist or is not allowed, or a row is not a
        distribution.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1], [0, 1]], [[1, 0], [1, 0]]], R=[[0, 1], [2, 0]], gamma=0.5)
    >>> T, R = policy_model(mdp, [0, 1])
    >>> T, R
    (array([[0., 1.],
           [1., 0.]]), array([0., 0.]))
    """
    chances = policy_chances(mdp, policy)
    s, a = chances.nonzero()
    # Row s picks from the model's stacked rows those of the actions of state s.
    picked = sparse.csr_array(
        (chances[s, a], (s, a * mdp.n_states + s)), shape=(mdp.n_states, mdp.R.size)
    )
    return picked @ mdp.stacked, picked @ mdp.R.T.ravel()


def _chain(mdp: MDP, actions: NDArray[np.intp]) -> tuple[Any, NDArray[np.float64]]:
    """Return what `policy_model` does, for one action in each state, by plain indexing."""
    states = np.arange(mdp.n_states)
    return mdp.stacked[actions * mdp.n_states + states], mdp.R[states, actions]


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
        If the shape does not fit, an action does not exist or is not allowed, or a row is not a
        distribution.

    Examples
    --------
    >>> policy_chances(MDP(T=[[[1]], [[1]]], R=[[1, 3]], gamma=0.5), [1])
    array([[0., 1.]])
    """
    if n_axes("policy", policy) == 1:
        actions = integers("policy", policy, 0, mdp.n_actions - 1)
        if len(actions) != mdp.n_states:
            raise ValueError(f"policy must have shape ({mdp.n_states},), got {actions.shape}")
        chances = np.eye(mdp.n_actions)[actions]
    else:
        chances = distribution("policy", policy, mdp.R.shape)
    wrong = np.argwhere((chances > 0) & ~mdp.allowed)
    if len(wrong):
        s, a = wrong[0].tolist()
        raise ValueError(f"policy must take allowed actions, got action {a} in state {s}")
    return chances
