"""Where kicks go: counted in the physics, and placed before a goal without it.

A kick takes the physics three milliseconds. A slider that asks for thousands of kicks cannot wait
for that, and need not: the path of the ball hardly depends on where the robot stands. So a few
hundred kicks on an open field are stored, and placed before a goal at any distance and
orientation. This leaves out what only the goal does to a ball: it bounces off posts, panels and
the back wall, and a hard shot from close range can bounce out again.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.experiments.goal.task import Distance, start_of
from arkaq_edu.field import GoalSupervisor, World, pitch
from arkaq_edu.field.goal import MAX_GOAL_DISTANCE, MIN_GOAL_DISTANCE
from arkaq_edu.field.supervisor import ROBOT_START

Floats = NDArray[np.float64]

_POINTS = 12  # of a stored path


def kick_trials(
    goal_distance: Distance | float,
    orientations: ArrayLike,
    n: int = 1000,
    seed: int = 0,
) -> pd.DataFrame:
    """Kick many times in each of a number of orientations, and count the goals.

    Parameters
    ----------
    goal_distance : {"near", "far"} or float
        Where the robot stands (mm).
    orientations : array_like
        Orientations of the goal (rad).
    n : int
        Number of kicks in each.
    seed : int
        The seed of the kicks. They are the same in every orientation, so that differences
        between orientations are not due to luck.

    Returns
    -------
    DataFrame
        Columns orientation, kicks, goals.

    Examples
    --------
    >>> trials = kick_trials("near", [0.0, 0.8], n=30)
    >>> trials.goals.iloc[0] > trials.goals.iloc[1]
    np.True_
    """
    if isinstance(goal_distance, str):
        goal_distance = start_of(goal_distance).distance
    _checks.number("goal_distance", goal_distance, MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE)
    supervisor = GoalSupervisor(goal_distance)
    orientations = np.atleast_1d(_checks.array("orientations", orientations, None))
    n, seed = _checks.integer("n", n, 1), _checks.integer("seed", seed)
    world, rows = World(), []
    for orientation in orientations.tolist():
        goals = 0
        for number in range(n):
            world.rng = np.random.default_rng([seed, number])
            supervisor.place(world, orientation)
            supervisor.set_ball(world)
            world.swing_paw()
            goals += supervisor.judge(world).is_success
        rows.append({"orientation": orientation, "kicks": n, "goals": goals})
    return pd.DataFrame(rows)


def load_kick_trials(goal_distance: Distance) -> pd.DataFrame:
    """Return the trials that come with the course: 1,000 kicks in each of 25 orientations.

    Examples
    --------
    >>> int(load_kick_trials("near").kicks.sum())
    25000
    """
    start_of(goal_distance)
    trials = pd.read_csv(data_file("goal_kicks.csv"))
    chosen = trials[trials.goal_distance == goal_distance]
    return chosen.drop(columns="goal_distance").reset_index(drop=True)


@lru_cache(maxsize=2)
def ball_paths(n: int = 500, seed: int = 0) -> Floats:
    """Kick `n` times on an open field.

    Parameters
    ----------
    n : int
        Number of kicks.
    seed : int
        The seed of the kicks.

    Returns
    -------
    ndarray, shape (n, 12, 2)
        Points at equal distances along each path of the ball, ahead and to the left of the robot
        (mm). The array is cached, so it is read-only.

    References
    ----------
    Thesis 5.1.3.3; `arkaq_edu.field.Kick`.

    Examples
    --------
    >>> paths = ball_paths(n=50)
    >>> bool(1800 < paths[:, -1, 0].mean() < 2800)
    True
    """
    world, paths = World(rng=_checks.integer("seed", seed)), []
    for _ in range(_checks.integer("n", n, 1)):
        world.reset(ROBOT_START, (0.0, -pitch.WIDTH / 2))
        GoalSupervisor.set_ball(world)
        path = np.array(world.swing_paw()) - ROBOT_START[:2]
        run = np.append(0.0, np.hypot(*np.diff(path, axis=0).T).cumsum())
        marks = np.linspace(0.0, run[-1], _POINTS)
        paths.append(np.column_stack([np.interp(marks, run, along) for along in path.T]))
    kicked = np.array(paths)
    kicked.flags.writeable = False
    return kicked


def spread_out(paths: Floats, factor: float) -> Floats:
    """Draw paths toward their mean (a factor below 1), or away from it (above 1).

    Parameters
    ----------
    paths : ndarray, shape (n, points, 2)
    factor : float
        At least 0. With 0 every kick is the mean kick, with 1 nothing changes.

    Returns
    -------
    ndarray, shape (n, points, 2)

    Examples
    --------
    >>> bool(np.ptp(spread_out(ball_paths(50), 0.0), axis=0).max() < 1e-6)
    True
    """
    mean = paths.mean(axis=0)
    return mean + _checks.number("factor", factor, 0) * (paths - mean)


def on_the_field(paths: Floats, distance: float, orientation: ArrayLike) -> Floats:
    """Place paths before the goal.

    Parameters
    ----------
    paths : ndarray, shape (n, points, 2)
        See `ball_paths`.
    distance : float
        Distance of the robot from the middle of the goal line (mm).
    orientation : array_like, shape (n,) or (m, 1)
        Of the goal's middle, seen from the robot (rad, left positive): one for each path, or m
        for all of them.

    Returns
    -------
    ndarray, shape (n, points, 2) or (m, n, points, 2)
        Depth behind the goal line, and place to the left of the goal's middle (mm).

    Examples
    --------
    >>> ahead = np.array([[[0.0, 0.0], [2000.0, 0.0]]])
    >>> on_the_field(ahead, 1500.0, [0.5]).round(1).tolist()
    [[[-1500.0, 0.0], [255.2, -958.9]]]
    """
    heading = -np.asarray(orientation, dtype=float)[..., None]
    c, s = np.cos(heading), np.sin(heading)
    ahead, left = paths[..., 0], paths[..., 1]
    # All depths, then all places across: what follows reads one of them at a time.
    planes = np.array([ahead * c - left * s - distance, ahead * s + left * c])
    return np.moveaxis(planes, 0, -1)


def is_goal(placed: Floats) -> NDArray[np.bool_]:
    """Return which paths cross the goal line between the posts.

    Parameters
    ----------
    placed : ndarray, shape (..., points, 2)
        See `on_the_field`.

    Returns
    -------
    ndarray of bool, shape (...)

    Examples
    --------
    >>> in_wide_short = [[[-500, 0], [500, 0]], [[-500, 0], [500, 900]], [[-500, 0], [20, 0]]]
    >>> is_goal(np.array(in_wide_short, dtype=float))
    array([ True, False, False])
    """
    depth, across = placed[..., 0], placed[..., 1]
    over = depth >= pitch.BALL_RADIUS
    then = over.argmax(axis=-1)[..., None]  # the first point over the line
    before = np.maximum(then - 1, 0)
    d0, d1, y0, y1 = (
        np.take_along_axis(values, at, axis=-1)[..., 0]
        for values in (depth, across)
        for at in (before, then)
    )
    share = (pitch.BALL_RADIUS - d0) / np.where(d1 > d0, d1 - d0, 1.0)
    crossed = y0 + share * (y1 - y0)
    return over.any(axis=-1) & (np.abs(crossed) < pitch.GOAL_WIDTH / 2)


def chance(paths: Floats, distance: float, orientations: ArrayLike) -> Floats:
    """Return the share of paths that score, in each orientation of the goal.

    Parameters
    ----------
    paths : ndarray, shape (n, points, 2)
        See `ball_paths`.
    distance : float
        Distance of the robot from the goal line (mm), in [800, 5000].
    orientations : array_like, shape (m,)
        Of the goal's middle (rad).

    Returns
    -------
    ndarray, shape (m,)

    See Also
    --------
    kick_trials : the same, counted in the physics.

    Examples
    --------
    >>> straight, aside = chance(ball_paths(50), 1850.0, [0.0, 0.4])
    >>> bool(straight > 0.4 > 0.2 > aside)
    True
    """
    _checks.number("distance", distance, MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE)
    column = np.asarray(orientations, dtype=float)[:, None]
    return is_goal(on_the_field(paths, distance, column)).mean(axis=-1)
