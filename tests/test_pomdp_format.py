"""Cassandra's .POMDP format, and the course's own problem files."""

import numpy as np
import pytest

from arkaq_edu.pomdp import belief_update, predict, problem


@pytest.mark.parametrize(
    "name", ["ball_side", "corridor", "floors", "three_places", "tiger", "two_state"]
)
def test_the_course_has_its_problems(name):
    pomdp = problem(name)
    assert not any(word.isdigit() for word in (*pomdp.states, *pomdp.actions, *pomdp.observations))


def test_erratum_11_the_floors_after_one_step_down():
    floors = problem("floors")
    np.testing.assert_array_equal(predict(floors, floors.start, 0), [0, 0.25, 0.25, 0.5])


def test_figure_2_7_the_corridor():
    corridor = problem("corridor")
    right, nothing = corridor.actions.index("right"), corridor.observations.index("nothing")
    once = belief_update(corridor, corridor.start, right, nothing)
    np.testing.assert_allclose(once, [0.1, 0.45, 0, 0.45], atol=1e-12)
    twice = belief_update(corridor, once, right, nothing)
    np.testing.assert_allclose(twice, [0.1, 9 / 55, 0, 81 / 110], atol=1e-12)
