"""Walk to the ball: the first task of the thesis as a Gymnasium environment."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from arkaq_edu import _checks
from arkaq_edu.field import Camera, Legs, Supervisor, World, bird_view
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE, Placement

# Left and right footstep (mm): forward, and arcs that turn by a tenth of a radian.
FOOTSTEPS = ((100.0, 100.0), (91.0, 109.0), (109.0, 91.0))
ACTIONS = ("forward", "left", "right")
_MOST_DISTANCE, _MOST_ORIENTATION = 8000.0, 0.6


class BallApproachEnv(gymnasium.Env[np.ndarray, int]):
    """Walk to a ball that stands somewhere in the field of view.

    ## Action space

    ``Discrete(3)``, one footstep cycle (640 ms) a step:

    | action | name | left, right footstep | what it does |
    |---|---|---|---|
    | 0 | forward | 100, 100 mm | walks 100 mm, drifting left and turning a little right |
    | 1 | left | 91, 109 mm | walks 100 mm on an arc that turns .1 rad to the left |
    | 2 | right | 109, 91 mm | walks 100 mm on an arc that turns .1 rad to the right |

    ## Observation space

    ``Box(float32, (3,))``, out of the camera's pixels:

    | entry | meaning | low | high |
    |---|---|---|---|
    | 0 | distance of the ball (mm); 0 without a sighting | 0 | 8000 |
    | 1 | orientation of the ball (rad, left positive); 0 without a sighting | -0.6 | 0.6 |
    | 2 | visible: 1 with a sighting, else 0 | 0 | 1 |

    ## Rewards

    +100 when the true distance falls under 500 mm, and +50 more if the ball then lies within
    .05 rad of straight ahead; 0 otherwise.

    ## Start

    The robot stands before its own goal and looks up the field; the ball is placed by the
    supervisor, uniform over the visible field between `near` and `far`. With
    ``options={"distance": mm, "orientation": rad}`` in ``reset`` it is put just there.

    ## End

    Terminated: the true distance is under 500 mm. Truncated: the camera has not seen the ball for
    `patience` cycles in a row (it is out of view for good), or 150 cycles have passed.

    ## Info

    From ``reset`` and ``step``: the true `distance` (mm) and `orientation` (rad), `is_success`
    (True from the cycle in which the ball is reached).

    Parameters
    ----------
    near, far : float
        The nearest and farthest start of the ball (mm), in [200, 4100].
    placement : {"area", "thesis"}
        How the ball is placed; see `arkaq_edu.field.random_place`.
    legs : Legs, optional
        The gait's imperfections.
    camera : Camera, optional
        The camera.
    patience : int
        Cycles without a sighting after which the ball counts as lost.
    render_mode : {"rgb_array"}, optional
        The field from above.

    References
    ----------
    Thesis 5.2 (interval of the inputs, actions) and 5.2.2 (rewards).

    Examples
    --------
    >>> env = gymnasium.make("arkaq_edu:BallApproach-v0")
    >>> observation, info = env.reset(seed=0, options={"distance": 950, "orientation": 0.0})
    >>> reward, cycles, terminated = 0.0, 0, False
    >>> while not terminated:
    ...     observation, reward, terminated, truncated, info = env.step(0)
    ...     cycles += 1
    >>> cycles, reward, info["is_success"]
    (5, 150.0, True)
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 12}  # noqa: RUF012

    def __init__(
        self,
        near: float = 600.0,
        far: float = MAX_BALL_DISTANCE,
        placement: Placement = "area",
        legs: Legs | None = None,
        camera: Camera | None = None,
        patience: int = 10,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode must be None or 'rgb_array', got {render_mode!r}")
        self.render_mode = render_mode
        self.patience = _checks.integer("patience", patience, 1)
        self.supervisor = Supervisor(near, far, placement)
        self.camera = camera or Camera()
        self.world = World(legs=legs)
        self.trail: list[tuple[float, float]] = []
        self.action_space = spaces.Discrete(len(FOOTSTEPS))  # type: ignore[assignment]
        low = np.array([0.0, -_MOST_ORIENTATION, 0.0], dtype=np.float32)
        high = np.array([_MOST_DISTANCE, _MOST_ORIENTATION, 1.0], dtype=np.float32)
        self.observation_space = spaces.Box(low, high, dtype=np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode; see the class's Start."""
        super().reset(seed=seed)
        self.world.rng = self.np_random
        place = dict(options or {})
        if place:
            distance, orientation = place.pop("distance", None), place.pop("orientation", None)
            if place or distance is None or orientation is None:
                raise ValueError(f"options must hold distance and orientation, got {options!r}")
            self.supervisor.place(
                self.world,
                _checks.number("distance", distance, 200, MAX_BALL_DISTANCE),
                _checks.number("orientation", orientation, -0.5, 0.5),
            )
        else:
            self.supervisor.reset(self.world, self.np_random)
        self.trail = [self.world.pose[:2]]
        self._unseen = 0
        return self._observe(), self._info(self.supervisor.judge(self.world).is_success)

    def step(self, action: int) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take one footstep cycle."""
        if action not in (0, 1, 2):
            raise ValueError(f"action must be 0, 1 or 2, got {action!r}")
        self.world.cycle(*FOOTSTEPS[int(action)])
        self.trail.append(self.world.pose[:2])
        observation = self._observe()
        verdict = self.supervisor.judge(self.world)
        self._unseen = 0 if observation[2] else self._unseen + 1
        lost = self._unseen >= self.patience and not verdict.is_success
        return observation, verdict.reward, verdict.is_success, lost, self._info(verdict.is_success)

    def render(self) -> np.ndarray | None:
        """Draw the field from above, with the way walked so far."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() draws only with render_mode='rgb_array'")
            return None
        return bird_view(self.world, trail=self.trail)

    def _observe(self) -> np.ndarray:
        seen = self.camera.sighting(self.world)
        if seen is None:
            return np.zeros(3, dtype=np.float32)
        distance = min(seen.distance, _MOST_DISTANCE)
        orientation = max(-_MOST_ORIENTATION, min(_MOST_ORIENTATION, seen.orientation))
        return np.array([distance, orientation, 1.0], dtype=np.float32)

    def _info(self, is_success: bool) -> dict[str, Any]:
        distance, orientation = self.world.ball_from_robot()
        return {"distance": distance, "orientation": orientation, "is_success": is_success}
