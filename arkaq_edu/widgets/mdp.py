"""Two explorers on one small floor: value iteration by sweeps, and Q-learning by steps."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.floor import BALL, HOLE, SHADES, STONE, floor_polygons
from arkaq_edu.mdp import MDP, QLearner, best_actions, error_bound, policy_iteration, train
from arkaq_edu.mdp.gridworld import Grid, grid_world
from arkaq_edu.widgets.explorer import Explorer, wide
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text, between

#: The last stop of the slider of sweeps.
SWEEPS = 40
#: The stops of the slider of steps.
STEPS = (0, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)
#: The stops of the slider of the learning rate.
RATES: tuple[float | str, ...] = ("1/visits", 0.05, 0.1, 0.2, 0.5, 1.0)
#: The robots that learn, including the one that is shown.
RUNS = 20

_WIDE = wide("7em")
_ERRORS = (0.01, 10_000.0)


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


@cache
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


def planning_explorer() -> Explorer:
    """Return sliders for sweeps, discount and slip above a floor with values and arrows.

    Returns
    -------
    Explorer
        Its sliders are ``controls["n"]``, the sweeps, ``controls["gamma"]`` and
        ``controls["slip"]``.

    References
    ----------
    Thesis 2.2.1, equations 2.8 and 2.9.

    Examples
    --------
    >>> explorer = planning_explorer()
    >>> explorer.controls["n"].value = 3
    >>> explorer
    sweep 3: 4 arrows turned, 16 of 37 are right; V is off by 83.6, the bound says 1187.6
    """
    return Explorer(
        draw_sweep,
        n=ipywidgets.IntSlider(0, min=0, max=SWEEPS, description="sweeps", **_WIDE),
        gamma=ipywidgets.FloatSlider(
            0.95, min=0.5, max=0.95, step=0.05, description="gamma", **_WIDE
        ),
        slip=ipywidgets.FloatSlider(0.1, min=0, max=0.5, step=0.05, description="slip", **_WIDE),
    )


def draw_sweep(n: int, gamma: float, slip: float) -> Scene:
    """Return the picture of the floor after n sweeps of value iteration, and of the error so far.

    Parameters
    ----------
    n : int
        The number of sweeps.
    gamma : float
        The discount rate, in [0, 1).
    slip : float
        The probability that a step goes to one side instead, in [0, 1].

    Returns
    -------
    Scene
    """
    run = sweeps(round(gamma, 3), round(slip, 3))
    going_on = int((~run.grid.mdp.ends).sum())
    turned = int((run.best[n] != run.best[n - 1]).any(axis=1).sum()) if n else 0
    fact = (
        f"sweep {n}: {turned} arrow{'s' * (turned != 1)} turned, "
        f"{run.right[n].sum()} of {going_on} are right; "
        f"V is off by {run.error[n]:.1f}, the bound says {run.bound[n]:.1f}"
    )
    return Scene(fact, [_floor(run.grid, run.V[n], run.best[n]), _errors(run, n)])


def _floor(grid: Grid, V: NDArray[np.float64], best: NDArray[np.bool_]) -> Panel:
    floor = floor_polygons(grid, V, best)
    width, height = len(grid.plan[0]), len(grid.plan)
    within = (0, width, 0, height)
    layers: list[Layer] = [Cells(floor.squares, floor.shades, within, SHADES, border=1.0)]
    for polygons, color in (
        (floor.walls, STONE), (floor.holes, HOLE), (floor.balls, BALL), (floor.arrows, style.INK),
    ):  # fmt: skip
        if polygons:
            layers.append(Cells(polygons, [0] * len(polygons), within, [color], border=0))
    return Panel("", "", (0, width), (0, height), layers, width=1.25, bare=True)


def _errors(run: Sweeps, n: int) -> Panel:
    k = np.arange(SWEEPS + 1)
    bound, error = (np.clip(values, *_ERRORS) for values in (run.bound, run.error))
    above, seen = run.bound >= _ERRORS[0], run.error >= _ERRORS[0]
    layers: list[Layer] = [
        Line(k[above], bound[above], style.INK, 1.3, dashed=True),
        Line(k[seen], error[seen], style.OURS, 2.0),
        Points([n], bound[[n]], 4.0, style.INK, hollow=True),
        Points([n], error[[n]], 4.5, style.OURS),
        Text(18, 5000, "bound, computed without V*"),
        Text(18, 2200, "largest error of V", style.OURS),
    ]
    return Panel(
        "sweeps", "distance of V from V*", (0, SWEEPS), _ERRORS, layers, log="y",
        yticks=[0.01, 0.1, 1, 10, 100, 1000, 10_000],
    )  # fmt: skip


class Life(NamedTuple):
    """What robots have learned on the course's floor after each number of `STEPS`.

    Attributes
    ----------
    Q : ndarray, shape (stops, S, A)
        The table of the robot that is shown.
    error : ndarray, shape (RUNS, stops)
        The mean of abs(max Q - V*) over the free squares, for each robot.
    """

    Q: NDArray[np.float64]
    error: NDArray[np.float64]


@cache
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
    mdp = grid_world().mdp
    exact, _ = policy_iteration(mdp)
    Q = np.empty((len(STEPS), *mdp.R.shape))
    error = np.empty((RUNS, len(STEPS)))
    for seed in range(RUNS):
        learner = QLearner(mdp.n_states, mdp.n_actions, alpha, mdp.gamma, rng=seed)
        for i, more in enumerate(np.diff(STEPS, prepend=0).tolist()):
            if more:
                train(mdp, learner, more, temperature=temperature)
            off = np.abs(learner.Q.max(axis=1) - exact)
            error[seed, i] = off[~mdp.ends].mean()
            if seed == 0:
                Q[i] = learner.Q
    return Life(Q, error)


def q_learning_explorer() -> Explorer:
    """Return sliders for steps, learning rate and temperature above what a robot has learned.

    Returns
    -------
    Explorer
        Its sliders are ``controls["steps"]``, ``controls["alpha"]`` and
        ``controls["temperature"]``.

    References
    ----------
    Thesis 2.2.3 and chapter 3, equations 2.12 and 3.2.

    Examples
    --------
    >>> explorer = q_learning_explorer()
    >>> explorer.controls["steps"].value = 0
    >>> explorer
    0 steps: 0 of 37 arrows are right; Q is off by 66.8, that of 20 robots by 66.8 ± 0.0
    """
    names = [(f"{steps:,}", steps) for steps in STEPS]
    return Explorer(
        draw_life,
        steps=ipywidgets.SelectionSlider(
            options=names, value=5000, description="steps", **_WIDE
        ),
        alpha=ipywidgets.SelectionSlider(
            options=[(str(rate), rate) for rate in RATES], value=0.1, description="alpha", **_WIDE
        ),
        temperature=ipywidgets.SelectionSlider(
            options=[(f"{T:g}", T) for T in (0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 1000.0)],
            value=10.0, description="temperature", **_WIDE,
        ),
    )  # fmt: skip


def draw_life(steps: int, alpha: float | str, temperature: float) -> Scene:
    """Return the picture of what one robot has learned, and of the errors of all robots.

    Parameters
    ----------
    steps : int
        One of `STEPS`.
    alpha : float or "1/visits"
        The learning rate.
    temperature : float
        The temperature of the Boltzmann choice, above 0.

    Returns
    -------
    Scene
    """
    life, grid, i = lives(alpha, temperature), grid_world(), STEPS.index(steps)
    mdp = grid.mdp
    best = best_actions(life.Q[i])
    right = _right(mdp, best, policy_iteration(mdp)[0])
    mean, spread = life.error.mean(axis=0), life.error.std(axis=0)
    fact = (
        f"{steps:,} steps: {right.sum()} of {(~mdp.ends).sum()} arrows are right; Q is off by "
        f"{life.error[0, i]:.1f}, that of {RUNS} robots by {mean[i]:.1f} ± {spread[i]:.1f}"
    )
    return Scene(fact, [_floor(grid, life.Q[i].max(axis=1), best), _learned(life, i)])


def _learned(life: Life, i: int) -> Panel:
    mean, spread = life.error.mean(axis=0)[1:], life.error.std(axis=0)[1:]
    k = np.array(STEPS[1:], dtype=float)
    ends, heights = (90.0, 25_000.0), (0.0, 100.0)
    layers: list[Layer] = [
        between(k, mean - spread, mean + spread, (*ends, *heights), "#e2cbdc"),
        Line(k, mean, style.OURS, 2.0),
        Points([max(STEPS[i], ends[0])], life.error[0, [i]], 4.5, style.INK),
        Text(700, 94, f"{RUNS} robots ± 1 sigma", style.OURS),
        Text(700, 87, "dot: the robot on the left"),
    ]
    return Panel(
        "steps", "mean distance of max Q from V*", ends, heights, layers, log="x",
        xticks=[100, 1000, 10_000],
    )  # fmt: skip
