"""ARKAQ on small POMDPs, and the ball problem on cells."""

import numpy as np
import pytest

from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import cells, hidden
from arkaq_edu.pomdp import belief_update, problem, solve_pomdp

BRIEF = TrainingSettings(
    patterns=100, period=40, exploration=400, exploitation=1200, hold=1, gamma=0.95,
    alpha_least=0.02, hot=20.0, cold=0.5,
)  # fmt: skip


def test_what_is_remembered_is_the_belief_or_the_last_looks():
    tiger, rng = problem("tiger"), np.random.default_rng(0)
    envs = {name: hidden.make_hidden("tiger", name) for name in hidden.REMEMBERS}
    looks = {name: env.reset(seed=3)[0] for name, env in envs.items()}
    b, heard, last = tiger.start, np.array([0, 0, 1.0]), np.zeros(3)
    for _ in range(20):
        a = int(rng.integers(3))
        before = heard
        looks = {name: env.step(a)[0] for name, env in envs.items()}
        z = int(looks["last look"][:3].argmax())
        b, heard, last = belief_update(tiger, b, a, z), np.eye(3)[z], np.eye(3)[a]
        assert looks["belief"] == pytest.approx([*b, 1])
        assert looks["last look"].tolist() == [*heard, 1]
        assert looks["two looks"].tolist() == [*before, *last, *heard, 1]


def test_a_belief_beats_a_look_at_the_tiger_and_nothing_beats_the_best(monkeypatch):
    monkeypatch.setattr(hidden, "LEARNING", BRIEF)
    found = {
        name: hidden.earned(
            hidden.make_hidden("tiger", name),
            acting(hidden.train("tiger", name, 1, learning=BRIEF)),
            50,
            0,
        )
        for name in ("last look", "belief")
    }
    assert found["last look"] < 0 < found["belief"] <= hidden.best("tiger", 0, 50) + 5


def acting(agent):
    def begin():
        agent.reset()
        return agent.act

    return begin


def test_from_the_fork_the_cheese_is_two_steps_away():
    maze = problem("cheese")
    value = solve_pomdp(maze, horizon=12)
    at = dict(zip(maze.states, np.eye(maze.n_states), strict=True))
    # The step to the cheese earns 10; each before it costs 1.
    assert value.value(at["middle"]) == pytest.approx(10)
    assert value.value(at["top-middle"]) == pytest.approx(-1 + 0.95 * 10)
    assert value.value(at["over"]) == 0
    assert value.value(maze.start) < np.mean([value.value(at[s]) for s in maze.states[:-1]])


def test_a_cell_holds_the_places_that_are_drawn_in_it():
    rng = np.random.default_rng(0)
    for s in (0, 17, 200, 359):
        assert (cells.cell(*cells._places(s, 50, rng)) == s).all()
    assert cells.cell(10.0, -3.0) == 0 and cells.cell(9999.0, 3.0) == 359


def test_a_step_ahead_comes_nearer_and_a_step_to_the_left_turns_the_ball_to_the_right():
    model = cells.on_cells()
    at = int(cells.cell(2000.0, 0.0))
    distance, orientation = np.divmod(np.arange(360), len(cells.ORIENTATIONS) - 1)
    for action, turn in enumerate((0, -1, 1)):
        after = model.T[action, at, :360]
        assert after @ orientation - at % 15 == pytest.approx(turn, abs=0.2)
        assert after @ distance - at // 15 == pytest.approx(-100 / 150, abs=0.1)
    near = int(cells.cell(510.0, 0.0))
    earned = model.R[near] / model.T[:, near, cells.OVER]  # by those that get there
    assert 130 < earned[0] < 150 and (earned[1:] >= 100).all() and (earned[1:] < 115).all()


def test_the_planners_reach_the_ball():
    for trusts in cells.PLANNERS:
        found = cells.measure(0, trusts, episodes=10)
        assert found["success"] == 100 and abs(found["regret"]) < 25
