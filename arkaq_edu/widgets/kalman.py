"""The Kalman explorer: set the noise a filter assumes, watch its estimate and its NIS."""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.kalman import KalmanFilter, KalmanTrace
from arkaq_edu.widgets.explorer import Explorer, wide
from arkaq_edu.widgets.scene import Layer, Line, Panel, Points, Scene, Text, between

START, STEP = 3400.0, -100.0  # distance of the ball at the start, and its change by a footstep: mm
#: True standard deviations in mm: of the start, a footstep, a sighting.
START_NOISE, STEP_NOISE, SIGHTING_NOISE = 100.0, 25.0, 100.0

_ONE_SIGMA = "#e2cbdc"  # style.OURS at a quarter of its strength on white, as in `style.band`
_RIGHT = "#e3e3e3"
_CYCLES, _DISTANCES = (-1.0, 60.0), (0.0, 4500.0)
_NIS = (0.05, 500.0)


class Walk(NamedTuple):
    """A simulated walk to the ball, in mm, with one row for each footstep cycle.

    `draws` are uniform in [0, 1): a sighting is missing if its draw is below the dropout.
    """

    truth: NDArray[np.float64]
    Z: NDArray[np.float64]
    U: NDArray[np.float64]
    draws: NDArray[np.float64]


def simulated_walk(rng: np.random.Generator | int | None = 0) -> Walk:
    """Return a walk of 60 cycles: 15 footsteps, 15 cycles at rest, and both again.

    Parameters
    ----------
    rng : numpy.random.Generator or int
        Source of the noise; the explorer uses the seed 0.

    Returns
    -------
    Walk
        ``truth`` (60,), ``Z`` (60, 1), ``U`` (60, 1) with 1 for a footstep, ``draws`` (60,).

    References
    ----------
    Thesis, equations 2.49 to 2.52, with A = H = 1.

    Examples
    --------
    >>> walk = simulated_walk()
    >>> len(walk.truth), int(walk.U.sum())
    (60, 30)
    """
    rng = np.random.default_rng(rng)
    U = np.repeat([1.0, 0.0, 1.0, 0.0], 15)
    start = START + START_NOISE * rng.standard_normal()
    truth = start + np.cumsum(STEP * U + STEP_NOISE * rng.standard_normal(len(U)))
    Z = truth + SIGHTING_NOISE * rng.standard_normal(len(U))
    return Walk(truth, Z[:, np.newaxis], U[:, np.newaxis], rng.random(len(U)))


def walk_filter(r: float, q: float) -> KalmanFilter:
    """Return a filter for the simulated walk that assumes these standard deviations.

    Parameters
    ----------
    r, q : float
        Of a sighting and of a footstep, in mm, at least 0: R is r**2 and Q is q**2.

    Returns
    -------
    KalmanFilter
        With the footsteps as ``B`` and the true variance of the start as ``P0``.

    Raises
    ------
    ValueError
        If `r` or `q` is negative.

    Examples
    --------
    >>> walk_filter(r=100.0, q=25.0).R
    array([[10000.]])
    """
    r, q = _checks.number("r", r, 0), _checks.number("q", q, 0)
    return KalmanFilter(
        [[1]], [[1]], [[q**2]], [[r**2]], [[STEP]], x0=[START], P0=[[START_NOISE**2]]
    )


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
    # The true value is a stop of both sliders: a browser moves a value between two stops.
    powers: dict[str, Any] = {"base": 10, "step": 0.05} | wide()
    r, q = (np.log10([sigma / 10, sigma * 10]) for sigma in (SIGHTING_NOISE, STEP_NOISE))
    return Explorer(
        partial(draw, simulated_walk()),
        r=ipywidgets.FloatLogSlider(
            10.0, min=r[0], max=r[1], readout_format=".0f", description="sigma of R (mm)", **powers
        ),
        q=ipywidgets.FloatLogSlider(
            25.0, min=q[0], max=q[1], readout_format=".1f", description="sigma of Q (mm)", **powers
        ),
        dropout=ipywidgets.FloatSlider(
            0.0, min=0, max=0.9, step=0.1, readout_format=".0%", description="dropout", **wide()
        ),
    )


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
    dropout = round(dropout, 3)  # a slider's steps add up to 0.30000000000000004
    Z = np.where(walk.draws[:, np.newaxis] < dropout, np.nan, walk.Z)
    trace = walk_filter(r, q).filter(Z, walk.U)
    mean, low, high = trace.nis_band()
    ours, theirs = _rms(trace.x[:, 0] - walk.truth), _rms(Z[:, 0] - walk.truth)
    fact = (
        f"mean NIS {mean:.2f} where {low:.2f} to {high:.2f} is right; "
        f"estimate {ours:.0f} mm off, sightings {theirs:.0f} mm"
    )
    told = f"R = ({r:.0f} mm)², Q = ({q:.3g} mm)², {np.isnan(Z).sum()} of {len(Z)} missing"
    return Scene(fact, [_track(walk, Z, trace, told), _nis(trace)])


def _rms(errors: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.nanmean(errors**2)))


def _track(walk: Walk, Z: NDArray[np.float64], trace: KalmanTrace, told: str) -> Panel:
    k = np.arange(len(Z), dtype=float)
    x, sigma = trace.x[:, 0], np.sqrt(trace.P[:, 0, 0])
    seen = trace.accepted
    layers: list[Layer] = [
        between(k, x - sigma, x + sigma, (*_CYCLES, *_DISTANCES), _ONE_SIGMA),
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
        between(n, np.clip(low, *_NIS), high, (*ends, *_NIS), _RIGHT),
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
