"""A grid world as polygons, for the figures and the widgets that draw its values and actions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_hex, to_rgb
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.mdp.gridworld import WALL, Grid

#: The colors of values from 0 to 100, from light to dark: `style.OURS` on white.
SHADES = tuple(
    to_hex((1 - share) + share * np.array(to_rgb(style.OURS)))
    for share in np.linspace(0.06, 0.62, 32)
)
#: The colors of walls, of holes and of the ball.
STONE, HOLE, BALL = style.QUIET, style.INK, "#e8782a"
_SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
_DISC = 0.5 + 0.3 * style.directions(np.linspace(0, 2 * np.pi, 25)[:-1])
_ARROW = np.array(
    [[-0.3, -0.035], [0.08, -0.035], [0.08, -0.13], [0.32, 0], [0.08, 0.13], [0.08, 0.035],
     [-0.3, 0.035]]
)  # fmt: skip


class Floor(NamedTuple):
    """The polygons of a grid world.

    Attributes
    ----------
    squares, walls, holes, balls : list of ndarray, shape (k, 2)
        A square for each state; the walls, holes and balls.
    shades : list of int
        The color of each state's square, as an index of `SHADES`.
    arrows : list of ndarray, shape (7, 2)
        An arrow for each best action.
    """

    squares: list[NDArray[np.float64]]
    shades: list[int]
    walls: list[NDArray[np.float64]]
    holes: list[NDArray[np.float64]]
    balls: list[NDArray[np.float64]]
    arrows: list[NDArray[np.float64]]


def floor_polygons(grid: Grid, V: ArrayLike, best: ArrayLike) -> Floor:
    """Return the polygons that show values and best actions; each square has side 1.

    Parameters
    ----------
    grid : Grid
        The floor.
    V : array_like, shape (S,)
        The value of each state. Values from 0 to 100 become darker; those below 0 are as light
        as 0.
    best : array_like of bool, shape (S, A)
        Which actions are the best of their state (see `arkaq_edu.mdp.best_actions`).

    Returns
    -------
    Floor

    Raises
    ------
    ValueError
        If a shape does not fit.

    Examples
    --------
    >>> import numpy as np
    >>> from arkaq_edu.mdp import grid_world
    >>> grid = grid_world(["..o"])
    >>> floor = floor_polygons(grid, [0.0, 100.0, 0.0], np.eye(4)[[0, 0, 0]])
    >>> len(floor.arrows), floor.shades, floor.arrows[1].max(axis=0).round(2)
    (2, [0, 31, 0], array([1.82, 0.76]))
    """
    V = _checks.array("V", V, (grid.mdp.n_states,))
    shades = np.rint(np.clip(V / 100, 0, 1) * (len(SHADES) - 1)).astype(int).tolist()
    arrows = []
    for place, (dx, dy) in grid.arrows(best):
        turned = _ARROW @ np.array([[dx, dy], [-dy, dx]])
        # Below an arrow there is room for a number.
        height, size = (0.63, 1.0) if dy == 0 else (0.6, 0.9)
        arrows.append(place + [0.5, height] + size * turned)
    walls, holes, balls = (
        [place + shape for place, found in grid.signs.items() if found == sign]
        for sign, shape in ((WALL, _SQUARE), ("x", _SQUARE), ("o", _DISC))
    )
    squares = [place + _SQUARE for place in grid.places]
    return Floor(squares, shades, walls, holes, balls, arrows)
