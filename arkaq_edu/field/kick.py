"""The kick: a paw swings at the ball, and where it meets the ball decides where the ball goes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pymunk

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.arcs import RESTING, Motion

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


def swing_paw(
    paw: pymunk.Body,
    ball: pymunk.Body,
    step: Callable[[float], None],
    move: Callable[[float, float, float], None],
) -> None:
    """Swing the paw until the ball moves or the paw has passed it.

    Paw and ball are round, so the ball leaves along the line through their centers. A ball that
    lies farther ahead is hit by a faster paw.

    Parameters
    ----------
    paw, ball : pymunk.Body
        In the same space.
    step : callable
        Steps that space by a time (s).
    move : callable
        Moves the paw, which meets nothing on the way, to x and y (mm) in a time (s).
    """
    (x, y), forward, traveled = paw.position, paw.rotation_vector, _PAW_START
    gap = paw.position.get_distance(ball.position) - PAW_RADIUS - pitch.BALL_RADIUS
    while traveled < min(2 * PAW_TRAVEL, _PAW_START + gap - 2 * _PAW_STRIDE):
        x, y = x + forward.x * _PAW_STRIDE, y + forward.y * _PAW_STRIDE
        move(x, y, _PAW_STRIDE / (PAW_RATE * traveled))
        traveled += _PAW_STRIDE
    paw.position = x, y
    while traveled < 2 * PAW_TRAVEL and ball.velocity.length < RESTING:
        speed = PAW_RATE * traveled
        paw.velocity = forward * speed
        step(_PAW_STRIDE / speed)
        traveled += _PAW_STRIDE


def roll_out(
    ball: Motion,
    acceleration: float,
    roll: Callable[[Motion, complex, float], tuple[Motion, list[complex]]],
) -> tuple[Motion, Path]:
    """Let the ball roll until it rests; return its motion then, and its path (mm).

    Parameters
    ----------
    ball : Motion
        The ball when it leaves the paw.
    acceleration : float
        Sideways acceleration (mm/s^2), to the left of the ball's first direction.
    roll : callable
        Lets the ball roll for a while under a push (mm/s^2), in steps of a time (s); returns its
        motion and the places that it has passed.
    """
    path, speed = [ball.place], abs(ball.velocity)
    if speed > RESTING:
        push = 1j * acceleration * ball.velocity / speed
        # One length for all steps: pymunk starts each with the impulses of the last, scaled by
        # its length, so that a longer one would push the ball too much.
        dt = min(_LONGEST_STEP, _BALL_STRIDE / speed)
    while abs(ball.velocity) > RESTING:
        ball, places = roll(ball, push, dt)
        path += places
    return ball._replace(velocity=0j), [(place.real, place.imag) for place in path]
