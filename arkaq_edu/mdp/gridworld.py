"""A grid world: a small floor seen from above, with walls, a ball, holes, and feet that slip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import affordable, array, number, shown
from arkaq_edu.mdp.model import MDP

#: The four actions of a grid world, each with its step as (columns to the right, rows up).
MOVES = {"right": (1, 0), "up": (0, 1), "left": (-1, 0), "down": (0, -1)}

#: The reward for entering a square: the ball, a hole, the free floor.
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
    """A grid world and the places of its states.

    Attributes
    ----------
    plan : tuple of str
        The floor, one string for each row, from the top.
    places : ndarray of int, shape (S, 2)
        Column and row of each state's square; row 0 is at the bottom.
    mdp : MDP
        The model. Its actions have the order of `MOVES`. An episode starts on any free square
        and ends on the ball or in a hole.
    """

    plan: tuple[str, ...]
    places: NDArray[np.int64]
    mdp: MDP

    @property
    def signs(self) -> dict[tuple[int, int], str]:
        """The sign of the plan at each square (column, row)."""
        return _signs(self.plan)

    def arrows(self, best: ArrayLike) -> list[tuple[NDArray[np.int64], tuple[int, int]]]:
        """Return an arrow for each best action: its square and its step.

        A state where an episode ends has no arrow, and neither has one where all actions are best.

        Parameters
        ----------
        best : array_like of bool, shape (S, A)
            Which actions are the best of their state, see `arkaq_edu.mdp.best_actions`.

        Returns
        -------
        list of (place, step)

        Raises
        ------
        ValueError
            If the shape does not fit.

        Examples
        --------
        >>> grid_world(["..o"]).arrows(np.eye(4)[[0, 2, 0]])
        [(array([0, 0]), (1, 0)), (array([1, 0]), (-1, 0))]
        """
        best = array("best", best, self.mdp.R.shape) > 0
        shown = best & ~best.all(axis=1, keepdims=True) & ~self.mdp.ends[:, np.newaxis]
        steps = list(MOVES.values())
        return [(self.places[s], steps[a]) for s, a in np.argwhere(shown)]

    def __repr__(self) -> str:
        """Return the size of the floor and the model's repr."""
        return f"Grid({len(self.plan)} rows, {len(self.plan[0])} columns, {self.mdp!r})"


def _signs(plan: tuple[str, ...]) -> dict[tuple[int, int], str]:
    top = len(plan) - 1
    return {(x, top - y): sign for y, row in enumerate(plan) for x, sign in enumerate(row)}


def grid_world(plan: Sequence[str] = FLOOR, slip: float = 0.1, gamma: float = 0.95) -> Grid:
    """Return a floor on which a robot steps from square to square.

    Parameters
    ----------
    plan : sequence of str, default FLOOR
        One string for each row, all of one length. "." is free, "#" is a wall, "o" is the ball,
        which earns 100, and "x" is a hole, which costs 100.
    slip : float, default 0.1
        The probability that a step goes to one side instead, in [0, 1]; both sides are equally
        likely. A step against a wall or the border leads nowhere.
    gamma : float, default 0.95
        The discount rate, in [0, 1].

    Returns
    -------
    Grid

    Raises
    ------
    ValueError
        If the plan is not a rectangle, has an unknown sign or no free square, or if a number is
        out of range.

    References
    ----------
    Thesis 2.1.4 (goals and rewards) and 2.2. The floor is the course's own.

    Examples
    --------
    >>> grid = grid_world(["..o"], slip=0.0, gamma=0.5)
    >>> grid
    Grid(1 rows, 3 columns, MDP(3 states, 4 actions, gamma=0.5))
    >>> from arkaq_edu.mdp import value_iteration
    >>> value_iteration(grid.mdp)
    (array([ 50., 100.,   0.]), array([0, 0, 0]))
    """
    slip = number("slip", slip, 0, 1)
    refusal = ValueError(f"plan must have rows of one length made of . # o x, got {shown(plan)}")
    if (
        isinstance(plan, str)
        or not np.iterable(plan)
        or not all(isinstance(row, str) for row in plan)
    ):
        raise refusal
    plan = tuple(plan)
    signs = _signs(plan)
    if len({len(row) for row in plan}) != 1 or not set(signs.values()) <= {WALL, *GAINS}:
        raise refusal
    squares = [square for square, sign in signs.items() if sign != WALL]
    if "." not in signs.values():
        raise ValueError(f"plan must have a free square, got {shown(plan)}")
    state = {square: s for s, square in enumerate(squares)}
    free = np.array([signs[square] == "." for square in squares])
    ahead = np.zeros(affordable("plan", (len(MOVES), len(squares), len(squares))))
    for (x, y), s in state.items():
        for a, (dx, dy) in enumerate(MOVES.values()):
            ahead[a, s, state.get((x + dx, y + dy), s) if free[s] else s] = 1
    # The moves are in circular order, so the two sides of an action are its neighbors in the list.
    aside = (np.roll(ahead, 1, axis=0) + np.roll(ahead, -1, axis=0)) / 2
    T = (1 - slip) * ahead + slip * aside
    gains = np.array([GAINS[signs[square]] for square in squares])
    R = np.where(free[:, np.newaxis], (T @ gains).T, 0.0)
    return Grid(plan, np.array(squares), MDP(T, R, gamma, start=free / free.sum()))
