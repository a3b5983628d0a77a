"""The pictures of the chapter on belief states, against the thesis and against counting."""

import itertools
from fractions import Fraction

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

from arkaq_edu.figures import belief
from arkaq_edu.figures.drawing import style
from arkaq_edu.pomdp import Calibration, problem

NAN = float("nan")
CELLS = 4


@pytest.fixture
def ax():
    return Figure().subplots()


def floors_by_counting(moves):
    """Put a robot on each floor, four to one, move them all, count them."""
    robots = [min(floor + moves, 3) for floor in range(4)]
    return [robots.count(floor) / 4 for floor in range(4)]


def corridor_by_paths(steps):
    """Sum over all paths that never meet the goal, in fractions."""
    weight = dict.fromkeys(range(CELLS), Fraction(0))
    for start in (0, 1, 3):
        for moves in itertools.product((1, -1), repeat=steps):
            cell, p = start, Fraction(1, 3)
            for move in moves:
                cell = min(max(cell + move, 0), CELLS - 1)
                p *= Fraction(9 if move == 1 else 1, 10) * (cell != 2)
            weight[cell] += p
    total = sum(weight.values())
    return [float(p / total) for p in weight.values()]


def test_figure_2_5_has_the_causes_of_a_pomdp(ax):
    causes = {}
    for start, end in belief.figure_2_5(ax).wires:
        causes.setdefault(end, set()).add(start)
    assert causes == {
        "O_t": {"S_t"},
        "B_t": {"O_t"},
        "A_t": {"B_t"},
        "R_t": {"S_t", "A_t"},
        "S_t+1": {"S_t", "A_t"},
        "O_t+1": {"S_t+1", "A_t"},
        "B_t+1": {"B_t", "A_t", "O_t+1"},
        "A_t+1": {"B_t+1"},
    }, "T(s, a, .), O(s', a, .), R(s, a), SE(b, a, o), and a policy of the belief alone"
    assert not any({"S_t", "S_t+1"} & into for name, into in causes.items() if name[0] in "AB")


def test_figure_2_6_counts_robots_where_the_thesis_counts_floors(ax):
    plot = belief.figure_2_6(ax)
    assert plot.beliefs == pytest.approx(np.array([floors_by_counting(0), floors_by_counting(1)]))
    assert plot.beliefs[1].tolist() == [0, 0.25, 0.25, 0.5]
    heights = np.array([[bar.get_height() for bar in row] for row in plot.bars])
    assert heights == pytest.approx(plot.beliefs)
    marks = np.column_stack(plot.printed.get_data())
    foot = plot.bars[1][0].get_y()
    assert marks[:, 1] - foot == pytest.approx([0, 0.33, 0.33, 0.33])
    possible = plot.beliefs[1] > 0
    assert marks[:, 1] - foot == pytest.approx(possible / possible.sum(), abs=0.004)
    assert plot.printed.get_markerfacecolor() == "none"
    for mark, bar in zip(marks, plot.bars[1], strict=True):
        assert bar.get_x() + bar.get_width() < mark[0] < bar.get_x() + 1, "beside its bar"
    assert [tick.get_text() for tick in ax.get_xticklabels()] == list(problem("floors").states)


def test_figure_2_7_is_what_the_thesis_prints(ax):
    plot = belief.figure_2_7(ax)
    printed = [[0.333, 0.333, 0, 0.333], [0.1, 0.45, 0, 0.45], [0.1, 0.164, 0, 0.736]]
    assert plot.beliefs.round(3).tolist() == printed
    assert plot.beliefs == pytest.approx(np.array([corridor_by_paths(n) for n in range(3)]))
    assert plot.printed is None
    assert repr(plot).endswith("[.100 .450 .000 .450], [.100 .164 .000 .736]")


def test_rows_of_beliefs_do_not_overlap_and_stand_in_their_order(ax):
    plot = belief.plot_beliefs([[0.0, 1.0], [1.0, 0.0]], ["left", "right"], ["then", "now"], ax)
    (upper, lower) = (row[0].get_y() for row in plot.bars)
    assert upper > lower + 1
    assert ax.get_ylim()[0] <= lower and ax.get_ylim()[1] >= upper + 1
    assert {"then", "now", "1.00", ".00"} <= {text.get_text() for text in ax.texts}


@pytest.mark.parametrize(
    ("beliefs", "names", "message"),
    [([[0.5, 0.6]], ["now"], "beliefs must sum to 1"), ([[0.5, 0.5]], ["a", "b"], "beliefs must")],
)
def test_what_is_no_belief_is_refused(ax, beliefs, names, message):
    with pytest.raises(ValueError, match=message):
        belief.plot_beliefs(beliefs, ["left", "right"], names, ax)


@pytest.mark.parametrize("p", [0.0, 0.25, 1.0])
def test_figure_2_8_has_surely_s2_on_the_left(ax, p):
    plot = belief.figure_2_8(ax, p=p)
    assert plot.belief.get_xdata() == [p]
    assert plot.line.get_xdata().tolist() == [0, 1]
    left, right = ax.get_xlim()
    assert left < 0 < 1 < right
    sure = {text.get_text(): text.xy[0] for text in ax.texts if "surely" in text.get_text()}
    assert sure == {"surely $s_2$": 0, "surely $s_1$": 1}


def test_figure_2_13_is_equation_2_16(ax):
    pomdp, p = problem("two_state"), 0.4
    plot = belief.figure_2_13(ax, p=p)
    assert len(plot.successors) == 6
    areas = {}
    for (action, observation), dot in plot.successors.items():
        a, z = pomdp.actions.index(action), pomdp.observations.index(observation)
        joint = [
            sum(w * pomdp.T[a, s, t] for s, w in enumerate((p, 1 - p))) * pomdp.O[a, t, z]
            for t in range(2)
        ]
        assert dot.get_xdata()[0] == pytest.approx(joint[0] / sum(joint))
        areas[action, observation] = dot.get_markersize() ** 2, sum(joint)
    ratios = [area / chance for area, chance in areas.values()]
    assert ratios == pytest.approx([plot.start.get_markersize() ** 2] * 6), "areas are chances"
    assert plot.start.get_xdata() == [p]
    colors = {action: dot.get_color() for (action, _), dot in plot.successors.items()}
    assert len(set(colors.values())) == 2


@pytest.mark.parametrize("p", [-0.1, 1.5])
@pytest.mark.parametrize("figure", [belief.figure_2_8, belief.figure_2_13])
def test_a_belief_outside_its_line_is_refused(ax, figure, p):
    with pytest.raises(ValueError, match="p must"):
        figure(ax, p=p)


def test_a_run_shows_the_belief_in_the_truth_and_what_misled_it(ax):
    beliefs = [[0.9, 0.1], [0.3, 0.7], [0.5, 0.5]]
    plot = belief.plot_run(beliefs, [0, 0, 1], [False, True, False], ax)
    assert plot.on_truth.get_xdata().tolist() == [1, 2, 3]
    assert plot.on_truth.get_ydata().tolist() == [0.9, 0.3, 0.5]
    assert [line[0, 0] for line in plot.changes.get_segments()] == [3]
    assert plot.misled.get_xdata().tolist() == [2]
    assert plot.misled.get_markerfacecolor() == "none"
    with pytest.raises(ValueError, match="truth must"):
        belief.plot_run(beliefs, [0, 0], [0, 0, 0], ax)


def test_calibration_is_a_mean_and_a_deviation_over_seeds(ax):
    shares = np.array([[0.5, NAN, 0.9], [0.7, 0.8, 1.0], [0.6, 0.6, 0.8]])
    told = Calibration(np.array([0.55, 0.75, 0.95]), shares)
    plot = belief.plot_calibration({"told": told}, ax)
    assert plot.lines["told"].get_xdata() == pytest.approx(told.claimed)
    assert plot.lines["told"].get_ydata() == pytest.approx([0.6, 0.7, 0.9])
    corners = plot.bands["told"].get_paths()[0].vertices
    top = {round(float(x), 9): y for x, y in sorted(map(tuple, corners))}
    std = [np.std([0.5, 0.7, 0.6]), 0.1, np.std([0.9, 1.0, 0.8])]
    assert [top[0.55], top[0.75], top[0.95]] == pytest.approx(np.add([0.6, 0.7, 0.9], std))
    assert plot.lines["told"].get_color() == style.OURS
    with pytest.raises(ValueError, match="colors for at most 2 names"):
        belief.plot_calibration(dict.fromkeys("abc", told), ax)


def test_every_figure_makes_its_own_axes():
    for number in ("2_5", "2_6", "2_7", "2_8", "2_13"):
        plot = getattr(belief, f"figure_{number}")()
        assert plot.ax.figure.number in plt.get_fignums()
        title = plot.ax.get_title(loc="left")
        assert title and repr(plot).startswith(title)
        plot.ax.figure.draw_without_rendering()
        plt.close(plot.ax.figure)
