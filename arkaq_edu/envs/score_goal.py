"""Score a goal: the second task of the thesis as a Gymnasium environment."""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple

import gymnasium
import numpy as np
from gymnasium import spaces

from arkaq_edu import _checks
from arkaq_edu.field import Camera, GoalSupervisor, Head, Kick, Legs, World, bird_view, motion
from arkaq_edu.field.goal import MAX_GOAL_DISTANCE, MIN_GOAL_DISTANCE, MISS_REWARD

ACTIONS = ("turn left", "turn right", "kick")
TURN_LEFT, TURN_RIGHT, KICK = range(3)
TURN = 0.15
_MOST_ORIENTATION = 2.2


class Start(NamedTuple):
    """How far from the goal (mm), and how far it lies off straight ahead at the start (rad)."""

    distance: float
    least: float
    most: float


# Thesis 5.3 gives no number. Its "near" is where the robot's kick, well aimed, scores about six
# times in ten; its "far" is farther, and "not straight": the robot looks past the goal.
STARTS = {"near": Start(1850.0, 0.0, 0.4), "far": Start(2300.0, 0.25, 0.4)}


class ScoreGoalEnv(gymnasium.Env[np.ndarray, int]):
    """Turn toward the goal and kick.

    ## Action space

    ``Discrete(3)``:

    | action | name | left, right footstep | what it does |
    |---|---|---|---|
    | 0 | turn left | -13.5, 13.5 mm | turns .15 rad to the left on the spot in one cycle (640 ms) |
    | 1 | turn right | 13.5, -13.5 mm | turns .15 rad to the right |
    | 2 | kick | | the supervisor sets the ball before the paw, the paw swings, the ball rolls out |

    ## Observation space

    ``Box(float32, (2,))``, out of the camera's pixels:

    | entry | meaning | low | high |
    |---|---|---|---|
    | 0 | orientation of the goal's middle (rad, left positive); 0 without a sighting | -2.2 | 2.2 |
    | 1 | visible: 1 with a sighting, else 0 | 0 | 1 |

    The robot looks after each turn. Where the picture cuts the goal, it pans its head to what it
    saw, waits until the head is still, and looks again. The orientation is counted from the body.

    ## Rewards

    +100 for a ball that comes to rest in the goal, -100 for a kick that misses, 0 for a turn. A
    robot that has not kicked after `patience` turns has missed: -100.

    ## Start

    The robot stands `goal_distance` straight before the middle of the sky-blue goal. The
    orientation of the goal is drawn:

    | `goal_distance` | mm | orientation (rad) |
    |---|---|---|
    | "near" | 1850 | uniform in [-.4, .4] |
    | "far" | 2300 | uniform in [.25, .4], on either side |
    | a number | that | uniform in [-.4, .4] |

    So the goal's middle is in the picture. With ``options={"orientation": rad}`` in
    ``reset`` the goal is just there.

    ## End

    Terminated by the kick, or after `patience` turns. There is no time limit besides.

    ## Info

    From ``reset`` and ``step``: the true `orientation` (rad) of the goal's middle, `is_success`
    (True when a goal has been scored), `time` (s since the start).

    Parameters
    ----------
    goal_distance : {"near", "far"} or float
        Where the robot stands (mm from its turning point to the goal line), in [800, 5000].
    legs : Legs, optional
        The gait's imperfections.
    head : Head, optional
        How the head moves, and whether that blurs the pictures.
    kick : Kick, optional
        How the ball lies before a kick, and how straight it rolls.
    camera : Camera, optional
        The camera.
    patience : int
        Turns after which the episode ends without a kick.
    render_mode : {"rgb_array", "rgb_array_list"}, optional
        The field from above: as it is now, or a film of all since the last ``render``, with the
        ball on its way.

    Notes
    -----
    The thesis gives neither distances, turn nor starts. The kick decides them: it is calibrated on
    50 kicks of a real robot (`arkaq_edu.field.Kick`), and aimed as well as turns of .15 rad allow
    it scores 63 % from 1,850 mm, where actions at random score 33 %: the thesis's "around 60" and
    "around 35 per cent". From 2,300 mm it is 36 % and 12 %.

    References
    ----------
    Thesis 5.3, figures 5.31 to 5.33, 5.40 and 5.41.

    Examples
    --------
    >>> env = gymnasium.make("arkaq_edu:ScoreGoal-v0", goal_distance="near")
    >>> observation, info = env.reset(seed=0, options={"orientation": 0.16})
    >>> observation.round(2)
    array([0.16, 1.  ], dtype=float32)
    >>> observation, reward, terminated, truncated, info = env.step(0)
    >>> reward, terminated, bool(abs(info["orientation"]) < 0.03)
    (0.0, False, True)
    >>> observation, reward, terminated, truncated, info = env.step(2)
    >>> reward, terminated, info["is_success"]
    (100.0, True, True)
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": ["rgb_array", "rgb_array_list"],
        "render_fps": 12,
    }

    def __init__(
        self,
        goal_distance: Literal["near", "far"] | float = "near",
        legs: Legs | None = None,
        head: Head | None = None,
        kick: Kick | None = None,
        camera: Camera | None = None,
        patience: int = 30,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(
                f"render_mode must be None, 'rgb_array' or 'rgb_array_list', got {render_mode!r}"
            )
        if isinstance(goal_distance, str):
            if goal_distance not in STARTS:
                raise ValueError(
                    f"goal_distance must be 'near', 'far' or a number, got {goal_distance!r}"
                )
            self.start = STARTS[goal_distance]
        else:
            distance = _checks.number(
                "goal_distance", goal_distance, MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE
            )
            self.start = STARTS["near"]._replace(distance=distance)
        self.render_mode = render_mode
        self.patience = _checks.integer("patience", patience, 1)
        self.supervisor = GoalSupervisor(self.start.distance)
        self.camera = camera or Camera()
        self.world = World(legs=legs, head=head, kick=kick)
        self.ball_trail: list[tuple[float, float]] = []
        self.action_space = spaces.Discrete(len(ACTIONS))  # type: ignore[assignment]
        low = np.array([-_MOST_ORIENTATION, 0.0], dtype=np.float32)
        high = np.array([_MOST_ORIENTATION, 1.0], dtype=np.float32)
        self.observation_space = spaces.Box(low, high, dtype=np.float32)
        self._frames: list[np.ndarray] = []
        if render_mode == "rgb_array_list":
            self.world.watch = self._film

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode; see the class's Start."""
        super().reset(seed=seed)
        self.world.rng = self.np_random
        place = dict(options or {})
        if place:
            if place.keys() != {"orientation"}:
                raise ValueError(f"options must hold orientation alone, got {options!r}")
            orientation = _checks.number("orientation", place["orientation"], -0.5, 0.5)
        else:
            u = self.np_random.uniform(-1.0, 1.0)
            off = self.start.least + (self.start.most - self.start.least) * abs(u)
            orientation = math.copysign(off, u)
        self.supervisor.place(self.world, orientation)
        self.ball_trail, self._turns = [], 0
        self._frames, self._next_frame = [], 0.0
        return self._observe(), self._info(False)

    def step(self, action: int) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Turn, or kick and see where the ball comes to rest."""
        if action not in (TURN_LEFT, TURN_RIGHT, KICK):
            raise ValueError(f"action must be 0, 1 or 2, got {action!r}")
        if action == KICK:
            self.supervisor.set_ball(self.world)
            self.ball_trail = motion.kick(self.world)
            verdict = self.supervisor.judge(self.world)
            observation = self._observe()
            return observation, verdict.reward, True, False, self._info(verdict.is_success)
        motion.turn(self.world, TURN if action == TURN_LEFT else -TURN)
        self._turns += 1
        over = self._turns >= self.patience
        return self._observe(), MISS_REWARD if over else 0.0, over, False, self._info(False)

    def render(self) -> np.ndarray | list[np.ndarray] | None:  # type: ignore[override]
        """Draw the field from above, with the ball's way after a kick."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() draws only with render_mode='rgb_array'")
            return None
        if self.render_mode == "rgb_array":
            return self._picture()
        self._frames.append(self._picture())
        frames, self._frames = self._frames, []
        return frames

    def _picture(self) -> np.ndarray:
        return bird_view(self.world, ball_trail=self.ball_trail)

    def _film(self) -> None:
        """Keep a picture of the kick, `render_fps` of them a second."""
        if self.world.time >= self._next_frame:
            self._frames.append(self._picture())
            self._next_frame = self.world.time + 1 / self.metadata["render_fps"]

    def _observe(self) -> np.ndarray:
        """Look; if the picture cuts the goal, turn the head to it and look again."""
        seen = self.camera.goal(self.world)
        if seen is not None and not seen.whole:
            motion.look(self.world, seen.orientation)
            seen = self.camera.goal(self.world) or seen
        if seen is None:
            return np.zeros(2, dtype=np.float32)
        orientation = max(-_MOST_ORIENTATION, min(_MOST_ORIENTATION, seen.orientation))
        return np.array([orientation, 1.0], dtype=np.float32)

    def _info(self, is_success: bool) -> dict[str, Any]:
        orientation, _ = self.world.goal_from_robot()
        return {"orientation": orientation, "is_success": is_success, "time": self.world.time}
