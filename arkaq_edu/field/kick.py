"""The kick: a paw swings at the ball, and where the ball lies against it decides where it goes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pymunk

from arkaq_edu import _checks
from arkaq_edu.field import pitch

# Where the ball should lie before a kick, from the point the robot turns about (mm): ahead, and a
# little to the right of the paw's line, for the real robot's kicks go a little to the right.
MARK = (245.0, -1.9)
PAW_RADIUS = 30.0
# The paw speeds up in proportion to the way it has made, as anything does that topples: after
# `SWING` mm, where it meets a ball on the mark, its speed is SWING * QUICKENING mm/s.
SWING = 54.0
QUICKENING = 14.7
_AWAKE = 12.0  # mm into the swing; with less speed than here no ball is met
# How far they get in one step (mm): the paw, and a rolling ball, which then passes through nothing.
_PAW_STRIDE, _BALL_STRIDE = 2.0, 30.0
_LONGEST_STEP = 1 / 20
_STEPS_A_LOOK = 3  # steps between two looks at how fast the ball still is
_RESTING = 1.0  # mm/s


@dataclass(frozen=True)
class Kick:
    """How far a kick is from being the same every time.

    Parameters
    ----------
    spread : float
        Standard deviation of where the ball lies before the kick (mm), ahead and across alike, in
        [0, 12]. Grabbing depends on the jaw and on friction and is not modeled; the supervisor
        sets the ball, as well as the robot would (thesis 5.1.3.3).
    swerve : float
        The strongest sideways pull on a rolling ball (mm/s^2), in [0, 200]; drawn once a kick,
        uniform in [-swerve, swerve]. On a carpet a ball does not run quite straight, and hooks as
        it gets slow.

    Notes
    -----
    The defaults, with `MARK`, `SWING` and `QUICKENING`, are calibrated on 50 kicks of a real
    robot (``data/kicks.csv``). With both zero every kick is the same.

    References
    ----------
    M. Hausknecht, AIBO kick work log, UT Austin.
    """

    spread: float = 9.0
    swerve: float = 140.0

    def __post_init__(self) -> None:
        _checks.number("spread", self.spread, 0, 12)
        _checks.number("swerve", self.swerve, 0, 200)


def build_paw(pose: tuple[float, float, float]) -> pymunk.Body:
    """Return the paw, drawn back; it passes through the robot's own body."""
    paw = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shape = pymunk.Circle(paw, PAW_RADIUS)
    shape.elasticity, shape.friction = 0.5, 0.0
    shape.filter = pymunk.ShapeFilter(group=pitch.ROBOT_GROUP)
    x, y, heading = pose
    ahead = MARK[0] - pitch.BALL_RADIUS - PAW_RADIUS - SWING + _AWAKE
    paw.position = x + ahead * math.cos(heading), y + ahead * math.sin(heading)
    paw.angle = heading
    return paw


def swing(paw: pymunk.Body, ball: pymunk.Body, step: Callable[[float], None]) -> None:
    """Swing the paw until the ball is on its way or the paw has passed.

    A round paw meets a round ball, so the ball leaves along the line through their middles: one
    that lies aside goes aside. One that lies farther ahead is met by a faster paw.

    Parameters
    ----------
    paw, ball : pymunk.Body
        In a space.
    step : callable
        Steps that space by a time (s).
    """
    forward, way = paw.rotation_vector, _AWAKE
    while way < 2 * SWING and ball.velocity.length < _RESTING:
        speed = QUICKENING * way
        paw.velocity = forward * speed
        step(_PAW_STRIDE / speed)
        way += _PAW_STRIDE


def roll(ball: pymunk.Body, pull: float, step: Callable[[float], None]) -> list[tuple]:
    """Let the ball roll until it rests, and return where it was on the way (mm).

    Parameters
    ----------
    ball : pymunk.Body
        In a space.
    pull : float
        Sideways acceleration (mm/s^2), to the left of where the ball goes at first.
    step : callable
        Steps that space by a time (s).
    """
    aside = ball.velocity.normalized().perpendicular() * (pull * ball.mass)
    trail = [tuple(ball.position)]
    speed, bumped = ball.velocity.length, False
    while speed > _RESTING:
        # pymunk starts on a contact with the last step's push, scaled up if the step is longer:
        # so no longer step right after a bump.
        if not bumped:
            dt = min(_LONGEST_STEP, _BALL_STRIDE / speed)
        for _ in range(_STEPS_A_LOOK):
            ball.force = aside
            step(dt)
        trail.append(tuple(ball.position))
        before, speed = speed, ball.velocity.length
        bumped = before - speed > 2 * _STEPS_A_LOOK * dt * pitch.BALL_DECELERATION
    ball.velocity = 0.0, 0.0
    return trail
