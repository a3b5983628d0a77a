"""Policies that aim and kick."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.arkaq import Sensing
from arkaq_edu.envs.score_goal import KICK, TURN_LEFT, TURN_RIGHT
from arkaq_edu.experiments.policies import Policy, always
from arkaq_edu.experiments.policies import at_random as at_random
from arkaq_edu.experiments.policies import greedy as greedy


def planner() -> Policy:
    """Return a policy that sees the true orientation and turns as long as that brings it closer.

    It knows the size of a turn, and nothing about kicks. The study calls it "oracle".

    Examples
    --------
    >>> choose = planner()(0)
    >>> choose(np.zeros(2), {"orientation": 0.3}), choose(np.zeros(2), {"orientation": 0.01})
    (0, 2)
    """
    return always(partial(_aim, float(Sensing.goal().B[0][TURN_RIGHT])))


def _aim(turn: float, observation: NDArray[np.floating], info: dict[str, Any]) -> int:
    orientation = info["orientation"]
    if abs(orientation) <= turn / 2:
        return KICK
    return TURN_LEFT if orientation > 0 else TURN_RIGHT
