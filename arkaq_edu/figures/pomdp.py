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

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Place, arrow, blank, wire, words, write
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.figures.drawing.style import POMDP_ACTIONS, probability
from arkaq_edu.pomdp import POMDP, PolicyTree, ValueFunction, problem, solve_pomdp, solved
from arkaq_edu.pomdp.belief import expected_rewards
from arkaq_edu.pomdp.pruning import dominated
from arkaq_edu.pomdp.surface import bowl, upper_surface
from arkaq_edu.pomdp.trees import tree_value

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
    nodes = list(_nodes(tree, pomdp))
    right = max(x for _, _, (x, _) in nodes)
    title = f"a policy tree of {tree.depth} steps: {len(nodes)} nodes, an action in each"
    limits = (-0.9, max(right, 4.5) + 0.6), (-1.5 * (tree.depth - 1) - 0.5, 0.5)
    ax = blank(ax, title, *limits, inch=0.9)
    places = {name: place for name, _, place in nodes}
    parts, wires = {}, {}
    for name, plan, (x, y) in nodes:
        parts[name] = _action(ax, (x, y), pomdp.actions[plan.action])
        if name:
            before, _, seen = name.rpartition(" ")
            from_x, from_y = places[before]
            wires[before, name] = wire(ax, (from_x, from_y - 0.22), (x, y + 0.22))
            words(ax, ((from_x + 2 * x) / 3, (from_y + 2 * y) / 3), seen)
    for step in range(tree.depth):
        write(ax, (-0.9, -1.5 * step), f"{tree.depth - step} to go", ha="left", color=style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


def _nodes(
    tree: PolicyTree, pomdp: POMDP, name: str = "", left: float = 0.3, y: float = 0.0
) -> Iterator[tuple[str, PolicyTree, Place]]:
    """Yield each node's observations so far, its plan, and its place above its own leaves."""
    leaves = pomdp.n_observations ** (tree.depth - 1)
    yield name, tree, (left + (leaves - 1) / 2, y)
    for z, branch in enumerate(tree.branches):
        seen = f"{name} {pomdp.observations[z]}".strip()
        yield from _nodes(branch, pomdp, seen, left + z * leaves / pomdp.n_observations, y - 1.5)


def _action(ax: Axes, place: Place, name: str) -> Text:
    color = POMDP_ACTIONS.get(name, style.QUIET)
    dark = np.dot(to_rgb(color), [0.3, 0.6, 0.1]) < 0.5
    box = {"boxstyle": "round,pad=0.35", "facecolor": color, "edgecolor": "white"}
    return write(ax, place, name, bbox=box, color="white" if dark else style.INK)


def plot_surface(
    V: ValueFunction, pomdp: POMDP, ax: Axes | None = None, *, title: str = ""
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
    lines, labels = {}, set()
    for i, k in enumerate(plans, 1):
        action = pomdp.actions[V.actions[k]]
        color = POMDP_ACTIONS.get(action, style.QUIET)
        (lines[f"p{i}"],) = ax.plot([0, 1], V.alphas[k][::-1], color=color, linewidth=1.2)
        if action not in labels:
            lines[f"p{i}"].set_label(f"first {action}")
        labels.add(action)
        mid = (p[i - 1] + p[i]) / 2
        _tag(ax, (mid, np.interp(mid, p, values)), f"$p_{{{i}}}$", (0, 7))
    surface = _surface(ax, V)
    ax.legend(frameon=False, fontsize=9)
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
    plot = plot_surface(V, problem("tiger"), ax, title=title)
    plot.ax.set_ylim(-34, 16)
    return plot


def figure_2_11(ax: Axes | None = None) -> Plot:
    """Draw figure 2.11: a value function over three states, a bowl above the triangle of beliefs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

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
    pomdp, V = problem("three_places"), solved("three_places", 2)
    seen = bowl(V, azimuth=46.0, elevation=38.0)
    title = (
        f"{len(V)} planes make a bowl: {V.value([1 / 3] * 3):.1f} where nothing is known, "
        f"{V.alphas.max():.1f} at the best corner"
    )
    ax = blank(ax, title, (-1.4, 1.2), (-1.75, 1.45), size=(6.4, 6.0))
    colors = [POMDP_ACTIONS[pomdp.actions[V.actions[k]]] for k in seen.plans]
    shadows = style.cells(seen.shadows, [style.paler(color, 0.7) for color in colors], ax)
    for value, (x, y) in zip(*seen.scale, strict=True):
        ax.plot([x - 0.04, x], [y, y], color=style.QUIET, linewidth=1)
        write(ax, (x - 0.07, y), f"{value:,g}", ha="right", color=style.QUIET)
    if len(seen.scale[0]):
        x, y = seen.scale[1].mean(axis=0)
        write(ax, (x - 0.3, y), "value", rotation=90, color=style.QUIET)
    for (foot, top), name in zip(seen.corners, pomdp.states, strict=True):
        ax.plot(*np.transpose([foot, top]), ":", color=style.QUIET, linewidth=1, zorder=0.5)
        write(ax, (top[0], top[1] + 0.09), name, va="bottom", fontsize=10)
    faces = style.cells(seen.faces, style.shaded(colors, seen.light), ax)
    for name in dict.fromkeys(pomdp.actions[a] for a in V.actions):
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
    title = (
        f"{actions[0]} for p({pomdp.states[0]}) < {probability(p[1])}, "
        f"{actions[1]} up to {probability(p[2])}, then {actions[2]}"
    )
    ax = _belief_axes(ax, pomdp, title)
    (surface,) = ax.plot(p, values, color=style.INK, linewidth=3)
    low, high = -8.0, 14.0
    colors = [POMDP_ACTIONS[name] for name in actions]
    bars = ax.barh([low] * 3, np.diff(p), 1.4, p[:-1], align="edge", color=colors, linewidth=0)
    # The outer pieces are steep and narrow: their names stand beside the line, and inside the axes.
    named = (("left", 0.01, (9, 3)), ("center", 0.5, (0, 7)), ("right", 0.99, (-22, 3)))
    for i, (side, x, aside) in enumerate(named):
        name = f"$a(p_{i + 1})$ = {actions[i]}"
        ground = style.white(1.5)
        write(ax, (x, low + 1.9), name, ha=side, va="bottom", color="black", bbox=ground)
        mid = (p[i] + p[i + 1]) / 2
        _tag(ax, (mid, np.interp(mid, p, values)), f"$p_{i + 1}$", aside)
    _dotted(ax, p[1:-1], low, values[1:-1])
    ax.set(ylim=(low, high))
    return Plot(ax, surface=surface, intervals=dict(zip(("p1", "p2", "p3"), bars, strict=True)))


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
    V = solved("two_state", _checks.integer("horizon", horizon, 1))
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
    V = solved("two_state", _checks.integer("horizon", horizon, 1))
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
    earned = dict(zip(pomdp.actions, expected_rewards(pomdp, b).tolist(), strict=True))
    title = (
        f"b = [{probability(p)} {probability(1 - p)}]: "
        f"a1 earns {earned['a1']:.4g}, a2 {earned['a2']:.4g}; "
        f"a1 is better for $p(s_1)$ > {f'{even:g}'.removeprefix('0')}, on the right"
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
        style.tag(ax, (end, line[end]), name, (-8 if end else 8, 4), color=color)
    surface = _surface(ax, V)
    _dotted(ax, [p, even], 0, [max(earned.values()), even])
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
    plan c is dominated only by a and b together, plan d by c alone
    """
    pomdp = problem("two_state")
    alphas = np.array([tree_value(pomdp, plan) for plan in PLANS.values()])
    names = list(PLANS)
    joint, alone = found = dominated(alphas)
    both = " and ".join(names[k] for k in joint.by)
    title = (
        f"plan {names[joint.index]} is dominated only by {both} together, "
        f"plan {names[alone.index]} by {names[alone.by[0]]} alone"
    )
    ax = _belief_axes(ax, pomdp, title)
    colors = (style.INK, style.INK, style.OURS, style.ACTIONS["left"])
    lines = {}
    for name, alpha, color in zip(names, alphas, colors, strict=True):
        (lines[name],) = ax.plot([0, 1], alpha[::-1], color=color, linewidth=1.8)
        _tag(ax, (1, alpha[0]), f"$p_{name}$", (5, 0), color)
    mixed = joint.weights @ alphas[list(joint.by)]
    (mixture,) = ax.plot([0, 1], mixed[::-1], "--", color=style.QUIET, linewidth=1.2)
    weighted = zip(joint.weights, joint.by, strict=True)
    shares = " + ".join(f"{probability(weight)} $p_{names[k]}$" for weight, k in weighted)
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
    ax = blank(ax, title, (-0.7, 2 * len(row) - 1.3), (-1.5, 1.5), size=(8.4, 3.2))
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
            side, length = np.sign(ahead), abs(2 * ahead)
            words(ax, (x + ahead, side * (0.3 + _bend(length) * (length / 2 - 0.2))), name)
    start = 2.0 * row.index(reached[0])
    arrow(ax, (start - 0.62, 0.0), (start - 0.27, 0.0), color=style.QUIET)
    notes = (
        ("start", (start - 0.66, 0.0), "right", "center"),
        (f"surely {pomdp.states[1]}", (-0.7, -1.45), "left", "bottom"),
        (f"surely {pomdp.states[0]}", (2 * len(row) - 1.3, -1.45), "right", "bottom"),
    )
    for text, place, ha, va in notes:
        write(ax, place, text, ha=ha, va=va, color=style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


def _arc(ax: Axes, start: float, end: float) -> FancyArrowPatch:
    """Draw an arrow along a row: to the right above it, to the left below it.

    One from the next node ends farther out than one from afar, so that each has its own tip.
    """
    side = float(np.sign(end - start))
    before = 0.35 if abs(end - start) <= 2.0 else 0.05
    tail, head = (start + 0.2 * side, 0.3 * side), (end - before * side, 0.3 * side)
    return arrow(ax, tail, head, -_bend(abs(end - start)), shrinkA=2, shrinkB=2, linewidth=1.1)


def _bend(length: float) -> float:
    """Return how far an arrow bends: one to the next node stays below those from afar."""
    return 0.3 if length <= 2.0 else 0.45


def _belief_axes(ax: Axes | None, pomdp: POMDP, title: str) -> Axes:
    """Return axes of value over belief; p of the first state runs to the right."""
    label = "$p(s_1)$" if pomdp.states[0] == "s1" else f"p({pomdp.states[0]})"
    ax = style.axes(ax, xlabel=label, ylabel="value", title=title, size=(6.4, 4.0))
    ax.set(xlim=(0, 1), xticks=np.linspace(0, 1, 6))
    return ax


def _surface(ax: Axes, V: ValueFunction) -> Line2D:
    """Draw the upper surface as a broad line under those of the plans."""
    _, p, values = upper_surface(V.alphas)
    (line,) = ax.plot(p, values, color=style.INK, alpha=0.3, linewidth=6, zorder=1.5)
    line.set_label("the best plan")
    return line


def _dotted(ax: Axes, x: ArrayLike, low: float, high: ArrayLike) -> None:
    ax.vlines(x, low, high, color=style.QUIET, linestyle=":", linewidth=1, zorder=0.5)


def _tag(ax: Axes, place: Place, text: str, offset: Place, color: str = style.INK) -> None:
    """Write text above or to the right of a point, on white."""
    sides = {"ha": "left" if offset[0] else "center"}
    style.tag(ax, place, text, offset, color=color, bbox=style.white(0.8, 0.8), **sides)
