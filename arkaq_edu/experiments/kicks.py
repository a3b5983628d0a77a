"""Kicks: those of a real robot, and simulated ones to compare with them."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.field import GoalSupervisor, Kick, World, bird_view
from arkaq_edu.field.kick import MARK
from arkaq_edu.field.supervisor import ROBOT_START


def load_kicks() -> pd.DataFrame:
    """Return the 50 kicks of a real robot (``data/kicks.csv``).

    Returns
    -------
    DataFrame
        One row per kick. x and y (mm): where the ball came to rest, ahead and to the left of where
        it lay. y_at_2m (mm): how far to the left it passed 2 m, NaN if it stopped before.

    References
    ----------
    M. Hausknecht, AIBO kick work log, UT Austin.

    Examples
    --------
    >>> real = load_kicks()
    >>> len(real), round(float(np.hypot(real.x, real.y).mean()))
    (50, 2222)
    """
    table = 10.0 * pd.read_csv(data_file("kicks.csv"), index_col="kick")
    names = {"x_cm": "x", "y_cm": "y", "lateral_at_2m_cm": "y_at_2m"}
    return table.rename(columns=names)[list(names.values())]


def record_kicks(n: int = 50, seed: int = 0, kick: Kick | None = None) -> pd.DataFrame:
    """Kick `n` times up the simulated field.

    Parameters
    ----------
    n : int
        Number of kicks.
    seed : int
        Seed of all randomness.
    kick : Kick, optional
        The imperfections of the kick.

    Returns
    -------
    DataFrame
        As `load_kicks` returns it.

    References
    ----------
    Thesis 5.1.3.3.

    Examples
    --------
    >>> same = record_kicks(n=3, kick=Kick(spread=0.0, swerve=0.0))
    >>> int(same.round(6).x.nunique())
    1
    """
    _checks.integer("n", n, 1)
    world = World(rng=_checks.integer("seed", seed), kick=kick)
    rows = []
    for _ in range(n):
        world.reset(ROBOT_START, (0.0, -1800.0))
        GoalSupervisor.set_ball(world)
        ahead, aside = np.transpose(world.swing_paw())
        ahead -= ROBOT_START[0] + MARK[0]
        passed = np.interp(2000.0, ahead, aside) if ahead[-1] > 2000.0 else np.nan
        rows.append((ahead[-1], aside[-1], passed))
    return pd.DataFrame(rows, columns=["x", "y", "y_at_2m"])


def ready_to_kick(seed: int, distance: float = 1400.0) -> World:
    """Return a field on which the robot faces the goal with the ball before its paw (figure 5.31).

    Parameters
    ----------
    seed : int
        Seed of all randomness.
    distance : float
        Distance of the goal (mm).

    Examples
    --------
    >>> distance, orientation = ready_to_kick(seed=0).ball_from_robot()
    >>> round(distance)
    246
    """
    world, supervisor = World(rng=seed), GoalSupervisor(distance)
    supervisor.place(world, 0.0)
    supervisor.set_ball(world)
    return world


def photograph_kick(
    after: float, region: tuple[float, float, float, float], seed: int = 0
) -> tuple[NDArray[np.uint8], float]:
    """Kick, and return a picture from above taken during the kick (figure 5.32).

    Parameters
    ----------
    after : float
        Time since the swing began (s), in [0, 3]; the ball rolls longer.
    region : tuple of float
        See `arkaq_edu.field.bird_view`.
    seed : int
        Seed of all randomness.

    Returns
    -------
    picture : ndarray of uint8, shape (rows, columns, 3)
    rolled : float
        How far the ball has rolled (mm).

    Examples
    --------
    >>> picture, rolled = photograph_kick(0.05, (1000.0, 3000.0, -700.0, 700.0))
    >>> rolled  # the paw has not reached the ball
    0.0
    """
    _checks.number("after", after, 0, 3)
    world = ready_to_kick(seed)
    begin, path = world.time, [world.ball]
    photos: list[tuple[NDArray[np.uint8], float]] = []

    def watch() -> None:
        path.append(world.ball)
        if world.time - begin >= after and not photos:
            picture = bird_view(world, sight=False, ball_trail=path, region=region)
            photos.append((picture, math.dist(path[0], path[-1])))

    world.watch = watch
    world.swing_paw()
    return photos[0]


def first_miss(distance: float = 1400.0) -> tuple[World, list[tuple[float, float]]]:
    """Kick at the goal with one seed after the other, until a kick misses (figure 5.33).

    Returns
    -------
    world : World
        The field after the miss.
    path : list of (x, y)
        The path of the ball (mm).

    Examples
    --------
    >>> world, path = first_miss()
    >>> GoalSupervisor(1400.0).judge(world).is_success
    False
    """
    seed, supervisor = 0, GoalSupervisor(distance)
    while True:
        world = ready_to_kick(seed, distance)
        path = world.swing_paw()
        if not supervisor.judge(world).is_success:
            return world, path
        seed += 1
