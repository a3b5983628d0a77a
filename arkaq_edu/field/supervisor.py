"""The supervisor of the first problem: it places robot and ball, and judges the approach."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from arkaq_edu import _checks
from arkaq_edu.field.camera import FIELD_OF_VIEW
from arkaq_edu.field.world import World

# From this pose, looking up the field, everything that the camera can see lies on the carpet.
ROBOT_START = (-2500.0, 0.0, 0.0)
MIN_BALL_DISTANCE, MAX_BALL_DISTANCE = 200.0, 4100.0
CLOSE_ENOUGH, STRAIGHT_ENOUGH = 500.0, 0.05
CLOSE_REWARD, STRAIGHT_REWARD = 100.0, 50.0

Placement = Literal["area", "thesis"]


class Verdict(NamedTuple):
    """The reward, and whether the task is done."""

    reward: float
    is_success: bool


def random_place(
    rng: np.random.Generator | int | None,
    near: float = MIN_BALL_DISTANCE,
    far: float = MAX_BALL_DISTANCE,
    placement: Placement = "area",
) -> tuple[float, float]:
    """Draw a random place for the ball inside the robot's field of view.

    Parameters
    ----------
    rng : numpy.random.Generator or int, optional
        The random numbers, or their seed.
    near, far : float
        The nearest and farthest distance (mm), in [0, 4100]. With the placement "thesis", they
        are at least 1 mm apart.
    placement : {"area", "thesis"}
        "thesis": eq 5.1, a uniform depth z, then a uniform x across the view triangle at that
        depth. The density of balls on the field falls as 1 / z. "area": uniform on the field, so
        the distance is the square root of a uniform number. Both stay within [near, far].

    Returns
    -------
    distance, orientation : float
        In mm and rad.

    Raises
    ------
    ValueError
        If an argument is out of range or unknown.

    References
    ----------
    Thesis 5.2.1, eq 5.1, figures 5.7 and 5.8.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> distance, orientation = random_place(rng, near=600.0)
    >>> 600 <= distance <= 4100, abs(orientation) <= 0.4965
    (True, True)
    """
    rng = _checks.generator("rng", rng)
    near, far = _interval(near, far, placement, 0.0)
    half = FIELD_OF_VIEW / 2
    if placement == "area":
        distance = math.sqrt(rng.uniform(near**2, far**2))
        return distance, rng.uniform(-half, half)
    while True:  # until the place lies within [near, far]
        z = rng.uniform(0.0, far)
        x = z * math.tan(half) * rng.uniform(0.0, 1.0) * (-1.0, 1.0)[rng.integers(2)]
        distance = math.hypot(z, x)
        if near <= distance <= far:
            return distance, math.atan2(x, z)


def _interval(near: float, far: float, placement: Placement, least: float) -> tuple[float, float]:
    """Return `near` and `far` as numbers between which a ball can be placed."""
    _checks.choice("placement", placement, ("area", "thesis"))
    near = _checks.number("near", near, least, MAX_BALL_DISTANCE)
    # "thesis" draws places until one lies between the two, so it needs some room there.
    room = 1.0 if placement == "thesis" else 0.0
    return near, _checks.number("far", far, near + room, MAX_BALL_DISTANCE)


class Supervisor:
    """Places the ball for an approach, and rewards it.

    Parameters
    ----------
    near, far : float
        The least and greatest distance of the ball from the robot (mm), in [200, 4100].
    placement : {"area", "thesis"}
        See `random_place`.

    References
    ----------
    Thesis 5.2.1 and 5.2.2.

    Examples
    --------
    >>> world, supervisor = World(rng=0), Supervisor(near=1000.0)
    >>> supervisor.reset(world, np.random.default_rng(0))
    >>> supervisor.judge(world)
    Verdict(reward=0.0, is_success=False)
    """

    def __init__(
        self, near: float = 600.0, far: float = MAX_BALL_DISTANCE, placement: Placement = "area"
    ) -> None:
        self.near, self.far = _interval(near, far, placement, MIN_BALL_DISTANCE)
        self.placement = placement

    def reset(self, world: World, rng: np.random.Generator) -> None:
        """Put the robot at its start and the ball at a random place that it can see."""
        distance, orientation = random_place(rng, self.near, self.far, self.placement)
        self.place(world, distance, orientation)

    def place(self, world: World, distance: float, orientation: float) -> None:
        """Put the robot at its start and the ball at a distance (mm) and orientation (rad)."""
        distance = _checks.number("distance", distance)
        x, y, heading = ROBOT_START
        angle = heading + _checks.number("orientation", orientation)
        ball = x + distance * math.cos(angle), y + distance * math.sin(angle)
        world.reset(ROBOT_START, ball)

    def judge(self, world: World) -> Verdict:
        """Return the immediate reward: 100 within 500 mm of the ball, 50 more within .05 rad."""
        distance, orientation = world.ball_from_robot()
        if distance >= CLOSE_ENOUGH:
            return Verdict(0.0, False)
        straight = abs(orientation) <= STRAIGHT_ENOUGH
        return Verdict(CLOSE_REWARD + STRAIGHT_REWARD * straight, True)
