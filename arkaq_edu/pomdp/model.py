"""A partially observable Markov decision process: an MDP whose state is hidden."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import affordable, array, generator, shown, transitions
from arkaq_edu._frozen import Frozen
from arkaq_edu.mdp.model import MDP


class POMDP(Frozen):
    """A POMDP <S, A, T, R, Omega, O> with a discount rate.

    Parameters
    ----------
    T : array_like of shape (A, S, S), or list of A scipy.sparse matrices of shape (S, S)
        ``T[a][s, t]`` is the probability that action `a` leads from state `s` to state `t`.
    O : array_like of shape (A, S, Z), or list of A scipy.sparse matrices of shape (S, Z)
        ``O[a][t, z]`` is the probability of observing `z` when action `a` has led to state `t`.
    R : array_like, shape (S, A)
        ``R[s, a]`` is the reward expected for action `a` in state `s`.
    gamma : float
        The discount rate, in [0, 1]. With 1 the values are finite only up to a horizon.
    start : array_like, shape (S,), optional
        The belief at the start. By default all states are equally likely.
    states, actions, observations : sequence of str, optional
        Their names. By default they are "0", "1", ...

    Attributes
    ----------
    mdp : MDP
        The same world without the observations: its state is seen.
    T, O : ndarray, or tuple of scipy.sparse.csr_array
        As given, each row divided by its sum, and read-only.
    R, start : ndarray
        As given, and read-only.
    gamma : float
    n_states, n_actions, n_observations : int
    states, actions, observations : tuple of str

    Raises
    ------
    ValueError
        If a shape does not fit, an entry is not finite, a row of `T` or `O` is not a distribution,
        `gamma` is outside [0, 1], the number of names is wrong, or two names are equal.

    Notes
    -----
    `O` holds distributions over observations, one for each action and each state that it led to.
    The thesis (2.3) calls them distributions over states. It also lists A_t in the history on which
    A_t is chosen; that history ends with the observation O_t.

    References
    ----------
    Thesis 2.3 (figure 2.5). L. Kaelbling, M. Littman, A. Cassandra, "Planning and acting in
    partially observable stochastic domains", Artificial Intelligence 101, 1998.

    Examples
    --------
    The ball is left or right of the robot. A look tells the side, and errs in one of ten cases.

    >>> stay = [[1, 0], [0, 1]]
    >>> pomdp = POMDP(T=[stay], O=[[[0.9, 0.1], [0.1, 0.9]]], R=[[0], [0]], gamma=0.9,
    ...               states=["left", "right"], actions=["look"])
    >>> pomdp
    POMDP(2 states, 1 action, 2 observations, gamma=0.9)
    >>> pomdp.states, pomdp.observations
    (('left', 'right'), ('0', '1'))
    """

    def __init__(
        self,
        T: ArrayLike,
        O: ArrayLike,  # noqa: E741  (the thesis's letter)
        R: ArrayLike,
        gamma: float,
        start: ArrayLike | None = None,
        *,
        states: Sequence[str] | None = None,
        actions: Sequence[str] | None = None,
        observations: Sequence[str] | None = None,
    ) -> None:
        self.mdp = MDP(T, array("R", R, (None, None)), gamma, start)
        self.R, self.start = self.mdp.R, self.mdp.start
        self.T: Any = self.mdp.T  # an array or a tuple: T[a] is the matrix of an action
        self.gamma = self.mdp.gamma
        self.n_states, self.n_actions = self.mdp.n_states, self.mdp.n_actions
        self.O: Any = transitions("O", O, (self.n_actions, self.n_states, None))
        self.n_observations = self.O[0].shape[1]
        self.states = _names("states", states, self.n_states)
        self.actions = _names("actions", actions, self.n_actions)
        self.observations = _names("observations", observations, self.n_observations)
        self.freeze()

    def __repr__(self) -> str:
        counts = [
            f"{n} {word}{'' if n == 1 else 's'}"
            for n, word in (
                (self.n_states, "state"),
                (self.n_actions, "action"),
                (self.n_observations, "observation"),
            )
        ]
        return f"POMDP({', '.join(counts)}, gamma={self.gamma:g})"

    def dense(self) -> POMDP:
        """Return the same model with arrays for T and O, for what needs all their entries.

        Returns
        -------
        POMDP
            The model itself, if its tables are arrays.

        Raises
        ------
        ValueError
            If the tables would not fit into memory.

        Examples
        --------
        >>> from scipy.sparse import eye_array
        >>> pomdp = POMDP([eye_array(2)], [[[1], [1]]], [[0], [0]], gamma=0.9)
        >>> pomdp.dense().T
        array([[[1., 0.],
                [0., 1.]]])
        """
        if isinstance(self.T, np.ndarray) and isinstance(self.O, np.ndarray):
            return self
        A, S, Z = self.n_actions, self.n_states, self.n_observations
        affordable("the dense tables of pomdp", (A, S, S + Z))
        T, O = (  # noqa: E741
            table if isinstance(table, np.ndarray) else [M.toarray() for M in table]
            for table in (self.T, self.O)
        )
        names = {"states": self.states, "actions": self.actions, "observations": self.observations}
        return POMDP(T, O, self.R, self.gamma, self.start, **names)  # type: ignore[arg-type]

    def step(
        self, s: ArrayLike, a: ArrayLike, rng: np.random.Generator | int
    ) -> tuple[Any, Any, Any, Any]:
        """Take action `a` in state `s`, for one agent or for many at once.

        Parameters
        ----------
        s, a : int or array_like of int, shape (N,)
            The states, which are hidden from the agents, and the actions.
        rng : numpy.random.Generator or int
            The source of randomness.

        Returns
        -------
        s_next : int or ndarray, shape (N,)
            The next states.
        z : int or ndarray, shape (N,)
            What is observed there.
        r : float or ndarray, shape (N,)
            The rewards R(s, a).
        terminated : bool or ndarray, shape (N,)
            Whether `s_next` ends the episode: it is never left, and nothing is earned there.

        Raises
        ------
        ValueError
            If a state or an action does not exist, or `rng` is neither a generator nor a seed.

        Examples
        --------
        >>> pomdp = POMDP(T=[[[0, 1], [1, 0]]], O=[[[1, 0], [0, 1]]], R=[[5], [0]], gamma=0.5)
        >>> s_next, z, r, terminated = pomdp.step([0, 1], 0, rng=0)
        >>> s_next, z, r, terminated
        (array([1, 0]), array([1, 0]), array([5., 0.]), array([False, False]))
        """
        rng = generator("rng", rng)
        s_next, r, terminated = self.mdp.step(s, a, rng)
        sums = _rows(self.O, a, s_next).cumsum(axis=-1)
        # The last sum may be a little below 1 by rounding. Scaled by it, no draw falls outside.
        u = rng.random(np.shape(s_next)) * sums[..., -1]
        z = (sums <= u[..., np.newaxis]).sum(axis=-1)
        return s_next, z, r, terminated


def _rows(table: Any, a: ArrayLike, s: Any) -> NDArray[np.float64]:
    """Return table[a, s] for some actions and states, dense."""
    if isinstance(table, np.ndarray):
        return table[np.asarray(a), s]
    a, s = np.broadcast_arrays(a, s)
    rows = [table[i][[j]].toarray()[0] for i, j in zip(a.flat, s.flat, strict=True)]
    return np.reshape(rows, (*s.shape, -1))


def _names(what: str, given: Sequence[str] | None, n: int) -> tuple[str, ...]:
    """Return n different names, by default the numbers from 0."""
    if given is None:
        return tuple(map(str, range(n)))
    names = () if isinstance(given, str) or not np.iterable(given) else tuple(given)
    if len(names) != n or not all(isinstance(name, str) and name for name in names):
        raise ValueError(f"{what} must be {n} names, got {shown(given)}")
    if len(set(names)) < n:
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{what} must be different names, got {twice!r} twice")
    return names
