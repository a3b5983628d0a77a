"""Figures 2.22 and 2.23, and the plots of the chapter on the Kalman filter.

References
----------
Thesis, section 2.5.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_22(Figure().subplots())
Kalman filter model: x_k = A x_k-1 + B u_k-1 + w, seen as z_k = H x_k + v
"""

from __future__ import annotations

import copy

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.kalman import KalmanFilter, KalmanTrace

# Marker, its size, and the distance from its center at which an arrow ends, in points.
_SHAPES = {"vector": ("o", 40, 21), "matrix": ("s", 32, 19), "noise": ("*", 54, 15),
           "sum": ("o", 17, 9)}  # fmt: skip

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
    ax = _canvas(ax, "Kalman filter model: x_k = A x_k-1 + B u_k-1 + w, seen as z_k = H x_k + v")
    ax.set(xlim=(-0.7, 10.9), ylim=(-2.4, 2.3))
    ax.axvline(6.1, color=style.QUIET, linewidth=1, linestyle=":")
    for x, words, side in ((5.95, "hidden in the world", "right"), (6.25, "the sensor", "left")):
        ax.text(x, 2.05, words, ha=side, color=style.QUIET)
    arrows = {}
    for start, end in FLOW:
        one, other = MODEL[start], MODEL[end]
        reaches = _SHAPES[one[1]][2], _SHAPES[other[1]][2]
        arrows[start, end] = _arrow(ax, one[2], other[2], *reaches)
    nodes = {}
    for name, (words, kind, (x, y)) in MODEL.items():
        marker, size, _ = _SHAPES[kind]
        ax.plot(x, y, marker, ms=size, mfc=style.CELLS[0], mec=style.INK)
        nodes[name] = ax.text(x, y - 0.03, words, ha="center", va="center", color=style.INK)
    for noise, covariance in (("w", "$Q$"), ("v", "$R$")):
        x, y = MODEL[noise][2]
        ax.text(x + 0.55, y - 0.4, covariance, ha="center", va="center", color=style.INK)
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
    ax = _canvas(ax, "Kalman filter cycle: predict, then correct by what is seen, and again")
    ax.set(xlim=(-0.3, 11.3), ylim=(-2.4, 2.3))
    places = {"predict": (2.3, 0.0), "correct": (8.0, 0.0)}
    half = {"predict": 1.9, "correct": 2.6}
    nodes = {}
    for name, equations in CYCLE.items():
        x, y = places[name]
        left, right = x - half[name], x + half[name]
        ax.fill_between([left, right], y - 1.1, y + 1.1, fc=style.CELLS[0], ec=style.INK)
        ax.text(x, y + 0.78, name, ha="center", va="center", weight="bold", color=style.INK)
        words = "\n".join(equations)
        nodes[name] = ax.text(
            x, y - 0.25, words, ha="center", va="center", linespacing=2.2, fontsize=10,
            color=style.INK,
        )  # fmt: skip
    out, back = places["predict"][0] + half["predict"], places["correct"][0] - half["correct"]
    arrows = {
        ("predict", "correct"): _arrow(ax, (out, 0.6), (back, 0.6)),
        ("correct", "predict"): _arrow(ax, (back, -0.6), (out, -0.6)),
    }
    ax.text((out + back) / 2, -0.85, r"$k \to k+1$", ha="center", va="top", color=style.INK)
    inputs = {
        "x_0, P_0": (r"start: $\hat{x}_0,\ P_0$", (1.2, 2.0), "predict"),
        "u": (r"action: $u_{k-1}$", (3.4, 2.0), "predict"),
        "z": (r"sighting: $z_k$", (8.0, 2.0), "correct"),
        "x, P": (r"estimate: $\hat{x}_k,\ P_k$", (8.0, -2.1), None),
    }
    for name, (words, (x, y), into) in inputs.items():
        nodes[name] = ax.text(x, y, words, ha="center", va="center", color=style.INK)
        if into:
            arrows[name, into] = _arrow(ax, (x, 1.75), (x, 1.1))
        else:
            arrows["correct", name] = _arrow(ax, (x, -1.1), (x, -1.85))
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
    ax = style.axes(
        ax, xlabel="ball distance (mm)", ylabel="density (1/mm)",
        title=f"{words['predicted']}, {words['seen']}: {words['corrected']}",
    )  # fmt: skip
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
        ax.annotate(
            name, (mean, density.max()), (0, 4), textcoords="offset points", ha="center",
            color=color, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
        )  # fmt: skip
    style.measurements([z / kf.H[0, 0]], [0.0], ax, clip_on=False, zorder=5)
    ax.fill_between(x, curves["corrected"].get_ydata(), color=style.OURS, alpha=0.25, lw=0)
    ax.set(xlim=(low, high), ylim=(0, None), yticks=[])
    return Plot(ax, curves=curves)


def plot_track(
    truth: ArrayLike,
    Z: ArrayLike,
    trace: KalmanTrace,
    ax: Axes | None = None,
    *,
    axis: int = 0,
    title: str = "",
) -> Plot:
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
    return Plot(
        ax, f"a track of {T} looks", truth=line, sightings=marks, estimate=estimate, band=area
    )


def _canvas(ax: Axes | None, title: str) -> Axes:
    if ax is None:
        _, ax = plt.subplots(figsize=(8.4, 3.6), layout="constrained")
    style.axes(ax, title=title)
    ax.axis("off")
    return ax


def _arrow(
    ax: Axes,
    start: tuple[float, float],
    end: tuple[float, float],
    leave: float = 0.0,
    reach: float = 1.0,
) -> Annotation:
    look = {"arrowstyle": "-|>", "shrinkA": leave, "shrinkB": reach, "color": style.INK}
    return ax.annotate("", end, start, arrowprops=look)
