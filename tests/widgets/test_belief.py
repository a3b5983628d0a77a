"""The belief explorer without a browser: what its buttons offer, and what it draws of them."""

import itertools

import numpy as np
import pytest

from arkaq_edu.figures.drawing import style
from arkaq_edu.pomdp import problem, successors, to_triangle
from arkaq_edu.pomdp.simplex import TETRAHEDRON
from arkaq_edu.pomdp.turns import WORLD, follow
from arkaq_edu.widgets import belief_explorer
from arkaq_edu.widgets.belief import PROBLEMS
from arkaq_edu.widgets.explorer import is_offered
from arkaq_edu.widgets.scene import Cells, Line, Points, Text

FIGURE_2_7 = ("corridor", "right", "nothing", "right", "nothing")


@pytest.fixture(scope="module")
def explorer():
    return belief_explorer()


@pytest.fixture
def turns(explorer):
    control = explorer.controls["turns"]
    control.value = ("corridor",)
    return control


def buttons(row):
    return {button.description: button for button in row.children[1:]}


def offered(row):
    return [name for name, button in buttons(row).items() if is_offered(button)]


def lengths(cells):
    return [float(np.ptp(polygon[:, 0])) for polygon in cells.polygons]


def of_kind(panel, kind):
    return [layer for layer in panel.layers if isinstance(layer, kind)]


def test_figure_2_7_by_clicks(explorer, turns):
    facts = [repr(explorer)]
    for name in FIGURE_2_7[1:]:
        row = turns.observations if is_offered(turns.observations.children[1]) else turns.actions
        buttons(row)[name].click()
        facts.append(repr(explorer))
    assert facts == [
        "corridor, at first: first, second or fourth .33 each; 1.58 bits of doubt",
        "corridor, step 1, right: nothing .67 or goal .33?",
        "corridor, step 1, right then nothing: second or fourth .45 each; 1.37 bits of doubt",
        "corridor, step 2, right: nothing .55 or goal .45?",
        "corridor, step 2, right then nothing: fourth .74; 1.08 bits of doubt",
    ]
    assert turns.value == FIGURE_2_7 and explorer.error is None
    bars = of_kind(explorer.drawn.panels[1], Cells)[0]
    assert np.round(lengths(bars), 3).tolist() == [0.1, 0.164, 0, 0.736]


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize("length", [0, 1, 2, 9, 30])
def test_every_half_turn_of_every_problem_is_drawn(explorer, turns, name, length):
    pomdp = problem(name)
    actions = itertools.cycle(pomdp.actions)
    turns.value = (name, *(next(actions) if k % 2 == 0 else WORLD for k in range(length)))
    assert explorer.error is None and repr(explorer).startswith(f"{name}, ")
    track = follow(pomdp, turns.value[1:], 0)
    assert len(track.beliefs) == length + 1
    trail, bars, chances = explorer.drawn.panels

    assert lengths(of_kind(bars, Cells)[0]) == pytest.approx(track.beliefs[-1])
    outlines = [float(np.max(line.x)) for line in of_kind(bars, Line)]
    assert outlines == pytest.approx([] if length == 0 else track.beliefs[-2])

    drawn = [lengths(cells) for cells in of_kind(chances, Cells)]
    if track.pending is None:
        expected = [successors(pomdp, track.beliefs[-1], a).chances for a in range(pomdp.n_actions)]
    else:
        expected = [successors(pomdp, track.beliefs[-2], track.pending).chances]
    assert np.array(drawn) == pytest.approx(np.array(expected))

    dots, now = of_kind(trail, Points)
    assert len(dots.x) == length // 2 + 1 and len(now.x) == 1
    if pomdp.n_states == 2:
        assert dots.x == pytest.approx([b[0] for b in track.beliefs[::2]])
        assert (np.diff(dots.y) == 1).all() and trail.ylim[0] > max(now.y), "time runs down"
    for panel in explorer.drawn.panels:
        for word in of_kind(panel, Text):
            assert panel.xlim[0] <= word.x <= panel.xlim[1]
            assert min(panel.ylim) <= word.y <= max(panel.ylim)


@pytest.mark.parametrize(("name", "n"), [("three_places", 3), ("corridor", 4)])
def test_a_belief_stands_where_its_corners_draw_it(explorer, turns, name, n):
    turns.value = (name,)
    (trail, _, _) = explorer.drawn.panels
    edges = of_kind(trail, Line)[: n * (n - 1) // 2]
    corners = {(float(x), float(y)) for edge in edges for x, y in zip(edge.x, edge.y, strict=True)}
    assert len(corners) == n and trail.bare
    assert sum(edge.dashed for edge in edges) == (n == 4), "one edge of a tetrahedron is hidden"
    (x,), (y,) = of_kind(trail, Points)[-1].x, of_kind(trail, Points)[-1].y
    start = problem(name).start
    ordered = to_triangle(np.eye(3)) if n == 3 else TETRAHEDRON
    assert corners == {tuple(corner) for corner in ordered.tolist()}
    assert (x, y) == pytest.approx(tuple(start @ ordered))
    names = [word.text for word in of_kind(trail, Text)]
    assert names == list(problem(name).states)


def test_only_what_can_follow_is_offered(turns):
    assert offered(turns.actions) == ["left", "right"] and offered(turns.observations) == []
    turns.press("right")
    assert offered(turns.actions) == []
    assert offered(turns.observations) == ["nothing", "goal", WORLD]
    turns.press("goal")
    turns.press("left")
    assert offered(turns.observations) == ["nothing", WORLD], "the goal is never met twice running"
    with pytest.raises(ValueError, match="'goal' has probability 0 after 'left'"):
        turns.press("goal")
    assert turns.value == ("corridor", "right", "goal", "left"), "and nothing is pressed"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (("chess",), "problem must be one of corridor"),
        (("corridor", "nothing"), "action must be one of left, right, got 'nothing'"),
        (("corridor", WORLD), "action must"),
        (("corridor", "left", "left"), "observation must be one of nothing, goal, got 'left'"),
    ],
)
def test_presses_that_make_no_turn_are_refused(turns, value, message):
    with pytest.raises(ValueError, match=message):
        turns.value = value
    assert turns.value == ("corridor",)


def test_the_menu_begins_anew_and_start_again_forgets(explorer, turns):
    turns.value = FIGURE_2_7
    turns.menu.value = "tiger"
    assert turns.value == ("tiger",)
    assert list(buttons(turns.actions)) == list(problem("tiger").actions)
    assert list(buttons(turns.observations)) == [*problem("tiger").observations, WORLD]
    turns.press("listen")
    (again,) = [
        b for b in turns.children[0].children if getattr(b, "description", "")[:5] == "start"
    ]
    again.click()
    assert turns.value == ("tiger",) and repr(explorer).startswith("tiger, at first")
    turns.value = FIGURE_2_7
    assert turns.menu.value == "corridor" and turns.value == FIGURE_2_7


def test_the_world_answers_by_its_seed():
    pomdp = problem("ball_side")
    presses = ["look", WORLD] * 3
    answers = [follow(pomdp, presses, seed).steps for seed in (3, 3, *range(4, 20))]
    assert answers[0] == answers[1] and len(set(map(tuple, answers))) > 5


def test_each_action_keeps_its_color_from_the_choice_to_the_answer(explorer, turns):
    _, _, before = explorer.drawn.panels
    left, right = of_kind(before, Cells)
    assert (left.palette, right.palette) == ([style.ACTIONS["left"]], [style.ACTIONS["right"]])
    turns.press("right")
    (chosen,) = of_kind(explorer.drawn.panels[2], Cells)
    assert chosen.palette == right.palette
