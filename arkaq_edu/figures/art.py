"""Figures 2.18 to 2.21: the networks of adaptive resonance, and pictures of them at work.

References
----------
Thesis, section 2.4.
G. A. Carpenter, S. Grossberg, ART 2: self-organization of stable category recognition codes for
analog input patterns, Applied Optics 26 (1987) 4919-4930, where figures 2.20 and 2.21 come from.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_21(Figure().subplots())
once learned, vigilance 0.95 resets a cosine below 0.76 (c = 0.1, d = 0.9)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.patches import Circle, Rectangle
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.art.reset import COSINES, learned_norm, match_norm, reset_fact
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import blank, box, frame, node, wire, words, write
from arkaq_edu.figures.drawing.plot import Plot

# Diagrams


def figure_2_18(ax: Axes | None = None) -> Plot:
    """Draw figure 2.18, the two layers of an ART network and the traces between them."""
    title = "ART: every node of F1 is joined with every node of F2, both ways"
    ax = blank(ax, title, (-5.2, 5.5), (-1.8, 3.0))
    features = [(x, 0.0) for x in np.linspace(-2.2, 2.2, 5).tolist()]
    categories = [(x, 2.4) for x in np.linspace(-1.8, 1.8, 3).tolist()]
    for ends in product(features, categories):
        ax.plot(*zip(*ends, strict=True), color="#cccccc", linewidth=0.8, zorder=0)
    for height in (0.0, 2.4):
        box(ax, (0.0, height), width=6.0, height=0.8)
    for place in features + categories:
        ax.add_patch(Circle(place, 0.24, facecolor="white", edgecolor=style.INK))
    parts = {
        "F1": words(ax, (3.15, 0.0), "F1: features\n(short-term memory)", "left"),
        "F2": words(ax, (3.15, 2.4), "F2: categories\n(short-term memory)", "left"),
        "up": words(ax, (-2.85, 1.2), "bottom-up traces $z_{ij}$\nwhich category?", "right"),
        "down": words(ax, (2.85, 1.2), "top-down traces $z_{ji}$\nwhat does it expect?", "left"),
        "I": words(ax, (0.0, -1.5), "input pattern $I$"),
    }
    wires = {
        ("F1", "F2"): wire(ax, (-2.7, 0.4), (-2.7, 2.0)),
        ("F2", "F1"): wire(ax, (2.7, 2.0), (2.7, 0.4)),
    }
    wires |= {("I", f"F1 {i}"): wire(ax, (x, -1.2), (x, -0.4)) for i, (x, _) in enumerate(features)}
    return Plot(ax, parts=parts, wires=wires)


def figure_2_19(ax: Axes | None = None) -> Plot:
    """Draw figure 2.19, ART1: two gains, the attentional and the orienting subsystem."""
    ax = blank(ax, "ART1: attention matches, orientation resets", (-0.6, 10.0), (-0.1, 6.8))
    frame(ax, (-0.3, 1.5), 6.0, 5.1)
    frame(ax, (6.1, 1.5), 3.2, 2.4)
    parts = {
        "attentional": words(ax, (2.7, 6.25), "attentional subsystem", color=style.QUIET),
        "orienting": words(ax, (7.7, 3.5), "orienting subsystem", color=style.QUIET),
        "F2": box(ax, (4.0, 5.2), "F2 (STM)", width=2.2),
        "F1": box(ax, (4.0, 2.4), "F1 (STM)", width=2.2),
        "gain 2": box(ax, (1.2, 5.2), "gain 2"),
        "gain 1": box(ax, (1.2, 2.4), "gain 1"),
        "A": box(ax, (7.9, 2.4), r"match $<\rho$ ?", width=2.0),
        "I": box(ax, (4.0, 0.4), "input $I$", width=1.5),
        "LTM up": words(ax, (3.55, 3.8), "LTM", "right"),
        "LTM down": words(ax, (4.65, 3.8), "LTM", "left"),
        "reset": words(ax, (7.4, 5.2), "reset"),
    }
    wires = {
        ("F1", "F2"): wire(ax, (3.7, 2.75), (3.7, 4.85)),
        ("F2", "F1"): wire(ax, (4.5, 4.85), (4.5, 2.75)),
        ("gain 2", "F2"): wire(ax, (1.75, 5.2), (2.9, 5.2), sign="+"),
        ("gain 1", "F1"): wire(ax, (1.75, 2.4), (2.9, 2.4), sign="+"),
        ("F2", "gain 1"): wire(ax, (3.1, 4.85), (1.2, 2.75), sign="−"),
        ("I", "F1"): wire(ax, (4.0, 0.75), (4.0, 2.05), sign="+"),
        ("I", "gain 1"): wire(ax, (1.2, 0.4), (1.2, 2.05), sign="+"),
        ("I", "gain 2"): wire(ax, (3.25, 0.4), (0.1, 0.4), (0.1, 5.2), (0.65, 5.2), sign="+"),
        ("I", "A"): wire(ax, (4.75, 0.4), (7.9, 0.4), (7.9, 2.05), sign="+"),
        ("F1", "A"): wire(ax, (5.1, 2.4), (6.9, 2.4), sign="−"),
        ("A", "F2"): wire(ax, (8.9, 2.4), (9.7, 2.4), (9.7, 5.2), (5.1, 5.2)),
    }
    return Plot(ax, parts=parts, wires=wires)


def figure_2_20(ax: Axes | None = None) -> Plot:
    """Draw figure 2.20, ART2: the loops of F1 between the input and F2, and the reset."""
    ax = blank(ax, "ART2: the loops of F1; black dots divide by norms", (-5.2, 3.8), (-1.6, 6.1))
    places = {
        "w": (0.0, 0.0), "x": (2.6, 0.0), "u": (0.0, 1.8), "v": (2.6, 1.8), "p": (0.0, 3.6),
        "q": (2.6, 3.6), "r": (-2.6, 2.7),
    }  # fmt: skip
    parts = {name: node(ax, place, f"${name}_i$") for name, place in places.items()}
    parts |= {
        "y": box(ax, (1.3, 5.6), "F2: node $y_J$", width=3.6),
        "I": words(ax, (0.0, -1.35), "$I_i$"),
        "au": words(ax, (-0.15, 0.9), "$a u_i$", "right"),
        "fx": words(ax, (2.75, 0.9), "$f(x_i)$", "left"),
        "fq": words(ax, (2.75, 2.7), "$b f(q_i)$", "left"),
        "up": words(ax, (-0.25, 4.6), "$z_{ij}$", "right"),
        "down": words(ax, (0.25, 4.6), "$d z_{Ji}$", "left"),
        "cp": words(ax, (-1.15, 3.5), "$c p_i$", "right"),
        "reset": words(ax, (-2.75, 4.3), r"reset if $\|r\| < \rho$", "right"),
    }
    wires = {
        ("I", "w"): wire(ax, (0.0, -1.1), (0.0, -0.34)),
        ("w", "x"): wire(ax, (0.34, 0.0), (2.26, 0.0), norm=True),
        ("x", "v"): wire(ax, (2.6, 0.34), (2.6, 1.46)),
        ("v", "u"): wire(ax, (2.26, 1.8), (0.34, 1.8), norm=True),
        ("u", "w"): wire(ax, (0.0, 1.46), (0.0, 0.34)),
        ("u", "p"): wire(ax, (0.0, 2.14), (0.0, 3.26)),
        ("p", "q"): wire(ax, (0.34, 3.6), (2.26, 3.6), norm=True),
        ("q", "v"): wire(ax, (2.6, 3.26), (2.6, 2.14)),
        ("p", "y"): wire(ax, (-0.12, 3.92), (-0.12, 5.25)),
        ("y", "p"): wire(ax, (0.12, 5.25), (0.12, 3.92)),
        ("u", "r"): wire(ax, (-0.32, 1.91), (-2.28, 2.59), norm=True),
        ("p", "r"): wire(ax, (-0.32, 3.49), (-2.28, 2.81), norm=True),
        ("r", "y"): wire(ax, (-2.6, 3.04), (-2.6, 5.6), (-0.5, 5.6)),
    }
    return Plot(ax, parts=parts, wires=wires)


# The reset


def figure_2_21(
    ax: Axes | None = None, *, c: float = 0.1, d: float = 0.9, vigilance: float = 0.95
) -> Plot:
    """Draw figure 2.21, what the orienting subsystem sees while a category learns (eq 2.47).

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    c, d : float in (0, 1)
        As in `arkaq_edu.art.ART2`; the thesis gives neither.
    vigilance : float in (0, 1)
        A smaller norm of r is a reset.

    Returns
    -------
    Plot
        ``curves``, by cosine, and ``vigilance``, the line of resets.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_21(Figure().subplots())
    >>> float(plot.curves[0.0].get_ydata().min().round(3))
    0.746
    """
    xlabel = r"$\|c\,d\,z_J\|$, from an uncommitted node to one that has learned all"
    ax = style.axes(ax, xlabel=xlabel, ylabel=r"$\|r\|$", title=reset_fact(c, d, vigilance))
    cdz = np.linspace(0, learned_norm(c, d), 101)
    curves = {}
    for cosine in COSINES:
        norm_r = match_norm(cosine, cdz, c)
        (curves[cosine],) = ax.plot(cdz, norm_r, color=style.INK, linewidth=1.3)
        name = r"$\cos(u, z_J)$ = 1" if cosine == 1 else f"{cosine:g}"
        style.tag(ax, (cdz[-1], norm_r[-1]), name, (5, 0), fontsize=9)
    line = ax.axhline(vigilance, color=style.OURS, linestyle="--")
    write(
        ax, (0.03, 0.05), "reset below the dashed line", ha="left", va="baseline",
        color=style.OURS, transform=ax.transAxes,
    )  # fmt: skip
    ax.set(xlim=(0, cdz[-1]), ylim=(0.7, 1.02))
    return Plot(ax, curves=curves, vigilance=line)


# Networks at work


def plot_letters(
    patterns: ArrayLike, names: Sequence[str] = (), ax: Axes | None = None, *, columns: int = 5,
    title: str = "",
) -> Plot:  # fmt: skip
    """Draw binary patterns side by side, each as a grid of points.

    Parameters
    ----------
    patterns : array_like, shape (n, m)
        Zeros and ones, row by row from the top of each grid.
    names : sequence of n str, optional
        A caption for each grid.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    columns : int
        Width of a grid, a divisor of m.
    title : str
        What the picture states.

    Returns
    -------
    Plot
        ``grids``, the filled points of each, and ``words``, the captions.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from arkaq_edu.art import LETTERS
    >>> plot_letters([LETTERS["L"], LETTERS["T"]], "LT", Figure().subplots())
    2 grids
    """
    patterns = _checks.array("patterns", patterns, (None, None)) > 0
    grids = [(pattern, np.zeros_like(pattern)) for pattern in patterns]
    return _grids(ax, title, grids, names, 1.4 if len(names) else 0.3, columns)


def plot_search(
    trace: pd.DataFrame, names: Mapping[int, str] | None = None, ax: Axes | None = None
) -> Plot:
    """Draw the search of ART1 for one pattern, step by step: the activity of F1, and the outcome.

    Filled points are active in F1. Crosses mark inputs that the expectation has switched off.

    Parameters
    ----------
    trace : DataFrame
        What `arkaq_edu.art.ART1.trace` returns.
    names : mapping of int to str, optional
        Names for the nodes of F2.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    Plot
        ``grids``, the activity of F1 at each step, and ``words``, the captions.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from arkaq_edu.art import ART1, LETTERS
    >>> network = ART1(0.8).fit([LETTERS["L"], LETTERS["T"]])
    >>> plot_search(network.trace(LETTERS["I"]), ax=Figure().subplots())
    0 resets, then node 1 is in resonance
    """
    grids, captions = [], []
    for _, step in trace.groupby("step"):
        active = step["activity"].to_numpy() > 0
        grids.append((active, (step["input"].to_numpy() > 0) & ~active))
        first = step.iloc[0]
        who = (names or {}).get(first["node"], f"node {first['node']}")
        end = "reset" if first["reset"] else "resonance"
        captions.append(f"{who}\nmatch {first['match']:.2f}\n{end}")
    captions[0] = "input alone"
    resets = sum(caption.endswith("reset") for caption in captions)
    end = "no node is left" if len(grids) == 1 else f"{who} is in resonance"
    title = f"{resets} reset{'' if resets == 1 else 's'}, then {end}"
    return _grids(ax, title, grids, captions, below=3.2)


def _grids(
    ax: Axes | None, title: str, grids: Sequence[tuple[NDArray[np.bool_], NDArray[np.bool_]]],
    captions: Sequence[str], below: float, columns: int = 5,
) -> Plot:  # fmt: skip
    """Draw grids side by side: filled points for the first array, crosses for the second."""
    m = len(grids[0][0])
    if m % columns:
        raise ValueError(f"columns must divide the {m} points of a pattern, got {columns}")
    pitch, rows = columns + 1.5, m // columns
    width = len(grids) * pitch - 1.2
    ax = blank(ax, title, (-0.3, width), (-below, rows + 0.3), inch=min(0.25, 9 / width))
    points = np.array([(i % columns, rows - 1 - i // columns) for i in range(m)])
    for k, (active, lost) in enumerate(grids):
        corners = points + np.array([k * pitch, 0])
        squares = PatchCollection([Rectangle(tuple(corner), 1, 1) for corner in corners])
        colors = [style.INK if on else "white" for on in active]
        squares.set(facecolors=colors, edgecolors="#bbbbbb", linewidths=0.6)
        ax.add_collection(squares)
        ax.plot(*(corners[lost] + 0.5).T, "x", color=style.OURS, markersize=6, markeredgewidth=1.6)
    texts = [
        write(ax, (k * pitch + columns / 2, -0.4), caption, va="top")
        for k, caption in enumerate(captions)
    ]
    return Plot(ax, f"{len(grids)} grids", grids=[active for active, _ in grids], words=texts)


def plot_settling(trace: pd.DataFrame, theta: float, ax: Axes | None = None) -> Plot:
    """Draw the activity `u` of each feature while the loops of ART2's F1 settle.

    Parameters
    ----------
    trace : DataFrame
        What `arkaq_edu.art.ART2.trace` returns.
    theta : float
        The noise threshold.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    Plot
        ``lines``, one for each feature.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from arkaq_edu.art import ART2
    >>> network = ART2(0.9, theta=0.3).fit([[0, 0, 1.0]])
    >>> plot_settling(network.trace([1.0, 0.2, 0.0]), 0.3, Figure().subplots())
    1 of 2 active features is above theta
    """
    u = trace.pivot(index="step", columns="feature", values="u").to_numpy()
    given = trace["input"][trace["step"] == 0].to_numpy()
    left, active = (u[-1] >= theta).sum(), (given > 0).sum()
    title = f"{left} of {active} active features {'is' if left == 1 else 'are'} above theta"
    ax = style.axes(ax, xlabel="cycle of F1", ylabel="activity u", title=title)
    # Before the first cycle there is only the input.
    lines = ax.plot(np.vstack([given, u]), "-o", color=style.INK, markersize=3)
    style.measurements(np.zeros(len(given)), given, ax, markersize=7)
    ax.axhline(theta, color=style.QUIET, linestyle=":", linewidth=1)
    style.tag(ax, (len(u), theta), "theta", (5, 0), color=style.QUIET, fontsize=9)
    node = trace.groupby("step")["node"].first()
    for step in node.index[node.diff().fillna(0) != 0]:
        ax.axvline(step + 0.5, color=style.OURS, linestyle="--", linewidth=1)
        aside = -4 if step > len(u) / 2 else 4
        look = {"va": "center", "color": style.OURS, "fontsize": 9}
        look["xycoords"] = ax.get_xaxis_transform()
        style.tag(ax, (step + 0.5, 1.0), f"F2 chooses node {node[step]}", (aside, -6), **look)
    ax.set(ylim=(-0.03, 1.05), xlim=(-0.3, len(u) + 0.1))
    return Plot(ax, lines=lines)
