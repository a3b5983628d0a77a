"""A Markov decision process: a world that answers each action with a state and a reward."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from arkaq_edu._checks import (
    array,
    distribution,
    generator,
    integers,
    number,
    shown,
    transitions,
)
from arkaq_edu._frozen import Frozen, frozen
from arkaq_edu.mdp import compiled

#: `MDP.from_gymnasium` makes a sparse model where a dense table would take more bytes than this.
MOST_DENSE_BYTES = 2**26


class MDP(Frozen):
    """A Markov decision process <S, A, T, R> with its discount rate.

    Parameters
    ----------
    T : array_like, shape (A, S, S), or list of A sparse matrices, shape (S, S)
        ``T[a, s, t]``, or ``T[a][s, t]``, is the probability that action `a` leads from state `s`
        to state `t`. From sparse matrices (`scipy.sparse`) no dense table is made.
    R : array_like, shape (S, A) or (A, S, S), or list of A sparse matrices, shape (S, S)
        ``R[s, a]`` is the expected reward for action `a` in state `s`; -inf marks an action that
        the state does not allow. Or ``R[a, s, t]`` is the reward if the action leads to state `t`.
    gamma : float
        The discount rate, in [0, 1]. Without a horizon, 1 is well defined only for policies that
        are sure to reach an end.
    start : array_like, shape (S,), optional
        The probability that an episode starts in each state; without it all are equally likely.

    Attributes
    ----------
    T : ndarray, shape (A, S, S), or tuple of A sparse matrices, shape (S, S)
    R : ndarray, shape (S, A)
        The expected rewards.
    start : ndarray, shape (S,)
    gamma : float
    n_states, n_actions : int
    allowed : ndarray of bool, shape (S, A)
        The actions that each state allows.
    ends : ndarray of bool, shape (S,)
        The states that are never left and earn nothing: there an episode ends.

    Raises
    ------
    ValueError
        If a shape does not fit, a probability is not finite, a row of `T` is not a distribution,
        `gamma` is outside [0, 1], a reward is larger than 1e100 or neither finite nor -inf, or a
        state allows no action.

    Notes
    -----
    All arrays are read-only, and so are those of copies. The rows of `T` must be distributions for
    actions that are not allowed, too; they are never used.

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

    The same from sparse matrices. When it has the ball, it cannot walk.

    >>> T = [sparse.csr_array(walk), sparse.eye_array(3)]
    >>> MDP(T, R=[[0, 0], [80, 0], [-np.inf, 0]], gamma=0.9).ends
    array([False, False,  True])
    """

    def __init__(
        self,
        T: ArrayLike | Sequence[Any],
        R: ArrayLike | Sequence[Any],
        gamma: float,
        start: ArrayLike | None = None,
    ) -> None:
        self.T: Any = transitions("T", T, (None, None, None))
        if not isinstance(self.T, np.ndarray):
            self.T = tuple(self.T)
        shape = (len(self.T), *self.T[0].shape)
        if shape[1] != shape[2]:
            raise ValueError(f"T must have shape (A, S, S), each at least 1, got {shape}")
        self.n_actions, self.n_states = shape[:2]
        # Column by column: the order in which a sweep of value iteration goes through it.
        self.R: NDArray[np.float64] = np.array(self._expected_rewards(R), order="F")
        self.allowed = -np.inf < self.R
        if not self.allowed.any(axis=1).all():
            s = int(self.allowed.any(axis=1).argmin())
            raise ValueError(f"R must allow an action in every state, got only -inf in state {s}")
        self.gamma = number("gamma", gamma, 0, 1)
        if start is None:
            start = np.full(self.n_states, 1 / self.n_states)
        self.start = distribution("start", start, (self.n_states,)).copy()
        stays = np.array([T_a.diagonal() == 1 for T_a in self.T]).T
        self.ends = ((stays & (self.R == 0)) | ~self.allowed).all(axis=1)
        self.freeze()

    def _expected_rewards(self, R: Any) -> NDArray[np.float64]:
        """Return R(s, a), the mean over the next states where R is given as R(a, s, s')."""
        n = self.n_states
        if _are_sparse(R):
            if [np.shape(R_a) for R_a in R] != [(n, n)] * self.n_actions:
                shapes = shown([np.shape(R_a) for R_a in R])
                raise ValueError(
                    f"R must hold {self.n_actions} matrices of {n} x {n}, got {shapes}"
                )
            R = [sparse.csr_array(R_a) for R_a in R]
            for R_a in R:
                array("R", R_a.data, (None,), allow_minus_infinity=True)
        else:
            R = array("R", R, None, allow_minus_infinity=True)
            if R.ndim != 3:
                return array("R", R, (n, self.n_actions), allow_minus_infinity=True)
            R = array("R", R, (self.n_actions, n, n), allow_minus_infinity=True)
        pairs = zip(self.T, R, strict=True)
        # Only where T is not 0, so that an impossible step may have any reward.
        means = [sparse.csr_array(T_a).multiply(R_a).sum(axis=1) for T_a, R_a in pairs]
        return np.stack(means, axis=1)

    @cached_property
    def stacked(self) -> Any:
        """`T` as one matrix, dense or sparse, shape (A S, S): row a S + s is T(s, a, .)."""
        if isinstance(self.T, tuple):
            return frozen(sparse.vstack(self.T, format="csr"))
        return self.T.reshape(-1, self.n_states)

    @cached_property
    def outcomes(self) -> tuple[NDArray[Any], ...]:
        """What `compiled.draw` reads: the running sums of the rows of `stacked`, and their places.

        These are the sums, the states that they belong to, and where each row begins.
        """
        rows = self.stacked
        if sparse.issparse(rows):
            chances, states, first = rows.data, rows.indices, rows.indptr
        else:
            chances, states = rows.ravel(), np.empty(0, np.int32)
            first = np.arange(0, rows.size + 1, self.n_states)
        return tuple(map(frozen, (compiled.running_sums(chances, first), states, first)))

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
        return self.R + self.gamma * self.expected(array("V", V, (self.n_states,)))

    def expected(self, V: NDArray[np.floating]) -> NDArray[np.float64]:
        """Return sum_t T(s, a, t) V(t), the mean of `V` over the next states.

        Parameters
        ----------
        V : ndarray, shape (S,)
            The value of each state.

        Returns
        -------
        ndarray, shape (S, A)

        Examples
        --------
        >>> MDP(T=[[[0.5, 0.5], [0, 1]]], R=[[1], [0]], gamma=0.5).expected(np.array([4.0, 8.0]))
        array([[6.],
               [8.]])
        """
        return (self.stacked @ V).reshape(self.n_actions, self.n_states).T

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
            If a state or an action does not exist, a state does not allow its action, or the
            shapes of `s` and `a` differ.

        Examples
        --------
        >>> mdp = MDP(T=[[[0, 1], [0, 1]]], R=[[5], [0]], gamma=0.5)
        >>> s_next, r, terminated = mdp.step([0, 1], 0, rng=0)
        >>> s_next, r, terminated
        (array([1, 1]), array([5., 0.]), array([ True,  True]))
        """
        s = integers("s", s, 0, self.n_states - 1)
        a = integers("a", a, 0, self.n_actions - 1)
        try:
            row = np.asarray(a * self.n_states + s)
        except ValueError:
            raise ValueError(f"s and a must have one shape, got {s.shape} and {a.shape}") from None
        r = self.R.T.ravel()[row]
        if (r == -np.inf).any():
            wrong, state = divmod(int(row.flat[(r == -np.inf).argmax()]), self.n_states)
            raise ValueError(f"a must be an action that its state allows, got {wrong} in {state}")
        u = generator("rng", rng).random(row.shape)
        drawn = compiled.draws(*self.outcomes, row.ravel(), np.ravel(u))
        s_next = drawn.reshape(row.shape)[()]
        return s_next, r, self.ends[s_next]

    @classmethod
    def from_gymnasium(cls, env: Any, gamma: float = 0.99) -> MDP:
        """Read the model of a tabular Gymnasium environment: FrozenLake, CliffWalking, Taxi.

        Parameters
        ----------
        env : str or gymnasium.Env
            The environment or its name. It must have the transition table ``P``, where
            ``P[s][a]`` lists (probability, next state, reward, terminated).
        gamma : float, default 0.99
            The discount rate, in [0, 1].

        Returns
        -------
        MDP
            It has one more state than the environment: the last one, where every episode that
            terminates ends. A time limit is not part of the model. A large model is sparse.

        Raises
        ------
        ValueError
            If there is no such environment, or it has no transition table.

        Examples
        --------
        >>> MDP.from_gymnasium("FrozenLake-v1")
        MDP(17 states, 4 actions, gamma=0.99)
        """
        if isinstance(env, str):
            import gymnasium

            try:
                env = gymnasium.make(env)
            except gymnasium.error.Error as error:
                raise ValueError(
                    f"env must name an environment, got {shown(env)}: {error}"
                ) from None
        env = getattr(env, "unwrapped", env)
        if not hasattr(env, "P"):
            raise ValueError(f"env must have a transition table P, got {env!r}")
        n, n_actions = len(env.P), len(env.P[0])
        R = np.zeros((n + 1, n_actions))
        entries = [(1.0, a * (n + 1) + n, n) for a in range(n_actions)]
        for s in range(n):
            for a in range(n_actions):
                for p, s_next, r, terminated in env.P[s][a]:
                    entries.append((p, a * (n + 1) + s, n if terminated else s_next))
                    R[s, a] += p * r
        chances, row, column = zip(*entries, strict=True)
        stacked = sparse.csr_array((chances, (row, column)), shape=(n_actions * (n + 1), n + 1))
        T = [stacked[k : k + n + 1] for k in range(0, stacked.shape[0], n + 1)]
        if 8 * n_actions * (n + 1) ** 2 <= MOST_DENSE_BYTES:
            T = [T_a.toarray() for T_a in T]
        start = np.append(getattr(env, "initial_state_distrib", np.full(n, 1 / n)), 0.0)
        return cls(T, R, gamma, start)


def _are_sparse(matrices: Any) -> bool:
    """Return whether this is a list of sparse matrices; dense ones may be among them."""
    return isinstance(matrices, (list, tuple)) and any(map(sparse.issparse, matrices))


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
