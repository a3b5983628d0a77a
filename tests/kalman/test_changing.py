"""A, Q, H, R and B that change along a track: the joint Gaussian, and a new filter for each row."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu import KalmanFilter, constant_velocity, kalman_batch
from arkaq_edu.kalman import fit_noise
from tests.kalman.systems import joint_gaussian, random_covariance, with_gaps

T = 7
NAMES = ("A", "H", "Q", "R", "B")


@st.composite
def changing_systems(draw):
    """Draw a system in which any of the matrices change, with a track and its inputs."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, m, k = draw(st.integers(1, 3)), draw(st.integers(1, 3)), draw(st.integers(1, 2))
    system = {
        "A": np.linalg.qr(rng.normal(size=(T, n, n)))[0] * rng.uniform(0.5, 1.1, (T, 1, n)),
        "H": rng.normal(size=(T, m, n)),
        "Q": np.array([random_covariance(rng, n, draw(st.integers(0, n)), -2) for _ in range(T)]),
        "R": np.array([random_covariance(rng, m, m, -2) for _ in range(T)]),
        "B": rng.normal(size=(T, n, k)),
    }
    for name in draw(st.sets(st.sampled_from(NAMES))):
        system[name] = system[name][0]  # the same in all rows
    system |= {"x0": rng.normal(size=n), "P0": random_covariance(rng, n, n, -1)}
    Z = with_gaps(rng, rng.normal(size=(T, m)), draw(st.sampled_from([0, 0.3])))
    return system, Z, rng.normal(size=(T, k))


@settings(max_examples=60, deadline=None)
@given(changing_systems())
def test_filter_and_smoother_are_those_of_the_joint_gaussian(drawn):
    system, Z, _ = drawn
    kf = KalmanFilter(**system)
    trace = kf.filter(Z)
    x, P = kf.smooth(trace)
    posterior, seen, log_likelihood = joint_gaussian(system, Z)
    for t in range(T):
        until_now = seen[seen < (t + 1) * Z.shape[1]]
        for (expected_x, expected_P), ours_x, ours_P in [
            (posterior(until_now, t), trace.x[t], trace.P[t]),
            (posterior(seen, t), x[t], P[t]),
        ]:
            scale = 1 + np.abs(expected_x).max() + np.abs(expected_P).max()
            np.testing.assert_allclose(ours_x / scale, expected_x / scale, rtol=0, atol=1e-8)
            np.testing.assert_allclose(ours_P / scale, expected_P / scale, rtol=0, atol=1e-8)
    assert trace.log_likelihood == pytest.approx(log_likelihood, rel=1e-9, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(changing_systems())
def test_a_track_is_a_new_filter_for_each_row(drawn):
    system, Z, U = drawn
    trace = KalmanFilter(**system, gate=0.9).filter(Z, U)
    x, P = system["x0"], system["P0"]
    for t in range(T):
        now = {name: system[name] if system[name].ndim == 2 else system[name][t] for name in NAMES}
        kf = KalmanFilter(**now, x0=x, P0=P, gate=0.9)
        np.testing.assert_array_equal(kf.predict(U[t]), trace.x_prior[t])
        np.testing.assert_array_equal(kf.P, trace.P_prior[t])
        kf.update(Z[t])
        for name in ("x", "P", "K", "S", "innovation", "nis", "accepted"):
            np.testing.assert_array_equal(getattr(kf, name), getattr(trace, name)[t])
        x, P = kf.x, kf.P


def test_matrices_repeated_for_each_row_give_the_constant_track():
    """Also after P has converged, where the constant filter takes a shortcut."""
    A, H = constant_velocity(0.64, 2)
    Q, R, B = np.diag([1.0, 1e-4, 25.0, 1e-3]), np.diag([400.0, 1e-3]), np.ones((4, 1))
    rng = np.random.default_rng(0)
    Z, U = rng.normal(size=(400, 2)) * [20, 0.03] + [1500, 0.1], rng.normal(size=(400, 1))
    constant = KalmanFilter(A, H, Q, R, B)
    repeated = KalmanFilter(*(np.repeat(M[None], 400, axis=0) for M in (A, H, Q, R, B)))
    np.testing.assert_array_equal(repeated.P0, constant.P0)
    ours, expected = repeated.filter(Z, U), constant.filter(Z, U)
    np.testing.assert_allclose(ours.x, expected.x, rtol=1e-12, atol=1e-12)
    assert ours.log_likelihood == pytest.approx(expected.log_likelihood, rel=1e-12)
    for a, b in zip(repeated.smooth(ours), constant.smooth(expected), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)


def test_uneven_time_steps_are_even_ones_with_gaps():
    """Steps of 1, 3, 2, ... seconds are steps of one second with nothing seen in between."""
    steps = np.array([1, 3, 2, 1, 5, 1])
    A, H = constant_velocity(1.0, 1)
    Q, R = np.diag([0.5, 2.0]), [[9.0]]
    power = np.linalg.matrix_power
    A_long = [power(A, dt) for dt in steps]
    Q_long = [sum(power(A, s) @ Q @ power(A, s).T for s in range(dt)) for dt in steps]
    z = np.random.default_rng(1).normal(size=(len(steps), 1)) * 10
    Z, at = np.full((steps.sum(), 1), np.nan), np.cumsum(steps) - 1
    Z[at] = z
    start = {"x0": [0, 1], "P0": np.eye(2)}
    even, uneven = KalmanFilter(A, H, Q, R, **start), KalmanFilter(A_long, H, Q_long, R, **start)
    ours, expected = uneven.filter(z), even.filter(Z)
    np.testing.assert_allclose(ours.x, expected.x[at], rtol=1e-10)
    np.testing.assert_allclose(ours.P, expected.P[at], rtol=1e-10)
    assert ours.log_likelihood == pytest.approx(expected.log_likelihood, rel=1e-10)
    (x, P), (all_x, all_P) = uneven.smooth(ours), even.smooth(expected)
    np.testing.assert_allclose(x, all_x[at], rtol=1e-9)
    np.testing.assert_allclose(P, all_P[at], rtol=1e-9)


@settings(max_examples=20, deadline=None)
@given(changing_systems())
def test_a_batch_is_its_tracks(drawn):
    system, Z, _ = drawn
    system.pop("B")
    tracks = np.stack([Z, 2 * Z, Z[::-1]])
    expected = [KalmanFilter(**system).filter(track).x for track in tracks]
    np.testing.assert_allclose(kalman_batch(**system, Z=tracks), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["A", "H", "Q", "R"])
def test_a_batch_in_which_one_matrix_changes(name):
    """Doubled in its second row, and as given from then on."""
    system = {"A": [[0.9]], "H": [[1.5]], "Q": [[0.3]], "R": [[2.0]], "P0": [[4.0]], "x0": [1.0]}
    system[name] = np.array([1.0, 2.0, 1.0])[:, None, None] * system[name]
    Z = np.array([[[1.0], [3.0], [2.0]], [[0.0], [-1.0], [5.0]]])
    expected = [KalmanFilter(**system).filter(track).x for track in Z]
    np.testing.assert_allclose(kalman_batch(**system, Z=Z), expected, rtol=1e-12)


def test_the_noises_of_an_uneven_track_are_fitted():
    rng = np.random.default_rng(2)
    A = [constant_velocity(dt, 1)[0] for dt in rng.uniform(0.5, 2, 300)]
    kf = KalmanFilter(A, [[1.0, 0.0]], np.zeros((2, 2)), [[1.0]])
    Z = 3.0 * np.cumsum([M[0, 1] for M in A])[:, None] + rng.normal(0, 20.0, (300, 1))
    fitted = fit_noise(kf, Z)
    assert fitted.R[0, 0] == pytest.approx(400, rel=0.2)
    np.testing.assert_array_equal(fitted.A, kf.A)


def test_the_default_start_is_what_the_first_step_shows():
    """A velocity is seen through the first step: its variance is 1e6 R / dt**2."""
    A = [constant_velocity(dt, 1)[0] for dt in (0.5, 3.0, 7.0)]
    kf = KalmanFilter(A, [[1.0, 0.0]], np.zeros((2, 2)), [[9.0]])
    np.testing.assert_allclose(kf.P0, np.diag([9e6, 36e6]), rtol=1e-12)


def wanderer(**changes):
    return KalmanFilter(**({"A": [[1]], "H": [[1]], "Q": [[1]], "R": [[1]]} | changes))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: wanderer(A=[[[1]]] * 3).predict(),
            "A must be one matrix for predict, got one for",
        ),
        (lambda: wanderer(Q=[[[1]]] * 3).predict(), "Q must be one matrix for predict"),
        (lambda: wanderer(B=[[[1]]] * 3).predict([1]), "B must be one matrix for predict"),
        (lambda: wanderer(H=[[[1]]] * 3).update([1]), "H must be one matrix for update"),
        (lambda: wanderer(R=[[[1]]] * 3).update([1]), "R must be one matrix for update"),
        (lambda: wanderer(A=[[[1]]] * 3, Q=[[[1]]] * 2), "Q must have 3 rows, as A has, got 2"),
        (
            lambda: wanderer(H=[[[1]]] * 3).filter([[1]]),
            r"Z must have shape \(3, 1\), got \(1, 1\)",
        ),
        (lambda: wanderer(A=np.ones((0, 1, 1))), "A must have at least one row"),
        (lambda: wanderer(A=np.ones((3, 2, 1))), r"A must have shape \(any, 2, 2\), got"),
        (lambda: wanderer(A=np.ones((1, 1, 1, 1))), r"A must have shape \(any, any\), got"),
        (lambda: wanderer(R=[[[1]], [[-4]]]), "R must be .* got an eigenvalue of -4 in row 1"),
        (
            lambda: KalmanFilter(np.eye(2), np.eye(2), [np.eye(2), [[1, 2], [0, 1]]], np.eye(2)),
            r"Q must be a covariance \(symmetric\), got 2 at \(0, 1\) and 0 at \(1, 0\) in row 1",
        ),
        (
            lambda: setattr(wanderer(A=[[[1]]] * 3), "R", [[[1]]] * 2),
            "R must have 3 rows, as A has",
        ),
    ],
)
def test_what_does_not_fit_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_a_noise_that_changes_may_be_assigned_and_one_may_replace_it():
    kf = wanderer(A=[[[1]]] * 2)
    kf.R = [[[1.0]], [[4.0]]]
    told = wanderer(R=[[[1.0]], [[4.0]]], P0=kf.P0)
    np.testing.assert_array_equal(kf.filter([[1], [2]]).x, told.filter([[1], [2]]).x)
    alone = wanderer(R=[[[1.0]]] * 2, P0=[[1]])
    assert alone.update([4.0], R=[[3.0]]) == pytest.approx([1.0])
    assert repr(kf) == "KalmanFilter(1 states, 1 measurements, 0 inputs)"
    both = KalmanFilter(np.eye(2), [[[1, 0]]] * 3, np.eye(2), [[1]], [[1], [1]])
    assert repr(both) == "KalmanFilter(2 states, 1 measurements, 1 inputs)"
