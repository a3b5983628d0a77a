"""The pictures of the chapter on decision processes: what they draw is what the model holds."""

import re

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from matplotlib.patches import Circle, RegularPolygon
from matplotlib.path import Path

from arkaq_edu.figures import FIGURES, mdp
from arkaq_edu.figures.drawing import floor as drawn
from arkaq_edu.figures.drawing import style
from arkaq_edu.mdp import (
    MDP,
    MOVES,
    best_actions,
    grid_world,
    value_iteration,
)
from arkaq_edu.mdp.procedures import EXPLOITATION, EXPLORATION


@pytest.fixture
def ax():
    return Figure().subplots()


def random_mdp(seed, n_states, n_actions):
    rng = np.random.default_rng(seed)
    T = rng.dirichlet(np.full(n_states, 0.4), size=(n_actions, n_states))
    T = np.where(T < 0.05, 0, T)
    R = rng.choice([0.0, 0.0, -1.5, 4.0], (n_states, n_actions))
    return MDP(T / T.sum(axis=2, keepdims=True), R, 0.9)


def test_the_gallery_knows_them():
    for number in ("2.3", "2.4", "4.3", "4.4"):
        assert FIGURES[number] is getattr(mdp, "figure_" + number.replace(".", "_"))


# --- figure 2.3 -----------------------------------------------------------------------------------


def test_figure_2_3_has_the_markov_property(ax):
    plot = mdp.figure_2_3(ax)
    into = {}
    for start, end in plot.wires:
        into.setdefault(end, set()).add(start)
    assert into["S_t"] == {"S_t-1", "A_t-1"} and into["S_t+1"] == {"S_t", "A_t"}
    for t in ("t-1", "t", "t+1"):
        assert into[f"R_{t}"] == {f"S_{t}", f"A_{t}"}
        assert into[f"A_{t}"] == {f"S_{t}"}, "the agent sees the state, and needs no more"
        assert plot.parts[f"S_{t}"].get_text() == f"$S_{{{t}}}$"


def test_figure_2_3_tells_states_actions_and_rewards_apart_by_shape(ax):
    plot = mdp.figure_2_3(ax)
    shapes = {"S": set(), "A": set(), "R": set()}
    for patch in ax.patches:
        if isinstance(patch, Circle):
            shapes["S"].add(patch.center)
        elif isinstance(patch, RegularPolygon):
            shapes["A" if patch.orientation else "R"].add(patch.xy)
    at = {name: text.get_position() for name, text in plot.parts.items()}
    for letter, places in shapes.items():
        assert places == {place for name, place in at.items() if name[0] == letter}


def test_an_arrow_of_figure_2_3_ends_at_the_rim(ax):
    plot = mdp.figure_2_3(ax)
    for (start, end), arrow in plot.wires.items():
        for name, place in zip((start, end), arrow._path_original.vertices[[0, -1]], strict=True):
            gap = np.abs(np.subtract(place, plot.parts[name].get_position()))
            reach = {"S": np.hypot(*gap), "A": gap.max(), "R": gap.sum()}[name[0]]
            assert reach == pytest.approx({"S": 0.34, "A": 0.31, "R": 0.42}[name[0]])


# --- figure 2.4 -----------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 3))
def test_any_small_model_is_drawn_whole(seed, n_states, n_actions):
    model = random_mdp(seed, n_states, n_actions)
    plot = mdp.figure_2_4(Figure().subplots(), mdp=model)
    going_on = [s for s in range(n_states) if not model.ends[s]]
    assert set(plot.choices) == {(s, a) for s in going_on for a in range(n_actions)}
    for s in going_on:
        for a in range(n_actions):
            for t in range(n_states):
                p = model.T[a, s, t]
                assert ((s, a, t) in plot.arrows) == (p > 0)
                if p:
                    assert plot.arrows[s, a, t][1].get_text() == f"{p:.3g}"
            assert ((s, a) in plot.rewards) == (model.R[s, a] != 0)
            if model.R[s, a]:
                number = plot.rewards[s, a][1].get_text().replace("−", "-")
                assert float(number) == model.R[s, a]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 4), st.integers(1, 3))
def test_nothing_lies_on_anything_else(seed, n_states, n_actions):
    plot = mdp.figure_2_4(Figure().subplots(), mdp=random_mdp(seed, n_states, n_actions))
    nodes = [text.get_position() for text in (*plot.states.values(), *plot.choices.values())]
    apart = np.linalg.norm(np.subtract.outer(nodes, nodes)[:, [0, 1], :, [0, 1]], axis=0)
    assert apart[~np.eye(len(nodes), dtype=bool)].min() > 0.5
    for _, number in plot.rewards.values():
        gaps = np.linalg.norm(np.subtract(nodes, number.get_position()), axis=1)
        assert gaps.min() > 0.3


def test_an_arrow_leaves_its_choice_and_ends_at_the_rim_of_the_state_it_names():
    model = random_mdp(4, 3, 2)
    plot = mdp.figure_2_4(Figure().subplots(), mdp=model)
    for (s, a, t), (arrow, _) in plot.arrows.items():
        path = arrow._path_original
        np.testing.assert_allclose(path.vertices[0], plot.choices[s, a].get_position())
        gap = np.subtract(path.vertices[-1], plot.states[t].get_position())
        assert np.hypot(*gap) == pytest.approx(mdp._RADIUS)
        assert path.codes.tolist() == [Path.MOVETO, Path.CURVE3, Path.CURVE3]


def test_names_and_places_are_those_given_and_an_end_has_a_double_border(ax):
    model = MDP([[[0, 1], [0, 1]]], [[3], [0]], 0.9)
    plot = mdp.plot_transitions(model, ax, states=["on", "off"], actions=["go"],
                                places=[[0, 0], [5, 1]])  # fmt: skip
    assert [plot.states[s].get_text() for s in (0, 1)] == ["on", "off"]
    assert plot.states[1].get_position() == (5, 1)
    assert plot.choices[0, 0].get_text() == "go" and (1, 0) not in plot.choices
    middles = [circle.center for circle in ax.patches if hasattr(circle, "radius")]
    assert middles.count((5.0, 1.0)) == 2 and middles.count((0.0, 0.0)) == 1
    assert repr(plot) == "2 states, 1 choices, 1 transitions; spirals are rewards"


@pytest.mark.parametrize(
    ("given_", "message"),
    [
        ({"states": ["one"]}, "states must hold 2 names, got 1"),
        ({"actions": ["a", "b"]}, "actions must hold 1 names, got 2"),
        ({"places": [[0, 0]]}, r"places must have shape \(2, 2\), got \(1, 2\)"),
    ],
)
def test_names_and_places_must_fit(ax, given_, message):
    with pytest.raises(ValueError, match=message):
        mdp.plot_transitions(MDP([np.eye(2)], [[1], [2]], 0.9), ax, **given_)


# --- figures 4.3 and 4.4 --------------------------------------------------------------------------


@pytest.mark.parametrize("procedure", [EXPLORATION, EXPLOITATION])
def test_what_became_of_each_printed_line(procedure, ax):
    plot = mdp._procedure(procedure, ax)
    assert [text.get_text() for text in plot.printed] == [words for _, words in procedure.printed]
    assert [text.get_text() for text in plot.runs] == [line.words for line in procedure.runs]
    said = re.search(r"of (\d+) printed lines (\d+) run .* (\d+) change, (\d+) goes; (\d+) are new",
                     repr(plot))  # fmt: skip
    stay = sum(not line.changed for line in procedure.runs)
    used = {i for i, _ in plot.links}
    new = len(plot.runs) - len({j for _, j in plot.links})
    counts = [len(plot.printed), stay, len(used) - stay, len(plot.printed) - len(used), new]
    assert [int(number) for number in said.groups()] == counts
    for (i, j), link in plot.links.items():
        line = procedure.runs[j]
        assert link.get_color() == (style.OURS if line.changed else style.INK)
        heights = [plot.printed[i].get_position()[1], plot.runs[j].get_position()[1]]
        assert link.get_ydata().tolist() == heights
        assert line.changed or procedure.printed[i][1] == line.words


def test_a_procedure_makes_its_own_axes_and_its_words_stay_on_them():
    for figure in (mdp.figure_4_3, mdp.figure_4_4, mdp.figure_2_3):
        plot = figure()
        canvas = plot.ax.figure
        canvas.draw_without_rendering()
        box = canvas.get_window_extent()
        for text in plot.ax.texts:
            words = text.get_window_extent()
            assert box.x0 <= words.x0 and words.x1 <= box.x1, text.get_text()
        plt.close(canvas)


# --- the grid -------------------------------------------------------------------------------------


def test_a_grid_shows_its_values_and_the_best_actions(ax):
    grid = grid_world()
    V, _ = value_iteration(grid.mdp)
    best = best_actions(grid.mdp.action_values(V))
    plot = mdp.plot_grid(grid, V, best, ax, title="solved")
    assert repr(plot) == "solved"
    going_on = ~grid.mdp.ends
    assert [text.get_text() for text in plot.numbers] == [f"{v:.0f}" for v in V[going_on]]
    assert len(plot.arrows.get_paths()) == best[going_on].sum()
    lightness = plot.squares.get_facecolor()[:, :3].sum(axis=1)
    assert (np.diff(lightness[np.argsort(V)]) <= 1e-9).all(), "dearer is darker"


def test_an_arrow_points_where_its_action_leads():
    grid = grid_world(["...", "...", "..."])
    for a, (dx, dy) in enumerate(MOVES.values()):
        best = np.zeros((9, 4))
        best[:, a] = 1
        floor = drawn.floor_polygons(grid, np.zeros(9), best)
        assert len(floor.arrows) == 9
        for place, arrow in zip(grid.places, floor.arrows, strict=True):
            tip = arrow[3] - arrow[[0, 6]].mean(axis=0)
            np.testing.assert_allclose(tip / np.hypot(*tip), [dx, dy], atol=1e-9)
            assert (arrow > place).all() and (arrow < place + 1).all()


def test_all_actions_alike_have_no_arrow_two_have_two_and_ends_none():
    grid = grid_world(["..o"])
    best = np.array([[1, 1, 1, 1], [1, 1, 0, 0], [1, 0, 0, 0]])
    floor = drawn.floor_polygons(grid, [-50.0, 250.0, 0.0], best)
    assert len(floor.arrows) == 2
    assert floor.shades == [0, len(drawn.SHADES) - 1, 0]
    assert len(floor.balls) == 1 and floor.balls[0].mean(axis=0) == pytest.approx([2.5, 0.5])


def test_walls_and_holes_are_where_the_plan_has_them():
    grid = grid_world(["#.x", ".o#"])
    floor = drawn.floor_polygons(grid, np.zeros(4), np.ones((4, 4)))
    corners = [[tuple(p.min(axis=0)) for p in part] for part in (floor.walls, floor.holes)]
    assert corners == [[(0, 1), (2, 0)], [(2, 1)]]
    assert {tuple(square.min(axis=0)) for square in floor.squares} == {
        (1, 1), (2, 1), (0, 0), (1, 0),
    }  # fmt: skip


def test_a_grid_needs_a_value_a_state():
    with pytest.raises(ValueError, match=r"V must have shape \(3,\), got \(2,\)"):
        drawn.floor_polygons(grid_world(["..o"]), [1.0, 2.0], np.ones((3, 4)))
    with pytest.raises(ValueError, match=r"best must have shape \(3, 4\), got \(3,\)"):
        drawn.floor_polygons(grid_world(["..o"]), [1.0, 2.0, 0.0], [0, 1, 2])


# --- bands ----------------------------------------------------------------------------------------


def test_bands_are_the_mean_over_runs_and_one_sigma(ax):
    runs = np.random.default_rng(0).normal(size=(20, 5))
    plot = mdp.plot_bands([1, 2, 5, 10, 20], {"ours": runs, "other": runs + 3}, ax)
    line, area = plot.lines["ours"], plot.bands["ours"]
    assert line.get_ydata() == pytest.approx(runs.mean(axis=0))
    top = runs.mean(axis=0) + runs.std(axis=0)
    assert area.get_datalim(ax.transData).ymax == pytest.approx(top.max())
    colors = [plot.lines[name].get_color() for name in ("ours", "other")]
    assert len(set(colors)) == 2 and ax.get_xscale() == "log"
    with pytest.raises(ValueError, match=r"ours must have shape \(any, 2\), got \(20, 5\)"):
        mdp.plot_bands([1, 2], {"ours": runs}, ax)
    with pytest.raises(ValueError, match="colors for at most 3 names"):
        mdp.plot_bands(range(1, 6), dict.fromkeys("abcd", runs), ax)
