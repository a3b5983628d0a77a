"""A picture as data: panels with axes, layers on the panels, and the fact that the picture states.

A scene is drawn in two ways. While a kernel runs, the browser draws it on a canvas (canvas.js).
For a stored notebook without a kernel, matplotlib draws it into a PNG. Both know the same layers.

The browser needs two things of a layer: its `look`, which travels as JSON, and its `numbers`,
which travel as float32. `paint` draws the layer with matplotlib.

Examples
--------
>>> dots = Points([0.0, 1.0], [2.0, 3.0])
>>> panel = Panel("time (s)", "distance (mm)", (0, 1), (0, 4), [dots])
>>> layout, numbers = Scene("two dots", [panel]).pack()
>>> layout["panels"][0]["layers"][0]["kind"], len(numbers)
('points', 16)
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import tick_label

#: Left, right, bottom and top of a part of a panel, in the units of its axes.
Window = tuple[float, float, float, float]

PNG_WIDTH = 760  # width of a stored picture on the page (pixels)
SIGMA = style.paler(style.OURS, 0.75)  # as `style.band` looks on white
_POINTS = 0.75  # in a pixel of the page


class _Marks:
    """What layers at points `x`, `y` have in common."""

    x: Any
    y: Any

    def look(self) -> dict[str, Any]:
        """Return everything but the points."""
        return {name: value for name, value in vars(self).items() if name not in ("x", "y")}

    def numbers(self) -> NDArray[np.float32]:
        """Return x and y in turn."""
        return np.column_stack([self.x, self.y]).astype(np.float32).ravel()


@dataclass(frozen=True)
class Points(_Marks):
    """Round marks: filled if we computed them, hollow if they were measured or printed.

    `radius` is in pixels of the page.
    """

    kind: ClassVar[str] = "points"
    x: ArrayLike
    y: ArrayLike
    radius: float = 3.0
    color: str = style.INK
    hollow: bool = False

    def paint(self, ax: Axes) -> None:
        """Draw with matplotlib."""
        size = 2 * self.radius * _POINTS
        if self.hollow:
            style.measurements(self.x, self.y, ax, color=self.color, markersize=size)
        else:
            ax.plot(self.x, self.y, "o", color=self.color, markersize=size, markeredgewidth=0)


@dataclass(frozen=True)
class Line(_Marks):
    """A line through points; a NaN in x and y interrupts it.

    `width` is in pixels of the page.
    """

    kind: ClassVar[str] = "line"
    x: ArrayLike
    y: ArrayLike
    color: str = style.INK
    width: float = 1.5
    dashed: bool = False

    @classmethod
    def around(cls, polygon: NDArray[np.float64], color: str, width: float) -> Line:
        """Return the outline of a polygon.

        Examples
        --------
        >>> len(Line.around(box(0, 1, 0, 1), "black", 1.0).x)
        5
        """
        x, y = np.vstack([polygon, polygon[:1]]).T
        return cls(x, y, color, width)

    @classmethod
    def through(cls, paths: NDArray[np.floating], color: str, width: float) -> Line:
        """Return many paths, shape (paths, points, 2), as one line, interrupted between them.

        Examples
        --------
        >>> Line.through(np.zeros((2, 3, 2)), "black", 1.0).x
        array([ 0.,  0.,  0., nan,  0.,  0.,  0., nan])
        """
        lifted = np.pad(paths, ((0, 0), (0, 1), (0, 0)), constant_values=np.nan)
        x, y = lifted.reshape(-1, 2).T
        return cls(x, y, color, width)

    def paint(self, ax: Axes) -> None:
        """Draw with matplotlib."""
        dash = "--" if self.dashed else "-"
        ax.plot(self.x, self.y, dash, color=self.color, linewidth=self.width * _POINTS)


@dataclass(frozen=True)
class Text(_Marks):
    """Words that begin at a point, or are centered on it if `align` is "center"."""

    kind: ClassVar[str] = "text"
    x: float
    y: float
    text: str
    color: str = style.INK
    align: str = "left"

    def paint(self, ax: Axes) -> None:
        """Draw with matplotlib."""
        ax.text(self.x, self.y, self.text, color=self.color, va="center", ha=self.align, fontsize=9)


@dataclass(frozen=True)
class Cells:
    """Polygons, each filled with a color of `palette`, clipped to a window of the panel.

    `within` is that window: left, right, bottom, top, in the units of the axes. `border` is the
    width of the white lines between the polygons (points); by default it depends on their number.
    """

    kind: ClassVar[str] = "cells"
    polygons: Sequence[NDArray[np.float64]]
    colors: Sequence[int]
    within: Window
    palette: Sequence[str] = style.CELLS
    border: float | None = None

    @classmethod
    def shape(cls, polygons: Sequence[NDArray[np.float64]], color: str, within: Window) -> Cells:
        """Return polygons of one color, without borders.

        Examples
        --------
        >>> Cells.shape([box(0, 1, 0, 1)], "red", (0, 9, 0, 9)).palette
        ['red']
        """
        return cls(polygons, [0] * len(polygons), within, [color], border=0)

    @classmethod
    def band(
        cls, x: ArrayLike, mean: NDArray[Any], std: NDArray[Any], within: Window, color: str = SIGMA
    ) -> Cells:
        """Return the band of one standard deviation to each side of a mean.

        Examples
        --------
        >>> mean, std = np.array([2, 3]), np.array([1, 1])
        >>> Cells.band([0, 1], mean, std, (0, 1, 0, 9)).polygons[0].tolist()
        [[0, 3], [1, 4], [1, 2], [0, 1]]
        """
        return cls.shape([area(x, mean - std, mean + std)], color, within)

    @classmethod
    def strip(
        cls, ends: NDArray[np.float64], colors: Sequence[int], within: Window, **look: Any
    ) -> Cells:
        """Return a strip at the foot of a panel: a rectangle from each of the ends to the next.

        Parameters
        ----------
        ends : ndarray, shape (n + 1,)
            Where the rectangles begin and end; their height is that of `within`.
        colors, within, **look
            As for `Cells`.

        Examples
        --------
        >>> Cells.strip(np.array([0, 0.3, 1]), [0, 1], (0, 1, 0, 0.1)).polygons[1][0].tolist()
        [0.3, 0.0]
        """
        boxes = [box(left, right, *within[2:]) for left, right in pairwise(ends)]
        return cls(boxes, colors, within, **look)

    def look(self) -> dict[str, Any]:
        """Return everything but the polygons."""
        border = style.border_width(len(self.polygons)) if self.border is None else self.border
        return {"palette": list(self.palette), "within": self.within, "border": border}

    def numbers(self) -> NDArray[np.float32]:
        """Return the number of polygons, their sizes, their colors, their corners."""
        sizes = [len(polygon) for polygon in self.polygons]
        corners = np.concatenate([np.ravel(polygon) for polygon in self.polygons])
        return np.concatenate([[len(sizes)], sizes, self.colors, corners]).astype(np.float32)

    def paint(self, ax: Axes) -> None:
        """Draw with matplotlib."""
        area = style.cells(self.polygons, [self.palette[color] for color in self.colors], ax)
        area.set(linewidth=self.look()["border"], zorder=2)  # as lines: later layers lie above
        left, right, bottom, top = self.within
        window = Rectangle((left, bottom), right - left, top - bottom, transform=ax.transData)
        area.set_clip_path(window)


@dataclass(frozen=True)
class Picture:
    """Colored pixels, shape (rows, columns, 3), first row on top, in a window of the panel.

    `within` is that window: left, right, bottom, top, in the units of the axes. If `smooth` is
    False, every pixel is drawn as a square of one color.
    """

    kind: ClassVar[str] = "picture"
    pixels: NDArray[np.uint8]
    within: Window
    smooth: bool = True

    def look(self) -> dict[str, Any]:
        """Return everything but the pixels."""
        return {"columns": self.pixels.shape[1], "within": self.within, "smooth": self.smooth}

    def numbers(self) -> NDArray[np.float32]:
        """Return red, green, blue and 255 of each pixel: four bytes, like a float32."""
        return np.pad(self.pixels, ((0, 0), (0, 0), (0, 1)), constant_values=255).view("f4").ravel()

    def paint(self, ax: Axes) -> None:
        """Draw with matplotlib."""
        how = "antialiased" if self.smooth else "nearest"
        ax.imshow(self.pixels, extent=self.within, aspect=ax.get_aspect(), interpolation=how)


Layer = Cells | Points | Line | Text | Picture


@dataclass(frozen=True)
class Panel:
    """Axes with units, and the layers on them, the first one at the bottom.

    Parameters
    ----------
    xlabel, ylabel : str
        The quantity along each axis, with its unit.
    xlim, ylim : tuple of two float
        Ends of the axes; the first may be greater than the second.
    layers : sequence of Points, Line, Text, Cells or Picture
        What is drawn.
    log : str
        The axes that are logarithmic: "x", "y" or "xy".
    xticks, yticks : sequence of float, optional
        Positions of the numbers; by default round ones.
    width : float
        Share of the picture's width, relative to the other panels.
    bare : bool
        Whether to draw no axes; then both directions have the same scale.
    """

    xlabel: str
    ylabel: str
    xlim: tuple[float, float]
    ylim: tuple[float, float]
    layers: Sequence[Layer]
    log: str = ""
    xticks: Sequence[float] | None = None
    yticks: Sequence[float] | None = None
    width: float = 1.0
    bare: bool = False

    def ticks(self) -> tuple[list[float], list[float]]:
        """Return the positions of the numbers on the two axes.

        Examples
        --------
        >>> Panel("x", "y", (0, 1), (0, 4000), [], xticks=[0, 1]).ticks()
        ([0.0, 1.0], [0.0, 1000.0, 2000.0, 3000.0, 4000.0])
        """
        return _ticks(self.xticks, self.xlim), _ticks(self.yticks, self.ylim)

    def paint(self, ax: Axes) -> None:
        """Draw with matplotlib."""
        style.axes(ax, xlabel=self.xlabel, ylabel=self.ylabel)
        ax.set(**{f"{axis}scale": "log" for axis in self.log})
        ax.set(xlim=self.xlim, ylim=self.ylim)
        for axis, ticks in zip((ax.xaxis, ax.yaxis), self.ticks(), strict=True):
            axis.set_major_locator(FixedLocator(ticks))
            axis.set_minor_locator(NullLocator())
            axis.set_ticklabels([tick_label(tick) for tick in ticks])
        if self.bare:
            ax.axis("off")
            ax.set_aspect("equal")
        for layer in self.layers:
            layer.paint(ax)


@dataclass(frozen=True)
class Scene:
    """Panels side by side, and the one sentence that the picture states."""

    fact: str
    panels: Sequence[Panel]

    def pack(self) -> tuple[dict[str, Any], bytes]:
        """Return what the browser needs: a layout, and all numbers as float32.

        The layout says for each layer where its numbers start and how many there are.
        """
        names = ("xlabel", "ylabel", "xlim", "ylim", "log", "width", "bare")
        parts: list[NDArray[np.float32]] = [np.empty(0, np.float32)]
        panels, start = [], 0
        for panel in self.panels:
            layers = []
            for layer in panel.layers:
                numbers = layer.numbers()
                place = {"start": start, "length": len(numbers)}
                layers.append({"kind": layer.kind, **place, **layer.look()})
                parts.append(numbers)
                start += len(numbers)
            x, y = ([[tick, tick_label(tick)] for tick in ticks] for ticks in panel.ticks())
            axes = {name: getattr(panel, name) for name in names}
            panels.append({**axes, "xticks": x, "yticks": y, "layers": layers})
        return {"fact": self.fact, "panels": panels}, np.concatenate(parts).tobytes()

    def png(self, note: str = "") -> bytes:
        """Return the picture as matplotlib draws it, with two pixels for each of the page.

        A `note` stands below the panels.
        """
        figure = Figure(
            figsize=(PNG_WIDTH / 96, 4.25 if note else 4.0), dpi=192, layout="constrained"
        )
        if note:
            figure.supxlabel(f"▶  {note}", x=0.99, ha="right", fontsize="small", color=style.OURS)
        widths = [panel.width for panel in self.panels]
        row = figure.subplots(1, len(self.panels), width_ratios=widths, squeeze=False)[0]
        for panel, ax in zip(self.panels, row, strict=True):
            panel.paint(ax)
        figure.suptitle(self.fact, x=0.01, ha="left", fontsize="medium", color=style.INK)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        file = io.BytesIO()
        # These pictures have few colors: a palette takes a quarter of the bytes and looks the same.
        # It must hold the rare ones too: a far ball is a few orange pixels.
        few = picture.quantize(128, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
        few.save(file, "PNG", optimize=True)
        return file.getvalue()


def box(left: float, right: float, bottom: float, top: float) -> NDArray[np.float64]:
    """Return the corners of a rectangle.

    Examples
    --------
    >>> box(0, 2, 0, 1).tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
    """
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]], dtype=float)


def area(x: ArrayLike, low: ArrayLike, high: ArrayLike) -> NDArray[np.float64]:
    """Return the outline of the area between two curves.

    Examples
    --------
    >>> area([0, 1], [0, 0], [1, 2]).tolist()
    [[0, 1], [1, 2], [1, 0], [0, 0]]
    """
    x, low, high = (np.asarray(values) for values in (x, low, high))
    return np.column_stack([np.append(x, x[::-1]), np.append(high, low[::-1])])


def _ticks(given: Sequence[float] | None, limits: tuple[float, float]) -> list[float]:
    low, high = sorted(limits)
    ticks = MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(low, high) if given is None else given
    return [round(float(tick), 10) + 0.0 for tick in ticks if low <= tick <= high]
