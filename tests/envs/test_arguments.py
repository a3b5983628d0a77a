"""What the three environments take as actions, seeds and options, and what they refuse."""

import gymnasium
import numpy as np
import pytest

from arkaq_edu.envs import FullState, PixelObservation

TASKS = {
    "arkaq_edu:BallApproach-v0": {},
    "arkaq_edu:ScoreGoal-v0": {},
    "arkaq_edu:POMDP-v0": {"pomdp": "tiger"},
}


@pytest.fixture(params=TASKS, ids=lambda name: name.split(":")[1])
def env(request):
    return gymnasium.make(request.param, **TASKS[request.param])


def outcome(env, action):
    env.reset(seed=3)
    observation, *rest = env.step(action)
    return np.asarray(observation).tolist(), *rest


@pytest.mark.parametrize("kind", [np.int64, np.uint8, np.array, lambda a: np.array([a]), np.intp])
def test_an_action_is_an_integer_or_an_array_of_one(env, kind):
    assert outcome(env, kind(1)) == outcome(env, 1)


@pytest.mark.parametrize(
    "action",
    [
        -1, 3, 1.0, "1", None, True, [1], (1,), np.array([0, 1]), np.array([]), np.array(1.0),
        np.array(["1"]), np.ma.masked_equal([1], 1), 10**400, 1j, float("nan"),
    ],
)  # fmt: skip
def test_anything_else_is_refused_by_name(env, action):
    env.reset(seed=3)
    with pytest.raises(ValueError, match=r"action must be an integer in \[0, 2\]"):
        env.step(action)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", [1], np.array([1, 2]), True, float("nan"), 2**70])
def test_a_seed_is_checked_by_our_own_gate(env, seed):
    with pytest.raises(ValueError, match="seed must be an integer"):
        env.unwrapped.reset(seed=seed)


@pytest.mark.parametrize("kind", [np.int64, np.array, lambda a: np.array([a])])
def test_a_seed_is_an_integer_or_an_array_of_one(env, kind):
    first, again = env.unwrapped.reset(seed=5), env.unwrapped.reset(seed=kind(5))
    assert np.array_equal(first[0], again[0]) and first[1] == again[1]


@pytest.mark.parametrize("options", [5, "distance", [1, 2], {"x": 1}, {"x": "y" * 10_000}])
def test_options_that_are_none_are_refused_by_name(env, options):
    with pytest.raises(ValueError, match=r"^options must") as caught:
        env.unwrapped.reset(seed=1, options=options)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("name", ["arkaq_edu:BallApproach-v0", "arkaq_edu:ScoreGoal-v0"])
@pytest.mark.parametrize("part", ["legs", "camera"])
@pytest.mark.parametrize("value", [{}, 0, "default", ()])
def test_parts_of_another_class_are_refused_by_name(name, part, value):
    with pytest.raises(ValueError, match=f"{part} must be of the class"):
        gymnasium.make(name, **{part: value})


@pytest.mark.parametrize("part", ["head", "kick"])
def test_so_are_head_and_kick(part):
    with pytest.raises(ValueError, match=f"{part} must be of the class"):
        gymnasium.make("arkaq_edu:ScoreGoal-v0", **{part: {}})


@pytest.mark.parametrize("value", ["1850", "middle", None, np.nan, 1e308, [1850]])
def test_a_goal_distance_is_a_name_or_a_number(value):
    with pytest.raises(ValueError, match="goal_distance must be"):
        gymnasium.make("arkaq_edu:ScoreGoal-v0", goal_distance=value)


def test_the_settings_name_all_that_shapes_the_episodes():
    ball = gymnasium.make("arkaq_edu:BallApproach-v0", far=1000).unwrapped.settings
    assert (ball["far"], ball["legs"]["slide"], ball["camera"]["min_pixels"]) == (1000.0, 0.07, 10)
    far = gymnasium.make("arkaq_edu:ScoreGoal-v0", goal_distance="far").unwrapped.settings
    assert (far["goal_distance"], far["orientation"]) == (2300.0, [0.25, 0.4])
    assert far["kick"]["spread"] == 9.0 and far["head"]["blurs"] is True


@pytest.mark.parametrize("wrapper", [FullState, PixelObservation])
@pytest.mark.parametrize("env", [None, "BallApproach-v0", gymnasium.make("CartPole-v1")])
def test_a_wrapper_of_another_environment_is_refused_by_name(wrapper, env):
    with pytest.raises(ValueError, match="env must be BallApproach-v0 or ScoreGoal-v0"):
        wrapper(env)
