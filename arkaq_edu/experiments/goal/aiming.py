"""What an agent with given states would do in the end, and how often it would score.

It needs neither physics nor training, so a slider can ask for it at every stop.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.envs.score_goal import KICK, STARTS, TURN_LEFT, TURN_RIGHT
from arkaq_edu.experiments.goal.kicks import chance
from arkaq_edu.experiments.goal.planning import (
    ORIENTATIONS,
    PATIENCE,
    best,
    follow,
    goal_probability,
    mean_over_starts,
    on_grid,
    random,
)
from arkaq_edu.field.goal import GOAL_REWARD, MISS_REWARD
from arkaq_edu.mdp import MDP, value_iteration

Floats = NDArray[np.float64]

_SENSING = Sensing.goal()
_WIDEST = 1.0  # rad; farther to the side hardly a kick scores


def chance_on_grid(paths: Floats, distance: float) -> Floats:
    """Return the chance that a kick scores on `ORIENTATIONS`, interpolated from 81 of them.

    Examples
    --------
    >>> from arkaq_edu.experiments.goal.kicks import ball_paths
    >>> chance_on_grid(ball_paths(50), 1850.0).shape
    (481,)
    """
    looked = np.linspace(-_WIDEST, _WIDEST, 81)
    return on_grid(looked, chance(paths, distance, looked))


def category(centers: ArrayLike, orientations: ArrayLike) -> NDArray[np.intp]:
    """Return the nearest center of each orientation: the agent's state.

    Parameters
    ----------
    centers : array_like, shape (k, 1)
        Scaled orientations.
    orientations : array_like, shape (m,)
        In rad. Outside the view, the state is that of the view's edge.

    Returns
    -------
    ndarray of int, shape (m,)

    Examples
    --------
    >>> category([[-0.5], [0.5]], [-1.0, -0.1, 0.1])
    array([0, 0, 1])
    """
    seen = _SENSING.scale(np.asarray(orientations, dtype=float)[:, None])
    return np.abs(seen - np.ravel(centers)).argmin(axis=1)


def plan(
    scores: Floats, centers: ArrayLike, learning: TrainingSettings | None = None
) -> NDArray[np.intp]:
    """Return the best action of every state: what Q-learning would find, given enough time.

    All orientations of a state have equal weight. The state "kicked" earns nothing and is never
    left.

    Parameters
    ----------
    scores : ndarray, shape (481,)
        The chance that a kick scores, on `ORIENTATIONS`.
    centers : array_like, shape (k, 1)
        The states, scaled orientations.
    learning : TrainingSettings, optional
        Discount and cost of a cycle; by default ``TrainingSettings.goal()``.

    Returns
    -------
    ndarray of int, shape (k,)

    References
    ----------
    Thesis eq 2.8 (value iteration), 5.3.2.

    Examples
    --------
    >>> from arkaq_edu.experiments.goal.kicks import ball_paths
    >>> scores = chance_on_grid(ball_paths(50), 1850.0)
    >>> plan(scores, [[-0.8], [-0.4], [0.0], [0.4], [0.8]]).tolist()
    [1, 1, 2, 0, 0]
    """
    learning = learning or TrainingSettings.goal()
    k = len(np.ravel(centers))
    sensing = _SENSING
    view = ORIENTATIONS[np.abs(ORIENTATIONS) <= sensing.high[0] + sensing.B[0][TURN_RIGHT]]
    # A whole state may lie between two places of the grid, so add the centers.
    seen = np.append(view, sensing.unscale(centers))
    inside = np.eye(k)[:, category(centers, seen)]
    inside /= inside.sum(axis=1, keepdims=True)
    T = np.zeros((3, k + 1, k + 1))
    T[:, k, k] = T[KICK, :, k] = 1.0
    for action in (TURN_LEFT, TURN_RIGHT):
        then = category(centers, seen + sensing.B[0][action])
        T[action, :k, :k] = inside @ np.eye(k)[then]
    R = np.full((k + 1, 3), learning.cycle_reward)
    earned = MISS_REWARD + scores * (GOAL_REWARD - MISS_REWARD)
    R[:k, KICK] += inside @ np.interp(seen, ORIENTATIONS, earned)
    R[k] = 0.0
    return value_iteration(MDP(T, R, learning.gamma), tol=1e-3)[1][:k]


def probabilities(
    scores: Floats, centers: ArrayLike, actions: NDArray[np.intp]
) -> dict[str, Floats]:
    """Return the probability of a goal on `ORIENTATIONS`, by policy.

    Parameters
    ----------
    scores : ndarray, shape (481,)
        The chance that a kick scores, on `ORIENTATIONS`.
    centers : array_like, shape (k, 1)
        The states, scaled orientations.
    actions : ndarray of int, shape (k,)
        The action of each state.

    Returns
    -------
    dict of str to ndarray, shape (481,)
        "learned" takes the `actions`, "best" sees the orientation itself, "random" draws.

    Examples
    --------
    >>> scores = np.maximum(0.0, 0.6 - 2 * abs(ORIENTATIONS))
    >>> values = probabilities(scores, [[0.0]], np.array([KICK]))
    >>> [float(values[who][240].round(2)) for who in ("learned", "best", "random")]
    [0.6, 0.6, 0.37]
    """
    learned = follow(actions[category(centers, ORIENTATIONS)])
    policies = {"learned": learned, "best": best, "random": random}
    return {who: goal_probability(scores, choose) for who, choose in policies.items()}


def score_fact(goals: dict[str, Floats]) -> str:
    """Say how often each policy of `probabilities` scores, over all starts.

    Examples
    --------
    >>> scores = np.maximum(0.0, 0.6 - 2 * abs(ORIENTATIONS))
    >>> score_fact(probabilities(scores, [[0.0]], np.array([KICK])))
    '23 % score; the best 53 %, random 20 %'
    """
    learned, best, random = (
        f"{100 * mean_over_starts(goals[who], STARTS['near']):.0f} %"
        for who in ("learned", "best", "random")
    )
    return f"{learned} score; the best {best}, random {random}"


def last_aims(centers: ArrayLike, actions: NDArray[np.intp], n: int, seed: int = 0) -> Floats:
    """Follow a policy from `n` starts at equal distances to where it kicks.

    Parameters
    ----------
    centers : array_like, shape (k, 1)
        The states, scaled orientations.
    actions : ndarray of int, shape (k,)
        The action of each state.
    n : int
        Number of starts.
    seed : int
        The seed of the variation of turns.

    Returns
    -------
    ndarray, shape (at most n,)
        Orientations of the goal (rad) at the kick. Starts that lead to no kick are left out.

    Examples
    --------
    >>> aims = last_aims([[-0.6], [0.0], [0.6]], np.array([TURN_RIGHT, KICK, TURN_LEFT]), n=50)
    >>> len(aims), bool(np.abs(aims).max() < 0.16)
    (50, True)
    """
    sensing, rng = _SENSING, np.random.default_rng(seed)
    moved = np.array(sensing.B[0])
    aims = np.linspace(-1, 1, n) * STARTS["near"].most
    for _ in range(PATIENCE):
        action = actions[category(centers, aims)]
        varied = moved[action] + np.sqrt(sensing.Q[0][0]) * rng.standard_normal(n)
        aims = np.where(action == KICK, aims, aims + varied)
    return aims[actions[category(centers, aims)] == KICK]
