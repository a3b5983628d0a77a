"""What a filter computed along a track, and whether its innovations are as large as it expects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.kalman.consistency import chi_square_band

Array = NDArray[np.float64]


@dataclass(frozen=True)
class KalmanTrace:
    """Everything a filter computed along a track of T rows, with n states and m measurements.

    Attributes
    ----------
    x, P : ndarray, shapes (T, n) and (T, n, n)
        Estimate and covariance after each row (posterior).
    x_prior, P_prior : ndarray, shapes (T, n) and (T, n, n)
        The same before the row's sighting was used (prediction).
    innovation : ndarray, shape (T, m)
        z - H x_prior; NaN where an entry of z is missing.
    S : ndarray, shape (T, m, m)
        Covariance of the innovation, H P_prior H' + R.
    K : ndarray, shape (T, n, m)
        Gain as it was used: zeros in the column of a missing entry.
    nis : ndarray, shape (T,)
        Normalized innovation squared, innovation' S^-1 innovation; NaN for a missing sighting.
    accepted : ndarray of bool, shape (T,)
        Whether the row's sighting was used: False if it is missing or failed the gate.
    log_likelihood : float
        Log probability density of all sightings that were used.
    A, Q : ndarray, shape (n, n) or (T, n, n)
        Of the filter, for `KalmanFilter.smooth`.
    """

    x: Array
    P: Array
    x_prior: Array
    P_prior: Array
    innovation: Array
    S: Array
    K: Array
    nis: Array
    accepted: NDArray[np.bool_]
    log_likelihood: float
    A: Array
    Q: Array

    def nis_band(self, probability: float = 0.95) -> tuple[float, float, float]:
        """Return the mean NIS of the track and the interval expected of a correct filter.

        If A, H, Q and R are correct, the innovations are independent and the sum of their NIS is
        chi-square distributed. A mean above the band means that the filter is overconfident (Q or R
        too small). A mean below it means that Q or R is too large. A gate keeps the largest NIS
        out of the mean.

        Parameters
        ----------
        probability : float, default 0.95
            Probability in (0, 1) that the mean of a correct filter lies in the band.

        Returns
        -------
        mean, low, high : float
            Over the rows whose sighting was used. NaN if there are none.

        Raises
        ------
        ValueError
            If `probability` is not in (0, 1).

        References
        ----------
        Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with Applications to Tracking and
        Navigation (2001), section 5.4.

        Examples
        --------
        A filter that assumes sigma = 10 mm where it is 30:

        >>> from arkaq_edu import KalmanFilter
        >>> seen = np.random.default_rng(0).normal(0.0, 30.0, (200, 1))
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[10.0**2]])
        >>> mean, low, high = kf.filter(seen).nis_band()
        >>> print(f"{mean:.1f}, but a correct filter stays in [{low:.2f}, {high:.2f}]")
        8.3, but a correct filter stays in [0.81, 1.21]
        """
        rows = int(self.accepted.sum())
        entries = int((~np.isnan(self.innovation[self.accepted])).sum())
        if rows == 0:
            return np.nan, np.nan, np.nan
        low, high = chi_square_band(entries / rows, rows, probability)
        return float(self.nis[self.accepted].mean()), low, high

    def running_nis(self) -> tuple[NDArray[np.intp], Array, Array, Array]:
        """Return the mean NIS of the first 1, 2, ... sightings, and the 95 % band for each.

        Each sighting must be complete or missing altogether.

        Returns
        -------
        count : ndarray of int, shape (k,)
            Number of sightings used: 1 to k.
        mean : ndarray, shape (k,)
            Their mean NIS.
        low, high : ndarray, shape (k,)
            The band in which a correct filter keeps the mean with probability 0.95.

        References
        ----------
        As for `nis_band`.

        Examples
        --------
        >>> from arkaq_edu import KalmanFilter
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[3]])
        >>> count, mean, low, high = kf.filter([[4.0], [float("nan")], [3.0]]).running_nis()
        >>> count, mean.round(2), high.round(2)
        (array([1, 2]), array([4., 2.]), array([5.02, 3.69]))
        """
        used = self.nis[self.accepted]
        count = np.arange(1, len(used) + 1)
        bands = [chi_square_band(self.innovation.shape[1], int(rows)) for rows in count]
        low, high = np.reshape(bands, (-1, 2)).T
        return count, np.cumsum(used) / count, low, high
