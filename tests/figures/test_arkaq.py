"""The parts of the agent are drawn from a look to a step, and its automata as they run."""

import itertools

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from arkaq_edu.arkaq import GOAL_Q_LEARNING, GOAL_SEGMENTATION, Q_LEARNING, SEGMENTATION
from arkaq_edu.figures import arkaq, gallery
from arkaq_edu.figures.drawing.automaton import plot_automaton


def reached(plot, start):
    """The parts that a signal from `start` gets to along the wires."""
    found, front = set(), {start}
    while front:
        found |= front
        front = {end for begin, end in plot.wires if begin in found} - found
    return found


@pytest.mark.thesis("figures 3.1 and 3.2")
@pytest.mark.parametrize("draw", [arkaq.figure_3_1, arkaq.figure_3_2])
def test_what_is_seen_comes_back_to_the_world_as_an_action(draw):
    plot = draw(Figure(layout="constrained").subplots())
    assert all(reached(plot, part) == set(plot.parts) for part in plot.parts)
    assert {end for pair in plot.wires for end in pair} == set(plot.parts)


def test_the_filter_is_told_of_the_action_and_the_table_of_the_reward():
    wires = arkaq.figure_3_2(Figure().subplots()).wires
    assert ("choose", "predict") in wires and ("world", "table") in wires
    assert ("world", "choose") not in wires


def test_the_gallery_holds_all_seventy_figures():
    counts = {"2": 23, "3": 2, "4": 4, "5": 41}
    numbers = [f"{chapter}.{i}" for chapter, n in counts.items() for i in range(1, n + 1)]
    assert list(gallery.FIGURES) == numbers and len(numbers) == 70


# The automata

DRAWN = [
    (arkaq.figure_5_6, SEGMENTATION),
    (arkaq.figure_5_15, Q_LEARNING),
    (arkaq.figure_5_34, GOAL_SEGMENTATION),
    (arkaq.figure_5_38, GOAL_Q_LEARNING),
]


@pytest.mark.thesis("figures 5.6, 5.15, 5.34 and 5.38, errata row 39")
@pytest.mark.parametrize(("figure", "table"), DRAWN)
def test_every_state_and_transition_of_the_table_is_drawn(figure, table):
    plot = figure(Figure(layout="constrained").subplots())
    assert set(plot.states) == {*table.states, "done"}
    assert set(plot.transitions) == set(table.table)
    shown = {text.get_text() for text in plot.ax.texts}
    assert set(plot.states) <= shown
    for (state, event), then in table.table.items():
        arrow, label = plot.transitions[state, event]
        assert event in label.get_text().split("\nor ") and label in plot.ax.texts
        assert arrow in plot.ax.patches
        # It leaves the rim of one state's box and points at the rim of the other's.
        for place, name in zip(arrow._posA_posB, (state, then), strict=True):
            x, y = np.abs(np.subtract(place, plot.states[name].get_position()))
            assert max(x / 0.65, y / 0.21) == pytest.approx(1)


@pytest.mark.parametrize(("figure", "table"), DRAWN)
def test_no_word_covers_another_and_no_arrows_cross(figure, table):
    plot = figure(Figure(layout="constrained").subplots())
    plot.ax.figure.canvas.draw()
    labels = {label: arrow for arrow, label in plot.transitions.values()}
    words = [label.get_window_extent() for label in labels]
    boxes = [p.get_window_extent() for p in plot.ax.patches if isinstance(p, FancyBboxPatch)]
    for one, other in [*itertools.combinations(words, 2), *itertools.product(words, boxes)]:
        assert not one.overlaps(other)
    for name, text in plot.states.items():
        x0, y0, x1, y1 = text.get_window_extent().extents
        assert any(b.x0 < x0 and x1 < b.x1 and b.y0 < y0 and y1 < b.y1 for b in boxes), name
    lines = [np.array(arrow._posA_posB) for arrow in labels.values()]
    for (a, b), (c, d) in itertools.combinations(lines, 2):
        assert not (turns(a, b, c) * turns(a, b, d) < 0 and turns(c, d, a) * turns(c, d, b) < 0)


def turns(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def test_a_state_without_a_place_is_named():
    places = {k: v for k, v in arkaq.SEGMENTATION_PLACES.items() if k != "act"}
    with pytest.raises(ValueError, match="places must hold every state, got none for 'act'"):
        plot_automaton(SEGMENTATION, places, Figure(layout="constrained").subplots())


def test_the_shorter_name_of_a_place_is_only_renamed():
    assert arkaq.GOAL_SEGMENTATION_PLACES["turn"] == arkaq.SEGMENTATION_PLACES["act"]
