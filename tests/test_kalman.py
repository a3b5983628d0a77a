"""The Kalman filter against filterpy, closed forms and its own promises."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter as Peer
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu import KalmanFilter


def random_covariance(rng, size, rank, low_exponent):
    """Return a covariance of a given rank with eigenvalues from 10**low_exponent to 10."""
    basis, _ = np.linalg.qr(rng.normal(size=(size, size)))
    eigenvalues = 10.0 ** rng.uniform(low_exponent, 1, size)
    eigenvalues[rank:] = 0
    P = (basis * eigenvalues) @ basis.T
    return (P + P.T) / 2


@st.composite
def systems(draw, max_states=8, max_measurements=4):
    """Draw a random system, its start and a generator for its sightings."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(1, max_states))
    m = draw(st.integers(1, min(n, max_measurements)))
    A = rng.normal(size=(n, n))
    A *= draw(st.sampled_from([0.5, 0.9, 1.0])) / np.abs(np.linalg.eigvals(A)).max()
    system = {
        "A": A,
        "H": rng.normal(size=(m, n)),
        "Q": random_covariance(rng, n, draw(st.integers(0, n)), -2),
        "R": random_covariance(rng, m, m, draw(st.sampled_from([0, -3, -6]))),
        "B": rng.normal(size=(n, draw(st.integers(1, 3)))),
        "x0": rng.normal(size=n),
        "P0": random_covariance(rng, n, n, -1),
    }
    return system, rng


def peer_of(system):
    n, m = system["A"].shape[0], system["H"].shape[0]
    peer = Peer(dim_x=n, dim_z=m)
    peer.F, peer.H, peer.Q, peer.R = (system[name] for name in "AHQR")
    peer.B, peer.x, peer.P = system["B"], system["x0"].copy(), system["P0"].copy()
    return peer


def assert_close(ours, theirs, tolerance=1e-10, beside=0.0):
    """Compare arrays by their largest entry, or by the size of what they are the sum of."""
    scale = max(np.abs(theirs).max(), np.abs(beside).max())
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * scale)


@settings(max_examples=150, deadline=None)
@given(systems())
def test_agrees_with_filterpy(drawn):
    system, rng = drawn
    kf, peer = KalmanFilter(**system), peer_of(system)
    Z = rng.normal(size=(20, system["H"].shape[0]))
    U = rng.normal(size=(20, system["B"].shape[1]))
    trace = kf.filter(Z, U)
    log_likelihood, tolerance = 0.0, 1e-10
    for t, (z, u) in enumerate(zip(Z, U, strict=True)):
        peer.predict(u)
        assert_close(trace.x_prior[t], peer.x, tolerance, beside=1)
        assert_close(trace.P_prior[t], peer.P, tolerance)
        assert_close(kf.predict(u), peer.x, tolerance, beside=1)
        shrunk = np.abs(peer.P).max()
        peer.update(z)
        # No two ways of computing agree to more digits than S and the fall of P leave them.
        shrunk /= np.abs(peer.P).max()
        tolerance = max(tolerance, 1e-14 * shrunk, 1e-14 * np.linalg.cond(peer.S))
        log_likelihood += peer.log_likelihood
        assert_close(kf.update(z), peer.x, tolerance, beside=1)
        for name, theirs, beside in [
            ("x", peer.x, 1), ("P", peer.P, 0), ("K", peer.K, 0), ("S", peer.S, 0),
            ("innovation", peer.y, 1),
        ]:  # fmt: skip
            assert_close(getattr(trace, name)[t], theirs, tolerance, beside)
            assert_close(getattr(kf, name), getattr(trace, name)[t], tolerance, beside)
        assert trace.nis[t] == pytest.approx(peer.mahalanobis**2, rel=100 * tolerance)
    assert trace.log_likelihood == pytest.approx(log_likelihood, rel=100 * tolerance)
