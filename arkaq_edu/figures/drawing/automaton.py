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
from arkaq_edu.figures.drawing.diagram import Place, arrow, box, write
from arkaq_edu.figures.drawing.plot import Plot

WIDTH, HEIGHT = 1.3, 0.42
_TIP = {"mutation_scale": 14, "shrinkB": 1}


def plot_automaton(
    automaton: Automaton, places: Mapping[str, Place], ax: Axes | None = None, *, title: str = ""
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
    states = {name: box(ax, places[name], name, width=WIDTH, height=HEIGHT) for name in names}
    if DONE in names:  # the end has a double border, as is usual for automata
        box(ax, places[DONE], width=WIDTH - 0.1, height=HEIGHT - 0.1)
    right, y = places[automaton.start][0] - WIDTH / 2, places[automaton.start][1]
    arrow(ax, (right - 0.5, y), (right, y), **_TIP)
    ax.plot(right - 0.5, y, "o", color=style.INK)
    ax.autoscale_view()
    return Plot(ax, f"{len(transitions)} transitions", states=states, transitions=transitions)


def _labeled_arrow(ax: Axes, start: Place, end: Place, label: str) -> tuple[FancyArrowPatch, Text]:
    if start == end:  # a loop above the box
        (x, top), bend = (start[0], start[1] + HEIGHT / 2), -1.4
        tail, head, middle = (x - 0.3, top), (x + 0.3, top), (x, top + 0.47)
    else:
        tail, head, bend = _rim(start, end), _rim(end, start), 0.0
        middle = (tail[0] + head[0]) / 2, (tail[1] + head[1]) / 2
    drawn = arrow(ax, tail, head, bend, **_TIP)
    return drawn, write(ax, middle, label, fontsize=8, bbox=style.white(1.5))


def _rim(start: Place, end: Place) -> Place:
    """Return where the straight line between two states leaves the box of the first."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    to_side = WIDTH / 2 / abs(dx) if dx else math.inf
    to_top = HEIGHT / 2 / abs(dy) if dy else math.inf
    reach = min(to_side, to_top)
    return start[0] + reach * dx, start[1] + reach * dy
