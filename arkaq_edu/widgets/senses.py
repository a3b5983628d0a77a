"""The senses of the live robot, which can be made worse, and the film of how it moved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from arkaq_edu.arkaq import Estimator, Sensing

_FILM = 1 / 30  # s between two rows of a motion, where more than the ends of a cycle is to be seen


class Senses(gymnasium.Wrapper):
    """A task with worse senses, which records how robot and ball moved in the last step.

    Attributes
    ----------
    noise : float
        How far off a sighting is, along and across (mm, one standard deviation).
    dropout : float
        How likely a sighting is lost.
    motion : list of list
        Rows of time (s, from the start of the step), x, y, heading and pan of the robot, x and y
        of the ball and, while it kicks, x and y of the paw (mm, rad).
    """

    def __init__(self, env: gymnasium.Env) -> None:
        super().__init__(env)
        self.noise = self.dropout = 0.0
        self.motion: list[list[float]] = []
        task: Any = env.unwrapped
        self.world, self.camera = task.world, task.camera
        self._range = task.start.distance if hasattr(task, "start") else None

    def follow(self, estimator: Estimator) -> None:
        """Tell this estimator how noisy the senses are: its filter's R grows by as much."""
        self._estimator, self._sensing = estimator, estimator.sensing

    def film(self, filming: bool) -> None:
        """Record also what lies between the ends of a step, or not: it takes time."""
        self.world.watch = self._watch if filming else None

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, Any]:
        """Start an episode."""
        self.rng = np.random.default_rng(seed)
        self._begin()  # a robot that cannot see the goal looks around first
        observation, info = self.env.reset(seed=seed, options=options)
        self._begin()
        return self._sensed(observation), info

    def step(self, action: int) -> tuple[Any, Any, bool, bool, Any]:
        """Act for one cycle."""
        self._begin()
        observation, *rest = self.env.step(action)
        self._record()
        return self._sensed(observation), *rest  # type: ignore[return-value]

    def _begin(self) -> None:
        self._start, self.motion = self.world.time, []
        self._record()

    def row(self, t: float) -> list[float]:
        """Return where everything is, as a row of `motion`."""
        world = self.world
        x, y, heading = world.pose
        places = *short((x, y)), *short((heading, world.pan), 4), *short(world.ball)
        return [round(t, 3), *places, *short(world.paw or ())]

    def _record(self) -> None:
        self.motion.append(self.row(self.world.time - self._start))

    def _watch(self) -> None:
        if self.world.time - self._start >= self.motion[-1][0] + _FILM:
            self._record()

    def _sensed(self, observation: NDArray[np.floating]) -> NDArray[np.floating]:
        if not observation[-1] or self.rng.random() < self.dropout:
            return np.zeros_like(observation)
        if self.noise:
            spread = np.full(len(observation) - 1, float(self.noise))
            spread[-1] /= self._range or max(observation[0], 1.0)  # what lies aside, as an angle
            observation = observation.copy()
            observation[:-1] += spread * self.rng.standard_normal(len(spread))
            self._tell(replace(self._sensing, R=self._sensing.R + np.diag(spread**2)))
        elif self._estimator.sensing is not self._sensing:
            self._tell(self._sensing)
        return observation

    def _tell(self, sensing: Sensing) -> None:
        self._estimator.sensing = sensing
        self._estimator.kalman.R = sensing.R


def short(values: Any, digits: int = 1) -> list[float]:
    """Return rounded numbers, as JSON holds them."""
    return [round(float(value), digits) for value in values]
