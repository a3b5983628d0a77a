"""What plays an episode of either problem."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.arkaq import Arkaq

#: Chooses an action from the observation and the info, which holds the true state.
Choice = Callable[[NDArray[np.floating], dict[str, Any]], int]
#: Starts the episode of a number and returns how actions are chosen in it.
Policy = Callable[[int], Choice]

_N_ACTIONS = 3  # of either task


def greedy(agent: Arkaq) -> Policy:
    """Return the greedy policy of an agent.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> choose = greedy(approach.load_agent())(0)
    >>> choose(np.array([1000.0, 0.3, 1.0]), {})  # the ball is to the left
    1
    """

    def begin(episode: int) -> Choice:
        agent.reset()
        return lambda observation, info: agent.act(observation)

    return begin


def at_random(seed: int = 0) -> Policy:
    """Return the policy that draws its actions at random.

    Examples
    --------
    >>> choose = at_random(seed=1)(0)
    >>> choose(np.zeros(3), {}) in (0, 1, 2)
    True
    """

    def begin(episode: int) -> Choice:
        rng = np.random.default_rng([seed, episode])
        return lambda observation, info: int(rng.integers(_N_ACTIONS))

    return begin
