"""Value functions explored without a browser: sliders, drags and keys, and what they show."""

import re

import numpy as np
import pytest

from arkaq_edu.figures.drawing.style import POMDP_ACTIONS, QUIET
from arkaq_edu.pomdp import all_trees, problem, solve_pomdp, tree_value
from arkaq_edu.widgets import bowl_explorer, pomdp, value_explorer
from arkaq_edu.widgets.scene import Cells, Line, Points, Text

TWO, THREE = problem("two_state"), problem("three_places")
FACT = re.compile(
    r"(\d) steps? to go, p\(s1\) = ([\d.]+): worth ([\d.]+), begin with (a\d); "
    r"(\d+) of ([\d,]+) plans are needed"
)


@pytest.fixture(scope="module")
def explorer():
    return value_explorer()


@pytest.fixture(scope="module")
def bowl():
    return bowl_explorer()


def pull(explorer, number, start, to, phase="move"):
    explorer.view.drag = {
        "number": number, "panel": 0, "from": start, "to": to, "phase": phase,
    }  # fmt: skip
    assert explorer.error is None


def pieces(line):
    """The pieces of a line whose pen is lifted: from (x, y) to (x, y)."""
    x, y = (np.reshape(values, (-1, 3)) for values in (line.x, line.y))
    assert np.isnan(x[:, 2]).all() and np.isnan(y[:, 2]).all()
    return np.stack([x[:, :2], y[:, :2]], axis=-1)


@pytest.mark.parametrize("belief", [0.0, 0.25, 0.6, 1.0])
@pytest.mark.parametrize("horizon", [1, 3, 5])
def test_the_explorer_states_value_and_action_of_the_belief(explorer, horizon, belief):
    explorer.controls["horizon"].value = horizon
    explorer.controls["belief"].value = belief
    assert explorer.error is None
    steps, p, value, action, needed, plans = FACT.fullmatch(repr(explorer)).groups()
    V = solve_pomdp(TWO, horizon)
    b = [belief, 1 - belief]
    assert (int(steps), float(p), int(needed)) == (horizon, belief, len(V))
    assert float(value) == pytest.approx(V.value(b), abs=0.0006)
    assert action == TWO.actions[V.action(b)]
    shorter = len(V.shorter) if horizon > 1 else 1
    assert int(plans.replace(",", "")) == 2 * shorter**3
    surface, _ = explorer.drawn.panels
    mark = surface.layers[-1]
    assert (mark.x, mark.y) == ([belief], [pytest.approx(V.value(b))])


def test_value_and_plan_by_brute_force(explorer):
    trees = list(all_trees(TWO, 2))
    alphas = np.array([tree_value(TWO, tree) for tree in trees])
    explorer.controls["horizon"].value = 2
    for belief in (0.1, 0.5, 0.9):
        explorer.controls["belief"].value = belief
        best = trees[int((alphas @ [belief, 1 - belief]).argmax())]
        fact = FACT.fullmatch(repr(explorer))
        assert float(fact[3]) == pytest.approx((alphas @ [belief, 1 - belief]).max(), abs=0.0006)
        texts = [x for x in explorer.drawn.panels[1].layers if isinstance(x, Text)]
        shown = {(x.x, x.y): x.text for x in texts if x.text in TWO.actions}
        root, *after = (shown[place] for place in sorted(shown, key=lambda at: (-at[1], at[0])))
        assert root == TWO.actions[best.action]
        assert after == [TWO.actions[branch.action] for branch in best.branches]


@pytest.mark.parametrize("horizon", [1, 2, 3, 4, 5])
def test_the_lines_are_those_of_the_plans(explorer, horizon):
    explorer.controls["horizon"].value = horizon
    faded, first, second, *rest = explorer.drawn.panels[0].layers
    V = solve_pomdp(TWO, horizon)
    seen = pieces(faded)
    assert len(seen) == min(2 * (len(V.shorter) if V.shorter else 1) ** 3, 128)
    above = V.value(np.column_stack([np.linspace(0, 1, 21), np.linspace(1, 0, 21)]))
    for (_, left), (_, right) in seen:
        line = np.linspace(left, right, 21)
        assert (line <= above + 1e-9).all(), "no plan is above the surface"
    kept = np.concatenate([pieces(first), pieces(second)])
    assert sorted(map(tuple, kept[:, :, 1].round(9))) == sorted(
        map(tuple, V.alphas[:, ::-1].round(9))
    )
    bold = np.concatenate([pieces(line) for line in rest[:2]])
    assert sorted(bold[:, 0, 0])[0] == 0 and sorted(bold[:, 1, 0])[-1] == 1
    for (x0, y0), (x1, y1) in bold:
        assert [y0, y1] == pytest.approx(V.value([[x0, 1 - x0], [x1, 1 - x1]]))
    strip = next(layer for layer in rest if isinstance(layer, Cells))
    for polygon, color in zip(strip.polygons, strip.colors, strict=True):
        mid = polygon[:, 0].mean()
        assert strip.palette[color] == POMDP_ACTIONS[TWO.actions[V.action([mid, 1 - mid])]]


def test_the_belief_is_dragged_along_the_picture(explorer):
    explorer.controls["horizon"].value = 3
    values = []
    for to in (0.9, 0.601, -0.5, 1.5):
        pull(explorer, 1, (0.25, 1.0), (to, 2.0))
        values.append(explorer.controls["belief"].value)
    assert values == [0.9, 0.6, 0.0, 1.0]
    assert FACT.fullmatch(repr(explorer))[2] == "1.00"
    explorer.view.arrows = (explorer.view.arrows[0] - 1, explorer.view.arrows[1])
    assert FACT.fullmatch(repr(explorer))[2] == "0.99"


def test_only_the_belief_moves_with_the_belief(explorer):
    explorer.controls["belief"].value = 0.2
    before = explorer.drawn.panels[0]
    explorer.controls["belief"].value = 0.8
    after = explorer.drawn.panels[0]
    assert before.layers[:-2] == after.layers[:-2] and before.ylim == after.ylim


@pytest.mark.parametrize("horizon", [1, 2, 5])
def test_the_bowl_states_its_planes_and_its_heights(bowl, horizon):
    bowl.controls["horizon"].value = horizon
    V = solve_pomdp(THREE, horizon)
    wanted = rf"{len(V)} planes, worth ([\d.]+) in the middle, ([\d.]+) at the corners"
    middle, corner = map(float, re.search(wanted, repr(bowl)).groups())
    assert middle == pytest.approx(V.value([1 / 3] * 3), abs=0.006)
    assert V.value(np.eye(3)) == pytest.approx(corner, abs=0.006), "all corners alike"
    turned, flat = bowl.drawn.panels
    shadows, faces = (x for x in turned.layers if isinstance(x, Cells))
    (regions,) = (x for x in flat.layers if isinstance(x, Cells))
    assert len(shadows.polygons) == len(faces.polygons) == len(regions.polygons) == len(V)
    assert list(faces.colors) == list(range(len(V))), "drawn one after the other"
    own = [POMDP_ACTIONS[THREE.actions[a]] for a in V.actions]
    assert sorted(regions.palette) == sorted(own)
    named = [x.text for x in flat.layers if isinstance(x, Text)]
    assert named == [*THREE.states, *THREE.actions]


@pytest.mark.parametrize("horizon", [1, 5])
def test_a_plane_seen_edge_on_is_a_line(horizon):
    """From -150 degrees the plane of "right" shows its edge; its border alone would hide it."""

    def beyond(view):
        """Which outlines reach the post of the corner "right"."""
        turned, _ = pomdp.draw_bowl(horizon, view).panels
        lines = [x for x in turned.layers if isinstance(x, Line)]
        post = min((x for x in lines if x.dashed), key=lambda line: line.x[0])
        return [x for x in lines if x.color != QUIET and min(x.x) < post.x[0] + 1e-6]

    assert len(beyond((-150, 0))) == 1
    assert beyond((-150, 38)) == []


def test_the_bowl_is_turned_by_drags_and_keys(bowl):
    bowl.controls["view"].value = (0, 30)
    before = bowl.drawn.panels
    pull(bowl, 1, (0.0, 0.0), (0.5, 0.0), "begin")
    assert bowl.controls["view"].value == (30, 30), "the near side follows the pointer"
    pull(bowl, 1, (0.0, 0.0), (0.5, -0.5), "end")
    assert bowl.controls["view"].value == (30, 60) and "seen from 30°, 60° up" in repr(bowl)
    after = bowl.drawn.panels
    assert not np.allclose(before[0].layers[0].polygons[0], after[0].layers[0].polygons[0])
    same = [x for x in zip(before[1].layers, after[1].layers, strict=True)]
    assert all(np.array_equal(a.numbers(), b.numbers()) for a, b in same), "the map stays"
    x, y = bowl.view.arrows
    bowl.view.arrows = (x - 2, y - 1)
    assert bowl.controls["view"].value == (26, 62)
    bowl.controls["view"].value = (180, 90)
    bowl.view.arrows = (x + 9, y - 9)
    assert bowl.controls["view"].value == (180, 90) and bowl.error is None


@pytest.mark.parametrize("view", [(-180, 0), (0, 0), (0, 90), (180, 90), (60, 42), (0, 40)])
@pytest.mark.parametrize("horizon", [1, 5])
def test_the_bowl_stays_in_its_panel(horizon, view):
    scene = pomdp.draw_bowl(horizon, view)
    for panel in scene.panels:
        (left, right), (low, high) = panel.xlim, panel.ylim
        for layer in panel.layers:
            x, y = (
                np.concatenate(layer.polygons).T if isinstance(layer, Cells) else (layer.x, layer.y)
            )
            assert left < np.min(x) and np.max(x) < right and low < np.min(y) and np.max(y) < high


@pytest.mark.parametrize(
    "draw", [lambda: pomdp.draw_value(4, 0.3), lambda: pomdp.draw_bowl(3, (9, 9))]
)
def test_a_picture_is_the_same_on_paper_and_small_on_the_wire(draw):
    scene = draw()
    layout, numbers = scene.pack()
    assert len(numbers) < 20_000 and layout["fact"] == scene.fact
    assert scene.png() == draw().png()
    kinds = {type(layer) for panel in scene.panels for layer in panel.layers}
    assert kinds == {Cells, Line, Points, Text}
