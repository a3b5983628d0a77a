"""The map that centers make of a plane: the cell of each center, and colors for the cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import Voronoi

from arkaq_edu._checks import array, integer, integers

FARTHEST = 4.0  # along an axis: well inside the ring


def voronoi_cells(
    centers: ArrayLike,
) -> tuple[list[NDArray[np.float64]], NDArray[np.intp]]:
    """Return the cell of each center (the points nearest to it) and which cells touch.

    Cells are exact inside the square [-1, 1] x [-1, 1]. Outside they are cut off somewhere.

    Parameters
    ----------
    centers : array_like, shape (n, 2)
        Distinct points, n >= 1, with coordinates in [-4, 4].

    Returns
    -------
    polygons : list of n arrays, shape (k, 2)
        The corners of each cell, in order around it.
    pairs : array of int, shape (m, 2)
        Indices of centers whose cells share a border.

    Raises
    ------
    ValueError
        For centers of the wrong shape, too far out, or equal.

    Examples
    --------
    >>> polygons, pairs = voronoi_cells([[0, -0.5], [0, 0.5]])
    >>> len(polygons), pairs.tolist()
    (2, [[0, 1]])
    """
    centers = array("centers", centers, (None, 2))
    n = len(centers)
    if n == 0 or np.abs(centers).max() > FARTHEST or len(np.unique(centers, axis=0)) < n:
        raise ValueError(
            f"centers must be distinct points within {FARTHEST:g} of 0, at least one, got {n}"
        )
    # A ring of far points closes the outer cells. The square is 2.8 across and the ring is at
    # least 10 away, so no point of the square is nearer to the ring than to a center.
    angles = np.arange(8) * np.pi / 4
    ring = 12 * np.column_stack([np.cos(angles), np.sin(angles)])
    diagram = Voronoi(np.vstack([centers, ring]))
    polygons = [diagram.vertices[diagram.regions[region]] for region in diagram.point_region[:n]]
    pairs = diagram.ridge_points
    return polygons, np.sort(pairs[(pairs < n).all(axis=1)], axis=1)


def six_colors(n: int, pairs: NDArray[np.intp]) -> list[int]:
    """Color the cells of a map with six colors so that neighbors differ.

    Some cell of a plane map always has fewer than six neighbors. Take it away, color the rest, and
    put it back: one of the six colors is free.

    Parameters
    ----------
    n : int
        Number of cells, >= 0.
    pairs : array of int, shape (m, 2)
        Neighbors, as `voronoi_cells` returns them.

    Returns
    -------
    list of n int
        Numbers from 0 to 5.

    Raises
    ------
    ValueError
        If `pairs` do not come from a map in the plane.

    Examples
    --------
    >>> six_colors(3, np.array([[0, 1], [1, 2]]))
    [0, 1, 2]
    """
    n = integer("n", n)
    pairs = integers("pairs", pairs, 0, n - 1)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise ValueError(f"pairs must have shape (any, 2), got {pairs.shape}")
    neighbors: list[list[int]] = [[] for _ in range(n)]
    for i, j in pairs.tolist():
        neighbors[i].append(j)
        neighbors[j].append(i)
    left = [len(others) for others in neighbors]
    ready = [i for i in range(n) if left[i] < 6]
    taken_away: list[int] = []
    while ready:
        taken_away.append(ready.pop())
        for j in neighbors[taken_away[-1]]:
            left[j] -= 1
            if left[j] == 5:
                ready.append(j)
    if len(taken_away) < n:
        raise ValueError("pairs must be those of a map in the plane, got more neighbors than fit")
    colors = [-1] * n
    for i in reversed(taken_away):
        used = {colors[j] for j in neighbors[i]}
        # Each cell tries a different color first, so all six appear about equally often.
        colors[i] = next(c % 6 for c in range(i, i + 6) if c % 6 not in used)
    return colors
