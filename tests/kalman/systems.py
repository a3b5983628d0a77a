"""Systems to filter, and tracks with gaps."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu import KalmanFilter, constant_velocity


def random_covariance(rng, size, rank, low_exponent):
    """Return a covariance of a given rank with eigenvalues from 10**low_exponent to 10."""
    basis, _ = np.linalg.qr(rng.normal(size=(size, size)))
    eigenvalues = 10.0 ** rng.uniform(low_exponent, 1, size)
    eigenvalues[rank:] = 0
    P = (basis * eigenvalues) @ basis.T
    return (P + P.T) / 2


@st.composite
def systems(draw, max_states=8, max_measurements=4):
    """Draw a random system, its start and a generator for its sightings.

    Q may be singular, or R nearly so: with both at once S itself is nearly singular, and no two
    ways of computing agree to ten digits.
    """
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(1, max_states))
    m = draw(st.integers(1, min(n, max_measurements)))
    rank = draw(st.integers(0, n))
    lowest = draw(st.sampled_from([0, -3, -12] if rank == n else [0, -3]))
    A = rng.normal(size=(n, n))
    A *= draw(st.sampled_from([0.5, 0.9, 1.0])) / np.abs(np.linalg.eigvals(A)).max()
    system = {
        "A": A,
        "H": rng.normal(size=(m, n)),
        "Q": random_covariance(rng, n, rank, -2),
        "R": random_covariance(rng, m, m, lowest),
        "B": rng.normal(size=(n, draw(st.integers(1, 3)))),
        "x0": rng.normal(size=n),
        "P0": random_covariance(rng, n, n, -1),
    }
    return system, rng


def with_gaps(rng, Z, share):
    """Return Z with a share of its entries missing."""
    return np.where(rng.random(Z.shape) < share, np.nan, Z)


def ball(**changes):
    A, H = constant_velocity(0.64, 2)
    system = {"A": A, "H": H, "Q": np.diag([1.0, 1e-4, 25.0, 1e-3]), "R": np.diag([400.0, 1e-3])}
    system["P0"] = 1e6 * np.eye(4)
    return KalmanFilter(**(system | changes))


def joint_gaussian(system, Z):
    """Return what is known of the states of a track, without any recursion over time.

    Each state is a linear map of x0 and the noises, so all states and sightings are one Gaussian.
    A, H, Q and R may have an entry for each row.

    Returns
    -------
    posterior : callable
        Of the indices of sighted numbers and a row: mean and covariance of the state.
    seen : ndarray
        The indices of all sighted numbers.
    log_likelihood : float
    """
    T, m = Z.shape
    A, H, Q, R = (np.broadcast_to(system[k], (T, *np.shape(system[k])[-2:])) for k in "AHQR")
    x0, P0 = system["x0"], system["P0"]
    n = len(x0)
    to_states = np.zeros((T * n, (T + 1) * n))  # from x0, w_1 .. w_T
    source = np.zeros(((T + 1) * n, (T + 1) * n))
    see, noise = np.zeros((T * m, T * n)), np.zeros((T * m, T * m))
    source[:n, :n] = P0
    previous = np.eye(n, (T + 1) * n)
    for t in range(T):
        states, entries = slice(t * n, (t + 1) * n), slice(t * m, (t + 1) * m)
        previous = A[t] @ previous
        previous[:, (t + 1) * n : (t + 2) * n] += np.eye(n)
        to_states[states] = previous
        source[(t + 1) * n : (t + 2) * n, (t + 1) * n : (t + 2) * n] = Q[t]
        see[entries, states], noise[entries, entries] = H[t], R[t]
    mean = to_states[:, :n] @ x0
    spread = to_states @ source @ to_states.T
    sightings, cross = see @ spread @ see.T + noise, spread @ see.T
    seen = np.flatnonzero(~np.isnan(Z.ravel()))

    def posterior(known, t):
        rows = slice(t * n, (t + 1) * n)
        gain = cross[rows, known] @ np.linalg.inv(sightings[np.ix_(known, known)])
        x = mean[rows] + gain @ (Z.ravel()[known] - (see @ mean)[known])
        return x, spread[rows, rows] - gain @ cross[rows, known].T

    log_likelihood = 0.0
    if seen.size:
        normal = stats.multivariate_normal((see @ mean)[seen], sightings[np.ix_(seen, seen)])
        log_likelihood = normal.logpdf(Z.ravel()[seen])
    return posterior, seen, log_likelihood
