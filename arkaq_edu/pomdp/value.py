"""A value function over beliefs: the upper surface of a set of vectors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integer, integers, n_axes
from arkaq_edu.pomdp.graph import PolicyGraph
from arkaq_edu.pomdp.trees import PolicyTree


@dataclass(frozen=True, eq=False)
class ValueFunction:
    """V(b) = max_k b . alpha_k: what the best of K plans earns from a belief (equation 2.23).

    Attributes
    ----------
    alphas : ndarray, shape (K, S)
        What each plan earns from each state.
    actions : ndarray of int, shape (K,)
        The first action of each plan.
    branches : ndarray of int, shape (K, Z)
        The plan that follows each observation: a row of `shorter`, or, if that is None, a row of
        this same value function (a policy graph). Shape (K, 0) for plans of one step, and if no
        policy graph is known.
    shorter : ValueFunction or None
        The value function with one step fewer to go.
    error : float
        A certified bound on the distance from the optimal value, over all beliefs.
    horizon : int or None
        The number of steps to go; None if the future has no end.

    Raises
    ------
    ValueError
        If there is no plan, `alphas`, `actions` and `branches` differ in length, a number is not
        finite, or a branch leads to no plan.

    Notes
    -----
    V is piecewise linear and convex in the belief. The thesis (2.3.4) says this of the optimal
    policy, but it is the value function that has this shape; a policy chooses among the pieces.
    Equations 2.20, 2.22 and 2.23 write V(s); the argument is the belief, V(b).

    References
    ----------
    Thesis 2.3.4 (equations 2.20-2.23; figures 2.10-2.12). E. Sondik, "The optimal control of
    partially observable Markov processes over the infinite horizon: discounted costs", Operations
    Research 26, 1978.

    Examples
    --------
    Figure 2.16: a1 earns 1 in s1, a2 earns 1.5 in s2.

    >>> V = ValueFunction(np.array([[1, 0], [0, 1.5]]), np.array([0, 1]), np.empty((2, 0), int))
    >>> V.value([0.25, 0.75]), V.action([0.25, 0.75])
    (1.125, 1)
    >>> V.value([[1, 0], [0.6, 0.4], [0, 1]])
    array([1. , 0.6, 1.5])
    """

    alphas: NDArray[np.floating]
    actions: NDArray[np.intp]
    branches: NDArray[np.intp]
    shorter: ValueFunction | None = None
    error: float = 0.0
    horizon: int | None = None

    def __post_init__(self) -> None:
        alphas = array("alphas", self.alphas, (None, None))
        if not alphas.size:
            raise ValueError(f"alphas must hold at least one vector, got {alphas.shape}")
        n, after = len(alphas), len(alphas if self.shorter is None else self.shorter.alphas)
        actions = integers("actions", self.actions)
        branches = integers("branches", self.branches, 0, after - 1)
        for name, x, wanted in (("actions", actions, 1), ("branches", branches, 2)):
            if x.ndim != wanted or len(x) != n:
                asked = f"({n},)" if wanted == 1 else f"({n}, any)"
                raise ValueError(f"{name} must have shape {asked}, got {x.shape}")
        # The class is frozen, but what it keeps are the converted values.
        vars(self).update(alphas=alphas, actions=actions, branches=branches)

    def __len__(self) -> int:
        return len(self.alphas)

    def __repr__(self) -> str:
        n, n_states = self.alphas.shape
        return f"ValueFunction({n} vector{'' if n == 1 else 's'} over {n_states} states)"

    def best(self, b: ArrayLike) -> Any:
        """Return which plan is best from a belief; of equally good plans the first.

        Parameters
        ----------
        b : array_like, shape (S,) or (N, S)
            A belief, or many.

        Returns
        -------
        int, or ndarray of int of shape (N,)

        Raises
        ------
        ValueError
            If `b` is not a distribution over the states.
        """
        k = (self._beliefs(b) @ self.alphas.T).argmax(axis=-1)
        return k if k.ndim else int(k)

    def value(self, b: ArrayLike) -> Any:
        """Return V(b), equation 2.23.

        Parameters
        ----------
        b : array_like, shape (S,) or (N, S)
            A belief, or many.

        Returns
        -------
        float, or ndarray of shape (N,)

        Raises
        ------
        ValueError
            If `b` is not a distribution over the states.
        """
        values = (self._beliefs(b) @ self.alphas.T).max(axis=-1)
        return values if values.ndim else float(values)

    def action(self, b: ArrayLike) -> Any:
        """Return the first action of the best plan.

        Parameters
        ----------
        b : array_like, shape (S,) or (N, S)
            A belief, or many.

        Returns
        -------
        int, or ndarray of int of shape (N,)

        Raises
        ------
        ValueError
            If `b` is not a distribution over the states.
        """
        a = self.actions[self.best(b)]
        return a if np.ndim(a) else int(a)

    @property
    def graph(self) -> PolicyGraph | None:
        """The policy graph, or None if no graph is known."""
        if self.shorter is not None or not self.branches.shape[1]:
            return None
        return PolicyGraph(self.actions, self.branches)

    def tree(self, k: int) -> PolicyTree:
        """Return plan k of a finite horizon as a tree.

        Parameters
        ----------
        k : int
            The row of `alphas`.

        Returns
        -------
        PolicyTree

        Raises
        ------
        ValueError
            If there is no such plan, or the horizon is not finite.
        """
        k = integer("k", k, 0, len(self) - 1)
        if self.horizon is None:
            raise ValueError("k must be a plan with an end, but these plans go on for ever")
        stages = [self]
        while stages[-1].shorter is not None:
            stages.append(stages[-1].shorter)
        # From the last step to the first. Plans share their branches, so trees share theirs.
        trees = [PolicyTree(int(a)) for a in stages.pop().actions]
        for V in reversed(stages):
            trees = [
                PolicyTree(int(a), tuple(trees[j] for j in row))
                for a, row in zip(V.actions, V.branches, strict=True)
            ]
        return trees[k]

    def _beliefs(self, b: ArrayLike) -> NDArray[np.float64]:
        n_states = self.alphas.shape[1]
        many = n_axes("b", b) == 2
        return distribution("b", b, (None, n_states) if many else (n_states,))
