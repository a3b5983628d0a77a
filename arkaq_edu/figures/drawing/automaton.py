"""An automaton as boxes and arrows, drawn from the table that runs.

Examples
--------
>>> from arkaq_edu.arkaq import Automaton
>>> from matplotlib.figure import Figure
>>> door = Automaton("shut", {("shut", "push"): "open", ("open", "leave"): "done"})
>>> places = {"shut": (0, 0), "open": (3, 0), "done": (6, 0)}
>>> plot_automaton(door, places, Figure().subplots(), title="a door that is left open")
a door that is left open
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

from arkaq_edu.arkaq.automata import DONE, Automaton
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Place, box
from arkaq_edu.figures.drawing.plot import Plot

WIDTH, HEIGHT = 1.3, 0.42


def plot_automaton(
    automaton: Automaton,
    places: Mapping[str, Place],
    ax: Axes | None = None,
    *,
    title: str = "",
) -> Plot:
    """Draw the states of an automaton, and an arrow for each step from one to another.

    Parameters
    ----------
    automaton : Automaton
        The table.
    places : mapping of state to (x, y)
        The center of each state, including the end "done". A state is 1.3 wide and .42 high.
    ax : matplotlib.axes.Axes, optional
        Where to draw. The default is new axes.
    title : str
        What the picture states.

    Returns
    -------
    Plot
        ``states``, the text of each state, and ``transitions``, the arrow and the label of each
        (state, event). Events with the same start and end share an arrow and a label.

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
    events: dict[tuple[str, str], list[str]] = {}
    for (state, event), following in automaton.table.items():
        events.setdefault((state, following), []).append(event)
    transitions: dict[tuple[str, str], tuple[FancyArrowPatch, Text]] = {}
    for (state, following), together in events.items():
        drawn = _labeled_arrow(ax, places[state], places[following], "\nor ".join(together))
        transitions |= {(state, event): drawn for event in together}
    states = {}
    for name in names:
        states[name] = box(ax, places[name], name, width=WIDTH, height=HEIGHT)
    if DONE in names:  # the end has a double border, as is usual for automata
        box(ax, places[DONE], width=WIDTH - 0.1, height=HEIGHT - 0.1)
    x, y = places[automaton.start]
    ax.add_patch(_arrow((x - WIDTH / 2 - 0.5, y), (x - WIDTH / 2, y)))
    ax.plot(x - WIDTH / 2 - 0.5, y, "o", color=style.INK)
    ax.autoscale_view()
    return Plot(ax, f"{len(transitions)} transitions", states=states, transitions=transitions)


def _labeled_arrow(ax: Axes, start: Place, end: Place, label: str) -> tuple[FancyArrowPatch, Text]:
    if start == end:  # a loop above the box
        (x, y), top = start, HEIGHT / 2
        arrow = _arrow((x - 0.3, y + top), (x + 0.3, y + top), "arc3,rad=-1.4")
        middle = (x, y + top + 0.47)
    else:
        tail, head = _rim(start, end), _rim(end, start)
        arrow, middle = _arrow(tail, head), ((tail[0] + head[0]) / 2, (tail[1] + head[1]) / 2)
    ax.add_patch(arrow)
    white = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
    text = ax.text(
        *middle, label, ha="center", va="center", fontsize=8, color=style.INK, bbox=white
    )
    return arrow, text


def _arrow(tail: Place, head: Place, bend: str = "arc3") -> FancyArrowPatch:
    return FancyArrowPatch(
        tail, head, arrowstyle="-|>", mutation_scale=14, shrinkA=0, shrinkB=1,
        connectionstyle=bend, color=style.INK,
    )  # fmt: skip


def _rim(start: Place, end: Place) -> Place:
    """Return where the straight line between two states leaves the box of the first."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    to_side = WIDTH / 2 / abs(dx) if dx else math.inf
    to_top = HEIGHT / 2 / abs(dy) if dy else math.inf
    reach = min(to_side, to_top)
    return start[0] + reach * dx, start[1] + reach * dy
