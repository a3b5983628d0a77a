"""Figures 2.22 and 2.23, and the plots of the chapter on the Kalman filter.

References
----------
Thesis, section 2.5.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_22(Figure().subplots())
Kalman filter model: A and B move the state, noise shakes it; H shows it, with noise
"""

from __future__ import annotations

import copy

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import arrow, write
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.kalman import KalmanFilter, KalmanTrace

# Marker, its size, and the distance from its center at which an arrow ends, in points.
_SHAPES = {"vector": ("o", 40, 21), "matrix": ("s", 32, 19), "noise": ("*", 54, 15),
           "sum": ("o", 17, 9)}  # fmt: skip
_TIP = {"mutation_scale": 10, "shrinkB": 1, "zorder": 3}

#: The nodes of figure 2.22: label, kind, position.
MODEL = {
    "x before": (r"$x_{k-1}$", "vector", (0.0, 0.0)),
    "A": ("$A$", "matrix", (1.8, 0.0)),
    "u": (r"$u_{k-1}$", "vector", (0.0, -1.7)),
    "B": ("$B$", "matrix", (1.8, -1.7)),
    "w": ("$w$", "noise", (3.6, 1.5)),
    "moves": ("+", "sum", (3.6, 0.0)),
    "x": ("$x_k$", "vector", (5.2, 0.0)),
    "H": ("$H$", "matrix", (7.0, 0.0)),
    "v": ("$v$", "noise", (8.6, 1.5)),
    "is seen": ("+", "sum", (8.6, 0.0)),
    "z": ("$z_k$", "vector", (10.2, 0.0)),
}
#: Its arrows.
FLOW = [
    ("x before", "A"), ("A", "moves"), ("u", "B"), ("B", "moves"), ("w", "moves"), ("moves", "x"),
    ("x", "H"), ("H", "is seen"), ("v", "is seen"), ("is seen", "z"),
]  # fmt: skip

#: The two halves of figure 2.23: the equations of each, in order.
CYCLE = {
    "predict": [
        r"$\hat{x}_{k|k-1} = A\,\hat{x}_{k-1} + B\,u_{k-1}$",
        r"$P_{k|k-1} = A\,P_{k-1}A^T + Q$",
    ],
    "correct": [
        r"$K_k = P_{k|k-1}H^T\,(H\,P_{k|k-1}H^T + R)^{-1}$",
        r"$\hat{x}_k = \hat{x}_{k|k-1} + K_k\,(z_k - H\,\hat{x}_{k|k-1})$",
        r"$P_k = (I - K_k H)\,P_{k|k-1}$",
    ],
}


def figure_2_22(ax: Axes | None = None) -> Plot:
    """Draw figure 2.22, the system that a Kalman filter assumes.

    Circles are vectors, squares are matrices. Stars are noise, with the covariance beside them.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    Plot
        ``nodes`` and ``arrows``, by their names in `MODEL` and `FLOW`.

    References
    ----------
    Thesis, figure 2.22 and equations 2.49 to 2.52.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_22(Figure().subplots())
    >>> sorted(start for start, end in plot.arrows if end == "moves")
    ['A', 'B', 'w']
    """
    title = "Kalman filter model: A and B move the state, noise shakes it; H shows it, with noise"
    ax = _canvas(ax, title, (-0.7, 10.9))
    ax.axvline(6.1, color=style.QUIET, linewidth=1, linestyle=":")
    for x, words, side in ((5.95, "hidden in the world", "right"), (6.25, "the sensor", "left")):
        ax.text(x, 2.05, words, ha=side, color=style.QUIET)
    arrows, nodes = {}, {}
    for start, end in FLOW:
        (_, kind, tail), (_, other, head) = MODEL[start], MODEL[end]
        gaps = {"shrinkA": _SHAPES[kind][2], "shrinkB": _SHAPES[other][2]}
        arrows[start, end] = arrow(ax, tail, head, **(_TIP | gaps))
    for name, (words, kind, (x, y)) in MODEL.items():
        marker, size, _ = _SHAPES[kind]
        ax.plot(x, y, marker, ms=size, mfc=style.CELLS[0], mec=style.INK)
        nodes[name] = write(ax, (x, y - 0.03), words, fontsize=10)
    write(ax, (2.6, -2.3), r"$x_k = A\,x_{k-1} + B\,u_{k-1} + w$", fontsize=10)
    write(ax, (8.6, -2.3), r"$z_k = H\,x_k + v$", fontsize=10)
    for noise, covariance in (("w", "$Q$"), ("v", "$R$")):
        x, y = MODEL[noise][2]
        write(ax, (x + 0.55, y - 0.4), covariance, fontsize=10)
    return Plot(ax, nodes=nodes, arrows=arrows)


def figure_2_23(ax: Axes | None = None) -> Plot:
    """Draw figure 2.23, the cycle of the filter: predict, correct, repeat.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    Plot
        ``nodes`` "predict" and "correct" with the equations; ``arrows``.

    References
    ----------
    Thesis, figure 2.23 and equations 2.55 to 2.59.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_23(Figure().subplots())
    >>> plot.nodes["correct"].get_text().count("=")
    3
    """
    title = "Kalman filter cycle: predict, then correct by what is seen, and again"
    ax = _canvas(ax, title, (-0.3, 11.3))
    nodes = {}
    for name, x, half in (("predict", 2.3, 1.9), ("correct", 8.0, 2.6)):
        ax.fill_between([x - half, x + half], -1.1, 1.1, fc=style.CELLS[0], ec=style.INK)
        write(ax, (x, 0.78), name, weight="bold", fontsize=10)
        nodes[name] = write(ax, (x, -0.25), "\n".join(CYCLE[name]), linespacing=2.2, fontsize=10)
    out, back = 2.3 + 1.9, 8.0 - 2.6
    arrows = {
        ("predict", "correct"): arrow(ax, (out, 0.6), (back, 0.6), **_TIP),
        ("correct", "predict"): arrow(ax, (back, -0.6), (out, -0.6), **_TIP),
        ("correct", "x, P"): arrow(ax, (8.0, -1.1), (8.0, -1.85), **_TIP),
    }
    for name, words, x, into in (
        ("x_0, P_0", r"start: $\hat{x}_0,\ P_0$", 1.2, "predict"),
        ("u", r"action: $u_{k-1}$", 3.4, "predict"),
        ("z", r"sighting: $z_k$", 8.0, "correct"),
    ):
        nodes[name] = write(ax, (x, 2.0), words, fontsize=10)
        arrows[name, into] = arrow(ax, (x, 1.75), (x, 1.1), **_TIP)
    nodes["x, P"] = write(ax, (8.0, -2.1), r"estimate: $\hat{x}_k,\ P_k$", fontsize=10)
    write(ax, ((out + back) / 2, -0.85), r"$k \to k+1$", va="top", fontsize=10)
    return Plot(ax, nodes=nodes, arrows=arrows)


def plot_predict_correct(
    kf: KalmanFilter, z: float, u: ArrayLike | None = None, ax: Axes | None = None
) -> Plot:
    """Draw one predict and update of a scalar filter as densities; the filter does not change.

    Parameters
    ----------
    kf : KalmanFilter
        One state, one measurement, before the predict.
    z : float
        The sighting.
    u : array_like, shape (k,), optional
        Control input of the predict.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    Plot
        ``curves``: "before", "predicted", "seen", "corrected".

    Raises
    ------
    ValueError
        If the filter has more than one state or measurement, or `z` is not finite.

    References
    ----------
    Thesis, equations 2.55 to 2.59.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ruler = KalmanFilter([[1]], [[1]], Q=[[0]], R=[[4]], x0=[10], P0=[[4]])
    >>> plot_predict_correct(ruler, 12.0, ax=Figure().subplots())
    predicted 10 ± 2, seen 12 ± 2: corrected 11 ± 1.41
    """
    if kf.H.shape != (1, 1):
        raise ValueError(f"kf must have one state and one measurement, got {kf!r}")
    z = _checks.number("z", z)
    kf = copy.deepcopy(kf)
    found = {"before": (kf.x[0], kf.P[0, 0])}
    kf.predict(u)
    found["predicted"] = kf.x[0], kf.P[0, 0]
    found["seen"] = z / kf.H[0, 0], kf.R[0, 0] / kf.H[0, 0] ** 2
    kf.update([z])
    found["corrected"] = kf.x[0], kf.P[0, 0]

    spread = {name: (mean, np.sqrt(variance)) for name, (mean, variance) in found.items()}
    words = {name: f"{name} {m:.0f} ± {s:.3g}" for name, (m, s) in spread.items()}
    title = f"{words['predicted']}, {words['seen']}: {words['corrected']}"
    ax = style.axes(ax, xlabel="ball distance (mm)", ylabel="density (1/mm)", title=title)
    low = min(mean - 3.2 * sigma for mean, sigma in spread.values())
    high = max(mean + 3.2 * sigma for mean, sigma in spread.values())
    x = np.linspace(low, high, 401)
    look = {
        "before": (style.QUIET, ":", 1.2), "predicted": (style.INK, "--", 1.5),
        "seen": (style.INK, "-", 1.2), "corrected": (style.OURS, "-", 2.2),
    }  # fmt: skip
    curves = {}
    for name, (mean, sigma) in spread.items():
        color, dash, width = look[name]
        density = np.exp(-(((x - mean) / sigma) ** 2) / 2) / (sigma * np.sqrt(2 * np.pi))
        (curves[name],) = ax.plot(x, density, dash, color=color, linewidth=width)
        ground = style.white(0.5, 0.8)
        style.tag(ax, (mean, density.max()), name, (0, 4), va="baseline", color=color, bbox=ground)
    style.measurements([z / kf.H[0, 0]], [0.0], ax, clip_on=False, zorder=5)
    ax.fill_between(x, curves["corrected"].get_ydata(), color=style.OURS, alpha=0.25, lw=0)
    ax.set(xlim=(low, high), ylim=(0, None), yticks=[])
    return Plot(ax, curves=curves)


def plot_track(
    truth: ArrayLike, Z: ArrayLike, trace: KalmanTrace, ax: Axes | None = None, *, axis: int = 0,
    title: str = "",
) -> Plot:  # fmt: skip
    """Draw the truth, the sightings and the estimate along a track.

    Parameters
    ----------
    truth : array_like, shape (T,)
        The true value of the measured number.
    Z : array_like, shape (T, m)
        The sightings; NaN where there was none.
    trace : KalmanTrace
        The result of the filter.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    axis : int
        Which state and measurement: 0 the distance (mm), 1 the orientation (rad).
    title : str
        Title of the plot.

    Returns
    -------
    Plot
        ``truth``, ``sightings``, ``estimate`` and ``band``.

    Raises
    ------
    ValueError
        If the lengths differ.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[1]])
    >>> plot = plot_track([0, 0], [[1], [1]], kf.filter([[1], [1]]), Figure().subplots())
    >>> plot.estimate.get_ydata().round(2)
    array([0.5 , 0.67])
    """
    T = len(trace.x)
    truth, Z = _checks.array("truth", truth, (T,)), _checks.array("Z", Z, (T, None), allow_nan=True)
    ylabel = ("distance (mm)", "orientation (rad)")[axis]
    ax = style.axes(ax, xlabel="footstep cycle", ylabel=ylabel, title=title)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, steps=[1, 2, 5, 10]))
    k = np.arange(T)
    std = np.sqrt(trace.P[:, axis, axis])
    label = "estimate, one sigma each side"
    estimate, area = style.band(k, trace.x[:, axis], std, ax, label=label)
    (line,) = ax.plot(k, truth, color=style.INK, linewidth=1.2, label="truth")
    marks = style.measurements(k, Z[:, axis], ax, markersize=4, label="sighting")
    ax.legend(frameon=False)
    fact = f"a track of {T} looks"
    return Plot(ax, fact, truth=line, sightings=marks, estimate=estimate, band=area)


def _canvas(ax: Axes | None, title: str, xlim: tuple[float, float]) -> Axes:
    ax = style.axes(ax, title=title, size=(8.4, 3.6))
    ax.axis("off")
    ax.set(xlim=xlim, ylim=(-2.4, 2.3))
    return ax
