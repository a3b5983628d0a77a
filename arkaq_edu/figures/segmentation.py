"""Figures 4.1, 4.2 and 5.9 to 5.14: how a network cuts the robot's view into categories.

A category is a center. Its cell is every ball position nearer to this center than to any other,
measured between scaled patterns, where distance and orientation both run from -1 to 1. In the
picture's own units the cells are the same polygons, stretched. The templates of the angular network
have norm 1, so the nearest is the most aligned, and their cells are sectors.

References
----------
Thesis, sections 4.2 and 5.2.1.

Examples
--------
>>> from matplotlib.figure import Figure
>>> plot_centers([[0.0, -0.5], [0.0, 0.5]], Figure().subplots())
2 centers
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, degrees
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Circle, Rectangle
from matplotlib.quiver import Quiver
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.art import ART2A, EuclideanART
from arkaq_edu.experiments import segmentation
from arkaq_edu.experiments.segmentation import SENSING, in_view
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.plot import Plot


def figure_4_1(
    ax: Axes | None = None, *, vigilance: float = 0.8, learning_rate: float = 0.3, times: int = 3
) -> Plot:
    """Draw figure 4.1, a template that turns toward a pattern presented several times.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    vigilance : float in [-1, 1)
        Cosine above which a pattern belongs to a template.
    learning_rate : float in (0, 1]
        Update factor of the template.
    times : int
        How many times x1 is presented between t = 0 and t = 1.

    Returns
    -------
    Plot
        ``before`` and ``after`` (an arrow for each template), ``patterns``.

    References
    ----------
    Thesis, section 4.2.1, equations 4.1 to 4.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_4_1(Figure().subplots())
    3 times x1: w1 turns from 15° to 38°, x1 lies at 50°
    """
    patterns = np.array([[1.25], [0.75]]) * style.directions(np.radians([50, 100]))
    art = ART2A(vigilance, learning_rate).fit(style.directions(np.radians([15, 115])))
    before = art.cluster_centers_
    for _ in range(_checks.integer("times", times, 0, 10_000)):
        art.learn_one(patterns[0])
    after = art.cluster_centers_

    w1_x1 = np.array([before[0], after[0], patterns[0]])
    start, end, aim = np.degrees(np.arctan2(w1_x1[:, 1], w1_x1[:, 0]))
    turn = f"$w_1$ turns from {start:.0f}° to {end:.0f}°"
    ax = _plane(ax, f"{times} times $x_1$: {turn}, $x_1$ lies at {aim:.0f}°")
    ax.add_patch(Circle((0, 0), 1, fill=False, color=style.QUIET, linewidth=0.8))
    old = _arrows(ax, before, style.QUIET)
    new = _arrows(ax, after, style.OURS)
    marks = style.measurements(patterns[:, 0], patterns[:, 1], ax)
    _name(ax, before[:1], ["$w_1$, $t = 0$"], style.QUIET)
    _name(ax, after[:1], ["$w_1$, $t = 1$"], style.OURS)
    for place, name in zip(after[1:], ("$w_2$", "$w_3$"), strict=False):
        style.tag(ax, place, name, (0, 6), color=style.OURS)
    _name(ax, patterns, ["$x_1$", "$x_2$"], style.INK)
    ax.set(xlim=(-0.75, 1.5), ylim=(-0.15, 1.25))
    return Plot(ax, before=old, after=new, patterns=marks)


def figure_4_2(
    ax: Axes | None = None, *, vigilance: float = 0.4, learning_rate: float = 0.5
) -> Plot:
    """Draw figure 4.2, a pattern that moves the nearest center and one that founds its own.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    vigilance : float > 0
        Distance at which a pattern founds a center.
    learning_rate : float in (0, 1]
        Update factor eta.

    Returns
    -------
    Plot
        ``before`` and ``after`` (the centers), ``reach`` (a circle of the vigilance around
        each old center), ``patterns``.

    References
    ----------
    Thesis, section 4.2.2, equations 4.4 to 4.6.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_4_2(Figure().subplots())
    x1 at 0.25 from m1 moves it; x2 at 0.62 from the nearest founds m3
    """
    old = np.array([[0.3, 0.35], [1.0, 0.3]])
    patterns = np.array([[0.5, 0.5], [0.85, 0.9]])
    art = EuclideanART.from_centers(old, [1, 1], vigilance, learning_rate)
    told = []
    for i, pattern in enumerate(patterns, 1):
        n, gap = art.n_clusters_, np.linalg.norm(art.cluster_centers_ - pattern, axis=1).min()
        j = art.learn_one(pattern) + 1
        place = f"$m_{j}$ moves it" if art.n_clusters_ == n else f"the nearest founds $m_{j}$"
        told.append(f"$x_{i}$ at {gap:.2f} from {place}")

    ax = _plane(ax, "; ".join(told))
    reach = [Circle(tuple(m), vigilance, fill=False, color=style.QUIET, ls="--") for m in old]
    for circle in reach:
        ax.add_patch(circle)
    new = art.cluster_centers_
    (was,) = ax.plot(*old.T, "o", color=style.QUIET, markersize=5)
    (now,) = ax.plot(*new.T, "o", color=style.OURS, markersize=5)
    marks = style.measurements(patterns[:, 0], patterns[:, 1], ax, markersize=10)
    _name(ax, old[:1], ["$m_1$, $t = 0$"], style.QUIET, below=True)
    style.tag(ax, new[0], "$m_1$, $t = 1$", (-6, 4), color=style.OURS)
    _name(ax, new[1:], ["$m_2$", "$m_3$", "$m_4$"], style.OURS, below=True)
    _name(ax, patterns, ["$x_1$", "$x_2$"], style.INK)
    ax.set(xlim=(-0.15, 1.5), ylim=(-0.15, 1.1))
    return Plot(ax, before=was, after=now, reach=reach, patterns=marks)


def _plane(ax: Axes | None, title: str) -> Axes:
    ax = style.axes(ax, xlabel="first feature", ylabel="second feature", title=title)
    ax.set_aspect("equal")
    return ax


def _arrows(ax: Axes, tips: NDArray[np.float64], color: str) -> Quiver:
    feet = np.zeros(len(tips))
    return ax.quiver(feet, feet, *tips.T, color=color, angles="xy", scale_units="xy", scale=1)


def _name(
    ax: Axes, places: NDArray[np.float64], names: list[str], color: str, *, below: bool = False
) -> None:
    for place, name in zip(places, names, strict=False):
        style.tag(ax, place, name, (8, -10 if below else 4), color=color, va="baseline")


def plot_cells(centers: ArrayLike, ax: Axes, colors: Sequence[str] | None = None) -> PolyCollection:
    """Draw the cells of centers in the robot's view, by default in soft colors.

    Parameters
    ----------
    centers : array_like, shape (n, 2)
        Centers as scaled patterns (distance, orientation).
    ax : matplotlib.axes.Axes
        Where to draw.
    colors : sequence of n str, optional
        The color of each cell.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> len(plot_cells([[0, -0.5], [0, 0.5]], Figure().subplots()).get_paths())
    2
    """
    polygons, numbers = segmentation.map_of(centers)
    area = style.cells(polygons, colors or [style.CELLS[number] for number in numbers], ax)
    (near, left), (far, right) = SENSING.low, SENSING.high
    area.set_clip_path(Rectangle((left, near), right - left, far - near, transform=ax.transData))
    return area


def plot_centers(centers: ArrayLike, ax: Axes | None = None, *, title: str = "") -> Plot:
    """Draw centers and their cells in the robot's view.

    Parameters
    ----------
    centers : array_like, shape (n, 2)
        Centers as scaled patterns (distance, orientation).
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    title : str
        What the picture states.

    Returns
    -------
    Plot
        ``cells``, ``centers`` (the dots) and ``n_centers``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_centers([[0, -0.5], [0, 0.5]], Figure().subplots()).centers.get_xdata()
    array([-0.25,  0.25])
    """
    ax = style.view_axes(ax, title=title)
    area = plot_cells(centers, ax)
    across, up = in_view(centers).T
    n = len(across)
    size = 2 * style.dot_radius(n)
    (dots,) = ax.plot(across, up, "o", color=style.INK, markersize=size, markeredgewidth=0)
    return Plot(ax, f"{n} centers", cells=area, centers=dots, n_centers=n)


def figure_5_9(
    ax: Axes | None = None, *, vigilance: float = 0.95, patterns: ArrayLike | None = None
) -> Plot:
    """Draw figure 5.9, the templates of the angular network and the sectors they stand for.

    The cross is the thesis's example, a ball at 2,100 mm and 0.3 rad. A ring marks the template to
    which it belongs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    vigilance : float in [-1, 1)
        Cosine above which a pattern belongs to a template.
    patterns : array_like, shape (n, 2), optional
        Scaled patterns in their order; the recorded stream by default.

    Returns
    -------
    Plot
        ``cells``, ``templates`` (segments from the middle of the view), ``example``, ``chosen``
        and ``n_templates``.

    References
    ----------
    Thesis, sections 4.2.1 and 5.2.1, figure 5.9.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_9(Figure().subplots(), patterns=[[1, 0], [0, 1], [0.5, 0.1], [-1, -1]])
    3 templates at cosine 0.95, an angle of 18.2°
    """
    patterns = segmentation.recorded_patterns() if patterns is None else patterns
    art = ART2A(vigilance, segmentation.ANGULAR_RATE).fit(patterns)
    templates, n = art.cluster_centers_, art.n_clusters_
    title = f"{n} templates at cosine {vigilance:g}, an angle of {degrees(acos(vigilance)):.1f}°"
    plot = plot_centers(templates, ax, title=title)
    middle, tips = in_view([0.0, 0.0]), in_view(templates)
    arrows = LineCollection([[middle, tip] for tip in tips], colors=style.INK, linewidths=1)
    plot.ax.add_collection(arrows, autolim=False)
    distance, orientation = ball = 2100.0, 0.3
    seen = f"a ball at {distance:,.0f} mm, {orientation:g} rad"
    example = style.measurements([orientation], [distance], plot.ax, marker="x", label=seen)
    x, y = tips[art.category(SENSING.scale(ball))]
    ring = {"color": style.OURS, "markersize": 12, "label": "its template", "clip_on": False}
    chosen = style.measurements([x], [y], plot.ax, **ring)
    plot.ax.legend(loc="upper center", ncols=2, frameon=False, borderaxespad=0.1)
    marks: dict[str, Any] = {"templates": arrows, "example": example, "chosen": chosen}
    return Plot(plot.ax, cells=plot.cells, n_templates=n, **marks)


def plot_segmentation(
    vigilance: float, ax: Axes | None = None, *, patterns: ArrayLike | None = None,
    learning_rate: float | str = segmentation.LEARNING_RATE,
) -> Plot:  # fmt: skip
    """Segment a stream of patterns and draw the centers, with the thesis's count and ours.

    Parameters
    ----------
    vigilance : float
        Distance between scaled patterns at which a pattern founds a center.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    patterns : array_like, shape (n, 2), optional
        Scaled patterns in their order; the recorded stream by default.
    learning_rate : float or "count"
        As for `arkaq_edu.art.EuclideanART`.

    Returns
    -------
    Plot
        As `plot_centers`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_segmentation(0.15, Figure().subplots(), patterns=[[0, 0], [0.1, 0], [1, 1]])
    2 categories at vigilance 0.15, the thesis printed 137
    """
    patterns = segmentation.recorded_patterns() if patterns is None else patterns
    centers = EuclideanART(vigilance, learning_rate).fit(patterns).cluster_centers_
    return plot_centers(centers, ax, title=segmentation.count_fact(len(centers), vigilance))


def figure_5_10(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.10, the centers at vigilance 0.15; see `plot_segmentation`."""
    return plot_segmentation(0.15, ax, **options)


def figure_5_11(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.11, the centers at vigilance 0.1; see `plot_segmentation`."""
    return plot_segmentation(0.1, ax, **options)


def figure_5_12(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.12, the centers at vigilance 0.075; see `plot_segmentation`."""
    return plot_segmentation(0.075, ax, **options)


def figure_5_13(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.13, the centers at vigilance 0.05; see `plot_segmentation`."""
    return plot_segmentation(0.05, ax, **options)


def figure_5_14(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.14, the centers at vigilance 0.025; see `plot_segmentation`."""
    return plot_segmentation(0.025, ax, **options)
