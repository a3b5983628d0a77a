"""The pictures of the chapter on value functions: what they draw is what the plans earn."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from arkaq_edu.figures import FIGURES, pomdp
from arkaq_edu.figures.drawing.plot import plain
from arkaq_edu.figures.drawing.style import POMDP_ACTIONS
from arkaq_edu.pomdp import (
    PolicyTree,
    ValueFunction,
    all_trees,
    problem,
    solve_pomdp,
    solved,
    tree_value,
)

TWO = problem("two_state")
BELIEFS = np.linspace(0, 1, 201)


@pytest.fixture
def ax():
    return Figure().subplots()


def brute(name, horizon):
    """The values of all plans there are, and the best of them at each belief."""
    model = problem(name)
    alphas = np.array([tree_value(model, tree) for tree in all_trees(model, horizon)])
    return alphas, (np.column_stack([BELIEFS, 1 - BELIEFS]) @ alphas.T).max(axis=1)


def drawn(line, at=BELIEFS):
    return np.interp(at, *line.get_data())


def test_every_figure_of_the_chapter_is_in_the_gallery():
    for number in ("2.9", "2.10", "2.11", "2.12", "2.14", "2.15", "2.16", "2.17"):
        assert FIGURES[number] is getattr(pomdp, f"figure_{number.replace('.', '_')}")


@pytest.mark.parametrize("number", ["9", "10", "11", "12", "14", "15", "16", "17"])
def test_a_figure_makes_its_own_axes_and_says_what_it_is(number):
    plot = getattr(pomdp, f"figure_2_{number}")()
    assert plot.ax.figure.number in plt.get_fignums()
    assert repr(plot) == plain(plot.ax.get_title(loc="left")) != ""
    plot.ax.figure.draw_without_rendering()
    plt.close(plot.ax.figure)


def test_figure_2_9_has_the_actions_of_the_tree_and_a_wire_for_each_observation(ax):
    tree = PolicyTree(0, (PolicyTree(1), PolicyTree(0), PolicyTree(1)))
    plot = pomdp.figure_2_9(ax, tree=tree, pomdp=TWO)
    assert {name: text.get_text() for name, text in plot.parts.items()} == {
        "": "a1", "z1": "a2", "z2": "a1", "z3": "a2",
    }  # fmt: skip
    assert set(plot.wires) == {("", "z1"), ("", "z2"), ("", "z3")}
    heights = [plot.parts[name].get_position()[1] for name in ("", "z1")]
    assert heights[0] > heights[1]
    tiger = pomdp.figure_2_9(Figure().subplots(), pomdp=problem("tiger"))
    assert tiger.parts["hear-left hear-left"].get_text() == "open-right"
    assert len(tiger.parts) == 1 + 2 + 4 == len(tiger.wires) + 1


def test_the_tree_of_figure_2_9_is_a_best_one(ax):
    plot = pomdp.figure_2_9(ax)

    def grow(name, depth):
        branches = () if depth == 1 else [grow(f"{name} {z}".strip(), depth - 1)
                                          for z in TWO.observations]  # fmt: skip
        return PolicyTree(TWO.actions.index(plot.parts[name].get_text()), tuple(branches))

    earned = TWO.start @ tree_value(TWO, grow("", 3))
    assert earned == pytest.approx(solve_pomdp(TWO, 3).value(TWO.start))


def test_figure_2_10_is_the_upper_surface_of_three_plans(ax):
    plot = pomdp.figure_2_10(ax)
    alphas, best = brute("tiger", 1)
    assert list(plot.lines) == ["p1", "p2", "p3"]
    assert drawn(plot.surface) == pytest.approx(best)
    lines = np.array([line.get_ydata() for line in plot.lines.values()])
    assert sorted(map(tuple, lines)) == sorted(map(tuple, alphas[:, ::-1]))
    assert list(np.argsort(lines[:, 1] - lines[:, 0])) == [0, 1, 2], "from left to right"


@pytest.mark.parametrize(("horizon", "pieces"), [(1, 2), (2, 4)])
def test_figures_2_14_and_2_15_are_the_best_of_all_plans_there_are(horizon, pieces):
    _, best = brute("two_state", horizon)
    curve = pomdp.figure_2_14(Figure().subplots(), horizon=horizon)
    segments = pomdp.figure_2_15(Figure().subplots(), horizon=horizon)
    for plot in (curve, segments):
        assert drawn(plot.surface) == pytest.approx(best)
    assert len(segments.lines) == len(segments.surface.get_xdata()) - 1 == pieces


def test_the_pieces_are_those_of_the_surface_in_their_order():
    plot = pomdp.figure_2_15(Figure().subplots())
    ends = plot.surface.get_xdata()
    for i, line in enumerate(plot.lines.values()):
        mid = (ends[i] + ends[i + 1]) / 2
        assert drawn(line, mid) == pytest.approx(drawn(plot.surface, mid))
    colors = [to_rgb(line.get_color()) for line in plot.lines.values()]
    assert colors[0] == to_rgb(POMDP_ACTIONS["a2"]) and colors[-1] == to_rgb(POMDP_ACTIONS["a1"])


def test_figure_2_12_maps_beliefs_to_actions(ax):
    plot = pomdp.figure_2_12(ax)
    tiger = problem("tiger")
    for bar in plot.intervals.values():
        inside = np.linspace(bar.get_x(), bar.get_x() + bar.get_width(), 22)[1:-1]
        best = (np.column_stack([inside, 1 - inside]) @ tiger.R).argmax(axis=1)
        assert {POMDP_ACTIONS[tiger.actions[a]] for a in best} == {
            next(c for c in POMDP_ACTIONS.values() if to_rgb(c) == bar.get_facecolor()[:3])
        }
    assert sum(bar.get_width() for bar in plot.intervals.values()) == pytest.approx(1)
    assert repr(plot).startswith("open-left for p(tiger-left) < .10"), "a tiger on the right"


def test_figure_2_16_has_the_numbers_of_the_thesis_and_a1_wins_on_the_right(ax):
    plot = pomdp.figure_2_16(ax)
    marks = [np.ravel(plot.lines[f"at {name}"].get_data()) for name in ("a1", "a2")]
    assert np.array(marks) == pytest.approx(np.array([[0.25, 0.25], [0.25, 1.125]]))
    a1, a2 = (drawn(plot.lines[name]) for name in ("a1", "a2"))
    assert (a1 == BELIEFS).all() and a2 == pytest.approx(1.5 * (1 - BELIEFS))
    assert (a1 > a2)[BELIEFS > 0.601].all() and (a1 < a2)[BELIEFS < 0.599].all()
    assert drawn(plot.surface) == pytest.approx(np.maximum(a1, a2))
    with pytest.raises(ValueError, match="p must"):
        pomdp.figure_2_16(Figure().subplots(), p=1.2)


def test_figure_2_17_needs_two_to_dominate_c_and_one_for_d(ax):
    plot = pomdp.figure_2_17(ax)
    a, b, c, d = (drawn(plot.lines[name]) for name in "abcd")
    assert (d < c).all() and not (d < a).all() and not (d < b).all()
    assert (c < np.maximum(a, b)).all() and not (c <= a).all() and not (c <= b).all()
    assert (drawn(plot.mixture) > c).all()
    assert {one.index: one.by for one in plot.found} == {2: (0, 1), 3: (2,)}
    vectors = [line.get_ydata()[::-1] for line in plot.lines.values()]
    every = {tuple(alpha.round(9)) for alpha in brute("two_state", 2)[0]}
    assert {tuple(np.round(alpha, 9)) for alpha in vectors} <= every, "plans of the example"


def test_figure_2_11_has_seven_planes_and_is_low_where_nothing_is_known(ax):
    plot = pomdp.figure_2_11(ax)
    assert len(plot.faces.get_paths()) == len(plot.shadows.get_paths()) == 7
    V = solve_pomdp(problem("three_places"), 2)
    corners, middle = V.value(np.eye(3)), V.value([1 / 3] * 3)
    assert (corners > middle).all()
    assert repr(plot) == (
        f"7 planes make a bowl: {middle:.1f} where nothing is known, "
        f"{corners.max():.1f} at the best corner"
    )
    lowest = min(path.vertices[:, 1].min() for path in plot.faces.get_paths())
    shadow = max(path.vertices[:, 1].max() for path in plot.shadows.get_paths())
    assert shadow < lowest, "the shadow lies apart, below the bowl"
    numbers = {text.get_text() for text in ax.texts}
    assert numbers >= {"2", "3", "4", "5", "value"}, "a scale of heights"
    colors = {tuple(c) for c in plot.faces.get_facecolor().round(3)}
    assert len(colors) == 7, "shaded, so that planes of one action can be told apart"


def test_the_policy_graph_of_tiger_listens_until_one_side_is_two_ahead(ax):
    tiger = problem("tiger")
    V = solve_pomdp(tiger)
    plot = pomdp.plot_policy_graph(V, tiger, ax)
    row = sorted(plot.parts, key=lambda name: plot.parts[name].get_position())
    names = [plot.parts[name].get_text() for name in row]
    assert names == ["open-left", "listen", "listen", "listen", "open-right"]
    steps = {(row.index(start), row.index(end)) for start, end in plot.wires}
    assert steps == {(0, 2), (1, 0), (1, 2), (2, 1), (2, 3), (3, 2), (3, 4), (4, 2)}
    for start, end in plot.wires:
        assert int(end) in V.branches[int(start)]
    assert row[2] == str(V.best(tiger.start))
    with pytest.raises(ValueError, match="V must be a value function without a horizon"):
        pomdp.plot_policy_graph(solved("tiger", 2), tiger, ax)


def test_a_surface_is_drawn_over_two_states_only():
    with pytest.raises(ValueError, match="alphas must"):
        pomdp.plot_surface(solved("three_places", 1), problem("three_places"))


def test_a_policy_graph_may_lead_through_a_node_that_is_nowhere_best(ax):
    tiger = problem("tiger")
    alphas = np.array([[3.0, 0.0], [0.0, 3.0], [1.0, 1.0]])
    V = ValueFunction(alphas, np.array([1, 2, 0]), np.array([[2, 2], [2, 2], [0, 1]]))
    plot = pomdp.plot_policy_graph(V, tiger, ax)
    assert repr(plot) == "3 of 3 nodes can be reached from the start"
