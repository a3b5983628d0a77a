"""The ARKAQ agent: its parts (figures 3.1, 3.2) and its automata (5.6, 5.15, 5.34, 5.38).

References
----------
Thesis, chapter 3 and sections 5.2.1, 5.2.2, 5.3.1 and 5.3.2.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_3_1(Figure().subplots())
ARKAQ: one layer makes states of what is seen, the other decides in them
"""

from __future__ import annotations

from matplotlib.axes import Axes

from arkaq_edu.arkaq import GOAL_Q_LEARNING, GOAL_SEGMENTATION, Q_LEARNING, SEGMENTATION, Automaton
from arkaq_edu.arkaq.automata import DONE
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.automaton import plot_automaton
from arkaq_edu.figures.drawing.diagram import Place, blank, box, frame, wire, words
from arkaq_edu.figures.drawing.plot import Plot

# The centers of the states, chosen by hand so that no two arrows cross.
SEGMENTATION_PLACES = {
    "supervisor": (0.0, 1.0), "observe": (4.0, 1.0), "unknown": (2.0, 2.0),
    "network": (4.0, -1.0), "act": (0.0, -1.0), DONE: (0.0, 2.4),
}  # fmt: skip
Q_LEARNING_PLACES = {
    "supervisor": (0.0, -1.2), "identify": (1.4, 1.0), "explore": (4.1, 1.8),
    "exploit": (4.1, 0.4), "act": (6.8, 1.1), "evaluate": (5.0, -1.2), DONE: (0.0, 1.9),
}  # fmt: skip
GOAL_SEGMENTATION_PLACES = {
    "turn" if state == "act" else state: place for state, place in SEGMENTATION_PLACES.items()
}
GOAL_Q_LEARNING_PLACES = {
    "supervisor": (0.0, -1.2), "identify": (1.3, 0.7), "explore": (3.95, 1.6),
    "exploit": (3.95, 0.4), "act": (6.8, 0.4), "judge": (6.8, -1.2), "evaluate": (3.6, -1.2),
    DONE: (0.0, 1.9),
}  # fmt: skip


def figure_3_1(ax: Axes | None = None) -> Plot:
    """Draw figure 3.1, the two layers of ARKAQ.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw. The default is new axes.

    Returns
    -------
    Plot
        ``parts``, the boxes by name, and ``wires``, the arrows by (from, to).

    Notes
    -----
    The thesis calls the network ART2 here. The one its agent runs is the Euclidean one.

    References
    ----------
    Thesis, chapter 3, figure 3.1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> sorted(figure_3_1(Figure().subplots()).parts)
    ['ART', 'Kalman', 'Q', 'world']
    """
    title = "ARKAQ: one layer makes states of what is seen, the other decides in them"
    ax = blank(ax, title, (-0.7, 9.4), (-0.6, 4.4))
    frame(ax, (2.3, 2.35), 6.9, 1.8)
    frame(ax, (2.3, 0.2), 6.9, 1.5)
    parts = {
        "world": box(ax, (0.2, 2.0), "world", width=1.4, height=1.2),
        "Kalman": box(ax, (3.9, 3.05), "Kalman filter", width=1.7),
        "ART": box(ax, (7.4, 3.05), "ART network", width=1.7),
        "Q": box(ax, (7.4, 0.95), "Q-learning", width=1.7),
    }
    wires = {
        ("world", "Kalman"): wire(ax, (0.2, 2.6), (0.2, 3.05), (3.05, 3.05)),
        ("Kalman", "ART"): wire(ax, (4.75, 3.05), (6.55, 3.05)),
        ("ART", "Q"): wire(ax, (7.4, 2.7), (7.4, 1.3)),
        ("Q", "world"): wire(ax, (6.55, 0.95), (0.2, 0.95), (0.2, 1.4)),
        ("world", "Q"): wire(ax, (-0.2, 1.4), (-0.2, -0.3), (7.4, -0.3), (7.4, 0.6)),
    }
    for text, x, y in (
        ("sighting", 1.45, 3.05), ("estimate", 5.65, 3.05), ("state", 7.4, 2.0),
        ("action", 1.45, 0.95), ("reward", 4.0, -0.3),
    ):  # fmt: skip
        words(ax, (x, y), text)
    words(ax, (2.5, 3.85), "world model generator", "left", style.QUIET)
    words(ax, (2.5, 1.4), "policy generator", "left", style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


def figure_3_2(ax: Axes | None = None) -> Plot:
    """Draw figure 3.2, ARKAQ in detail: what each part passes to the next.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw. The default is new axes.

    Returns
    -------
    Plot
        ``parts``, the boxes by name, and ``wires``, the arrows by (from, to).

    References
    ----------
    Thesis, chapter 3, figure 3.2; equations 2.12 (the table), 2.55-2.59 (the filter), 3.2 (the
    choice) and 4.4-4.6 (the network). The arrow from the action back to the filter (its B u) is
    an addition of the course.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_3_2(Figure().subplots())
    >>> [end for start, end in plot.wires if start == "choose"]
    ['world', 'predict', 'table']
    """
    title = "ARKAQ in detail: pixels become a sighting, an estimate, a state, values, an action"
    ax = blank(ax, title, (-0.7, 11.2), (-1.4, 4.8))
    frame(ax, (1.7, 2.1), 9.3, 2.5)
    frame(ax, (1.7, -0.55), 9.3, 2.05)
    parts = {
        "world": box(ax, (0.1, 1.75), "world", width=1.2, height=1.0),
        "predict": box(ax, (2.7, 3.7), "predict", width=1.3),
        "correct": box(ax, (4.9, 3.0), "correct", width=1.3),
        "scale": box(ax, (6.9, 3.0), "scale", width=1.2),
        "network": box(ax, (9.4, 3.0), "nearest\ncategory", width=1.5, height=0.9),
        "table": box(ax, (9.4, 0.4), "table\n$Q(s, a)$", width=1.5, height=0.9),
        "choose": box(ax, (5.6, 0.4), "choose $a$", width=1.4),
    }
    wires = {
        ("world", "correct"): wire(ax, (0.1, 2.25), (0.1, 2.75), (4.25, 2.75)),
        ("predict", "correct"): wire(ax, (3.35, 3.7), (4.9, 3.7), (4.9, 3.35)),
        ("correct", "scale"): wire(ax, (5.55, 3.0), (6.3, 3.0)),
        ("scale", "network"): wire(ax, (7.5, 3.0), (8.65, 3.0)),
        ("network", "table"): wire(ax, (9.4, 2.55), (9.4, 0.85)),
        ("table", "choose"): wire(ax, (8.65, 0.55), (6.3, 0.55)),
        ("choose", "world"): wire(ax, (4.9, 0.4), (0.1, 0.4), (0.1, 1.25)),
        ("choose", "predict"): wire(ax, (2.7, 0.4), (2.7, 3.35)),
        ("world", "table"): wire(ax, (-0.3, 1.25), (-0.3, -1.1), (9.4, -1.1), (9.4, -0.05)),
        ("choose", "table"): wire(ax, (6.3, 0.2), (8.65, 0.2)),
    }
    for text, x, y in (
        ("sighting", 0.95, 2.75), ("action", 2.7, 1.8), ("state $s$", 9.4, 1.8),
        ("the row of $s$", 7.5, 0.85), ("action", 7.5, -0.1), ("action", 3.8, 0.4),
        ("reward $r$", 4.9, -1.1),
    ):  # fmt: skip
        words(ax, (x, y), text)
    for text, x, y in (
        ("Kalman filter", 1.9, 4.35), ("ART network", 8.65, 4.35),
        ("Boltzmann choice, cooling", 4.5, 1.25), ("Q-learning", 1.9, -0.3),
    ):  # fmt: skip
        words(ax, (x, y), text, "left", style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


def figure_5_6(ax: Axes | None = None) -> Plot:
    """Draw figure 5.6, the automaton of the segmentation; see `plot_automaton`."""
    return _automaton("segmentation", SEGMENTATION, SEGMENTATION_PLACES, ax)


def figure_5_15(ax: Axes | None = None) -> Plot:
    """Draw figure 5.15, the automaton of exploration and exploitation; see `plot_automaton`."""
    return _automaton("Q-learning", Q_LEARNING, Q_LEARNING_PLACES, ax)


def figure_5_34(ax: Axes | None = None) -> Plot:
    """Draw figure 5.34, the automaton of the goal's segmentation; see `plot_automaton`."""
    return _automaton("segmentation", GOAL_SEGMENTATION, GOAL_SEGMENTATION_PLACES, ax)


def figure_5_38(ax: Axes | None = None) -> Plot:
    """Draw figure 5.38, the automaton of the goal's Q-learning; see `plot_automaton`.

    The caption in the thesis says "segmentation".
    """
    return _automaton("Q-learning", GOAL_Q_LEARNING, GOAL_Q_LEARNING_PLACES, ax)


def _automaton(name: str, automaton: Automaton, places: dict[str, Place], ax: Axes | None) -> Plot:
    size = f"{len(automaton.states)} states and {len(automaton.table)} transitions"
    title = f"{name}: {size}, from the table that the agent runs"
    return plot_automaton(automaton, places, ax, title=title)
