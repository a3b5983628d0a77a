"""The vigilance explorer: move the vigilance, watch the categories of the robot's view."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import ipywidgets
import numpy as np
from numpy.typing import ArrayLike

from .. import _checks
from ..art import EuclideanART
from ..figures import segmentation, style
from .explorer import Explorer
from .scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: Where the slider stops; the thesis's five values are among these.
VIGILANCES = tuple(round(0.025 + 0.005 * step, 3) for step in range(36))


def vigilance_explorer(
    patterns: ArrayLike | None = None, learning_rate: float | str = segmentation.LEARNING_RATE
) -> Explorer:
    """Return a slider of vigilance above the map of categories and the thesis's five counts.

    Parameters
    ----------
    patterns : array_like, shape (n, 2), optional
        Scaled patterns (distance, orientation) in the order in which they are learned; the
        course's recorded stream where it is None.
    learning_rate : float or "count"
        Update factor eta of the centres.

    Returns
    -------
    Explorer
        Its slider is ``controls["vigilance"]``, from 0.025 to 0.2.

    Raises
    ------
    ValueError
        For patterns of the wrong shape, and for a learning rate out of its range.

    References
    ----------
    Thesis, section 5.2.1 and figures 5.10 to 5.14.

    Examples
    --------
    >>> explorer = vigilance_explorer([[0.0, 0.0], [0.1, 0.0], [1.0, 1.0]])
    >>> explorer
    2 categories at vigilance 0.15, the thesis printed 137
    >>> explorer.controls["vigilance"].value = 0.05
    >>> explorer
    3 categories at vigilance 0.05, the thesis printed 825
    """
    if patterns is None:
        patterns = segmentation.recorded_patterns()
    patterns = _checks.array("patterns", patterns, (None, 2))
    counts = {v: len(centers(patterns, v, learning_rate)) for v in VIGILANCES}
    slider = ipywidgets.FloatSlider(
        0.15, min=VIGILANCES[0], max=VIGILANCES[-1], step=0.005, readout_format=".3f",
        description="vigilance", layout={"width": "min(100%, 36em)"},
    )  # fmt: skip
    return Explorer(partial(draw, patterns, learning_rate, counts), vigilance=slider)


def centers(patterns: ArrayLike, vigilance: float, learning_rate: float | str) -> np.ndarray:
    """Return the centres that one pass over the patterns leaves, shape (n, 2)."""
    return EuclideanART(vigilance, learning_rate).fit(patterns).cluster_centers_


def draw(
    patterns: ArrayLike,
    learning_rate: float | str,
    counts: Mapping[float, int],
    vigilance: float,
) -> Scene:
    """Return the picture at one vigilance: the map on the left, the counts on the right.

    Parameters
    ----------
    patterns : array_like, shape (n, 2)
        Scaled patterns.
    learning_rate : float or "count"
        Update factor eta.
    counts : mapping of float to int
        Our counts, the curve on the right.
    vigilance : float
        Where the slider stands.

    Returns
    -------
    Scene
    """
    vigilance = round(vigilance, 3)  # a slider's steps add up to 0.15000000000000002
    found = centers(patterns, vigilance, learning_rate)
    fact = segmentation.count_fact(len(found), vigilance)
    return Scene(fact, [_map(found), _curve(counts, vigilance, len(found))])


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


def _curve(counts: Mapping[float, int], vigilance: float, n: int) -> Panel:
    thesis = segmentation.THESIS_COUNTS
    layers: list[Layer] = [
        Line([vigilance, vigilance], [30, n], style.QUIET, 1.0, dashed=True),
        Line(list(counts), list(counts.values()), style.OURS),
        Points(list(thesis), list(thesis.values()), 5.0, hollow=True),
        Points([vigilance], [n], 5.0, style.OURS),
        Points([0.08], [3600], 5.0, hollow=True),
        Text(0.09, 3600, "the thesis"),
        Line([0.074, 0.086], [2500, 2500], style.OURS),
        Text(0.09, 2500, "this stream", style.OURS),
    ]
    return Panel(
        "vigilance (a distance)", "categories", (0.022, 0.22), (30, 5000), layers, log=True,
        xticks=[0.025, 0.05, 0.1, 0.2], yticks=[30, 100, 300, 1000, 3000],
    )  # fmt: skip
