"""Figures 5.6, 5.15, 5.34 and 5.38: the automata, drawn from the tables that the agent runs.

References
----------
Thesis, sections 5.2.1, 5.2.2, 5.3.1 and 5.3.2.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_5_6(Figure().subplots())
segmentation: 5 states and 9 transitions, from the table that the agent runs
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from matplotlib.text import Text

from arkaq_edu.arkaq import GOAL_Q_LEARNING, GOAL_SEGMENTATION, Q_LEARNING, SEGMENTATION, Automaton
from arkaq_edu.arkaq.automata import DONE
from arkaq_edu.figures.drawing import style

#: Where the states stand: chosen by hand so that no two arrows cross.
SEGMENTATION_PLACES = {
    "supervisor": (0.0, 1.0),
    "observe": (4.0, 1.0),
    "unknown": (2.0, 2.0),
    "network": (4.0, -1.0),
    "act": (0.0, -1.0),
    DONE: (0.0, 2.4),
}
Q_LEARNING_PLACES = {
    "supervisor": (0.0, -1.2),
    "identify": (1.4, 1.0),
    "explore": (4.1, 1.8),
    "exploit": (4.1, 0.4),
    "act": (6.8, 1.1),
    "evaluate": (5.0, -1.2),
    DONE: (0.0, 1.9),
}
GOAL_SEGMENTATION_PLACES = {
    "turn" if state == "act" else state: place for state, place in SEGMENTATION_PLACES.items()
}
GOAL_Q_LEARNING_PLACES = Q_LEARNING_PLACES | {"act": (6.8, 0.4), "judge": (6.8, -1.2)} | {
    "explore": (4.1, 1.6), "exploit": (4.1, 0.4), "identify": (1.4, 0.7), "evaluate": (3.6, -1.2),
}  # fmt: skip
_WIDTH, _HEIGHT = 1.3, 0.42
_FILL = style.CELLS[0]


class AutomatonPlot(NamedTuple):
    """What `plot_automaton` drew: the states, and for each (state, event) its arrow and label.

    Events that lead from one state to the same other share an arrow and a label.
    """

    ax: Axes
    states: dict[str, Text]
    transitions: dict[tuple[str, str], tuple[FancyArrowPatch, Text]]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or f"{len(self.transitions)} transitions"


def plot_automaton(
    automaton: Automaton,
    places: Mapping[str, tuple[float, float]],
    ax: Axes | None = None,
    *,
    title: str = "",
) -> AutomatonPlot:
    """Draw the states of an automaton, and an arrow for what leads from one to the next.

    Parameters
    ----------
    automaton : Automaton
        The table.
    places : mapping of state to (x, y)
        Where the middle of each state stands, the end "done" too; a state is 1.3 wide and .42
        high.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.

    Returns
    -------
    AutomatonPlot
        ``ax``, ``states`` and ``transitions``.

    Raises
    ------
    ValueError
        If a state has no place.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> door = Automaton("shut", {("shut", "push"): "open", ("open", "leave"): "done"})
    >>> places = {"shut": (0, 0), "open": (3, 0), "done": (6, 0)}
    >>> plot = plot_automaton(door, places, Figure().subplots())
    >>> sorted(plot.states), plot.transitions["shut", "push"][1].get_text()
    (['done', 'open', 'shut'], 'push')
    """
    names = dict.fromkeys([*automaton.states, *automaton.table.values()])
    for name in names:
        if name not in places:
            raise ValueError(f"places must hold every state, got none for {name!r}")
    ax = style.axes(ax, title=title)
    ax.axis("off")
    together: dict[tuple[str, str], list[str]] = {}
    for (state, event), then in automaton.table.items():
        together.setdefault((state, then), []).append(event)
    transitions: dict[tuple[str, str], tuple[FancyArrowPatch, Text]] = {}
    for (state, then), events in together.items():
        drawn = _draw_arrow(ax, places[state], places[then], "\nor ".join(events))
        transitions |= {(state, event): drawn for event in events}
    states = {name: _draw_state(ax, name, places[name]) for name in names}
    x, y = places[automaton.start]
    ax.add_patch(_arrow((x - _WIDTH / 2 - 0.5, y), (x - _WIDTH / 2, y)))
    ax.plot(x - _WIDTH / 2 - 0.5, y, "o", color=style.INK)
    ax.autoscale_view()
    return AutomatonPlot(ax, states, transitions)


def figure_5_6(ax: Axes | None = None) -> AutomatonPlot:
    """Draw figure 5.6, the automaton of the segmentation; see `plot_automaton`."""
    title = _fact("segmentation", SEGMENTATION)
    return plot_automaton(SEGMENTATION, SEGMENTATION_PLACES, ax, title=title)


def figure_5_15(ax: Axes | None = None) -> AutomatonPlot:
    """Draw figure 5.15, the automaton of exploration, and of exploitation with it."""
    title = _fact("Q-learning", Q_LEARNING)
    return plot_automaton(Q_LEARNING, Q_LEARNING_PLACES, ax, title=title)


def figure_5_34(ax: Axes | None = None) -> AutomatonPlot:
    """Draw figure 5.34, the automaton of the goal's segmentation; see `plot_automaton`."""
    title = _fact("segmentation", GOAL_SEGMENTATION)
    return plot_automaton(GOAL_SEGMENTATION, GOAL_SEGMENTATION_PLACES, ax, title=title)


def figure_5_38(ax: Axes | None = None) -> AutomatonPlot:
    """Draw figure 5.38, the automaton of the goal's Q-learning (captioned segmentation)."""
    title = _fact("Q-learning", GOAL_Q_LEARNING)
    return plot_automaton(GOAL_Q_LEARNING, GOAL_Q_LEARNING_PLACES, ax, title=title)


def _fact(name: str, automaton: Automaton) -> str:
    size = f"{len(automaton.states)} states and {len(automaton.table)} transitions"
    return f"{name}: {size}, from the table that the agent runs"


def _draw_state(ax: Axes, name: str, place: tuple[float, float]) -> Text:
    x, y = place
    corner = (x - _WIDTH / 2, y - _HEIGHT / 2)
    # A double border marks the end, as everywhere in the theory of automata.
    for shrink in (0.0, 0.05) if name == DONE else (0.0,):
        box = FancyBboxPatch(
            (corner[0] + shrink, corner[1] + shrink),
            _WIDTH - 2 * shrink,
            _HEIGHT - 2 * shrink,
            boxstyle="round,pad=0,rounding_size=0.15",
            facecolor=_FILL,
            edgecolor=style.INK,
        )
        ax.add_patch(box)
    return ax.text(x, y, name, ha="center", va="center", fontsize=9, color=style.INK)


def _draw_arrow(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], label: str
) -> tuple[FancyArrowPatch, Text]:
    if start == end:
        (x, y), out, up = start, 0.3, _HEIGHT / 2
        arrow = _arrow((x - out, y + up), (x + out, y + up), "arc3,rad=-1.4")
        place = (x, y + up + 0.47)
    else:
        one, other = _rim(start, end), _rim(end, start)
        arrow, place = _arrow(one, other), ((one[0] + other[0]) / 2, (one[1] + other[1]) / 2)
    ax.add_patch(arrow)
    white = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
    text = ax.text(*place, label, ha="center", va="center", fontsize=8, color=style.INK, bbox=white)
    return arrow, text


def _arrow(
    start: tuple[float, float], end: tuple[float, float], bend: str = "arc3"
) -> FancyArrowPatch:
    return FancyArrowPatch(
        start, end, arrowstyle="-|>", mutation_scale=14, shrinkA=0, shrinkB=1,
        connectionstyle=bend, color=style.INK,
    )  # fmt: skip


def _rim(of: tuple[float, float], toward: tuple[float, float]) -> tuple[float, float]:
    """Return where the straight line between two states leaves the first one's box."""
    dx, dy = toward[0] - of[0], toward[1] - of[1]
    reach = min(_WIDTH / 2 / abs(dx) if dx else math.inf, _HEIGHT / 2 / abs(dy) if dy else math.inf)
    return of[0] + reach * dx, of[1] + reach * dy
