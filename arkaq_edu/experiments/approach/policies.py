"""Policies that walk to the ball."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.envs.ball_approach import FOOTSTEPS
from arkaq_edu.experiments.policies import Policy, always
from arkaq_edu.experiments.policies import at_random as at_random
from arkaq_edu.experiments.policies import greedy as greedy
from arkaq_edu.field import pitch


def planner() -> Policy:
    """Return a policy that sees the true state and takes the action that faces the ball best.

    It knows the gait without its drift and variation.

    Examples
    --------
    >>> choose = planner()(0)
    >>> choose(np.zeros(3), {"distance": 2000.0, "orientation": 0.4})  # the ball is to the left
    1
    """
    return always(_face_ball)


def _face_ball(observation: NDArray[np.floating], info: dict[str, Any]) -> int:
    x = info["distance"] * math.cos(info["orientation"])
    y = info["distance"] * math.sin(info["orientation"])

    def orientation_after(action: int) -> float:
        left, right = FOOTSTEPS[action]
        turn, ahead = (right - left) / pitch.ROBOT_WIDTH, (left + right) / 2
        pose = (ahead * math.cos(turn / 2), ahead * math.sin(turn / 2), turn)
        return abs(pitch.bearing(*pose, x, y)[1])

    return min(range(len(FOOTSTEPS)), key=orientation_after)
