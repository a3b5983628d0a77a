"""Recorded sightings of the ball, and what they say about the senses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.experiments import streams
from arkaq_edu.experiments.approach.task import make_task
from arkaq_edu.experiments.streams import mean_nis as mean_nis


def record_sightings(n: int = 6500, seed: int = 0, period: int | None = None) -> pd.DataFrame:
    """Let the robot walk at random until it has seen the ball `n` times.

    The ball is placed by eq 5.1.

    Parameters
    ----------
    n : int
        Number of sightings.
    seed : int
        The seed of everything drawn.
    period : int, optional
        Cycles between resets; by default that of `TrainingSettings`.

    Returns
    -------
    DataFrame
        See `arkaq_edu.experiments.streams.record`; it measures distance and orientation.

    References
    ----------
    Thesis 5.2.1 and figure 5.6.

    Examples
    --------
    >>> int(record_sightings(n=50, seed=1).visible.sum())
    50
    """
    period = TrainingSettings().period if period is None else _checks.integer("period", period, 1)
    return streams.record(make_task(), n, seed, period)


def load_sightings() -> pd.DataFrame:
    """Return the stream that comes with the course: ``record_sightings()``.

    Examples
    --------
    >>> int(load_sightings().visible.sum())
    6500
    """
    return pd.read_csv(data_file("sightings.csv"))


def patterns(stream: pd.DataFrame) -> NDArray[np.float64]:
    """Return the sightings of a stream as patterns, shape (n, 2), each entry in [-1, 1].

    Examples
    --------
    >>> patterns(load_sightings()).shape
    (6500, 2)
    """
    return streams.patterns(stream, Sensing.consistent())


def calibrate(stream: pd.DataFrame) -> Sensing:
    """Measure the settings of the Kalman filter on a stream.

    Parameters
    ----------
    stream : DataFrame
        See `record_sightings`.

    Returns
    -------
    Sensing
        `B` holds the mean change of distance and orientation under each action, `Q` the variance
        about it. `range_noise` is the standard deviation of the error of the distance, over the
        distance squared.

    Examples
    --------
    >>> measured, used = calibrate(load_sightings()), Sensing.consistent()
    >>> bool(abs(measured.B[0] - np.array(used.B)[0]).max() < 1)
    True
    """
    mean, variance = streams.effects(stream)
    far = stream[(stream.visible == 1) & (stream.true_distance > 1000)]
    error = (far.distance - far.true_distance) / far.true_distance**2
    return replace(
        Sensing.consistent(),
        B=mean.to_numpy().T,
        Q=np.diag(variance),
        range_noise=float(error.std()),
    )
