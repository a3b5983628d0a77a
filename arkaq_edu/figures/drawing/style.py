"""The visual grammar that all figures and widgets share.

- Each action has one color everywhere (`ACTIONS`).
- Hollow marks are measurements, or numbers that the thesis prints. Filled marks are our own.
- A band is one standard deviation to each side.
- Cells of a partition have soft colors, and no two neighbors the same one (`CELLS`).
- In the robot's view the ball's orientation runs across, with the robot's left on the left. The
  distance runs upward, with the robot at the bottom.

Colors that meet in one picture also differ in lightness. So they can be told apart in a gray print
and by a color-blind reader.

Examples
--------
>>> from matplotlib.figure import Figure
>>> measurements([0, 1, 2], [1.0, 1.2, 0.9], Figure().subplots()).get_markerfacecolor()
'none'
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.text import Annotation
from matplotlib.ticker import FuncFormatter, ScalarFormatter
from matplotlib.transforms import Affine2D, ScaledTranslation
from numpy.typing import ArrayLike, NDArray

from arkaq_edu.figures.drawing.plot import describe_pictures

INK = "#222222"
QUIET = "#6b6b6b"
OURS = "#8a2f74"  # what we computed, unless it has the color of an action
ACTIONS = {"forward": "#16324f", "left": "#c8501e", "right": "#5aaadf", "kick": "#f4d24a"}
# The actions of the course's POMDPs, each in the color of a similar action of the robot.
POMDP_ACTIONS = {
    name: ACTIONS[like]
    for like, names in {
        "forward": ("a1", "down", "listen", "step-ahead"),
        "left": ("a2", "left", "open-left", "step-left", "turn-left", "up"),
        "right": ("open-right", "right", "step-right", "turn-right"),
        "kick": ("look",),
    }.items()
    for name in names
}
# From light to dark. A search found these six soft colors: they stay distinct for every kind of
# color vision.
CELLS = ("#d6f4f4", "#e1e5cf", "#a4e2f7", "#dccda4", "#a5cacc", "#afbda8")

# The chains of figure 2.2: to enter one is an action.
CHAIN_COLORS = dict(zip(("upper", "middle", "lower"), list(ACTIONS.values())[:3], strict=True))
# Lines that are compared, in their order.
SERIES = (QUIET, ACTIONS["left"], ACTIONS["right"], ACTIONS["forward"], OURS)

# The camera shows .4965 rad to each side; the thesis gives .5 rad, and 200 to 4,100 mm.
VIEW_ORIENTATION = (0.5, -0.5)
VIEW_DISTANCE = (0.0, 4500.0)

# The robot from above, looking upward: shoulders, two arms and the head, in points.
_ROBOT = [
    Path.unit_circle().transformed(Affine2D().scale(*size).translate(*middle))
    for size, middle in (
        ((1.7, 3.6), (-7.6, 2.4)), ((1.7, 3.6), (7.6, 2.4)), ((8.5, 3.2), (0.0, 0.0)),
        ((3.8, 3.8), (0.0, 1.2)),
    )
]  # fmt: skip


def axes(
    ax: Axes | None = None, *, xlabel: str = "", ylabel: str = "", title: str = "",
    size: tuple[float, float] | None = None,
) -> Axes:  # fmt: skip
    """Return axes in the house style: `ax` itself, or new ones if it is None.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Axes to style.
    xlabel, ylabel : str
        The quantity along each axis, with its unit.
    title : str
        The fact that the picture states.
    size : tuple of two float, optional
        Width and height of new axes, in inches.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes(Figure().subplots(), xlabel="time (s)").get_xlabel()
    'time (s)'
    """
    if ax is None:
        _, ax = plt.subplots(figsize=size, layout="constrained")
        describe_pictures()
    ax.set(xlabel=xlabel, ylabel=ylabel)
    ax.set_title(title, loc="left", fontsize="medium", color=INK)
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(colors=INK)
    for axis in (ax.xaxis, ax.yaxis):
        if isinstance(axis.get_major_formatter(), ScalarFormatter):
            axis.set_major_formatter(FuncFormatter(lambda value, _: tick_label(round(value, 10))))
    return ax


def tick_label(value: float) -> str:
    """Return the number of a tick as it is written beside the axis.

    Examples
    --------
    >>> tick_label(2000.0), tick_label(-0.2), tick_label(-0.0)
    ('2,000', '−0.2', '0')
    """
    return f"{value + 0.0:,.10g}".replace("-", "−")


def view_axes(ax: Axes | None = None, *, title: str = "") -> Axes:
    """Return `axes` of the robot's view: orientation (rad, left on the left) by distance (mm).

    The robot itself is at the foot of the picture, at (0, 0).

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> [float(end) for end in view_axes(Figure().subplots()).get_xlim()]
    [0.5, -0.5]
    """
    xlabel = "ball to the left  |  to the right (rad)"
    ax = axes(ax, xlabel=xlabel, ylabel="distance (mm)", title=title)
    ax.set(xlim=VIEW_ORIENTATION, ylim=VIEW_DISTANCE)
    figure: Any = ax.get_figure(root=True)
    points: Any = Affine2D().scale(1 / 72) + figure.dpi_scale_trans
    data: Any = ax.transData
    here = points + ScaledTranslation(0.0, 0.0, data)
    look: dict[str, Any] = {"facecolor": "white", "edgecolor": INK, "linewidth": 0.8}
    for part in _ROBOT:
        ax.add_artist(PathPatch(part, transform=here, clip_on=False, zorder=4, **look))
    return ax


def measurements(x: ArrayLike, y: ArrayLike, ax: Axes | None = None, **style: Any) -> Line2D:
    """Draw hollow marks: what a sensor measured, or what the thesis prints.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Places of the marks.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    **style
        Passed to `matplotlib.axes.Axes.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> marks = measurements([0.15], [137], Figure().subplots(), label="thesis")
    >>> marks.get_label(), marks.get_markerfacecolor()
    ('thesis', 'none')
    """
    look = {"linestyle": "none", "marker": "o", "color": INK, "markerfacecolor": "none"}
    (marks,) = (ax or axes()).plot(np.asarray(x), np.asarray(y), **(look | style))
    return marks


def band(
    x: ArrayLike, mean: ArrayLike, std: ArrayLike, ax: Axes | None = None, *, color: str = OURS,
    **style: Any,
) -> tuple[Line2D, FillBetweenPolyCollection]:  # fmt: skip
    """Draw a mean as a line, in a band of one standard deviation to each side.

    Parameters
    ----------
    x, mean, std : array_like, shape (n,)
        Places, means and standard deviations.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    color : str
        Color of line and band.
    **style
        Passed to `matplotlib.axes.Axes.plot` for the line.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> line, area = band([0, 1], [2.0, 3.0], [0.5, 0.5], Figure().subplots())
    >>> area.get_datalim(area.axes.transData).ymin
    np.float64(1.5)
    """
    ax = ax or axes()
    x, mean, std = (np.asarray(values, dtype=float) for values in (x, mean, std))
    (line,) = ax.plot(x, mean, color=color, **style)
    area = ax.fill_between(x, mean - std, mean + std, color=color, alpha=0.25, linewidth=0)
    return line, area


def bands(
    ax: Axes, curves: Mapping[str, tuple[ArrayLike, ArrayLike, ArrayLike]], colors: Sequence[str],
    **look: Any,
) -> tuple[dict[str, Line2D], dict[str, FillBetweenPolyCollection]]:  # fmt: skip
    """Draw a `band` for each curve (x, mean, standard deviation), in a color of its own.

    Raises
    ------
    ValueError
        If there are more curves than colors.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> curves = {"slow": ([0, 1], [2, 3], [0.5, 0.5]), "fast": ([0, 1], [4, 5], [0.5, 0.5])}
    >>> lines, areas = bands(Figure().subplots(), curves, SERIES)
    >>> lines["fast"].get_ydata()
    array([4., 5.])
    """
    if len(curves) > len(colors):
        raise ValueError(f"there are colors for at most {len(colors)} names, got {[*curves]}")
    lines, areas = {}, {}
    for (name, (x, mean, std)), color in zip(curves.items(), colors, strict=False):
        lines[name], areas[name] = band(x, mean, std, ax, color=color, label=name, **look)
    return lines, areas


def cells(
    polygons: Sequence[NDArray[np.float64]], colors: Sequence[str], ax: Axes | None = None
) -> PolyCollection:
    """Draw the cells of a partition, with thin white borders.

    Parameters
    ----------
    polygons : sequence of array, shape (k, 2)
        Corners of each cell, in order around it.
    colors : sequence of str
        A color for each cell.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    >>> len(cells([square, square + [1, 0]], CELLS[:2], Figure().subplots()).get_paths())
    2
    """
    width = border_width(len(polygons))
    area = PolyCollection(list(polygons), facecolors=list(colors), edgecolors="white", lw=width)
    (ax or axes()).add_collection(area)
    return area


def tag(
    ax: Axes,
    place: tuple[float, float],
    text: str,
    offset: tuple[float, float] = (0, 0),
    **look: Any,
) -> Annotation:
    """Write text beside a place, on the side to which `offset` (points) leads from it.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> text = tag(Figure().subplots(), (0.5, 1.0), "best", (4, 0))
    >>> text.get_text(), text.get_ha(), text.get_va()
    ('best', 'left', 'center')
    """
    across, up = np.sign(offset).tolist()
    usual: dict[str, Any] = {
        "ha": {-1: "right", 0: "center", 1: "left"}[across],
        "va": {-1: "top", 0: "center", 1: "bottom"}[up],
        "annotation_clip": False,
    }
    return ax.annotate(text, place, offset, textcoords="offset points", **(usual | look))


def white(pad: float = 1.0, alpha: float = 1.0) -> dict[str, Any]:
    """Return the white ground of a text that stands on lines: the `bbox` of the text.

    Examples
    --------
    >>> white()["facecolor"]
    'white'
    """
    return {"facecolor": "white", "edgecolor": "none", "pad": pad, "alpha": alpha}


def directions(angles: ArrayLike) -> NDArray[np.float64]:
    """Return unit vectors at angles (rad), shape (n, 2).

    Examples
    --------
    >>> directions([0, np.pi / 2]).round(3).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    return np.column_stack([np.cos(angles), np.sin(angles)])


def dot_radius(n: int) -> float:
    """Return a radius (points) at which `n` dots stay visible and hide little of their cells.

    Examples
    --------
    >>> dot_radius(137) > dot_radius(1933) > 0.5
    True
    """
    return float(np.clip(20 / np.sqrt(max(n, 1)), 0.6, 2.5))


def border_width(n: int) -> float:
    """Return a width (points) at which the borders of `n` cells hide little of the cells.

    Examples
    --------
    >>> border_width(137) > border_width(1933) > 0.1
    True
    """
    return float(np.clip(9 / np.sqrt(max(n, 1)), 0.15, 1.0))


def paler(color: str, share: float) -> str:
    """Return a color with a share of white in it.

    Examples
    --------
    >>> paler("#000000", 0.2)
    '#333333'
    """
    red, green, blue = (channel + share * (1 - channel) for channel in to_rgb(color))
    return to_hex((red, green, blue))


def shaded(colors: Sequence[str], light: NDArray[np.float64]) -> list[str]:
    """Return the colors of the faces of a body, paler where more light (0 to 1) falls on a face.

    Examples
    --------
    >>> shaded(["#000000", "#000000"], np.array([0.0, 1.0]))
    ['#262626', '#737373']
    """
    return [paler(color, 0.15 + 0.3 * part) for color, part in zip(colors, light, strict=True)]


def probability(p: float, digits: int = 2) -> str:
    """Return a probability without the zero before its point.

    Examples
    --------
    >>> probability(0.25), probability(0.9996, 3), probability(1)
    ('.25', '1.000', '1.00')
    """
    return f"{p:.{digits}f}".removeprefix("0")
