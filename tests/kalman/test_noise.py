"""What is inferred from a whole track: likelihood, smoothing, consistency, the noises."""

from __future__ import annotations

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter as Peer
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu import KalmanFilter, constant_velocity
from arkaq_edu.kalman import chi_square_band, fit_noise
from tests.kalman.systems import joint_gaussian


@st.composite
def small_problems(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, m, T = draw(st.integers(1, 3)), draw(st.integers(1, 2)), 6
    root_Q = rng.normal(size=(n, draw(st.integers(1, n))))  # Q may be singular
    root_R, root_P = rng.normal(size=(m, m)), rng.normal(size=(n, n))
    turn, _ = np.linalg.qr(rng.normal(size=(n, n)))
    system = {
        "A": turn * rng.uniform(0.5, 1.1, n),
        "H": rng.normal(size=(m, n)),
        "Q": root_Q @ root_Q.T,
        "R": root_R @ root_R.T + 0.1 * np.eye(m),
        "x0": rng.normal(size=n),
        "P0": root_P @ root_P.T,
    }
    Z = rng.normal(size=(T, m))
    Z[rng.random((T, m)) < draw(st.sampled_from([0, 0.3]))] = np.nan
    return system, Z


@settings(max_examples=60, deadline=None)
@given(small_problems())
def test_filter_smoother_and_likelihood_are_those_of_the_joint_gaussian(problem):
    system, Z = problem
    T = len(Z)
    kf = KalmanFilter(**system)
    trace = kf.filter(Z)
    smoothed, sure = kf.smooth(trace)
    posterior, seen, expected = joint_gaussian(system, Z)
    for t in range(T):
        until_now = seen[seen < (t + 1) * Z.shape[1]]
        for (x, P), ours_x, ours_P in [
            (posterior(until_now, t), trace.x[t], trace.P[t]),
            (posterior(seen, t), smoothed[t], sure[t]),
        ]:
            np.testing.assert_allclose(ours_x, x, rtol=1e-8, atol=1e-8)
            np.testing.assert_allclose(ours_P, P, rtol=1e-8, atol=1e-8)
    assert trace.log_likelihood == pytest.approx(expected, rel=1e-9, abs=1e-9)


def ball(Q, R, **changes):
    A, H = constant_velocity(0.64, 2)
    return KalmanFilter(A, H, Q, R, x0=[2000, 0, 0, 0], P0=np.diag([1e4, 0.1, 1e4, 0.1]), **changes)


Q_TRUE = np.diag([4.0, 1e-5, 900.0, 1e-3])
R_TRUE = np.array([[400.0, 0.15], [0.15, 4e-4]])


def simulate(rng, kf, T):
    """Return the true states and the sightings of a system that is what the filter thinks."""
    x = rng.multivariate_normal(kf.x0, kf.P0)
    states, Z = [], []
    for _ in range(T):
        x = kf.A @ x + rng.multivariate_normal(np.zeros(len(x)), kf.Q)
        states.append(x)
        Z.append(kf.H @ x + rng.multivariate_normal(np.zeros(len(kf.H)), kf.R))
    return np.array(states), np.array(Z)


def test_smoothing_agrees_with_filterpy_over_a_long_track():
    kf = ball(Q_TRUE, R_TRUE)
    _, Z = simulate(np.random.default_rng(0), kf, 300)
    trace = kf.filter(Z)
    x, P = kf.smooth(trace)
    peer = Peer(dim_x=4, dim_z=2)
    peer.F, peer.Q = kf.A, kf.Q
    theirs_x, theirs_P, _, _ = peer.rts_smoother(trace.x, trace.P)
    np.testing.assert_allclose(x, theirs_x, rtol=1e-9)
    np.testing.assert_allclose(P, theirs_P, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(P, P.transpose(0, 2, 1))


def test_smoothing_knows_more_than_filtering_and_is_nearer_the_truth():
    kf = ball(Q_TRUE, R_TRUE)
    truth, Z = simulate(np.random.default_rng(1), kf, 500)
    trace = kf.filter(Z)
    before = trace.x.copy()
    x, P = kf.smooth(trace)
    np.testing.assert_array_equal(trace.x, before)
    sigma = np.sqrt(np.einsum("tii->ti", trace.P) / np.einsum("tii->ti", P))
    assert (sigma >= 1 - 1e-9).all() and sigma[:-1].mean() > 1.2
    assert (((x - truth) ** 2).mean(axis=0) < ((trace.x - truth) ** 2).mean(axis=0)).all()
    np.testing.assert_array_equal(x[-1], trace.x[-1])


def test_bands_are_those_of_the_chi_square_distribution():
    for dof, count, probability in [(2, 1, 0.95), (3, 50, 0.99), (1.5, 7, 0.5)]:
        tail = (1 - probability) / 2
        expected = stats.chi2.ppf([tail, 1 - tail], dof * count) / count
        np.testing.assert_allclose(chi_square_band(dof, count, probability), expected, rtol=1e-12)


def test_a_right_filter_is_consistent_and_wrong_ones_are_not():
    rng = np.random.default_rng(3)
    right = ball(Q_TRUE, R_TRUE)
    runs = [simulate(rng, right, 60) for _ in range(100)]
    errors = []
    for states, Z in runs:
        trace = right.filter(Z)
        e = states - trace.x
        errors.append(np.einsum("ti,tij,tj->t", e, np.linalg.inv(trace.P), e))
    errors = np.array(errors)
    low, high = chi_square_band(4, len(runs), 0.9999)
    assert low < errors.mean(axis=0).min() and errors.mean(axis=0).max() < high

    _, Z = simulate(rng, right, 2000)
    Z[rng.random(Z.shape) < 0.2] = np.nan
    mean, low, high = right.filter(Z).nis_band(0.999)
    assert low < mean < high
    for wrong, side in [(ball(Q_TRUE, R_TRUE / 4), 1), (ball(Q_TRUE, R_TRUE * 4), -1)]:
        mean, low, high = wrong.filter(Z).nis_band(0.999)
        assert (mean > high) if side > 0 else (mean < low)


def test_the_thesis_noise_is_inconsistent_with_the_swings_it_reports():
    """Swings of 100 mm and .05 rad, taken as three sigma; R = <100, .05> holds variances."""
    rng = np.random.default_rng(4)
    Z = np.array([2000.0, 0.1]) + rng.normal(size=(1000, 2)) * [100 / 3, 0.05 / 3]
    Q = np.diag([0.001, 0.0001, 0.0001, 0.000001])
    for axis, side in [(0, 1), (1, -1)]:
        alone = Z.copy()
        alone[:, 1 - axis] = np.nan
        mean, low, high = ball(Q, np.diag([100.0, 0.05])).filter(alone).nis_band()
        assert (mean > 5 * high) if side > 0 else (mean < low / 5)
    mean, low, high = ball(0 * Q, np.diag([1111.0, 0.00028])).filter(Z).nis_band()
    assert low < mean < high


def test_nothing_seen_has_no_band():
    trace = ball(Q_TRUE, R_TRUE).filter(np.full((3, 2), np.nan))
    assert np.isnan(trace.nis_band()).all()
    assert trace.log_likelihood == 0


def test_fitting_a_standing_thing_gives_the_sample_variance():
    """With x unknown and Q = 0 the likelihood is that of the deviations from the mean."""
    Z = np.random.default_rng(5).normal(700.0, 12.0, (80, 1))
    told = KalmanFilter([[1]], [[1]], [[0]], [[1.0]], P0=[[1e9]])
    fitted = fit_noise(told, Z)
    assert fitted.R[0, 0] == pytest.approx(Z.var(ddof=1), rel=1e-4)
    assert fitted.Q[0, 0] == 0


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_fitting_finds_the_noises_that_made_the_track(factor):
    truth = ball(Q_TRUE, R_TRUE, gate=0.999)
    _, Z = simulate(np.random.default_rng(6), truth, 3000)
    Z[1000:1100] = np.nan
    told = ball(Q_TRUE * factor, R_TRUE / factor, gate=0.999)
    fitted = fit_noise(told, Z)
    assert fitted.gate == 0.999
    np.testing.assert_allclose(np.diag(fitted.R), np.diag(R_TRUE), rtol=0.2)
    np.testing.assert_allclose(np.diag(fitted.Q)[2:], np.diag(Q_TRUE)[2:], rtol=0.3)
    np.testing.assert_allclose(
        fitted.Q / np.diag(np.diag(fitted.Q)).max(), fitted.Q / fitted.Q.max()
    )
    correlation = R_TRUE[0, 1] / np.sqrt(R_TRUE[0, 0] * R_TRUE[1, 1])
    assert fitted.R[0, 1] == pytest.approx(correlation * np.sqrt(np.prod(np.diag(fitted.R))))
    ours, true = (ball(kf.Q, kf.R).filter(Z) for kf in (fitted, truth))
    assert ours.log_likelihood >= true.log_likelihood
    mean, low, high = ours.nis_band(0.999)
    assert low < mean < high


def test_fitting_uses_the_control_input():
    rng = np.random.default_rng(7)
    U = rng.integers(0, 2, (400, 1)).astype(float)
    Z = 3000 - 5 * np.cumsum(U, axis=0) + rng.normal(0, 20, (400, 1))
    kf = KalmanFilter([[1]], [[1]], [[1.0]], [[1.0]], B=[[-5.0]], x0=[3000], P0=[[1]])
    told = fit_noise(kf, Z, U)
    assert told.Q[0, 0] < 0.05
    assert told.R[0, 0] == pytest.approx(400, rel=0.15)
    np.testing.assert_array_equal(told.B, kf.B)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: fit_noise(ball(Q_TRUE, R_TRUE), [[1.0, 1.0]]),
            "at least 6 sighted numbers, got 2",
        ),
        (lambda: fit_noise(ball(0 * Q_TRUE, 0 * R_TRUE), np.ones((9, 2))), "got zeros only"),
        (lambda: fit_noise(ball(Q_TRUE, R_TRUE), np.ones((9, 3))), r"Z must have shape \(any, 2\)"),
        (
            lambda: fit_noise(ball([Q_TRUE] * 9, R_TRUE), np.ones((9, 2))),
            "kf must have one Q",
        ),
        (lambda: fit_noise("ball", [[1.0]]), "kf must be a KalmanFilter, got 'ball'"),
        (lambda: chi_square_band(1e-320), r"dof must be a number in .* got 1e-320"),
        (lambda: ball(Q_TRUE, R_TRUE).smooth("track"), "trace must be a KalmanTrace, got 'track'"),
        (lambda: chi_square_band(0), r"dof must be a number in \[1e-100, 1e\+100\], got 0"),
        (lambda: chi_square_band(2, 0), "count must be an integer >= 1, got 0"),
        (lambda: chi_square_band(2, 1, 1.0), r"probability must be a number in \(0, 1\), got 1"),
        (
            lambda: KalmanFilter([[1]], [[1]], [[1]], [[1]]).smooth(
                ball(Q_TRUE, R_TRUE).filter([[1.0, 1.0]])
            ),
            r"trace.x must have shape \(any, 1\), got \(1, 4\)",
        ),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
