"""The best that can be done: dynamic programming over the orientation of the goal.

The orientation and the number of turns left are the whole state. A kick in orientation o scores
with probability p(o), a turn moves o by a known amount, give or take the variation of the
footsteps. Backward from the last turn (eq 2.6, value iteration over a finite horizon), the
probability of a goal is

    V_0(o) = 0,    V_k(o) = max(E[V_{k-1}(o - turn)], E[V_{k-1}(o + turn)], p(o)).

Other policies put another choice in place of the maximum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing
from arkaq_edu.envs.score_goal import KICK, TURN_LEFT, TURN_RIGHT, Start
from arkaq_edu.experiments.goal.kicks import load_kick_trials
from arkaq_edu.experiments.goal.task import Distance, start_of

Floats = NDArray[np.float64]

#: Places of the grid in a turn; with 30, a standard deviation of a turn is half a place.
STEPS = 30
#: Orientations of the goal (rad) on which values are kept, eight turns to each side.
ORIENTATIONS = Sensing.goal().B[0][TURN_RIGHT] / STEPS * np.arange(-8 * STEPS, 8 * STEPS + 1)
#: Turns after which an episode ends without a kick.
PATIENCE = 30

# The error of a turn: -1, 0 or 1 places, with weights that give it the variance of the footsteps.
_ASIDE = Sensing.goal().Q[0][0] / (ORIENTATIONS[1] - ORIENTATIONS[0]) ** 2 / 2
_SAME = 1e-9  # probabilities that differ by less count as equal


def after_turns(values: Floats) -> tuple[Floats, Floats]:
    """Return the mean of `values` after a turn to the left and after one to the right.

    A turn moves by `STEPS` places of the grid, with an error. The error is -1, 0 or 1 places, with
    weights that give it the variance of the footsteps. Beyond the grid, values are zero.

    Parameters
    ----------
    values : ndarray, shape (481,)
        On `ORIENTATIONS`.

    Returns
    -------
    left, right : ndarray, shape (481,)

    Examples
    --------
    >>> left, right = after_turns(ORIENTATIONS)
    >>> left[240].round(3), right[240].round(3)  # from straight ahead
    (np.float64(-0.148), np.float64(0.148))
    """
    w = _ASIDE
    edge = np.zeros(STEPS + 1)
    padded = np.concatenate([edge, values, edge])
    mean = w * padded[:-2] + (1 - 2 * w) * padded[1:-1] + w * padded[2:]
    return mean[: len(values)], mean[-len(values) :]


def goal_probability(
    chance: Floats, choose: Callable[[Floats], Floats], turns: int = PATIENCE
) -> Floats:
    """Work backward from the last turn to the probability of a goal.

    Parameters
    ----------
    chance : ndarray, shape (481,)
        The probability that a kick scores, on `ORIENTATIONS`.
    choose : function
        Takes what each action gives, shape (3, 481), and returns what the policy gets, shape
        (481,): see `best`, `random`, `follow`.
    turns : int
        Turns after which an episode ends without a kick.

    Returns
    -------
    ndarray, shape (481,)

    Examples
    --------
    >>> chance = np.maximum(0.0, 0.6 - 2 * abs(ORIENTATIONS))
    >>> kick_at_once = follow(np.full(481, KICK))
    >>> bool((goal_probability(chance, kick_at_once) == chance).all())
    True
    """
    V = np.zeros_like(chance)
    for _ in range(turns):
        V = choose(np.array([*after_turns(V), chance]))
    return V


def best(Q: Floats) -> Floats:
    """Return what the best action gives."""
    return Q.max(axis=0)


def random(Q: Floats) -> Floats:
    """Return what an action drawn at random gives."""
    return Q.mean(axis=0)


def follow(actions: NDArray[np.intp]) -> Callable[[Floats], Floats]:
    """Return the choice of a policy that takes `actions`, one for each of `ORIENTATIONS`."""
    return lambda Q: np.take_along_axis(Q, actions[None], axis=0)[0]


def mean_over_starts(values: Floats, start: Start) -> float:
    """Return the mean of `values` over the starts of the task, on both sides of the goal.

    Examples
    --------
    >>> round(mean_over_starts(abs(ORIENTATIONS), start_of("far")), 3)
    0.325
    """
    aside = np.linspace(start.least, start.most, 2001)
    return float(np.interp([-aside, aside], ORIENTATIONS, values).mean())


@dataclass(frozen=True)
class BestPolicy:
    """The best policy that sees the goal's orientation.

    Attributes
    ----------
    orientation : ndarray, shape (n,)
        A grid (rad).
    chance : ndarray, shape (n,)
        The probability that a kick scores, in each orientation.
    value : ndarray, shape (n,)
        The probability of a goal under the best policy, with all turns left.
    action : ndarray of int, shape (patience, n)
        The best action; row k is with k + 1 turns left. With many turns left the policy is choosy:
        turns vary, and the next may end straighter.
    goals : float
        The mean of `value` over the starts of the task.
    random : float
        The same for random actions.
    """

    orientation: Floats
    chance: Floats
    value: Floats
    action: NDArray[np.intp]
    goals: float
    random: float


def best_policy(
    goal_distance: Distance, trials: pd.DataFrame | None = None, patience: int = PATIENCE
) -> BestPolicy:
    """Return the best policy, found by dynamic programming: no learning, no agent.

    Parameters
    ----------
    goal_distance : {"near", "far"}
    trials : DataFrame, optional
        See `kick_trials`; by default those that come with the course.
    patience : int
        Turns after which the episode ends without a kick.

    Returns
    -------
    BestPolicy

    Notes
    -----
    Each chance is counted over 1,000 kicks, the same in every orientation. So the chances, and
    what follows from them, are known to about 1.5 per cent.

    References
    ----------
    Thesis eq 2.6 and 5.3.

    Examples
    --------
    >>> found = best_policy("near")
    >>> bool(found.random < found.goals <= found.chance.max())
    True
    """
    start = start_of(goal_distance)
    patience = _checks.integer("patience", patience, 1)
    trials = load_kick_trials(goal_distance) if trials is None else trials
    chance = on_grid(trials.orientation, trials.goals / trials.kicks)
    toward = np.where(ORIENTATIONS > 0, TURN_LEFT, TURN_RIGHT)
    actions = []

    def best_and_keep(Q: Floats) -> Floats:
        # Of actions that give the same, prefer the kick, then the turn toward the goal.
        V = best(Q) - _SAME
        turn = np.where(follow(toward)(Q) >= V, toward, 1 - toward)
        actions.append(np.where(Q[KICK] >= V, KICK, turn))
        return best(Q)

    value = goal_probability(chance, best_and_keep, patience)
    by_chance = goal_probability(chance, random, patience)
    goals, at_random = mean_over_starts(value, start), mean_over_starts(by_chance, start)
    return BestPolicy(ORIENTATIONS, chance, value, np.array(actions), goals, at_random)


def on_grid(orientations: ArrayLike, chance: ArrayLike) -> Floats:
    """Interpolate a chance measured in some orientations on `ORIENTATIONS`; beyond, it is zero.

    Examples
    --------
    >>> float(on_grid([-0.5, 0.5], [0.2, 0.6])[240])  # straight ahead
    0.4
    """
    x, y = np.asarray(orientations, dtype=float), np.asarray(chance, dtype=float)
    return np.interp(ORIENTATIONS, x, y, 0.0, 0.0)
