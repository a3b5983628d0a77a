"""Bounds on the optimal value from points: for models whose exact solution is out of reach."""

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

# A trial goes on while the bounds are further apart than this part of what they are at the start.
ZETA = 0.9

# What counts as better, relative to the value: rounding does not.
TINY = 1e-12


@dataclass(frozen=True, eq=False)
class UpperBound:
    """A function above the optimal value function: a sawtooth hung between points.

    Attributes
    ----------
    corners : ndarray, shape (S,)
        A bound in each state, known for certain.
    points : ndarray, shape (N, S)
        Beliefs where it is known to be lower than between the corners.
    values : ndarray, shape (N,)
        The bound there.
    vectors : ndarray, shape (A, S)
        The fast informed bound, max_a b . vectors[a], which holds as well.

    Examples
    --------
    Between two corners with the value 4 the bound is known to be 2 in the middle.

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
            If `b` is no distribution over the states.
        """
        n_states = len(self.corners)
        many = np.ndim(b) == 2
        beliefs = distribution("b", array("b", b, (None, n_states) if many else (n_states,)))
        rows = np.array(beliefs, ndmin=2)  # a copy: kernels are compiled for what can be written
        below = self.values - self.points @ self.corners
        bounds = np.empty(len(rows))
        _upper(rows, self.corners, self.points, below, self.vectors, bounds)
        return bounds if many else float(bounds[0])


@dataclass(frozen=True, eq=False)
class PointBased:
    """What is known of an optimal value function after a search from a start.

    Attributes
    ----------
    lower : ValueFunction
        A policy graph, and what it earns at least. To act by it earns at least that much.
    upper : UpperBound
        Called with a belief, or many: what no policy earns more than.
    start : ndarray, shape (S,)
        The belief where the search began, and where the two are near each other.
    backups : int
        How many times a belief was used to improve both.

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
        """The upper bound minus the lower one, at the start."""
        return self.upper(self.start) - self.lower.value(self.start)

    def __repr__(self) -> str:
        low, high = self.lower.value(self.start), self.upper(self.start)
        return (
            f"PointBased({low:.6g} to {high:.6g} at the start, {len(self.lower)} vectors, "
            f"{len(self.upper.points)} points)"
        )


@kernel
def _lower(beliefs, alphas, bounds, best):
    """Fill in, for each row of `beliefs`, max_k b . alphas[k] and the first k that reaches it."""
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
    """Fill in the upper bound at each row of `beliefs`; `below` is how far each point hangs down.

    A belief b is p_i times r plus a rest, r = min_s b(s) / p_i(s); the bound is convex, so at b it
    hangs down by r below_i at least. A row may sum to less than 1: the bound is then in proportion.
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
    """Enter in `by`, for each row that is nowhere above some other, which that is."""
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
    """Tell which points hang lower than the others leave them."""
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


def fast_informed_bound(pomdp: POMDP) -> Floats:
    """Return vectors whose upper surface is nowhere below V*: the fast informed bound.

    Parameters
    ----------
    pomdp : POMDP
        The model.

    Returns
    -------
    ndarray, shape (A, S)
        Of each first action.

    Notes
    -----
    As if, one step on, the best action could be chosen for each state that was left and for each
    observation: tighter than the values of the MDP (QMDP), in which every state is seen. The
    iteration starts above and comes down, so wherever it stops it is a bound.

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


class _Rows:
    """Rows of an array that grows."""

    def __init__(self, rows: NDArray[Any]) -> None:
        self.room, self.n = rows, len(rows)

    @property
    def now(self) -> NDArray[Any]:
        return self.room[: self.n]

    def append(self, row: Any) -> None:
        if self.n == len(self.room):
            more = np.empty((self.n + 8, *self.room.shape[1:]), self.room.dtype)
            self.room = np.concatenate([self.room, more])
        self.room[self.n] = row
        self.n += 1


class Ahead(NamedTuple):
    """What can follow from a belief, for each action and observation: shapes (A, Z) and (A, Z, S).

    Values are those of the beliefs that follow times how likely they are.
    """

    joint: Floats
    lower: Floats
    branches: Ints
    upper: Floats


class _Search:
    """The two bounds, and how a look from a belief improves them there."""

    def __init__(self, pomdp: POMDP) -> None:
        self.pomdp = pomdp
        self.chances = np.ascontiguousarray(pomdp.O.transpose(0, 2, 1))
        n = np.arange(pomdp.n_actions)
        # What each action earns that is taken again and again.
        systems = np.eye(pomdp.n_states) - pomdp.gamma * pomdp.T
        self.alphas = _Rows(np.linalg.solve(systems, pomdp.R.T[..., np.newaxis])[..., 0])
        self.actions = _Rows(n)
        self.branches = _Rows(np.repeat(n[:, np.newaxis], pomdp.n_observations, axis=1))
        self.vectors = fast_informed_bound(pomdp)
        self.corners = self.vectors.max(axis=0)
        self.points, self.below = _Rows(np.empty((0, pomdp.n_states))), _Rows(np.empty(0))
        self.many_vectors = self.many_points = 2 * len(n)

    def lower(self, b: Floats) -> float:
        return float((self.alphas.now @ b).max())

    def upper(self, beliefs: Floats) -> Floats:
        bounds = np.empty(len(beliefs))
        _upper(beliefs, self.corners, self.points.now, self.below.now, self.vectors, bounds)
        return bounds

    def gap(self, b: Floats) -> float:
        return float(self.upper(np.array([b]))[0]) - self.lower(b)

    def look(self, b: Floats) -> Ahead:
        joint = (b @ self.pomdp.T)[:, np.newaxis] * self.chances
        flat = joint.reshape(-1, len(b))
        lower, branches = np.empty(len(flat)), np.empty(len(flat), dtype=np.int64)
        _lower(flat, self.alphas.now, lower, branches)
        Z = self.pomdp.n_observations
        upper = self.upper(flat)
        return Ahead(joint, lower.reshape(-1, Z), branches.reshape(-1, Z), upper.reshape(-1, Z))

    def improve(self, b: Floats) -> None:
        """Make the best vector for a belief, and hang the upper bound lower there."""
        pomdp, ahead = self.pomdp, self.look(b)
        rewards = b @ pomdp.R
        high = (rewards + pomdp.gamma * ahead.upper.sum(axis=1)).max()
        if high < self.upper(np.array([b]))[0] - TINY * abs(high):
            self.points.append(b)
            self.below.append(high - b @ self.corners)
        earned = rewards + pomdp.gamma * ahead.lower.sum(axis=1)
        a = int(earned.argmax())
        if earned[a] > self.lower(b) + TINY * abs(earned[a]):
            later = (self.chances[a] * self.alphas.now[ahead.branches[a]]).sum(axis=0)
            self.alphas.append(pomdp.R[:, a] + pomdp.gamma * pomdp.T[a] @ later)
            self.actions.append(a)
            self.branches.append(ahead.branches[a])

    def trial(self, most: int) -> int:
        """Walk to where the bounds are too far apart, improve them on the way back."""
        b: Floats = self.pomdp.start
        path: list[Floats] = []
        enough = ZETA * self.gap(b)
        while len(path) < most:
            path.append(b)
            enough = enough / self.pomdp.gamma if self.pomdp.gamma else np.inf
            ahead = self.look(b)
            a = (b @ self.pomdp.R + self.pomdp.gamma * ahead.upper.sum(axis=1)).argmax()
            mass = ahead.joint[a].sum(axis=1)
            excess = ahead.upper[a] - ahead.lower[a] - mass * enough
            z = excess.argmax()
            if not excess[z] > 0:
                break
            b = ahead.joint[a, z] / mass[z]
        for b in reversed(path):
            self.improve(b)
        self.tidy()
        return len(path)

    def tidy(self) -> None:
        """Drop what others make superfluous, whenever there is a quarter more of it."""
        if self.alphas.n > self.many_vectors:
            by = np.arange(self.alphas.n)
            _dominated(self.alphas.now, by)
            kept = np.flatnonzero(by == np.arange(len(by)))
            while (by[by] != by).any():
                by = by[by]
            branches = np.searchsorted(kept, by[self.branches.now[kept]])
            self.alphas, self.actions = _Rows(self.alphas.now[kept]), _Rows(self.actions.now[kept])
            self.branches = _Rows(branches)
            self.many_vectors = 5 * len(kept) // 4 + 8
        if self.points.n > self.many_points:
            kept = np.flatnonzero(_needed(self.points.now, self.below.now))
            self.points, self.below = _Rows(self.points.now[kept]), _Rows(self.below.now[kept])
            self.many_points = 5 * len(kept) // 4 + 8


def solve_point_based(pomdp: POMDP, tol: float = 1e-3, max_backups: int = 10_000) -> PointBased:
    """Close in on the optimal value at the start from above and below, where beliefs matter.

    Parameters
    ----------
    pomdp : POMDP
        The model; the search begins at its `start`.
    tol : float, default 1e-3
        The search ends when the bounds at the start are no further apart than this.
    max_backups : int, default 10000
        Or when so many vectors were tried. There is no limit in seconds: the same model gives the
        same bounds on every machine.

    Returns
    -------
    PointBased
        `lower`, a policy graph as a value function, and `upper`, a function of beliefs. Both hold
        everywhere (up to the rounding of floats), and are near each other where the search has
        been.

    Raises
    ------
    ValueError
        If `tol` is not above 0 or `max_backups` is not an integer >= 0.

    See Also
    --------
    solve_pomdp : exact at every belief, for small models.

    Notes
    -----
    Heuristic search value iteration. The bounds begin with policies that never change their
    action, and with the fast informed bound. A trial walks from the start: by the action that may
    be best, the one with the highest upper bound, to the observation after which the bounds are
    most too far apart. What is too far grows by 1 / gamma with each step, so a walk ends. On the
    way back each belief on it improves both: a new vector below, and above a lower point, between
    which the bound is a sawtooth. A new vector says how its plan goes on after each observation,
    and a vector that another is nowhere below hands its place to it: so the vectors stay a policy
    graph, whose values (`PolicyGraph.values`) are nowhere below them.

    After more than two seconds a progress bar shows.

    References
    ----------
    T. Smith, R. Simmons, "Point-based POMDP algorithms: improved analysis and implementation",
    UAI 2005. J. Pineau, G. Gordon, S. Thrun, "Point-based value iteration: an anytime algorithm
    for POMDPs", IJCAI 2003.

    Examples
    --------
    The ball is left or right of the robot and stays there. A look errs in one of ten cases; a kick
    to the right side earns 1, to the wrong side costs 1.

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
    alphas = search.alphas.now
    # Nowhere is V* above the plane through the corners, nor V below any of its vectors.
    error = float((search.corners - alphas).max(axis=1).min())
    lower = ValueFunction(alphas, search.actions.now, search.branches.now, None, error)
    values = search.below.now + search.points.now @ search.corners
    upper = UpperBound(search.corners, search.points.now, values, search.vectors)
    return PointBased(lower, upper, pomdp.start, backups)
