"""The segmentation of the robot's view (chapter 7): its stream, its counts, its map.

References
----------
Thesis, sections 4.2 and 5.2.1.
"""

from __future__ import annotations

from math import acos, degrees

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.art import ART2A, EuclideanART, coverage, quantization_error
from arkaq_edu.art.geometry import six_colors, voronoi_cells
from arkaq_edu.experiments import approach
from arkaq_edu.experiments.claims import thesis_numbers
from arkaq_edu.experiments.streams import VIGILANCES

#: The numbers of centers that the thesis prints, by vigilance (figures 5.10 to 5.14).
THESIS_COUNTS = {rho: int(thesis_numbers()[f"centers, vigilance {rho:g}"]) for rho in VIGILANCES}

#: The update factor eta with which the agent learns.
LEARNING_RATE = TrainingSettings().learning_rate

#: The update factor of the templates of figure 5.9. It is small, as the authors of ART 2-A advise:
#: a template that swings leaves gaps behind, in which others are founded.
ANGULAR_RATE = 0.1

#: The two methods of the thesis's section 4.2.
METHODS: dict[str, type[EuclideanART | ART2A]] = {"Euclidean": EuclideanART, "angular": ART2A}

#: The orders in which a stream may be presented.
ORDERS = ("as recorded", "shuffled", "sorted by distance")

#: What the scaled interval from -1 to 1 stands for, in mm and rad.
SENSING = Sensing.thesis()
DISTANCE, ORIENTATION = zip(SENSING.low, SENSING.high, strict=True)


def recorded_patterns() -> NDArray[np.float64]:
    """Return the course's recorded stream of sightings as scaled patterns.

    Returns
    -------
    array, shape (n, 2)
        Distance and orientation, each in [-1, 1], as they were seen one after another.

    Examples
    --------
    >>> patterns = recorded_patterns()
    >>> patterns.shape, bool(abs(patterns).max() <= 1)
    ((6500, 2), True)
    """
    return approach.patterns(approach.load_sightings())


def in_order(patterns: ArrayLike, order: str) -> NDArray[np.float64]:
    """Return the same patterns in another order.

    Parameters
    ----------
    patterns : array_like, shape (n, 2)
        Scaled distance and orientation, as recorded.
    order : str
        One of `ORDERS`: "as recorded"; "shuffled", always in the same way; "sorted by distance",
        the nearest ball first.

    Returns
    -------
    array, shape (n, 2)

    Raises
    ------
    ValueError
        For another order, or patterns of the wrong shape.

    Examples
    --------
    >>> in_order([[0.5, 0.1], [-0.5, 0.2]], "sorted by distance")
    array([[-0.5,  0.2],
           [ 0.5,  0.1]])
    """
    patterns = _checks.array("patterns", patterns, (None, 2))
    if order not in ORDERS:
        raise ValueError(f"order must be one of {ORDERS}, got {order!r}")
    if order == "shuffled":
        return np.random.default_rng(0).permutation(patterns)
    return patterns[np.argsort(patterns[:, 0], kind="stable")] if order == ORDERS[2] else patterns


def in_view(patterns: ArrayLike) -> NDArray[np.float64]:
    """Return where scaled patterns lie in the robot's view.

    Parameters
    ----------
    patterns : array_like, shape (..., 2)
        Scaled distance and orientation.

    Returns
    -------
    array, shape (..., 2)
        Orientation in rad, distance in mm.

    Examples
    --------
    >>> in_view([[-1, 0.5]])
    array([[  0.25, 200.  ]])
    """
    return SENSING.unscale(patterns)[..., ::-1]


def map_of(centers: ArrayLike) -> tuple[list[NDArray[np.float64]], list[int]]:
    """Return the cells of centers as polygons of the robot's view, and a color for each.

    A cell holds the ball positions whose scaled pattern is nearer to this center than to any other.

    Parameters
    ----------
    centers : array_like, shape (n, 2)
        Centers as scaled patterns (distance, orientation).

    Returns
    -------
    polygons : list of n arrays, shape (k, 2)
        Corners: orientation in rad, distance in mm.
    colors : list of n int
        Numbers from 0 to 5, different for neighbors.

    Examples
    --------
    >>> polygons, colors = map_of([[0, -0.5], [0, 0.5]])
    >>> colors
    [0, 1]
    """
    polygons, pairs = voronoi_cells(centers)
    ends = np.cumsum([len(polygon) for polygon in polygons])
    corners = np.split(in_view(np.concatenate(polygons)), ends[:-1])
    return corners, six_colors(len(polygons), pairs)


def count_fact(n: int, vigilance: float) -> str:
    """Say how many categories there are, and what the thesis prints there or nearby.

    Examples
    --------
    >>> count_fact(140, 0.15)
    '140 categories at vigilance 0.15, the thesis printed 137'
    >>> count_fact(200, 0.125)
    '200 categories at vigilance 0.125, the thesis printed 333 at 0.1 and 137 at 0.15'
    >>> count_fact(80, 0.2)
    '80 categories at vigilance 0.2, the thesis printed 137 at 0.15'
    """
    ours = f"{n:,} categor{'y' if n == 1 else 'ies'} at vigilance {vigilance:g}"
    if vigilance in THESIS_COUNTS:
        return f"{ours}, the thesis printed {THESIS_COUNTS[vigilance]:,}"
    below = sorted(v for v in THESIS_COUNTS if v < vigilance)[-1:]
    above = sorted(v for v in THESIS_COUNTS if v > vigilance)[:1]
    around = " and ".join(f"{THESIS_COUNTS[v]:,} at {v:g}" for v in below + above)
    return f"{ours}, the thesis printed {around}"


def partition_fact(
    network: EuclideanART | ART2A, patterns: ArrayLike, *, printed: bool = True
) -> str:
    """Say how many categories a network has, and how well they hold the patterns.

    With `printed`, also what the thesis prints there.

    Examples
    --------
    >>> patterns = [[0.5, 0.0], [0.5, 0.1], [-1.0, 1.0]]
    >>> partition_fact(ART2A(0.9, 0.5).fit(patterns), patterns)
    '2 categories at vigilance 0.9, a cosine: 25.8°; coverage 100.0 %, error 0.041'
    """
    n, at = network.n_clusters_, network.vigilance
    counted = f"{n} categor{'y' if n == 1 else 'ies'} at vigilance {at:g}"
    if isinstance(network, ART2A):
        counted += f", a cosine: {degrees(acos(at)):.1f}°"
    elif printed and at in THESIS_COUNTS:
        counted = count_fact(n, at)
    covered = 100 * coverage(network, patterns)
    error = quantization_error(patterns, network.predict(patterns))
    return f"{counted}; coverage {covered:.1f} %, error {error:.3f}"
