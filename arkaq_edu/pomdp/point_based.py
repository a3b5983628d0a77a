"""Bounds on the optimal value from points, for models whose exact solution is out of reach."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm.auto import tqdm

from arkaq_edu._checks import array, distribution, integer, number
from arkaq_edu._compiled import kernel
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
        many = np.ndim(b) == 2
        beliefs = distribution("b", array("b", b, (None, n_states) if many else (n_states,)))
        rows = np.array(beliefs, ndmin=2)  # a copy: kernels are compiled for writable arrays
        below = self.values - self.points @ self.corners
        bounds = np.empty(len(rows))
        _upper(rows, self.corners, self.points, below, self.vectors, bounds)
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


def solve_point_based(pomdp: POMDP, tol: float = 1e-3, max_backups: int = 10_000) -> PointBased:
    """Bound the optimal value at the start from below and from above.

    Parameters
    ----------
    pomdp : POMDP
        The model. The search begins at its `start`.
    tol : float, default 1e-3
        The search ends when the bounds at the start are no further apart than this.
    max_backups : int, default 10000
        The search also ends after this many backups. There is no time limit, so the bounds do not
        depend on the speed of the machine.

    Returns
    -------
    PointBased
        `lower`, a policy graph as a value function, and `upper`, a function of beliefs. Both hold
        at every belief, up to rounding. They are close together where the search has been.

    Raises
    ------
    ValueError
        If `tol` is not above 0 or `max_backups` is not an integer >= 0.

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
    tol = number("tol", tol, 0, open_low=True)
    max_backups = integer("max_backups", max_backups, 0)
    search, backups = _Search(pomdp), 0
    with tqdm(total=max_backups, desc="bounds", unit="backup", delay=2, leave=False) as bar:
        while backups < max_backups and (gap := search.gap(pomdp.start)) > tol:
            steps = search.trial(max_backups - backups)
            backups += steps
            bar.update(steps)
            bar.set_postfix(gap=f"{gap:.2g}", refresh=False)
    low, high = search.lower, search.upper
    # V* is nowhere above the plane through the corners, and V nowhere below any of its vectors.
    error = float((high.corners - low.alphas).max(axis=1).min())
    lower = ValueFunction(low.alphas, low.actions, low.branches, None, error)
    values = high.below + high.points @ high.corners
    upper = UpperBound(high.corners, high.points, values, high.vectors)
    return PointBased(lower, upper, pomdp.start, backups)


class _Ahead(NamedTuple):
    """What can follow a belief, for each action and observation.

    The bounds are those of the next belief, times the probability of getting there.
    """

    joint: Floats  # (A, Z, S): Pr(s', z | b, a)
    lower: Floats  # (A, Z)
    branches: Ints  # (A, Z): the vector that attains `lower`
    upper: Floats  # (A, Z)


class _Search:
    """Heuristic search: where to improve the two bounds, and how."""

    def __init__(self, pomdp: POMDP) -> None:
        self.pomdp = pomdp
        self.seen = np.ascontiguousarray(pomdp.O.transpose(0, 2, 1))  # (A, Z, S): O(s', a, z)
        self.lower, self.upper = _Lower(pomdp), _Upper(pomdp)

    def gap(self, b: Floats) -> float:
        return float(self.upper.at(np.array([b]))[0]) - self.lower.value(b)

    def look(self, b: Floats) -> _Ahead:
        joint = (b @ self.pomdp.T)[:, np.newaxis] * self.seen  # equation 2.15, not yet divided
        beliefs = joint.reshape(-1, len(b))
        lower, branches = self.lower.at(beliefs)
        upper = self.upper.at(beliefs)
        AZ = joint.shape[:2]
        return _Ahead(joint, lower.reshape(AZ), branches.reshape(AZ), upper.reshape(AZ))

    def improve(self, b: Floats) -> None:
        """Back up both bounds at a belief; a bound that would not improve is left as it is."""
        R, T, gamma = self.pomdp.R, self.pomdp.T, self.pomdp.gamma
        ahead = self.look(b)
        high = (b @ R + gamma * ahead.upper.sum(axis=1)).max()
        if high < self.upper.at(np.array([b]))[0] - TINY * abs(high):
            self.upper.add(b, high)
        earned = b @ R + gamma * ahead.lower.sum(axis=1)
        a = int(earned.argmax())
        if earned[a] > self.lower.value(b) + TINY * abs(earned[a]):
            later = (self.seen[a] * self.lower.alphas[ahead.branches[a]]).sum(axis=0)
            self.lower.add(R[:, a] + gamma * T[a] @ later, a, ahead.branches[a])  # equation 2.19

    def trial(self, most: int) -> int:
        """Walk to where the bounds are too far apart, and improve them on the way back.

        Return the number of backups.
        """
        R, gamma = self.pomdp.R, self.pomdp.gamma
        b: Floats = self.pomdp.start
        path: list[Floats] = []
        enough = ZETA * self.gap(b)
        while len(path) < most:
            path.append(b)
            enough = enough / gamma if gamma else np.inf
            ahead = self.look(b)
            a = (b @ R + gamma * ahead.upper.sum(axis=1)).argmax()
            chances = ahead.joint[a].sum(axis=1)
            excess = ahead.upper[a] - ahead.lower[a] - chances * enough
            z = excess.argmax()
            if not excess[z] > 0:
                break
            b = ahead.joint[a, z] / chances[z]
        for b in reversed(path):
            self.improve(b)
        self.lower.tidy()
        self.upper.tidy()
        return len(path)


class _Lower:
    """The lower bound: vectors, each with its action and the vectors that follow it."""

    def __init__(self, pomdp: POMDP) -> None:
        A, Z = pomdp.n_actions, pomdp.n_observations
        # What each action earns if it is taken for ever: V = R + gamma T V.
        systems = np.eye(pomdp.n_states) - pomdp.gamma * pomdp.T
        self.alphas: Floats = np.linalg.solve(systems, pomdp.R.T[..., np.newaxis])[..., 0]
        self.actions = np.arange(A)
        self.branches = np.repeat(self.actions[:, np.newaxis], Z, axis=1)
        self.limit: float = 2 * A

    def value(self, b: Floats) -> float:
        return float((self.alphas @ b).max())

    def at(self, beliefs: Floats) -> tuple[Floats, Ints]:
        """Return the bound at some beliefs, and the vectors that attain it."""
        bounds, best = np.empty(len(beliefs)), np.empty(len(beliefs), dtype=np.int64)
        _lower(beliefs, self.alphas, bounds, best)
        return bounds, best

    def add(self, alpha: Floats, action: int, branches: Ints) -> None:
        self.alphas = np.concatenate([self.alphas, alpha[np.newaxis]])
        self.actions = np.append(self.actions, action)
        self.branches = np.concatenate([self.branches, branches[np.newaxis]])

    def tidy(self) -> None:
        """Drop vectors that are nowhere above another one, which takes their place."""
        if len(self.alphas) <= self.limit:
            return
        by = np.arange(len(self.alphas))
        _dominated(self.alphas, by)
        kept = np.flatnonzero(by == np.arange(len(by)))
        while (by[by] != by).any():  # the one that takes the place may itself be dropped
            by = by[by]
        self.branches = np.searchsorted(kept, by[self.branches[kept]])
        self.alphas, self.actions = self.alphas[kept], self.actions[kept]
        self.limit = GROWTH * len(kept) + ROOM


class _Upper:
    """The upper bound: the corners, the sawtooth of the points, and the fast informed bound."""

    def __init__(self, pomdp: POMDP) -> None:
        self.vectors = fast_informed_bound(pomdp)
        self.corners = self.vectors.max(axis=0)
        self.points, self.below = np.empty((0, pomdp.n_states)), np.empty(0)
        self.limit: float = 2 * pomdp.n_actions

    def at(self, beliefs: Floats) -> Floats:
        bounds = np.empty(len(beliefs))
        _upper(beliefs, self.corners, self.points, self.below, self.vectors, bounds)
        return bounds

    def add(self, b: Floats, value: float) -> None:
        self.points = np.concatenate([self.points, b[np.newaxis]])
        self.below = np.append(self.below, value - b @ self.corners)

    def tidy(self) -> None:
        """Drop points that are not below the sawtooth of the others."""
        if len(self.points) <= self.limit:
            return
        kept = np.flatnonzero(_needed(self.points, self.below))
        self.points, self.below = self.points[kept], self.below[kept]
        self.limit = GROWTH * len(kept) + ROOM


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
    itself is seen. The iteration comes down from above, so it is a bound wherever it stops.

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
    T, O, gamma = pomdp.T, pomdp.O, pomdp.gamma  # noqa: E741
    top = pomdp.R.max() / (1 - gamma)
    vectors: Floats = np.full((pomdp.n_actions, pomdp.n_states), top)
    enough = 1e-10 * np.abs(pomdp.R).max()
    while True:
        before = vectors
        ahead = [
            sum((T[a] @ (O[a, :, z, np.newaxis] * before.T)).max(axis=1) for z in range(O.shape[2]))
            for a in range(pomdp.n_actions)
        ]
        vectors = np.minimum(pomdp.R.T + gamma * np.array(ahead), before)
        if (before - vectors).max() <= enough * (1 - gamma):
            return vectors


@kernel
def _lower(beliefs, alphas, bounds, best):
    """Set bounds[i] = max_k b . alphas[k] for row b = beliefs[i], and best[i] to the first k."""
    support = np.empty(beliefs.shape[1], dtype=np.int64)
    for i in range(len(beliefs)):
        n = 0
        for s in range(beliefs.shape[1]):
            if beliefs[i, s] > 0:
                support[n] = s
                n += 1
        bounds[i], best[i] = -np.inf, 0
        for k in range(len(alphas)):
            value = 0.0
            for j in range(n):
                value += beliefs[i, support[j]] * alphas[k, support[j]]
            if value > bounds[i]:
                bounds[i], best[i] = value, k


@kernel
def _upper(beliefs, corners, points, below, vectors, bounds):
    """Fill in the upper bound at each row b of `beliefs`; it is the lowest of three.

    The plane through the corners; that plane minus the sawtooth of a point; and the fast informed
    bound. below[i] <= 0 is how far point p_i lies below the plane. With r = min_s b(s) / p_i(s), b
    is r p_i plus a rest, and because V* is convex, the bound at b is lower by r below[i] at least.
    A row may sum to less than 1; its bound is in proportion.
    """
    n_states = len(corners)
    for k in range(len(beliefs)):
        mass, flat, deepest = 0.0, 0.0, 0.0
        for s in range(n_states):
            mass += beliefs[k, s]
            flat += beliefs[k, s] * corners[s]
        for i in range(len(points)):
            if mass * below[i] >= deepest:
                continue
            r = mass
            for s in range(n_states):
                if beliefs[k, s] < r * points[i, s]:
                    r = beliefs[k, s] / points[i, s]
                    if r * below[i] >= deepest:
                        break
            deepest = min(deepest, r * below[i])
        informed = -np.inf
        for a in range(len(vectors)):
            value = 0.0
            for s in range(n_states):
                value += beliefs[k, s] * vectors[a, s]
            informed = max(informed, value)
        bounds[k] = min(flat + deepest, informed)


@kernel
def _dominated(alphas, by):
    """Set by[i] = j for each row i that is nowhere above another row j; by[i] = i before."""
    for i in range(len(alphas)):
        for j in range(len(alphas)):
            if i == j or by[j] != j:
                continue
            s = 0
            while s < alphas.shape[1] and alphas[i, s] <= alphas[j, s]:
                s += 1
            if s == alphas.shape[1]:
                by[i] = j
                break


@kernel
def _needed(points, below):
    """Return which points are below the sawtooth of all others."""
    needed = np.ones(len(points), dtype=np.bool_)
    for i in range(len(points)):
        for j in range(len(points)):
            if i == j or not needed[j] or below[j] > below[i]:
                continue
            r = 1.0
            for s in range(points.shape[1]):
                if points[i, s] < r * points[j, s]:
                    r = points[i, s] / points[j, s]
            if r * below[j] <= below[i]:
                needed[i] = False
                break
    return needed
