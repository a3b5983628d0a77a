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

from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Rectangle
from matplotlib.text import Text

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Place, blank, wire, words
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.figures.drawing.style import POMDP_ACTIONS, probability
from arkaq_edu.pomdp import (
    POMDP,
    PolicyTree,
    ValueFunction,
    bowl,
    dominated,
    expected_rewards,
    problem,
    solve_pomdp,
    solved,
    tree_value,
    upper_surface,
)

#: The plans of figure 2.17, two steps of the problem "two_state": an action, and one for each of
#: z1, z2 and z3.
PLANS = {
    name: PolicyTree(action, tuple(map(PolicyTree, after)))
    for name, (action, after) in {
        "a": (0, (0, 1, 1)), "b": (1, (0, 1, 1)), "c": (0, (0, 0, 1)), "d": (0, (0, 1, 0)),
    }.items()
}  # fmt: skip


def figure_2_9(
    ax: Axes | None = None, *, tree: PolicyTree | None = None, pomdp: POMDP | None = None
) -> Plot:
    """Draw figure 2.9, a policy tree: an action, and for each observation what follows.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    tree : PolicyTree, optional
        The plan; by default the best plan of three steps from the start of `pomdp`.
    pomdp : POMDP, optional
        The model whose names to use; by default the problem "two_state".

    Returns
    -------
    Plot
        ``parts`` by the observations that lead to them, "" for the root; ``wires``.

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
    places, plans = _layout(tree, pomdp)
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
    return Plot(ax, parts=parts, wires=wires)


def _layout(tree: PolicyTree, pomdp: POMDP) -> tuple[dict[str, Place], dict[str, PolicyTree]]:
    """Return the place and the plan of every node, by the observations that lead to it."""
    places: dict[str, Place] = {}
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


def _action(ax: Axes, place: Place, name: str) -> Text:
    color = POMDP_ACTIONS.get(name, style.QUIET)
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
) -> Plot:
    """Draw a value function over two states: a line for each plan, and their upper surface bold.

    Parameters
    ----------
    V : ValueFunction
        Over two states.
    pomdp : POMDP
        The model whose names to use.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    ylim : tuple of two float, optional
        The ends of the value axis.
    title : str
        What the picture states.

    Returns
    -------
    Plot
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
    plans, p, values = upper_surface(V.alphas)
    ax = _belief_axes(ax, pomdp, title)
    lines, named = {}, set()
    for i, k in enumerate(plans):
        action = pomdp.actions[V.actions[k]]
        label = "_" if action in named else f"first {action}"
        (lines[f"p{i + 1}"],) = ax.plot(
            [0, 1], V.alphas[k][::-1], label=label, linewidth=1.2,
            color=POMDP_ACTIONS.get(action, style.QUIET),
        )  # fmt: skip
        named.add(action)
    surface = _surface(ax, V)
    for i, mid in enumerate((p[:-1] + p[1:]) / 2):
        height = np.interp(mid, p, values)
        _tag(ax, (mid, height), f"$p_{{{i + 1}}}$", (0, 7))
    ax.legend(frameon=False, fontsize=9)
    if ylim:
        ax.set_ylim(*ylim)
    return Plot(ax, lines=lines, surface=surface)


def figure_2_10(ax: Axes | None = None) -> Plot:
    """Draw figure 2.10: the upper surface of the three policy trees of Tiger with one step to go.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        As of `plot_surface`.

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
) -> Plot:
    """Draw figure 2.11: a value function over three states, a bowl above the triangle of beliefs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    horizon : int
        The number of steps to go in the problem "three_places".
    azimuth, elevation : float
        The direction from which it is seen, in degrees.

    Returns
    -------
    Plot
        ``faces`` and ``shadows``, in the order of `arkaq_edu.pomdp.bowl`.

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
    colors = [POMDP_ACTIONS[pomdp.actions[V.actions[k]]] for k in seen.plans]
    shadows = style.cells(seen.shadows, [style.paler(color, 0.55) for color in colors], ax)
    for (foot, top), name in zip(seen.corners, pomdp.states, strict=True):
        ax.plot(*np.transpose([foot, top]), ":", color=style.QUIET, linewidth=1, zorder=0.5)
        ax.text(top[0], top[1] + 0.07, name, ha="center", va="bottom", color=style.INK)
    faces = style.cells(seen.faces, style.shaded(colors, seen.light), ax)
    for name in dict.fromkeys(pomdp.actions[V.actions[k]] for k in range(len(V))):
        ax.plot([], [], "s", color=POMDP_ACTIONS[name], label=name)
    ax.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, -0.02), ncols=4, fontsize=9)
    return Plot(ax, faces=faces, shadows=shadows)


def figure_2_12(ax: Axes | None = None) -> Plot:
    """Draw figure 2.12: the surface of figure 2.10 projected to a map from beliefs to actions.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        The line ``surface`` and the ``intervals`` "p1", "p2", ... on the axis of beliefs, each in
        its action's color.

    References
    ----------
    Thesis, section 2.3.4 and figure 2.12, where a(p) is the action at the root of p.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_12(Figure().subplots())
    open-left for p(tiger-left) < .10, listen up to .90, then open-right
    """
    pomdp, V = problem("tiger"), solved("tiger", 1)
    plans, p, values = upper_surface(V.alphas)
    actions = [pomdp.actions[V.actions[k]] for k in plans]
    first, *inner = (
        f"{name} up to {probability(end)}" for name, end in zip(actions, p[1:-1], strict=False)
    )
    first = first.replace(" up to", f" for p({pomdp.states[0]}) <")
    ax = _belief_axes(ax, pomdp, ", ".join([first, *inner, f"then {actions[-1]}"]))
    (surface,) = ax.plot(p, values, color=style.INK, linewidth=3)
    low, high = -8.0, 14.0
    intervals = {}
    for i, (left, right) in enumerate(pairwise(p)):
        color = POMDP_ACTIONS[actions[i]]
        bar = Rectangle((left, low), right - left, 1.4, color=color, linewidth=0)
        ax.add_patch(bar)
        intervals[f"p{i + 1}"] = bar
        mid = (left + right) / 2
        side = "left" if mid < 0.1 else "right" if mid > 0.9 else "center"
        at = {"left": left + 0.01, "right": right - 0.01, "center": mid}[side]
        aside = {"left": (9, 3), "right": (-22, 3), "center": (0, 7)}[side]  # of a steep piece
        name = f"$a(p_{i + 1})$ = {actions[i]}"
        white = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}  # over the dotted lines
        ax.text(at, low + 1.9, name, ha=side, va="bottom", fontsize=9, bbox=white)
        _tag(ax, (mid, np.interp(mid, p, values)), f"$p_{i + 1}$", aside)
    for end, height in zip(p[1:-1], values[1:-1], strict=True):
        ax.plot([end, end], [low, height], ":", color=style.QUIET, linewidth=1, zorder=0.5)
    ax.set(ylim=(low, high))
    return Plot(ax, surface=surface, intervals=intervals)


def figure_2_14(ax: Axes | None = None, *, horizon: int = 6) -> Plot:
    """Draw figure 2.14: a value function of so many pieces that it looks like a curve.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    horizon : int
        The number of steps to go in the problem "two_state".

    Returns
    -------
    Plot
        The line ``surface``.

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
    plans, p, values = upper_surface(V.alphas)
    steps = f"{horizon} step{'s' * (horizon > 1)}"
    title = f"{steps} to go: a value over every belief, in {len(plans)} pieces"
    ax = _belief_axes(ax, problem("two_state"), title)
    (surface,) = ax.plot(p, values, color=style.INK, linewidth=3)
    _tag(ax, (0.12, V.value([0.12, 0.88])), "$V(b)$", (8, 4))
    ax.set_ylim(top=1.02 * V.alphas.max())
    return Plot(ax, surface=surface)


def figure_2_15(ax: Axes | None = None, *, horizon: int = 3) -> Plot:
    """Draw figure 2.15: a value function and the lines that it is made of.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    horizon : int
        The number of steps to go in the problem "two_state".

    Returns
    -------
    Plot
        As of `plot_surface`.

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


def figure_2_16(ax: Axes | None = None, *, p: float = 0.25) -> Plot:
    """Draw figure 2.16: the value of a single action, a1 or a2, at every belief.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    p : float in [0, 1]
        The marked belief: the probability of s1.

    Returns
    -------
    Plot
        ``lines`` "a1", "a2" and the marks on them at `p`, "at a1", "at a2"; the ``surface``.

    Raises
    ------
    ValueError
        If `p` is not a probability.

    Notes
    -----
    The thesis says that a1 is preferred on the left. On the axis of figure 2.8, where p(s1) = 0 is
    on the left, a1 is better on the right.

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
    even = upper_surface(V.alphas).p[1]
    earned = dict(zip(pomdp.actions, expected_rewards(pomdp, b), strict=True))
    title = (
        f"b = [{probability(p)} {probability(1 - p)}]: "
        f"a1 earns {earned['a1']:.4g}, a2 {earned['a2']:.4g}; "
        f"a1 is better for p(s1) > {f'{even:g}'.removeprefix('0')}, on the right"
    )
    ax = _belief_axes(ax, pomdp, title)
    lines = {}
    for name, value in earned.items():
        line = pomdp.R[::-1, pomdp.actions.index(name)]
        color = POMDP_ACTIONS[name]
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
    return Plot(ax, lines=lines, surface=surface)


def figure_2_17(ax: Axes | None = None) -> Plot:
    """Draw figure 2.17: a plan below one other, and a plan below two others together.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        ``lines`` "a" to "d"; ``mixture``, a dashed mixture of p_a and p_b that is above p_c
        everywhere; ``found``, what `dominated` returns for c and d.

    Notes
    -----
    The thesis says that p_a and p_b dominate p_c "similarly". But p_c is below neither of them
    everywhere: only both together dominate it.

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
    alphas = np.array([tree_value(pomdp, plan) for plan in PLANS.values()])
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
        f"{probability(weight)} $p_{names[k]}$"
        for weight, k in zip(joint.weights, joint.by, strict=True)
    )
    _tag(ax, (0.3, mixed @ [0.3, 0.7]), shares, (0, 6), style.QUIET)
    ax.set(ylim=(0.4, 2.8))
    return Plot(ax, lines=lines, mixture=mixture, found=found)


def plot_policy_graph(V: ValueFunction, pomdp: POMDP, ax: Axes | None = None) -> Plot:
    """Draw a policy graph from the start on, its nodes in the order of their beliefs.

    Parameters
    ----------
    V : ValueFunction
        Over two states, without a horizon.
    pomdp : POMDP
        The model, with its names and its start.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        ``parts`` by the number of the node, as text; ``wires`` by two such numbers. Only nodes that
        can be reached are drawn.

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
    reached = V.graph.reached(V.best(pomdp.start))
    # By slope, as the upper surface has them from left to right. A node need not be on it.
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
    return Plot(ax, parts=parts, wires=wires)


def _arc(ax: Axes, start: float, end: float) -> FancyArrowPatch:
    """Draw an arrow along a row: to the right above it, to the left below it."""
    side = float(np.sign(end - start))
    arrow = FancyArrowPatch(
        (start + 0.2 * side, 0.3 * side), (end - 0.3 * side, 0.3 * side),
        connectionstyle="arc3,rad=-0.45", arrowstyle="-|>", mutation_scale=12,
        color=style.INK, linewidth=1.1,
    )  # fmt: skip
    ax.add_patch(arrow)
    return arrow


def _belief_axes(ax: Axes | None, pomdp: POMDP, title: str) -> Axes:
    """Return axes of value over belief; p of the first state runs to the right."""
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
        *upper_surface(V.alphas)[1:], color=style.INK, alpha=0.3, linewidth=6, zorder=1.5,
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
    """Write text beside a point, on white."""
    white = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
    ax.annotate(
        text, place, offset, textcoords="offset points", color=color, fontsize=10, bbox=white,
        ha="center" if not offset[0] else "left", va="bottom" if offset[1] else "center",
    )  # fmt: skip
