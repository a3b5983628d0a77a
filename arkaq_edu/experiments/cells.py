"""The ball problem on cells: a POMDP that can be planned, to compare with what is learned.

Where the ball is, is cut into cells of distance and orientation. The planner knows the footsteps,
their variation and the camera's errors (`Sensing.consistent`); it does not learn. One that trusts
the last look solves the MDP of the cells. One that keeps a belief solves the POMDP, point by point.

``arkaq study data/studies/planned.toml`` judges both; ``data/studies/planned.csv`` is its result.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing
from arkaq_edu.envs.ball_approach import FOOTSTEPS
from arkaq_edu.experiments import approach
from arkaq_edu.experiments.policies import Choice
from arkaq_edu.experiments.runs import FRESH_SEEDS
from arkaq_edu.field import pitch
from arkaq_edu.field.camera import FIELD_OF_VIEW
from arkaq_edu.field.supervisor import (
    CLOSE_ENOUGH,
    CLOSE_REWARD,
    STRAIGHT_ENOUGH,
    STRAIGHT_REWARD,
)
from arkaq_edu.mdp import value_iteration
from arkaq_edu.pomdp import POMDP, ValueFunction, solve_point_based

Floats = NDArray[np.float64]

#: Borders of the cells: the distance of the ball (mm), from where it is reached, and its
#: orientation (rad). A footstep to the side turns by the width of a cell.
DISTANCES, ORIENTATIONS = np.arange(CLOSE_ENOUGH, 4101.0, 150.0), np.arange(-0.75, 0.76, 0.1)
_SHAPE = len(DISTANCES) - 1, len(ORIENTATIONS) - 1
#: The last state, after the ball was reached; the last two observations, no ball and the end.
OVER, UNSEEN, END = np.prod(_SHAPE) + np.array([0, 0, 1])


@lru_cache(maxsize=4)
def on_cells(samples: int = 400, gamma: float = 0.97) -> POMDP:
    """Return the ball problem on cells.

    Parameters
    ----------
    samples : int
        Draws in each cell, from which the probabilities are counted. They are always the same.
    gamma : float
        The discount per cycle.

    Returns
    -------
    POMDP
        Its states are the cells of the true place, distance by distance, and the end. Its
        observations are the cells of the seen place, no ball, and the end.

    Examples
    --------
    >>> on_cells(samples=20)
    POMDP(361 states, 3 actions, 362 observations, gamma=0.97)
    """
    rng, n, known = np.random.default_rng(0), int(OVER), Sensing.consistent()
    walk_error, look_error = np.sqrt(known.Q.diagonal()), np.sqrt(known.R.diagonal())
    T, R = np.zeros((3, n + 1, n + 1)), np.zeros((n + 1, 3))
    O = np.zeros((n + 1, n + 2))  # noqa: E741  (the thesis's letter)
    T[:, n, n] = O[n, END] = 1.0
    for s in range(n):
        distance, orientation = _places(s, samples, rng)
        error = rng.normal(size=(2, samples))
        far = distance + error[0] * (look_error[0] + known.range_noise * distance**2)
        aside = orientation + error[1] * look_error[1]
        seen = np.where(abs(orientation) < FIELD_OF_VIEW / 2, cell(far, aside), UNSEEN)
        np.add.at(O[s], seen, 1 / samples)
        for a in range(3):
            d, o = _walk(distance, orientation, a)
            d, o = np.array([d, o]) + rng.normal(size=(2, samples)) * walk_error[:, None]
            reached = d < DISTANCES[0]
            np.add.at(T[a, s], np.where(reached, OVER, cell(d, o)), 1 / samples)
            straight = abs(o) <= STRAIGHT_ENOUGH
            R[s, a] = np.mean(reached * (CLOSE_REWARD + STRAIGHT_REWARD * straight))
    start = np.append(np.tile(abs(ORIENTATIONS[:-1] + 0.05) < FIELD_OF_VIEW / 2, _SHAPE[0]), False)
    return POMDP(T, np.tile(O, (3, 1, 1)), R, gamma, start / start.sum())


def cell(distance: Any, orientation: Any) -> Any:
    """Return the cell of a place; beyond the borders, the nearest."""
    i = np.clip(np.searchsorted(DISTANCES, distance, "right") - 1, 0, _SHAPE[0] - 1)
    j = np.clip(np.searchsorted(ORIENTATIONS, orientation, "right") - 1, 0, _SHAPE[1] - 1)
    return i * _SHAPE[1] + j


def _places(s: int, n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Draw places in a cell."""
    i, j = divmod(s, _SHAPE[1])
    near, far, right, left = *DISTANCES[i : i + 2], *ORIENTATIONS[j : j + 2]
    return rng.uniform(near, far, n), rng.uniform(right, left, n)


def _walk(distance: Floats, orientation: Floats, a: int) -> tuple[Floats, Floats]:
    """Return where the ball is after an action."""
    left, right = FOOTSTEPS[a]
    turn, ahead = (right - left) / pitch.ROBOT_WIDTH, (left + right) / 2
    x = distance * np.cos(orientation) - ahead * np.cos(turn / 2)
    y = distance * np.sin(orientation) - ahead * np.sin(turn / 2)
    return np.hypot(x, y), np.arctan2(y, x) - turn


class LastLook:
    """Act as if the ball were in the middle of the cell where it was seen last.

    The best action for each cell is found by value iteration.

    Examples
    --------
    >>> from arkaq_edu.experiments.approach import describe, evaluate
    >>> bool(evaluate(LastLook, n=20).is_success.all())
    True
    """

    def __init__(self, episode: int = 0) -> None:
        self.action = _by_cell()
        self.state = 0

    def __call__(self, observation: NDArray[np.floating], info: dict[str, Any]) -> int:
        """Return the action for a look."""
        if observation[2]:
            self.state = int(cell(*observation[:2]))
        return int(self.action[self.state])


class Belief:
    """Keep a belief over the cells, and act by the point-based value of it.

    Examples
    --------
    >>> walker = Belief()
    >>> walker(np.array([2000.0, 0.3, 1.0]), {})  # the ball is to the left
    1
    """

    def __init__(self, episode: int = 0) -> None:
        self.pomdp, self.value = on_cells(), _by_belief()
        self.belief: Floats = self.pomdp.start
        self.last: int | None = None

    def __call__(self, observation: NDArray[np.floating], info: dict[str, Any]) -> int:
        """Return the action for a look and all looks before it."""
        if self.last is not None:
            self.belief = self.belief @ self.pomdp.T[self.last]
        z = int(cell(*observation[:2])) if observation[2] else int(UNSEEN)
        joint = self.belief * self.pomdp.O[0][:, z]
        # What cannot be has been seen, if the belief was wrong: then believe the look alone.
        self.belief = joint if joint.sum() > 0 else self.pomdp.O[0][:, z]
        self.belief = self.belief / self.belief.sum()
        self.last = self.value.action(self.belief)
        return self.last


@lru_cache(maxsize=1)
def _by_cell() -> NDArray[np.intp]:
    return value_iteration(on_cells().mdp)[1]


@lru_cache(maxsize=1)
def _by_belief() -> ValueFunction:
    return solve_point_based(on_cells(), 0.5, max_backups=1000).lower


#: What plans, by name.
PLANNERS: dict[str, Callable[[int], Choice]] = {"last look": LastLook, "belief": Belief}


def measure(seed: int, trusts: str, episodes: int = 200) -> dict[str, float]:
    """Judge a planner on fresh starts; see `arkaq_edu.experiments.study`.

    Parameters
    ----------
    seed : int
        The starts are those that judge an agent of this seed.
    trusts : {"last look", "belief"}
    episodes : int
        The number of fresh starts.
    """
    policy = PLANNERS[_checks.choice("trusts", trusts, PLANNERS)]
    shown, best = (
        approach.evaluate(p, episodes, FRESH_SEEDS + seed) for p in (policy, approach.planner())
    )
    regret = float(best.reward.mean() - shown.reward.mean())
    return {**approach.score(shown), "regret": regret}
