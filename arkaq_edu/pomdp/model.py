"""A partially observable Markov decision process: an MDP whose state is hidden."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import array, distribution, number
from arkaq_edu.mdp.model import MDP


class POMDP:
    """A POMDP <S, A, T, R, Omega, O> with a discount rate.

    Parameters
    ----------
    T : array_like, shape (A, S, S)
        ``T[a, s, t]`` is the probability that action `a` leads from state `s` to state `t`.
    O : array_like, shape (A, S, Z)
        ``O[a, t, z]`` is the probability of observing `z` when action `a` has led to state `t`.
    R : array_like, shape (S, A)
        ``R[s, a]`` is the reward expected for action `a` in state `s`.
    gamma : float
        The discount rate, in [0, 1).
    start : array_like, shape (S,), optional
        The belief at the start. By default all states are equally likely.
    states, actions, observations : sequence of str, optional
        Their names. By default they are "0", "1", ...

    Attributes
    ----------
    mdp : MDP
        The same world without the observations: its state is seen.
    T, O, R, start : ndarray
        As given, and read-only.
    gamma : float
    n_states, n_actions, n_observations : int
    states, actions, observations : tuple of str

    Raises
    ------
    ValueError
        If a shape does not fit, an entry is not finite, a row of `T` or `O` is not a distribution,
        `gamma` is outside [0, 1), the number of names is wrong, or two names are equal.

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
        self.mdp = MDP(T, R, gamma, start)
        self.T, self.R, self.start = self.mdp.T, self.mdp.R, self.mdp.start
        self.gamma = number("gamma", gamma, 0, 1, open_high=True)
        self.n_states, self.n_actions = self.mdp.n_states, self.mdp.n_actions
        O_of = array("O", O, (self.n_actions, self.n_states, None))
        if not O_of.size:
            raise ValueError(f"O must have shape (A, S, Z), none of them 0, got {O_of.shape}")
        self.O = distribution("O", O_of).copy()
        self.O.setflags(write=False)
        self.n_observations = self.O.shape[2]
        self.states = _names("states", states, self.n_states)
        self.actions = _names("actions", actions, self.n_actions)
        self.observations = _names("observations", observations, self.n_observations)

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
            If a state or an action does not exist.

        Examples
        --------
        >>> pomdp = POMDP(T=[[[0, 1], [1, 0]]], O=[[[1, 0], [0, 1]]], R=[[5], [0]], gamma=0.5)
        >>> s_next, z, r, terminated = pomdp.step([0, 1], 0, rng=0)
        >>> s_next, z, r, terminated
        (array([1, 0]), array([1, 0]), array([5., 0.]), array([False, False]))
        """
        rng = np.random.default_rng(rng)
        s_next, r, terminated = self.mdp.step(s, a, rng)
        sums = self.O[np.asarray(a), s_next].cumsum(axis=-1)
        # The last sum may be a little below 1 by rounding. Scaled by it, no draw falls outside.
        u = rng.random(np.shape(s_next)) * sums[..., -1]
        z = (sums <= u[..., np.newaxis]).sum(axis=-1)
        return s_next, z, r, terminated


def _names(what: str, given: Sequence[str] | None, n: int) -> tuple[str, ...]:
    """Return n different names, by default the numbers from 0."""
    if given is None:
        return tuple(map(str, range(n)))
    names = tuple(given)
    if len(names) != n or not all(isinstance(name, str) and name for name in names):
        raise ValueError(f"{what} must be {n} names, got {given!r}")
    if len(set(names)) < n:
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{what} must be different names, got {twice!r} twice")
    return names
