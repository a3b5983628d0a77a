"""The shape of a value function: a line over two states, a bowl over three (figures 2.10 to 2.15).

A value function is the upper surface of vectors. Over two states each vector is a line over p(s1).
Over three states it is a plane over the triangle of beliefs, and the upper surface is a bowl.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array
from arkaq_edu.pomdp.pruning import prune
from arkaq_edu.pomdp.simplex import to_triangle
from arkaq_edu.pomdp.value import ValueFunction

Floats = NDArray[np.float64]

#: The corners of the triangle of beliefs in pictures of the bowl: about the origin, each 1 away.
CENTERED = np.sqrt(3) * (to_triangle(np.eye(3)) - to_triangle(np.eye(3)).mean(axis=0))
# The bowl is this high, its middle this far above the origin, the triangle this far below the bowl.
RISE, MIDDLE, DROP = 0.8, 0.45, 1.15
# The direction the light comes from, on the picture as seen at azimuth 0: from the left, behind.
LIGHT = np.array([-0.8, 0.6])


class UpperSurface(NamedTuple):
    """The upper surface of lines over two states, from p(s1) = 0 to 1.

    Attributes
    ----------
    plans : ndarray of int, shape (n,)
        The vectors on the surface, from left to right.
    p : ndarray, shape (n + 1,)
        The p(s1) at which each piece begins and ends. The first is 0, the last 1.
    values : ndarray, shape (n + 1,)
        The value there.
    """

    plans: NDArray[np.intp]
    p: Floats
    values: Floats


def upper_surface(alphas: ArrayLike) -> UpperSurface:
    """Return which lines over two states form their upper surface, and where.

    Parameters
    ----------
    alphas : array_like, shape (K, 2)
        The vectors.

    Returns
    -------
    UpperSurface

    Raises
    ------
    ValueError
        If there are not two states.

    References
    ----------
    Thesis 2.3.4 (equation 2.23; figures 2.10 and 2.12).

    Examples
    --------
    >>> plans, p, values = upper_surface([[1, 0], [0, 1.5], [0.2, 0.3]])
    >>> plans, p, values
    (array([1, 0]), array([0. , 0.6, 1. ]), array([1.5, 0.6, 1. ]))
    """
    A = array("alphas", alphas, (None, 2))
    slope = A[:, 0] - A[:, 1]
    needed = prune(A)
    plans = needed[np.argsort(slope[needed])]
    left, rise = A[plans, 1], slope[plans]
    borders = (left[:-1] - left[1:]) / (rise[1:] - rise[:-1])
    p = np.concatenate([[0.0], borders, [1.0]])
    return UpperSurface(plans, p, (np.column_stack([p, 1 - p]) @ A.T).max(axis=1))


@lru_cache(maxsize=32)
def regions(V: ValueFunction) -> dict[int, Floats]:
    """Return, for each plan, the region of beliefs where it is best, as a polygon.

    Parameters
    ----------
    V : ValueFunction
        Over three states.

    Returns
    -------
    dict of int to ndarray, shape (m, 3)
        The corners of each region, in order around it. Plans that are best at single beliefs only
        are left out.

    Raises
    ------
    ValueError
        If there are not three states.

    Examples
    --------
    >>> V = ValueFunction(np.eye(3), np.arange(3), np.empty((3, 0), int))
    >>> regions(V)[0].round(2)
    array([[0.5 , 0.  , 0.5 ],
           [1.  , 0.  , 0.  ],
           [0.5 , 0.5 , 0.  ],
           [0.33, 0.33, 0.33]])
    """
    A = array("alphas", V.alphas, (None, 3))
    found = {k: _region(A, k) for k in prune(A).tolist()}
    return {k: region for k, region in found.items() if len(region) > 2}


def _region(A: Floats, k: int) -> Floats:
    """Cut the triangle of beliefs along every line where another vector becomes better than k."""
    region = np.eye(3)
    for ahead in A[k] - np.delete(A, k, axis=0):
        lead = region @ ahead
        cut = []
        for i in range(len(region)):
            here, before = lead[i], lead[i - 1]
            if here * before < 0:  # the lead is zero between these two corners
                cut.append((region[i - 1] * here - region[i] * before) / (here - before))
            if here >= 0:
                cut.append(region[i])
        region = np.array(cut).reshape(-1, 3)
    return region


class Bowl(NamedTuple):
    """A value function over three states, as seen from somewhere.

    Attributes
    ----------
    plans : ndarray of int, shape (n,)
        The plan of each face. The farthest face comes first: they can be drawn in this order.
    faces, shadows : list of ndarray, shape (m, 2)
        Each face on the picture, and the region below it on the triangle of beliefs.
    light : ndarray, shape (n,)
        How much light falls on each face, from 0 to 1.
    corners : ndarray, shape (3, 2, 2)
        For each state its corner of the triangle, and the point of the bowl above it.
    scale : tuple of ndarray, shapes (n,) and (n, 2)
        Round values, and where each is on the picture, above the leftmost corner. None where the
        eye is so high that they would lie on each other.
    """

    plans: NDArray[np.intp]
    faces: list[Floats]
    shadows: list[Floats]
    light: Floats
    corners: Floats
    scale: tuple[Floats, Floats]


def bowl(V: ValueFunction, azimuth: float, elevation: float) -> Bowl:
    """Return the faces of a value function over three states, as seen from somewhere.

    Parameters
    ----------
    V : ValueFunction
        Over three states.
    azimuth : float
        How far the bowl is turned about its axis, in degrees.
    elevation : float
        How far the eye is above the horizon, in degrees: 0 to 90.

    Returns
    -------
    Bowl

    Raises
    ------
    ValueError
        If there are not three states.

    Notes
    -----
    Along any line the slope of a convex function grows. So of two faces, the one that climbs more
    steeply away from the eye is the farther one. Sorted by this slope, far comes before near.

    References
    ----------
    Thesis 2.3.4 (figure 2.11).

    Examples
    --------
    Seen from above, the bowl lies on its shadow:

    >>> from arkaq_edu.pomdp.solve import solved
    >>> seen = bowl(solved("three_places", 1), 0, 90)
    >>> len(seen.faces), bool(np.allclose(seen.faces[0], seen.shadows[0]))
    (4, True)
    """
    A, polygons = V.alphas, regions(V)
    values = {k: b @ A[k] for k, b in polygons.items()}
    low, high = min(v.min() for v in values.values()), A.max()
    scale = RISE / max(high - low, 1e-9)
    turn, up = np.radians([azimuth, elevation])
    right, away = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

    def seen(b: Floats, value: Floats) -> Floats:
        place = b @ CENTERED
        height = (value - low) * scale - RISE / 2 + MIDDLE
        return np.column_stack([place @ right, place @ away * np.sin(up) + height * np.cos(up)])

    # The gradient of b . alpha on the picture: the corners sum to 0, and their squares to 3/2.
    slopes = {k: scale * A[k] @ CENTERED * 2 / 3 for k in polygons}
    order = sorted(polygons, key=lambda k: -float(slopes[k] @ away))
    light = np.array([slopes[k] for k in order]) @ LIGHT
    floor, corners = low - DROP / scale, np.eye(3)
    ticks = _round_values(low, high) if np.cos(up) > 0.4 else np.empty(0)
    leftmost = corners[[(CENTERED @ right).argmin()] * len(ticks)]
    return Bowl(
        np.array(order),
        [seen(polygons[k], values[k]) for k in order],
        [seen(polygons[k], np.full(len(polygons[k]), floor)) for k in order],
        (light - light.min()) / max(np.ptp(light), 1e-9),
        np.stack([seen(corners, np.full(3, floor)), seen(corners, A.max(axis=0))], axis=1),
        (ticks, seen(leftmost, ticks)),
    )


def _round_values(low: float, high: float) -> Floats:
    """Return three to six round values from low to high."""
    rough = max(high - low, 1e-9) / 5
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(power * n for n in (1, 2, 5, 10) if power * n >= rough)
    return step * np.arange(np.ceil(low / step), np.floor(high / step + 1e-9) + 1)
