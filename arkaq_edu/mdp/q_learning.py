"""Q-learning in a table: learn what each action is worth in each state by trying it."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import (
    LARGEST,
    affordable,
    array,
    generator,
    integer,
    integers,
    n_axes,
    number,
    shown,
)
from arkaq_edu.mdp import compiled
from arkaq_edu.mdp.choice import softmax


class QLearner:
    """Q-learning over a table of states and actions.

    Parameters
    ----------
    n_states, n_actions : int
        Size of the table, each at least 1. States and actions are counted from 0.
    alpha : float, "1/visits" or callable
        The learning rate: a constant in [0, 1]; ``"1/visits"``, which makes Q(s, a) the mean of
        its targets; or a function of the visit n = 1, 2, ... of the pair that returns a rate in
        [0, 1].
    gamma : float
        The discount rate per step, in [0, 1].
    initial : float, default 0.0
        The first value of every Q(s, a). With a value above all possible returns, the greedy
        choice tries every action.
    rng : numpy.random.Generator or int, optional
        The random numbers of `boltzmann` and `greedy`: each call takes one.

    Attributes
    ----------
    Q : ndarray of float64, shape (n_states, n_actions)
        Expected return of each pair; may be written to in place. -inf marks an action that the
        state does not allow: it is never drawn, and cannot be learned.
    visits : ndarray of int64, shape (n_states, n_actions)
        Number of backups of each pair.

    Raises
    ------
    ValueError
        If an argument is outside its range.

    Notes
    -----
    "Converges if the environment is stationary" (2.2.3) is only one condition. Q reaches Q* with
    probability one if every pair is visited again and again, too, and if the learning rates of
    each pair sum to infinity while their squares sum to a finite number. 1/n meets this; a
    constant does not. The constant alpha = 1, with which 4.3 starts, is exact where outcomes are
    certain. Where they are random, it never settles.

    References
    ----------
    Thesis 2.2.3 (equation 2.12), chapter 3 (equations 3.1-3.3) and 4.3.
    C. Watkins, P. Dayan, "Q-learning", Machine Learning 8, 1992.

    Examples
    --------
    >>> learner = QLearner(n_states=3, n_actions=2, alpha=1.0, gamma=0.9, rng=0)
    >>> learner.update(1, 0, 100.0, 2, terminated=True)
    100.0
    >>> learner.update(0, 0, 0.0, 1, terminated=False)
    90.0
    >>> learner.Q
    array([[ 90.,   0.],
           [100.,   0.],
           [  0.,   0.]])
    >>> learner.greedy(0), learner.unvisited(0)
    (0, array([1]))
    """

    def __init__(
        self,
        n_states: int,
        n_actions: int,
        alpha: float | str | Callable[[int], float],
        gamma: float,
        *,
        initial: float = 0.0,
        rng: np.random.Generator | int | None = None,
    ) -> None:
        shape = integer("n_states", n_states, 1), integer("n_actions", n_actions, 1)
        if isinstance(alpha, str) and alpha != "1/visits":
            raise ValueError(f"alpha must be a number, '1/visits' or a callable, got {alpha!r}")
        if not callable(alpha) and not isinstance(alpha, str):
            alpha = number("alpha", alpha, 0, 1)
        self.alpha = alpha
        self.gamma = number("gamma", gamma, 0, 1)
        self.Q = np.full(affordable("n_states and n_actions", shape), number("initial", initial))
        self.visits = np.zeros(shape, np.int64)
        self.rng = generator("rng", rng)

    def update(
        self,
        s: int,
        a: int,
        r: float,
        s_next: int,
        terminated: bool = False,
        n_steps: int = 1,
    ) -> float:
        """Learn from one experience (equation 2.12).

        Parameters
        ----------
        s, a, s_next : int
            The state, the action taken in it, and the next state.
        r : float
            The reward. For an action held for k steps, the discounted sum of their rewards:
            r_1 + gamma r_2 + ... + gamma^(k-1) r_k.
        terminated : bool, default False
            Whether the episode ended in `s_next`, after which nothing more is earned. An episode
            that was only cut short (truncated) has not ended.
        n_steps : int, default 1
            The number of steps k for which the action was held ("while current state remains
            same", figure 4.3). The process is semi-Markov: the future is discounted by gamma^k.

        Returns
        -------
        float
            The change of Q(s, a). Thesis 4.3 watches it to decide when learning has converged.

        Raises
        ------
        ValueError
            If an index is not an integer inside the table, `n_steps` is below 1, `terminated` is
            neither true nor false, or `r` is not a number in [-1e100, 1e100]. If `a` is not
            allowed in `s`, or no action in `s_next`. Then nothing is learned.

        Examples
        --------
        >>> learner = QLearner(2, 1, alpha=1.0, gamma=0.5, initial=8.0)
        >>> learner.update(0, 0, 0.0, 1, n_steps=3)  # 0.5**3 * 8
        -7.0
        """
        Q, visits = self.Q, self.visits
        n_states, n_actions = Q.shape
        s, s_next = integer("s", s, 0, n_states - 1), integer("s_next", s_next, 0, n_states - 1)
        a, n_steps = integer("a", a, 0, n_actions - 1), integer("n_steps", n_steps, 1)
        r, terminated = number("r", r), _flag("terminated", terminated)
        best = max(Q[s_next].tolist())
        if best == -math.inf or Q[s, a] == -math.inf:
            raise ValueError(_refusal(s, a, s_next, best))

        alpha = self._rate(int(visits[s, a]) + 1)
        visits[s, a] += 1
        discount = 0.0 if terminated else self.gamma**n_steps
        target = r + discount * best
        before = Q[s, a]
        Q[s, a] += alpha * (target - Q[s, a])
        return float(Q[s, a] - before)

    def _rate(self, n: int) -> float:
        """Return the learning rate of the n-th visit of a pair."""
        if callable(self.alpha):
            return number(f"alpha({n})", self.alpha(n), 0, 1)
        return 1 / n if isinstance(self.alpha, str) else self.alpha

    def rates(self, n: int) -> NDArray[np.float64]:
        """Return the learning rates of the next n backups, by visit, for the compiled loops.

        Parameters
        ----------
        n : int
            The number of backups to come.

        Returns
        -------
        ndarray
            Entry k - 1 is the rate of the k-th visit of a pair; the last entry that of all later
            ones.

        Raises
        ------
        ValueError
            If the schedule returns a rate outside [0, 1].

        Examples
        --------
        >>> QLearner(1, 1, alpha="1/visits", gamma=0.9).rates(4)
        array([1.        , 0.5       , 0.33333333, 0.25      ])
        """
        most = int(self.visits.max()) + integer("n", n)
        affordable("n", (most,))
        if callable(self.alpha):
            rates = array("alpha", [self.alpha(n) for n in range(1, most + 1)], (most,))
            for i in np.flatnonzero(~((rates >= 0) & (rates <= 1))):
                number(f"alpha({i + 1})", rates[i], 0, 1)
            return rates
        return 1 / np.arange(1, most + 1) if isinstance(self.alpha, str) else np.array([self.alpha])

    def replay(
        self,
        s: ArrayLike,
        a: ArrayLike,
        r: ArrayLike,
        s_next: ArrayLike,
        terminated: ArrayLike,
        n_steps: ArrayLike = 1,
    ) -> NDArray[np.float64]:
        """Learn from N recorded experiences in their order, in one compiled loop.

        Parameters
        ----------
        s, a, r, s_next, terminated, n_steps : array_like, shape (N,)
            As in `update`. Each may be one value for all experiences.

        Returns
        -------
        changes : ndarray, shape (N,)
            What `update` would return for each experience. The table becomes the same to the last
            bit.

        Raises
        ------
        ValueError
            As `update` does, with the place of the fault. Then nothing is learned.

        Examples
        --------
        >>> learner = QLearner(3, 1, alpha=1.0, gamma=0.9)
        >>> learner.replay([1, 0], 0, [100.0, 0.0], [2, 1], [True, False])
        array([100.,  90.])
        """
        experiences = s, a, r, s_next
        if not _ready(*experiences):
            experiences = self._in_table(*experiences)
        columns = np.atleast_1d(
            *experiences, _flags("terminated", terminated), integers("n_steps", n_steps, 1)
        )
        try:
            shape = np.broadcast(*columns).shape
        except ValueError:
            lengths = ", ".join(str(c.shape) for c in columns)
            raise ValueError(f"the columns must have one length, got shapes {lengths}") from None
        if len(shape) != 1:
            raise ValueError(f"the columns must have shape (N,), got {shape}")
        s, a, r, s_next = (
            np.ascontiguousarray(c if c.shape == shape else np.broadcast_to(c, shape))
            for c in columns[:4]
        )
        # The loop itself repeats a single `terminated` or `n_steps`: that saves two copies.
        terminated, n_steps = map(np.ascontiguousarray, columns[4:])
        # It learns in copies, so that it can check each experience as it comes to it.
        Q, visits, changes = self.Q.copy(), self.visits.copy(), np.empty(shape)
        learned = compiled.replay(
            Q, visits, s, a, r, s_next, terminated, n_steps, self.rates(len(changes)), self.gamma,
            changes,
        )  # fmt: skip
        if learned < len(changes):
            self._in_table(s, a, r, s_next)
            s_i, a_i, s_next_i = (int(column[learned]) for column in (s, a, s_next))
            refusal = _refusal(s_i, a_i, s_next_i, self.Q[s_next_i].max())
            raise ValueError(f"{refusal} at ({learned},)")
        self.Q[:], self.visits[:] = Q, visits
        return changes

    def _in_table(self, s: ArrayLike, a: ArrayLike, r: ArrayLike, s_next: ArrayLike) -> Any:
        """Return columns of experiences in the table's range."""
        n_states, n_actions = self.Q.shape
        return (
            integers("s", s, 0, n_states - 1),
            integers("a", a, 0, n_actions - 1),
            array("r", r, (None,) * n_axes("r", r)),
            integers("s_next", s_next, 0, n_states - 1),
        )

    def probabilities(self, s: int, temperature: float) -> NDArray[np.float64]:
        """Return the Boltzmann probabilities of the actions in `s` (equation 3.2).

        Parameters
        ----------
        s : int
            The state.
        temperature : float
            T > 0, in the unit of the rewards. It is not a probability, as chapter 3 of the thesis
            has it. As T falls to 0, only the best actions are drawn. As it grows, all actions
            become equally likely.

        Returns
        -------
        ndarray, shape (n_actions,)

        Raises
        ------
        ValueError
            If `s` is outside the table or `temperature` is not above 0.

        Examples
        --------
        >>> learner = QLearner(1, 2, alpha=1.0, gamma=0.0)
        >>> learner.Q[0] = [0.0, np.log(3.0)]
        >>> learner.probabilities(0, temperature=1.0)
        array([0.25, 0.75])
        """
        return softmax(self._row(s), temperature)

    def boltzmann(self, s: int, temperature: float) -> int:
        """Draw an action by its probability at this temperature (equation 3.2).

        Parameters
        ----------
        s : int
            The state.
        temperature : float
            T > 0, see `probabilities`.

        Returns
        -------
        int
            The action.

        Raises
        ------
        ValueError
            If `s` is outside the table or `temperature` is not above 0.

        Examples
        --------
        >>> learner = QLearner(1, 2, alpha=1.0, gamma=0.0, rng=0)
        >>> learner.Q[0] = [0.0, 5.0]
        >>> learner.boltzmann(0, temperature=0.1)
        1
        """
        q, T = self._row(s), number("temperature", temperature, 0, open_low=True)
        top = max(q)
        # -inf / inf has no value: an action that is not allowed has the weight 0 at any T.
        weights = [math.exp((x - top) / T) if x > -math.inf else 0.0 for x in q]
        below = list(accumulate(weights))
        total = below[-1]
        # The product can be rounded up to the total: then it is the last action with a weight.
        return min(bisect_right(below, self.rng.random() * total), bisect_left(below, total))

    def greedy(self, s: int) -> int:
        """Draw one of the best actions of `s`; each of n has probability 1/n (equation 3.3).

        Parameters
        ----------
        s : int
            The state.

        Returns
        -------
        int
            The action.

        Raises
        ------
        ValueError
            If `s` is outside the table.

        Examples
        --------
        >>> learner = QLearner(1, 3, alpha=1.0, gamma=0.0, rng=0)
        >>> learner.Q[0] = [5.0, 1.0, 5.0]
        >>> sorted({learner.greedy(0) for _ in range(100)})
        [0, 2]
        """
        q = self._row(s)
        top = max(q)
        best = [a for a, x in enumerate(q) if x == top]
        return best[int(self.rng.random() * len(best))]

    def explore(self, s: int) -> int:
        """Draw an action that has had no backup in `s`; if there is none, any action.

        Parameters
        ----------
        s : int
            The state.

        Returns
        -------
        int
            The action.

        Raises
        ------
        ValueError
            If `s` is outside the table.

        References
        ----------
        Thesis 4.3 (figure 4.3).

        Examples
        --------
        >>> learner = QLearner(1, 2, alpha=1.0, gamma=0.0, rng=0)
        >>> learner.update(0, 0, 5.0, 0)
        5.0
        >>> learner.explore(0)
        1
        """
        untried = self.unvisited(s)
        if not len(untried):
            untried = np.flatnonzero(np.array(self._row(s)) > -np.inf)
        return int(untried[self.rng.integers(len(untried))])

    def unvisited(self, s: int) -> NDArray[np.intp]:
        """Return the allowed actions that have had no backup in `s`, in increasing order.

        Parameters
        ----------
        s : int
            The state.

        Returns
        -------
        ndarray of int
            Possibly empty.

        Raises
        ------
        ValueError
            If `s` is outside the table.

        Examples
        --------
        >>> QLearner(1, 3, alpha=1.0, gamma=0.0).unvisited(0)
        array([0, 1, 2])
        """
        s = integer("s", s, 0, len(self.Q) - 1)
        return np.flatnonzero((self.visits[s] == 0) & (self.Q[s] > -np.inf))

    def _row(self, s: int) -> list[float]:
        """Return the values of the actions in `s`, checked."""
        s = integer("s", s, 0, len(self.Q) - 1)
        q: list[float] = self.Q[s].tolist()
        if not all(x <= LARGEST for x in q):
            array("Q", q, (None,), allow_minus_infinity=True)  # says which entry it is
        if max(q) == -math.inf:
            raise ValueError(f"Q must allow an action in every state, got only -inf in state {s}")
        return q

    def state(self) -> dict[str, Any]:
        """Return all that has been learned, so that the same run can be continued from it.

        Returns
        -------
        dict
            ``Q`` and ``visits``, copied arrays of shape (n_states, n_actions), and ``rng``, the
            state of the generator (for ``numpy.random.default_rng``, plain numbers and strings
            that JSON can hold).

        Examples
        --------
        >>> learner = QLearner(2, 2, alpha=0.5, gamma=0.9, rng=1)
        >>> before = learner.state()
        >>> draws = [learner.greedy(0) for _ in range(20)]
        >>> learner.restore(before)
        >>> draws == [learner.greedy(0) for _ in range(20)]
        True
        """
        rng = self.rng.bit_generator.state
        return {"Q": self.Q.copy(), "visits": self.visits.copy(), "rng": rng}

    def restore(self, state: dict[str, Any]) -> None:
        """Take over what `state` returned, here or in another process.

        Parameters
        ----------
        state : dict
            With ``Q``, ``visits`` and ``rng``.

        Raises
        ------
        ValueError
            If an entry is missing, has another shape than this table, holds a value that is not a
            number or a negative count, or belongs to another kind of generator.
        """
        if not isinstance(state, Mapping):
            raise ValueError(f"state must be a dict, got {shown(state)}")
        missing = {"Q", "visits", "rng"} - set(state)
        if missing:
            raise ValueError(f"state must hold Q, visits and rng, got no {sorted(missing)[0]}")
        Q = array("Q", state["Q"], self.Q.shape, allow_minus_infinity=True)
        visits = integers("visits", state["visits"], 0)
        if visits.shape != Q.shape:
            raise ValueError(f"visits must have shape {Q.shape}, got {visits.shape}")
        try:
            self.rng.bit_generator.state = state["rng"]
        except (TypeError, ValueError, KeyError):
            kind = type(self.rng.bit_generator).__name__
            raise ValueError(f"rng must be the state of a {kind} generator") from None
        self.Q[:], self.visits[:] = Q, visits


def _flag(name: str, value: Any) -> bool:
    """Return a truth value: true, false, 1 or 0, also from an array of one element."""
    if value is True or value is False:
        return value
    flags = _flags(name, value)
    if flags.size != 1:
        raise ValueError(f"{name} must be true or false, got {shown(value)}")
    return bool(flags.item())


def _flags(name: str, value: ArrayLike) -> NDArray[np.bool_]:
    """Return an array of truth values."""
    n_axes(name, value)
    x = np.asarray(value)
    return x if x.dtype == bool else integers(name, value, 0, 1).astype(bool)


def _refusal(s: int, a: int, s_next: int, best: float) -> str:
    """Say what is not allowed in an experience."""
    if best == -math.inf:
        return f"s_next must allow an action, got only Q = -inf in state {s_next}"
    return f"a must be an action that state {s} allows, got {a} with Q = -inf"


def _ready(*experiences: Any) -> bool:
    """Return whether the compiled loop can read columns, and check them, as they are."""
    kinds = (np.int64, np.int64, np.float64, np.int64)
    return (
        all(type(x) is np.ndarray and x.ndim == 1 for x in experiences)
        and tuple(x.dtype for x in experiences) == kinds
    )
