"""The supervisor of the second problem: it places robot and ball, and judges the shot."""

from __future__ import annotations

import math

import numpy as np

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.kick import MARK
from arkaq_edu.field.supervisor import Verdict
from arkaq_edu.field.world import World

GOAL_REWARD, MISS_REWARD = 100.0, -100.0
MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE = 800.0, 5000.0
# Where the ball waits until the kick: on the touch line, out of the way.
_WAITING = -pitch.WIDTH / 2


class GoalSupervisor:
    """Places robot and ball for a shot at the sky-blue goal, and rewards it.

    Parameters
    ----------
    distance : float
        Distance of the robot from the goal (mm), in [800, 5000]. It stands on the line through
        the middle of the goal.

    References
    ----------
    Thesis 5.1.3.3 and 5.3.

    Examples
    --------
    >>> world, supervisor = World(rng=0), GoalSupervisor(distance=1500.0)
    >>> supervisor.place(world, 0.1)
    >>> supervisor.set_ball(world)
    >>> path = world.swing_paw()
    >>> supervisor.judge(world)
    Verdict(reward=100.0, is_success=True)
    """

    def __init__(self, distance: float) -> None:
        self.distance = _checks.number("distance", distance, MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE)

    def place(self, world: World, orientation: float) -> None:
        """Put the robot before the goal so that it sees the middle at an orientation (rad)."""
        orientation = _checks.number("orientation", orientation)
        x = pitch.LENGTH / 2 - self.distance
        world.reset((x, 0.0, -orientation), (x, _WAITING))

    @staticmethod
    def set_ball(world: World) -> None:
        """Put the ball before the paw: on the mark, give or take the spread of the kick."""
        x, y, heading = world.pose
        c, s = math.cos(heading), math.sin(heading)
        ahead, left = np.array(MARK) + world.kick.spread * world.rng.standard_normal(2)
        world.put_ball(x + ahead * c - left * s, y + ahead * s + left * c)

    def judge(self, world: World) -> Verdict:
        """Return 100 if the ball rests in the sky-blue goal, wholly over its line, else -100."""
        x, y = world.ball
        inside = x >= pitch.LENGTH / 2 + pitch.BALL_RADIUS and abs(y) < pitch.GOAL_WIDTH / 2
        return Verdict(GOAL_REWARD if inside else MISS_REWARD, inside)
