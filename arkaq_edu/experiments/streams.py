"""Streams of sightings: what the robot saw while it walked about at random."""

from __future__ import annotations

from collections.abc import Sequence

import gymnasium
import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART

VIGILANCES = (0.15, 0.1, 0.075, 0.05, 0.025)
_COLUMNS = [
    "episode",
    "cycle",
    "action",
    "distance",
    "orientation",
    "visible",
    "true_distance",
    "true_orientation",
]


def record_sightings(n: int = 6500, seed: int = 0, period: int | None = None) -> pd.DataFrame:
    """Let the robot walk about at random until it has seen the ball `n` times.

    The recipe is the segmentation phase of the agent (figure 5.6): the ball is placed by eq 5.1,
    the actions are uniform, and the supervisor resets the world after `period` cycles, or as soon
    as the ball is reached or not seen.

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
        A row a look: episode, cycle, the action that led to it (-1 at the start), distance (mm)
        and orientation (rad) as seen, visible (0 or 1), true_distance, true_orientation. Lengths
        are rounded to .001 mm, angles to .000001 rad.

    References
    ----------
    Thesis 5.2.1.

    Examples
    --------
    >>> stream = record_sightings(n=50, seed=1)
    >>> int(stream.visible.sum()), bool((stream.distance[stream.visible == 1] > 200).all())
    (50, True)
    """
    _checks.integer("n", n, 1)
    period = TrainingSettings().period if period is None else _checks.integer("period", period, 1)
    env = gymnasium.make("arkaq_edu:BallApproach-v0", placement="thesis")
    rng = np.random.default_rng(_checks.integer("seed", seed))
    rows: list[tuple[float, ...]] = []
    seen = episode = 0
    while seen < n:
        action, over, cycle = -1, False, 0
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        while True:
            place = info["distance"], info["orientation"]
            rows.append((episode, cycle, action, *observation.tolist(), *place))
            seen += int(observation[2])
            cycle += 1
            if seen == n or over or not observation[2] or cycle > period:
                break
            action = int(rng.integers(3))
            observation, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        episode += 1
    stream = pd.DataFrame(rows, columns=_COLUMNS)
    stream = stream.round(
        {"distance": 3, "orientation": 6, "true_distance": 3, "true_orientation": 6}
    )
    return stream.astype({name: int for name in ("episode", "cycle", "action", "visible")})


def load_sightings() -> pd.DataFrame:
    """Return the stream recorded for the course: ``record_sightings()``, kept in ``data``.

    Returns
    -------
    DataFrame
        See `record_sightings`.

    Examples
    --------
    >>> int(load_sightings().visible.sum())
    6500
    """
    return pd.read_csv(data_file("sightings.csv"))


def patterns(stream: pd.DataFrame) -> NDArray[np.float64]:
    """Return the sightings of a stream as patterns for the network.

    Parameters
    ----------
    stream : DataFrame
        With columns distance, orientation and visible.

    Returns
    -------
    ndarray, shape (n, 2)
        Scaled distance and orientation, each in [-1, 1]; looks without a sighting are left out.

    Examples
    --------
    >>> patterns(load_sightings()).shape
    (6500, 2)
    """
    seen = stream[stream.visible == 1]
    return Sensing.consistent().scale(seen[["distance", "orientation"]].to_numpy())


def count_centers(
    X: ArrayLike,
    vigilances: Sequence[float] = VIGILANCES,
    learning_rate: float | None = None,
) -> pd.Series:
    """Return how many centers one stream of patterns founds at each vigilance.

    Parameters
    ----------
    X : array_like, shape (n, m)
        The patterns, in the order of presentation.
    vigilances : sequence of float
    learning_rate : float, optional
        The update factor eta; by default that of `TrainingSettings`.

    Returns
    -------
    Series of int, indexed by vigilance

    References
    ----------
    Thesis figures 5.10-5.14.

    Examples
    --------
    >>> count_centers([[0.0], [0.2], [0.9]], vigilances=[0.5, 0.1]).tolist()
    [2, 3]
    """
    eta = TrainingSettings().learning_rate if learning_rate is None else learning_rate
    counts = [EuclideanART(rho, eta).fit(X).n_clusters_ for rho in vigilances]
    return pd.Series(counts, index=pd.Index(vigilances, name="vigilance"), name="centers")


def calibrate(stream: pd.DataFrame) -> Sensing:
    """Measure, from a stream that knows the truth, what the Kalman filter should believe.

    Parameters
    ----------
    stream : DataFrame
        As `record_sightings` returns it.

    Returns
    -------
    Sensing
        `B` holds the mean change of distance and orientation under each action, `Q` the variance
        about it, `range_noise` the spread of the distance's error over the distance squared.

    Examples
    --------
    >>> measured, used = calibrate(load_sightings()), Sensing.consistent()
    >>> bool(abs(measured.B[0] - np.array(used.B)[0]).max() < 1)
    True
    """
    truth = stream[["true_distance", "true_orientation"]]
    moved = truth.diff()[stream.cycle > 0]
    by_action = moved.groupby(stream.action[stream.cycle > 0])
    mean = by_action.mean().loc[[0, 1, 2]]
    spread = (moved - by_action.transform("mean")).var()
    seen = stream[stream.visible == 1]
    error = (seen.distance - seen.true_distance) / seen.true_distance**2
    far = seen.true_distance > 1000
    default = Sensing.consistent()
    return Sensing(
        default.low,
        default.high,
        A=default.A,
        H=default.H,
        Q=np.diag(spread),
        R=default.R,
        P0=default.P0,
        B=mean.to_numpy().T,
        range_noise=float(error[far].std()),
    )
