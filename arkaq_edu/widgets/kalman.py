"""The Kalman explorer: set the noise a filter assumes, watch its estimate and its NIS."""

from __future__ import annotations

from functools import partial

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.kalman import KalmanTrace
from arkaq_edu.kalman.walk import SIGHTING_NOISE, STEP_NOISE, Walk, simulated_walk, walk_filter
from arkaq_edu.widgets.explorer import Explorer, sized, slider
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text, area

_RIGHT = "#e3e3e3"
_CYCLES, _DISTANCES = (-1.0, 60.0), (0.0, 4500.0)
_NIS = (0.05, 500.0)


def kalman_explorer() -> Explorer:
    """Return sliders for R, Q and dropout above a track, its estimate and its NIS.

    The sliders change the filter; the simulated noise stays the same.

    Returns
    -------
    Explorer
        Its sliders are ``controls["r"]`` and ``controls["q"]``, the standard deviations in mm
        that the filter assumes, and ``controls["dropout"]``, the share of sightings missing.

    References
    ----------
    Thesis, section 2.5; it starts at the R of section 5.2.

    Examples
    --------
    >>> explorer = kalman_explorer()
    >>> explorer
    mean NIS 25.15 where 0.67 to 1.39 is right; estimate 90 mm off, sightings 102 mm
    >>> explorer.controls["r"].value = 100.0
    >>> explorer
    mean NIS 1.10 where 0.67 to 1.39 is right; estimate 60 mm off, sightings 102 mm
    """
    return Explorer(
        partial(draw, simulated_walk()),
        r=_powers("sigma of R (mm)", 10.0, SIGHTING_NOISE, ".0f", "sighting"),
        q=_powers("sigma of Q (mm)", 25.0, STEP_NOISE, ".1f", "footstep"),
        dropout=slider(
            "dropout", 0.0, 0, 0.9, 0.1,
            readout_format=".0%", tooltip="The share of sightings that are missing",
        ),
    )  # fmt: skip


def _powers(
    name: str, value: float, true: float, readout: str, what: str
) -> ipywidgets.FloatLogSlider:
    # The true value is a stop, too: a browser moves a value between two stops.
    low, high = np.log10([true / 10, true * 10])
    return ipywidgets.FloatLogSlider(
        value, min=low, max=high, step=0.05, description=name, readout_format=readout,
        tooltip=f"The standard deviation of a {what} that the filter assumes", **sized(),
    )  # fmt: skip


def draw(walk: Walk, r: float, q: float, dropout: float) -> Scene:
    """Return the scene for the assumed noise: the track on the left, the NIS on the right.

    Parameters
    ----------
    walk : Walk
        Truth, sightings and footsteps.
    r, q : float
        Assumed standard deviations in mm, of a sighting and of a footstep.
    dropout : float
        Share of the sightings that are missing, 0 to 1. A larger share contains the smaller one.

    Returns
    -------
    Scene
    """
    # A slider's steps add up to 0.30000000000000004.
    Z = walk.sightings(round(dropout, 3))
    trace = walk_filter(r, q).filter(Z, walk.U)
    told = f"R = ({r:.0f} mm)², Q = ({q:.3g} mm)², {np.isnan(Z).sum()} of {len(Z)} missing"
    return Scene(walk.fact(Z, trace), [_track(walk, Z, trace, told), _nis(trace)])


def _track(walk: Walk, Z: NDArray[np.float64], trace: KalmanTrace, told: str) -> Panel:
    k = np.arange(len(Z), dtype=float)
    x, sigma = trace.x[:, 0], np.sqrt(trace.P[:, 0, 0])
    seen = trace.accepted
    layers: list[Layer] = [
        Cells.band(k, x, sigma, (*_CYCLES, *_DISTANCES)),
        Line(k, walk.truth, style.INK, 1.3),
        Line(k, x, style.OURS, 2.0),
        Points(k[seen], Z[seen, 0], 3.0, hollow=True),
        Text(0.3, 4350, told),
        Line([31.0, 34.0], [3950, 3950], style.INK, 1.3),
        Text(35.5, 3950, "truth"),
        Points([32.5], [3700], 3.0, hollow=True),
        Text(35.5, 3700, "sighting"),
        Line([31.0, 34.0], [3450, 3450], style.OURS, 2.0),
        Text(35.5, 3450, "estimate ± 1 sigma", style.OURS),
    ]
    return Panel("footstep cycle", "ball distance (mm)", _CYCLES, _DISTANCES, layers, width=1.45)


def _nis(trace: KalmanTrace) -> Panel:
    n, mean, low, high = trace.running_nis()
    ends = (1.0, 66.0)
    layers: list[Layer] = [
        Cells.shape([area(n, np.clip(low, *_NIS), high)], _RIGHT, (*ends, *_NIS)),
        Line(ends, [1, 1], style.QUIET, 1.0, dashed=True),
        Line(n, np.clip(mean, *_NIS), style.OURS, 2.0),
        Points(n[-1:], np.clip(mean[-1:], *_NIS), 4.0, style.OURS),
        Text(1.15, 330, "too sure of itself", style.QUIET),
        Text(11.0, 0.075, "too modest", style.QUIET),
        Text(1.15, 0.32, "95 % of right filters", style.QUIET),
    ]
    return Panel(
        "sightings so far", "mean NIS", ends, _NIS, layers, log="xy",
        xticks=[1, 3, 10, 30, 60], yticks=[0.1, 1, 10, 100],
    )  # fmt: skip
