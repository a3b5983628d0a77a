"""The noises Q and R, learned from a recorded track."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu.kalman.filter import Array, KalmanFilter

# No sigma is sought further from its start than this factor, up or down.
REACH = 1e6


def fit_noise(kf: KalmanFilter, Z: ArrayLike, U: ArrayLike | None = None) -> KalmanFilter:
    """Return the filter with the Q and R under which a recorded track is most likely.

    Each standard deviation in Q and R is scaled by a factor of its own; correlations stay, and
    what is 0 stays 0: so the given filter says which noises there are, and where the search
    starts. The thesis sets both by hand (section 5.2); see the notes of `KalmanFilter`.

    Parameters
    ----------
    kf : KalmanFilter
        The model and the start of the search. Its gate is left out while searching, since a
        sighting that is refused would not count.
    Z : array_like, shape (T, m)
        The recorded sightings; NaN where an entry is missing.
    U : array_like, shape (T, k), optional
        The recorded control inputs.

    Returns
    -------
    KalmanFilter
        A new filter, the same but for Q and R. Its ``filter(Z, U)`` is the most likely trace.

    Raises
    ------
    ValueError
        If Z or U does not fit the filter, if Z holds fewer numbers than there are sigmas to find,
        or if neither Q nor R has any noise.

    Notes
    -----
    The likelihood of the track is the product of the densities of its innovations, and is climbed
    in the logarithms of the sigmas (L-BFGS-B). A sigma that ends a factor of 1e6 below its start
    cannot be told from 0 on this track.

    References
    ----------
    F. C. Schweppe, "Evaluation of likelihood functions for Gaussian signals", IEEE Transactions
    on Information Theory 11 (1965). Thesis section 2.5, eq 2.51 and 2.52.

    Examples
    --------
    A ball that stands still, seen with sigma = 30 mm by a filter that was told 1000:

    >>> Z = np.random.default_rng(0).normal(1500.0, 30.0, (500, 1))
    >>> told = KalmanFilter([[1]], [[1]], Q=[[0]], R=[[1000.0**2]])
    >>> round(float(fit_noise(told, Z).R[0, 0]) ** 0.5)
    30
    """
    from scipy.optimize import minimize

    def scaled(log_factors: Array, gate: float | None = None) -> KalmanFilter:
        """Return the filter whose sigmas are the given ones times the factors."""
        factors = np.ones(len(sigmas))
        factors[sigmas > 0] = np.exp(log_factors)
        of_states, of_sightings = np.split(factors, [n])
        Q = kf.Q * np.outer(of_states, of_states)
        R = kf.R * np.outer(of_sightings, of_sightings)
        B = kf.B if kf.B.size else None
        return KalmanFilter(kf.A, kf.H, Q, R, B, kf.x0, kf.P0, gate=gate)

    n = len(kf.A)
    sigmas = np.sqrt(np.concatenate([np.diag(kf.Q), np.diag(kf.R)]))
    unknown = int((sigmas > 0).sum())
    seen = int(np.isfinite(scaled(np.zeros(unknown)).filter(Z, U).innovation).sum())
    if unknown == 0:
        raise ValueError("Q and R must hold some noise to scale, got zeros only")
    if seen < unknown:
        raise ValueError(f"Z must hold at least {unknown} sighted numbers, got {seen}")
    best = minimize(
        lambda log_factors: -scaled(log_factors).filter(Z, U).log_likelihood / seen,
        np.zeros(unknown),
        method="L-BFGS-B",
        jac="3-point",
        bounds=[(-math.log(REACH), math.log(REACH))] * unknown,
    )
    return scaled(best.x, kf.gate)
