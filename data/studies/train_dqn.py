"""Stable-Baselines3's DQN on either task, for ``arkaq study data/studies/deep.toml --out DQN``.

It sees what ARKAQ sees, the camera's picture, or the truth. Not part of `make bench` or of any
test: it needs ``pip install torch stable-baselines3``, and about half a minute on one core for
8,000 steps.
"""

from __future__ import annotations

import gymnasium
import numpy as np
import torch
from gymnasium.spaces import Box
from gymnasium.wrappers import RescaleObservation, TransformObservation, TransformReward
from stable_baselines3 import DQN
from stable_baselines3.common.monitor import Monitor

from arkaq_edu.envs import FullState, PixelObservation

TASKS = {"approach": "arkaq_edu:BallApproach-v0", "goal": "arkaq_edu:ScoreGoal-v0"}
GAMMA = {"approach": 0.98, "goal": 0.9}  # some thirty steps to the ball, three to the kick
FRESH = 10**6  # seeds of the episodes that judge


def measure(
    seed: int, problem: str, steps: int, sees: str = "features", episodes: int = 200, **options
) -> dict[str, float]:
    """Train a network for some steps, and judge its greedy policy on fresh starts.

    Parameters
    ----------
    seed : int
    problem : {"approach", "goal"}
    steps : int
        Steps in the environment.
    sees : {"features", "pixels", "state"}
        What ARKAQ sees (the default), the camera's picture, or the truth.
    episodes : int
        Fresh starts.
    **options
        Options of the task, for example ``goal_distance``.
    """
    torch.set_num_threads(1)  # nets this small only wait for each other on more
    env = make(problem, sees, options)
    env.action_space.seed(seed)
    agent = DQN(
        "CnnPolicy" if sees == "pixels" else "MlpPolicy",
        env,
        learning_rate=5e-4,
        batch_size=64,
        buffer_size=30_000,
        learning_starts=1_000,
        gradient_steps=2,
        target_update_interval=1_000,
        gamma=GAMMA[problem],
        exploration_fraction=0.8,
        exploration_final_eps=0.1,
        seed=seed,
        device="cpu",
    )
    agent.learn(steps, log_interval=None)
    return {
        "success": success(
            env, lambda seen: int(agent.predict(seen, deterministic=True)[0]), seed, episodes
        ),
        "success at random": success(
            env, lambda seen: int(env.action_space.sample()), seed, episodes
        ),
    }


def make(problem: str, sees: str, options: dict) -> gymnasium.Env:
    """Return the task with observations and rewards of the size a network likes."""
    env = TransformReward(gymnasium.make(TASKS[problem], **options), lambda reward: reward / 100)
    if sees == "pixels":
        # Every third pixel of every third row: ten thousands of whole pictures fill a memory.
        small = Box(0, 255, (54, 70, 3), np.uint8)
        return Monitor(TransformObservation(PixelObservation(env), lambda p: p[::3, ::3], small))
    env = FullState(env) if sees == "state" else env
    return Monitor(RescaleObservation(env, np.float32(-1), np.float32(1)))


def success(env: gymnasium.Env, act, seed: int, episodes: int) -> float:
    """Return the percentage of episodes that `act` brings to the goal."""
    reached = 0
    env.reset(seed=FRESH + seed)
    for _ in range(episodes):
        (observation, info), over = env.reset(), False
        while not over:
            observation, _, terminated, truncated, info = env.step(act(observation))
            over = terminated or truncated
        reached += info["is_success"]
    return 100 * reached / episodes
