"""The vigilance explorer: change what decides a partition, watch the categories of the view."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import ipywidgets
import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.art import ART2A, EuclideanART
from arkaq_edu.art.geometry import six_colors, voronoi_cells
from arkaq_edu.experiments import segmentation
from arkaq_edu.experiments.patterns import Patterns
from arkaq_edu.experiments.segmentation import LEARNING_RATE, METHODS, ORDERS, THESIS_COUNTS
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import WRAP, Explorer, sized, slider
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: The stops of the sliders of vigilance: distances, including the thesis's five, and cosines.
VIGILANCES = tuple(round(0.025 + 0.005 * step, 3) for step in range(36))
COSINES = tuple(round(0.5 + 0.01 * step, 2) for step in range(50))


def vigilance_explorer(
    patterns: ArrayLike | Patterns | None = None, learning_rate: float = LEARNING_RATE
) -> Explorer:
    """Return controls of what decides a partition, above the map of categories and the counts.

    Parameters
    ----------
    patterns : array_like, shape (n, 2), or Patterns, optional
        Scaled patterns (distance, orientation) in the order in which they were recorded; the
        course's recorded stream by default. `arkaq_edu.experiments.patterns.read_patterns` reads
        your own from a csv, with axes of their own.
    learning_rate : float in (0, 1]
        The first value of the update factor eta. The curve of counts is drawn for this value.

    Returns
    -------
    Explorer
        Its ``controls``: method (Euclidean or angular); vigilance, a distance, or cosine, the
        vigilance of the angular method (the other one is hidden); order, in which patterns are
        presented; eta; and n, the number of patterns.

    Raises
    ------
    ValueError
        For patterns of the wrong shape, or a learning rate out of range.

    References
    ----------
    Thesis, sections 4.2 and 5.2.1 and figures 5.9 to 5.14.

    Examples
    --------
    >>> explorer = vigilance_explorer([[0.0, 0.0], [0.1, 0.0], [1.0, 1.0]])
    >>> explorer
    2 categories at vigilance 0.15, the thesis printed 137; coverage 100.0 %, error 0.041
    >>> explorer.controls["vigilance"].value = 0.05
    >>> explorer
    3 categories at vigilance 0.05, the thesis printed 825; coverage 100.0 %, error 0.000
    """
    own = None
    if isinstance(patterns, Patterns):
        own, patterns = patterns, patterns.scaled
    elif patterns is None:
        patterns = segmentation.recorded_patterns()
    patterns = _checks.array("patterns", patterns, (None, 2))
    rate = _checks.number("learning_rate", learning_rate, 0, 1, open_low=True)
    controls = _controls(len(patterns), rate)
    references = {
        method: {v: METHODS[method](v, rate).fit(patterns).n_clusters_ for v in stops}
        for method, stops in (("Euclidean", VIGILANCES), ("angular", COSINES))
    }
    explorer = Explorer(partial(draw, patterns, references, own=own), **controls)
    rows = [("method", "vigilance", "cosine"), ("order", "eta", "n")]
    explorer.children = [
        *(ipywidgets.HBox([controls[name] for name in row], layout=WRAP) for row in rows),
        *explorer.children[len(controls) :],
    ]
    return explorer


def _controls(n: int, learning_rate: float) -> dict[str, Any]:
    narrow, middle, wide = (sized("", width) for width in (17, 21, 38))
    few = max(1, n // 13)  # pieces of 500, if it is the recorded stream
    ends, cosines = (VIGILANCES[0], VIGILANCES[-1]), (COSINES[0], COSINES[-1])
    method = ipywidgets.Dropdown(
        options=list(METHODS), description="method",
        tooltip="What vigilance compares: distances, or angles", **narrow,
    )  # fmt: skip
    distance = slider(
        "vigilance", 0.15, *ends, 0.005, readout_format=".3f",
        tooltip="A pattern farther than this from every center founds a category", **wide,
    )  # fmt: skip
    cosine = slider(
        "vigilance", 0.95, *cosines, 0.01,
        tooltip="A pattern with a smaller cosine to every template founds a category", **wide,
    )  # fmt: skip
    cosine.layout.display = "none"

    def show_its_vigilance(change: Any) -> None:
        shown, hidden = (cosine, distance) if change["new"] == "angular" else (distance, cosine)
        shown.layout.display, hidden.layout.display = None, "none"

    method.observe(show_its_vigilance, names="value")
    return {
        "method": method,
        "vigilance": distance,
        "cosine": cosine,
        "order": ipywidgets.Dropdown(
            options=ORDERS, description="order",
            tooltip="In which order the patterns are learned", **narrow,
        ),
        "eta": slider(
            "eta", learning_rate, 0.05, 1.0, 0.05,
            tooltip="How far a center moves to a pattern that it holds", **middle,
        ),
        "n": slider(
            "patterns", n, few, n, few,
            tooltip="How many patterns are learned, the first ones recorded", **middle,
        ),
    }  # fmt: skip


def draw(
    patterns: ArrayLike,
    references: Mapping[str, Mapping[float, int]],
    method: str = "Euclidean",
    vigilance: float = 0.15,
    cosine: float = 0.95,
    order: str = ORDERS[0],
    eta: float = LEARNING_RATE,
    n: int | None = None,
    own: Patterns | None = None,
) -> Scene:
    """Return the picture for one setting: the map on the left, the counts on the right.

    Parameters
    ----------
    patterns : array_like, shape (N, 2)
        Scaled patterns as recorded. Coverage and error are measured on all of them.
    references : mapping of str to mapping of float to int
        The curve on the right for each method: counts by vigilance.
    method : str
        A key of `METHODS`.
    vigilance, cosine : float
        The vigilance of the Euclidean method and that of the angular method.
    order : str
        One of `arkaq_edu.experiments.segmentation.ORDERS`, for the patterns that are learned.
    eta : float
        Update factor.
    n : int, optional
        Number of patterns that are learned, the first ones recorded; all by default.
    own : Patterns, optional
        The names and the units of the axes, where the patterns are not the robot's.

    Returns
    -------
    Scene
    """
    network = _learn(patterns, method, vigilance, cosine, order, eta, n)
    at, found = network.vigilance, network.cluster_centers_
    counts, n_found = references.get(method, {}), len(found)
    if method == "angular":
        curve = _cosine_curve(counts, at, n_found)
    elif own:
        curve = _own_curve(counts, at, n_found)
    else:
        curve = _distance_curve(counts, at, n_found)
    fact = segmentation.partition_fact(network, patterns, printed=own is None)
    return Scene(fact, [_own_map(found, own) if own else _map(found), curve])


def centers(
    patterns: ArrayLike,
    method: str = "Euclidean",
    vigilance: float = 0.15,
    cosine: float = 0.95,
    order: str = ORDERS[0],
    eta: float = LEARNING_RATE,
    n: int | None = None,
) -> NDArray[np.float64]:
    """Return the centers of the partition that `draw` shows, shape (k, 2), scaled.

    Examples
    --------
    >>> centers([[0.0, 0.0], [1.0, 1.0]]).tolist()
    [[0.0, 0.0], [1.0, 1.0]]
    """
    return _learn(patterns, method, vigilance, cosine, order, eta, n).cluster_centers_


def _learn(
    patterns: ArrayLike,
    method: str,
    vigilance: float,
    cosine: float,
    order: str,
    eta: float,
    n: int | None,
) -> EuclideanART | ART2A:
    # A slider's steps add up to 0.15000000000000002.
    at = round(cosine if method == "angular" else vigilance, 3)
    learned = segmentation.in_order(np.asarray(patterns)[:n], order)
    return METHODS[method](at, round(eta, 3)).fit(learned)


def _own_map(found: NDArray[np.float64], own: Patterns) -> Panel:
    polygons, pairs = voronoi_cells(found)
    colors = six_colors(len(polygons), pairs)
    (left, bottom), (right, top) = own.low, own.high
    x, y = own.unscale(found).T
    dots = Points(x, y, radius=style.dot_radius(len(found)) / 0.75)
    cells = Cells([own.unscale(cell) for cell in polygons], colors, (left, right, bottom, top))
    return Panel(*own.names, (left, right), (bottom, top), [cells, dots], width=1.45)


def _map(found: NDArray[np.float64]) -> Panel:
    polygons, colors = segmentation.map_of(found)
    across, up = segmentation.in_view(found).T
    window = (*segmentation.ORIENTATION, *segmentation.DISTANCE)
    dots = Points(across, up, radius=style.dot_radius(len(found)) / 0.75)
    return Panel(
        "ball to the left  |  to the right (rad)", "distance (mm)",
        style.VIEW_ORIENTATION, style.VIEW_DISTANCE,
        [Cells(polygons, colors, window), dots], width=1.45,
    )  # fmt: skip


def _distance_curve(counts: Mapping[float, int], vigilance: float, n: int) -> Panel:
    printed = Points(list(THESIS_COUNTS), list(THESIS_COUNTS.values()), 5.0, hollow=True)
    layers = [
        *_counts(counts, vigilance, n, 15, printed),
        Points([0.07], [3600], 5.0, hollow=True),
        Text(0.079, 3600, "the thesis"),
        *_key((0.065, 0.075), 0.079, 2400, 1600),
    ]
    return Panel(
        "vigilance (a distance)", "categories", (0.022, 0.22), (15, 5000), layers, log="xy",
        xticks=[0.025, 0.05, 0.1, 0.2], yticks=[30, 100, 300, 1000, 3000],
    )  # fmt: skip


def _own_curve(counts: Mapping[float, int], vigilance: float, n: int) -> Panel:
    top = 1.6 * max(*counts.values(), n)
    layers = [
        *_counts(counts, vigilance, n, 1),
        *_key((0.065, 0.075), 0.079, 0.8 * top, 0.62 * top),
    ]
    return Panel(
        "vigilance (a distance)", "categories", (0.022, 0.22), (1, top), layers, log="x",
        xticks=[0.025, 0.05, 0.1, 0.2],
    )  # fmt: skip


def _cosine_curve(counts: Mapping[float, int], cosine: float, n: int) -> Panel:
    layers = [*_counts(counts, cosine, n, 0), *_key((0.51, 0.54), 0.56, 66, 61)]
    return Panel("vigilance (a cosine)", "categories", (0.49, 1.0), (0, 70), layers)


def _counts(
    counts: Mapping[float, int], at: float, n: int, low: float, *printed: Layer
) -> list[Layer]:
    """Return the curve of counts, what the thesis prints, and this count on its dashed line."""
    return [
        Line([at, at], [low, n], style.QUIET, 1.0, dashed=True),
        Line(list(counts), list(counts.values()), style.OURS),
        *printed,
        Points([at], [n], 5.0, style.OURS),
    ]


def _key(mark: tuple[float, float], words: float, line: float, dot: float) -> list[Layer]:
    """Return what line and dot stand for: the marks, the words, and the height of each row."""
    return [
        Line(mark, [line, line], style.OURS),
        Text(words, line, "all, as recorded", style.OURS),
        Points([sum(mark) / 2], [dot], 5.0, style.OURS),
        Text(words, dot, "on the left", style.OURS),
    ]
