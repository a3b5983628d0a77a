"""Find the nearest of many moving centers without looking at all of them.

Space is cut into cubic cells two vigilances wide, and a hash table says which centers lie in which
cell. Everything nearer than one vigilance to a pattern then lies in the two cells per axis that a
box around the pattern touches; a nearest center further off is found by widening the box. So the
work per pattern depends on how crowded a cell is, not on how many centers there are in all.

The answer is that of comparing with every center, to the last bit and ties included, because
distances are computed in the same way and only centers that cannot win are left out. So the
arrangement of the table never shows in a result, and it can be rebuilt from the centers.

The table is a pair of integer arrays: ``heads[b]`` is the first center of bucket `b`, ``nexts[c]``
the center after `c` in its bucket, -1 the end. Cells that share a bucket cost time, not exactness.

The learning rule, `learn`, stands at the end of this file and not with its class: numba's cache
knows only the file of the function it compiled, and would miss a change in another.
"""

import math

import numpy as np

from arkaq_edu._compiled import kernel
from arkaq_edu.art._inlined import inlined

ANY_DISTANCE = 1 << 30  # a reach that no search uses up
# Half a cell is a hair more than a vigilance, so that rounding a place (by less than 2**-22 half
# cells) cannot put a center less than a vigilance away outside the box around a pattern.
_A_HAIR_LESS = 1.0 - 2.0**-20
_FARTHEST = 2.0**28


def half_cells_per_unit(vigilance: float) -> float:
    """Return the `scale` of the grid for a vigilance."""
    return _A_HAIR_LESS / vigilance


@kernel
def place(coordinate, scale):
    """Return in which half cell `coordinate` lies, along one axis."""
    # Everything very far out shares the outermost one: no two points get further apart by that.
    return int(np.floor(min(max(coordinate * scale, -_FARTHEST), _FARTHEST)))


@kernel
def locate(x, scale):
    """Return the half cell of `x` along its first three axes, 0 along those it lacks."""
    j = place(x[1], scale) if len(x) > 1 else 0
    k = place(x[2], scale) if len(x) > 2 else 0
    return place(x[0], scale), j, k


@kernel
def hashed(i, j, k, n_buckets):
    """Return the bucket of cell (i, j, k); `n_buckets` is a power of two."""
    return ((i * 73856093 + j * 19349663 + k * 83492791) >> 12) & (n_buckets - 1)


@kernel
def bucket_of(x, scale, n_buckets):
    """Return the bucket of the cell in which `x` lies."""
    i, j, k = locate(x, scale)
    return hashed(i >> 1, j >> 1, k >> 1, n_buckets)


@inlined
def closer(x, centers, c, best, best_d2):
    """Return the nearer of center `c` and the best so far; of equals, the lower index."""
    d2 = 0.0
    for axis in range(len(x)):
        gap = x[axis] - centers[c, axis]
        d2 += gap * gap
    # & and |, unlike `and` and `or`, leave the processor no branch to guess wrong.
    better = (d2 < best_d2) | ((d2 == best_d2) & (c < best))
    return (c if better else best), (d2 if better else best_d2)


@kernel
def nearest(x, centers, n, heads, nexts, scale, reach):
    """Return the nearest of the first `n` centers and its squared distance.

    The search ends at `reach` vigilances. Where no center is that near, what is returned is some
    center further off, or none (index ``len(centers)``, distance infinite).
    """
    at_i, at_j, at_k = locate(x, scale)
    best, best_d2 = len(centers), np.inf
    radius = 1
    while True:
        first_i, last_i = (at_i - radius) >> 1, (at_i + radius) >> 1
        first_j, last_j = ((at_j - radius) >> 1, (at_j + radius) >> 1) if len(x) > 1 else (0, 0)
        first_k, last_k = ((at_k - radius) >> 1, (at_k + radius) >> 1) if len(x) > 2 else (0, 0)
        if (last_i - first_i + 1) * (last_j - first_j + 1) * (last_k - first_k + 1) > n:
            break
        for i in range(first_i, last_i + 1):
            for j in range(first_j, last_j + 1):
                for k in range(first_k, last_k + 1):
                    c = heads[hashed(i, j, k, len(heads))]
                    while c >= 0:
                        best, best_d2 = closer(x, centers, c, best, best_d2)
                        c = nexts[c]
        # Centers outside the box are at least `radius` half cells away, rounding apart.
        if radius >= reach or math.sqrt(best_d2) * scale < radius * _A_HAIR_LESS:
            return best, best_d2
        radius *= 2
    for c in range(n):  # there are fewer centers than cells in the box
        best, best_d2 = closer(x, centers, c, best, best_d2)
    return best, best_d2


@kernel
def link(c, bucket, heads, nexts):
    """Put center `c` into `bucket`."""
    nexts[c] = heads[bucket]
    heads[bucket] = c


@kernel
def unlink(c, bucket, heads, nexts):
    """Take center `c` out of `bucket`."""
    if heads[bucket] == c:
        heads[bucket] = nexts[c]
        return
    before = heads[bucket]
    while nexts[before] != c:
        before = nexts[before]
    nexts[before] = nexts[c]


@kernel
def link_all(centers, n, heads, nexts, scale):
    """Build the table of the first `n` centers anew."""
    for bucket in range(len(heads)):
        heads[bucket] = -1
    for c in range(n):
        link(c, bucket_of(centers[c], scale, len(heads)), heads, nexts)


@kernel
def learn(X, start, labels, centers, counts, n, heads, nexts, scale, vigilance, rate, limit):
    """Present the patterns ``X[start:]`` in order; return where it stopped and how many centers.

    It stops early when a center is to be founded and ``len(centers)`` leaves no room for it.
    A `rate` of 0 stands for one over the count.
    """
    for t in range(start, len(X)):
        x = X[t]
        j, d2 = nearest(x, centers, n, heads, nexts, scale, 1)
        if math.sqrt(d2) < vigilance:
            counts[j] += 1
            eta = rate if rate > 0 else 1.0 / counts[j]
            old = bucket_of(centers[j], scale, len(heads))
            for i in range(len(x)):
                centers[j, i] += eta * (x[i] - centers[j, i])
            new = bucket_of(centers[j], scale, len(heads))
            if new != old:
                unlink(j, old, heads, nexts)
                link(j, new, heads, nexts)
        elif n < limit:
            if n == len(centers):
                return t, n
            j = n
            n += 1
            centers[j] = x
            counts[j] = 1
            link(j, bucket_of(x, scale, len(heads)), heads, nexts)
        else:
            j, d2 = nearest(x, centers, n, heads, nexts, scale, ANY_DISTANCE)
        labels[t] = j
    return len(X), n


@kernel
def recall(X, labels, centers, n, heads, nexts, scale):
    """Write the index of the nearest center of each pattern of `X` into `labels`."""
    for t in range(len(X)):
        labels[t] = nearest(X[t], centers, n, heads, nexts, scale, ANY_DISTANCE)[0]
