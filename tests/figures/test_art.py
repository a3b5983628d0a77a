"""Figures 2.18 to 2.21 and the pictures of networks at work: drawn is what was computed."""

import itertools

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import PatchCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch

from arkaq_edu.art import ART1, ART2, LETTERS
from arkaq_edu.art.reset import COSINES
from arkaq_edu.figures import art
from arkaq_edu.figures.drawing import style

DIAGRAMS = {"2.18": art.figure_2_18, "2.19": art.figure_2_19, "2.20": art.figure_2_20}
L, T, F, E, I = (LETTERS[name] for name in "LTFEI")  # noqa: E741


def fresh_axes():
    return Figure(layout="constrained").subplots()


# Diagrams


@pytest.mark.parametrize("number", DIAGRAMS)
def test_a_diagram_draws_where_it_is_told(number, monkeypatch):
    monkeypatch.setattr(plt, "subplots", lambda *_, **__: pytest.fail("opened a window"))
    ax = fresh_axes()
    plot = DIAGRAMS[number](ax)
    assert plot.ax is ax and not ax.axison
    assert repr(plot) == ax.get_title(loc="left") != ""
    assert f"figure {number}," in DIAGRAMS[number].__doc__


@pytest.mark.parametrize("number", DIAGRAMS)
def test_no_words_cover_each_other_or_leave_the_picture(number):
    plot = DIAGRAMS[number](fresh_axes())
    plot.ax.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in [*plot.ax.texts, plot.ax._left_title]]
    for one, other in itertools.combinations(boxes, 2):
        assert not one.overlaps(other)
    frame = plot.ax.figure.bbox
    for box in boxes:
        assert frame.x0 <= box.x0 and box.x1 <= frame.x1
        assert frame.y0 <= box.y0 and box.y1 <= frame.y1


@pytest.mark.parametrize("number", DIAGRAMS)
def test_words_in_a_box_fit_into_it(number):
    plot = DIAGRAMS[number](fresh_axes())
    plot.ax.figure.canvas.draw()
    frames = [p for p in plot.ax.patches if isinstance(p, FancyBboxPatch | Circle)]
    for text in plot.parts.values():
        words = text.get_window_extent()
        middle = (words.x0 + words.x1) / 2, (words.y0 + words.y1) / 2
        for box in (frame.get_window_extent() for frame in frames):
            if box.contains(*middle):
                assert box.x0 < words.x0 and words.x1 < box.x1
                assert box.y0 < words.y0 and words.y1 < box.y1


# What the equations of section 2.4 say of which activity follows which.
ART2_WIRES = {
    ("I", "w"), ("u", "w"), ("w", "x"), ("x", "v"), ("q", "v"), ("v", "u"), ("u", "p"),
    ("y", "p"), ("p", "q"), ("p", "y"), ("u", "r"), ("p", "r"), ("r", "y"),
}  # fmt: skip


@pytest.mark.thesis("figure 2.20")
def test_art2_is_wired_as_its_equations_are():
    assert set(art.figure_2_20(fresh_axes()).wires) == ART2_WIRES


@pytest.mark.thesis("figure 2.19")
def test_art1_has_two_of_three_at_f1_and_resets_f2():
    wires = set(art.figure_2_19(fresh_axes()).wires)
    assert {source for source, target in wires if target == "F1"} == {"I", "gain 1", "F2"}
    assert {source for source, target in wires if target == "A"} == {"I", "F1"}
    assert ("A", "F2") in wires and ("F2", "gain 1") in wires


@pytest.mark.thesis("figures 2.18 to 2.20")
@pytest.mark.parametrize("number", DIAGRAMS)
def test_an_arrow_between_parts_ends_at_them(number):
    plot = DIAGRAMS[number](fresh_axes())
    plot.ax.figure.canvas.draw()
    shapes = [p for p in plot.ax.patches if isinstance(p, FancyBboxPatch | Circle)]
    for arrow in plot.wires.values():
        tip = plot.ax.transData.transform(arrow._path_original.vertices[-1])
        boxes = [shape.get_window_extent() for shape in shapes]
        gaps = [
            np.hypot(
                max(box.x0 - tip[0], 0, tip[0] - box.x1), max(box.y0 - tip[1], 0, tip[1] - box.y1)
            )
            for box in boxes
        ]
        assert min(gaps) < 3


# The reset


def test_figure_2_21_is_equation_2_47():
    plot = art.figure_2_21(fresh_axes(), c=0.2, d=0.8, vigilance=0.9)
    assert list(plot.curves) == list(COSINES)
    for cosine, curve in plot.curves.items():
        cdz, norm_r = curve.get_data()
        assert cdz[0] == 0 and cdz[-1] == pytest.approx(0.2 * 0.8 / 0.2)
        # From the vectors themselves: u = (1, 0), z at the angle.
        dz = cdz[:, None] / 0.2 * [cosine, np.sqrt(1 - cosine**2)]
        p = dz + np.array([1.0, 0.0])
        r = ([1, 0] + 0.2 * p) / (1 + 0.2 * np.linalg.norm(p, axis=1, keepdims=True))
        assert norm_r == pytest.approx(np.linalg.norm(r, axis=1))
    assert plot.vigilance.get_ydata() == [0.9, 0.9]
    assert "vigilance 0.9 " in repr(plot) and "(c = 0.2, d = 0.8)" in repr(plot)


def test_figure_2_21_has_no_words_on_one_another():
    plot = art.figure_2_21(fresh_axes())
    plot.ax.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in plot.ax.texts]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))


# Networks at work


def fills(ax):
    grids = [c for c in ax.collections if isinstance(c, PatchCollection)]
    return [[to_hex(color) == style.INK for color in grid.get_facecolors()] for grid in grids]


def test_letters_are_drawn_point_by_point():
    plot = art.plot_letters([L, T], ["ell", "tee"], fresh_axes(), title="two letters")
    assert fills(plot.ax) == [(L > 0).tolist(), (T > 0).tolist()]
    assert [text.get_text() for text in plot.words] == ["ell", "tee"]
    assert repr(plot) == "two letters"
    # The L's foot is at the bottom: its first row is drawn highest.
    corners = [path.vertices.min(axis=0) for path in plot.ax.collections[0].get_paths()]
    assert corners[0].tolist() == [0, 4] and corners[-1].tolist() == [4, 0]


def test_a_width_that_does_not_divide_is_refused():
    with pytest.raises(ValueError, match="columns must divide the 25 points of a pattern, got 4"):
        art.plot_letters([L], ax=fresh_axes(), columns=4)


def test_a_search_is_drawn_as_the_trace_has_it():
    network = ART1(0.8).fit([L, T, F])
    plot = art.plot_search(network.trace(E), {0: "L", 1: "T", 2: "F"}, fresh_axes())
    expected = [E, E & F, E & L, E & T, E]
    assert fills(plot.ax) == [(grid > 0).tolist() for grid in expected]
    crosses = [len(line.get_xdata()) for line in plot.ax.lines]
    assert crosses == [(E - grid).sum() for grid in expected]
    assert repr(plot) == "3 resets, then node 3 is in resonance"
    words = [text.get_text() for text in plot.words]
    assert words[1] == f"F\nmatch {(E & F).sum() / E.sum():.2f}\nreset"
    assert words[0] == "input alone" and words[-1].endswith("resonance")


def test_a_silent_pattern_finds_no_node():
    plot = art.plot_search(ART1(0.8).fit([L]).trace(0 * L), ax=fresh_axes())
    assert repr(plot) == "0 resets, then no node is left" and len(plot.grids) == 1


def test_settling_is_drawn_from_the_input_to_the_resonance():
    network = ART2(0.95, theta=0.3, a=2, b=2, signal="smooth").fit([[0, 0, 1.0]])
    trace = network.trace([1.0, 0.5, 0.25])
    plot = art.plot_settling(trace, 0.3, fresh_axes())
    u = trace.pivot(index="step", columns="feature", values="u").to_numpy()
    unit = np.array([1.0, 0.5, 0.25]) / np.linalg.norm([1.0, 0.5, 0.25])
    for feature, line in enumerate(plot.lines):
        assert line.get_ydata() == pytest.approx([unit[feature], *u[:, feature]])
    assert repr(plot) == "2 of 3 active features are above theta"
    assert "F2 chooses node 1" in [text.get_text() for text in plot.ax.texts]
