"""Policy trees: an action now, and for each observation another tree (equations 2.18 to 2.22)."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import integer
from arkaq_edu.pomdp.model import POMDP


@dataclass(frozen=True)
class PolicyTree:
    """A plan for some steps: an action, and for each observation a plan for the remaining steps.

    Parameters
    ----------
    action : int
        The action at the root.
    branches : tuple of PolicyTree, default ()
        The plan that follows each observation, all of the same depth; empty if this is the last
        step.

    Raises
    ------
    ValueError
        If `action` is not an integer >= 0, or the branches are not trees of the same depth.

    References
    ----------
    Thesis 2.3.4, figure 2.9.

    Examples
    --------
    Listen twice for a tiger. If it was heard behind the same door both times, open the other one.

    >>> listen, left, right = map(PolicyTree, range(3))
    >>> plan = PolicyTree(0, (PolicyTree(0, (right, listen)), PolicyTree(0, (listen, left))))
    >>> plan.depth
    3
    >>> print(PolicyTree(0, (right, left)))
    0
      0: 2
      1: 1
    """

    action: int
    branches: tuple[PolicyTree, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "action", integer("action", self.action))
        object.__setattr__(self, "branches", tuple(self.branches))
        if not all(isinstance(branch, PolicyTree) for branch in self.branches):
            raise ValueError(f"branches must be policy trees, got {self.branches!r}")
        depths = {branch.depth for branch in self.branches}
        if len(depths) > 1:
            raise ValueError(f"branches must all have the same depth, got {sorted(depths)}")

    @property
    def depth(self) -> int:
        """The number of steps in the plan."""
        tree, depth = self, 1
        while tree.branches:
            tree, depth = tree.branches[0], depth + 1
        return depth

    def nodes(self, steps: int) -> dict[tuple[int, ...], int]:
        """Return the action of each node of the first steps, by the observations that lead there.

        Parameters
        ----------
        steps : int
            The number of steps, at least 1.

        Returns
        -------
        dict of tuple of int to int
            The root, (), comes first; each node comes before the nodes below it.

        Examples
        --------
        >>> PolicyTree(0, (PolicyTree(2), PolicyTree(1))).nodes(2)
        {(): 0, (0,): 2, (1,): 1}
        """
        found: dict[tuple[int, ...], int] = {(): self.action}
        for z, branch in enumerate(self.branches if steps > 1 else ()):
            found |= {(z, *seen): action for seen, action in branch.nodes(steps - 1).items()}
        return found

    def text(self, pomdp: POMDP | None = None) -> str:
        """Return the tree as text: an action, and below it a line for each observation.

        Parameters
        ----------
        pomdp : POMDP, optional
            The model whose names to use. By default actions and observations are numbers.

        Returns
        -------
        str

        Examples
        --------
        >>> pomdp = POMDP([np.eye(2)] * 2, np.full((2, 2, 2), 0.5), np.eye(2), 0.9,
        ...               actions=["look", "kick"], observations=["ball left", "ball right"])
        >>> print(PolicyTree(0, (PolicyTree(1), PolicyTree(0))).text(pomdp))
        look
          ball left: kick
          ball right: look
        """
        return "\n".join(self._lines(pomdp))

    def __str__(self) -> str:
        return self.text()

    def _lines(self, pomdp: POMDP | None) -> list[str]:
        lines = [pomdp.actions[self.action] if pomdp else str(self.action)]
        for z, branch in enumerate(self.branches):
            first, *rest = branch._lines(pomdp)
            lines.append(f"  {pomdp.observations[z] if pomdp else z}: {first}")
            lines += ["  " + line for line in rest]
        return lines


def tree_value(pomdp: POMDP, tree: PolicyTree) -> NDArray[np.float64]:
    """Return the vector alpha_p of a policy tree p: what it earns from each state (equation 2.21).

    Parameters
    ----------
    pomdp : POMDP
        The model.
    tree : PolicyTree
        The plan.

    Returns
    -------
    ndarray, shape (S,)
        V_p(s) = R(s, a) + gamma sum_s' T(s, a, s') sum_o O(s', a, o) V_{o(p)}(s'), where a is the
        action at the root and o(p) the tree that follows observation o. Without branches it is
        only the reward.

    Raises
    ------
    ValueError
        If the tree has an action that does not exist, or branches for another number of
        observations.

    Notes
    -----
    From a belief b the tree earns b . alpha_p, equations 2.20 and 2.22. The thesis writes V_p(s)
    there, but this is a function of the belief, V_p(b). Likewise 2.23 is V_t(b), the value of the
    best tree for b.

    References
    ----------
    Thesis 2.3.4 (equations 2.18-2.22).

    Examples
    --------
    The ball is left or right and stays there. A look errs in one of ten cases. A kick to the right
    side earns 1.

    >>> pomdp = POMDP(T=[np.eye(2)] * 3, O=[[[0.9, 0.1], [0.1, 0.9]]] * 3,
    ...               R=[[0, 1, 0], [0, 0, 1]], gamma=0.5)
    >>> tree_value(pomdp, PolicyTree(1))
    array([1., 0.])
    >>> tree_value(pomdp, PolicyTree(0, (PolicyTree(1), PolicyTree(2))))
    array([0.45, 0.45])
    """
    R, T, O, gamma = pomdp.R, pomdp.T, pomdp.O, pomdp.gamma  # noqa: E741
    a = integer("action", tree.action, 0, pomdp.n_actions - 1)
    if not tree.branches:
        return R[:, a].copy()  # equation 2.18
    if len(tree.branches) != pomdp.n_observations:
        raise ValueError(
            f"branches must be one for each of the {pomdp.n_observations} observations, "
            f"got {len(tree.branches)}"
        )
    V = np.column_stack([tree_value(pomdp, branch) for branch in tree.branches])  # V[s', o]
    return R[:, a] + gamma * T[a] @ (O[a] * V).sum(axis=1)  # equation 2.19


def all_trees(pomdp: POMDP, depth: int) -> Iterator[PolicyTree]:
    """Yield every policy tree of a depth.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    depth : int
        The number of steps, at least 1.

    Yields
    ------
    PolicyTree
        There are A to the power (Z^depth - 1) / (Z - 1) of them. For two actions and two
        observations that is 2, 8, 128, 32768, and then two billion.

    Raises
    ------
    ValueError
        If `depth` is not an integer >= 1.

    References
    ----------
    Thesis 2.3.4: P in equation 2.23.

    Examples
    --------
    >>> pomdp = POMDP([np.eye(2)] * 2, np.full((2, 2, 2), 0.5), np.eye(2), 0.9)
    >>> [sum(1 for tree in all_trees(pomdp, depth)) for depth in (1, 2, 3)]
    [2, 8, 128]
    """
    depth = integer("depth", depth, 1)
    return _trees(pomdp.n_actions, pomdp.n_observations, depth)


def _trees(n_actions: int, n_observations: int, depth: int) -> Iterator[PolicyTree]:
    if depth == 1:
        yield from map(PolicyTree, range(n_actions))
        return
    shorter = list(_trees(n_actions, n_observations, depth - 1))
    for action in range(n_actions):
        for branches in itertools.product(shorter, repeat=n_observations):
            yield PolicyTree(action, branches)
