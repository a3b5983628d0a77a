"""The noise covariances Q and R, fitted to a recorded track."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import array, shown
from arkaq_edu.kalman.filter import KalmanFilter
from arkaq_edu.kalman.trace import Array

# Largest factor, up or down, between a sigma and its start. A sigma that reaches the lower end
# cannot be distinguished from 0 on the track.
REACH = 1e6


def fit_noise(kf: KalmanFilter, Z: ArrayLike, U: ArrayLike | None = None) -> KalmanFilter:
    """Return a filter with the Q and R that make a recorded track most likely.

    Each standard deviation in Q and R is scaled by a factor of its own. Correlations stay, and
    zeros stay zero. So the given filter sets which noises exist and where the search starts. The
    thesis sets both by hand (section 5.2); see the notes of `KalmanFilter`.

    Parameters
    ----------
    kf : KalmanFilter
        The model and the start of the search, with one Q and one R; A, H and B may change along
        the track. The search ignores its gate, since a refused sighting would not count in the
        likelihood.
    Z : array_like, shape (T, m)
        The recorded sightings; NaN or masked where an entry is missing.
    U : array_like, shape (T, k), optional
        The recorded control inputs.

    Returns
    -------
    KalmanFilter
        A new filter that differs from `kf` in Q and R only.

    Raises
    ------
    ValueError
        If Z or U does not fit the filter, if Z holds fewer numbers than there are sigmas to fit,
        or if Q and R are zero or change along the track.

    Notes
    -----
    The likelihood of the track is the product of the densities of its innovations. L-BFGS-B
    maximizes it over the logarithms of the sigmas, each within a factor of 1e6 of its start.

    References
    ----------
    F. C. Schweppe, "Evaluation of likelihood functions for Gaussian signals", IEEE Transactions
    on Information Theory 11 (1965). Thesis section 2.5.

    Examples
    --------
    A ball at rest, measured with sigma = 30 mm by a filter that assumes 1000:

    >>> Z = np.random.default_rng(0).normal(1500.0, 30.0, (500, 1))
    >>> assumed = KalmanFilter([[1]], [[1]], Q=[[0]], R=[[1000.0**2]])
    >>> round(float(fit_noise(assumed, Z).R[0, 0]) ** 0.5)
    30
    """
    from scipy.optimize import minimize

    def scaled(log_factors: Array, gate: float | None = None) -> KalmanFilter:
        """Return the filter with each sigma multiplied by its factor."""
        factors = np.ones(len(sigmas))
        factors[sigmas > 0] = np.exp(log_factors)
        of_states, of_sightings = np.split(factors, [n])
        Q = kf.Q * np.outer(of_states, of_states)
        R = kf.R * np.outer(of_sightings, of_sightings)
        B = kf.B if kf.B.size else None
        return KalmanFilter(kf.A, kf.H, Q, R, B, kf.x0, kf.P0, gate=gate)

    if not isinstance(kf, KalmanFilter):
        raise ValueError(f"kf must be a KalmanFilter, got {shown(kf)}")
    if kf.Q.ndim == 3 or kf.R.ndim == 3:
        raise ValueError("kf must have one Q and one R, got matrices that change along the track")
    Z = array("Z", Z, None, allow_nan=True)
    n = len(kf.Q)
    sigmas = np.sqrt(np.concatenate([np.diag(kf.Q), np.diag(kf.R)]))
    unknown = int((sigmas > 0).sum())
    if unknown == 0:
        raise ValueError("Q and R must hold some noise to scale, got zeros only")
    seen = int(np.isfinite(scaled(np.zeros(unknown)).filter(Z, U).innovation).sum())
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
