"""Figures 5.9 to 5.14: how an ART network cuts the robot's view into categories.

A category is a center; its cell is every ball position nearer to this center than to any other.
Near is meant between scaled patterns, where distance and orientation both run from -1 to 1; in
the picture's own units the cells are the same polygons, stretched. The templates of the angular
network have unit norm, so that the nearest is the most aligned: their cells are sectors.

References
----------
Thesis, section 5.2.1 and figures 5.9 to 5.14.

Examples
--------
>>> import numpy as np
>>> from matplotlib.figure import Figure
>>> plot = plot_centers(np.array([[0.0, -0.5], [0.0, 0.5]]), Figure().subplots())
>>> plot.n_centers
2
"""

from __future__ import annotations

from math import acos, degrees
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import Voronoi

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.art import ART2A, EuclideanART
from arkaq_edu.figures.drawing import style

#: The numbers of centers the thesis prints, by vigilance (figures 5.10 to 5.14).
THESIS_COUNTS = {0.15: 137, 0.1: 333, 0.075: 519, 0.05: 825, 0.025: 1933}

#: The update factor eta with which the agent learns.
LEARNING_RATE = TrainingSettings().learning_rate

#: The update factor with which the templates of figure 5.9 turn. Slow, as the authors of ART 2-A
#: advise: a template that swings leaves directions behind it, where others are founded.
ANGULAR_RATE = 0.1

#: In which order a stream may be presented.
ORDERS = ("as recorded", "shuffled", "sorted by distance")

#: What the scaled interval from -1 to 1 stands for.
SENSING = Sensing.thesis()
DISTANCE, ORIENTATION = zip(SENSING.low, SENSING.high, strict=True)


class CentersPlot(NamedTuple):
    """What `plot_centers` drew."""

    ax: Axes
    cells: PolyCollection
    centers: Line2D
    n_centers: int

    def __repr__(self) -> str:
        """Return what the picture states, so that a notebook prints it under the picture."""
        return self.ax.get_title(loc="left") or f"{self.n_centers} centers"


def recorded_patterns() -> NDArray[np.float64]:
    """Return the course's recorded stream of sightings as scaled patterns.

    Returns
    -------
    array, shape (n, 2)
        Distance and orientation, each in [-1, 1], in the order in which they were seen.

    Examples
    --------
    >>> patterns = recorded_patterns()
    >>> patterns.shape[1], bool(abs(patterns).max() <= 1)
    (2, True)
    """
    from arkaq_edu.experiments import streams  # brings the whole field with it

    return streams.patterns(streams.load_sightings())


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


def coverage(network: ART2A | EuclideanART, patterns: ArrayLike) -> float:
    """Return the share of patterns that a fitted network recognizes.

    A pattern is recognized if it would found no category: its category is within the vigilance.
    Even a pattern that was learned may be lost, because centers move on.

    Parameters
    ----------
    network : ART2A or EuclideanART
        Fitted; it learns nothing here.
    patterns : array_like, shape (n, m)
        Patterns, learned or not.

    Returns
    -------
    float in [0, 1]

    References
    ----------
    Thesis, sections 4.2.1 and 4.2.2: cosine > vigilance; distance < vigilance.

    Examples
    --------
    >>> network = EuclideanART(0.5).fit([[0.0, 0.0], [1.0, 0.0]])
    >>> coverage(network, [[0.1, 0.0], [0.5, 0.5], [1.0, 0.2], [1.0, 0.0]])
    0.75
    """
    patterns = np.asarray(patterns, dtype=float)
    own = network.cluster_centers_[network.predict(patterns)]
    if isinstance(network, ART2A):
        norms = np.linalg.norm(patterns, axis=1)
        recognized = (own * patterns).sum(axis=1) > network.vigilance * norms
    else:
        recognized = np.linalg.norm(patterns - own, axis=1) < network.vigilance
    return float(recognized.mean())


def quantization_error(places: ArrayLike, labels: ArrayLike) -> float:
    """Return how far places are, root mean square, from the mean place of their category.

    It is the error of the best guess of the place that can be made from the category alone.

    Parameters
    ----------
    places : array_like, shape (n, m)
        In any unit, n >= 1.
    labels : array_like, shape (n,)
        The category of each.

    Returns
    -------
    float
        In the unit of `places`.

    Examples
    --------
    >>> quantization_error([[100.0], [300.0], [1000.0], [1200.0]], [0, 0, 1, 1])
    100.0
    """
    places = _checks.array("places", places, (None, None))
    labels = _checks.array("labels", labels, (len(places),))
    _, category, sizes = np.unique(labels, return_inverse=True, return_counts=True)
    sums = [np.bincount(category, weights=column) for column in places.T]
    means = np.column_stack(sums) / sizes[:, None]
    return float(np.sqrt(((places - means[category]) ** 2).sum(axis=1).mean()))


def in_view(patterns: ArrayLike) -> NDArray[np.float64]:
    """Return where patterns lie in the picture: orientation across, distance up.

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


def voronoi_cells(
    centers: ArrayLike,
) -> tuple[list[NDArray[np.float64]], NDArray[np.intp]]:
    """Return each center's cell, the points nearest to it, and which cells touch.

    Inside the square [-1, 1] x [-1, 1] the cells are exact; outside they end somewhere.

    Parameters
    ----------
    centers : array_like, shape (n, 2)
        Points of the square, n >= 1.

    Returns
    -------
    polygons : list of n arrays, shape (k, 2)
        The corners of each cell, in order around it.
    pairs : array of int, shape (m, 2)
        Indices of centers whose cells share a border.

    Examples
    --------
    >>> polygons, pairs = voronoi_cells([[0, -0.5], [0, 0.5]])
    >>> len(polygons), pairs.tolist()
    (2, [[0, 1]])
    """
    centers = _checks.array("centers", centers, (None, 2))
    n = len(centers)
    # A ring of far points closes the outer cells. No point of the square is nearer to the ring
    # than to a center: across the square is 2.8, to the ring at least 10.
    angles = np.arange(8) * np.pi / 4
    ring = 12 * np.column_stack([np.cos(angles), np.sin(angles)])
    diagram = Voronoi(np.vstack([centers, ring]))
    polygons = [diagram.vertices[diagram.regions[region]] for region in diagram.point_region[:n]]
    pairs = diagram.ridge_points
    return polygons, np.sort(pairs[(pairs < n).all(axis=1)], axis=1)


def six_colors(n: int, pairs: NDArray[np.intp]) -> list[int]:
    """Color the cells of a map with six colors so that no two neighbors share one.

    Some country of a map always has fewer than six neighbors. Take it away, color the rest, and
    put it back: one of six colors is free.

    Parameters
    ----------
    n : int
        Number of cells.
    pairs : array of int, shape (m, 2)
        Neighbors. The map must be flat, as cells in a plane are.

    Returns
    -------
    list of n int
        Numbers from 0 to 5.

    Examples
    --------
    >>> import numpy as np
    >>> six_colors(3, np.array([[0, 1], [1, 2]]))
    [0, 1, 2]
    """
    neighbors: list[list[int]] = [[] for _ in range(n)]
    for i, j in pairs.tolist():
        neighbors[i].append(j)
        neighbors[j].append(i)
    left_over = [len(others) for others in neighbors]
    ready = [i for i in range(n) if left_over[i] < 6]
    taken_away: list[int] = []
    while ready:
        i = ready.pop()
        taken_away.append(i)
        for j in neighbors[i]:
            left_over[j] -= 1
            if left_over[j] == 5:
                ready.append(j)
    colors = [-1] * n
    for i in reversed(taken_away):
        used = {colors[j] for j in neighbors[i]}
        # Starting at a color of its own makes all six appear equally often.
        colors[i] = next(c % 6 for c in range(i, i + 6) if c % 6 not in used)
    return colors


def map_of(centers: ArrayLike) -> tuple[list[NDArray[np.float64]], list[int]]:
    """Return the cells of centers as polygons of the robot's view, and a color for each.

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


def plot_centers(centers: ArrayLike, ax: Axes | None = None, *, title: str = "") -> CentersPlot:
    """Draw centers and their cells in the robot's view.

    Parameters
    ----------
    centers : array_like, shape (n, 2)
        Centers as scaled patterns (distance, orientation).
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.

    Returns
    -------
    CentersPlot
        ``ax``, ``cells``, ``centers`` (the dots) and ``n_centers``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_centers([[0, -0.5], [0, 0.5]], Figure().subplots()).centers.get_xdata()
    array([-0.25,  0.25])
    """
    polygons, colors = map_of(centers)
    ax = style.view_axes(ax, title=title)
    area = style.cells(polygons, [style.CELLS[color] for color in colors], ax)
    (left, right), (near, far) = ORIENTATION, DISTANCE
    view = Rectangle((left, near), right - left, far - near, transform=ax.transData)
    area.set_clip_path(view)
    across, up = in_view(centers).T
    size = 2 * style.dot_radius(len(polygons))
    (dots,) = ax.plot(across, up, "o", color=style.INK, markersize=size, markeredgewidth=0)
    return CentersPlot(ax, area, dots, len(polygons))


class TemplatesPlot(NamedTuple):
    """What `figure_5_9` drew: each template's sector, its arrow from the middle, an example."""

    ax: Axes
    cells: PolyCollection
    templates: LineCollection
    example: Line2D
    chosen: Line2D
    n_templates: int

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def figure_5_9(
    ax: Axes | None = None,
    *,
    vigilance: float = 0.95,
    patterns: ArrayLike | None = None,
    learning_rate: float = ANGULAR_RATE,
) -> TemplatesPlot:
    """Draw figure 5.9, the templates of the angular network and the sectors they stand for.

    The hollow mark is the thesis's example, a ball at 2100 mm and 0.3 rad; the template that it
    belongs to is ringed.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    vigilance : float in [-1, 1)
        Cosine above which a pattern belongs to a template.
    patterns : array_like, shape (n, 2), optional
        Scaled patterns in their order; the recorded stream where it is None.
    learning_rate : float in (0, 1]
        As for `arkaq_edu.art.ART2A`.

    Returns
    -------
    TemplatesPlot
        ``ax``, ``cells``, ``templates`` (segments from the middle of the view), ``example``,
        ``chosen`` and ``n_templates``.

    References
    ----------
    Thesis, sections 4.2.1 and 5.2.1, figure 5.9.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_9(Figure().subplots(), patterns=[[1, 0], [0, 1], [0.5, 0.1], [-1, -1]])
    3 templates at cosine 0.95, an angle of 18.2°
    """
    patterns = recorded_patterns() if patterns is None else patterns
    art = ART2A(vigilance, learning_rate).fit(patterns)
    templates = art.cluster_centers_
    title = f"{len(templates)} templates at cosine {vigilance:g}, an angle of "
    base = plot_centers(templates, ax, title=f"{title}{degrees(acos(vigilance)):.1f}°")
    middle, tips = in_view([0.0, 0.0]), in_view(templates)
    arrows = LineCollection([[middle, tip] for tip in tips], colors=style.INK, linewidths=1)
    base.ax.add_collection(arrows, autolim=False)
    ball = 2100.0, 0.3
    example = style.measurements(ball[1:], ball[:1], base.ax, marker="x")
    own = tips[[art.category(SENSING.scale(ball))]]
    chosen = style.measurements(own[:, 0], own[:, 1], base.ax, color=style.OURS, markersize=12)
    return TemplatesPlot(base.ax, base.cells, arrows, example, chosen, len(templates))


def figure_5_10(ax: Axes | None = None, **options: Any) -> CentersPlot:
    """Draw figure 5.10, the centers at vigilance 0.15; see `plot_segmentation`."""
    return plot_segmentation(0.15, ax, **options)


def figure_5_11(ax: Axes | None = None, **options: Any) -> CentersPlot:
    """Draw figure 5.11, the centers at vigilance 0.1; see `plot_segmentation`."""
    return plot_segmentation(0.1, ax, **options)


def figure_5_12(ax: Axes | None = None, **options: Any) -> CentersPlot:
    """Draw figure 5.12, the centers at vigilance 0.075; see `plot_segmentation`."""
    return plot_segmentation(0.075, ax, **options)


def figure_5_13(ax: Axes | None = None, **options: Any) -> CentersPlot:
    """Draw figure 5.13, the centers at vigilance 0.05; see `plot_segmentation`."""
    return plot_segmentation(0.05, ax, **options)


def figure_5_14(ax: Axes | None = None, **options: Any) -> CentersPlot:
    """Draw figure 5.14, the centers at vigilance 0.025; see `plot_segmentation`."""
    return plot_segmentation(0.025, ax, **options)


def plot_segmentation(
    vigilance: float,
    ax: Axes | None = None,
    *,
    patterns: ArrayLike | None = None,
    learning_rate: float | str = LEARNING_RATE,
) -> CentersPlot:
    """Segment a stream of patterns and draw the centers, with the thesis's count and ours.

    Parameters
    ----------
    vigilance : float
        Distance, between scaled patterns, from which on a pattern founds a center.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    patterns : array_like, shape (n, 2), optional
        Scaled patterns in their order; the recorded stream where it is None.
    learning_rate : float or "count"
        As for `arkaq_edu.art.EuclideanART`.

    Returns
    -------
    CentersPlot

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_segmentation(0.15, Figure().subplots(), patterns=[[0, 0], [0.1, 0], [1, 1]])
    >>> plot.ax.get_title(loc="left")
    '2 categories at vigilance 0.15, the thesis printed 137'
    """
    patterns = recorded_patterns() if patterns is None else patterns
    centers = EuclideanART(vigilance, learning_rate).fit(patterns).cluster_centers_
    return plot_centers(centers, ax, title=count_fact(len(centers), vigilance))


def count_fact(n: int, vigilance: float) -> str:
    """Say how many categories there are, and what the thesis printed there or nearby.

    Examples
    --------
    >>> count_fact(140, 0.15)
    '140 categories at vigilance 0.15, the thesis printed 137'
    >>> count_fact(200, 0.125)
    '200 categories at vigilance 0.125, the thesis printed 333 at 0.1 and 137 at 0.15'
    >>> count_fact(80, 0.2)
    '80 categories at vigilance 0.2, the thesis printed 137 at 0.15'
    """
    ours = f"{n} categor{'y' if n == 1 else 'ies'} at vigilance {vigilance:g}"
    if vigilance in THESIS_COUNTS:
        return f"{ours}, the thesis printed {THESIS_COUNTS[vigilance]}"
    below = sorted(v for v in THESIS_COUNTS if v < vigilance)[-1:]
    above = sorted(v for v in THESIS_COUNTS if v > vigilance)[:1]
    around = " and ".join(f"{THESIS_COUNTS[v]} at {v:g}" for v in below + above)
    return f"{ours}, the thesis printed {around}"
