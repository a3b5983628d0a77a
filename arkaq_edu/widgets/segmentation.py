"""The vigilance explorer: move what decides a partition, watch the categories of the view."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from math import acos, degrees
from typing import Any

import ipywidgets
import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.art import ART2A, EuclideanART, coverage, quantization_error
from arkaq_edu.experiments import segmentation
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Explorer
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: The two methods of the thesis's section 4.2.
METHODS = {"Euclidean": EuclideanART, "angular": ART2A}

#: Where the sliders of vigilance stop: distances, the thesis's five among them, and cosines.
VIGILANCES = tuple(round(0.025 + 0.005 * step, 3) for step in range(36))
COSINES = tuple(round(0.5 + 0.01 * step, 2) for step in range(50))


def vigilance_explorer(
    patterns: ArrayLike | None = None, learning_rate: float = segmentation.LEARNING_RATE
) -> Explorer:
    """Return what decides a partition, on sliders, above the map of categories and the counts.

    Parameters
    ----------
    patterns : array_like, shape (n, 2), optional
        Scaled patterns (distance, orientation) in the order in which they were recorded; the
        course's recorded stream where it is None.
    learning_rate : float in (0, 1]
        Where the update factor eta stands at first, and for which the curve of counts is drawn.

    Returns
    -------
    Explorer
        Its ``controls``: method (Euclidean or angular); vigilance, a distance, and cosine, the
        vigilance of the angular method, of which the other is hidden; order, in which patterns
        are presented; eta; and n, how many of them are.

    Raises
    ------
    ValueError
        For patterns of the wrong shape, and for a learning rate out of its range.

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
    if patterns is None:
        patterns = segmentation.recorded_patterns()
    patterns = _checks.array("patterns", patterns, (None, 2))
    rate = _checks.number("learning_rate", learning_rate, 0, 1, open_low=True)
    controls = _controls(len(patterns), rate)
    references = {
        method: {v: METHODS[method](v, rate).fit(patterns).n_clusters_ for v in stops}
        for method, stops in (("Euclidean", VIGILANCES), ("angular", COSINES))
    }
    explorer = Explorer(partial(draw, patterns, references), **controls)
    rows = [("method", "vigilance", "cosine"), ("order", "eta", "n")]
    wrap = {"flex_flow": "row wrap"}
    explorer.children = [
        *(ipywidgets.HBox([controls[name] for name in row], layout=wrap) for row in rows),
        *explorer.children[len(controls) :],
    ]
    return explorer


def _controls(n: int, learning_rate: float) -> dict[str, Any]:
    few = max(1, n // 13)  # the recorded stream in pieces of 500
    wide, narrow, choice = ({"width": f"min(100%, {em}em)"} for em in (38, 21, 17))
    controls = {
        "method": ipywidgets.Dropdown(options=list(METHODS), description="method", layout=choice),
        "vigilance": ipywidgets.FloatSlider(
            0.15, min=VIGILANCES[0], max=VIGILANCES[-1], step=0.005, readout_format=".3f",
            description="vigilance", layout=wide,
        ),
        "cosine": ipywidgets.FloatSlider(
            0.95, min=COSINES[0], max=COSINES[-1], step=0.01,
            description="vigilance", layout=wide | {"display": "none"},
        ),
        "order": ipywidgets.Dropdown(
            options=segmentation.ORDERS, description="order", layout=choice
        ),
        "eta": ipywidgets.FloatSlider(
            learning_rate, min=0.05, max=1.0, step=0.05, description="eta", layout=narrow
        ),
        "n": ipywidgets.IntSlider(
            n, min=few, max=n, step=few, description="patterns", layout=narrow
        ),
    }  # fmt: skip

    def show_its_vigilance(change: Any) -> None:
        angular = change["new"] == "angular"
        controls["vigilance"].layout.display = "none" if angular else None
        controls["cosine"].layout.display = None if angular else "none"

    controls["method"].observe(show_its_vigilance, names="value")
    return controls


def draw(
    patterns: ArrayLike,
    references: Mapping[str, Mapping[float, int]],
    method: str = "Euclidean",
    vigilance: float = 0.15,
    cosine: float = 0.95,
    order: str = segmentation.ORDERS[0],
    eta: float = segmentation.LEARNING_RATE,
    n: int | None = None,
) -> Scene:
    """Return the picture for one setting: the map on the left, the counts on the right.

    Parameters
    ----------
    patterns : array_like, shape (N, 2)
        Scaled patterns as recorded. Coverage and error are measured on all of them.
    references : mapping of str to mapping of float to int
        For each method the curve on the right: counts by vigilance.
    method : str
        A key of `METHODS`.
    vigilance, cosine : float
        The vigilance of the Euclidean method and that of the angular method.
    order : str
        One of `segmentation.ORDERS`, for the patterns that are learned.
    eta : float
        Update factor.
    n : int, optional
        How many patterns are learned, the first ones recorded; all where it is None.

    Returns
    -------
    Scene
    """
    # A slider's steps add up to 0.15000000000000002.
    at = round(cosine if method == "angular" else vigilance, 3)
    learned = segmentation.in_order(np.asarray(patterns)[:n], order)
    network = METHODS[method](at, round(eta, 3)).fit(learned)
    found = network.cluster_centers_
    counted = f"{len(found)} categor{'y' if len(found) == 1 else 'ies'} at vigilance {at:g}"
    if method == "angular":
        counted += f", a cosine: {degrees(acos(at)):.1f}°"
    elif at in segmentation.THESIS_COUNTS:
        counted = segmentation.count_fact(len(found), at)
    curve = _cosine_curve if method == "angular" else _distance_curve
    covered = coverage(network, patterns)
    error = quantization_error(patterns, network.predict(patterns))
    fact = f"{counted}; coverage {100 * covered:.1f} %, error {error:.3f}"
    return Scene(fact, [_map(found), curve(references.get(method, {}), at, len(found))])


def _map(found: np.ndarray) -> Panel:
    polygons, colors = segmentation.map_of(found)
    across, up = segmentation.in_view(found).T
    window = (*segmentation.ORIENTATION, *segmentation.DISTANCE)
    dots = Points(across, up, radius=style.dot_radius(len(found)) / 0.75)
    return Panel(
        "ball orientation (rad), left of the robot is left", "distance (mm)",
        style.VIEW_ORIENTATION, style.VIEW_DISTANCE,
        [Cells(polygons, colors, window), dots], width=1.45,
    )  # fmt: skip


def _distance_curve(counts: Mapping[float, int], vigilance: float, n: int) -> Panel:
    thesis = segmentation.THESIS_COUNTS
    layers: list[Layer] = [
        Line([vigilance, vigilance], [15, n], style.QUIET, 1.0, dashed=True),
        Line(list(counts), list(counts.values()), style.OURS),
        Points(list(thesis), list(thesis.values()), 5.0, hollow=True),
        Points([vigilance], [n], 5.0, style.OURS),
        Points([0.07], [3600], 5.0, hollow=True),
        Text(0.079, 3600, "the thesis"),
        Line([0.065, 0.075], [2400, 2400], style.OURS),
        Text(0.079, 2400, "all, as recorded", style.OURS),
        Points([0.07], [1600], 5.0, style.OURS),
        Text(0.079, 1600, "on the left", style.OURS),
    ]
    return Panel(
        "vigilance (a distance)", "categories", (0.022, 0.22), (15, 5000), layers, log="xy",
        xticks=[0.025, 0.05, 0.1, 0.2], yticks=[30, 100, 300, 1000, 3000],
    )  # fmt: skip


def _cosine_curve(counts: Mapping[float, int], cosine: float, n: int) -> Panel:
    layers: list[Layer] = [
        Line([cosine, cosine], [0, n], style.QUIET, 1.0, dashed=True),
        Line(list(counts), list(counts.values()), style.OURS),
        Points([cosine], [n], 5.0, style.OURS),
        Line([0.51, 0.54], [66, 66], style.OURS),
        Text(0.56, 66, "all, as recorded", style.OURS),
        Points([0.525], [61], 5.0, style.OURS),
        Text(0.56, 61, "on the left", style.OURS),
    ]
    return Panel("vigilance (a cosine)", "categories", (0.49, 1.0), (0, 70), layers)
