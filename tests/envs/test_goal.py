"""The goal-scoring task as Gymnasium sees it, and against its own printed rules."""

import math
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from scipy import stats

from arkaq_edu.envs.score_goal import KICK, TURN_LEFT, TURN_RIGHT
from arkaq_edu.field import Camera, Head, Kick, Legs, pitch

TASK = "arkaq_edu:ScoreGoal-v0"
NEAR, FAR = 1850.0, 2300.0
EXACT = {"legs": Legs(0, 0, 0), "kick": Kick(0, 0)}


def play(env, choose, seed=None, options=None):
    """One episode: its observations, actions, rewards, infos, and how it ended."""
    observation, info = env.reset(seed=seed, options=options)
    observations, actions, rewards, infos, over = [observation], [], [], [info], False
    while not over:
        actions.append(choose(observation))
        observation, reward, terminated, truncated, info = env.step(actions[-1])
        observations.append(observation)
        rewards.append(reward)
        infos.append(info)
        over = terminated or truncated
    return np.array(observations), actions, rewards, infos, truncated


def at_random(seed):
    rng = np.random.default_rng(seed)
    return lambda observation: int(rng.integers(3))


def take_aim(observation):
    """Turn until another turn would not help, then kick."""
    if abs(observation[0]) <= 0.075:
        return KICK
    return TURN_LEFT if observation[0] > 0 else TURN_RIGHT


# Gymnasium --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"goal_distance": "far"},
        {"goal_distance": 1000},
        {"render_mode": "rgb_array"},
        {"head": Head(reach=0.0)},
    ],
)
def test_gymnasium_has_nothing_to_complain_of(options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(TASK, **options).unwrapped)


def test_spaces():
    env = gymnasium.make(TASK)
    assert env.action_space == gymnasium.spaces.Discrete(3)
    box = env.observation_space
    assert (box.shape, box.dtype) == ((2,), np.float32)
    assert np.all(box.low <= [-0.5, 0]) and np.all(box.high >= [0.5, 1])
    assert (box.low[1], box.high[1]) == (0, 1)


def test_importing_the_package_is_enough_to_register_it():
    import arkaq_edu  # noqa: F401

    assert "ScoreGoal-v0" in gymnasium.registry


# The rules --------------------------------------------------------------------------------------


def in_goal(ball):
    x, y = ball
    return 2700 + 42 <= x <= 3000 and abs(y) < 400


def test_every_episode_keeps_the_rules():
    env = gymnasium.make(TASK)
    outcomes = {"goal": 0, "miss": 0}
    for seed in range(120):
        observations, actions, rewards, infos, truncated = play(env, at_random(seed), seed)
        world = env.unwrapped.world
        assert actions[-1] == KICK and KICK not in actions[:-1] and not truncated
        assert not any(rewards[:-1]) and not any(info["is_success"] for info in infos[:-1])
        scored = in_goal(world.ball)
        assert rewards[-1] == (100 if scored else -100)
        assert infos[-1]["is_success"] is scored
        outcomes["goal" if scored else "miss"] += 1
        for observation, info in zip(observations, infos, strict=True):
            assert observation in env.observation_space and observation.dtype == np.float32
            assert observation[1] == 1, "the head follows the goal"
            assert observation[0] == pytest.approx(info["orientation"], abs=0.03)
        seen = observations[:, 0]
        turns = [{TURN_LEFT: -0.15, TURN_RIGHT: 0.15, KICK: 0.0}[a] for a in actions]
        assert np.diff(seen) == pytest.approx(turns, abs=0.03)
        assert np.all(np.diff([info["time"] for info in infos]) > 0.5)
        x, y, heading = world.pose
        assert infos[-1]["orientation"] == pytest.approx(
            math.atan2(-y, 2700 - x) - heading, abs=0.002
        )
    assert min(outcomes.values()) >= 25, outcomes


@pytest.mark.parametrize(("action", "turn"), [(TURN_LEFT, -0.15), (TURN_RIGHT, 0.15)])
def test_a_turn_changes_the_orientation_and_nothing_else(action, turn):
    env = gymnasium.make(TASK, **EXACT)
    _, before = env.reset(seed=0, options={"orientation": 0.1})
    place = env.unwrapped.world.pose[:2]
    _, reward, terminated, truncated, after = env.step(action)
    assert after["orientation"] - before["orientation"] == pytest.approx(turn, abs=0.003)
    assert env.unwrapped.world.pose[:2] == pytest.approx(place, abs=1e-6)
    assert (reward, terminated, truncated, after["is_success"]) == (0, False, False, False)


@pytest.mark.parametrize(
    ("distance", "orientation", "scored"),
    [
        (1200, 0.0, True),
        (1200, 0.2, True),
        (1200, -0.2, True),
        (1200, 0.5, False),
        (1200, -0.5, False),
        (2200, 0.0, True),
        (2200, 0.3, False),
        (3000, 0.0, False),  # the ball lies 2755 mm before the line, and rolls 2200
    ],
)
def test_an_exact_kick_scores_where_it_is_aimed_and_gets_there(distance, orientation, scored):
    env = gymnasium.make(TASK, goal_distance=distance, **EXACT)
    env.reset(seed=0, options={"orientation": orientation})
    *_, reward, terminated, _, info = env.step(KICK)
    assert (reward, terminated, info["is_success"]) == (100 if scored else -100, True, scored)


@pytest.mark.parametrize("patience", [1, 5, 30])
def test_a_robot_that_never_kicks_has_missed(patience):
    env = gymnasium.make(TASK, patience=patience)
    turns = iter([TURN_LEFT, TURN_RIGHT] * 20)
    _, actions, rewards, infos, truncated = play(env, lambda _: next(turns), 0)
    assert len(actions) == patience and not truncated
    assert rewards == [0] * (patience - 1) + [-100] and not infos[-1]["is_success"]


# Starts -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("place", "distance", "least", "most"),
    [("near", NEAR, 0.0, 0.4), ("far", FAR, 0.25, 0.4), (1234, 1234.0, 0.0, 0.4)],
)
def test_the_goal_lies_where_the_table_says_and_is_seen(place, distance, least, most):
    env = gymnasium.make(TASK, goal_distance=place)
    env.reset(seed=0)
    starts = []
    for _ in range(300):
        observation, info = env.reset()
        assert env.unwrapped.world.pose[:2] == (2700 - distance, 0)
        assert observation[1] == 1 and not info["is_success"]
        starts.append(info["orientation"])
    off = np.abs(starts)
    assert stats.kstest(off, stats.uniform(least, most - least).cdf).pvalue > 1e-3
    assert stats.binomtest(int(np.sum(np.array(starts) > 0)), 300).pvalue > 1e-3


def test_the_goal_can_be_put_in_an_orientation():
    env = gymnasium.make(TASK)
    for orientation in (-0.5, -0.13, 0.0, 0.42):
        observation, info = env.reset(seed=0, options={"orientation": orientation})
        assert info["orientation"] == pytest.approx(orientation)
        assert observation[0] == pytest.approx(orientation, abs=0.006)


# What the thesis reports ------------------------------------------------------------------------


def scored(env, policy, episodes):
    env.reset(seed=1)
    return sum(play(env, policy)[3][-1]["is_success"] for _ in range(episodes))


@pytest.mark.parametrize(("place", "aimed", "random"), [("near", 0.63, 0.33), ("far", 0.36, 0.12)])
def test_aim_and_luck_score_as_often_as_the_docstring_says(place, aimed, random):
    env = gymnasium.make(TASK, goal_distance=place)
    for policy, share in ((take_aim, aimed), (at_random(7), random)):
        goals = scored(env, policy, 500)
        assert stats.binomtest(goals, 500, share).pvalue > 1e-3, (goals, share)


# The three uncertainties, each turned off -------------------------------------------------------


def test_without_the_uncertainty_of_the_ball_an_aimed_kick_nearly_always_scores():
    env = gymnasium.make(TASK, kick=Kick(spread=0.0, swerve=0.0))
    assert scored(env, take_aim, 60) >= 59


def test_without_blur_the_robot_loses_no_time():
    times = []
    for blurs in (True, False):
        env = gymnasium.make(TASK, head=Head(blurs=blurs))
        env.reset(seed=0, options={"orientation": 0.4})
        times.append([env.step(TURN_LEFT)[-1]["time"] for _ in range(2)])
    assert times[1] == pytest.approx([0.64, 1.28])
    assert times[0][-1] > 1.4


def test_a_head_that_cannot_pan_loses_the_goal():
    env = gymnasium.make(TASK, head=Head(reach=0.0))
    observation, _ = env.reset(seed=0, options={"orientation": -0.4})
    visible = [observation[1]] + [env.step(TURN_LEFT)[0][1] for _ in range(4)]
    assert visible[0] == 1 and visible[-1] == 0
    env = gymnasium.make(TASK)
    env.reset(seed=0, options={"orientation": -0.4})
    assert all(env.step(TURN_LEFT)[0][1] for _ in range(9)), "a head that can follows it"


def test_perfect_legs_turn_just_as_far_every_time():
    for legs, spread in ((Legs(variation=0.0), 0.0), (Legs(variation=0.05), 0.05)):
        env = gymnasium.make(TASK, legs=legs)
        turned = []
        env.reset(seed=0, options={"orientation": 0.0})
        for k in range(24):
            before = env.unwrapped.world.pose[2]
            env.step(TURN_LEFT if k % 2 else TURN_RIGHT)
            turned.append(abs(env.unwrapped.world.pose[2] - before))
        assert bool(np.std(turned[2:]) > 1e-3) is (spread > 0)


# The same again ---------------------------------------------------------------------------------


def recorded(env, seed, episodes=4):
    """The bytes of some episodes, the first of them seeded."""
    said = []
    for k in range(episodes):
        observations, _, rewards, infos, _ = play(env, at_random(k), seed if k == 0 else None)
        told = [(i["orientation"], i["time"], i["is_success"]) for i in infos]
        said.append((observations.tobytes(), rewards, np.array(told).tobytes()))
    return said


def test_the_same_seed_gives_the_same_bytes():
    env = gymnasium.make(TASK)
    first = recorded(env, 5)
    assert recorded(gymnasium.make(TASK), 5) == first
    assert recorded(env, 5) == first, "reset(seed) then reset() can be had again"
    assert recorded(env, 6) != first


# Bad input --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"goal_distance": "close"}, "goal_distance.*close"),
        ({"goal_distance": 100}, "goal_distance.*100"),
        ({"goal_distance": 6000}, "goal_distance.*6000"),
        ({"goal_distance": None}, "goal_distance.*None"),
        ({"patience": 0}, "patience.*0"),
    ],
)
def test_bad_arguments_are_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        gymnasium.make(TASK, **arguments)


def test_bad_modes_places_and_actions_are_refused():
    env = gymnasium.make(TASK).unwrapped
    with pytest.raises(ValueError, match=r"render_mode.*human"):
        type(env)(render_mode="human")
    for options in ({"orientation": 0.6}, {"distance": 1000}, {"orientation": 0, "x": 1}):
        with pytest.raises(ValueError, match="orientation"):
            env.reset(seed=0, options=options)
    env.reset(seed=0)
    for action in (-1, 3):
        with pytest.raises(ValueError, match=f"action.*{action}"):
            env.step(action)


def test_a_camera_of_ones_own_is_used():
    env = gymnasium.make(TASK, camera=Camera(height=350.0))  # looks over the goal's bar
    observation, _ = env.reset(seed=0)
    assert not observation.any()


# Pictures ---------------------------------------------------------------------------------------


def orange(picture):
    return np.abs(picture.astype(int) - pitch.PALETTE[pitch.ORANGE]).sum(axis=-1) < 40


def test_the_picture_shows_the_ball_where_it_came_to_rest_and_the_way_there():
    env = gymnasium.make(TASK, render_mode="rgb_array", kick=Kick(0, 0))
    env.reset(seed=0, options={"orientation": 0.45})
    before = env.render()
    assert (before.shape, before.dtype) == ((600, 900, 3), np.uint8)
    env.step(KICK)
    after = env.render()
    x, y = env.unwrapped.world.ball
    row, column = int((2000 - y) * 0.15), int((x + 3000) * 0.15)
    assert orange(after)[row, column] and not orange(before)[row, column]
    halfway = env.unwrapped.ball_trail[len(env.unwrapped.ball_trail) // 2]
    row, column = int((2000 - halfway[1]) * 0.15), int((halfway[0] + 3000) * 0.15)
    red, green, _ = (after[row, column].astype(int) - before[row, column]).tolist()
    assert red > 50 and red > green
    env.reset(seed=0, options={"orientation": 0.45})
    assert np.array_equal(env.render(), before), "a new episode wipes the way off"


def test_a_film_shows_the_kick_from_the_paw_drawn_back_to_the_ball_at_rest():
    env = gymnasium.make(TASK, render_mode="rgb_array_list", kick=Kick(0, 0)).unwrapped
    env.reset(seed=0, options={"orientation": 0.0})
    assert len(env.render()) == 1
    env.step(KICK)
    film = env.render()
    rolling = env.world.time
    assert len(film) == pytest.approx(12 * rolling, rel=0.25)
    places = [np.nonzero(orange(frame))[1].mean() for frame in film[:-1] if orange(frame).any()]
    farthest = int(np.argmax(places))  # the back of the goal
    assert np.all(np.diff(places[: farthest + 1]) >= 0) and places[farthest] - places[0] > 250
    assert len(env.render()) == 1, "what has been shown is not shown again"


def test_without_a_render_mode_nothing_is_drawn():
    env = gymnasium.make(TASK).unwrapped
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert env.render() is None
