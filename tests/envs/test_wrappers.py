"""The same tasks seen otherwise: as pictures, and as they truly are."""

import math
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from arkaq_edu.envs import FullState, PixelObservation
from arkaq_edu.field import pitch

TASKS = ["arkaq_edu:BallApproach-v0", "arkaq_edu:ScoreGoal-v0"]


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize(
    "wrap", [FullState, PixelObservation, lambda env: PixelObservation(env, classes=True)]
)
def test_gymnasium_has_nothing_to_complain_of(task, wrap):
    env = wrap(gymnasium.make(task).unwrapped)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # That the checker would rather have the task bare is not news.
        warnings.filterwarnings("ignore", message=".*different from the unwrapped version.*")
        warnings.filterwarnings("ignore", message=".*[Cc]heck_env.*")
        check_env(env)


@pytest.mark.parametrize("task", TASKS)
def test_the_picture_is_what_the_task_measured(task):
    env = PixelObservation(gymnasium.make(task), classes=True)
    measured = gymnasium.make(task)
    for seed in range(8):
        colors, _ = env.reset(seed=seed)
        seen, _ = measured.reset(seed=seed)
        camera, world = env.unwrapped.camera, env.unwrapped.world
        assert colors in env.observation_space and colors.shape == (160, 208)
        for action in (0, 1, 1):
            read = camera.sighting_in(colors) if len(seen) == 3 else camera.goal_in(colors)
            if read is None:
                assert not seen[-1]
            else:
                orientation = read.orientation + world.pan
                assert seen[-2] == pytest.approx(orientation, abs=1e-6)
            colors, *_ = env.step(action)
            seen, *_ = measured.step(action)


@pytest.mark.parametrize("task", TASKS)
def test_the_picture_in_color_is_that_of_the_classes(task):
    picture, _ = PixelObservation(gymnasium.make(task)).reset(seed=3)
    classes, _ = PixelObservation(gymnasium.make(task), classes=True).reset(seed=3)
    assert picture.shape == (160, 208, 3) and picture.dtype == classes.dtype == np.uint8
    assert np.array_equal(picture, pitch.PALETTE[classes])
    assert len(np.unique(classes)) >= 3


@pytest.mark.parametrize("task", TASKS)
def test_the_full_state_is_the_truth(task):
    env = FullState(gymnasium.make(task))
    rng = np.random.default_rng(0)
    for seed in range(10):
        state, info = env.reset(seed=seed)
        over = False
        while not over:
            assert state in env.observation_space and state.dtype == np.float32
            x, y, heading, ball_x, ball_y = state.tolist()
            to = (2700, 0) if "Goal" in task else (ball_x, ball_y)
            bearing = math.atan2(to[1] - y, to[0] - x) - heading
            assert math.remainder(bearing - info["orientation"], 2 * math.pi) == pytest.approx(
                0, abs=0.003
            )
            state, _, terminated, truncated, info = env.step(int(rng.integers(3)))
            over = terminated or truncated


def test_what_is_seen_changes_nothing_of_what_happens():
    said = []
    for wrap in (lambda env: env, FullState, PixelObservation):
        env = wrap(gymnasium.make(TASKS[1]))
        env.reset(seed=2)
        told = [env.step(action)[1:] for action in (0, 1, 1, 2)]
        said.append(told)
    assert said[0] == said[1] == said[2]


def test_the_heading_of_the_full_state_comes_round():
    env = FullState(gymnasium.make(TASKS[1]))
    env.reset(seed=0)
    headings = np.array([env.step(0)[0][2] for _ in range(25)])
    assert headings.min() < -3 < 3 < headings.max()
    assert math.sin(headings[-1]) == pytest.approx(math.sin(env.unwrapped.world.pose[2]), abs=1e-6)
