"""Policy graphs: plans without an end, that go on among themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu.mdp._indices import indices
from arkaq_edu.pomdp.model import POMDP


class PolicyGraph:
    """A finite controller: in each node an action, and for each observation the next node.

    Parameters
    ----------
    actions : array_like of int, shape (K,)
        The action of each node.
    branches : array_like of int, shape (K, Z)
        The node that follows each observation.

    Raises
    ------
    ValueError
        If a shape does not fit, or a node or an action does not exist.

    References
    ----------
    E. Hansen, "Solving POMDPs by searching in policy space", UAI 1998.

    Examples
    --------
    Look for ever at a world that pays 1 for it:

    >>> graph = PolicyGraph([0], [[0, 0]])
    >>> graph
    PolicyGraph(1 node, 2 observations)
    >>> graph.values(POMDP([np.eye(2)], [[[0.9, 0.1], [0.1, 0.9]]], [[1], [1]], gamma=0.5))
    array([[2., 2.]])
    """

    def __init__(self, actions: ArrayLike, branches: ArrayLike) -> None:
        self.actions = indices("actions", actions, 0, None)
        if self.actions.ndim != 1 or not self.actions.size:
            raise ValueError(f"actions must have shape (K,), got {self.actions.shape}")
        K = len(self.actions)
        self.branches = indices("branches", branches, 0, K - 1)
        if self.branches.ndim != 2 or len(self.branches) != K:
            raise ValueError(f"branches must have shape ({K}, Z), got {self.branches.shape}")

    def __len__(self) -> int:
        return len(self.actions)

    def __repr__(self) -> str:
        K, Z = self.branches.shape
        return (
            f"PolicyGraph({K} node{'' if K == 1 else 's'}, {Z} observation{'' if Z == 1 else 's'})"
        )

    def values(self, pomdp: POMDP) -> NDArray[np.floating]:
        """Return what each node earns from each state.

        Parameters
        ----------
        pomdp : POMDP
            The model.

        Returns
        -------
        ndarray, shape (K, S)
            The solution of alpha_k(s) = R(s, a) + gamma sum_t T(s, a, t) sum_z O(t, a, z)
            alpha_k'(t), where a is the action of node k and k' the node that follows z: equation
            2.19 without an end.

        Raises
        ------
        ValueError
            If the graph has actions or observations that the model has not.
        """
        indices("actions", self.actions, 0, pomdp.n_actions - 1)
        K, Z = self.branches.shape
        if pomdp.n_observations != Z:
            raise ValueError(
                f"branches must have shape ({K}, {pomdp.n_observations}), got {(K, Z)}"
            )
        S = pomdp.n_states
        moves = np.zeros((K, S, K, S))
        for z in range(Z):
            step = pomdp.T[self.actions] * pomdp.O[self.actions, np.newaxis, :, z]
            moves[np.arange(K), :, self.branches[:, z], :] += step
        rewards = pomdp.R[:, self.actions].T.ravel()
        system = np.eye(K * S) - pomdp.gamma * moves.reshape(K * S, K * S)
        return np.linalg.solve(system, rewards).reshape(K, S)
