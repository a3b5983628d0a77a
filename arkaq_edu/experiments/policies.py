"""What plays an episode of either problem."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq

#: Chooses an action from the observation and the info, which holds the true state.
Choice = Callable[[NDArray[np.floating], dict[str, Any]], int]
#: Starts the episode of a number and returns how actions are chosen in it.
Policy = Callable[[int], Choice]

_N_ACTIONS = 3  # of either task


def greedy(agent: Arkaq) -> Policy:
    """Return the greedy policy of an agent. It can be pickled, so it travels to other processes.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> choose = greedy(approach.load_agent())(0)
    >>> choose(np.array([1000.0, 0.3, 1.0]), {})  # the ball is to the left
    1
    """
    return partial(_begin_greedy, agent)


def _begin_greedy(agent: Arkaq, episode: int) -> Choice:
    agent.reset()
    return partial(_act, agent)


def _act(agent: Arkaq, observation: NDArray[np.floating], info: dict[str, Any]) -> int:
    return agent.act(observation)


def at_random(seed: int = 0) -> Policy:
    """Return the policy that draws its actions at random. It can be pickled.

    Examples
    --------
    >>> choose = at_random(seed=1)(0)
    >>> choose(np.zeros(3), {}) in (0, 1, 2)
    True
    """
    return partial(_begin_at_random, _checks.integer("seed", seed))


def _begin_at_random(seed: int, episode: int) -> Choice:
    return partial(_draw, np.random.default_rng([seed, episode]))


def _draw(rng: np.random.Generator, observation: NDArray[np.floating], info: dict[str, Any]) -> int:
    return int(rng.integers(_N_ACTIONS))


def always(choose: Choice) -> Policy:
    """Return the policy that chooses in every episode alike. It can be pickled if `choose` can.

    Examples
    --------
    >>> always(max)(3) is max
    True
    """
    return partial(_same, choose)


def _same(choose: Choice, episode: int) -> Choice:
    return choose
