"""What is learned on the course's floor: values by sweeps, and robots by steps."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from arkaq_edu.mdp.gridworld import Grid, grid_world
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.planning import best_actions, error_bound, policy_iteration
from arkaq_edu.mdp.q_learning import QLearner
from arkaq_edu.mdp.training import train

SWEEPS = 40  # of value iteration
#: The numbers of steps after which the robots are looked at.
STEPS = (0, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)
#: The robots that learn, including the one that is shown.
RUNS = 20


class Sweeps(NamedTuple):
    """Value iteration on a floor, sweep by sweep.

    Attributes
    ----------
    grid : Grid
        The floor.
    V : ndarray, shape (n + 1, S)
        The values after 0, 1, ... n sweeps.
    best : ndarray of bool, shape (n + 1, S, A)
        The best actions by those values.
    error, bound : ndarray, shape (n + 1,)
        The largest distance from V*, and the bound that `error_bound` gives without V*.
    right : ndarray of bool, shape (n + 1, S)
        Whether all arrows of the state are also best by V*.
    """

    grid: Grid
    V: NDArray[np.float64]
    best: NDArray[np.bool_]
    error: NDArray[np.float64]
    bound: NDArray[np.float64]
    right: NDArray[np.bool_]

    def fact(self, n: int) -> str:
        """Say how many arrows sweep `n` turned, and how far V is from V* after it.

        Examples
        --------
        >>> sweeps(0.95, 0.1).fact(3)
        'sweep 3: 4 arrows turned, 16 of 37 are right; V is off by 83.6, the bound says 1187.6'
        """
        turned = int((self.best[n] != self.best[n - 1]).any(axis=1).sum()) if n else 0
        return (
            f"sweep {n}: {turned} arrow{'s' * (turned != 1)} turned, "
            f"{self.right[n].sum()} of {(~self.grid.mdp.ends).sum()} are right; "
            f"V is off by {self.error[n]:.1f}, the bound says {self.bound[n]:.1f}"
        )


@lru_cache(maxsize=16)
def sweeps(gamma: float, slip: float) -> Sweeps:
    """Return value iteration on the course's floor, from V = 0, for `SWEEPS` sweeps.

    Parameters
    ----------
    gamma : float
        The discount rate, in [0, 1).
    slip : float
        The probability that a step goes to one side instead, in [0, 1].

    Returns
    -------
    Sweeps

    References
    ----------
    Thesis 2.2.1, equations 2.8 and 2.9.

    Examples
    --------
    >>> run = sweeps(gamma=0.9, slip=0.0)
    >>> int(run.right[0].sum()), int(run.right[-1].sum())
    (3, 37)
    """
    grid = grid_world(slip=slip, gamma=gamma)
    mdp = grid.mdp
    V = np.zeros((SWEEPS + 1, mdp.n_states))
    for n in range(SWEEPS):
        V[n + 1] = mdp.action_values(V[n]).max(axis=1)
    exact, _ = policy_iteration(mdp)
    best = np.array([best_actions(mdp.action_values(values)) for values in V])
    bound = np.array([error_bound(mdp, values) for values in V])
    return Sweeps(grid, V, best, np.abs(V - exact).max(axis=1), bound, _right(mdp, best, exact))


def _right(mdp: MDP, best: NDArray[np.bool_], exact: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Return for each state whether all its arrows are best by V*, too; never at an end."""
    truly = best_actions(mdp.action_values(exact))
    return ~(best & ~truly).any(axis=-1) & ~mdp.ends


class Life(NamedTuple):
    """What robots have learned on the course's floor after each number of `STEPS`.

    Attributes
    ----------
    grid : Grid
        The floor.
    Q : ndarray, shape (stops, S, A)
        The table of the robot that is shown.
    right : ndarray of bool, shape (stops, S)
        Whether all its arrows of the state are also best by V*.
    error : ndarray, shape (RUNS, stops)
        The mean of abs(max Q - V*) over the free squares, for each robot.
    """

    grid: Grid
    Q: NDArray[np.float64]
    right: NDArray[np.bool_]
    error: NDArray[np.float64]

    def fact(self, i: int) -> str:
        """Say what was learned after ``STEPS[i]`` steps.

        Examples
        --------
        >>> lives(0.1, 10.0).fact(0)
        '0 steps: 0 of 37 arrows are right; Q is off by 66.8, that of 20 robots by 66.8 ± 0.0'
        """
        errors = self.error[:, i]
        return (
            f"{STEPS[i]:,} steps: {self.right[i].sum()} of {(~self.grid.mdp.ends).sum()} arrows "
            f"are right; Q is off by {errors[0]:.1f}, "
            f"that of {RUNS} robots by {errors.mean():.1f} ± {errors.std():.1f}"
        )


@lru_cache(maxsize=64)
def lives(alpha: float | str, temperature: float) -> Life:
    """Return what `RUNS` robots learn at a learning rate and a temperature.

    Parameters
    ----------
    alpha : float or "1/visits"
        The learning rate, as for `arkaq_edu.mdp.QLearner`.
    temperature : float
        The temperature of the Boltzmann choice, above 0.

    Returns
    -------
    Life
        The robots start a new episode after each number of `STEPS`.

    References
    ----------
    Thesis 2.2.3 and chapter 3, equations 2.12 and 3.2.

    Examples
    --------
    >>> life = lives(0.2, 10.0)
    >>> bool(life.error[:, -1].max() < life.error[:, 0].min())
    True
    """
    grid = grid_world()
    mdp = grid.mdp
    exact, _ = policy_iteration(mdp)
    # A slider waits for it, so the robots learn in threads. Each has a generator of its own.
    tables = Parallel(n_jobs=-1, prefer="threads")(
        delayed(_live)(mdp, alpha, temperature, seed) for seed in range(RUNS)
    )
    off = np.abs(np.array(tables).max(axis=-1) - exact)
    best = np.array([best_actions(table) for table in tables[0]])
    error = off[..., ~mdp.ends].mean(axis=-1)
    return Life(grid, tables[0], _right(mdp, best, exact), error)


def _live(mdp: MDP, alpha: float | str, temperature: float, seed: int) -> NDArray[np.float64]:
    """Return the table of one robot after each number of `STEPS`."""
    learner = QLearner(mdp.n_states, mdp.n_actions, alpha, mdp.gamma, rng=seed)
    tables = [learner.Q.copy()]
    for more in np.diff(STEPS).tolist():
        train(mdp, learner, more, temperature=temperature)
        tables.append(learner.Q.copy())
    return np.array(tables)
