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

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch, Rectangle, RegularPolygon
from matplotlib.path import Path
from matplotlib.text import Text
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style

Place = tuple[float, float]

# How far circles, squares and diamonds reach from their center.
_CIRCLE, _SQUARE, _DIAMOND = 0.34, 0.31, 0.42


def blank(ax: Axes | None, title: str, xlim: Place, ylim: Place, inch: float = 0.75) -> Axes:
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

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> blank(Figure().subplots(), "nothing", (0, 2), (0, 1)).get_aspect()
    1.0
    """
    if ax is None:
        size = inch * (xlim[1] - xlim[0]), inch * (ylim[1] - ylim[0]) + 0.3
        _, ax = plt.subplots(figsize=size, layout="constrained")
    style.axes(ax, title=title)
    ax.axis("off")
    ax.set(aspect="equal", xlim=xlim, ylim=ylim)
    return ax


def words(ax: Axes, place: Place, text: str, side: str = "center", color: str = style.INK) -> Text:
    """Write words on white; the place is on their `side`: "left", "center" or "right".

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> words(Figure().subplots(), (0, 0), "hidden", "left").get_text()
    'hidden'
    """
    white = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    return ax.text(*place, text, ha=side, va="center", fontsize=9, color=color, bbox=white)


def box(ax: Axes, place: Place, text: str = "", *, width: float = 1.1, height: float = 0.7) -> Text:
    """Draw a rounded box around a place, with a text in its middle.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> box(Figure().subplots(), (0, 0), "world").get_position()
    (0, 0)
    """
    x, y = place
    patch = FancyBboxPatch(
        (x - width / 2, y - height / 2), width, height,
        boxstyle="round,pad=0,rounding_size=0.15", facecolor=style.CELLS[0], edgecolor=style.INK,
    )  # fmt: skip
    ax.add_patch(patch)
    return ax.text(x, y, text, ha="center", va="center", fontsize=9, color=style.INK)


def node(ax: Axes, place: Place, text: str) -> Text:
    """Draw a circle with a symbol in it.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> node(Figure().subplots(), (0, 0), "$s$").get_text()
    '$s$'
    """
    ax.add_patch(Circle(place, _CIRCLE, facecolor=style.CELLS[0], edgecolor=style.INK))
    return ax.text(*place, text, ha="center", va="center", fontsize=10, color=style.INK)


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
    text = f"${letter}_{{{index}}}$"
    if letter not in "AR":
        return node(ax, place, text)
    radius, turned = (_SQUARE * np.sqrt(2), np.pi / 4) if letter == "A" else (_DIAMOND, 0)
    look = {"facecolor": style.CELLS[0], "edgecolor": style.INK}
    ax.add_patch(RegularPolygon(place, 4, radius=radius, orientation=turned, **look))
    return ax.text(*place, text, ha="center", va="center", fontsize=10, color=style.INK)


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
    (x, y), (to_x, to_y) = one + _rim(start, along), other + _rim(end, -along)
    return wire(ax, (x, y), (to_x, to_y))


def _rim(name: str, along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the way from the center of a `moment` to its rim, in a direction of length 1."""
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
    drawn = Rectangle(corner, width, height, facecolor="none", edgecolor=style.QUIET)
    drawn.set(linestyle="--", linewidth=0.8)
    ax.add_patch(drawn)
    return drawn


def wire(ax: Axes, *corners: Place, sign: str = "", norm: bool = False) -> FancyArrowPatch:
    """Draw an arrow through corners.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Where to draw.
    *corners : tuple of two float
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
    arrow = FancyArrowPatch(
        path=Path(corners), arrowstyle="-|>", mutation_scale=12, shrinkA=0, shrinkB=0,
        color=style.INK, linewidth=1.1, joinstyle="miter",
    )  # fmt: skip
    ax.add_patch(arrow)
    (x, y), (end_x, end_y) = corners[-2:]
    if sign:
        along = np.array([end_x - x, end_y - y]) / np.hypot(end_x - x, end_y - y)
        beside = 0.22 * np.array([-along[1], along[0]]) * (1 if along[0] >= 0 else -1)
        x, y = np.array([end_x, end_y]) - 0.4 * along + beside
        ax.text(x, y, sign, ha="center", va="center", fontsize=10, color=style.INK)
    if norm:
        ax.plot((x + end_x) / 2, (y + end_y) / 2, "o", color=style.INK, markersize=7)
    return arrow
