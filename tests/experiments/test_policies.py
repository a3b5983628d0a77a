"""Policies of either task."""

import pickle

import pytest

from arkaq_edu.experiments import approach, goal


@pytest.mark.parametrize("task", [approach, goal])
@pytest.mark.parametrize(
    "make",
    [
        lambda task: task.greedy(task.load_agent()),
        lambda task: task.planner(),
        lambda task: task.at_random(3),
    ],
    ids=["greedy", "planner", "random"],
)
def test_a_policy_can_travel_to_another_process(task, make):
    policy = make(task)
    twin = pickle.loads(pickle.dumps(policy))
    assert task.evaluate(twin, 3, seed=1).equals(task.evaluate(policy, 3, seed=1))


@pytest.mark.parametrize("seed", [-1, 0.5, "1", None])
def test_a_seed_is_an_integer(seed):
    with pytest.raises(ValueError, match="seed must be an integer"):
        approach.at_random(seed)
