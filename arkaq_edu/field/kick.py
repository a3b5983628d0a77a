"""The kick: a paw swings at the ball, and where it meets the ball decides where the ball goes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pymunk

from arkaq_edu import _checks
from arkaq_edu.field import pitch

# Where the ball should lie before a kick (mm): ahead and to the left of the point that the robot
# turns about. It is a little to the right, because the real robot's kicks go a little to the right.
MARK = (245.0, -1.9)
PAW_RADIUS = 30.0
# The paw speeds up in proportion to the distance it has traveled, as a falling stick does: speed =
# PAW_RATE * distance. It meets a ball on the mark after PAW_TRAVEL.
PAW_TRAVEL = 54.0  # mm
PAW_RATE = 14.7  # 1/s
_PAW_START = 12.0  # mm into the swing; before that the paw is slow and meets no ball
# How far they move in one step (mm). A ball that moves this far passes through nothing.
_PAW_STRIDE, _BALL_STRIDE = 2.0, 30.0
_LONGEST_STEP = 1 / 20  # s
_STEPS_A_LOOK = 3  # steps between two checks of the ball's speed
_RESTING = 1.0  # mm/s; a slower ball is at rest

Path = list[tuple[float, float]]


@dataclass(frozen=True)
class Kick:
    """How much kicks differ from each other.

    Parameters
    ----------
    spread : float
        Standard deviation of the ball's place before the kick (mm), in [0, 12], along both axes.
        Grabbing depends on the jaw and on friction and is not modeled. Instead the supervisor
        places the ball as precisely as the robot would (thesis 5.1.3.3).
    swerve : float
        The largest sideways acceleration of a rolling ball (mm/s^2), in [0, 200]. Each kick draws
        its own, uniform in [-swerve, swerve]. On a carpet a ball does not roll quite straight,
        and curves more as it slows down.

    Notes
    -----
    The defaults, with `MARK`, `PAW_TRAVEL` and `PAW_RATE`, are calibrated on 50 kicks of a real
    robot (``data/kicks.csv``). With both at zero every kick is the same.

    References
    ----------
    M. Hausknecht, AIBO kick work log, UT Austin.
    """

    spread: float = 9.0
    swerve: float = 140.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "spread", _checks.number("spread", self.spread, 0, 12))
        object.__setattr__(self, "swerve", _checks.number("swerve", self.swerve, 0, 200))


def build_paw(pose: tuple[float, float, float]) -> pymunk.Body:
    """Return the paw, drawn back; it passes through the robot's own body."""
    paw = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shape = pymunk.Circle(paw, PAW_RADIUS)
    shape.elasticity, shape.friction = 0.5, 0.0
    shape.filter = pymunk.ShapeFilter(group=pitch.ROBOT_GROUP)
    x, y, heading = pose
    ahead = MARK[0] - pitch.BALL_RADIUS - PAW_RADIUS - PAW_TRAVEL + _PAW_START
    paw.position = x + ahead * math.cos(heading), y + ahead * math.sin(heading)
    paw.angle = heading
    return paw


def swing_paw(paw: pymunk.Body, ball: pymunk.Body, step: Callable[[float], None]) -> None:
    """Swing the paw until the ball moves or the paw has passed it.

    Paw and ball are round, so the ball leaves along the line through their centers. A ball that
    lies farther ahead is hit by a faster paw.

    Parameters
    ----------
    paw, ball : pymunk.Body
        In the same space.
    step : callable
        Steps that space by a time (s).
    """
    forward, traveled = paw.rotation_vector, _PAW_START
    while traveled < 2 * PAW_TRAVEL and ball.velocity.length < _RESTING:
        speed = PAW_RATE * traveled
        paw.velocity = forward * speed
        step(_PAW_STRIDE / speed)
        traveled += _PAW_STRIDE


def roll_out(ball: pymunk.Body, acceleration: float, step: Callable[[float], None]) -> Path:
    """Let the ball roll until it rests, and return its path (mm).

    Parameters
    ----------
    ball : pymunk.Body
        In a space.
    acceleration : float
        Sideways acceleration (mm/s^2), to the left of the ball's first direction.
    step : callable
        Steps that space by a time (s).
    """
    force = ball.velocity.normalized().perpendicular() * (acceleration * ball.mass)
    path: Path = [(ball.position.x, ball.position.y)]
    speed, bumped = ball.velocity.length, False
    while speed > _RESTING:
        # pymunk starts each contact with the impulse of the last step, scaled by the step's
        # length. A longer step right after a bump would push the ball twice.
        if not bumped:
            dt = min(_LONGEST_STEP, _BALL_STRIDE / speed)
        for _ in range(_STEPS_A_LOOK):
            ball.force = force
            step(dt)
        path.append((ball.position.x, ball.position.y))
        before, speed = speed, ball.velocity.length
        bumped = before - speed > 2 * _STEPS_A_LOOK * dt * pitch.BALL_DECELERATION
    ball.velocity = 0.0, 0.0
    return path
