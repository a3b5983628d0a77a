"""Bounds on the optimal value from points, for models whose exact solution is out of reach."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from tqdm import tqdm

from arkaq_edu._checks import distribution, integer, n_axes, number, shown
from arkaq_edu._compiled import word_before_compiling
from arkaq_edu.pomdp import point_kernels
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.value import ValueFunction

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]

# A trial goes on while the bounds are further apart than this share of their gap at the start. A
# share near 1 makes trials short, so that what they learn is used early.
ZETA = 0.9
# A bound must improve by this share of the value. Less may be rounding.
TINY = 1e-12
# Superfluous vectors and points are dropped when there are this many times more of them than after
# the last time: the search for them is quadratic.
GROWTH, ROOM = 5 / 4, 8
# The first bounds are bounds wherever their iteration stops. It stops when a sweep changes less
# than this share of the rewards, or after this many multiplications, which take about a second.
ENOUGH, MOST_WORK = 1e-10, 5e8
# Up to this many states the value of a policy is the solution of a linear system.
MOST_SOLVED = 1000


@dataclass(frozen=True, eq=False)
class UpperBound:
    """A function that is nowhere below the optimal value: a sawtooth between known points.

    Attributes
    ----------
    corners : ndarray, shape (S,)
        The bound in each state, if it is known for certain.
    points : ndarray, shape (N, S)
        Beliefs where the bound is known to be lower than the plane through the corners.
    values : ndarray, shape (N,)
        The bound there.
    vectors : ndarray, shape (A, S)
        The fast informed bound, max_a b . vectors[a]. It holds as well.

    Examples
    --------
    The bound is 4 in both corners, and known to be 2 in the middle.

    >>> upper = UpperBound(np.array([4.0, 4.0]), np.array([[0.5, 0.5]]), np.array([2.0]),
    ...                    np.array([[9.0, 9.0]]))
    >>> upper([[1, 0], [0.75, 0.25], [0.5, 0.5]])
    array([4., 3., 2.])
    """

    corners: Floats
    points: Floats
    values: Floats
    vectors: Floats

    def __call__(self, b: ArrayLike) -> Any:
        """Return the bound at a belief, or at many.

        Parameters
        ----------
        b : array_like, shape (S,) or (N, S)
            The beliefs.

        Returns
        -------
        float, or ndarray of shape (N,)

        Raises
        ------
        ValueError
            If `b` is not a distribution over the states.
        """
        n_states = len(self.corners)
        many = n_axes("b", b) == 2
        beliefs = distribution("b", b, (None, n_states) if many else (n_states,))
        below = self.values - self.points @ self.corners
        points = _Beliefs(n_states, np.reshape(self.points, (-1, n_states)))
        rows = _Beliefs(n_states, np.reshape(beliefs, (-1, n_states)))
        bounds = point_kernels.upper(rows.rows, self.corners, points.rows, below, self.vectors)
        return bounds if many else float(bounds[0])


@dataclass(frozen=True, eq=False)
class PointBased:
    """What a search has found out about the optimal value.

    Attributes
    ----------
    lower : ValueFunction
        A policy graph, and a bound on what it earns. Whoever acts by it earns at least that much.
    upper : UpperBound
        Called with a belief, or many: no policy earns more.
    start : ndarray, shape (S,)
        The belief where the search began. The bounds are closest around it.
    backups : int
        How many times the bounds were improved at a belief.

    Examples
    --------
    >>> pomdp = POMDP(T=[np.eye(2)] * 2, O=[[[1], [1]]] * 2, R=[[1, 0], [0, 1]], gamma=0.5)
    >>> found = solve_point_based(pomdp)
    >>> found
    PointBased(1 to 1.00098 at the start, 2 vectors, 5 points)
    >>> found.lower.value([0.75, 0.25]), found.upper([0.75, 0.25])
    (1.5, 1.50048828125)
    """

    lower: ValueFunction
    upper: UpperBound
    start: Floats
    backups: int

    @property
    def gap(self) -> float:
        """The upper bound minus the lower bound, at the start."""
        return self.upper(self.start) - self.lower.value(self.start)

    def __repr__(self) -> str:
        low, high = self.lower.value(self.start), self.upper(self.start)
        return (
            f"PointBased({low:.6g} to {high:.6g} at the start, {len(self.lower)} vectors, "
            f"{len(self.upper.points)} points)"
        )


def solve_point_based(
    pomdp: POMDP,
    tol: float = 1e-3,
    max_backups: int = 10_000,
    seconds: float | None = None,
) -> PointBased:
    """Bound the optimal value at the start from below and from above.

    Parameters
    ----------
    pomdp : POMDP
        The model. The search begins at its `start`.
    tol : float, default 1e-3
        The search ends when the bounds at the start are no further apart than this.
    max_backups : int, default 10000
        The search also ends after this many backups.
    seconds : float, optional
        The search also ends after this time. Without it the bounds do not depend on the speed of
        the machine. The first bounds are always made; for a thousand states they take about a
        second.

    Returns
    -------
    PointBased
        `lower`, a policy graph as a value function, and `upper`, a function of beliefs. Both hold
        at every belief, up to rounding. They are close together where the search has been.

    Raises
    ------
    ValueError
        If `pomdp` is not a POMDP or its discount is 1, `tol` is not above 0, `max_backups` is not
        an integer >= 0, or `seconds` is negative.

    See Also
    --------
    solve_pomdp : exact at every belief, for small models.

    Notes
    -----
    Heuristic search value iteration. The lower bound begins with policies that never change their
    action, the upper one with the fast informed bound. A trial follows, from the start, the action
    with the highest upper bound and the observation after which the bounds are most too far apart.
    The gap that is allowed grows by 1 / gamma with each step, so a trial ends. On the way back,
    each belief improves both bounds: by a new vector below, and by a new point of the sawtooth
    above.

    A new vector comes with the vectors that follow each observation. If one vector is nowhere above
    another, the other takes its place. So the vectors stay a policy graph, which earns at least
    what they promise (`PolicyGraph.values`).

    A progress bar shows after two seconds.

    References
    ----------
    T. Smith, R. Simmons, "Point-based POMDP algorithms: improved analysis and implementation",
    UAI 2005. J. Pineau, G. Gordon, S. Thrun, "Point-based value iteration: an anytime algorithm
    for POMDPs", IJCAI 2003.

    Examples
    --------
    The ball is left or right of the robot and stays there. A look errs in one of ten cases. A kick
    to the right side earns 1, a kick to the wrong side costs 1.

    >>> any_state = np.full((2, 2), 0.5)
    >>> pomdp = POMDP(T=[np.eye(2), any_state, any_state],
    ...               O=[[[0.9, 0.1], [0.1, 0.9]], any_state, any_state],
    ...               R=[[0, 1, -1], [0, -1, 1]], gamma=0.9)
    >>> found = solve_point_based(pomdp)
    >>> found.gap <= 1e-3, round(found.lower.value([0.5, 0.5]), 2), found.lower.action([0.5, 0.5])
    (True, 3.79, 0)
    """
    if not isinstance(pomdp, POMDP):
        raise ValueError(f"pomdp must be a POMDP, got {shown(pomdp)}")
    if pomdp.gamma == 1:
        raise ValueError(
            "pomdp must have a discount below 1 for an endless future; with 1 use "
            "solve_pomdp(pomdp, horizon)"
        )
    tol = number("tol", tol, 0, open_low=True, open_high=True)
    max_backups = integer("max_backups", max_backups, 0)
    seconds = np.inf if seconds is None else number("seconds", seconds, 0, open_high=True)
    stop = time.monotonic() + seconds
    search, backups = _Search(pomdp), 0
    with tqdm(
        total=max_backups, desc="bounds", unit="backup", delay=2, disable=None, leave=False
    ) as bar:
        while backups < max_backups and (gap := search.gap(pomdp.start)) > tol:
            if time.monotonic() >= stop:
                break
            steps = search.trial(max_backups - backups, stop)
            backups += steps
            bar.update(steps)
            bar.set_postfix(gap=f"{gap:.2g}", refresh=False)
    low, high = search.lower, search.upper
    # V* is nowhere above the plane through the corners, and V nowhere below any of its vectors.
    error = float((high.corners - low.alphas.filled).max(axis=1).min())
    lower = ValueFunction(low.alphas.filled, low.actions.filled, low.branches.filled, None, error)
    points = high.points.dense()
    values = high.below.filled + points @ high.corners
    upper = UpperBound(high.corners, points, values, high.vectors)
    return PointBased(lower, upper, pomdp.start, backups)


class _Growing:
    """An array that grows row by row."""

    def __init__(self, rows: NDArray[Any]) -> None:
        self.room, self.n = rows, len(rows)

    @property
    def filled(self) -> NDArray[Any]:
        return self.room[: self.n]

    def append(self, rows: Any) -> None:
        n = self.n + len(rows)
        if n > len(self.room):
            room = np.empty((2 * n, *self.room.shape[1:]), self.room.dtype)
            room[: self.n] = self.filled
            self.room = room
        self.room[self.n : n] = rows
        self.n = n


class _Beliefs:
    """Beliefs that grow in number, without their zeros."""

    def __init__(self, n_states: int, beliefs: Floats) -> None:
        self.n_states = n_states
        matrix = sparse.csr_array(beliefs)
        self.ends = _Growing(matrix.indptr.astype(np.int64))
        self.states = _Growing(matrix.indices.astype(np.int64))
        self.chances = _Growing(matrix.data)

    @property
    def rows(self) -> tuple[Ints, Ints, Floats]:
        """Where each row begins and ends; the states in it; their probabilities."""
        return self.ends.filled, self.states.filled, self.chances.filled

    def append(self, b: Floats) -> None:
        states = np.flatnonzero(b)
        self.states.append(states)
        self.chances.append(b[states])
        self.ends.append([self.states.n])

    def dense(self) -> Floats:
        ends, states, chances = self.rows
        shape = (len(ends) - 1, self.n_states)
        return sparse.csr_array((chances, states, ends), shape).toarray()


class _Search:
    """Heuristic search: where to improve the two bounds, and how.

    The model is held without its zeros. `seen` has a row for each action and observation.
    """

    def __init__(self, pomdp: POMDP) -> None:
        word_before_compiling(point_kernels.upper, "the bounds")
        A, Z, S = pomdp.n_actions, pomdp.n_observations, pomdp.n_states
        self.pomdp = pomdp
        self.T = [sparse.csr_array(pomdp.T[a]) for a in range(A)]
        self.to_next = sparse.vstack([T.T for T in self.T], format="csr")  # row (a, s'), column s
        seen = sparse.vstack([sparse.csr_array(pomdp.O[a]).T for a in range(A)], format="csr")
        self.seen = seen.data  # O(s', a, z) at row (a, z), column s'
        self.ends, self.states = seen.indptr.astype(np.int64), seen.indices.astype(np.int64)
        row = np.repeat(np.arange(A * Z), np.diff(seen.indptr))
        self.place = row // Z * S + self.states  # where (a, s') is in `to_next`
        self.z = row % Z
        self.lower, self.upper = _Lower(pomdp), _Upper(pomdp)

    def gap(self, b: Floats) -> float:
        return self.upper.value(b) - self.lower.value(b)

    def look(self, b: Floats) -> tuple[Floats, Floats, Ints, Floats]:
        """Return what can follow a belief.

        `joint` is Pr(s', z | b, a), the numerator of equation 2.15, where `seen` is not zero. The
        others have shape (A, Z): the lower bound of the next belief and the vector that attains it,
        and the upper bound, both times the probability of getting there.
        """
        predicted = self.to_next @ b  # sum_s T(s, a, s') b(s), for every a and s'
        joint = self.seen * predicted[self.place]
        rows = self.ends, self.states, joint
        AZ = self.pomdp.n_actions, self.pomdp.n_observations
        lower, branches = point_kernels.lower(rows, self.lower.alphas.filled)
        upper = self.upper.at(rows)
        return joint, lower.reshape(AZ), branches.reshape(AZ), upper.reshape(AZ)

    def improve(self, b: Floats) -> None:
        """Back up both bounds at a belief; a bound that would not improve is left as it is."""
        R, T, gamma = self.pomdp.R, self.T, self.pomdp.gamma
        _, lower, branches, upper = self.look(b)
        high = (b @ R + gamma * upper.sum(axis=1)).max()
        if high < self.upper.value(b) - TINY * abs(high):
            self.upper.add(b, high)
        earned = b @ R + gamma * lower.sum(axis=1)
        a = int(earned.argmax())
        if earned[a] > self.lower.value(b) + TINY * abs(earned[a]):
            later = self.later(a, branches[a])
            self.lower.add(R[:, a] + gamma * T[a] @ later, a, branches[a])  # equation 2.19

    def later(self, a: int, branches: Ints) -> Floats:
        """Return sum_z O(s', a, z) V_z(s') for every s', where V_z is the vector that follows z."""
        Z = len(branches)
        here = slice(self.ends[a * Z], self.ends[(a + 1) * Z])
        z, states = self.z[here], self.states[here]
        V = self.lower.alphas.filled[branches[z], states]
        return np.bincount(states, self.seen[here] * V, self.pomdp.n_states).astype(float)

    def trial(self, most: int, stop: float) -> int:
        """Walk to where the bounds are too far apart, and improve them on the way back.

        Return the number of backups, at most `most`. After the time `stop` it makes only one more.
        """
        R, gamma, Z = self.pomdp.R, self.pomdp.gamma, self.pomdp.n_observations
        b: Floats = self.pomdp.start
        path: list[Floats] = []
        enough = ZETA * self.gap(b)
        while len(path) < most:
            path.append(b)
            enough = enough / gamma if gamma else np.inf
            joint, lower, _, upper = self.look(b)
            a = int((b @ R + gamma * upper.sum(axis=1)).argmax())
            rows = [slice(*self.ends[k : k + 2]) for k in range(a * Z, (a + 1) * Z)]
            chances = np.array([joint[row].sum() for row in rows])
            excess = upper[a] - lower[a] - chances * enough
            z = int(excess.argmax())
            if not excess[z] > 0 or time.monotonic() >= stop:
                break
            b = np.zeros(len(b))
            b[self.states[rows[z]]] = joint[rows[z]] / chances[z]
        backups = 0
        for b in reversed(path):
            self.improve(b)
            backups += 1
            if time.monotonic() >= stop:
                break
        self.lower.tidy()
        self.upper.tidy()
        return backups


class _Lower:
    """The lower bound: vectors, each with its action and the vectors that follow it."""

    def __init__(self, pomdp: POMDP) -> None:
        A, Z = pomdp.n_actions, pomdp.n_observations
        self.alphas = _Growing(blind_policies(pomdp))
        self.actions = _Growing(np.arange(A))
        self.branches = _Growing(np.repeat(np.arange(A)[:, np.newaxis], Z, axis=1))
        self.limit: float = 2 * A

    def value(self, b: Floats) -> float:
        return float((self.alphas.filled @ b).max())

    def add(self, alpha: Floats, action: int, branches: Ints) -> None:
        self.alphas.append([alpha])
        self.actions.append([action])
        self.branches.append([branches])

    def tidy(self) -> None:
        """Drop vectors that are nowhere above another one, which takes their place."""
        alphas, actions, branches = (x.filled for x in (self.alphas, self.actions, self.branches))
        if len(alphas) <= self.limit:
            return
        by = np.arange(len(alphas))
        point_kernels.dominated(alphas, by)
        kept = np.flatnonzero(by == np.arange(len(by)))
        while (by[by] != by).any():  # the one that takes the place may itself be dropped
            by = by[by]
        self.branches = _Growing(np.searchsorted(kept, by[branches[kept]]))
        self.alphas, self.actions = _Growing(alphas[kept]), _Growing(actions[kept])
        self.limit = GROWTH * len(kept) + ROOM


class _Upper:
    """The upper bound: the corners, the sawtooth of the points, and the fast informed bound."""

    def __init__(self, pomdp: POMDP) -> None:
        self.vectors = fast_informed_bound(pomdp)
        self.corners = self.vectors.max(axis=0)
        self.points = _Beliefs(pomdp.n_states, np.empty((0, pomdp.n_states)))
        self.below = _Growing(np.empty(0))
        self.limit: float = 2 * pomdp.n_actions

    def at(self, rows: tuple[Ints, Ints, Floats]) -> Floats:
        return point_kernels.upper(
            rows, self.corners, self.points.rows, self.below.filled, self.vectors
        )

    def value(self, b: Floats) -> float:
        states = np.flatnonzero(b)
        return float(self.at((np.array([0, len(states)]), states, b[states]))[0])

    def add(self, b: Floats, value: float) -> None:
        self.points.append(b)
        self.below.append([value - b @ self.corners])

    def tidy(self) -> None:
        """Drop points that are not below the sawtooth of the others."""
        if self.below.n <= self.limit:
            return
        needed = point_kernels.needed(self.points.rows, self.below.filled, len(self.corners))
        ends, states, chances = self.points.rows
        inside = np.repeat(needed, np.diff(ends))
        self.points.ends = _Growing(np.append(0, np.diff(ends)[needed].cumsum()))
        self.points.states = _Growing(states[inside])
        self.points.chances = _Growing(chances[inside])
        self.below = _Growing(self.below.filled[needed])
        self.limit = GROWTH * self.below.n + ROOM


def blind_policies(pomdp: POMDP) -> Floats:
    """Return what each action earns if it is taken for ever: V = R + gamma T V, shape (A, S).

    For many states the equation is repeated from below, so the values are never too high.
    """
    R, T, gamma = pomdp.R, pomdp.T, pomdp.gamma
    A, S = pomdp.n_actions, pomdp.n_states
    if S <= MOST_SOLVED:
        dense = [T[a] if isinstance(T, np.ndarray) else T[a].toarray() for a in range(A)]
        systems = (np.eye(S) - gamma * T_a for T_a in dense)
        return np.stack([np.linalg.solve(M, R[:, a]) for a, M in enumerate(systems)])
    V = np.repeat(R.min(axis=0)[:, np.newaxis] / (1 - gamma), S, axis=1)
    sweeps = MOST_WORK / sum(sparse.csr_array(T_a).nnz for T_a in T)
    enough, change = ENOUGH * np.abs(R).max() * (1 - gamma), np.inf
    while change > enough and sweeps > 0:
        before, sweeps = V, sweeps - 1
        V = np.maximum(R.T + gamma * np.stack([T[a] @ V[a] for a in range(A)]), before)
        change = (V - before).max()
    return V


def fast_informed_bound(pomdp: POMDP) -> Floats:
    """Return vectors whose upper surface is nowhere below V*: the fast informed bound.

    Parameters
    ----------
    pomdp : POMDP
        The model.

    Returns
    -------
    ndarray, shape (A, S)
        One for each first action.

    Notes
    -----
    The bound pretends that after each step the best action can be chosen for the state before the
    step and the observation. It is tighter than the values of the MDP (QMDP), where the state
    itself is seen. The iteration comes down from above, so it is a bound wherever it stops. In a
    large model it stops early.

    References
    ----------
    M. Hauskrecht, "Value-function approximations for partially observable Markov decision
    processes", Journal of Artificial Intelligence Research 13, 2000.

    Examples
    --------
    >>> pomdp = POMDP(T=[np.eye(2)] * 2, O=[[[1], [1]]] * 2, R=[[1, 0], [0, 1]], gamma=0.5)
    >>> fast_informed_bound(pomdp).round(6)
    array([[2., 1.],
           [1., 2.]])
    """
    R, gamma, S = pomdp.R, pomdp.gamma, pomdp.n_states
    # Pr(s', z | s, a) for each action: rows (z, s), without those that cannot happen.
    steps = []
    for a in range(pomdp.n_actions):
        T, O = sparse.csr_array(pomdp.T[a]), sparse.csc_array(pomdp.O[a])  # noqa: E741
        parts = [T * O[:, [z]].toarray()[:, 0] for z in range(pomdp.n_observations)]
        both = sparse.csr_array(sparse.vstack(parts))
        both.eliminate_zeros()
        possible = np.flatnonzero(np.diff(both.indptr))
        steps.append((both[possible], possible % S))
    V: Floats = np.full((pomdp.n_actions, S), R.max() / (1 - gamma))
    sweeps = MOST_WORK / sum(both.nnz * len(V) for both, _ in steps)
    enough, change = ENOUGH * np.abs(R).max() * (1 - gamma), np.inf
    while change > enough and sweeps > 0:
        before, sweeps = V, sweeps - 1
        # For each s and z the best vector; then the sum over z.
        later = [np.bincount(s, (both @ V.T).max(axis=1), S) for both, s in steps]
        V = np.minimum(R.T + gamma * np.array(later), before)
        change = (before - V).max()
    return V
