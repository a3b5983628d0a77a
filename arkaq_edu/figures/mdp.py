"""Figures 2.3, 2.4, 4.3 and 4.4, and the pictures of the chapter on decision processes.

References
----------
Thesis, sections 2.2 and 4.3.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_3(Figure().subplots())
MDP in time: S_t and A_t decide over R_t and, by chance, over S_t+1
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.path import Path
from matplotlib.text import Text
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Diagram, Place, blank, link, moment, words
from arkaq_edu.mdp import MDP
from arkaq_edu.mdp.gridworld import MOVES, WALL, Grid

# --- figure 2.3 -----------------------------------------------------------------------------------

_STEP = 3.4  # from one moment to the next


def figure_2_3(ax: Axes | None = None) -> Diagram:
    """Draw figure 2.3, a Markov decision process from moment to moment.

    Circles are states, squares actions, diamonds rewards; an arrow leads from what decides to what
    is decided. None leads from S_t-1 to S_t+1: that is the Markov property.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Diagram
        ``ax``, ``parts`` and ``wires``, by names like "S_t" and "S_t+1".

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
    title = "MDP in time: S_t and A_t decide over R_t and, by chance, over S_t+1"
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
    for text, place in (
        ("T", (_STEP * 1.5, 0.0)), ("policy", (_STEP + 0.7, -0.72)), ("R", (_STEP, -1.45)),
    ):  # fmt: skip
        words(ax, place, text, color=style.QUIET)
    for x in (-0.9, 2 * _STEP + 0.9):
        words(ax, (x, 0.0), "...", color=style.QUIET)
    for row, text in enumerate(("circle: state", "square: action", "diamond: reward")):
        words(ax, (7.8, -2.4 - 0.42 * row), text, "left", color=style.QUIET)
    return Diagram(ax, parts, wires)


# --- figure 2.4 -----------------------------------------------------------------------------------


class TransitionPlot(NamedTuple):
    """What `plot_transitions` drew, by state, action and next state.

    ``states[s]`` and ``choices[s, a]`` are words; ``arrows[s, a, t]`` holds an arrow and its
    probability, ``rewards[s, a]`` a spiral and its number.
    """

    ax: Axes
    states: dict[int, Text]
    choices: dict[tuple[int, int], Text]
    arrows: dict[tuple[int, int, int], tuple[FancyArrowPatch, Text]]
    rewards: dict[tuple[int, int], tuple[Line2D, Text]]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def example_mdp() -> MDP:
    """Return the three states of figure 2.4, with numbers of the course's own.

    Examples
    --------
    >>> example_mdp()
    MDP(3 states, 2 actions, gamma=0.9)
    """
    T = [
        [[0.3, 0.7, 0.0], [0.6, 0.0, 0.4], [0.0, 0.2, 0.8]],
        [[0.2, 0.8, 0.0], [0.0, 0.3, 0.7], [0.9, 0.0, 0.1]],
    ]
    return MDP(T, R=[[0, -1], [5, 0], [0, 2]], gamma=0.9)


def figure_2_4(ax: Axes | None = None, *, mdp: MDP | None = None) -> TransitionPlot:
    """Draw figure 2.4, states and what each action may lead to; see `plot_transitions`.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    mdp : MDP, optional
        What is drawn; `example_mdp` where it is None.

    Returns
    -------
    TransitionPlot

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
    mdp: MDP,
    ax: Axes | None = None,
    *,
    states: Sequence[str] | None = None,
    actions: Sequence[str] | None = None,
    places: ArrayLike | None = None,
) -> TransitionPlot:
    """Draw any small MDP: circles are states, dots choices; arrows leave a choice by chance.

    Parameters
    ----------
    mdp : MDP
        What is drawn. A state where an episode ends has a double border and no choices.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    states, actions : sequence of str, optional
        Their names; S1, S2, ... and A1, A2, ... where they are None.
    places : array_like, shape (S, 2), optional
        Where the states stand, next ones about 3 apart; around a circle where it is None.

    Returns
    -------
    TransitionPlot

    Raises
    ------
    ValueError
        If there are not as many names or places as states and actions.

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
    states = [f"S{s + 1}" for s in range(mdp.n_states)] if states is None else list(states)
    actions = [f"A{a + 1}" for a in range(mdp.n_actions)] if actions is None else list(actions)
    for what, names, n in (("states", states, mdp.n_states), ("actions", actions, mdp.n_actions)):
        if len(names) != n:
            raise ValueError(f"{what} must hold {n} names, got {len(names)}")
    middle = _circle(mdp.n_states) if places is None else places
    middle = _checks.array("places", middle, (mdp.n_states, 2))
    spots = _choices(mdp, middle)
    lines = [(s, a, t) for s, a in spots for t in np.flatnonzero(mdp.T[a, s]).tolist()]
    title = f"{mdp.n_states} states, {len(spots)} choices, {len(lines)} transitions"
    if any(mdp.R[pair] for pair in spots):
        title += "; spirals are rewards"
    taken = [*middle, *spots.values()]
    (left, foot), (right, top) = np.min(taken, axis=0) - 1.2, np.max(taken, axis=0) + 1.2
    ax = blank(ax, title, (left, right), (foot, top))
    arrows = {}
    for s, a, t in lines:
        bend = 0.55 if s == t else 0.18
        arrows[s, a, t] = _chance(ax, spots[s, a], middle[t], bend, mdp.T[a, s, t], taken)
    rewards = {}
    for (s, a), spot in spots.items():
        ax.plot(*zip(middle[s], spot, strict=True), color=style.INK, linewidth=1, zorder=0)
        if mdp.R[s, a]:
            rewards[s, a] = _spiral(ax, spot, float(mdp.R[s, a]), taken)
    choices = {pair: _dot(ax, spot, actions[pair[1]]) for pair, spot in spots.items()}
    circles = {s: _disc(ax, middle[s], states[s], bool(mdp.ends[s])) for s in range(mdp.n_states)}
    return TransitionPlot(ax, circles, choices, arrows, rewards)


_RADIUS = 0.42  # of a state
_REACH = 1.15  # from the middle of a state to its choices


def _circle(n: int) -> NDArray[np.float64]:
    """Return n places around a circle, the first at the upper left, next ones 3.4 apart."""
    angle = np.pi * (0.75 - 2 * np.arange(n) / n)
    return 1.7 / np.sin(np.pi / max(n, 2)) * np.column_stack([np.cos(angle), np.sin(angle)])


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
        for a, angle in enumerate(angles):
            spots[s, a] = middle[s] + _REACH * np.array([np.cos(angle), np.sin(angle)])
    return spots


def _free(
    candidates: Iterable[NDArray[np.float64]], taken: list[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return the candidate that is farthest from all that is taken, and take it."""
    best = max(candidates, key=lambda place: min(np.hypot(*(place - other)) for other in taken))
    taken.append(best)
    return best


def _chance(
    ax: Axes, start: NDArray[np.float64], end: NDArray[np.float64], bend: float, p: float,
    taken: list[NDArray[np.float64]],
) -> tuple[FancyArrowPatch, Text]:  # fmt: skip
    """Draw an arrow from a choice to a state, and its probability where there is room."""
    dx, dy = end - start
    pull = (start + end) / 2 + bend * np.array([dy, -dx])
    rim = end - _RADIUS * (end - pull) / np.hypot(*(end - pull))
    curve = Path([start, pull, rim], [Path.MOVETO, Path.CURVE3, Path.CURVE3])
    arrow = FancyArrowPatch(
        path=curve, arrowstyle="-|>", mutation_scale=12, color=style.INK, linewidth=1
    )
    ax.add_patch(arrow)
    u = np.array([[0.5, 0.42, 0.58, 0.34, 0.66, 0.2, 0.8]]).T
    along = (1 - u) ** 2 * start + 2 * u * (1 - u) * pull + u**2 * rim
    place = _free(along[:5], taken)
    taken += list(along[5:])
    white = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
    return arrow, _word(ax, place, f"{p:.3g}", fontsize=8, bbox=white)


def _spiral(
    ax: Axes, start: NDArray[np.float64], reward: float, taken: list[NDArray[np.float64]]
) -> tuple[Line2D, Text]:
    """Draw a coil that leaves a choice where there is room, and the reward at its end."""
    around = np.linspace(0, 2 * np.pi, 25)[:-1]
    ways = np.column_stack([np.cos(around), np.sin(around)])
    end = _free(start + 1.08 * ways, taken)
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    turn = np.linspace(0, 4 * 2 * np.pi, 120)
    forth = 0.15 + 0.5 * turn / turn[-1] + 0.07 * (1 - np.cos(turn))
    coil = start + np.outer(forth, along) + np.outer(0.09 * np.sin(turn), across)
    (line,) = ax.plot(*coil.T, color=style.OURS, linewidth=1.2)
    words = f"{reward:+.3g}".replace("-", "−")
    return line, _word(ax, end, words, color=style.OURS, weight="bold")


def _dot(ax: Axes, place: NDArray[np.float64], name: str) -> Text:
    box = {"boxstyle": "round,pad=0.25", "facecolor": style.CELLS[3], "edgecolor": style.INK}
    return _word(ax, place, name, fontsize=9, bbox=box)


def _disc(ax: Axes, place: NDArray[np.float64], name: str, end: bool) -> Text:
    for radius in (_RADIUS, _RADIUS - 0.07) if end else (_RADIUS,):
        x, y = place
        ax.add_patch(Circle((x, y), radius, facecolor=style.CELLS[0], edgecolor=style.INK))
    return _word(ax, place, name, fontsize=9)


def _word(ax: Axes, place: NDArray[np.float64], words: str, **look: Any) -> Text:
    look = {"ha": "center", "va": "center", "color": style.INK} | look
    return ax.text(place[0], place[1], words, **look)


# --- figures 4.3 and 4.4 --------------------------------------------------------------------------


class Line(NamedTuple):
    """A line of a procedure that runs.

    `of` are the numbers of the printed lines it stands for; `changed`, whether it says something
    else; `event`, what the code is seen to do there.
    """

    indent: int
    words: str
    of: tuple[int, ...] = ()
    changed: bool = True
    event: str = ""


class Procedure(NamedTuple):
    """A procedure as it is printed, in short, line by line with its indent; and as it runs."""

    name: str
    printed: tuple[tuple[int, str], ...]
    runs: tuple[Line, ...]


_LOOP = "while the state is still s"
_HELD = (
    Line(1, f"{_LOOP}, at most max_repeat times", (5,)),
    Line(2, "do a", (6,), changed=False, event="perform"),
    Line(1, "take the rewards r1 ... rk and the new state s'", (7, 8)),
    Line(1, "r = r1 + γ r2 + ... + γ^(k-1) rk"),
    Line(1, "Q[s][a] += α (r + γ^k max Q[s'] − Q[s][a])", (9,), event="update"),
    Line(1, "episode over: no Q[s'] above, and reset", event="maybe reset"),
    Line(1, "s = the state now", (), event=""),
)

#: Figure 4.3 and `arkaq_edu.mdp.explore`.
EXPLORATION = Procedure(
    "exploration",
    (
        (0, "t = 0"),
        (0, "a fresh table Q[S][A]"),
        (0, "while Q has not converged"),
        (1, "pick a at random"),
        (1, "find the current state s"),
        (1, _LOOP),
        (2, "do a"),
        (1, "take the reward r"),
        (1, "take the new state s'"),
        (1, "evaluate Q[s][a]"),
    ),
    (
        Line(0, "a fresh table Q[S][A]", (1,), changed=False),
        Line(0, "reset; find the state s", (4,), event="reset"),
        Line(0, "until all was tried anew and changed Q by <= tol", (2,)),
        Line(1, "pick a at random, the untried in s first", (3,), event="choose"),
        *_HELD,
    ),
)

#: Figure 4.4 and `arkaq_edu.mdp.exploit`.
EXPLOITATION = Procedure(
    "exploitation",
    (
        (0, "t = 0"),
        (0, "the table Q[S][A] of the exploration"),
        (0, "while Q has not converged"),
        (1, "pick a among those of high Q"),
        (1, "find the current state s"),
        (1, _LOOP),
        (2, "do a"),
        (1, "take the reward r"),
        (1, "take the new state s'"),
        (1, "evaluate Q[s][a]"),
    ),
    (
        Line(0, "the table Q[S][A] of the exploration", (1,), changed=False),
        Line(0, "reset; find the state s", (4,), event="reset"),
        Line(0, "until Q has long changed by <= tol", (2,)),
        Line(1, "draw a by exp(Q[s][a] / T), T falling", (3,), event="choose"),
        *_HELD,
    ),
)


class ProcedurePlot(NamedTuple):
    """What figures 4.3 and 4.4 drew: printed lines, running lines, and what became of which."""

    ax: Axes
    printed: list[Text]
    runs: list[Text]
    links: dict[tuple[int, int], Line2D]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def figure_4_3(ax: Axes | None = None) -> ProcedurePlot:
    """Draw figure 4.3, Q-learning while it explores: as printed, and as it runs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    ProcedurePlot
        ``printed`` and ``runs``, a text a line; ``links`` from a printed line to a running one.

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


def figure_4_4(ax: Axes | None = None) -> ProcedurePlot:
    """Draw figure 4.4, Q-learning while it exploits: as printed, and as it runs.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    ProcedurePlot
        ``printed`` and ``runs``, a text a line; ``links`` from a printed line to a running one.

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


def _procedure(procedure: Procedure, ax: Axes | None) -> ProcedurePlot:
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
    ax.text(0.0, 0.4, "as printed", weight="bold", color=style.INK)
    ax.text(right + 0.2, 0.4, "as it runs", weight="bold", color=style.OURS)
    texts = []
    for i, (indent, text) in enumerate(printed):
        color = style.INK if i in used else style.QUIET
        texts.append(words(ax, (0.3 * indent, _row(i)), text, "left", color))
        style.measurements([left], [_row(i)], ax, color=color, markersize=4)
    lines, links = [], {}
    for j, line in enumerate(runs):
        color = style.OURS if line.changed else style.INK
        place = (right + 0.2 + 0.3 * line.indent, _row(j))
        lines.append(words(ax, place, line.words, "left", color))
        ax.plot(right, _row(j), "o" if line.of else "P", color=color, markersize=5)
        for i in line.of:
            (links[i, j],) = ax.plot(
                [left + 0.06, right], [_row(i), _row(j)], color=color, linewidth=1, zorder=0
            )
    return ProcedurePlot(ax, texts, lines, links)


def _row(i: int) -> float:
    return -0.4 * i - 0.1


# --- values and arrows on a grid ------------------------------------------------------------------

#: From 0 to 100, lighter to darker: `style.OURS` on white.
SHADES = tuple(
    to_hex((1 - share) + share * np.array(to_rgb(style.OURS)))
    for share in np.linspace(0.06, 0.62, 32)
)
#: What is no floor, and what lies on it.
STONE, HOLE, BALL = style.QUIET, style.INK, "#e8782a"
_ARROW = np.array(
    [[-0.3, -0.035], [0.08, -0.035], [0.08, -0.13], [0.32, 0], [0.08, 0.13], [0.08, 0.035],
     [-0.3, 0.035]]
)  # fmt: skip


class GridPlot(NamedTuple):
    """What `plot_grid` drew: squares shaded by value, arrows, and a number a state."""

    ax: Axes
    squares: PolyCollection
    arrows: PolyCollection
    numbers: list[Text]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or f"{len(self.arrows.get_paths())} arrows"


class Floor(NamedTuple):
    """The polygons that show a grid world: a square a state with its shade, walls, arrows.

    `shades` counts into `SHADES`; `arrows` holds one for each best action, none where all are.
    """

    squares: list[NDArray[np.float64]]
    shades: list[int]
    walls: list[NDArray[np.float64]]
    holes: list[NDArray[np.float64]]
    balls: list[NDArray[np.float64]]
    arrows: list[NDArray[np.float64]]


def floor_polygons(grid: Grid, V: ArrayLike, best: ArrayLike) -> Floor:
    """Return what shows values and best actions on a floor, a unit a square, as polygons.

    Parameters
    ----------
    grid : Grid
        The floor.
    V : array_like, shape (S,)
        The value of each state, darker up to 100; below 0 is as light as 0.
    best : array_like of bool, shape (S, A)
        Which actions are the best of their state (see `arkaq_edu.mdp.best_actions`).

    Returns
    -------
    Floor

    Raises
    ------
    ValueError
        If a shape does not fit.

    Examples
    --------
    >>> import numpy as np
    >>> from arkaq_edu.mdp import grid_world
    >>> grid = grid_world(["..o"])
    >>> floor = floor_polygons(grid, [0.0, 100.0, 0.0], np.eye(4)[[0, 0, 0]])
    >>> len(floor.arrows), floor.shades, floor.arrows[1].max(axis=0).round(2)
    (2, [0, 31, 0], array([1.82, 0.76]))
    """
    V = _checks.array("V", V, (grid.mdp.n_states,))
    best = _checks.array("best", best, grid.mdp.R.shape) > 0
    shades = np.rint(np.clip(V / 100, 0, 1) * (len(SHADES) - 1)).astype(int).tolist()
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    top = len(grid.plan) - 1
    signs = {(x, top - y): sign for y, row in enumerate(grid.plan) for x, sign in enumerate(row)}
    around = np.linspace(0, 2 * np.pi, 25)[:-1]
    disc = 0.5 + 0.3 * np.column_stack([np.cos(around), np.sin(around)])
    arrows = []
    for place, row, end in zip(grid.places, best, grid.mdp.ends, strict=True):
        for dx, dy in np.array(list(MOVES.values()))[row & ~row.all() & ~end]:
            turned = _ARROW @ np.array([[dx, dy], [-dy, dx]])
            arrows.append(
                place + [0.5, 0.63 if dy == 0 else 0.6] + turned * (1 if dy == 0 else 0.9)
            )

    def shown(sign: str, shape: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        return [place + shape for place, found in signs.items() if found == sign]

    return Floor(
        [place + corners for place in grid.places], shades, shown(WALL, corners),
        shown("x", corners), shown("o", disc), arrows,
    )  # fmt: skip


def plot_grid(
    grid: Grid, V: ArrayLike, best: ArrayLike, ax: Axes | None = None, *, title: str = ""
) -> GridPlot:
    """Draw the values of a grid world as shades and numbers, and its best actions as arrows.

    Walls are gray, holes black, the ball is orange. Where several actions are best, each has its
    arrow; where all are, there is none.

    Parameters
    ----------
    grid : Grid
        The floor.
    V : array_like, shape (S,)
        The value of each state.
    best : array_like of bool, shape (S, A)
        Which actions are the best of their state (see `arkaq_edu.mdp.best_actions`).
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.

    Returns
    -------
    GridPlot

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
    (width, height) = len(grid.plan[0]), len(grid.plan)
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
    return GridPlot(ax, squares, arrows, numbers)


# --- how an error falls ---------------------------------------------------------------------------


class BandsPlot(NamedTuple):
    """What `plot_bands` drew: for each name the mean over the runs, and a band around it."""

    ax: Axes
    bands: dict[str, tuple[Line2D, FillBetweenPolyCollection]]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or ", ".join(self.bands)


def plot_bands(
    x: ArrayLike,
    runs: Mapping[str, ArrayLike],
    ax: Axes | None = None,
    *,
    xlabel: str = "",
    ylabel: str = "",
    title: str = "",
) -> BandsPlot:
    """Draw what several ways of learning do over many runs: the mean, and one sigma each side.

    Parameters
    ----------
    x : array_like, shape (n,)
        When it was measured; the axis is logarithmic.
    runs : mapping of str to array_like, shape (runs, n)
        What was measured, a row for each run.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    xlabel, ylabel : str
        What runs along the axes.
    title : str
        What the picture states.

    Returns
    -------
    BandsPlot

    Raises
    ------
    ValueError
        If a shape does not fit, or there are more names than colors.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_bands([1, 10], {"slow": [[3.0, 1.0], [5.0, 3.0]]}, Figure().subplots())
    >>> plot.bands["slow"][0].get_ydata()
    array([4., 2.])
    """
    looks = ((style.OURS, "-"), (style.ACTIONS["right"], "--"), (style.INK, ":"))
    if len(runs) > len(looks):
        raise ValueError(f"runs must hold at most {len(looks)} names, got {len(runs)}")
    x = _checks.array("x", x, (None,))
    ax = style.axes(ax, xlabel=xlabel, ylabel=ylabel, title=title)
    ax.set_xscale("log")
    bands = {}
    for (name, values), (color, dash) in zip(runs.items(), looks, strict=False):
        found = _checks.array(name, values, (None, len(x)))
        bands[name] = style.band(
            x, found.mean(axis=0), found.std(axis=0), ax, color=color, linestyle=dash, label=name
        )
    ax.legend(frameon=False)
    return BandsPlot(ax, bands)
