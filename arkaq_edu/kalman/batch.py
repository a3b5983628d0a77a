"""Many tracks at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array
from arkaq_edu.kalman import compiled
from arkaq_edu.kalman.filter import KalmanFilter


def kalman_batch(
    A: ArrayLike,
    H: ArrayLike,
    Q: ArrayLike,
    R: ArrayLike,
    Z: ArrayLike,
    x0: ArrayLike | None = None,
    P0: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Filter N tracks of one system; each comes out as ``KalmanFilter(...).filter`` gives it.

    The gains of eq 2.57 do not depend on what is seen, only on whether it is: so tracks with the
    same gaps share them, and only the state is computed track by track.

    Parameters
    ----------
    A, H, Q, R, x0, P0 : array_like
        The system and the start of every track, as in `KalmanFilter`.
    Z : array_like, shape (N, T, m)
        Sightings; NaN where an entry is missing.

    Returns
    -------
    ndarray, shape (N, T, n)
        The estimates after each row.

    Raises
    ------
    ValueError
        As `KalmanFilter` does, and if Z has the wrong shape or holds an infinity.

    References
    ----------
    Thesis section 2.5, eq 2.55 to 2.59.

    Examples
    --------
    >>> Z = [[[3.0], [2.0]], [[float("nan")], [2.0]]]
    >>> kalman_batch([[1]], [[1]], [[0]], [[1]], Z, x0=[0], P0=[[1]])[:, :, 0]
    array([[1.5       , 1.66666667],
           [0.        , 1.        ]])
    """
    kf = KalmanFilter(A, H, Q, R, x0=x0, P0=P0)
    m, n = kf.H.shape
    Z = np.array(array("Z", Z, (None, None, m), allow_nan=True), order="C")
    groups: dict[bytes, list[int]] = {}
    for i, missing in enumerate(np.isnan(Z)):
        groups.setdefault(missing.tobytes(), []).append(i)
    x = np.empty((*Z.shape[:2], n))
    A, H, x0 = np.array(kf.A), np.array(kf.H), np.array(kf.x0)
    for members in groups.values():
        gains = kf.filter(Z[members[0]]).K
        compiled.follow(A, H, x0, gains, Z, np.array(members), x)
    return x
