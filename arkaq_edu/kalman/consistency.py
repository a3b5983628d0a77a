"""Does a filter know how wrong it is? Its errors, measured by its own covariances, must be right.

The NIS (normalized innovation squared) of a sighting is part of `KalmanTrace`; the NEES
(normalized estimation error squared) needs the truth. In a filter whose A, H, Q and R are right
both are chi-square distributed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, integer, number
from arkaq_edu.kalman import compiled


def chi_square_quantile(probability: float, dof: float) -> float:
    """Return the value that a chi-square variable stays below with some probability.

    Examples
    --------
    >>> round(chi_square_quantile(0.95, 2), 3)
    5.991
    """
    from scipy.special import gammaincinv

    return float(2 * gammaincinv(dof / 2, probability))


def chi_square_band(dof: float, count: int = 1, probability: float = 0.95) -> tuple[float, float]:
    """Return the band in which the mean of independent NIS or NEES of a right filter falls.

    Parameters
    ----------
    dof : float
        Degrees of freedom of each: the measurements seen (NIS) or the states (NEES), above 0.
    count : int, default 1
        Number of values averaged, at least 1. They must be independent: NIS along a track are,
        NEES along a track are not, so average NEES over runs.
    probability : float, default 0.95
        With which the mean falls inside, in (0, 1); the rest is split evenly above and below.

    Returns
    -------
    low, high : float

    Raises
    ------
    ValueError
        If an argument is out of its range.

    References
    ----------
    Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with Applications to Tracking and
    Navigation (2001), section 5.4. Not in the thesis.

    Examples
    --------
    The more values, the narrower:

    >>> for count in (1, 100):
    ...     low, high = chi_square_band(2, count)
    ...     print(f"[{low:.2f}, {high:.2f}]")
    [0.05, 7.38]
    [1.63, 2.41]
    """
    dof = number("dof", dof, 0, open_low=True, open_high=True)
    count = integer("count", count, 1)
    probability = number("probability", probability, 0, 1, open_low=True, open_high=True)
    tail = (1 - probability) / 2
    low, high = (chi_square_quantile(p, dof * count) / count for p in (tail, 1 - tail))
    return low, high


def nees(truth: ArrayLike, x: ArrayLike, P: ArrayLike) -> NDArray[np.float64]:
    """Return the squared estimation errors, each measured by its covariance: e' P^-1 e.

    Parameters
    ----------
    truth, x : array_like, shape (T, n)
        True and estimated states.
    P : array_like, shape (T, n, n)
        Covariances of the estimates.

    Returns
    -------
    ndarray, shape (T,)
        On average n if the filter is right.

    Raises
    ------
    ValueError
        If the shapes do not fit or an entry is not finite.

    References
    ----------
    As for `chi_square_band`.

    Examples
    --------
    >>> nees(truth=[[3.0, 1.0]], x=[[1.0, 1.0]], P=[[[4.0, 0.0], [0.0, 1.0]]])
    array([1.])
    """
    estimates = array("x", x, (None, None))
    T, n = estimates.shape
    errors = np.ascontiguousarray(array("truth", truth, (T, n)) - estimates)
    covariances = np.array(array("P", P, (T, n, n)), order="C")
    norms = np.empty(T)
    compiled.squared_norms(np.zeros((len(compiled.PLANES), n, n)), errors, covariances, norms)
    return norms
