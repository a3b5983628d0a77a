"""Kicks: those of a real robot, and simulated ones to set beside them."""

from __future__ import annotations

import numpy as np
import pandas as pd

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.field import GoalSupervisor, Kick, World
from arkaq_edu.field.kick import MARK
from arkaq_edu.field.supervisor import ROBOT_START


def load_kicks() -> pd.DataFrame:
    """Return the 50 kicks of a real robot (``data/kicks.csv``).

    Returns
    -------
    DataFrame
        A row a kick: x and y (mm), where the ball came to rest, ahead and aside of where it lay;
        y_at_2m (mm), how far aside it was when it passed 2 m, NaN where it stopped short.

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
        The seed of everything drawn.
    kick : Kick, optional
        The imperfections of the kick.

    Returns
    -------
    DataFrame
        As of `load_kicks`.

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
    world = World(rng=seed, kick=kick)
    rows = []
    for _ in range(n):
        world.reset(ROBOT_START, (0.0, -1800.0))
        GoalSupervisor.set_ball(world)
        ahead, aside = np.transpose(world.swing_paw())
        ahead -= ROBOT_START[0] + MARK[0]
        passed = np.interp(2000.0, ahead, aside) if ahead[-1] > 2000.0 else np.nan
        rows.append((ahead[-1], aside[-1], passed))
    return pd.DataFrame(rows, columns=["x", "y", "y_at_2m"])
