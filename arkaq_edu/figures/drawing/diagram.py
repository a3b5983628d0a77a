"""The parts of the diagrams: boxes, nodes, words, and the wires between them.

Examples
--------
>>> from matplotlib.figure import Figure
>>> from arkaq_edu.figures.drawing.plot import Plot
>>> ax = blank(Figure().subplots(), "a look becomes a step", (0, 4), (0, 1))
>>> parts = {"look": box(ax, (1, 0.5), "look"), "step": box(ax, (3, 0.5), "step")}
>>> Plot(ax, parts=parts, arrow=wire(ax, (1.55, 0.5), (2.45, 0.5)))
a look becomes a step
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch, Rectangle, RegularPolygon
from matplotlib.path import Path
from matplotlib.text import Text
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style

Place = tuple[float, float]
Point = Place | NDArray[np.float64]

# How far circles, squares and diamonds reach from their center.
_CIRCLE, _SQUARE, _DIAMOND = 0.34, 0.31, 0.42
_SHAPE: dict[str, Any] = {"facecolor": style.CELLS[0], "edgecolor": style.INK}
_TIP: dict[str, Any] = {
    "arrowstyle": "-|>", "mutation_scale": 12, "shrinkA": 0, "shrinkB": 0, "color": style.INK,
}  # fmt: skip


def blank(
    ax: Axes | None, title: str, xlim: Place, ylim: Place, inch: float = 0.75,
    size: tuple[float, float] | None = None,
) -> Axes:  # fmt: skip
    """Return axes without a frame, with the same scale in both directions.

    Parameters
    ----------
    ax : matplotlib.axes.Axes or None
        Axes to style; new ones if it is None.
    title : str
        The fact that the diagram states.
    xlim, ylim : tuple of two float
        Ends of the axes.
    inch : float
        Size of a unit on new axes.
    size : tuple of two float, optional
        Width and height of new axes (inches), in place of `inch`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> blank(Figure().subplots(), "nothing", (0, 2), (0, 1)).get_aspect()
    1.0
    """
    size = size or (inch * (xlim[1] - xlim[0]), inch * (ylim[1] - ylim[0]) + 0.3)
    ax = style.axes(ax, title=title, size=size)
    ax.axis("off")
    ax.set(aspect="equal", xlim=xlim, ylim=ylim)
    return ax


def write(ax: Axes, place: Point, text: str, **look: Any) -> Text:
    """Write text with its middle at a place.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> write(Figure().subplots(), (0, 0), "S", weight="bold").get_weight()
    'bold'
    """
    usual: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 9, "color": style.INK}
    return ax.text(place[0], place[1], text, **(usual | look))


def words(ax: Axes, place: Place, text: str, side: str = "center", color: str = style.INK) -> Text:
    """Write words on white; the place is on their `side`: "left", "center" or "right".

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> words(Figure().subplots(), (0, 0), "hidden", "left").get_text()
    'hidden'
    """
    return write(ax, place, text, ha=side, color=color, bbox=style.white())


def box(ax: Axes, place: Place, text: str = "", *, width: float = 1.1, height: float = 0.7) -> Text:
    """Draw a rounded box around a place, with a text in its middle.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> box(Figure().subplots(), (0, 0), "world").get_position()
    (0, 0)
    """
    corner, rounded = (
        (place[0] - width / 2, place[1] - height / 2),
        "round,pad=0,rounding_size=0.15",
    )
    ax.add_patch(FancyBboxPatch(corner, width, height, boxstyle=rounded, **_SHAPE))
    return write(ax, place, text)


def node(ax: Axes, place: Place, text: str) -> Text:
    """Draw a circle with a symbol in it.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> node(Figure().subplots(), (0, 0), "$s$").get_text()
    '$s$'
    """
    ax.add_patch(Circle(place, _CIRCLE, **_SHAPE))
    return write(ax, place, text, fontsize=10)


def moment(ax: Axes, name: str, place: Place) -> Text:
    """Draw a variable at a time step, such as "A_t+1".

    Actions are squares, rewards diamonds, all others (states, observations, beliefs) circles.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> moment(Figure().subplots(), "A_t+1", (0, 0)).get_text()
    '$A_{t+1}$'
    """
    letter, index = name.split("_")
    shapes = {
        "A": RegularPolygon(place, 4, radius=_SQUARE * np.sqrt(2), orientation=np.pi / 4, **_SHAPE),
        "R": RegularPolygon(place, 4, radius=_DIAMOND, **_SHAPE),
    }
    ax.add_patch(shapes.get(letter) or Circle(place, _CIRCLE, **_SHAPE))
    return write(ax, place, f"${letter}_{{{index}}}$", fontsize=10)


def link(ax: Axes, places: Mapping[str, Place], start: str, end: str) -> FancyArrowPatch:
    """Draw a straight wire from the rim of one `moment` to the rim of another.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> link(ax, {"S_t": (0, 0), "A_t": (2, 0)}, "S_t", "A_t") in ax.patches
    True
    """
    one, other = np.array(places[start]), np.array(places[end])
    along = (other - one) / np.hypot(*(other - one))
    return wire(ax, one + _rim(start, along), other + _rim(end, -along))


def _rim(name: str, along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the step from the center of a `moment` to its rim, in a direction of length 1."""
    if name[0] == "A":
        return _SQUARE * along / np.abs(along).max()
    if name[0] == "R":
        return _DIAMOND * along / np.abs(along).sum()
    return _CIRCLE * along


def frame(ax: Axes, corner: Place, width: float, height: float) -> Rectangle:
    """Draw a dashed frame, given its lower left corner.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> frame(Figure().subplots(), (0, 0), 2, 1).get_width()
    2
    """
    look: dict[str, Any] = {"facecolor": "none", "edgecolor": style.QUIET, "linestyle": "--"}
    drawn = Rectangle(corner, width, height, linewidth=0.8, **look)
    ax.add_patch(drawn)
    return drawn


def arrow(ax: Axes, start: Place, end: Place, bend: float = 0.0, **look: Any) -> FancyArrowPatch:
    """Draw an arrow, straight or bent to one side by a share of its length.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> arrow(Figure().subplots(), (0, 0), (1, 0), color="red").get_edgecolor()[:3]
    (1.0, 0.0, 0.0)
    """
    look = _TIP | {"connectionstyle": f"arc3,rad={bend}"} | look
    line = FancyArrowPatch(start, end, **look)
    ax.add_patch(line)
    return line


def wire(ax: Axes, *corners: Point, sign: str = "", norm: bool = False) -> FancyArrowPatch:
    """Draw an arrow through corners.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Where to draw.
    *corners : array_like of two float
        From the first to the last.
    sign : str
        A sign to write beside its end.
    norm : bool
        Whether to put a dot on its last piece, which marks a division by a norm.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> bent = wire(ax, (0, 0), (1, 0), (1, 1), sign="+")
    >>> [text.get_text() for text in ax.texts]
    ['+']
    """
    line = FancyArrowPatch(
        path=Path(np.array(corners)), joinstyle="miter", **(_TIP | {"linewidth": 1.1})
    )
    ax.add_patch(line)
    start, end = np.array(corners[-2:], dtype=float)
    if sign:
        along = (end - start) / np.hypot(*(end - start))
        beside = 0.22 * np.array([-along[1], along[0]]) * (1 if along[0] >= 0 else -1)
        write(ax, end - 0.4 * along + beside, sign, fontsize=10)
    if norm:
        ax.plot(*(start + end) / 2, "o", color=style.INK, markersize=7)
    return line
