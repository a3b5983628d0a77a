"""What moves out of reach of all else moves in closed form: the body's arcs, the ball's way.

pymunk moves a body in small steps. In each step the body goes on at the velocity it has, and then
changes it toward the wanted one, by at most what friction allows. As long as it touches nothing,
that adds up to one formula, `follow`. A test compares it with the steps.

A place or a velocity in the plane is a complex number here, x + iy. Multiplied by e^(ia) it is
turned to the left by a.
"""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple

import numpy as np

from arkaq_edu._compiled import kernel
from arkaq_edu.field import pitch

CYCLE = 0.64  # s
SUBSTEPS = 80  # physics steps in a cycle
STEP = CYCLE / SUBSTEPS
# A curved footstep is walked as this many straight chords.
CHORDS = 8

# What friction allows. The paws push the body, and turn it, by their grip on the carpet.
GRIP = 9810.0  # mm/s^2
TWIST = GRIP * pitch.ROBOT_WIDTH / ((pitch.ROBOT_LENGTH**2 + pitch.ROBOT_WIDTH**2) / 12)  # rad/s^2
# The carpet slows the ball down, and its spin: that of a disc.
ROLL = pitch.BALL_DECELERATION  # mm/s^2
SPIN = pitch.BALL_DECELERATION * pitch.BALL_RADIUS / (pitch.BALL_RADIUS**2 / 2)  # rad/s^2

_ROBOT_REACH = math.hypot(pitch.ROBOT_LENGTH, pitch.ROBOT_WIDTH) / 2
_POST_Y = pitch.GOAL_WIDTH / 2 + pitch.POST_RADIUS
# The ball rolls this many steps from one look at its speed to the next.
LOOK = 3
RESTING = 1.0  # mm/s; a slower ball is at rest
_LONGEST_WAY = 300  # looks


class Motion(NamedTuple):
    """Where a body is (mm, rad) and how it moves (mm/s, rad/s)."""

    place: complex
    angle: float
    velocity: complex
    spin: float


@kernel
def follow(v, u, a, n):
    """Return how far a body goes in n steps, and its velocity then, if it wants the velocity u.

    Each step changes its velocity v by a dt, so that it lags behind for m steps::

        k = |u - v| / (a dt)
        m = min(n, ceil(k))
        x = dt (n u - (u - v) (m - m (m - 1) / (2 k)))

    Parameters
    ----------
    v, u : float or complex
        The velocity at first, and the wanted one.
    a : float
        The largest acceleration.
    n : int
        The number of steps of `STEP` seconds.

    Examples
    --------
    A ball at 500 mm/s that slows down by 250 mm/s^2 rolls 500 mm in 2 s, and a bit, because it
    moves before it slows down.

    >>> follow(500.0, 0.0, 250.0, 250)
    (502.0, 0.0)
    """
    gap = u - v
    k = abs(gap) / (a * STEP)
    if k == 0:
        return STEP * n * u, u
    m = min(n, math.ceil(k))
    x = STEP * (n * u - gap * (m - m * (m - 1) / 2 / k))
    return x, u if k <= n else v + n / k * gap


@kernel
def chord(velocity, angle, spin):
    """Return the velocity over the coming chord: it points along the chord's mean heading."""
    return velocity * cmath.rect(1.0, angle + spin * CYCLE / CHORDS / 2)


@kernel
def walk(body, velocity, spin):
    """Return the motion after a cycle along an arc.

    Parameters
    ----------
    body : Motion
        The motion before it.
    velocity : complex
        Ahead and to the left (mm/s), in the body's own frame.
    spin : float
        The turn (rad/s, to the left).

    Examples
    --------
    >>> walking = Motion(0j, 0.0, 100 + 0j, 0.0)
    >>> walk(walking, 100 + 0j, 0.0).place
    (64+0j)
    """
    x, angle, v, w = body
    for _ in range(CHORDS):
        moved, v = follow(v, chord(velocity, angle, spin), GRIP, SUBSTEPS // CHORDS)
        turned, w = follow(w, spin, TWIST, SUBSTEPS // CHORDS)
        x, angle = x + moved, angle + turned
    return Motion(x, angle, v, w)


@kernel
def roll(ball, n):
    """Return the motion of a ball after n steps: it rolls straight on, ever slower."""
    rolled, v = follow(ball.velocity, 0j, ROLL, n)
    turned, w = follow(ball.spin, 0.0, SPIN, n)
    return Motion(ball.place + rolled, ball.angle + turned, v, w)


@kernel
def is_clear(place, radius):
    """Return whether a disc on the carpet (mm) is clear of the walls, the posts and the panels.

    Examples
    --------
    >>> is_clear(2700 + 300j, 99.0), is_clear(2700 + 300j, 100.0)
    (True, False)
    """
    x, y = abs(place.real), abs(place.imag)
    if x + radius >= pitch.CARPET_LENGTH / 2 or y + radius >= pitch.CARPET_WIDTH / 2:
        return False
    # A panel runs from its post to the wall, so what lies behind the post lies beside the panel.
    return math.hypot(max(pitch.LENGTH / 2 - x, 0.0), y - _POST_Y) > radius + pitch.POST_RADIUS


@kernel
def out_of_reach(robot, ball, fastest, seconds):
    """Return whether robot and ball can touch nothing, and not each other, for some time.

    Each is taken for the disc that it could get out of only by being faster than it is.

    Parameters
    ----------
    robot, ball : Motion
        Their motion now.
    fastest : float
        The speed that the robot wants (mm/s).
    seconds : float
        The time.

    Examples
    --------
    >>> robot, ball = Motion(0j, 0.0, 0j, 0.0), Motion(350 + 0j, 0.0, 0j, 0.0)
    >>> out_of_reach(robot, ball, 190.0, 0.64), out_of_reach(robot, ball, 200.0, 0.64)
    (True, False)
    """
    reach = _ROBOT_REACH + seconds * max(fastest, abs(robot.velocity))
    room = pitch.BALL_RADIUS + seconds * abs(ball.velocity)
    return (
        abs(robot.place - ball.place) > reach + room
        and is_clear(robot.place, reach)
        and is_clear(ball.place, room)
    )


@kernel
def free_cycle(robot, ball, velocity, spin):
    """Return the motions of robot and ball after a cycle, and whether nothing was in reach.

    Both are plain tuples: it takes a kernel microseconds to read or to make a named one.
    """
    robot, ball = Motion(*robot), Motion(*ball)
    free = out_of_reach(robot, ball, abs(velocity), CYCLE)
    if free:
        robot, ball = walk(robot, velocity, spin), roll(ball, SUBSTEPS)
    x, angle, v, w = robot
    ball_x, ball_angle, ball_v, ball_w = ball
    return (x, angle, v, w), (ball_x, ball_angle, ball_v, ball_w), free


@kernel
def swerve(ball, push, dt):
    """Return the motion of a ball after one step of dt (s) under a push (mm/s^2)."""
    v = ball.velocity + push * dt
    v *= 1 - min(1.0, ROLL * dt / max(abs(v), 1e-9))
    w = ball.spin - math.copysign(min(SPIN * dt, abs(ball.spin)), ball.spin)
    return Motion(ball.place + ball.velocity * dt, ball.angle + ball.spin * dt, v, w)


@kernel
def coast(ball, push, dt, robot):
    """Let a ball roll under a push until it rests, or until something may be in its way.

    The push turns the velocity, so there is no closed form for many steps.

    Parameters
    ----------
    ball : tuple
        The motion of the ball; both motions are plain tuples, as for `free_cycle`.
    push : complex
        Its acceleration by the carpet (mm/s^2).
    dt : float
        The length of a step (s).
    robot : tuple
        The motion of a robot that stands.

    Returns
    -------
    ball : tuple
        The motion after it.
    places : ndarray of complex, shape (3 n,)
        Where the ball is after each step (mm).
    """
    ball, robot = Motion(*ball), Motion(*robot)
    places, n = np.empty(LOOK * _LONGEST_WAY, np.complex128), 0
    while (
        n < len(places)
        and abs(ball.velocity) > RESTING
        and out_of_reach(robot, ball, 0.0, LOOK * dt)
    ):
        for _ in range(LOOK):
            ball = swerve(ball, push, dt)
            places[n] = ball.place
            n += 1
    return (ball.place, ball.angle, ball.velocity, ball.spin), places[:n]
