"""The explorers of planning and Q-learning without a browser: what they draw at all their stops."""

import itertools
import re
import tracemalloc

import numpy as np
import pytest

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.floor import SHADES
from arkaq_edu.mdp import (
    MOVES,
    QLearner,
    best_actions,
    floor,
    grid_world,
    policy_iteration,
    train,
    value_iteration,
)
from arkaq_edu.widgets import mdp as widgets
from arkaq_edu.widgets import planning_explorer, q_learning_explorer
from arkaq_edu.widgets.scene import Cells, Line, Points, Text

SWEPT = re.compile(
    r"sweep (\d+): (\d+) arrows? turned, (\d+) of 37 are right; "
    r"V is off by ([\d.]+), the bound says ([\d.]+)"
)
LEARNED = re.compile(
    r"([\d,]+) steps: (\d+) of 37 arrows are right; Q is off by ([\d.]+), "
    r"that of 20 robots by ([\d.]+) ± ([\d.]+)"
)


@pytest.fixture(scope="module")
def explorer():
    return planning_explorer()


@pytest.fixture(scope="module")
def learner_explorer():
    return q_learning_explorer()


def told(pattern, explorer):
    return [float(number.replace(",", "")) for number in pattern.fullmatch(repr(explorer)).groups()]


def arrows(scene):
    """The arrows of a scene's floor, as the set of (square, direction) they stand for."""
    (layer,) = [
        layer
        for layer in scene.panels[0].layers
        if isinstance(layer, Cells) and list(layer.palette) == [style.INK]
        and all(len(polygon) == 7 for polygon in layer.polygons)
    ]  # fmt: skip
    found = set()
    for arrow in layer.polygons:
        tip = arrow[3] - arrow[[0, 6]].mean(axis=0)
        step = tuple(np.rint(tip / np.hypot(*tip)).astype(int).tolist())
        found.add((*np.floor(arrow.mean(axis=0)).astype(int).tolist(), *step))
    return found


def wanted(grid, best):
    return {
        (*place, *step)
        for place, row, end in zip(grid.places.tolist(), best, grid.mdp.ends, strict=True)
        for step, is_best in zip(MOVES.values(), row, strict=True)
        if is_best and not row.all() and not end
    }


ENDS = list(itertools.product((0, 1, 8, 40), (0.5, 0.95), (0.0, 0.1, 0.5)))


@pytest.mark.parametrize(("n", "gamma", "slip"), ENDS)
def test_the_floor_shows_the_values_after_n_sweeps_and_their_best_actions(explorer, n, gamma, slip):
    for name, value in {"n": n, "gamma": gamma, "slip": slip}.items():
        explorer.controls[name].value = value
    assert explorer.error is None
    grid = grid_world(slip=slip, gamma=gamma)
    mdp, exact = grid.mdp, policy_iteration(grid.mdp)[0]
    before, V = np.zeros(mdp.n_states), np.zeros(mdp.n_states)
    for _ in range(n):  # the sum over next states, written out as equation 2.8 has it
        before, V = V, np.max(
            mdp.R.T + gamma * np.einsum("ast,t->as", mdp.T, V), axis=0
        )  # fmt: skip
    best, last = (best_actions(mdp.action_values(values)) for values in (V, before))
    truly = best_actions(mdp.action_values(exact))
    sweep, turned, right, off, bound = told(SWEPT, explorer)
    free = ~mdp.ends
    assert sweep == n and turned == (n and (best != last).any(axis=1).sum())
    assert right == sum(not (b & ~t).any() for b, t in zip(best[free], truly[free], strict=True))
    assert off == pytest.approx(np.abs(V - exact).max(), abs=0.051)
    assert bound >= off - 0.1, "a bound is no bound that is broken"
    following = mdp.action_values(V).max(axis=1)
    assert bound == pytest.approx(np.abs(following - V).max() / (1 - gamma), abs=0.051)
    assert arrows(explorer.drawn) == wanted(grid, best)
    squares = explorer.drawn.panels[0].layers[0]
    top = len(SHADES) - 1
    assert squares.colors == np.rint(np.clip(V, 0, 100) / 100 * top).astype(int).tolist()


def test_it_starts_before_the_first_sweep_and_a_step_of_the_slider_is_a_sweep():
    explorer = planning_explorer()
    sweeps = explorer.controls["n"]
    assert (sweeps.value, sweeps.step, sweeps.min, sweeps.max) == (0, 1, 0, floor.SWEEPS)
    assert repr(explorer).startswith("sweep 0: 0 arrows turned, 4 of 37 are right")
    sweeps.value += 1
    assert repr(explorer).startswith("sweep 1: ")


def test_moving_over_all_settings_fills_no_memory(explorer):
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    for gamma, slip in itertools.product(np.arange(0.5, 0.96, 0.05), np.arange(0, 0.51, 0.05)):
        explorer.controls["gamma"].value, explorer.controls["slip"].value = gamma, slip
        assert explorer.error is None
    held = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert held < 10e6


def test_the_lines_are_error_and_bound_and_the_dots_stand_at_this_sweep(explorer):
    for name, value in {"n": 8, "gamma": 0.95, "slip": 0.1}.items():
        explorer.controls[name].value = value
    run = floor.sweeps(0.95, 0.1)
    panel = explorer.drawn.panels[1]
    bound, error = (layer for layer in panel.layers if isinstance(layer, Line))
    hollow, dot = (layer for layer in panel.layers if isinstance(layer, Points))
    assert bound.dashed and not error.dashed and hollow.hollow and panel.log == "y"
    assert list(error.y) == pytest.approx(run.error[run.error >= 0.01])
    assert list(bound.y) == pytest.approx(run.bound[run.bound >= 0.01])
    assert (dot.x, dot.y[0], hollow.y[0]) == ([8], run.error[8], run.bound[8])


def test_a_slider_that_adds_up_steps_is_no_other_world():
    assert widgets.draw_sweep(5, 0.95, 0.1 + 0.2).fact == widgets.draw_sweep(5, 0.95, 0.3).fact


# --- Q-learning -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("steps", "alpha", "temperature"),
    [(0, 0.1, 10.0), (5000, 0.1, 10.0), (20_000, "1/visits", 0.1), (20_000, 1.0, 1000.0)],
)
def test_the_robot_shown_is_one_that_lived_so_long(learner_explorer, steps, alpha, temperature):
    for name, value in {"steps": steps, "alpha": alpha, "temperature": temperature}.items():
        learner_explorer.controls[name].value = value
    assert learner_explorer.error is None
    grid = grid_world()
    mdp = grid.mdp
    exact, _ = value_iteration(mdp)
    robot = QLearner(mdp.n_states, 4, alpha, 0.95, rng=0)
    for begin, end in itertools.pairwise(stop for stop in floor.STEPS if stop <= steps):
        train(mdp, robot, end - begin, temperature=temperature)
    assert robot.visits.sum() == steps
    best = best_actions(robot.Q)
    truly, free = best_actions(mdp.action_values(exact)), ~mdp.ends
    said, right, off, mean, spread = told(LEARNED, learner_explorer)
    assert said == steps
    assert right == sum(not (b & ~t).any() for b, t in zip(best[free], truly[free], strict=True))
    assert off == pytest.approx(np.abs(robot.Q.max(axis=1) - exact)[free].mean(), abs=0.051)
    life = floor.lives(alpha, temperature).error
    assert life.shape == (20, len(floor.STEPS))
    i = floor.STEPS.index(steps)
    assert life[0, i] == pytest.approx(off, abs=0.051)
    assert [mean, spread] == pytest.approx([life[:, i].mean(), life[:, i].std()], abs=0.051)
    if steps:
        assert arrows(learner_explorer.drawn) == wanted(grid, best)


def test_every_setting_can_be_drawn_and_the_robots_differ():
    for alpha in widgets.RATES:
        scene = widgets.draw_life(20_000, alpha, 10.0)
        assert LEARNED.fullmatch(scene.fact)
    assert len(set(floor.lives(0.1, 10.0).error[:, 4].tolist())) == 20


@pytest.mark.parametrize("make", [planning_explorer, q_learning_explorer])
def test_all_the_words_stay_inside_their_panels_and_a_stored_notebook_has_a_picture(make):
    explorer = make()
    for panel in explorer.drawn.panels:
        for word in (layer for layer in panel.layers if isinstance(layer, Text)):
            assert panel.xlim[0] <= word.x <= panel.xlim[1]
            assert panel.ylim[0] <= word.y <= panel.ylim[1]
    bundle, _ = explorer._repr_mimebundle_()
    assert bundle["text/plain"] == repr(explorer) and bundle["image/png"].startswith(b"\x89PNG")
