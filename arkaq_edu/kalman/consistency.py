"""Does a filter know how wrong it is? Its NIS, measured by its own covariances, must tell.

The NIS (normalized innovation squared) of each sighting is part of `KalmanTrace`. If A, H, Q and R
are correct, it is chi-square distributed.
"""

from __future__ import annotations

from arkaq_edu._checks import LARGEST, integer, number


def chi_square_quantile(probability: float, dof: float) -> float:
    """Return the value below which a chi-square variable lies with the given probability.

    Examples
    --------
    >>> round(chi_square_quantile(0.95, 2), 3)
    5.991
    """
    from scipy.special import gammaincinv

    return float(2 * gammaincinv(dof / 2, probability))


def chi_square_band(dof: float, count: int = 1, probability: float = 0.95) -> tuple[float, float]:
    """Return the band that holds the mean of independent NIS of a correct filter.

    Parameters
    ----------
    dof : float
        Degrees of freedom of each NIS: the number of measurements seen, from 1e-100 to 1e100.
    count : int, default 1
        Number of values averaged, at least 1. The NIS along a track are independent.
    probability : float, default 0.95
        Probability in (0, 1) that the mean lies in the band; the rest is split evenly.

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
    The more values, the narrower the band:

    >>> for count in (1, 100):
    ...     low, high = chi_square_band(2, count)
    ...     print(f"[{low:.2f}, {high:.2f}]")
    [0.05, 7.38]
    [1.63, 2.41]
    """
    dof = number("dof", dof, 1 / LARGEST, LARGEST)
    count = integer("count", count, 1)
    probability = number("probability", probability, 0, 1, open_low=True, open_high=True)
    tail = (1 - probability) / 2
    low, high = (chi_square_quantile(p, dof * count) / count for p in (tail, 1 - tail))
    return low, high
