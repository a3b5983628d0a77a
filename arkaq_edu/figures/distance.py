"""Figures 4.1 and 4.2: what one pattern does to a category, by angle and by Euclidean distance.

References
----------
Thesis, section 4.2 and figures 4.1 and 4.2.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_4_2(Figure().subplots()).after.get_xdata().round(2).tolist()
[0.4, 1.0, 0.85]
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.quiver import Quiver
from numpy.typing import ArrayLike, NDArray

from arkaq_edu.art import ART2A, EuclideanART
from arkaq_edu.figures.drawing import style


class TurnPlot(NamedTuple):
    """What `figure_4_1` drew: templates as arrows, before and after, and the patterns."""

    ax: Axes
    before: Quiver
    after: Quiver
    patterns: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class MovePlot(NamedTuple):
    """What `figure_4_2` drew: centers before and after, how far they reach, and the patterns."""

    ax: Axes
    before: Line2D
    after: Line2D
    reach: list[Circle]
    patterns: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def figure_4_1(
    ax: Axes | None = None,
    *,
    vigilance: float = 0.8,
    learning_rate: float = 0.3,
    times: int = 3,
) -> TurnPlot:
    """Draw figure 4.1, a template that turns toward a pattern presented several times.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    vigilance : float in [-1, 1)
        Cosine above which a pattern belongs to a template.
    learning_rate : float in (0, 1]
        Update factor of the template.
    times : int
        How often x1 is presented between t = 0 and t = 1.

    Returns
    -------
    TurnPlot
        ``ax``, ``before`` and ``after`` (arrows, one a template), ``patterns``.

    References
    ----------
    Thesis, section 4.2.1, equations 4.1 to 4.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_4_1(Figure().subplots())
    3 times x1: w1 turns from 15° to 38°, x1 lies at 50°
    """
    patterns = np.array([1.25, 0.75])[:, None] * _directions([50, 100])
    art = ART2A(vigilance, learning_rate).fit(_directions([15, 115]))
    before = art.cluster_centers_
    for _ in range(times):
        art.learn_one(patterns[0])
    after = art.cluster_centers_

    start, end, aim = (np.degrees(np.arctan2(*v[::-1])) for v in (before[0], after[0], patterns[0]))
    turn = f"w1 turns from {start:.0f}° to {end:.0f}°"
    ax = _plane(ax, f"{times} times x1: {turn}, x1 lies at {aim:.0f}°")
    ax.add_patch(Circle((0, 0), 1, fill=False, color=style.QUIET, linewidth=0.8))
    old = _arrows(ax, before, style.QUIET)
    new = _arrows(ax, after, style.OURS)
    marks = style.measurements(patterns[:, 0], patterns[:, 1], ax)
    _name(ax, before[:1], ["w1, t = 0"], style.QUIET)
    _name(ax, after, ["w1, t = 1", "w2", "w3"], style.OURS)
    _name(ax, patterns, ["x1", "x2"], style.INK)
    ax.set(xlim=(-0.75, 1.5), ylim=(-0.15, 1.25))
    return TurnPlot(ax, old, new, marks)


def figure_4_2(
    ax: Axes | None = None, *, vigilance: float = 0.4, learning_rate: float = 0.5
) -> MovePlot:
    """Draw figure 4.2, a pattern that moves the nearest center and one that founds its own.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    vigilance : float > 0
        Distance from which on a pattern founds a center.
    learning_rate : float in (0, 1]
        Update factor eta.

    Returns
    -------
    MovePlot
        ``ax``, ``before`` and ``after`` (the centers), ``reach`` (a circle of the vigilance around
        each center there was at first), ``patterns``.

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
        gaps = np.linalg.norm(art.cluster_centers_ - pattern, axis=1)
        n, j = art.n_clusters_, art.learn_one(pattern)
        founded = art.n_clusters_ > n
        place = "the nearest founds" if founded else f"m{j + 1} moves it"
        told.append(f"x{i} at {gaps.min():.2f} from {place}" + f" m{j + 1}" * founded)

    ax = _plane(ax, "; ".join(told))
    reach = [Circle(tuple(m), vigilance, fill=False, color=style.QUIET, ls="--") for m in old]
    for circle in reach:
        ax.add_patch(circle)
    new = art.cluster_centers_
    (was,) = ax.plot(*old.T, "o", color=style.QUIET, markersize=5)
    (now,) = ax.plot(*new.T, "o", color=style.OURS, markersize=5)
    marks = style.measurements(patterns[:, 0], patterns[:, 1], ax, markersize=10)
    _name(ax, old[:1], ["m1, t = 0"], style.QUIET, below=True)
    _name(ax, new, ["m1, t = 1", "m2", "m3", "m4"], style.OURS, below=True)
    _name(ax, patterns, ["x1", "x2"], style.INK)
    ax.set(xlim=(-0.15, 1.5), ylim=(-0.15, 1.1))
    return MovePlot(ax, was, now, reach, marks)


def _directions(degrees: ArrayLike) -> NDArray[np.float64]:
    """Return unit vectors at angles, shape (n, 2)."""
    angles = np.radians(degrees)
    return np.column_stack([np.cos(angles), np.sin(angles)])


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
        ax.annotate(
            name, tuple(place), (8, -10 if below else 4), textcoords="offset points", color=color
        )
