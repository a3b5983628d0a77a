"""One look after the other through every stage of the agent: from the camera to an action."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.arkaq import Arkaq, Estimator
from arkaq_edu.experiments.approach.evaluation import Trajectory


class Stage(NamedTuple):
    """What became of one look.

    Attributes
    ----------
    seen : ndarray, shape (2,)
        The sighting: distance (mm) and orientation (rad); NaN if the ball was not seen.
    expected : ndarray, shape (2,)
        What the filter expected, after the last action and before the look.
    gain : ndarray, shape (2,)
        The share of the surprise in distance and in orientation that was believed.
    estimate, sigma : ndarray, shape (2,)
        The filter's estimate after the look, and its standard deviations.
    pattern : ndarray, shape (2,)
        The estimate scaled to [-1, 1].
    state : int
        The category of the pattern.
    center : ndarray, shape (2,)
        The center of that category, in mm and rad.
    values : ndarray, shape (3,)
        The row of Q of that state.
    action : int
        The greedy action in it.
    """

    seen: NDArray[np.float64]
    expected: NDArray[np.float64]
    gain: NDArray[np.float64]
    estimate: NDArray[np.float64]
    sigma: NDArray[np.float64]
    pattern: NDArray[np.float64]
    state: int
    center: NDArray[np.float64]
    values: NDArray[np.float64]
    action: int


def stages(walk: Trajectory, agent: Arkaq) -> list[Stage]:
    """Follow the looks of a recorded walk through an agent.

    Parameters
    ----------
    walk : Trajectory
        The walk. Its actions were taken, whatever `agent` would do now.
    agent : Arkaq
        An agent that has learned.

    Returns
    -------
    list of Stage
        One for each look.

    References
    ----------
    Thesis, chapter 3 and figures 3.1 and 3.2.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> first = stages(approach.trajectory(1), approach.load_agent())[0]
    >>> first.pattern.shape, first.values.shape
    ((2,), (3,))
    """
    senses = Estimator(agent.sensing)
    centers: Any = agent.sensing.unscale(agent.art.cluster_centers_)
    sightings = walk.table[["seen_distance", "seen_orientation"]].to_numpy()
    led_here = [None, *walk.table.action[:-1]]
    found = []
    for seen, action in zip(sightings, led_here, strict=True):
        visible = not np.isnan(seen).any()
        pattern = senses.observe(np.append(np.nan_to_num(seen), visible), action)
        x, K = senses.kalman.x[:2], senses.kalman.K[:2]
        expected = x - K @ senses.kalman.innovation if visible else x
        state = agent.art.category(pattern)
        values = agent.q.Q[state]  # type: ignore[union-attr]
        found.append(
            Stage(
                seen, expected, np.diag(K) * visible, x.copy(),
                np.sqrt(np.diag(senses.kalman.P)[:2]), pattern, state, centers[state], values,
                int(values.argmax()),
            )
        )  # fmt: skip
    return found
