"""Walk to the ball: the first task of the thesis as a Gymnasium environment."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from arkaq_edu import _checks
from arkaq_edu.field import Camera, Legs, Supervisor, World, bird_view
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE, Placement

ACTIONS = ("forward", "left", "right")
# The left and the right footstep of each action (mm). The arcs turn by a tenth of a radian.
FOOTSTEPS = ((100.0, 100.0), (91.0, 109.0), (109.0, 91.0))
# Limits of the observations: more than the diagonal of the carpet (mm), and more than half the
# camera's field of view (rad).
_MAX_DISTANCE, _MAX_ORIENTATION = 8000.0, 0.6


class BallApproachEnv(gymnasium.Env[np.ndarray, int]):
    """Walk to a ball that lies somewhere in the field of view.

    A legged robot stands at one end of a field and sees the ball through its camera. It should
    walk up to the ball, and have it straight ahead when it arrives. Lengths are in mm, angles in
    rad and positive to the left.

    ## Action space

    ``Discrete(3)``, an integer or an array of one. Each step is one footstep cycle (640 ms):

    | action | name | left, right footstep | effect |
    |---|---|---|---|
    | 0 | forward | 100, 100 mm | walks 100 mm, drifts left and turns a little to the right |
    | 1 | left | 91, 109 mm | walks 100 mm along an arc that turns .1 rad to the left |
    | 2 | right | 109, 91 mm | walks 100 mm along an arc that turns .1 rad to the right |

    ## Observation space

    ``Box(float32, (3,))``, measured from the camera's pixels:

    | entry | meaning | low | high |
    |---|---|---|---|
    | 0 | distance of the ball (mm); 0 without a sighting | 0 | 8000 |
    | 1 | orientation of the ball (rad, left positive); 0 without a sighting | -0.6 | 0.6 |
    | 2 | visible: 1 with a sighting, else 0 | 0 | 1 |

    ## Rewards

    +100 in the cycle in which the true distance falls below 500 mm, and +50 more if the ball is
    then within .05 rad of straight ahead. 0 in all other cycles.

    ## Starting state

    The robot stands in front of its own goal and looks up the field. The supervisor puts the ball
    at a random place that the camera can see, between `near` and `far`. With
    ``options={"distance": mm, "orientation": rad}`` in ``reset``, it puts the ball there instead:
    the distance in [200, 4100], the orientation in [-.5, .5].

    ## Episode end

    Terminated when the true distance is below 500 mm. Truncated when the camera has not seen the
    ball for `patience` cycles in a row, since it is then out of view for good, or after 150
    cycles (the ``max_episode_steps`` of `gymnasium.make`).

    ## Information

    ``reset`` and ``step`` return the true `distance` (mm) and `orientation` (rad) of the ball, and
    `is_success`: True once the ball is reached.

    ## Version history

    v0: first version.

    Parameters
    ----------
    near, far : float
        The least and the greatest distance of the ball at the start (mm), in [200, 4100], `far`
        at least as large as `near`. A ball below 500 mm is reached in the first cycle.
    placement : {"area", "thesis"}
        How the ball is placed; see `arkaq_edu.field.random_place`.
    legs : Legs, optional
        The gait's imperfections.
    camera : Camera, optional
        The camera.
    patience : int
        The number of cycles without a sighting after which the ball is lost, at least 1.
    render_mode : {"rgb_array"}, optional
        A picture of the field from above.

    Raises
    ------
    ValueError
        If an argument is out of range or unknown.

    References
    ----------
    Thesis 5.2 (intervals of the inputs, actions) and 5.2.2 (rewards).

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
        if render_mode is not None:
            _checks.choice("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        self.patience = _checks.integer("patience", patience, 1)
        self.supervisor = Supervisor(near, far, placement)
        self.camera = _checks.instance("camera", Camera() if camera is None else camera, Camera)
        self.world = World(legs=legs)
        self.trail: list[tuple[float, float]] = []
        self.action_space = spaces.Discrete(len(FOOTSTEPS))  # type: ignore[assignment]
        low = np.array([0.0, -_MAX_ORIENTATION, 0.0], dtype=np.float32)
        high = np.array([_MAX_DISTANCE, _MAX_ORIENTATION, 1.0], dtype=np.float32)
        self.observation_space = spaces.Box(low, high, dtype=np.float32)

    @property
    def settings(self) -> dict[str, Any]:
        """All that shapes the episodes, by name: what a training's file keeps of its task."""
        return {
            "near": self.supervisor.near,
            "far": self.supervisor.far,
            "placement": self.supervisor.placement,
            "patience": self.patience,
            "legs": vars(self.world.legs),
            "camera": vars(self.camera),
        }

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode; see Starting state above."""
        super().reset(seed=_checks.seed("seed", seed))
        self.world.rng = self.np_random
        place = dict(_checks.instance("options", {} if options is None else options, dict))
        if place:
            distance, orientation = place.pop("distance", None), place.pop("orientation", None)
            if place or distance is None or orientation is None:
                given = _checks.shown(options)
                raise ValueError(f"options must hold distance and orientation, got {given}")
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
        """Walk one footstep cycle."""
        action = _checks.integer("action", action, 0, len(FOOTSTEPS) - 1)
        self.world.cycle(*FOOTSTEPS[action])
        self.trail.append(self.world.pose[:2])
        observation = self._observe()
        verdict = self.supervisor.judge(self.world)
        self._unseen = 0 if observation[2] else self._unseen + 1
        lost = self._unseen >= self.patience and not verdict.is_success
        return observation, verdict.reward, verdict.is_success, lost, self._info(verdict.is_success)

    def render(self) -> np.ndarray | None:
        """Draw the field from above, with the robot's path so far."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() draws only with render_mode='rgb_array'")
            return None
        return bird_view(self.world, trail=self.trail)

    def _observe(self) -> np.ndarray:
        seen = self.camera.sighting(self.world)
        if seen is None:
            return np.zeros(3, dtype=np.float32)
        distance = min(seen.distance, _MAX_DISTANCE)
        orientation = max(-_MAX_ORIENTATION, min(_MAX_ORIENTATION, seen.orientation))
        return np.array([distance, orientation, 1.0], dtype=np.float32)

    def _info(self, is_success: bool) -> dict[str, Any]:
        distance, orientation = self.world.ball_from_robot()
        return {"distance": distance, "orientation": orientation, "is_success": is_success}
