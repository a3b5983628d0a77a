"""Figures 3.1 and 3.2: every part is on the way from a look to a step, and back."""

import pytest
from matplotlib.figure import Figure

from arkaq_edu.figures import arkaq, gallery


def reached(plot, start):
    """The parts that a signal from `start` gets to along the wires."""
    found, front = set(), {start}
    while front:
        found |= front
        front = {end for begin, end in plot.wires if begin in found} - found
    return found


@pytest.mark.parametrize("draw", [arkaq.figure_3_1, arkaq.figure_3_2])
def test_what_is_seen_comes_back_to_the_world_as_an_action(draw):
    plot = draw(Figure().subplots())
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
