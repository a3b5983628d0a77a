"""Policy graphs: plans without an end, in which every observation leads to another plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import affordable, integers
from arkaq_edu._compiled import kernel
from arkaq_edu.pomdp.model import POMDP

# Up to this many unknowns the equations of a graph are solved as a linear system. Larger systems
# are slow, and repeating the equations is faster.
LARGE = 1000


@kernel
def follow(steps, rewards, actions, branches, enough, most, values):
    """Repeat the equations of a policy graph until no value changes by more than `enough`.

    `steps` and `rewards` come from `steps_and_rewards`; `values`, of shape (K, S), is overwritten.
    At most `most` rounds are made.
    """
    N, S = values.shape
    for _ in range(most):
        change = 0.0
        for n in range(N):
            a = actions[n]
            for s in range(S):
                total = rewards[a, s]  # equation 2.19
                for z in range(branches.shape[1]):
                    rest = branches[n, z]
                    for t in range(S):
                        if steps[a, z, s, t] != 0.0:  # in most models most of them are 0
                            total += steps[a, z, s, t] * values[rest, t]
                change = max(change, abs(total - values[n, s]))
                values[n, s] = total
        if change <= enough:
            break


def steps_and_rewards(pomdp: POMDP) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Return gamma T(s, a, t) O(t, a, z) at [a, z, s, t], and R(s, a) at [a, s]."""
    A, S, Z = pomdp.n_actions, pomdp.n_states, pomdp.n_observations
    affordable("the steps of pomdp", (A, Z, S, S))
    pomdp = pomdp.dense()
    seen = pomdp.O.transpose(0, 2, 1)[:, :, np.newaxis]
    return pomdp.gamma * pomdp.T[:, np.newaxis] * seen, np.ascontiguousarray(pomdp.R.T)


def settle(pomdp: POMDP, graph: PolicyGraph, guess: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return what the nodes of a graph earn, by repeating their equations from a guess."""
    values = guess.copy()
    most = 10 + int(
        40 / -np.log(max(pomdp.gamma, 1e-9))
    )  # gamma^most is below e^-40, less than rounding
    enough = 1e-15 * float(np.abs(pomdp.R).max())
    follow(*steps_and_rewards(pomdp), graph.actions, graph.branches, enough, most, values)
    return values


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
    A world pays 1 for every look, and the robot looks for ever:

    >>> graph = PolicyGraph([0], [[0, 0]])
    >>> graph
    PolicyGraph(1 node, 2 observations)
    >>> graph.values(POMDP([np.eye(2)], [[[0.9, 0.1], [0.1, 0.9]]], [[1], [1]], gamma=0.5))
    array([[2., 2.]])
    """

    def __init__(self, actions: ArrayLike, branches: ArrayLike) -> None:
        self.actions = integers("actions", actions, 0, None)
        if self.actions.ndim != 1 or not self.actions.size:
            raise ValueError(f"actions must have shape (K,), got {self.actions.shape}")
        K = len(self.actions)
        self.branches = integers("branches", branches, 0, K - 1)
        if self.branches.ndim != 2 or len(self.branches) != K:
            raise ValueError(f"branches must have shape ({K}, Z), got {self.branches.shape}")

    def __len__(self) -> int:
        return len(self.actions)

    def __repr__(self) -> str:
        K, Z = self.branches.shape
        return (
            f"PolicyGraph({K} node{'' if K == 1 else 's'}, {Z} observation{'' if Z == 1 else 's'})"
        )

    def reached(self, start: int) -> list[int]:
        """Return the nodes that can be reached from a node: itself, then the nearest first.

        Parameters
        ----------
        start : int
            The node.

        Returns
        -------
        list of int

        Examples
        --------
        >>> PolicyGraph([0, 1, 0], [[1, 0], [1, 1], [0, 0]]).reached(0)
        [0, 1]
        """
        nodes = [start]
        for k in nodes:  # the list grows in the loop
            nodes += [j for j in dict.fromkeys(self.branches[k].tolist()) if j not in nodes]
        return nodes

    def values(self, pomdp: POMDP) -> NDArray[np.floating]:
        """Return what each node earns from each state.

        Parameters
        ----------
        pomdp : POMDP
            The model.

        Returns
        -------
        ndarray, shape (K, S)
            The solution of alpha_k(s) = R(s, a) + gamma sum_s' T(s, a, s') sum_z O(s', a, z)
            alpha_k'(s'), where a is the action of node k and k' the node that follows z. This is
            equation 2.19 without an end. For large graphs the equations are repeated until the
            values no longer change.

        Raises
        ------
        ValueError
            If the model lacks actions or observations of the graph, or its discount is 1.
        """
        if pomdp.gamma == 1:
            raise ValueError("pomdp must have a discount below 1, for a graph has no end")
        integers("actions", self.actions, 0, pomdp.n_actions - 1)
        K, Z = self.branches.shape
        if pomdp.n_observations != Z:
            raise ValueError(
                f"branches must have shape ({K}, {pomdp.n_observations}), got {(K, Z)}"
            )
        S = pomdp.n_states
        if K * S > LARGE:
            return settle(pomdp, self, np.zeros((K, S)))
        steps, rewards = steps_and_rewards(pomdp)
        moves = np.zeros((K, S, K, S))
        for z in range(Z):
            moves[np.arange(K), :, self.branches[:, z], :] += steps[self.actions, z]
        system = np.eye(K * S) - moves.reshape(K * S, K * S)
        return np.linalg.solve(system, rewards[self.actions].ravel()).reshape(K, S)
