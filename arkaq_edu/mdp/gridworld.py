"""A small floor, seen from above: walls, a ball, holes, and feet that slip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import number
from arkaq_edu.mdp.model import MDP

#: The four actions of a grid world: where each leads, as (columns to the right, rows up).
MOVES = {"right": (1, 0), "up": (0, 1), "left": (-1, 0), "down": (0, -1)}

#: What entering a square earns: the ball, a hole, the free floor.
GAINS = {"o": 100.0, "x": -100.0, ".": 0.0}
WALL = "#"

#: The course's floor: the short way to the ball is a bridge between holes.
FLOOR = (
    "........",
    ".#.xx.#.",
    ".......o",
    ".#.xx.#.",
    ".#......",
    "...#....",
)


class Grid(NamedTuple):
    """A grid world, and where its states lie.

    Attributes
    ----------
    plan : tuple of str
        The floor, a row a string, the upmost first.
    places : ndarray of int, shape (S, 2)
        Column and row of each state's square; row 0 is the lowest.
    mdp : MDP
        The model. Its actions are in the order of `MOVES`; an episode starts on any free square
        and ends on a ball or in a hole.
    """

    plan: tuple[str, ...]
    places: NDArray[np.int64]
    mdp: MDP

    def __repr__(self) -> str:
        """Return the floor's size, and what the model says of itself."""
        return f"Grid({len(self.plan)} rows, {len(self.plan[0])} columns, {self.mdp!r})"


def grid_world(plan: Sequence[str] = FLOOR, slip: float = 0.1, gamma: float = 0.95) -> Grid:
    """Return a floor on which a robot steps from square to square.

    Parameters
    ----------
    plan : sequence of str, default FLOOR
        A row each, all of one length: "." is free, "#" a wall, "o" the ball, which earns 100, "x"
        a hole, which costs 100.
    slip : float, default 0.1
        How likely a step goes aside, to either side alike, in [0, 1]. A step against a wall or
        the border leads nowhere.
    gamma : float, default 0.95
        The discount rate, in [0, 1).

    Returns
    -------
    Grid

    Raises
    ------
    ValueError
        If the plan is no rectangle, holds another sign or no free square, or a number is out of
        range.

    References
    ----------
    Thesis 2.2. The floor is the course's own.

    Examples
    --------
    >>> grid = grid_world(["..o"], slip=0.0, gamma=0.5)
    >>> grid
    Grid(1 rows, 3 columns, MDP(3 states, 4 actions, gamma=0.5))
    >>> from arkaq_edu.mdp import value_iteration
    >>> value_iteration(grid.mdp)
    (array([ 50., 100.,   0.]), array([0, 0, 0]))
    """
    plan, slip = tuple(plan), number("slip", slip, 0, 1)
    signs = {
        (x, len(plan) - 1 - y): sign for y, row in enumerate(plan) for x, sign in enumerate(row)
    }
    if len({len(row) for row in plan}) != 1 or not set(signs.values()) <= {WALL, *GAINS}:
        raise ValueError(f"plan must have rows of one length made of . # o x, got {plan}")
    squares = [square for square, sign in signs.items() if sign != WALL]
    if "." not in signs.values():
        raise ValueError(f"plan must have a free square, got {plan}")
    state = {square: s for s, square in enumerate(squares)}
    free = np.array([signs[square] == "." for square in squares])
    ahead = np.zeros((len(MOVES), len(squares), len(squares)))
    for (x, y), s in state.items():
        for a, (dx, dy) in enumerate(MOVES.values()):
            ahead[a, s, state.get((x + dx, y + dy), s) if free[s] else s] = 1
    # The moves go round in order, so the two beside an action are its neighbors in the list.
    aside = (np.roll(ahead, 1, axis=0) + np.roll(ahead, -1, axis=0)) / 2
    T = (1 - slip) * ahead + slip * aside
    gains = np.array([GAINS[signs[square]] for square in squares])
    R = np.where(free[:, np.newaxis], (T @ gains).T, 0.0)
    return Grid(plan, np.array(squares), MDP(T, R, gamma, start=free / free.sum()))
