"""Figures 2.9 to 2.12 and 2.14 to 2.17: policy trees, and value functions over beliefs.

References
----------
Thesis, sections 2.3.4 to 2.3.6.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_16(Figure().subplots())
b = [.25 .75]: a1 earns 0.25, a2 1.125; a1 is better for p(s1) > .6, on the right
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Rectangle
from matplotlib.text import Text
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Diagram, blank, wire, words
from arkaq_edu.pomdp import (
    POMDP,
    Domination,
    PolicyTree,
    ValueFunction,
    dominated,
    problem,
    prune,
    solve_pomdp,
    tree_value,
)
from arkaq_edu.pomdp.simplex import CORNERS as TRIANGLE

Floats = NDArray[np.float64]

#: The color of each action of the course's problems.
COLORS = {
    name: style.ACTIONS[like]
    for like, names in {
        "forward": ("a1", "down", "listen", "step-ahead"),
        "left": ("a2", "left", "open-left", "step-left", "turn-left", "up"),
        "right": ("open-right", "right", "step-right", "turn-right"),
        "kick": ("look",),
    }.items()
    for name in names
}

#: The plans of figure 2.17, two steps of the problem "two_state": the first action, and the actions
#: after z1, z2 and z3.
PLANS = {"a": (0, (0, 1, 1)), "b": (1, (0, 1, 1)), "c": (0, (0, 0, 1)), "d": (0, (0, 1, 0))}

#: Where the corners of the triangle of beliefs stand, each 1 from its middle.
CORNERS = np.sqrt(3) * (TRIANGLE - TRIANGLE.mean(axis=0))
_RISE, _DROP = 0.8, 0.85  # of the bowl, and from its lowest point to the floor


class SurfacePlot(NamedTuple):
    """What a value function over two states is drawn of."""

    ax: Axes
    lines: dict[str, Line2D]
    surface: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class ProjectionPlot(NamedTuple):
    """What `figure_2_12` drew: the surface, and below it the interval of each plan."""

    ax: Axes
    surface: Line2D
    intervals: dict[str, Rectangle]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class DominationPlot(NamedTuple):
    """What `figure_2_17` drew, and what `dominated` found of it."""

    ax: Axes
    lines: dict[str, Line2D]
    mixture: Line2D
    found: list[Domination]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class BowlPlot(NamedTuple):
    """What `figure_2_11` drew: the faces of the bowl, and their shadows on the triangle."""

    ax: Axes
    faces: PolyCollection
    shadows: PolyCollection

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class Bowl(NamedTuple):
    """A value function over three states, as it is seen from somewhere.

    Attributes
    ----------
    plans : ndarray of int, shape (n,)
        The plan of each face, in the order in which they are to be drawn: the farthest first.
    faces, shadows : list of ndarray, shape (m, 2)
        Each face on the picture, and what lies below it on the triangle of beliefs.
    slopes : ndarray, shape (n, 2)
        How steep each face is, in value, across the triangle.
    heights : tuple of two float
        The lowest and the highest value.
    corners : ndarray, shape (3, 2, 2)
        Of each state: its corner of the triangle, and the bowl's above it.
    """

    plans: NDArray[np.intp]
    faces: list[Floats]
    shadows: list[Floats]
    slopes: Floats
    heights: tuple[float, float]
    corners: Floats


@lru_cache(maxsize=32)
def solved(name: str, horizon: int) -> ValueFunction:
    """Return the value function of one of the course's problems; it is solved once.

    Examples
    --------
    >>> [len(solved("two_state", horizon)) for horizon in (1, 2, 3)]
    [2, 4, 7]
    """
    return solve_pomdp(problem(name), horizon)


def upper_surface(alphas: ArrayLike) -> tuple[NDArray[np.intp], Floats]:
    """Return which lines over two states form their upper surface, and where each begins and ends.

    Parameters
    ----------
    alphas : array_like, shape (K, 2)
        The vectors.

    Returns
    -------
    plans : ndarray of int, shape (n,)
        The rows of `alphas` on the surface, from p(s1) = 0 to 1.
    ends : ndarray, shape (n + 1,)
        The p(s1) between them; the first is 0, the last 1.

    Examples
    --------
    >>> plans, ends = upper_surface([[1, 0], [0, 1.5], [0.2, 0.3]])
    >>> plans, ends
    (array([1, 0]), array([0. , 0.6, 1. ]))
    """
    A = _checks.array("alphas", alphas, (None, 2))
    slope = A[:, 0] - A[:, 1]
    needed = prune(A)
    plans = needed[np.argsort(slope[needed])]
    foot, rise = A[plans, 1], slope[plans]
    inner = (foot[:-1] - foot[1:]) / (rise[1:] - rise[:-1])
    return plans, np.concatenate([[0.0], inner, [1.0]])


def surface_line(alphas: ArrayLike) -> tuple[Floats, Floats]:
    """Return the corners of the upper surface over two states: p(s1), and the value there.

    Examples
    --------
    >>> surface_line([[1, 0], [0, 1.5]])
    (array([0. , 0.6, 1. ]), array([1.5, 0.6, 1. ]))
    """
    A = np.asarray(alphas, dtype=float)
    _, ends = upper_surface(A)
    return ends, (np.column_stack([ends, 1 - ends]) @ A.T).max(axis=1)


def figure_2_9(
    ax: Axes | None = None, *, tree: PolicyTree | None = None, pomdp: POMDP | None = None
) -> Diagram:
    """Draw figure 2.9, a policy tree: an action, and for each observation what follows.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    tree : PolicyTree, optional
        The plan; by default the best of three steps for `pomdp`, when all states are alike.
    pomdp : POMDP, optional
        Where the names come from; the problem "two_state" where it is None.

    Returns
    -------
    Diagram
        ``parts`` by the observations that lead to them, "" being the root; ``wires``.

    References
    ----------
    Thesis, section 2.3.4 and figure 2.9.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_9(Figure().subplots())
    >>> plot
    a policy tree of 3 steps: 13 nodes, an action in each
    >>> plot.parts[""].get_text(), plot.parts["z1 z3"].get_text()
    ('a2', 'a2')
    """
    pomdp = problem("two_state") if pomdp is None else pomdp
    if tree is None:
        V = solve_pomdp(pomdp, 3)
        tree = V.tree(V.best(pomdp.start))
    places, plans = _grown(tree, pomdp)
    width = max(x for x, _ in places.values())
    title = f"a policy tree of {tree.depth} steps: {len(plans)} nodes, an action in each"
    limits = (-0.9, max(width, 4.5) + 0.6), (-1.5 * (tree.depth - 1) - 0.5, 0.5)
    ax = blank(ax, title, *limits, inch=0.9)
    parts, wires = {}, {}
    for name, (x, y) in places.items():
        parts[name] = _action(ax, (x, y), pomdp.actions[plans[name].action])
        if name:
            before, _, seen = name.rpartition(" ")
            start = places[before]
            wires[before, name] = wire(ax, (start[0], start[1] - 0.22), (x, y + 0.22))
            words(ax, ((start[0] + 2 * x) / 3, (start[1] + 2 * y) / 3), seen)
    for step in range(tree.depth):
        left = tree.depth - step
        ax.text(-0.9, -1.5 * step, f"{left} to go", va="center", color=style.QUIET, fontsize=9)
    return Diagram(ax, parts, wires)


def _grown(
    tree: PolicyTree, pomdp: POMDP
) -> tuple[dict[str, tuple[float, float]], dict[str, PolicyTree]]:
    """Return the place and the plan of every node, by the observations on the way to it."""
    places: dict[str, tuple[float, float]] = {}
    plans: dict[str, PolicyTree] = {}
    leaves = 0

    def grow(name: str, plan: PolicyTree, y: float) -> float:
        nonlocal leaves
        plans[name] = plan
        below = [
            grow(f"{name} {seen}".strip(), branch, y - 1.5)
            for seen, branch in zip(pomdp.observations, plan.branches, strict=False)
        ]
        x = float(np.mean(below)) if below else 0.3 + leaves
        leaves += not below
        places[name] = x, y
        return x

    grow("", tree, 0.0)
    return places, plans


def _action(ax: Axes, place: tuple[float, float], name: str) -> Text:
    color = COLORS.get(name, style.QUIET)
    dark = np.dot(to_rgb(color), [0.3, 0.6, 0.1]) < 0.5
    box = {"boxstyle": "round,pad=0.35", "facecolor": color, "edgecolor": "white"}
    return ax.text(
        *place, name, ha="center", va="center", fontsize=9, bbox=box,
        color="white" if dark else style.INK,
    )  # fmt: skip


def plot_surface(
    V: ValueFunction,
    pomdp: POMDP,
    ax: Axes | None = None,
    *,
    ylim: tuple[float, float] | None = None,
    title: str = "",
) -> SurfacePlot:
    """Draw a value function over two states: every plan a line, their upper surface bold.

    Parameters
    ----------
    V : ValueFunction
        Over two states.
    pomdp : POMDP
        Where the names come from.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    ylim : tuple of two float, optional
        Ends of the axis of values.
    title : str
        What the picture states.

    Returns
    -------
    SurfacePlot
        ``lines`` "p1", "p2", ... from left to right on the surface, and the ``surface``.

    Raises
    ------
    ValueError
        If there are not two states.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_surface(solved("two_state", 2), problem("two_state"), Figure().subplots())
    >>> list(plot.lines)
    ['p1', 'p2', 'p3', 'p4']
    """
    plans, ends = upper_surface(V.alphas)
    ax = _belief_axes(ax, pomdp, title)
    lines, named = {}, set()
    for i, k in enumerate(plans):
        action = pomdp.actions[V.actions[k]]
        label = "_" if action in named else f"first {action}"
        (lines[f"p{i + 1}"],) = ax.plot(
            [0, 1], V.alphas[k][::-1], label=label, linewidth=1.2,
            color=COLORS.get(action, style.QUIET),
        )  # fmt: skip
        named.add(action)
    p, value = surface_line(V.alphas)
    surface = _surface(ax, V)
    for i, mid in enumerate((ends[:-1] + ends[1:]) / 2):
        height = np.interp(mid, p, value)
        _tag(ax, (mid, height), f"$p_{{{i + 1}}}$", (0, 7))
    ax.legend(frameon=False, fontsize=9)
    if ylim:
        ax.set_ylim(*ylim)
    return SurfacePlot(ax, lines, surface)


def figure_2_10(ax: Axes | None = None) -> SurfacePlot:
    """Draw figure 2.10: the upper surface of three policy trees, those of Tiger with a step to go.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    SurfacePlot

    References
    ----------
    Thesis, section 2.3.4 and figure 2.10. The bold line is the value function, not the policy.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_10(Figure().subplots())
    the value of the best of 3 plans: piecewise linear and convex in the belief
    """
    V = solved("tiger", 1)
    title = f"the value of the best of {len(V)} plans: piecewise linear and convex in the belief"
    return plot_surface(V, problem("tiger"), ax, ylim=(-34, 16), title=title)


def figure_2_11(
    ax: Axes | None = None, *, horizon: int = 2, azimuth: float = 46.0, elevation: float = 38.0
) -> BowlPlot:
    """Draw figure 2.11: a value function over three states, a bowl over the triangle of beliefs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    horizon : int
        Steps to go in the problem "three_places".
    azimuth, elevation : float
        From where it is seen, in degrees.

    Returns
    -------
    BowlPlot
        ``faces`` and ``shadows``, in the order of `bowl`.

    References
    ----------
    Thesis, section 2.3.4 and figure 2.11.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_11(Figure().subplots())
    7 planes make a bowl: 1.8 where nothing is known, 5.0 at the best corner
    """
    pomdp, V = problem("three_places"), solved("three_places", horizon)
    seen = bowl(V, azimuth, elevation)
    title = (
        f"{len(V)} planes make a bowl: {V.value([1 / 3] * 3):.1f} where nothing is known, "
        f"{V.alphas.max():.1f} at the best corner"
    )
    if ax is None:
        _, ax = plt.subplots(figsize=(6.4, 5.4), layout="constrained")
    ax = blank(ax, title, (-1.2, 1.2), (-1.55, 1.35))
    colors = [COLORS[pomdp.actions[V.actions[k]]] for k in seen.plans]
    shadows = style.cells(seen.shadows, [to_hex(paler(color, 0.55)) for color in colors], ax)
    for (foot, top), name in zip(seen.corners, pomdp.states, strict=True):
        ax.plot(*np.transpose([foot, top]), ":", color=style.QUIET, linewidth=1, zorder=0.5)
        ax.text(top[0], top[1] + 0.07, name, ha="center", va="bottom", color=style.INK)
    faces = style.cells(seen.faces, shaded(colors, seen), ax)
    for name in dict.fromkeys(pomdp.actions[V.actions[k]] for k in range(len(V))):
        ax.plot([], [], "s", color=COLORS[name], label=name)
    ax.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, -0.02), ncols=4, fontsize=9)
    return BowlPlot(ax, faces, shadows)


def bowl(V: ValueFunction, azimuth: float, elevation: float) -> Bowl:
    """Return the faces of a value function over three states as they are seen from somewhere.

    Parameters
    ----------
    V : ValueFunction
        Over three states.
    azimuth : float
        How far the bowl is turned about its axis, in degrees.
    elevation : float
        How far above the horizon the eye is, in degrees: 0 to 90.

    Returns
    -------
    Bowl

    Raises
    ------
    ValueError
        If there are not three states.

    Notes
    -----
    Along any line the slope of a convex function grows. So of two faces the one that climbs more
    steeply away from the eye is the farther one, and to draw by slope is to draw far before near.

    Examples
    --------
    From above, the bowl lies on its shadow:

    >>> seen = bowl(solved("three_places", 1), 0, 90)
    >>> len(seen.faces), bool(np.allclose(seen.faces[0], seen.shadows[0]))
    (4, True)
    """
    A, regions = _checks.array("alphas", V.alphas, (None, 3)), _regions(V)
    corners = {k: region @ A[k] for k, region in regions.items()}
    low = min(values.min() for values in corners.values())
    high = A.max()
    scale = _RISE / max(high - low, 1e-9)
    # A vector's slope across the triangle; its corners sum to 0, and are 1 from the middle.
    slopes = {k: scale * A[k] @ CORNERS * 2 / 3 for k in regions}
    turn, up = np.radians([azimuth, elevation])
    away = np.array([np.sin(turn), np.cos(turn)])
    order = sorted(regions, key=lambda k: -float(slopes[k] @ away))

    def seen(beliefs: Floats, values: Floats) -> Floats:
        place = beliefs @ CORNERS
        across = place @ [np.cos(turn), -np.sin(turn)]
        height = (values - low) * scale - _RISE / 2 + 0.3
        return np.column_stack([across, place @ away * np.sin(up) + height * np.cos(up)])

    floor = low - _DROP / scale
    ends = np.eye(3)
    return Bowl(
        np.array(order),
        [seen(regions[k], corners[k]) for k in order],
        [seen(regions[k], np.full(len(regions[k]), floor)) for k in order],
        np.array([slopes[k] for k in order]),
        (float(low), float(high)),
        np.stack([seen(ends, np.full(3, floor)), seen(ends, A.max(axis=0))], axis=1),
    )


@lru_cache(maxsize=32)
def _regions(V: ValueFunction) -> dict[int, Floats]:
    """Return where each plan is the best, as a polygon of beliefs."""
    found = {k: _region(V.alphas, k) for k in prune(V.alphas).tolist()}
    return {k: region for k, region in found.items() if len(region) > 2}


def _region(A: NDArray[np.floating], k: int) -> Floats:
    """Return the corners of the beliefs at which vector k is the best of A."""
    region = np.eye(A.shape[1])
    for ahead in A[k] - np.delete(A, k, axis=0):
        lead = region @ ahead
        # An edge between a corner that stays and one that goes is cut where the lead is 0.
        cut = []
        for i in range(len(region)):
            here, before = lead[i], lead[i - 1]
            if here * before < 0:
                cut.append((region[i - 1] * here - region[i] * before) / (here - before))
            if here >= 0:
                cut.append(region[i])
        region = np.array(cut).reshape(-1, A.shape[1])
    return region


def paler(color: str, share: float) -> tuple[float, float, float]:
    """Return a color with a share of white in it.

    Examples
    --------
    >>> paler("#000000", 0.25)
    (0.25, 0.25, 0.25)
    """
    red, green, blue = (channel + share * (1 - channel) for channel in to_rgb(color))
    return red, green, blue


def shaded(colors: Sequence[str], seen: Bowl) -> list[str]:
    """Return the color of each face, paler where it looks to the light: on the left, behind.

    Examples
    --------
    >>> seen = bowl(solved("three_places", 1), 0, 30)
    >>> len(set(shaded(["#000000"] * 4, seen)))
    4
    """
    light = seen.slopes @ [-0.8, 0.6]
    share = 0.15 + 0.3 * (light - light.min()) / max(np.ptp(light), 1e-9)
    return [to_hex(paler(color, part)) for color, part in zip(colors, share, strict=True)]


def figure_2_12(ax: Axes | None = None) -> ProjectionPlot:
    """Draw figure 2.12: the surface of figure 2.10 projected to a map from beliefs to actions.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    ProjectionPlot
        ``intervals`` "p1", "p2", ...: on the axis of beliefs, each in its action's color.

    References
    ----------
    Thesis, section 2.3.4 and figure 2.12; a(p) is the action at the root of p.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_12(Figure().subplots())
    open-left for p(tiger-left) < .10, listen up to .90, then open-right
    """
    pomdp, V = problem("tiger"), solved("tiger", 1)
    plans, ends = upper_surface(V.alphas)
    actions = [pomdp.actions[V.actions[k]] for k in plans]
    first, *inner = (
        f"{name} up to {short(end)}" for name, end in zip(actions, ends[1:-1], strict=False)
    )
    first = first.replace(" up to", f" for p({pomdp.states[0]}) <")
    ax = _belief_axes(ax, pomdp, ", ".join([first, *inner, f"then {actions[-1]}"]))
    p, value = surface_line(V.alphas)
    (surface,) = ax.plot(p, value, color=style.INK, linewidth=3)
    low, high = -8.0, 14.0
    intervals = {}
    for i, (left, right) in enumerate(pairwise(ends)):
        bar = Rectangle((left, low), right - left, 1.4, color=COLORS[actions[i]], linewidth=0)
        ax.add_patch(bar)
        intervals[f"p{i + 1}"] = bar
        mid = (left + right) / 2
        side = "left" if mid < 0.1 else "right" if mid > 0.9 else "center"
        at = {"left": left + 0.01, "right": right - 0.01, "center": mid}[side]
        aside = {"left": (9, 3), "right": (-22, 3), "center": (0, 7)}[side]  # of a steep piece
        name = f"$a(p_{i + 1})$ = {actions[i]}"
        white = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}  # over the dotted lines
        ax.text(at, low + 1.9, name, ha=side, va="bottom", fontsize=9, bbox=white)
        _tag(ax, (mid, np.interp(mid, p, value)), f"$p_{i + 1}$", aside)
    for end, height in zip(ends[1:-1], value[1:-1], strict=True):
        ax.plot([end, end], [low, height], ":", color=style.QUIET, linewidth=1, zorder=0.5)
    ax.set(ylim=(low, high))
    return ProjectionPlot(ax, surface, intervals)


def figure_2_14(ax: Axes | None = None, *, horizon: int = 6) -> SurfacePlot:
    """Draw figure 2.14: a value over every belief, of so many pieces that it looks like a curve.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    horizon : int
        Steps to go in the problem "two_state".

    Returns
    -------
    SurfacePlot
        Without lines.

    References
    ----------
    Thesis, section 2.3.4 and figure 2.14.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_14(Figure().subplots())
    6 steps to go: a value over every belief, in 54 pieces
    """
    V = solved("two_state", horizon)
    plans, _ = upper_surface(V.alphas)
    steps = f"{horizon} step{'s' * (horizon > 1)}"
    title = f"{steps} to go: a value over every belief, in {len(plans)} pieces"
    ax = _belief_axes(ax, problem("two_state"), title)
    (surface,) = ax.plot(*surface_line(V.alphas), color=style.INK, linewidth=3)
    _tag(ax, (0.12, V.value([0.12, 0.88])), "$V(b)$", (8, 4))
    ax.set_ylim(top=1.02 * V.alphas.max())
    return SurfacePlot(ax, {}, surface)


def figure_2_15(ax: Axes | None = None, *, horizon: int = 3) -> SurfacePlot:
    """Draw figure 2.15: a value function and the linear segments that it is made of.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    horizon : int
        Steps to go in the problem "two_state".

    Returns
    -------
    SurfacePlot

    References
    ----------
    Thesis, section 2.3.4 and figure 2.15.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_15(Figure().subplots())
    3 steps to go: the value is the upper surface of 7 lines
    """
    V = solved("two_state", horizon)
    title = f"{horizon} steps to go: the value is the upper surface of {len(V)} lines"
    return plot_surface(V, problem("two_state"), ax, title=title)


def figure_2_16(ax: Axes | None = None, *, p: float = 0.25) -> SurfacePlot:
    """Draw figure 2.16: the value of a single action, a1 or a2, at every belief.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    p : float in [0, 1]
        The belief that is marked: the probability of s1.

    Returns
    -------
    SurfacePlot
        ``lines`` "a1", "a2" and the mark of each at `p`: "at a1", "at a2".

    Raises
    ------
    ValueError
        If `p` is no probability.

    Notes
    -----
    The thesis says that a1 is to be preferred on the left. On the axis of figure 2.8, where
    p(s1) = 0 is on the left, a1 is the better on the right.

    References
    ----------
    Thesis, section 2.3.5 and figure 2.16.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_16(Figure().subplots(), p=0.8)
    >>> plot
    b = [.80 .20]: a1 earns 0.8, a2 0.3; a1 is better for p(s1) > .6, on the right
    """
    p = _checks.number("p", p, 0, 1)
    pomdp, V = problem("two_state"), solved("two_state", 1)
    b = np.array([p, 1 - p])
    _, (_, even, _) = upper_surface(V.alphas)
    earned = dict(zip(pomdp.actions, b @ pomdp.R, strict=True))
    title = (
        f"b = [{short(p)} {short(1 - p)}]: a1 earns {earned['a1']:.4g}, a2 {earned['a2']:.4g}; "
        f"a1 is better for p(s1) > {f'{even:g}'.removeprefix('0')}, on the right"
    )
    ax = _belief_axes(ax, pomdp, title)
    lines = {}
    for name, value in earned.items():
        line = pomdp.R[::-1, pomdp.actions.index(name)]
        color = COLORS[name]
        (lines[name],) = ax.plot([0, 1], line, color=color, linewidth=1.5)
        (lines[f"at {name}"],) = ax.plot(p, value, "o", color=color, markersize=8, zorder=4)
        _tag(ax, (p, value), f"{value:.4g}", (8, 6), color)
        end = int(line[1] > line[0])
        ax.annotate(
            name, (end, line[end]), (-8 if end else 8, 4), textcoords="offset points",
            ha="right" if end else "left", va="bottom", color=color,
        )  # fmt: skip
    surface = _surface(ax, V)
    for x, top in ((p, max(earned.values())), (even, even)):
        ax.plot([x, x], [0, top], ":", color=style.QUIET, linewidth=1, zorder=0.5)
    ax.set(ylim=(0, 1.65), xticks=[0, p, even, 1])
    return SurfacePlot(ax, lines, surface)


def figure_2_17(ax: Axes | None = None) -> DominationPlot:
    """Draw figure 2.17: a plan below one other, and a plan below two others together.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    DominationPlot
        ``lines`` "a" to "d"; ``mixture``, dashed, of p_a and p_b that lies above p_c everywhere;
        ``found``, what `dominated` says of c and of d.

    Notes
    -----
    The thesis says that p_c is "similarly" dominated by p_a and p_b. It is below neither of them:
    only of both together can it be said.

    References
    ----------
    Thesis, section 2.3.6 and figure 2.17.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_17(Figure().subplots())
    p_c is dominated only by p_a and p_b together, p_d by p_c alone
    """
    pomdp = problem("two_state")
    alphas = np.array([plan_value(pomdp, *plan) for plan in PLANS.values()])
    names = list(PLANS)
    found = dominated(alphas)
    told = [
        f"p_{names[one.index]} is dominated only by "
        + " and ".join(f"p_{names[k]}" for k in one.by)
        + (" alone" if len(one.by) == 1 else " together")
        for one in found
    ]
    title = ", ".join(told).replace(", p_d is dominated only by", ", p_d by")
    ax = _belief_axes(ax, pomdp, title)
    looks = {"a": ("-", style.INK), "b": ("-", style.INK), "c": ("-", style.OURS),
             "d": ("-", style.ACTIONS["left"])}  # fmt: skip
    lines = {}
    for name, alpha in zip(names, alphas, strict=True):
        dash, color = looks[name]
        (lines[name],) = ax.plot([0, 1], alpha[::-1], dash, color=color, linewidth=1.8)
        _tag(ax, (1, alpha[0]), f"$p_{name}$", (5, 0), color)
    joint = next(one for one in found if len(one.by) > 1)
    mixed = joint.weights @ alphas[list(joint.by)]
    (mixture,) = ax.plot([0, 1], mixed[::-1], "--", color=style.QUIET, linewidth=1.2)
    shares = " + ".join(
        f"{short(weight)} $p_{names[k]}$" for weight, k in zip(joint.weights, joint.by, strict=True)
    )
    _tag(ax, (0.3, mixed @ [0.3, 0.7]), shares, (0, 6), style.QUIET)
    ax.set(ylim=(0.4, 2.8))
    return DominationPlot(ax, lines, mixture, found)


def plot_policy_graph(V: ValueFunction, pomdp: POMDP, ax: Axes | None = None) -> Diagram:
    """Draw the plan without an end that begins at the start: nodes in the order of their beliefs.

    Parameters
    ----------
    V : ValueFunction
        Over two states, without a horizon.
    pomdp : POMDP
        Where the names and the start come from.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Diagram
        ``parts`` by the number of the node, as text; ``wires`` by the two numbers. Only the nodes
        that can be reached are there.

    Raises
    ------
    ValueError
        If `V` has a horizon, or there are not two states.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> tiger = problem("tiger")
    >>> plot_policy_graph(solve_pomdp(tiger), tiger, Figure().subplots())
    5 of 9 nodes can be reached from the start
    """
    if V.graph is None:
        raise ValueError(f"V must be a value function without a horizon, got {V!r}")
    alphas = _checks.array("alphas", V.alphas, (None, 2))
    reached = [V.best(pomdp.start)]
    for k in reached:  # it grows as it is walked
        reached += [j for j in dict.fromkeys(V.branches[k].tolist()) if j not in reached]
    # In the order in which the upper surface has them, from the left; a node need not be on it.
    row = sorted(reached, key=lambda k: alphas[k, 0] - alphas[k, 1])
    title = f"{len(row)} of {len(V)} nodes can be reached from the start"
    if ax is None:
        _, ax = plt.subplots(figsize=(8.4, 3.2), layout="constrained")
    ax = blank(ax, title, (-0.7, 2 * len(row) - 1.3), (-1.5, 1.5))
    parts, wires = {}, {}
    for i, k in enumerate(row):
        x = 2.0 * i
        parts[str(k)] = _action(ax, (x, 0.0), pomdp.actions[V.actions[k]])
        for j in dict.fromkeys(V.branches[k].tolist()):
            ahead = row.index(j) - i
            wires[str(k), str(j)] = _arc(ax, x, x + 2 * ahead)
            seen = np.flatnonzero(V.branches[k] == j)
            every = len(seen) == pomdp.n_observations
            name = "whatever" if every else " or ".join(pomdp.observations[z] for z in seen)
            words(ax, (x + ahead, 0.45 * ahead + 0.25 * np.sign(ahead)), name)
    ax.text(
        2.0 * row.index(reached[0]), -0.36, "start", ha="center", va="top", fontsize=9,
        color=style.QUIET,
    )  # fmt: skip
    ends = (-0.7, "left"), (2 * len(row) - 1.3, "right")
    for (x, side), name in zip(ends, pomdp.states[::-1], strict=True):
        ax.text(x, -1.45, f"surely {name}", ha=side, va="bottom", color=style.QUIET, fontsize=9)
    return Diagram(ax, parts, wires)


def _arc(ax: Axes, start: float, end: float) -> FancyArrowPatch:
    """Draw an arrow along a row: to the right above it, to the left below it."""
    way = float(np.sign(end - start))
    arrow = FancyArrowPatch(
        (start + 0.2 * way, 0.3 * way), (end - 0.3 * way, 0.3 * way),
        connectionstyle="arc3,rad=-0.45", arrowstyle="-|>", mutation_scale=12,
        color=style.INK, linewidth=1.1,
    )  # fmt: skip
    ax.add_patch(arrow)
    return arrow


def plan_value(pomdp: POMDP, action: int, after: Sequence[int]) -> Floats:
    """Return the vector of a plan of two steps: an action, and one after each observation.

    Examples
    --------
    >>> plan_value(problem("two_state"), *PLANS["a"]).round(3)
    array([2.035, 0.675])
    """
    return tree_value(pomdp, PolicyTree(action, tuple(map(PolicyTree, after))))


def short(p: float, digits: int = 2) -> str:
    """Return a probability without the zero before its point.

    Examples
    --------
    >>> short(0.25), short(0.9996, 3), short(1)
    ('.25', '1.000', '1.00')
    """
    return f"{p:.{digits}f}".removeprefix("0")


def _belief_axes(ax: Axes | None, pomdp: POMDP, title: str) -> Axes:
    """Return axes of value by belief; p of the first state runs to the right."""
    if pomdp.n_states != 2:
        raise ValueError(f"pomdp must have two states, got {pomdp!r}")
    if ax is None:
        _, ax = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    ax = style.axes(ax, xlabel=f"p({pomdp.states[0]})", ylabel="value", title=title)
    ax.set(xlim=(0, 1), xticks=np.linspace(0, 1, 6))
    return ax


def _surface(ax: Axes, V: ValueFunction) -> Line2D:
    """Draw the upper surface as a broad line under those of the plans."""
    (line,) = ax.plot(
        *surface_line(V.alphas), color=style.INK, alpha=0.3, linewidth=6, zorder=1.5,
        label="the best plan",
    )  # fmt: skip
    return line


def _tag(
    ax: Axes,
    place: tuple[float, float],
    text: str,
    offset: tuple[float, float],
    color: str = style.INK,
) -> None:
    """Write beside a place, on white."""
    white = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
    ax.annotate(
        text, place, offset, textcoords="offset points", color=color, fontsize=10, bbox=white,
        ha="center" if not offset[0] else "left", va="bottom" if offset[1] else "center",
    )  # fmt: skip
