"""Recorded sightings of the goal, what they say about the senses, and their segmentation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART
from arkaq_edu.envs.score_goal import TURN_LEFT, TURN_RIGHT
from arkaq_edu.experiments import streams
from arkaq_edu.experiments.claims import thesis_numbers
from arkaq_edu.experiments.goal.task import make_look_around
from arkaq_edu.experiments.streams import mean_nis as mean_nis

#: The vigilances of figures 5.35 to 5.37.
VIGILANCES = (0.075, 0.06, 0.05)


def record_sightings(n: int = 2000, seed: int = 0, period: int | None = None) -> pd.DataFrame:
    """Let the robot turn at random until it has seen the goal `n` times.

    It starts with the goal straight ahead and turns to the left or to the right. Turns are nearly
    equal, so it sees the goal in islands of orientations, one turn apart.

    Parameters
    ----------
    n : int
        Number of sightings.
    seed : int
        The seed of everything drawn.
    period : int, optional
        Turns between resets; by default that of ``TrainingSettings.goal()``.

    Returns
    -------
    DataFrame
        See `arkaq_edu.experiments.streams.record`; it measures orientation.

    References
    ----------
    Thesis 5.3.1 and figure 5.34.

    Examples
    --------
    >>> record_sightings(n=60, seed=1).visible.sum()
    np.int64(60)
    """
    env = make_look_around(period=period)
    return streams.record(env, n, seed, env.unwrapped.patience - 1)  # type: ignore[attr-defined]


def load_sightings() -> pd.DataFrame:
    """Return the stream that comes with the course: ``record_sightings()``.

    Examples
    --------
    >>> int(load_sightings().visible.sum())
    2000
    """
    return pd.read_csv(data_file("goal_orientations.csv"))


def patterns(stream: pd.DataFrame) -> NDArray[np.float64]:
    """Return the sightings of a stream as patterns, shape (n, 1), in [-1, 1].

    Examples
    --------
    >>> patterns(load_sightings()).shape
    (2000, 1)
    """
    return streams.patterns(stream, Sensing.goal())


def calibrate(stream: pd.DataFrame) -> Sensing:
    """Measure the settings of the Kalman filter on a stream.

    Parameters
    ----------
    stream : DataFrame
        See `record_sightings`.

    Returns
    -------
    Sensing
        `B` holds the mean effect of each turn, `Q` the variance about it, `R` the variance of the
        error of a sighting inside the interval. A kick ends the episode, so its effect is not
        needed.

    Examples
    --------
    >>> measured, used = calibrate(load_sightings()), Sensing.goal()
    >>> bool(abs(measured.B[0][0] - used.B[0][0]) < 0.001)
    True
    """
    mean, variance = streams.effects(stream)
    turn = mean.true_orientation
    default = Sensing.goal()
    seen = stream[(stream.visible == 1) & (stream.true_orientation.abs() <= default.high[0])]
    error = (seen.orientation - seen.true_orientation).var()
    return replace(
        default,
        B=[[float(turn[TURN_LEFT]), float(turn[TURN_RIGHT]), 0.0]],
        Q=[[float(variance.iloc[0])]],
        R=[[float(error)]],
    )


def coverage(X: ArrayLike, width: float = 0.01) -> float:
    """Return the share of the interval [-1, 1] that a stream of patterns covers.

    Parameters
    ----------
    X : array_like, shape (n, 1)
        Scaled orientations.
    width : float
        A place is covered if a pattern is within half this distance.

    Returns
    -------
    float in [0, 1]

    Examples
    --------
    >>> round(coverage([[-0.5], [0.0], [0.004], [0.5]]), 3)
    0.017
    """
    X = np.sort(_checks.array("X", X, (None, 1)).ravel())
    _checks.number("width", width, 0, 2, open_low=True)
    ends = np.clip(np.column_stack([X - width / 2, X + width / 2]), -1.0, 1.0)
    new = np.maximum(ends[1:, 0], ends[:-1, 1])
    covered = (ends[0, 1] - ends[0, 0]) + (ends[1:, 1] - new).clip(0).sum()
    return float(covered / 2)


def find_centers(vigilance: float, X: ArrayLike | None = None) -> NDArray[np.float64]:
    """Segment a stream of patterns and return its centers from right to left.

    Parameters
    ----------
    vigilance : float
        A pattern farther than this from all centers becomes a new center.
    X : array_like, shape (n, 1), optional
        Scaled orientations in their order; by default the recorded stream.

    Returns
    -------
    ndarray, shape (S, 1)
        Scaled orientations, the smallest first.

    Examples
    --------
    >>> find_centers(0.3, [[1.0], [0.0], [0.25]]).tolist()
    [[0.15], [1.0]]
    """
    X = patterns(load_sightings()) if X is None else X
    eta = TrainingSettings.goal().learning_rate
    return np.sort(EuclideanART(vigilance, eta).fit(X).cluster_centers_, axis=0)


def count_fact(n: int, vigilance: float) -> str:
    """Say how many centers there are, and how many the thesis prints.

    Examples
    --------
    >>> count_fact(14, 0.06), count_fact(1, 0.3)
    ('14 centers at vigilance 0.06, the thesis printed 13', '1 center at vigilance 0.3')
    """
    _checks.integer("n", n), _checks.number("vigilance", vigilance, 0, 1)
    printed = thesis_numbers().get(f"goal centers, vigilance {vigilance:g}")
    beside = "" if printed is None else f", the thesis printed {printed}"
    return f"{n} center{'s' if n > 1 else ''} at vigilance {vigilance:g}{beside}"


def cells(centers: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return centers from left to right (rad), and the ends of their cells.

    Parameters
    ----------
    centers : array_like, shape (S, 1)
        Scaled orientations, in any order.

    Returns
    -------
    middles : ndarray, shape (S,)
        Orientations of the centers (rad), the leftmost first: the greatest.
    ends : ndarray, shape (S + 1,)
        The borders between cells. The outer cells end at .5 and -.5.

    Examples
    --------
    >>> cells([[-0.4], [0.8], [0.0]])
    (array([ 0.4,  0. , -0.2]), array([ 0.5,  0.2, -0.1, -0.5]))
    """
    sensing = Sensing.goal()
    middles = np.sort(sensing.unscale(_checks.array("centers", centers, (None, 1))).ravel())[::-1]
    between = (middles[1:] + middles[:-1]) / 2
    return middles, np.concatenate([sensing.high, between, sensing.low])


def load_center_counts() -> pd.DataFrame:
    """Return how many centers thirty streams found: one row a seed, one column a vigilance.

    Each row is ``count_centers(patterns(record_sightings(seed=seed)), VIGILANCES)``.

    References
    ----------
    Thesis figures 5.35-5.37.

    Examples
    --------
    >>> load_center_counts().columns.tolist()
    [0.075, 0.06, 0.05]
    """
    return pd.read_csv(data_file("goal_centers.csv"), index_col="seed").rename(columns=float)
