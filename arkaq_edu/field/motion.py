"""The motion engine: gaits, made of footsteps.

The left and the right legs take footsteps of their own length. All that a robot does on the
ground is two numbers a cycle, and these functions say which; a way too long for one cycle takes
several equal ones.
"""

from __future__ import annotations

import math

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.world import LONGEST_FOOTSTEP, World

# What the normal gait turns in a cycle: 131 degrees a second.
MOST_TURN = math.radians(84)


def footsteps(ahead: float, turn: float) -> tuple[float, float]:
    """Return the left and right footstep (mm) that go `ahead` (mm) and `turn` (rad, left).

    Examples
    --------
    >>> footsteps(100.0, 0.1)
    (91.0, 109.0)
    >>> footsteps(0.0, -0.2)  # opposite footsteps turn on the spot
    (18.0, -18.0)
    """
    half = turn * pitch.ROBOT_WIDTH / 2
    return ahead - half, ahead + half


def walk(world: World, distance: float) -> None:
    """Walk straight ahead (mm), or back where `distance` is negative."""
    arc(world, distance, 0.0)


def turn(world: World, angle: float) -> None:
    """Turn on the spot (rad, to the left)."""
    arc(world, 0.0, angle)


def arc(world: World, distance: float, angle: float) -> None:
    """Walk along an arc of a length (mm) that turns by an angle (rad, to the left).

    Parameters
    ----------
    world : World
        The field; whole cycles pass in it, at least one.
    distance, angle : float
        The way, along the arc, and the turn.

    Raises
    ------
    ValueError
        If either is not finite.

    Examples
    --------
    >>> from arkaq_edu.field import Legs
    >>> world = World(rng=0, legs=Legs(slide=0.0, pull=0.0, variation=0.0))
    >>> world.reset(robot=(0.0, 0.0, 0.0), ball=(-2000.0, 0.0))
    >>> arc(world, math.pi / 2 * 600.0, math.pi / 2)  # a quarter of a circle, radius 600 mm
    >>> x, y, heading = world.pose
    >>> round(x, -1), round(y, -1), round(heading, 1), round(world.time, 2)
    (600.0, 600.0, 1.6, 3.84)
    """
    _checks.number("distance", distance)
    _checks.number("angle", angle)
    left, right = footsteps(distance, angle)
    longest = max(abs(left), abs(right)) / LONGEST_FOOTSTEP
    cycles = max(1, math.ceil(max(longest, abs(angle) / MOST_TURN) - 1e-9))
    for _ in range(cycles):
        world.cycle(left / cycles, right / cycles)


def stop(world: World) -> None:
    """Stand for one cycle."""
    world.cycle(0.0, 0.0)


def look(world: World, pan: float) -> None:
    """Pan the head (rad, to the left) and wait until pictures are good."""
    world.look(pan)
    if world.head.blurs:
        world.stand(world.unsettled)


def kick(world: World) -> list[tuple[float, float]]:
    """Kick with the paw and return the ball's way (mm) until it rests.

    Examples
    --------
    >>> from arkaq_edu.field.kick import MARK
    >>> world = World(rng=0)
    >>> world.reset(robot=(0.0, 0.0, 0.0), ball=MARK)
    >>> way = kick(world)
    >>> way[0] == MARK, way[-1] == world.ball, 1800 < world.ball[0] < 2800
    (True, True, True)
    """
    return world.swing_paw()
