import numpy as np
import pytest

from arkaq_edu.mdp import (
    grid_world,
    value_iteration,
)


def neighbor(plan, x, y, dx, dy):
    """Where a step from column x, row y (from the top) leads, by looking at the plan."""
    x2, y2 = x + dx, y - dy
    inside = 0 <= y2 < len(plan) and 0 <= x2 < len(plan[0])
    return (x2, y2) if inside and plan[y2][x2] != "#" else (x, y)


def test_a_floor_is_what_its_plan_says():
    plan = ["..#o", "x...", ".#.."]
    grid = grid_world(plan, slip=0.4, gamma=0.9)
    ways = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    where = {(int(x), len(plan) - 1 - int(y)): s for s, (x, y) in enumerate(grid.places)}
    assert len(where) == grid.mdp.n_states == 10
    for (x, y), s in where.items():
        sign = plan[y][x]
        assert grid.mdp.ends[s] == (sign != ".")
        assert grid.mdp.start[s] == pytest.approx(1 / 8 if sign == "." else 0)
        for a in range(4):
            expected, reward = np.zeros(10), 0.0
            for turn, p in ((0, 0.6), (1, 0.2), (-1, 0.2)) if sign == "." else ():
                x2, y2 = neighbor(plan, x, y, *ways[(a + turn) % 4])
                expected[where[x2, y2]] += p
                reward += p * {".": 0, "o": 100, "x": -100}[plan[y2][x2]]
            expected[s] += sign != "."
            np.testing.assert_allclose(grid.mdp.T[a, s], expected, atol=1e-12)
            assert grid.mdp.R[s, a] == pytest.approx(reward)


def test_without_slipping_the_ball_is_worth_gamma_for_each_step_to_it():
    """The distances by flooding the plan from the ball; a hole is never entered."""
    grid = grid_world(slip=0.0, gamma=0.9)
    plan = grid.plan
    (ball,) = [(x, y) for y, row in enumerate(plan) for x, sign in enumerate(row) if sign == "o"]
    steps, border = {ball: 0}, [ball]
    while border:
        x, y = border.pop(0)
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            square = neighbor(plan, x, y, dx, dy)
            if plan[square[1]][square[0]] == "." and square not in steps:
                steps[square] = steps[x, y] + 1
                border.append(square)
    V, _ = value_iteration(grid.mdp)
    for (x, y), v in zip(grid.places, V, strict=True):
        k = steps.get((int(x), len(plan) - 1 - int(y)), 0)
        assert v == pytest.approx(100 * 0.9 ** (k - 1) if k else 0)


def test_feet_that_slip_turn_the_robot_away_from_the_bridge():
    bridge = (2, 3)  # its left end, column and row from below
    turned = {}
    for slip in (0.0, 0.1, 0.2, 0.5):
        grid = grid_world(slip=slip)
        _, policy = value_iteration(grid.mdp)
        turned[slip] = int(policy[grid.places.tolist().index(list(bridge))])
    assert turned == {0.0: 0, 0.1: 0, 0.2: 2, 0.5: 2}


@pytest.mark.parametrize(
    ("given_", "message"),
    [
        ({"plan": ["..", "."]}, "plan must have rows of one length"),
        ({"plan": [".z"]}, "plan must have rows of one length made of"),
        ({"plan": []}, "plan must have rows of one length"),
        ({"plan": ["#o"]}, "plan must have a free square"),
        ({"plan": None}, "plan must have rows of one length made of . # o x, got None"),
        ({"plan": "..o"}, "plan must have rows of one length"),
        ({"plan": [1, 2]}, r"plan must have rows of one length made of . # o x, got \[1, 2\]"),
        ({"plan": ["." * 10_000]}, "plan must need at most 2,147,483,648 bytes"),
        ({"slip": 1.5}, r"slip must be a number in \[0, 1\], got 1.5"),
        ({"gamma": 1.1}, r"gamma must be a number in \[0, 1\], got 1.1"),
    ],
)
def test_a_floor_that_is_none_is_refused(given_, message):
    with pytest.raises(ValueError, match=message):
        grid_world(**given_)
