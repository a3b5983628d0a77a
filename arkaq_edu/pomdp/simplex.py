"""Beliefs laid out: a grid over all of them, and the triangle of those over three states."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integer

# Where a belief lies that is certain of one of three states: left, top, right.
CORNERS = np.array([[0.0, 0.0], [0.5, math.sqrt(3) / 2], [1.0, 0.0]])


def simplex_grid(n_states: int, resolution: int) -> NDArray[np.float64]:
    """Return every belief whose probabilities are multiples of 1 / resolution.

    Parameters
    ----------
    n_states : int
        The number of states, at least 1.
    resolution : int
        Into how many parts each edge is divided, at least 1.

    Returns
    -------
    ndarray, shape (N, S)
        N = C(resolution + S - 1, S - 1) beliefs, from certainty of the last state to certainty of
        the first.

    Raises
    ------
    ValueError
        If an argument is not an integer >= 1, or the grid would have more than a million points.

    Examples
    --------
    Figure 2.8: the beliefs over two states are a line.

    >>> simplex_grid(2, 4)
    array([[0.  , 1.  ],
           [0.25, 0.75],
           [0.5 , 0.5 ],
           [0.75, 0.25],
           [1.  , 0.  ]])
    """
    n_states = integer("n_states", n_states, 1)
    resolution = integer("resolution", resolution, 1)
    n_points = math.comb(resolution + n_states - 1, n_states - 1)
    if n_points > 1_000_000:
        raise ValueError(
            f"resolution must give at most 1000000 points, got {resolution}, which gives {n_points}"
        )
    # So many dots in a row with S - 1 bars among them: what lies between bars goes to one state.
    places = list(combinations(range(resolution + n_states - 1), n_states - 1))
    bars = np.array(places, dtype=float).reshape(n_points, n_states - 1)
    edges = np.full((n_points, 1), -1.0), np.full((n_points, 1), float(resolution + n_states - 1))
    return (np.diff(np.hstack([edges[0], bars, edges[1]]), axis=1) - 1) / resolution


def to_triangle(b: ArrayLike) -> NDArray[np.float64]:
    """Return where beliefs over three states lie in a triangle with sides of 1.

    Parameters
    ----------
    b : array_like, shape (3,) or (N, 3)
        A belief, or many.

    Returns
    -------
    ndarray, shape (2,) or (N, 2)
        The first state is the left corner (0, 0), the second the top, the third the right corner
        (1, 0). The higher the probability of a state, the further is its side and the nearer its
        corner.

    Raises
    ------
    ValueError
        If `b` has another shape or is no distribution.

    Examples
    --------
    >>> to_triangle([[1, 0, 0], [0, 0.5, 0.5]]).round(3)
    array([[0.   , 0.   ],
           [0.75 , 0.433]])
    """
    b = array("b", b, (None, 3) if np.ndim(b) == 2 else (3,))
    return distribution("b", b) @ CORNERS


def from_triangle(xy: ArrayLike) -> NDArray[np.float64]:
    """Return the beliefs over three states that lie at points of the triangle.

    Parameters
    ----------
    xy : array_like, shape (2,) or (N, 2)
        A point, or many, as `to_triangle` gives them.

    Returns
    -------
    ndarray, shape (3,) or (N, 3)

    Raises
    ------
    ValueError
        If `xy` has another shape or a point lies outside the triangle.

    Examples
    --------
    >>> from_triangle([0.5, 0.0])
    array([0.5, 0. , 0.5])
    """
    xy = array("xy", xy, (None, 2) if np.ndim(xy) == 2 else (2,))
    top = xy[..., 1] / CORNERS[1, 1]
    right = xy[..., 0] - top / 2
    b = np.stack([1 - right - top, top, right], axis=-1)
    if (b < -1e-9).any():
        where = np.argwhere((b < -1e-9).any(axis=-1))[0]
        raise ValueError(f"xy must lie in the triangle, got {xy[tuple(where)].tolist()}")
    b = b.clip(0)
    return b / b.sum(axis=-1, keepdims=True)
