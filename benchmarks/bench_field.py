"""The tasks' speed, the first against the pymunk steps it makes, and the time of a training."""

from __future__ import annotations

import time

import gymnasium
import numpy as np

from arkaq_edu.experiments.approach import train
from arkaq_edu.field.world import CYCLE, SUBSTEPS

CYCLES, ROUNDS = 1000, 7


def time_task(env: gymnasium.Env, actions: np.ndarray) -> float:
    """Return seconds a cycle, camera and resets included."""
    env.reset(seed=0)
    begin = time.perf_counter()
    for action in actions:
        _, _, terminated, truncated, _ = env.step(int(action))
        if terminated or truncated:
            env.reset()
    return (time.perf_counter() - begin) / len(actions)


def time_steps(env: gymnasium.Env) -> float:
    """Return seconds that the bare pymunk steps of a cycle take."""
    space = env.unwrapped.world.space
    begin = time.perf_counter()
    for _ in range(CYCLES * SUBSTEPS // 10):
        space.step(CYCLE / SUBSTEPS)
    return (time.perf_counter() - begin) / CYCLES * 10


def main() -> None:
    """Print both, and their ratio."""
    env = gymnasium.make("arkaq_edu:BallApproach-v0")
    actions = np.random.default_rng(0).integers(3, size=CYCLES)
    time_task(env, actions[:10])
    pairs = [(time_task(env, actions), time_steps(env)) for _ in range(ROUNDS)]
    task, steps = np.median(pairs, axis=0) * 1e6
    ratio = np.median([steps / task for task, steps in pairs])
    print(f"a cycle of the task {task:.0f} us; its {SUBSTEPS} bare pymunk steps {steps:.0f} us")
    print(f"speed of the task over bare pymunk: {ratio:.2f} (wanted: at least 0.5)")
    goal = gymnasium.make("arkaq_edu:ScoreGoal-v0")
    time_task(goal, actions[:10])
    for name, seconds in (
        ("to the ball", task / 1e6),
        ("at goal", np.median([time_task(goal, actions) for _ in range(ROUNDS)])),
    ):
        print(f"actions a second {name}, at random: {1 / seconds:.0f} (wanted: at least 2000)")
    begin = time.process_time()
    agent = train(seed=0, progress=False)
    spent = time.process_time() - begin
    print(f"training of {agent.cycles} cycles: {spent:.1f} s of one core (wanted: under 40)")


if __name__ == "__main__":
    main()
