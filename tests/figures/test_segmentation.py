"""The map of categories, and the figures of both methods: what is drawn is what was computed."""

import itertools

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.path import Path as Polygon

from arkaq_edu.experiments import segmentation as experiment
from arkaq_edu.experiments.segmentation import LEARNING_RATE, THESIS_COUNTS
from arkaq_edu.figures import FIGURES as GALLERY
from arkaq_edu.figures import segmentation
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.plot import plain
from tests.stand_in import triangle_stream

FIGURES = {
    0.15: segmentation.figure_5_10,
    0.1: segmentation.figure_5_11,
    0.075: segmentation.figure_5_12,
    0.05: segmentation.figure_5_13,
    0.025: segmentation.figure_5_14,
}


def scattered(n, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (n, 2))


def leader_count(patterns, vigilance, eta):
    """Count centers by a search through all of them, pattern by pattern."""
    centers = patterns[:1].copy()
    for x in patterns[1:]:
        gaps = np.sqrt(((centers - x) ** 2).sum(axis=1))
        j = gaps.argmin()
        if gaps[j] < vigilance:
            centers[j] += eta * (x - centers[j])
        else:
            centers = np.vstack([centers, x])
    return len(centers)


@pytest.mark.parametrize("centers", [[[0.0]], [[0.0, np.nan]], [0.0, 1.0]])
def test_refuses_what_is_no_list_of_centers(centers):
    with pytest.raises(ValueError, match="centers must"):
        segmentation.plot_centers(centers, Figure().subplots())


def test_draws_centers_in_the_robots_view():
    near_left, far_right = [(1000 - 2150) / 1950, 0.6], [(4000 - 2150) / 1950, -0.8]
    plot = segmentation.plot_centers([near_left, far_right], Figure().subplots(), title="two")
    assert plot.centers.get_xdata() == pytest.approx([0.3, -0.4])
    assert plot.centers.get_ydata() == pytest.approx([1000, 4000])
    assert repr(plot) == plot.ax.get_title(loc="left") == "two"
    # What is left of the robot is drawn on the left, what is far is drawn high.
    (left, low), (right, high) = plot.ax.transData.transform([(0.3, 1000), (-0.4, 4000)])
    assert left < right and low < high
    assert "rad" in plot.ax.get_xlabel() and "mm" in plot.ax.get_ylabel()
    one, other = map(to_hex, plot.cells.get_facecolors())
    assert one != other and {one, other} <= set(style.CELLS)


@pytest.mark.thesis("figures 5.10 to 5.14")
@pytest.mark.parametrize("vigilance", FIGURES)
def test_a_figure_prints_the_thesiss_count_and_ours(vigilance):
    patterns = triangle_stream(1500)
    plot = FIGURES[vigilance](Figure().subplots(), patterns=patterns, learning_rate=0.4)
    ours, thesis = leader_count(patterns, vigilance, 0.4), THESIS_COUNTS[vigilance]
    assert plot.n_centers == ours == len(plot.centers.get_xdata()) == len(plot.cells.get_paths())
    counted = f"{ours:,} categories at vigilance {vigilance}"
    assert repr(plot) == f"{counted}, the thesis printed {thesis:,}"


def test_a_figure_makes_its_own_axes_and_shows_nothing(monkeypatch):
    patterns = triangle_stream(300)
    monkeypatch.setattr(experiment, "recorded_patterns", lambda: patterns)
    monkeypatch.setattr(plt, "show", lambda *_: pytest.fail("plt.show was called"))
    before = plt.get_fignums()
    plot = segmentation.figure_5_10()
    assert plot.n_centers == leader_count(patterns, 0.15, LEARNING_RATE)
    assert plt.get_fignums() == [*before, plot.ax.figure.number]
    plt.close(plot.ax.figure)
    segmentation.figure_5_10(Figure().subplots())
    assert plt.get_fignums() == before


@pytest.mark.parametrize("number", ["4.1", "4.2", "5.9"])
def test_the_figures_of_both_methods_draw_where_they_are_told(number, monkeypatch):
    monkeypatch.setattr(plt, "subplots", lambda *_, **__: pytest.fail("opened a window"))
    ax = Figure(layout="constrained").subplots()
    plot = GALLERY[number](ax)
    assert plot.ax is ax and repr(plot) == plain(ax.get_title(loc="left")) != ""
    ax.figure.canvas.draw()


def angles(vectors):
    return np.degrees(np.angle(np.asarray(vectors) @ [1, 1j]))


def tips(arrows):
    return np.column_stack([arrows.U, arrows.V])


@pytest.mark.parametrize(("rate", "times"), [(0.3, 3), (0.1, 1), (1.0, 2)])
def test_a_template_turns_towards_its_pattern_and_keeps_its_length(rate, times):
    plot = segmentation.figure_4_1(Figure().subplots(), learning_rate=rate, times=times)
    before, after = tips(plot.before), tips(plot.after)
    w, x = before[0] @ [1, 1j], np.array(plot.patterns.get_xydata())[0] @ [1, 1j]
    for _ in range(times):
        w = (1 - rate) * w + rate * x / abs(x)
        w /= abs(w)
    assert after[0] @ [1, 1j] == pytest.approx(w)
    assert after[1] == pytest.approx(before[1])
    start, end, aim = np.rint(angles([before[0], after[0], [x.real, x.imag]])).astype(int)
    assert repr(plot) == f"{times} times x1: w1 turns from {start}° to {end}°, x1 lies at {aim}°"
    assert plot.patterns.get_markerfacecolor() == "none"


def test_a_pattern_out_of_every_angle_founds_a_template():
    plot = segmentation.figure_4_1(Figure().subplots(), vigilance=0.95)
    assert len(tips(plot.before)) == 2 and len(tips(plot.after)) == 3
    assert angles(tips(plot.after)[2:]) == pytest.approx(50)


@pytest.mark.parametrize("eta", [0.25, 0.5, 1.0])
def test_the_near_pattern_moves_a_center_and_the_far_one_founds_one(eta):
    plot = segmentation.figure_4_2(Figure().subplots(), learning_rate=eta)
    old, new = plot.before.get_xydata(), plot.after.get_xydata()
    x1, x2 = plot.patterns.get_xydata()
    assert new[0] == pytest.approx((1 - eta) * old[0] + eta * x1)
    assert new[1] == pytest.approx(old[1]) and new[2] == pytest.approx(x2)
    for circle, center in zip(plot.reach, old, strict=True):
        inside = [np.hypot(*(x - circle.center)) < circle.get_radius() for x in (x1, x2)]
        assert circle.center == pytest.approx(center) and circle.get_radius() == 0.4
        assert inside == [circle is plot.reach[0], False]


@pytest.mark.parametrize("vigilance", [0.5, 0.8, 0.95])
def test_a_sector_holds_the_patterns_most_aligned_with_its_template(vigilance):
    patterns = triangle_stream(2000)
    plot = segmentation.figure_5_9(Figure().subplots(), vigilance=vigilance, patterns=patterns)
    way = np.array([arrow[1] - arrow[0] for arrow in plot.templates.get_segments()])
    directions = way[:, ::-1] / [1950, 0.5]
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1)
    points = scattered(500, seed=2)
    own = (points @ directions.T).argmax(axis=1)
    seen = np.column_stack([points[:, 1] / 2, 2150 + 1950 * points[:, 0]])
    sectors = [Polygon(path.vertices) for path in plot.cells.get_paths()]
    inside = np.array([sector.contains_points(seen) for sector in sectors])
    assert plot.n_templates == len(sectors) == len(directions)
    assert inside.sum(axis=0).tolist() == [1] * len(points)
    assert inside.argmax(axis=0).tolist() == own.tolist()
    assert repr(plot).startswith(f"{len(directions)} templates at cosine {vigilance:g}, an angle")
    assert plot.example.get_xydata() == pytest.approx(np.array([[0.3, 2100.0]]))
    mine = directions @ [(2100 - 2150) / 1950, 0.6]
    tip = directions[mine.argmax()]
    assert plot.chosen.get_xydata()[0] == pytest.approx([tip[1] / 2, 2150 + 1950 * tip[0]])


def test_measurements_are_hollow_and_a_band_is_one_standard_deviation():
    ax = Figure().subplots()
    marks = style.measurements([1, 2], [3, 4], ax)
    assert marks.get_linestyle() == "None" and marks.get_markerfacecolor() == "none"
    x, mean, std = np.arange(3.0), np.array([1.0, 2.0, 4.0]), np.array([0.5, 1.0, 0.25])
    line, area = style.band(x, mean, std, ax)
    assert line.get_ydata() == pytest.approx(mean)
    corners = {tuple(corner) for corner in area.get_paths()[0].vertices}
    assert corners >= set(zip(x, mean - std, strict=True)) | set(zip(x, mean + std, strict=True))


# How the three kinds of color blindness see linear RGB (Machado, Oliveira and Fernandes 2009,
# severity 1), and how everybody does.
EYES = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)


def seen(color, eye="normal"):
    """CIELAB of a color as an eye sees it."""
    rgb = np.array(to_rgb(color))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(np.asarray(EYES[eye]) @ linear, 0, 1) / TO_XYZ.sum(axis=1)
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def least_difference(colors, eye):
    pairs = itertools.combinations([seen(color, eye) for color in colors], 2)
    return min(np.linalg.norm(one - other) for one, other in pairs)


@pytest.mark.parametrize("eye", EYES)
def test_colors_stay_apart_for_every_eye(eye):
    assert least_difference(style.ACTIONS.values(), eye) > 25
    assert least_difference(style.CELLS, eye) > 10  # 2 or 3 is what an eye can just tell


def test_colors_stay_apart_in_grey():
    def gaps(colors):
        return np.diff(sorted(seen(color)[0] for color in colors))

    assert gaps(style.ACTIONS.values()).min() > 12
    assert gaps(style.CELLS).min() > 3
