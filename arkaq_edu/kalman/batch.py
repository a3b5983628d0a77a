"""Many tracks at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array
from arkaq_edu.kalman import compiled
from arkaq_edu.kalman.filter import KalmanFilter, check_growth

# Tracks filtered side by side: enough to keep the processor's vectors full, and few enough that
# their covariances stay in its cache.
BLOCK = 64


def kalman_batch(
    A: ArrayLike,
    H: ArrayLike,
    Q: ArrayLike,
    R: ArrayLike,
    Z: ArrayLike,
    x0: ArrayLike | None = None,
    P0: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Filter N tracks of one system; each result equals that of ``KalmanFilter(...).filter``.

    The gains of eq 2.57 depend on which entries are seen, not on their values. So tracks with the
    same gaps share their gains, and only the states are computed for each track.

    Parameters
    ----------
    A, H, Q, R, x0, P0 : array_like
        The system and the start of every track, as for `KalmanFilter`. If A, H, Q or R changes
        along the tracks, these are filtered one after the other.
    Z : array_like, shape (N, T, m)
        Sightings; NaN or masked where an entry is missing.

    Returns
    -------
    ndarray, shape (N, T, n)
        The estimates after each row.

    Raises
    ------
    ValueError
        As for `KalmanFilter`, if Z has the wrong shape or is infinite, or if a track diverges.

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
    m, n = kf.H.shape[-2:]
    Z = array("Z", Z, (None, None, m), allow_nan=True)
    x = np.empty((*Z.shape[:2], n))
    model = [np.array(values) for values in (kf.A, kf.H, kf.Q, kf.R, kf.x0, kf.P0)]
    constant = all(M.ndim == 2 for M in model[:4])
    groups: dict[bytes, list[int]] = {}
    for i, missing in enumerate(np.isnan(Z)):
        groups.setdefault(missing.tobytes(), []).append(i)
    shared = [group for group in groups.values() if len(group) > 1]
    alone = [group[0] for group in groups.values() if len(group) == 1]
    for tracks in [*shared, alone]:
        for start in range(0, len(tracks), BLOCK):
            block = tracks[start : start + BLOCK]
            found = np.empty((Z.shape[1], n, len(block)))
            side_by_side = np.ascontiguousarray(np.moveaxis(Z[block], 0, 2))
            L = len(block) if tracks is alone else 1
            with np.errstate(all="ignore"):  # as in `KalmanFilter.filter`
                plain = constant and compiled.batch(*model, side_by_side, found, L)
            if plain:
                x[block] = np.moveaxis(found, 2, 0)
            else:
                x[block] = [kf.filter(Z[i]).x for i in block]
    check_growth(x=x)
    return x
