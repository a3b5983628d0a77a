"""The tasks and the agent: a cycle, a training, and studies over seeds and workers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from unittest import mock

import gymnasium
import numpy as np

from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import approach, study
from arkaq_edu.field import World, arcs
from arkaq_edu.field.world import CYCLE, SUBSTEPS
from benchmarks.case import Case, Figure, Growth, Run, timed

CYCLES = 400
#: A training that is short, for growth against seeds and workers.
SHORT = {"patterns": 200, "exploration": 500, "exploitation": 500, "episodes": 5}


def at_random(name: str) -> tuple[gymnasium.Env, Run]:
    """Return a task, and a run of random actions in it, camera and resets included."""
    env = gymnasium.make(f"arkaq_edu:{name}")
    actions = np.random.default_rng(0).integers(env.action_space.n, size=CYCLES)

    def run() -> None:
        env.reset(seed=0)
        for action in actions:
            _, _, terminated, truncated, _ = env.step(int(action))
            if terminated or truncated:
                env.reset()

    return env, run


def actions_a_second(name: str) -> Callable[[], float]:
    _, run = at_random(name)
    return lambda: CYCLES / float(np.median([timed(run) for _ in range(7)]))


def far_from_all() -> tuple[Run, Run]:
    """Return a walk where nothing is near: as it is, and by the physics all the way."""
    world = World(rng=0)
    world.reset((0.0, 0.0, 0.0), (-2500.0, -1500.0))

    def walk() -> None:
        for _ in range(CYCLES // 2):
            world.cycle(100.0, 100.0)
            world.cycle(-100.0, -100.0)

    def by_physics() -> None:
        with mock.patch.object(arcs, "free_cycle", lambda robot, ball, *_: (robot, ball, False)):
            walk()

    return walk, by_physics


def trained() -> float:
    """Return how long a training to walk to the ball takes, once its loops are compiled."""
    learning = TrainingSettings(patterns=200, exploration=500, exploitation=500)
    approach.train(seed=0, vigilance=0.1, learning=learning, progress=False)
    return timed(lambda: approach.train(seed=0, vigilance=0.1, progress=False))


def studied(seeds: int, jobs: int) -> Run:
    settings = {name: value for name, value in SHORT.items()}
    return lambda: study({"vigilance": [0.2]}, seeds, settings=settings, jobs=jobs, progress=False)


def cases() -> Iterator[Case | Figure | Growth]:
    env, run = at_random("BallApproach-v0")
    space = env.unwrapped.world.space

    def bare() -> None:
        for _ in range(CYCLES * SUBSTEPS):
            space.step(CYCLE / SUBSTEPS)

    bare_name = f"limit ({SUBSTEPS} bare pymunk steps)"
    yield Case("BallApproach-v0, random", "cycle", CYCLES, run, {bare_name: (CYCLES, bare)})
    walk, by_physics = far_from_all()
    by_physics_name = f"physics ({SUBSTEPS} steps)"
    yield Case(
        "cycle with nothing near", "cycle", CYCLES, walk, {by_physics_name: (CYCLES, by_physics)},
        {by_physics_name: 3.0},
    )  # fmt: skip
    for name, wanted in (("BallApproach-v0", 8000.0), ("ScoreGoal-v0", 4000.0)):
        title = f"{name}, random actions a second"
        yield Figure(title, "a second", actions_a_second(name), at_least=wanted)
    yield Figure("training to walk to the ball, vigilance 0.1", "s", trained, at_most=10.0)
    yield Growth("study, a short training", "seeds", [2, 4, 8], lambda n: studied(n, 1))
    yield Growth("study of 4 seeds", "workers", [1, 2], lambda n: studied(4, n))
