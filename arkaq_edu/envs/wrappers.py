"""Other observations of the same tasks: the camera's picture, or the true state.

The observations of the tasks are measurements from the camera's picture. With these wrappers an
agent gets the picture itself, or the true state, which no real robot knows.
"""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import RecordConstructorArgs

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.camera import HEIGHT, WIDTH


def _task(env: Any) -> gymnasium.Env:
    """Return `env` if it is one of the tasks on the field, or refuse it."""
    if not isinstance(env, gymnasium.Env) or not hasattr(env.unwrapped, "world"):
        given = _checks.shown(env)
        raise ValueError(f"env must be BallApproach-v0 or ScoreGoal-v0, got {given}")
    return env


class PixelObservation(gymnasium.ObservationWrapper, RecordConstructorArgs):
    """Observe the camera's picture.

    ## Observation space

    ``Box(0, 255, (160, 208, 3), uint8)``, the picture in color. With ``classes=True``,
    ``Box(0, 6, (160, 208), uint8)``, the color class of each pixel: an index into
    `arkaq_edu.field.pitch.PALETTE`.

    Parameters
    ----------
    env : gymnasium.Env
        ``BallApproach-v0`` or ``ScoreGoal-v0``.
    classes : bool
        Whether to return color classes.

    References
    ----------
    Thesis figure 5.3.

    Examples
    --------
    >>> env = PixelObservation(gymnasium.make("arkaq_edu:BallApproach-v0"))
    >>> picture, info = env.reset(seed=0)
    >>> picture.shape, picture.dtype
    ((160, 208, 3), dtype('uint8'))
    """

    def __init__(self, env: gymnasium.Env, classes: bool = False) -> None:
        RecordConstructorArgs.__init__(self, classes=classes)
        gymnasium.ObservationWrapper.__init__(self, _task(env))
        self.classes = bool(classes)
        self.observation_space = (
            spaces.Box(0, len(pitch.PALETTE) - 1, (HEIGHT, WIDTH), np.uint8)
            if self.classes
            else spaces.Box(0, 255, (HEIGHT, WIDTH, 3), np.uint8)
        )

    def observation(self, observation: Any) -> np.ndarray:
        """Return the picture instead of the measurements."""
        task: Any = self.unwrapped
        return (task.camera.colors if self.classes else task.camera.picture)(task.world)


class FullState(gymnasium.ObservationWrapper, RecordConstructorArgs):
    """Observe where the robot and the ball truly are.

    ## Observation space

    ``Box(float32, (5,))``:

    | entry | meaning | low | high |
    |---|---|---|---|
    | 0, 1 | x, y of the robot (mm) | -3000, -2000 | 3000, 2000 |
    | 2 | heading of the robot (rad, 0 up the field) | -pi | pi |
    | 3, 4 | x, y of the ball (mm) | -3000, -2000 | 3000, 2000 |

    Parameters
    ----------
    env : gymnasium.Env
        ``BallApproach-v0`` or ``ScoreGoal-v0``.

    Examples
    --------
    >>> env = FullState(gymnasium.make("arkaq_edu:ScoreGoal-v0"))
    >>> state, info = env.reset(seed=0, options={"orientation": 0.25})
    >>> state.tolist()
    [850.0, 0.0, -0.25, 850.0, -1800.0]
    """

    def __init__(self, env: gymnasium.Env) -> None:
        RecordConstructorArgs.__init__(self)
        gymnasium.ObservationWrapper.__init__(self, _task(env))
        x, y = pitch.CARPET_LENGTH / 2, pitch.CARPET_WIDTH / 2
        high = np.array([x, y, np.pi, x, y], dtype=np.float32)
        self.observation_space = spaces.Box(-high, high, dtype=np.float32)

    def observation(self, observation: Any) -> np.ndarray:
        """Return the true state instead of the measurements."""
        world = self.unwrapped.world  # type: ignore[attr-defined]
        x, y, heading = world.pose
        heading = math.remainder(heading, 2 * math.pi)
        return np.array([x, y, heading, *world.ball], dtype=np.float32)
