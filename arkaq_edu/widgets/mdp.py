"""Two explorers on one small floor: value iteration by sweeps, and Q-learning by steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.floor import BALL, HOLE, SHADES, STONE, floor_polygons
from arkaq_edu.mdp import best_actions
from arkaq_edu.mdp.floor import RUNS, STEPS, SWEEPS, Life, Sweeps, lives, sweeps
from arkaq_edu.mdp.gridworld import Grid
from arkaq_edu.widgets.explorer import Explorer, sized, slider, stops
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: The stops of the sliders of the learning rate and of the temperature.
RATES: tuple[float | str, ...] = ("1/visits", 0.05, 0.1, 0.2, 0.5, 1.0)
TEMPERATURES = (0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 1000.0)

_LOOK = sized("7em")
_TIPS = {
    "n": "How often every value was computed anew",
    "gamma": "What a reward is worth one step later",
    "slip": "The probability that a step goes to one side instead",
    "steps": "How many steps each robot has made",
    "alpha": "The learning rate: how far a step moves Q",
    "T": "The temperature of the choice: high is random, low is greedy",
}
_ERRORS = (0.01, 10_000.0)


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
        n=slider("sweeps", 0, 0, SWEEPS, tooltip=_TIPS["n"], **_LOOK),
        gamma=slider("gamma", 0.95, 0.5, 0.95, 0.05, tooltip=_TIPS["gamma"], **_LOOK),
        slip=slider("slip", 0.1, 0, 0.5, 0.05, tooltip=_TIPS["slip"], **_LOOK),
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
    return Scene(run.fact(n), [_floor(run.grid, run.V[n], run.best[n]), _errors(run, n)])


def _floor(grid: Grid, V: NDArray[np.float64], best: NDArray[np.bool_]) -> Panel:
    floor = floor_polygons(grid, V, best)
    width, height = len(grid.plan[0]), len(grid.plan)
    within = (0, width, 0, height)
    layers: list[Layer] = [Cells(floor.squares, floor.shades, within, SHADES, border=1.0)]
    for found, color in zip(floor[2:], (STONE, HOLE, BALL, style.INK), strict=True):
        if found:
            layers.append(Cells.shape(found, color, within))
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
    return Explorer(
        draw_life,
        steps=stops("steps", STEPS, 5000, "{:,}", tooltip=_TIPS["steps"], **_LOOK),
        alpha=stops("alpha", RATES, 0.1, "{}", tooltip=_TIPS["alpha"], **_LOOK),
        temperature=stops("temperature", TEMPERATURES, 10.0, tooltip=_TIPS["T"], **_LOOK),
    )


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
    life, i = lives(alpha, temperature), STEPS.index(steps)
    floor = _floor(life.grid, life.Q[i].max(axis=1), best_actions(life.Q[i]))
    return Scene(life.fact(i), [floor, _learned(life, i)])


def _learned(life: Life, i: int) -> Panel:
    mean, spread = life.error.mean(axis=0)[1:], life.error.std(axis=0)[1:]
    k = np.array(STEPS[1:], dtype=float)
    top = max(100.0, 1.3 * float(max((mean + spread).max(), life.error[0].max())))
    ends, heights = (90.0, 25_000.0), (0.0, top)
    layers: list[Layer] = [
        Cells.band(k, mean, spread, (*ends, *heights)),
        Line(k, mean, style.OURS, 2.0),
        Points([max(STEPS[i], ends[0])], life.error[0, [i]], 4.5, style.INK),
        Text(700, 0.94 * top, f"{RUNS} robots ± 1 sigma", style.OURS),
        Text(700, 0.87 * top, "dot: the robot on the left"),
    ]
    return Panel(
        "steps", "mean distance of max Q from V*", ends, heights, layers, log="x",
        xticks=[100, 1000, 10_000],
    )  # fmt: skip
