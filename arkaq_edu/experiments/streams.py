"""Streams of sightings: what a robot saw while it acted at random.

The problems record streams of their own (`approach.record_sightings`, `goal.record_sightings`).
Here is what both have in common.
"""

from __future__ import annotations

from collections.abc import Sequence

import gymnasium
import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Estimator, Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART

#: The vigilances of figures 5.10 to 5.14.
VIGILANCES = (0.15, 0.1, 0.075, 0.05, 0.025)

_DIGITS = {"distance": 3, "orientation": 6}  # .001 mm, .000001 rad


def record(env: gymnasium.Env, n: int, seed: int, period: int) -> pd.DataFrame:
    """Act at random in a task until its object has been seen `n` times.

    This is the segmentation phase of the agent (figures 5.6 and 5.34). The supervisor resets the
    world after `period` cycles, or as soon as the episode ends or the object is not seen.

    Parameters
    ----------
    env : gymnasium.Env
        Its observations are the measurements, then 1 with a sighting and 0 without.
    n : int
        Number of sightings.
    seed : int
        The seed of everything drawn.
    period : int
        Cycles between resets.

    Returns
    -------
    DataFrame
        One row a look: episode, cycle, action (what led to this look, -1 at the start), the
        measurements (mm, rad), visible (0 or 1), and the true values, such as true_distance.

    Examples
    --------
    >>> stream = record(gymnasium.make("arkaq_edu:BallApproach-v0"), n=50, seed=1, period=20)
    >>> int(stream.visible.sum()), bool((stream.distance[stream.visible == 1] > 200).all())
    (50, True)
    """
    _checks.integer("n", n, 1)
    rng = np.random.default_rng(_checks.integer("seed", seed))
    names = list(_DIGITS)[-(env.observation_space.shape[0] - 1) :]  # type: ignore[index]
    rows: list[tuple[float, ...]] = []
    seen = episode = 0
    while seen < n:
        action, over, cycle = -1, False, 0
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        while True:
            truth = (info[name] for name in names)
            rows.append((episode, cycle, action, *observation.tolist(), *truth))
            seen += int(observation[-1])
            cycle += 1
            if seen == n or over or not observation[-1] or cycle > period:
                break
            action = int(rng.integers(env.action_space.n))  # type: ignore[attr-defined]
            observation, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        episode += 1
    true = [f"true_{name}" for name in names]
    stream = pd.DataFrame(rows, columns=["episode", "cycle", "action", *names, "visible", *true])
    digits = {name: _DIGITS[name.removeprefix("true_")] for name in [*names, *true]}
    return stream.round(digits).astype(
        dict.fromkeys(["episode", "cycle", "action", "visible"], int)
    )


def measurements(stream: pd.DataFrame) -> list[str]:
    """Return the names of what is measured in a stream.

    Examples
    --------
    >>> measurements(pd.DataFrame(columns=["orientation", "visible", "true_orientation"]))
    ['orientation']
    """
    return [name for name in _DIGITS if name in stream]


def patterns(stream: pd.DataFrame, sensing: Sensing) -> NDArray[np.float64]:
    """Return the sightings of a stream as patterns, shape (n, m), each entry in [-1, 1].

    Looks without a sighting are left out.

    Examples
    --------
    >>> stream = pd.DataFrame({"orientation": [0.25, 0.0], "visible": [1, 0]})
    >>> patterns(stream, Sensing.goal())
    array([[0.5]])
    """
    seen = stream[stream.visible == 1]
    return sensing.scale(seen[measurements(stream)].to_numpy())


def effects(stream: pd.DataFrame) -> tuple[pd.DataFrame, pd.Series]:
    """Return what each action does to the true values: its mean, and the variance about it.

    Parameters
    ----------
    stream : DataFrame
        See `record`.

    Returns
    -------
    mean : DataFrame
        One row an action, one column a measurement: B of the Kalman filter, transposed.
    variance : Series
        One entry a measurement: the diagonal of Q.

    Examples
    --------
    >>> stream = pd.DataFrame({"cycle": [0, 1, 2], "action": [-1, 0, 0],
    ...                        "orientation": 0.0, "true_orientation": [0.0, 0.1, 0.3]})
    >>> mean, variance = effects(stream)
    >>> mean.to_numpy().round(3), variance.to_numpy().round(3)
    (array([[0.15]]), array([0.005]))
    """
    truth = stream[[f"true_{name}" for name in measurements(stream)]]
    moved = truth.diff()[stream.cycle > 0]
    by_action = moved.groupby(stream.action[stream.cycle > 0])
    return by_action.mean(), (moved - by_action.transform("mean")).var()


def count_centers(
    X: ArrayLike,
    vigilances: Sequence[float] = VIGILANCES,
    learning_rate: float | None = None,
) -> pd.Series:
    """Return how many centers a stream of patterns founds at each vigilance.

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
    Thesis figures 5.10-5.14 and 5.35-5.37.

    Examples
    --------
    >>> count_centers([[0.0], [0.2], [0.9]], vigilances=[0.5, 0.1]).tolist()
    [2, 3]
    """
    eta = TrainingSettings().learning_rate if learning_rate is None else learning_rate
    vigilances = _checks.array("vigilances", vigilances, (None,)).tolist()
    counts = [EuclideanART(rho, eta).fit(X).n_clusters_ for rho in vigilances]
    return pd.Series(counts, index=pd.Index(vigilances, name="vigilance"), name="centers")


def mean_nis(stream: pd.DataFrame, sensing: Sensing) -> float:
    """Return the mean normalized innovation squared of a filter on a stream.

    Parameters
    ----------
    stream : DataFrame
        See `record`.
    sensing : Sensing
        The filter's settings.

    Returns
    -------
    float
        The number of measurements if innovations are as large as the filter expects, more if the
        filter is overconfident. The first sighting of an episode, which meets the prior, does not
        count.

    References
    ----------
    Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001,
    section 5.4.

    Examples
    --------
    >>> from arkaq_edu.experiments.approach import load_sightings
    >>> bool(1.7 < mean_nis(load_sightings(), Sensing.consistent()) < 2.3)
    True
    """
    senses, values = Estimator(sensing), []
    looks = stream[[*measurements(stream), "visible"]].to_numpy(dtype=float)
    for look, cycle, action in zip(looks, stream.cycle, stream.action, strict=True):
        if cycle == 0:
            senses.reset()
        senses.observe(look, None if cycle == 0 else int(action))
        if cycle > 0 and look[-1]:
            values.append(senses.kalman.nis)
    return float(np.mean(values))
