"""Figures 2.3, 2.4, 4.3 and 4.4, and the plots of the chapter on decision processes.

References
----------
Thesis, sections 2.2 and 4.3.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_3(Figure().subplots())
MDP in time: state and action determine the reward and, with chance, the next state
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.bezier import BezierSegment
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.path import Path
from matplotlib.text import Text
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Place, blank, link, moment, words, write
from arkaq_edu.figures.drawing.floor import BALL, HOLE, SHADES, STONE, floor_polygons
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.mdp import MDP, Grid, example_mdp
from arkaq_edu.mdp.procedures import EXPLOITATION, EXPLORATION, Procedure

# --- figure 2.3 -----------------------------------------------------------------------------------

_STEP = 3.4  # from one moment to the next


def figure_2_3(ax: Axes | None = None) -> Plot:
    """Draw figure 2.3, a Markov decision process over time.

    Circles are states, squares actions, diamonds rewards. An arrow leads from what decides to what
    is decided. No arrow leads from S_t-1 to S_t+1: that is the Markov property.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.

    Returns
    -------
    Plot
        With ``parts`` and ``wires``, by names such as "S_t" and "S_t+1".

    References
    ----------
    Thesis, figure 2.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_3(Figure().subplots())
    >>> sorted(start for start, end in plot.wires if end == "S_t+1")
    ['A_t', 'S_t']
    """
    title = "MDP in time: state and action determine the reward and, with chance, the next state"
    ax = blank(ax, title, (-1.3, 9.9), (-3.4, 0.6))
    places: dict[str, Place] = {}
    flow: list[tuple[str, str]] = []
    for k, (before, t) in enumerate(pairwise(("", "t-1", "t", "t+1"))):
        x = k * _STEP
        places |= {f"S_{t}": (x, 0.0), f"A_{t}": (x + 1.4, -1.45), f"R_{t}": (x, -2.9)}
        flow += [(f"S_{t}", f"A_{t}"), (f"S_{t}", f"R_{t}"), (f"A_{t}", f"R_{t}")]
        if before:
            flow += [(f"S_{before}", f"S_{t}"), (f"A_{before}", f"S_{t}")]
    parts = {name: moment(ax, name, place) for name, place in places.items()}
    wires = {}
    for start, end in flow:
        wires[start, end] = link(ax, places, start, end)
        if start[0] == "S" and end[0] == "A":
            wires[start, end].set(linestyle="--", color=style.QUIET)
    for text, x, y in (
        ("T", _STEP * 1.5, 0.0), ("policy", _STEP + 0.7, -0.72), ("R", _STEP, -1.45),
        ("...", -0.9, 0.0), ("...", 2 * _STEP + 0.9, 0.0),
    ):  # fmt: skip
        words(ax, (x, y), text, color=style.QUIET)
    for row, text in enumerate(("circle: state", "square: action", "diamond: reward")):
        words(ax, (7.8, -2.4 - 0.42 * row), text, "left", color=style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


# --- figure 2.4 -----------------------------------------------------------------------------------

_RADIUS = 0.42  # of a state
_REACH = 1.15  # from the middle of a state to its choices
_ALONG = np.linspace(0.0, 1.0, 25)[1:]  # parts of the way along an arrow


def figure_2_4(ax: Axes | None = None, *, mdp: MDP | None = None) -> Plot:
    """Draw figure 2.4, states and where each action may lead; see `plot_transitions`.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.
    mdp : MDP, optional
        The model; `arkaq_edu.mdp.example_mdp` if None.

    Returns
    -------
    Plot

    References
    ----------
    Thesis, figure 2.4.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_4(Figure().subplots())
    3 states, 6 choices, 12 transitions; spirals are rewards
    """
    return plot_transitions(example_mdp() if mdp is None else mdp, ax)


def plot_transitions(
    mdp: MDP, ax: Axes | None = None, *, states: Sequence[str] | None = None,
    actions: Sequence[str] | None = None, places: ArrayLike | None = None,
) -> Plot:  # fmt: skip
    """Draw any small MDP: states as circles, choices as dots, transitions as arrows.

    Parameters
    ----------
    mdp : MDP
        The model. A state where an episode ends has a double border and no choices.
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.
    states, actions : sequence of str, optional
        Their names; S1, S2, ... and A1, A2, ... if None.
    places : array_like, shape (S, 2), optional
        The places of the states, neighbors about 3 apart; on a circle if None.

    Returns
    -------
    Plot
        With the texts ``states[s]`` and ``choices[s, a]``; ``arrows[s, a, t]``, an arrow and its
        probability; ``rewards[s, a]``, a spiral and its number.

    Raises
    ------
    ValueError
        If the number of names or places is not that of the states or actions.

    References
    ----------
    Thesis, figure 2.4.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> mdp = MDP(T=[[[0.2, 0.8], [0, 1]]], R=[[7], [0]], gamma=0.9)
    >>> plot = plot_transitions(mdp, Figure().subplots(), states=["near", "there"])
    >>> plot.arrows[0, 0, 1][1].get_text(), plot.rewards[0, 0][1].get_text()
    ('0.8', '+7')
    """
    states = [f"S{s + 1}" for s in range(mdp.n_states)] if states is None else states
    actions = [f"A{a + 1}" for a in range(mdp.n_actions)] if actions is None else actions
    for what, names, n in (("states", states, mdp.n_states), ("actions", actions, mdp.n_actions)):
        if len(names) != n:
            raise ValueError(f"{what} must hold {n} names, got {len(names)}")
    places = _circle(mdp.n_states) if places is None else places
    places = _checks.array("places", places, (mdp.n_states, 2))
    spots = _choices(mdp, places)
    lines = [(s, a, t) for s, a in spots for t in np.flatnonzero(mdp.T[a, s]).tolist()]
    title = f"{mdp.n_states} states, {len(spots)} choices, {len(lines)} transitions"
    if any(mdp.R[pair] for pair in spots):
        title += "; spirals are rewards"
    taken = [*places, *spots.values()]
    (left, foot), (right, top) = np.min(taken, axis=0) - 1.2, np.max(taken, axis=0) + 1.2
    ax = blank(ax, title, (left, right), (foot, top))
    curves = {(s, a, t): _curve(spots[s, a], places[t], s == t) for s, a, t in lines}
    stalks = [np.linspace(places[s], spot, 9) for (s, _), spot in spots.items()]
    drawn = np.concatenate([places, *stalks, *(curve(_ALONG) for curve in curves.values())])
    arrows = {
        (s, a, t): _chance(ax, curve, mdp.T[a, s, t], [*taken, *drawn])
        for (s, a, t), curve in curves.items()
    }
    taken += list(drawn)
    rewards = {
        pair: _spiral(ax, spot, mdp.R[pair], taken) for pair, spot in spots.items() if mdp.R[pair]
    }
    dot = {"boxstyle": "round,pad=0.25", "facecolor": style.CELLS[3], "edgecolor": style.INK}
    choices = {}
    for (s, a), spot in spots.items():
        ax.plot(*zip(places[s], spot, strict=True), color=style.INK, linewidth=1, zorder=0)
        choices[s, a] = write(ax, spot, actions[a], bbox=dot)
    for s, place in enumerate(places):
        for radius in (_RADIUS, _RADIUS - 0.07) if mdp.ends[s] else (_RADIUS,):
            circle = Circle(tuple(place), radius, facecolor=style.CELLS[0], edgecolor=style.INK)
            ax.add_patch(circle)
    named = {s: write(ax, place, states[s]) for s, place in enumerate(places)}
    return Plot(ax, states=named, choices=choices, arrows=arrows, rewards=rewards)


def _circle(n: int) -> NDArray[np.float64]:
    """Return n places around a circle, the first at the upper left, next ones 3.4 apart."""
    angles = np.pi * (0.75 - 2 * np.arange(n) / n)
    return 1.7 / np.sin(np.pi / max(n, 2)) * style.directions(angles)


def _choices(mdp: MDP, middle: NDArray[np.float64]) -> dict[tuple[int, int], NDArray[np.float64]]:
    """Return a place for each choice: beside its state, toward where it leads, apart."""
    spots = {}
    for s in np.flatnonzero(~mdp.ends).tolist():
        angles = []
        for a in range(mdp.n_actions):
            pull = mdp.T[a, s] @ (middle - middle[s])
            if np.hypot(*pull) < 1e-9:  # it stays: then away from the others
                pull = middle[s] - middle.mean(axis=0) + [0, 1e-3]
            angles.append(np.arctan2(pull[1], pull[0]) + 0.01 * a)
        apart = min(1.3, 2 * np.pi / mdp.n_actions)
        for _ in range(200):
            for a, b in np.argwhere(~np.eye(mdp.n_actions, dtype=bool)):
                gap = (angles[a] - angles[b] + np.pi) % (2 * np.pi) - np.pi
                if abs(gap) < apart:
                    angles[a] += 0.1 * np.copysign(apart - abs(gap), gap)
        for a, direction in enumerate(style.directions(angles)):
            spots[s, a] = middle[s] + _REACH * direction
    return spots


def _free(candidates: NDArray[np.float64], taken: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the candidate that is farthest from all that is taken, and take it."""
    gaps = np.linalg.norm(candidates[:, np.newaxis] - np.array(taken), axis=2).min(axis=1)
    taken.append(candidates[gaps.argmax()])
    return taken[-1]


def _curve(start: NDArray[np.float64], end: NDArray[np.float64], stays: bool) -> BezierSegment:
    """Return the bent line from a choice to the rim of a state."""
    dx, dy = end - start
    pull = (start + end) / 2 + (0.55 if stays else 0.18) * np.array([dy, -dx])
    rim = end - _RADIUS * (end - pull) / np.hypot(*(end - pull))
    return BezierSegment([start, pull, rim])


def _chance(
    ax: Axes, curve: BezierSegment, p: float, taken: list[NDArray[np.float64]]
) -> tuple[FancyArrowPatch, Text]:
    """Draw an arrow from a choice to a state, and its probability where there is room."""
    path = Path(curve.control_points, [Path.MOVETO, Path.CURVE3, Path.CURVE3])
    arrow = FancyArrowPatch(path=path, arrowstyle="-|>", mutation_scale=12, color=style.INK)
    ax.add_patch(arrow)
    own = {tuple(point) for point in curve(_ALONG)}
    others = [point for point in taken if tuple(point) not in own]
    place = _free(curve(np.linspace(0.25, 0.7, 19)), others)
    return arrow, write(ax, place, f"{p:.3g}", fontsize=8, bbox=style.white(0.8))


def _spiral(
    ax: Axes, start: NDArray[np.float64], reward: float, taken: list[NDArray[np.float64]]
) -> tuple[Line2D, Text]:
    """Draw a coil that leaves a choice where there is room, and the reward at its end."""
    around = style.directions(np.linspace(0, 2 * np.pi, 25)[:-1])
    end = _free(start + 1.08 * around, taken)
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    turn = np.linspace(0, 4 * 2 * np.pi, 120)
    forth = 0.15 + 0.5 * turn / turn[-1] + 0.07 * (1 - np.cos(turn))
    coil = start + np.outer(forth, along) + np.outer(0.09 * np.sin(turn), across)
    (line,) = ax.plot(*coil.T, color=style.OURS, linewidth=1.2)
    number = f"{reward:+.3g}".replace("-", "−")
    return line, write(ax, end, number, fontsize=10, color=style.OURS, weight="bold")


# --- figures 4.3 and 4.4 --------------------------------------------------------------------------


def figure_4_3(ax: Axes | None = None) -> Plot:
    """Draw figure 4.3, Q-learning while it explores: as printed, and as it runs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.

    Returns
    -------
    Plot
        With ``printed`` and ``runs``, one text for each line, and ``links`` from printed lines to
        running ones.

    References
    ----------
    Thesis, figure 4.3; `arkaq_edu.mdp.training` says why it cannot run as printed.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_4_3(Figure().subplots())
    exploration: of 10 printed lines 2 run as they stand, 7 change, 1 goes; 3 are new
    """
    return _procedure(EXPLORATION, ax)


def figure_4_4(ax: Axes | None = None) -> Plot:
    """Draw figure 4.4, Q-learning while it exploits: as printed, and as it runs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.

    Returns
    -------
    Plot
        As `figure_4_3`.

    References
    ----------
    Thesis, figure 4.4; `arkaq_edu.mdp.training` says why it cannot run as printed.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_4_4(Figure().subplots())
    >>> plot.runs[3].get_text().strip()
    'draw a by exp(Q[s][a] / T), T falling'
    """
    return _procedure(EXPLOITATION, ax)


def _procedure(procedure: Procedure, ax: Axes | None) -> Plot:
    name, printed, runs = procedure
    kept = {i for line in runs for i in line.of if not line.changed}
    used = {i for line in runs for i in line.of}
    new = sum(not line.of for line in runs)
    title = (
        f"{name}: of {len(printed)} printed lines {len(kept)} run as they stand, "
        f"{len(used - kept)} change, {len(printed) - len(used)} goes; {new} are new"
    )
    ax = blank(ax, title, (0.0, 11.2), (-0.4 * len(runs) - 0.1, 0.8))
    left, right = 4.2, 5.4
    rows = -0.4 * np.arange(len(runs)) - 0.1
    ax.text(0.0, 0.4, "as printed", weight="bold", color=style.INK)
    ax.text(right + 0.2, 0.4, "as it runs", weight="bold", color=style.OURS)
    plot = Plot(ax, printed=[], runs=[], links={})
    for i, (indent, text) in enumerate(printed):
        color = style.INK if i in used else style.QUIET
        plot.printed.append(words(ax, (0.3 * indent, rows[i]), text, "left", color))
        style.measurements([left], [rows[i]], ax, color=color, markersize=4)
    for j, line in enumerate(runs):
        color = style.OURS if line.changed else style.INK
        place = right + 0.2 + 0.3 * line.indent, rows[j]
        plot.runs.append(words(ax, place, line.words, "left", color))
        ax.plot(right, rows[j], "o" if line.of else "P", color=color, markersize=5)
        for i in line.of:
            ends = [left + 0.06, right], rows[[i, j]]
            (plot.links[i, j],) = ax.plot(*ends, color=color, linewidth=1, zorder=0)
    return plot


# --- values and arrows on a grid ------------------------------------------------------------------


def plot_grid(
    grid: Grid, V: ArrayLike, best: ArrayLike, ax: Axes | None = None, *, title: str = ""
) -> Plot:
    """Draw the values of a grid world as shades and numbers, and its best actions as arrows.

    Walls are gray, holes black, and the ball is orange. If several actions are best, each has an
    arrow; if all are best, there is none.

    Parameters
    ----------
    grid : Grid
        The floor.
    V : array_like, shape (S,)
        The value of each state.
    best : array_like of bool, shape (S, A)
        Which actions are the best of their state (see `arkaq_edu.mdp.best_actions`).
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.
    title : str
        What the plot states.

    Returns
    -------
    Plot
        With ``squares``, ``arrows`` and ``numbers``, a text for each state.

    Raises
    ------
    ValueError
        If a shape does not fit.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from arkaq_edu.mdp import best_actions, grid_world, value_iteration
    >>> grid = grid_world()
    >>> V, _ = value_iteration(grid.mdp)
    >>> plot_grid(grid, V, best_actions(grid.mdp.action_values(V)), Figure().subplots())
    37 arrows
    """
    floor = floor_polygons(grid, V, best)
    width, height = len(grid.plan[0]), len(grid.plan)
    ax = blank(ax, title, (-0.05, width + 0.05), (-0.05, height + 0.05))
    squares = style.cells(floor.squares, [SHADES[shade] for shade in floor.shades], ax)
    for polygons, color in ((floor.walls, STONE), (floor.holes, HOLE), (floor.balls, BALL)):
        style.cells(polygons, [color] * len(polygons), ax)
    arrows = style.cells(floor.arrows, [style.INK] * len(floor.arrows), ax)
    arrows.set_linewidth(0)
    numbers = [
        ax.text(x + 0.5, y + 0.08, f"{value:.0f}".replace("-", "−"), ha="center", fontsize=7)
        for (x, y), value, end in zip(grid.places, np.asarray(V), grid.mdp.ends, strict=True)
        if not end
    ]
    fact = f"{len(floor.arrows)} arrows"
    return Plot(ax, fact, squares=squares, arrows=arrows, numbers=numbers)


# --- how an error falls ---------------------------------------------------------------------------


def plot_bands(
    x: ArrayLike, runs: Mapping[str, ArrayLike], ax: Axes | None = None, *, xlabel: str = "",
    ylabel: str = "", title: str = "",
) -> Plot:  # fmt: skip
    """Draw what up to three learners do over many runs: the mean, with one sigma.

    Parameters
    ----------
    x : array_like, shape (n,)
        When it was measured; the axis is logarithmic.
    runs : mapping of str to array_like, shape (runs, n)
        What was measured, a row for each run.
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.
    xlabel, ylabel : str
        The labels of the axes.
    title : str
        What the plot states.

    Returns
    -------
    Plot
        With ``lines`` and ``bands`` by name.

    Raises
    ------
    ValueError
        If a shape does not fit, or there are more names than colors.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_bands([1, 10], {"slow": [[3.0, 1.0], [5.0, 3.0]]}, Figure().subplots())
    >>> plot.lines["slow"].get_ydata()
    array([4., 2.])
    """
    x = _checks.array("x", x, (None,))
    ax = style.axes(ax, xlabel=xlabel, ylabel=ylabel, title=title)
    ax.set_xscale("log")
    curves = {}
    for name, values in runs.items():
        found = _checks.array(name, values, (None, len(x)))
        curves[name] = x, found.mean(axis=0), found.std(axis=0)
    lines, bands = style.bands(ax, curves, (style.OURS, style.ACTIONS["right"], style.INK))
    for line, dash in zip(lines.values(), ("-", "--", ":"), strict=False):
        line.set(linestyle=dash)
    ax.legend(frameon=False)
    return Plot(ax, ", ".join(bands), lines=lines, bands=bands)
