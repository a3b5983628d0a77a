"""An index with one job: find the center nearest to a pattern without looking at all centers.

The plane of the first two features is cut into square cells, a little wider than the vigilance. A
hash table lists the centers of each cell. Every center nearer than the vigilance then lies in one
of the nine cells around the pattern, so the work depends on how crowded a cell is, not on how
many centers there are.

The answer is exactly that of comparing the pattern with every center, ties included. Distances are
computed in the same way, and only centers at least a vigilance away are skipped.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._compiled import kernel

# Rounding shifts a place by less than 2**-24 cells. Cells wider by 2**-20 make up for it.
_ROOM_FOR_ROUNDING = 1.0 - 2.0**-20
# All cells further out count as this one, so that a cell's number always fits an integer.
_OUTERMOST = 2.0**28


class Index(NamedTuple):
    """A hash table of centers: `heads[b]` starts the list of bucket `b`, `nexts` continues it.

    The end of a list is -1. Cells that share a bucket cost time, never exactness.
    """

    vigilance: float
    cells_per_unit: float
    heads: NDArray[np.int64]
    nexts: NDArray[np.int64]


def build(centers: NDArray[np.float64], n: int, vigilance: float) -> Index:
    """Return an index of the first `n` centers, with room for as many as `centers` has rows.

    Examples
    --------
    >>> centers = np.array([[0.0, 0.0], [1.0, 1.0]])
    >>> index = build(centers, 2, vigilance=0.5)
    >>> i, distance = nearest(np.array([0.3, 0.0]), centers, index)
    >>> int(i), distance
    (0, 0.3)
    >>> nearest(np.array([0.5, 0.0]), centers, index)
    (-1, inf)
    """
    capacity = len(centers)
    heads = np.full(2 << capacity.bit_length(), -1)  # a power of two, at most half full
    vigilance = float(vigilance)
    index = Index(vigilance, _ROOM_FOR_ROUNDING / vigilance, heads, np.empty(capacity, np.int64))
    add_all(n, centers, index)
    return index


@kernel
def cell(x, axis, index):
    """Return the number of the cell of `x` along an axis."""
    if axis >= len(x):
        return 0
    place = x[axis] * index.cells_per_unit
    return math.floor(min(max(place, -_OUTERMOST), _OUTERMOST))


@kernel
def bucket(row, column, index):
    """Return the bucket of a cell."""
    return ((row * 73856093 + column * 19349663) >> 12) & (len(index.heads) - 1)


@kernel
def nearest(x, centers, index):
    """Return the nearest center and its distance, or -1 and infinity beyond the vigilance."""
    best, best_d2 = -1, np.inf
    row, column = cell(x, 0, index), cell(x, 1, index)
    for r in range(row - 1, row + 2):
        for c in range(column - 1, column + 2):
            i = index.heads[bucket(r, c, index)]
            while i >= 0:
                d2 = squared_distance(x, centers, i)
                if d2 < best_d2 or (d2 == best_d2 and i < best):
                    best, best_d2 = i, d2
                i = index.nexts[i]
    distance = math.sqrt(best_d2)
    return (best, distance) if distance < index.vigilance else (-1, np.inf)


@kernel
def nearest_of_all(x, centers, n):
    """Return the nearest of the first `n` centers, however far."""
    best, best_d2 = 0, np.inf
    for i in range(n):
        d2 = squared_distance(x, centers, i)
        if d2 < best_d2:
            best, best_d2 = i, d2
    return best


@kernel
def squared_distance(x, centers, i):
    """Return the squared distance of `x` from center `i`."""
    total = 0.0
    for axis in range(len(x)):
        gap = x[axis] - centers[i, axis]
        total += gap * gap
    return total


@kernel
def add(i, centers, index):
    """List center `i` under the cell in which it lies."""
    b = bucket(cell(centers[i], 0, index), cell(centers[i], 1, index), index)
    index.nexts[i] = index.heads[b]
    index.heads[b] = i


@kernel
def add_all(n, centers, index):
    """List the first `n` centers."""
    for i in range(n):
        add(i, centers, index)


@kernel
def remove(i, centers, index):
    """Take center `i` off its list, before it moves."""
    b = bucket(cell(centers[i], 0, index), cell(centers[i], 1, index), index)
    if index.heads[b] == i:
        index.heads[b] = index.nexts[i]
        return
    before = index.heads[b]
    while index.nexts[before] != i:
        before = index.nexts[before]
    index.nexts[before] = index.nexts[i]
