"""The one visual grammar: every figure and every widget of the course speaks it.

- An action has one color, everywhere (`ACTIONS`).
- Hollow marks are measurements, or numbers somebody printed; filled marks are our own.
- A band is one standard deviation to each side.
- Cells of a partition get soft colors, and two neighbors never the same one (`CELLS`).
- In the robot's view the ball's orientation runs across, left of the robot on the left, and its
  distance upward, with the robot at the foot of the picture.

Colors that meet in one picture differ in lightness too, so that a gray print and a color-blind
reader lose nothing.

Examples
--------
>>> import numpy as np
>>> from matplotlib.figure import Figure
>>> ax = Figure().subplots()
>>> marks = measurements([0, 1, 2], [1.0, 1.2, 0.9], ax)
>>> marks.get_markerfacecolor()
'none'
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection, PolyCollection
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

INK = "#222222"
QUIET = "#6b6b6b"
OURS = "#8a2f74"  # what we computed, where no action gives it a color
ACTIONS = {"forward": "#16324f", "left": "#c8501e", "right": "#5aaadf", "kick": "#f4d24a"}
# From light to dark; found by a search for six soft colors that stay apart for every kind of
# color vision.
CELLS = ("#d6f4f4", "#e1e5cf", "#a4e2f7", "#dccda4", "#a5cacc", "#afbda8")

# What the camera can show: half its width is 0.4965 rad; the thesis gives 0.5 rad, 200 to 4100 mm.
VIEW_ORIENTATION = (0.5, -0.5)
VIEW_DISTANCE = (0.0, 4500.0)


def axes(ax: Axes | None = None, *, xlabel: str = "", ylabel: str = "", title: str = "") -> Axes:
    """Return axes in the house style: `ax` itself, or fresh ones where it is None.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Axes to dress.
    xlabel, ylabel : str
        What runs along the axes, with its unit.
    title : str
        What the picture states.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes(Figure().subplots(), xlabel="time (s)").get_xlabel()
    'time (s)'
    """
    if ax is None:
        _, ax = plt.subplots(layout="constrained")
    ax.set(xlabel=xlabel, ylabel=ylabel)
    ax.set_title(title, loc="left", fontsize="medium", color=INK)
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(colors=INK)
    return ax


def view_axes(ax: Axes | None = None, *, title: str = "") -> Axes:
    """Return axes of the robot's view: orientation (rad, left on the left) by distance (mm).

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Axes to dress; fresh ones where it is None.
    title : str
        What the picture states.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = view_axes(Figure().subplots())
    >>> [float(end) for end in ax.get_xlim()]
    [0.5, -0.5]
    """
    ax = axes(
        ax, xlabel="ball orientation (rad), left of the robot is left", ylabel="distance (mm)",
        title=title,
    )  # fmt: skip
    ax.set(xlim=VIEW_ORIENTATION, ylim=VIEW_DISTANCE)
    return ax


def measurements(x: ArrayLike, y: ArrayLike, ax: Axes | None = None, **style: Any) -> Line2D:
    """Draw hollow marks: what a sensor gave, or what somebody printed.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Places of the marks.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    **style
        Passed to `matplotlib.axes.Axes.plot`.

    Returns
    -------
    matplotlib.lines.Line2D

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> marks = measurements([0.15], [137], Figure().subplots(), label="thesis")
    >>> marks.get_label(), marks.get_markerfacecolor()
    ('thesis', 'none')
    """
    ax = axes(ax) if ax is None else ax
    look = {"linestyle": "none", "marker": "o", "color": INK, "markerfacecolor": "none"}
    (marks,) = ax.plot(np.asarray(x), np.asarray(y), **(look | style))
    return marks


def band(
    x: ArrayLike,
    mean: ArrayLike,
    std: ArrayLike,
    ax: Axes | None = None,
    *,
    color: str = OURS,
    **style: Any,
) -> tuple[Line2D, FillBetweenPolyCollection]:
    """Draw a mean as a line in a band that reaches one standard deviation to each side.

    Parameters
    ----------
    x, mean, std : array_like, shape (n,)
        Places, means and standard deviations.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    color : str
        Color of both.
    **style
        Passed to `matplotlib.axes.Axes.plot` for the line.

    Returns
    -------
    matplotlib.lines.Line2D, matplotlib.collections.FillBetweenPolyCollection

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> line, area = band([0, 1], [2.0, 3.0], [0.5, 0.5], Figure().subplots())
    >>> area.get_datalim(area.axes.transData).ymin
    np.float64(1.5)
    """
    ax = axes(ax) if ax is None else ax
    x, mean, std = (np.asarray(values, dtype=float) for values in (x, mean, std))
    (line,) = ax.plot(x, mean, color=color, **style)
    area = ax.fill_between(x, mean - std, mean + std, color=color, alpha=0.25, linewidth=0)
    return line, area


def cells(
    polygons: Sequence[NDArray[np.float64]], colors: Sequence[str], ax: Axes | None = None
) -> PolyCollection:
    """Draw the cells of a partition, each in its color, with thin white borders.

    Parameters
    ----------
    polygons : sequence of array, shape (k, 2)
        Corners of each cell, in order around it.
    colors : sequence of str
        A color for each cell.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    matplotlib.collections.PolyCollection

    Examples
    --------
    >>> import numpy as np
    >>> from matplotlib.figure import Figure
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> drawn = cells([square, square + [1, 0]], CELLS[:2], Figure().subplots())
    >>> len(drawn.get_paths())
    2
    """
    ax = axes(ax) if ax is None else ax
    width = border_width(len(polygons))
    area = PolyCollection(list(polygons), facecolors=list(colors), edgecolors="white", lw=width)
    ax.add_collection(area)
    return area


def dot_radius(n: int) -> float:
    """Return a radius, in points, at which `n` dots neither hide their cells nor vanish.

    Examples
    --------
    >>> dot_radius(137) > dot_radius(1933) > 0.5
    True
    """
    return float(np.clip(20 / np.sqrt(max(n, 1)), 0.6, 2.5))


def border_width(n: int) -> float:
    """Return a width, in points, at which the borders of `n` cells leave the cells to be seen.

    Examples
    --------
    >>> border_width(137) > border_width(1933) > 0.1
    True
    """
    return float(np.clip(9 / np.sqrt(max(n, 1)), 0.15, 1.0))
