"""Stable-Baselines3's DQN on either task: ``python -m benchmarks.train_dqn goal``.

It sees what ARKAQ sees (the default), the camera's picture, or the truth. Not part of `make bench`
or of any test: it needs ``pip install torch stable-baselines3`` and some minutes.
"""

from __future__ import annotations

import argparse

import gymnasium
import numpy as np
import torch
from gymnasium.spaces import Box
from gymnasium.wrappers import RescaleObservation, TransformObservation, TransformReward
from stable_baselines3 import DQN
from stable_baselines3.common.monitor import Monitor

from arkaq_edu.envs import FullState, PixelObservation

TASKS = {"approach": "arkaq_edu:BallApproach-v0", "goal": "arkaq_edu:ScoreGoal-v0"}
STEPS = {"approach": 40_000, "goal": 30_000}
GAMMA = {"approach": 0.98, "goal": 0.9}  # some thirty steps to the ball, three to the kick


def make(task: str, sees: str) -> gymnasium.Env:
    """Return the task with observations and rewards of the size a network likes."""
    env = TransformReward(gymnasium.make(TASKS[task]), lambda reward: reward / 100)
    if sees == "pixels":
        # Every third pixel of every third row: ten thousands of whole pictures fill a memory.
        small = Box(0, 255, (54, 70, 3), np.uint8)
        return Monitor(TransformObservation(PixelObservation(env), lambda p: p[::3, ::3], small))
    env = FullState(env) if sees == "state" else env
    return Monitor(RescaleObservation(env, np.float32(-1), np.float32(1)))


def success(env: gymnasium.Env, act, episodes: int) -> float:
    """Return the share of episodes that `act` brings to the goal."""
    reached = 0
    env.reset(seed=10**6)
    for _ in range(episodes):
        (observation, info), over = env.reset(), False
        while not over:
            observation, _, terminated, truncated, info = env.step(act(observation))
            over = terminated or truncated
        reached += info["is_success"]
    return reached / episodes


def main() -> None:
    """Train, then set the greedy policy beside actions at random."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=TASKS)
    parser.add_argument("--sees", choices=("features", "pixels", "state"), default="features")
    parser.add_argument("--steps", type=int)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    torch.set_num_threads(1)  # nets this small only wait for each other on more
    env = make(args.task, args.sees)
    env.action_space.seed(args.seed)
    agent = DQN(
        "CnnPolicy" if args.sees == "pixels" else "MlpPolicy",
        env,
        learning_rate=5e-4,
        batch_size=256,
        buffer_size=30_000,
        learning_starts=1_000,
        gradient_steps=4,
        target_update_interval=1_000,
        gamma=GAMMA[args.task],
        exploration_fraction=0.8,
        exploration_final_eps=0.1,
        seed=args.seed,
        device="cpu",
    )
    agent.learn(args.steps or STEPS[args.task], log_interval=None)
    greedy = success(env, lambda seen: int(agent.predict(seen, deterministic=True)[0]), 200)
    chance = success(env, lambda seen: int(env.action_space.sample()), 200)
    print(f"{args.task}, seeing {args.sees}: DQN {greedy:.0%}, at random {chance:.0%}")


if __name__ == "__main__":
    main()
