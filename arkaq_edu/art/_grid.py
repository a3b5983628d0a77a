"""Find the nearest of many moving centres without looking at all of them.

Space is cut into cubic cells as wide as the vigilance, and a hash table says which centres lie in
which cell. A centre nearer than the vigilance then lies in the pattern's own cell or in one that
touches it; a nearest centre further off is found by looking outward, shell by shell. The work per
pattern depends on how crowded a cell is, not on how many centres there are in all.

The answer is that of comparing with every centre, to the last bit and ties included, because
distances are computed in the same way and only centres that cannot win are left out. So the
arrangement of the table never shows in a result, and it can be rebuilt from the centres.

The table is a pair of integer arrays: ``heads[b]`` is the first centre of bucket `b`, ``nexts[j]``
the centre after `j` in its bucket, -1 the end. Cells that share a bucket cost time, not exactness.
"""

import math

import numpy as np

from .._compiled import kernel

ANY_DISTANCE = 1 << 30  # a reach that no search uses up
# Cells are a hair wider than the vigilance, so that rounding a place (by less than 2**-22 cells)
# cannot put two points less than a vigilance apart into cells that do not touch.
_A_HAIR_LESS = 1.0 - 2.0**-20
_FARTHEST_CELL = 2.0**28


def cells_per_unit(vigilance: float) -> float:
    """Return the `scale` of a grid: one over the width of its cells."""
    return _A_HAIR_LESS / vigilance


@kernel
def place(coordinate, scale):
    """Return the cell of `coordinate` along one axis."""
    # Everything very far out shares the outermost cell: no two points get further apart by that.
    return int(np.floor(min(max(coordinate * scale, -_FARTHEST_CELL), _FARTHEST_CELL)))


@kernel
def locate(x, scale):
    """Return the cell of pattern `x` along its first three axes, 0 along those it lacks."""
    j = place(x[1], scale) if len(x) > 1 else 0
    k = place(x[2], scale) if len(x) > 2 else 0
    return place(x[0], scale), j, k


@kernel
def bucket_of(cell, n_buckets):
    """Return the bucket of a cell; `n_buckets` is a power of two."""
    i, j, k = cell
    code = (i * 73856093) ^ (j * 19349663) ^ (k * 83492791)
    return (code ^ (code >> 15)) & (n_buckets - 1)


@kernel
def closer(x, centers, j, best, best_d2):
    """Return the nearer of centre `j` and the best so far; of equals, the lower index."""
    d2 = 0.0
    for i in range(len(x)):
        gap = x[i] - centers[j, i]
        d2 += gap * gap
    if d2 < best_d2 or (d2 == best_d2 and j < best):
        return j, d2
    return best, best_d2


@kernel
def search_shell(x, centers, heads, nexts, cell, radius, best, best_d2):
    """Return the best of the centres whose cell is `radius` cells away, and the best so far."""
    i, j, k = cell
    j_radius = radius if len(x) > 1 else 0
    k_radius = radius if len(x) > 2 else 0
    for di in range(-radius, radius + 1):
        for dj in range(-j_radius, j_radius + 1):
            for dk in range(-k_radius, k_radius + 1):
                if max(abs(di), abs(dj), abs(dk)) == radius:
                    c = heads[bucket_of((i + di, j + dj, k + dk), len(heads))]
                    while c >= 0:
                        best, best_d2 = closer(x, centers, c, best, best_d2)
                        c = nexts[c]
    return best, best_d2


@kernel
def nearest(x, centers, n, heads, nexts, scale, reach):
    """Return the nearest of the first `n` centres and its squared distance.

    Shells further than `reach` are not searched: what is returned is then some centre, or none
    (index ``len(centers)``, distance infinite), not nearer than `reach` cells.
    """
    best, best_d2 = len(centers), np.inf
    cell = locate(x, scale)
    radius = 0
    while (2 * radius + 1) ** min(len(x), 3) <= n:
        best, best_d2 = search_shell(x, centers, heads, nexts, cell, radius, best, best_d2)
        # The centres not seen yet are at least `radius` cells away, rounding apart.
        if radius == reach or math.sqrt(best_d2) * scale < radius * _A_HAIR_LESS:
            return best, best_d2
        radius += 1
    for c in range(n):  # fewer centres than cells in the next shell
        best, best_d2 = closer(x, centers, c, best, best_d2)
    return best, best_d2


@kernel
def link(j, bucket, heads, nexts):
    """Put centre `j` into `bucket`."""
    nexts[j] = heads[bucket]
    heads[bucket] = j


@kernel
def unlink(j, bucket, heads, nexts):
    """Take centre `j` out of `bucket`."""
    if heads[bucket] == j:
        heads[bucket] = nexts[j]
        return
    i = heads[bucket]
    while nexts[i] != j:
        i = nexts[i]
    nexts[i] = nexts[j]


@kernel
def link_all(centers, n, heads, nexts, scale):
    """Build the table of the first `n` centres anew."""
    for bucket in range(len(heads)):
        heads[bucket] = -1
    for j in range(n):
        link(j, bucket_of(locate(centers[j], scale), len(heads)), heads, nexts)
