"""A simulated walk to the ball, and a filter for it: one number, 60 footstep cycles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.kalman.filter import KalmanFilter
from arkaq_edu.kalman.trace import KalmanTrace

START, STEP = 3400.0, -100.0  # distance of the ball at the start, and its change by a footstep: mm
#: True standard deviations in mm: of the start, a footstep, a sighting.
START_NOISE, STEP_NOISE, SIGHTING_NOISE = 100.0, 25.0, 100.0


class Walk(NamedTuple):
    """A simulated walk to the ball, in mm, with one row for each footstep cycle.

    `draws` are uniform in [0, 1): a sighting is missing if its draw is below the dropout.
    """

    truth: NDArray[np.float64]
    Z: NDArray[np.float64]
    U: NDArray[np.float64]
    draws: NDArray[np.float64]

    def sightings(self, dropout: float) -> NDArray[np.float64]:
        """Return `Z` with a share of its rows missing (NaN). A larger share holds a smaller one.

        Examples
        --------
        >>> int(np.isnan(simulated_walk().sightings(0.3)).sum())
        17
        """
        return np.where(self.draws[:, np.newaxis] < dropout, np.nan, self.Z)

    def fact(self, Z: NDArray[np.float64], trace: KalmanTrace) -> str:
        """Say whether a filter's NIS is right, and how far its estimate and the sightings are off.

        Examples
        --------
        >>> walk = simulated_walk()
        >>> walk.fact(walk.Z, walk_filter(r=100.0, q=25.0).filter(walk.Z, walk.U))
        'mean NIS 1.10 where 0.67 to 1.39 is right; estimate 60 mm off, sightings 102 mm'
        """
        mean, low, high = trace.nis_band()
        ours, theirs = (
            np.sqrt(np.nanmean((found - self.truth) ** 2)) for found in (trace.x[:, 0], Z[:, 0])
        )
        return (
            f"mean NIS {mean:.2f} where {low:.2f} to {high:.2f} is right; "
            f"estimate {ours:.0f} mm off, sightings {theirs:.0f} mm"
        )


def simulated_walk(rng: np.random.Generator | int | None = 0) -> Walk:
    """Return a walk of 60 cycles: 15 footsteps, 15 cycles at rest, and both again.

    Parameters
    ----------
    rng : numpy.random.Generator or int
        Source of the noise; the explorer uses the seed 0.

    Returns
    -------
    Walk
        ``truth`` (60,), ``Z`` (60, 1), ``U`` (60, 1) with 1 for a footstep, ``draws`` (60,).

    References
    ----------
    Thesis, equations 2.49 to 2.52, with A = H = 1.

    Examples
    --------
    >>> walk = simulated_walk()
    >>> len(walk.truth), int(walk.U.sum())
    (60, 30)
    """
    rng = np.random.default_rng(rng)
    U = np.repeat([1.0, 0.0, 1.0, 0.0], 15)
    start = START + START_NOISE * rng.standard_normal()
    truth = start + np.cumsum(STEP * U + STEP_NOISE * rng.standard_normal(len(U)))  # eq 2.51
    Z = truth + SIGHTING_NOISE * rng.standard_normal(len(U))  # eq 2.52
    return Walk(truth, Z[:, np.newaxis], U[:, np.newaxis], rng.random(len(U)))


def walk_filter(r: float, q: float) -> KalmanFilter:
    """Return a filter for the simulated walk that assumes these standard deviations.

    Parameters
    ----------
    r, q : float
        Of a sighting and of a footstep, in mm, at least 0: R is r**2 and Q is q**2.

    Returns
    -------
    KalmanFilter
        With the footsteps as ``B`` and the true variance of the start as ``P0``.

    Raises
    ------
    ValueError
        If `r` or `q` is negative.

    Examples
    --------
    >>> walk_filter(r=100.0, q=25.0).R
    array([[10000.]])
    """
    r, q = _checks.number("r", r, 0), _checks.number("q", q, 0)
    return KalmanFilter(
        [[1]], [[1]], [[q**2]], [[r**2]], [[STEP]], x0=[START], P0=[[START_NOISE**2]]
    )
