"""Q-learning in a table: learn what each action is worth in each state by trying it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, integer, number
from arkaq_edu.mdp._indices import indices
from arkaq_edu.mdp.compiled import (
    ONE_OVER_VISITS,
    PAIR,
    backup,
    draw_boltzmann,
    draw_greedy,
    replay,
)
from arkaq_edu.mdp.schedules import softmax


class _Typed:
    """A kernel compiled, at its first call, for one set of types: `call` is the machine code.

    Numba looks up the types of all arguments at every call, which takes longer than the work here;
    this does without, and takes an int for a float.
    """

    def __init__(self, function: Callable[..., Any], *types: str) -> None:
        self.function, self.types = function, types
        self.call: Callable[..., Any] = self.compile

    def compile(self, pairs: NDArray[np.void], *rest: Any) -> Any:
        self.call = self.function
        if hasattr(self.function, "compile"):
            import numba

            types = [getattr(numba, name) for name in self.types]
            self.call = self.function.compile((numba.typeof(pairs), *types))
        return self.call(pairs, *rest)


_BACKUP = _Typed(backup, "int64", "int64", "float64", "int64", "float64", "float64")
_BOLTZMANN = _Typed(draw_boltzmann, "int64", "float64", "float64")
_GREEDY = _Typed(draw_greedy, "int64", "float64")


class QLearner:
    """Q-learning over a table of states and actions.

    Parameters
    ----------
    n_states, n_actions : int
        Size of the table, each at least 1. States and actions are counted from 0.
    alpha : float, "1/visits" or callable
        The learning rate: a constant in [0, 1]; ``"1/visits"``, which makes Q(s, a) the mean of
        its targets; or a function that takes the number n of this visit of the pair (1, 2, ...)
        and returns a rate in [0, 1].
    gamma : float
        The discount rate per step, in [0, 1].
    initial : float, default 0.0
        What every Q(s, a) starts from. A value above what can be earned makes the greedy choice
        try everything once.
    rng : numpy.random.Generator or int, optional
        Where the draws of `boltzmann` and `greedy` come from: each takes one number.

    Attributes
    ----------
    Q : ndarray of float64, shape (n_states, n_actions)
        Expected return of each pair; may be written to in place.
    visits : ndarray of int64, shape (n_states, n_actions)
        How many backups each pair has had.

    Raises
    ------
    ValueError
        If an argument is outside its range.

    Notes
    -----
    "Converges if the environment is stationary" (2.2.3) is half of it. With probability one
    Q reaches Q* if also every pair is visited again and again, and the rates of each pair's visits
    sum to infinity while their squares do not: 1/n does, a constant does not. A constant alpha = 1,
    which 4.3 starts from, is exact where outcomes are certain and never settles where they are not.

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
        self.alpha = alpha
        self.gamma = gamma
        self._pairs = np.empty(shape, PAIR)
        self._pairs["Q"] = number("initial", initial)
        self._pairs["visits"] = 0
        self.rng = np.random.default_rng(rng)

    @property
    def Q(self) -> NDArray[np.float64]:
        """Expected return of each pair, shape (n_states, n_actions): a view, not a copy."""
        return self._pairs["Q"]

    @property
    def visits(self) -> NDArray[np.int64]:
        """Number of backups of each pair, shape (n_states, n_actions): a view, not a copy."""
        return self._pairs["visits"]

    @property
    def alpha(self) -> float | str | Callable[[int], float]:
        """The learning rate; may be set again at any time."""
        return self._alpha

    @alpha.setter
    def alpha(self, value: float | str | Callable[[int], float]) -> None:
        if isinstance(value, str) and value != "1/visits":
            raise ValueError(f"alpha must be a number, '1/visits' or a callable, got {value!r}")
        self._rate: float | None  # what the kernel is given; None: to be asked for at each visit
        if callable(value):
            self._rate = None
        elif isinstance(value, str):
            self._rate = ONE_OVER_VISITS
        else:
            self._rate = value = number("alpha", value, 0, 1)
        self._alpha = value
        self._known_rates = np.empty(0)

    @property
    def gamma(self) -> float:
        """The discount rate per step."""
        return self._gamma

    @gamma.setter
    def gamma(self, value: float) -> None:
        self._gamma = number("gamma", value, 0, 1)

    def update(
        self,
        s: int,
        a: int,
        r: float,
        s_next: int,
        terminated: bool = False,
        n_steps: int = 1,
    ) -> float:
        """Learn from one experience (equation 2.12), and return by how much Q(s, a) changed.

        Parameters
        ----------
        s, a, s_next : int
            The state, the action taken in it, and the state it led to.
        r : float
            The reward. For an action held for k steps, their rewards discounted to the first:
            r_1 + gamma r_2 + ... + gamma^(k-1) r_k.
        terminated : bool, default False
            Whether the episode ended in `s_next`, beyond which nothing is earned. An episode that
            was only cut short (truncated) has not ended.
        n_steps : int, default 1
            How many steps k the action was held ("while current state remains same", figure 4.3):
            what follows is then discounted by gamma^k, since the process is semi-Markov.

        Returns
        -------
        float
            The new Q(s, a) less the old. Thesis 4.3 watches it to see when learning has converged.

        Raises
        ------
        ValueError
            If an index is not an integer inside the table, `n_steps` is below 1, `r` is not
            finite, or the new value would be too large for a float. Nothing is learned then.

        Examples
        --------
        >>> learner = QLearner(2, 1, alpha=1.0, gamma=0.5, initial=8.0)
        >>> learner.update(0, 0, 0.0, 1, n_steps=3)  # 0.5**3 * 8
        -7.0
        """
        alpha = self._rate
        if alpha is None:
            pair = integer("s", s, 0, len(self.Q) - 1), integer("a", a, 0, len(self.Q[0]) - 1)
            alpha = self._schedule(int(self.visits[pair]) + 1)
        try:
            discount = self._gamma
            if n_steps != 1:
                discount = discount**n_steps if (n_steps | 0) > 0 else math.nan
            if terminated:
                discount = 0.0
            # Refuses what is no integer, which the kernel would round.
            s | a | s_next
            change = _BACKUP.call(self._pairs, s, a, r, s_next, discount, alpha)
            if change == change:
                return change
        except (TypeError, OverflowError):
            pass
        raise self._complaint(s, a, r, s_next, n_steps)

    def replay(
        self,
        s: ArrayLike,
        a: ArrayLike,
        r: ArrayLike,
        s_next: ArrayLike,
        terminated: ArrayLike,
        n_steps: ArrayLike = 1,
    ) -> NDArray[np.float64]:
        """Learn from N recorded experiences in their order, all in one compiled loop.

        Parameters
        ----------
        s, a, r, s_next, terminated, n_steps : array_like, shape (N,)
            As in `update`; each may be one value for all.

        Returns
        -------
        changes : ndarray, shape (N,)
            What `update` would have returned for each: the table is the same to the last bit.

        Raises
        ------
        ValueError
            As `update` does, naming the place. Nothing is learned from a recording with an
            argument out of range; one that overflows is learned up to that place.

        Examples
        --------
        >>> learner = QLearner(3, 1, alpha=1.0, gamma=0.9)
        >>> learner.replay([1, 0], 0, [100.0, 0.0], [2, 1], [True, False])
        array([100.,  90.])
        """
        n_states, n_actions = self._pairs.shape
        columns = [
            indices("s", s, 0, n_states - 1),
            indices("a", a, 0, n_actions - 1),
            array("r", r, (None,) * np.ndim(r)),
            indices("s_next", s_next, 0, n_states - 1),
            np.asarray(terminated, dtype=bool),
            indices("n_steps", n_steps, 1, None),
        ]
        try:
            together = np.broadcast_arrays(*np.atleast_1d(*columns))
        except ValueError:
            lengths = ", ".join(str(c.shape) for c in columns)
            raise ValueError(f"the columns must have one length, got shapes {lengths}") from None
        if together[0].ndim != 1:
            raise ValueError(f"the columns must have shape (N,), got {together[0].shape}")
        s, a, *rest = (np.ascontiguousarray(c) for c in together)
        changes = np.empty(len(s))
        rates = self._rates(int(self.visits.max()) + len(s))
        bad = replay(self._pairs, s, a, *rest, rates, self._gamma, changes)
        if bad >= 0:
            raise ValueError(f"r must leave Q finite, got {rest[0][bad]} at ({bad},)")
        return changes

    def probabilities(self, s: int, temperature: float) -> NDArray[np.float64]:
        """Return the Boltzmann probabilities of the actions in `s` (equation 3.2).

        Parameters
        ----------
        s : int
            The state.
        temperature : float
            T > 0, in the unit of the rewards. It is no probability (thesis, chapter 3): as it
            falls to 0 the best actions share everything; toward infinity all are alike.

        Returns
        -------
        ndarray, shape (n_actions,)
            Positive or 0, and sum to 1, whatever the size of Q.

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
        return softmax(self.Q[integer("s", s, 0, len(self.Q) - 1)], temperature)

    def boltzmann(self, s: int, temperature: float) -> int:
        """Draw an action with the `probabilities` of `s` at this temperature.

        Parameters
        ----------
        s : int
            The state.
        temperature : float
            T > 0.

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
        >>> learner.Q[0] = [0.0, 1e300]
        >>> learner.boltzmann(0, temperature=1e-300)
        1
        """
        try:
            a = _BOLTZMANN.call(self._pairs, s | 0, temperature, self.rng.random())
            if a >= 0:
                return a
        except (TypeError, OverflowError):
            pass
        number("temperature", temperature, 0, open_low=True)
        raise self._bad_row(s)

    def greedy(self, s: int) -> int:
        """Draw one of the best actions of `s`; n of them have probability 1/n each (equation 3.3).

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
        try:
            a = _GREEDY.call(self._pairs, s | 0, self.rng.random())
            if a >= 0:
                return a
        except (TypeError, OverflowError):
            pass
        raise self._bad_row(s)

    def unvisited(self, s: int) -> NDArray[np.intp]:
        """Return the actions that have had no backup in `s`, in increasing order.

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
        row = self.visits[integer("s", s, 0, len(self.Q) - 1)]
        return (row == 0).nonzero()[0]

    def state(self) -> dict[str, Any]:
        """Return what has been learned, as data: the same run can be continued from it.

        Returns
        -------
        dict
            ``Q`` and ``visits``, copied arrays of shape (n_states, n_actions), and ``rng``, the
            state of the generator (of ``numpy.random.default_rng``: plain numbers and strings,
            which JSON can hold).

        Examples
        --------
        >>> learner = QLearner(2, 2, alpha=0.5, gamma=0.9, rng=1)
        >>> before = learner.state()
        >>> draws = [learner.greedy(0) for _ in range(20)]
        >>> learner.restore(before)
        >>> draws == [learner.greedy(0) for _ in range(20)]
        True
        """
        return {
            "Q": self.Q.copy(),
            "visits": self.visits.copy(),
            "rng": self.rng.bit_generator.state,
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Take over what `state` returned, here or in another process.

        Parameters
        ----------
        state : dict
            With ``Q``, ``visits`` and ``rng``.

        Raises
        ------
        ValueError
            If an entry is missing, has another shape than this table, holds no finite values or
            negative counts, or belongs to another kind of generator.
        """
        missing = {"Q", "visits", "rng"} - set(state)
        if missing:
            raise ValueError(f"state must hold Q, visits and rng, got no {sorted(missing)[0]}")
        Q = array("Q", state["Q"], self._pairs.shape)
        visits = indices("visits", state["visits"], 0, None)
        if visits.shape != Q.shape:
            raise ValueError(f"visits must have shape {Q.shape}, got {visits.shape}")
        try:
            self.rng.bit_generator.state = state["rng"]
        except (TypeError, ValueError, KeyError):
            kind = type(self.rng.bit_generator).__name__
            raise ValueError(f"rng must be the state of a {kind} generator") from None
        self._pairs["Q"] = Q
        self._pairs["visits"] = visits

    def _schedule(self, n: int) -> float:
        return number(f"alpha({n})", self._alpha(n), 0, 1)  # type: ignore[operator]

    def _rates(self, n_visits: int) -> NDArray[np.float64]:
        """Return the learning rates of visits 1, 2, ..., `n_visits`, or one that holds for all."""
        if self._rate is not None:
            return np.array([self._rate])
        missing = range(len(self._known_rates) + 1, n_visits + 1)
        rates = np.fromiter(map(self._alpha, missing), np.float64)  # type: ignore[arg-type]
        for n in np.flatnonzero(~((rates >= 0) & (rates <= 1))):
            self._schedule(missing[n])
        self._known_rates = np.append(self._known_rates, rates)
        return self._known_rates

    def _bad_row(self, s: Any) -> ValueError:
        """Say why no action of `s` could be drawn, off the fast path."""
        try:
            row = self.Q[integer("s", s, 0, len(self.Q) - 1)]
        except ValueError as error:
            return error
        return ValueError(f"Q must hold finite numbers, got {row} in state {s}")

    def _complaint(self, s: Any, a: Any, r: Any, s_next: Any, n_steps: Any) -> ValueError:
        """Say which argument of an update is wrong, off the fast path."""
        try:
            integer("s", s, 0, self._pairs.shape[0] - 1)
            integer("a", a, 0, self._pairs.shape[1] - 1)
            number("r", r)
            integer("n_steps", n_steps, 1)
            integer("s_next", s_next, 0, self._pairs.shape[0] - 1)
        except ValueError as error:
            return error
        return ValueError(f"r must leave Q({s}, {a}) finite, got {r!r}")
