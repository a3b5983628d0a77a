"""A Markov decision process: a world that answers each action with a state and a reward."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integers, number


class MDP:
    """A Markov decision process <S, A, T, R> with its discount rate.

    Parameters
    ----------
    T : array_like, shape (A, S, S)
        ``T[a, s, t]`` is the probability that action `a` leads from state `s` to state `t`.
    R : array_like, shape (S, A)
        ``R[s, a]`` is the expected reward for action `a` in state `s`.
    gamma : float
        The discount rate, in [0, 1).
    start : array_like, shape (S,), optional
        The probability that an episode starts in each state; without it all are equally likely.

    Attributes
    ----------
    T, R, start : ndarray
        As given, but read-only.
    cumulative : ndarray, shape (A, S, S)
        The cumulative sums of `T` over the next state, from which draws are made.
    gamma : float
    n_states, n_actions : int
    ends : ndarray of bool, shape (S,)
        The states that are never left and earn nothing: there an episode ends.

    Raises
    ------
    ValueError
        If a shape does not fit, an entry is not finite, a row of `T` is not a distribution,
        `gamma` is outside [0, 1), or a reward is larger than 1e100.

    References
    ----------
    Thesis 2.2 (equations 2.4-2.6; figures 2.3 and 2.4).

    Examples
    --------
    A robot is far from the ball (0), near it (1), or has it (2, the end). Walking takes it one
    state further with probability 0.8. Or it waits.

    >>> walk = [[0.2, 0.8, 0.0], [0.0, 0.2, 0.8], [0.0, 0.0, 1.0]]
    >>> wait = np.eye(3)
    >>> mdp = MDP(T=[walk, wait], R=[[0, 0], [80, 0], [0, 0]], gamma=0.9)
    >>> mdp
    MDP(3 states, 2 actions, gamma=0.9)
    >>> mdp.ends
    array([False, False,  True])
    """

    def __init__(
        self, T: ArrayLike, R: ArrayLike, gamma: float, start: ArrayLike | None = None
    ) -> None:
        self.T = distribution("T", array("T", T, (None, None, None))).copy()
        self.n_actions, self.n_states, n_next = self.T.shape
        if n_next != self.n_states or not self.T.size:
            raise ValueError(f"T must have shape (A, S, S), each at least 1, got {self.T.shape}")
        self.R = array("R", R, (self.n_states, self.n_actions)).copy()
        self.gamma = number("gamma", gamma, 0, 1, open_high=True)
        if start is None:
            start = np.full(self.n_states, 1 / self.n_states)
        self.start = distribution("start", array("start", start, (self.n_states,))).copy()
        stays = (self.T[:, range(self.n_states), range(self.n_states)] == 1).all(axis=0)
        self.ends = stays & (self.R == 0).all(axis=1)
        # Divided by the last entry, so that a draw below 1 always finds a state that can follow.
        sums = self.T.cumsum(axis=2)
        self.cumulative = sums / sums[:, :, -1:]
        for fixed in (self.T, self.R, self.start, self.ends, self.cumulative):
            fixed.setflags(write=False)

    def __repr__(self) -> str:
        return f"MDP({self.n_states} states, {self.n_actions} actions, gamma={self.gamma:g})"

    def action_values(self, V: ArrayLike) -> NDArray[np.float64]:
        """Return R(s, a) + gamma sum_t T(s, a, t) V(t), which equation 2.8 maximizes over a.

        Parameters
        ----------
        V : array_like, shape (S,)
            The value of each state one step later.

        Returns
        -------
        ndarray, shape (S, A)

        Raises
        ------
        ValueError
            If `V` has another shape or holds a number that is not finite.

        Notes
        -----
        This takes O(A S^2) operations: one sweep of value iteration. A step of Q-learning takes
        only O(A), for the maximum in equation 2.12. (The thesis, chapter 6, gives it the former.)

        Examples
        --------
        >>> mdp = MDP(T=[[[0.5, 0.5], [0, 1]]], R=[[1], [0]], gamma=0.5)
        >>> mdp.action_values([4, 8])
        array([[4.],
               [4.]])
        """
        return self.R + self.gamma * (self.T @ array("V", V, (self.n_states,))).T

    def step(
        self, s: ArrayLike, a: ArrayLike, rng: np.random.Generator | int
    ) -> tuple[Any, Any, Any]:
        """Take action `a` in state `s`, once or for many walkers at the same time.

        Parameters
        ----------
        s, a : int or array_like of int, shape (N,)
            The states and the actions.
        rng : numpy.random.Generator or int
            The random numbers: one for each walker.

        Returns
        -------
        s_next : int or ndarray, shape (N,)
            The next states.
        r : float or ndarray, shape (N,)
            The rewards.
        terminated : bool or ndarray, shape (N,)
            Whether `s_next` is an end.

        Raises
        ------
        ValueError
            If a state or an action does not exist.

        Examples
        --------
        >>> mdp = MDP(T=[[[0, 1], [0, 1]]], R=[[5], [0]], gamma=0.5)
        >>> s_next, r, terminated = mdp.step([0, 1], 0, rng=0)
        >>> s_next, r, terminated
        (array([1, 1]), array([5., 0.]), array([ True,  True]))
        """
        s, a = np.broadcast_arrays(
            integers("s", s, 0, self.n_states - 1), integers("a", a, 0, self.n_actions - 1)
        )
        u = np.random.default_rng(rng).random(s.shape)
        s_next = (self.cumulative[a, s] <= np.expand_dims(u, -1)).sum(axis=-1)
        return s_next, self.R[s, a], self.ends[s_next]

    @classmethod
    def from_gymnasium(cls, env: Any, gamma: float = 0.99) -> MDP:
        """Read the model of a tabular Gymnasium environment: FrozenLake, CliffWalking, Taxi.

        Parameters
        ----------
        env : str or gymnasium.Env
            The environment or its name. It must have the transition table ``P``, where
            ``P[s][a]`` lists (probability, next state, reward, terminated).
        gamma : float, default 0.99
            The discount rate, in [0, 1).

        Returns
        -------
        MDP
            It has one more state than the environment: the last one, where every episode that
            terminates ends. A time limit is not part of the model.

        Raises
        ------
        ValueError
            If the environment has no transition table.

        Examples
        --------
        >>> MDP.from_gymnasium("FrozenLake-v1")
        MDP(17 states, 4 actions, gamma=0.99)
        """
        if isinstance(env, str):
            import gymnasium

            env = gymnasium.make(env)
        env = getattr(env, "unwrapped", env)
        if not hasattr(env, "P"):
            raise ValueError(f"env must have a transition table P, got {env!r}")
        n, n_actions = len(env.P), len(env.P[0])
        T = np.zeros((n_actions, n + 1, n + 1))
        R = np.zeros((n + 1, n_actions))
        T[:, n, n] = 1
        for s in range(n):
            for a in range(n_actions):
                for probability, s_next, r, terminated in env.P[s][a]:
                    T[a, s, n if terminated else s_next] += probability
                    R[s, a] += probability * r
        start = np.append(getattr(env, "initial_state_distrib", np.full(n, 1 / n)), 0.0)
        return cls(T, R, gamma, start)


def example_mdp() -> MDP:
    """Return the three states of figure 2.4, with numbers of our own.

    References
    ----------
    Thesis, figure 2.4.

    Examples
    --------
    >>> example_mdp()
    MDP(3 states, 2 actions, gamma=0.9)
    """
    T = [
        [[0.3, 0.7, 0.0], [0.6, 0.0, 0.4], [0.0, 0.2, 0.8]],
        [[0.2, 0.8, 0.0], [0.0, 0.3, 0.7], [0.9, 0.0, 0.1]],
    ]
    return MDP(T, R=[[0, -1], [5, 0], [0, 2]], gamma=0.9)
