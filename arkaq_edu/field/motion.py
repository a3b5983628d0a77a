"""The motion engine (thesis 5.1.2.2): every gait is made of footsteps.

A robot on the ground does nothing but choose two numbers each cycle: the lengths of the left and
the right footstep. These functions compute them. A distance too long for one cycle takes several
equal ones.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.supervisor import ROBOT_START
from arkaq_edu.field.world import LONGEST_FOOTSTEP, World

# The normal gait turns this much in a cycle: 131 degrees a second.
LARGEST_TURN = math.radians(84)
# Longer walks are typing errors: on the carpet the robot would only push against a wall.
LONGEST_WALK, MOST_TURNS, MOST_CYCLES = 100_000.0, 100, 10_000


def footsteps(ahead: float, turn: float) -> tuple[float, float]:
    """Return the left and right footstep (mm) that go `ahead` (mm) and `turn` (rad, left).

    Examples
    --------
    >>> footsteps(100.0, 0.1)
    (91.0, 109.0)
    >>> footsteps(0.0, -0.2)  # opposite footsteps turn on the spot
    (18.0, -18.0)
    """
    ahead, turn = _checks.number("ahead", ahead), _checks.number("turn", turn)
    half = turn * pitch.ROBOT_WIDTH / 2
    return ahead - half, ahead + half


def gait(left: float, right: float) -> tuple[float, float]:
    """Return how far ahead (mm) and how much to the left (rad) a pair of footsteps (mm) goes.

    Examples
    --------
    >>> gait(91.0, 109.0)
    (100.0, 0.1)
    """
    left, right = _checks.number("left", left), _checks.number("right", right)
    return (left + right) / 2, (right - left) / pitch.ROBOT_WIDTH


def arc_path(
    pose: tuple[float, float, float], left: float, right: float, cycles: int
) -> NDArray[np.float64]:
    """Return the path of equal cycles on perfect legs: an arc, or a straight line.

    Parameters
    ----------
    pose : tuple of float
        x, y (mm) and heading (rad) at the start.
    left, right : float
        Footsteps of each cycle (mm).
    cycles : int
        Number of cycles, in [0, 10000].

    Returns
    -------
    ndarray, shape (8 * cycles + 1, 2)
        x, y (mm), eight points for each cycle.

    Examples
    --------
    >>> arc_path((0.0, 0.0, 0.0), 100.0, 100.0, 2)[-1]
    array([200.,   0.])
    """
    x, y, heading = _checks.array("pose", pose, (3,)).tolist()
    cycles = _checks.integer("cycles", cycles, 0, MOST_CYCLES)
    share = np.linspace(0.0, cycles, 8 * cycles + 1)
    ahead, turn = gait(left, right)
    # A chord over an angle a is sin(a / 2) / (a / 2) times as long as its arc.
    chord = share * ahead * np.sinc(share * turn / 2 / math.pi)
    angle = heading + share * turn / 2
    return np.column_stack([x + chord * np.cos(angle), y + chord * np.sin(angle)])


def walk(world: World, distance: float) -> None:
    """Walk straight ahead (mm), or back if `distance` is negative."""
    arc(world, distance, 0.0)


def turn(world: World, angle: float) -> None:
    """Turn on the spot (rad, to the left)."""
    arc(world, 0.0, angle)


def arc(world: World, distance: float, angle: float) -> None:
    """Walk along an arc.

    Parameters
    ----------
    world : World
        The field. At least one whole cycle passes in it.
    distance : float
        Length of the arc (mm), in [-100000, 100000]: 100 m.
    angle : float
        The turn over the whole arc (rad, to the left), at most 100 full turns.

    Raises
    ------
    ValueError
        If either is out of range.

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
    distance = _checks.number("distance", distance, -LONGEST_WALK, LONGEST_WALK)
    angle = _checks.number("angle", angle, -2 * math.pi * MOST_TURNS, 2 * math.pi * MOST_TURNS)
    left, right = footsteps(distance, angle)
    longest = max(abs(left), abs(right)) / LONGEST_FOOTSTEP
    cycles = max(1, math.ceil(max(longest, abs(angle) / LARGEST_TURN) - 1e-9))
    for _ in range(cycles):
        world.cycle(left / cycles, right / cycles)


def stop(world: World) -> None:
    """Stand for one cycle."""
    world.cycle(0.0, 0.0)


def footstep_path(world: World, left: float, right: float, cycles: int) -> NDArray[np.float64]:
    """Take equal footsteps (mm), and return the poses before the first and after each cycle.

    Returns
    -------
    ndarray, shape (cycles + 1, 3)
        x, y (mm) and heading (rad).

    Examples
    --------
    >>> footstep_path(World(rng=0), 100.0, 100.0, cycles=2).shape
    (3, 3)
    """
    poses = [world.pose]
    for _ in range(_checks.integer("cycles", cycles, 1, MOST_CYCLES)):
        world.cycle(left, right)
        poses.append(world.pose)
    return np.array(poses)


def straight_walk(world: World, cycles: int = 20) -> NDArray[np.float64]:
    """Take equal footsteps of 100 mm up the field, and return the poses relative to the start.

    Parameters
    ----------
    world : World
        It is reset first.
    cycles : int
        Number of footstep cycles, in [1, 10000].

    Returns
    -------
    ndarray, shape (cycles + 1, 3)
        x, y (mm) and heading (rad) before the first and after each cycle.

    References
    ----------
    Thesis 5.1.3.1, figure 5.5.

    Examples
    --------
    >>> x, y, heading = straight_walk(World(rng=0), cycles=10)[-1]
    >>> bool(y > 0 > heading)  # drifts to the left, turns to the right
    True
    """
    cycles = _checks.integer("cycles", cycles, 1, MOST_CYCLES)
    world.reset(ROBOT_START, (0.0, 1500.0))  # the ball is out of the way
    return footstep_path(world, 100.0, 100.0, cycles) - ROBOT_START


def look(world: World, pan: float) -> None:
    """Pan the head (rad, to the left) and wait until pictures are sharp."""
    world.look(pan)
    if world.head.blurs:
        world.stand(world.unsettled)


def kick(world: World) -> list[tuple[float, float]]:
    """Kick with the paw and return the ball's path (mm) until it rests.

    Examples
    --------
    >>> from arkaq_edu.field.kick import MARK
    >>> world = World(rng=0)
    >>> world.reset(robot=(0.0, 0.0, 0.0), ball=MARK)
    >>> path = kick(world)
    >>> path[0] == MARK, path[-1] == world.ball, 1800 < world.ball[0] < 2800
    (True, True, True)
    """
    return world.swing_paw()
