"""What comes in: masks, text, huge numbers, wide priors, other filters' traces."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from arkaq_edu import KalmanFilter, constant_velocity, kalman_batch
from arkaq_edu.kalman import chi_square_band, fit_noise
from tests.kalman.systems import ball, random_covariance

NAN = np.nan


def still(**changes):
    given = {"A": [[1]], "H": [[1]], "Q": [[0]], "R": [[1]], "x0": [0], "P0": [[1]]}
    return KalmanFilter(**(given | changes))


@pytest.mark.parametrize(
    "Z",
    [
        np.ma.array([[3.0], [-999.0], [2.0]], mask=[[0], [1], [0]]),
        np.ma.array([[3], [-999], [2]], mask=[[0], [1], [0]]),
        [[3.0], [NAN], [2.0]],
        [[3], [None], [2]],
        pd.DataFrame({"z": pd.array([3.0, pd.NA, 2.0], dtype="Float64")}),
    ],
)
def test_a_masked_sighting_is_a_missing_one(Z):
    trace = still().filter(Z)
    np.testing.assert_allclose(trace.x[:, 0], [1.5, 1.5, 5 / 3])
    assert trace.accepted.tolist() == [True, False, True]
    np.testing.assert_allclose(
        kalman_batch([[1]], [[1]], [[0]], [[1]], np.ma.stack([Z, Z]), [0], [[1]])[1, :, 0]
        if isinstance(Z, np.ma.MaskedArray)
        else trace.x[:, 0],
        [1.5, 1.5, 5 / 3],
    )


def test_masks_are_missing_in_update_and_fit_noise():
    kf = still()
    kf.update(np.ma.array([9.0], mask=[True]))
    assert kf.x[0] == 0 and not kf.accepted
    kf.update(np.ma.array([3.0], mask=[False]))
    assert kf.x[0] == 1.5 and kf.accepted
    Z = np.random.default_rng(0).normal(0, 30.0, (200, 1))
    mask = np.arange(200)[:, None] % 7 == 0
    masked = fit_noise(still(R=[[1e4]]), np.ma.array(np.where(mask, 1e9, Z), mask=mask))
    told = fit_noise(still(R=[[1e4]]), np.where(mask, NAN, Z))
    np.testing.assert_array_equal(masked.R, told.R)


MASKED = np.ma.array([[1.0]], mask=[[True]])
BAD = [
    (lambda: still(A=MASKED), "A must hold finite numbers, got nan"),
    (lambda: still(R=MASKED), "R must hold finite numbers, got nan"),
    (lambda: still(x0=MASKED[0]), "x0 must hold finite numbers, got nan"),
    (lambda: still(B=[[1]]).filter([[1.0]], MASKED), "U must hold finite numbers, got nan"),
    (lambda: setattr(still(), "x", MASKED[0]), "x must hold finite numbers, got nan"),
    (lambda: still(A=[["1"]]), "A must be an array of numbers"),
    (lambda: still(A=[[1 + 2j]]), "A must be an array of numbers"),
    (lambda: still().update([1 + 2j]), "z must be an array of numbers"),
    (lambda: still().update(["3"]), "z must be an array of numbers"),
    (lambda: still().update([10**400]), "z must be an array of numbers"),
    (lambda: still().update([1e200]), r"z must hold numbers of at most 1e\+100"),
    (lambda: still(R=[[1e200]]), r"R must hold numbers of at most 1e\+100"),
    (lambda: still(A=[[1], [1, 2]]), "A must be an array of numbers"),
    (lambda: constant_velocity(1.0, 10**9), "n_axes must need at most"),
    (lambda: constant_velocity("1", 1), "dt must be a number in"),
    (lambda: chi_square_band(1e300), r"dof must be a number in \[1e-100, 1e\+100\]"),
    (lambda: still().predict([1.0] * 1000), "u must be None .* got .{1,80}$"),
]


@pytest.mark.parametrize(("call", "message"), BAD)
def test_what_is_not_a_number_is_refused_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("P0", [None, 1e-4, 1e6, 1e12, 1e30, 1e90])
def test_two_sensors_count_however_wide_the_prior_is(P0):
    """In S = P0 + R the second sensor is lost by rounding if P0 is above about 5e14 R."""
    system = {"A": [[1]], "H": [[1], [1]], "Q": [[0]], "R": 1e-10 * np.eye(2)}
    P0 = None if P0 is None else [[P0]]
    kf = KalmanFilter(**system, P0=P0)
    assert kf.update([1.0, 3.0]) == pytest.approx([2.0], rel=1e-6)
    assert kf.P[0, 0] == pytest.approx(5e-11, rel=1e-6)
    np.testing.assert_allclose(kf.K, [[0.5, 0.5]], rtol=1e-6)
    assert kf.nis == pytest.approx(2e10, rel=1e-5)
    Z = [[[1.0, 3.0]], [[2.0, NAN]], [[5.0, 3.0]]]
    x = kalman_batch(**system, Z=Z, P0=P0)
    np.testing.assert_allclose(x.ravel(), [2, 2, 4], rtol=1e-5)


@pytest.mark.parametrize("width", [1.0, 1e4, 1e8, 1e12])
def test_five_sensors_with_noise_in_common_are_the_least_squares_solution(width):
    rng = np.random.default_rng(0)
    H, R = rng.normal(size=(5, 2)), 1e-8 * random_covariance(rng, 5, 5, 0)
    z, W = rng.normal(size=5), np.linalg.inv(R)
    P = np.linalg.inv(H.T @ W @ H + np.eye(2) / width)
    kf = KalmanFilter(np.eye(2), H, np.zeros((2, 2)), R, P0=width * np.eye(2))
    np.testing.assert_allclose(kf.update(z), P @ H.T @ W @ z, rtol=1e-6)
    np.testing.assert_allclose(kf.P, P, rtol=1e-6)


def test_a_copy_of_a_sensor_whose_noise_is_the_same_adds_nothing():
    """The noises are perfectly correlated, so that R is singular beside a prior of any width."""
    for width in (1.0, 1e20):
        kf = still(H=[[1], [1]], R=[[4, 4], [4, 4]], P0=[[width]])
        one = still(R=[[4]], P0=[[width]])
        np.testing.assert_allclose(kf.update([8, 8]), one.update([8]), rtol=1e-12)
        np.testing.assert_allclose(kf.P, one.P, rtol=1e-12)


def test_the_default_start_does_not_depend_on_the_units():
    """In mm, rad and s, or in m, degrees and ms: the same track."""
    A, H = constant_velocity(0.64, 2)
    Q, R = np.diag([1.0, 1e-4, 25.0, 1e-3]), np.diag([400.0, 1e-3])
    Z = np.random.default_rng(0).normal(size=(40, 2)) * [20, 0.03] + [1500, 0.1]
    known = KalmanFilter(A, H, Q, R)
    x = known.filter(Z).x
    for length, angle, second in [(1e-3, 57.3, 1e3), (1e-6, 1.0, 1.0), (1e6, 1e-3, 1 / 3600)]:
        of_z = np.diag([length, angle])
        of_x = np.diag([length, angle, length / second, angle / second])
        A, H = constant_velocity(0.64 * second, 2)
        kf = KalmanFilter(A, H, of_x @ Q @ of_x, of_z @ R @ of_z)
        np.testing.assert_allclose(kf.filter(Z @ of_z).x, x @ of_x, rtol=1e-7)
        np.testing.assert_allclose(kf.P0, of_x @ known.P0 @ of_x, rtol=1e-12)


def test_the_default_start_has_a_variance_for_every_state():
    np.testing.assert_allclose(still(R=[[4]], H=[[2]], P0=None).P0, [[1e6]])
    np.testing.assert_allclose(still(R=[[0]], Q=[[9]], P0=None).P0, [[9e6]])  # no R to go by
    np.testing.assert_allclose(still(R=[[0]], P0=None).P0, [[1e6]])
    np.testing.assert_allclose(still(H=[[0]], P0=None).P0, [[1e6]])  # never seen
    np.testing.assert_allclose(still(H=np.zeros((0, 1)), R=np.zeros((0, 0)), P0=None).P0, [[1e6]])
    np.testing.assert_allclose(still(R=[[1e100]], P0=None).P0, [[1e100]])
    quarter = [[np.cos(np.pi / 2), -1], [1, np.cos(np.pi / 2)]]  # with 6e-17 for zero
    turned = KalmanFilter(quarter, [[1, 0]], np.zeros((2, 2)), [[4.0]])
    np.testing.assert_allclose(turned.P0, 4e6 * np.eye(2))


def test_a_trace_is_smoothed_by_its_own_filter():
    other = KalmanFilter([[0.5]], [[1]], [[7.0]], [[1]])
    own = still(Q=[[0.1]])
    trace = own.filter([[1.0], [4.0], [2.0]])
    for ours, expected in zip(other.smooth(trace), own.smooth(trace), strict=True):
        np.testing.assert_array_equal(ours, expected)
    with pytest.raises(ValueError, match=r"trace.x must have shape \(any, 4\), got \(3, 1\)"):
        ball().smooth(trace)


def test_a_filter_that_diverges_says_so():
    kf = still(A=[[1.5]])
    with pytest.raises(ValueError, match=r"P has grown beyond 1e\+100: the filter diverges"):
        for _ in range(2000):
            kf.predict()
    assert np.isfinite(kf.P).all()
    with pytest.raises(ValueError, match=r"P has grown beyond 1e\+100 in row 283: the filter"):
        still(A=[[1.5]]).filter(np.full((2000, 1), NAN))
    with pytest.raises(ValueError, match=r"P has grown beyond 1e\+100"):
        kalman_batch([[1.5]], [[1]], [[0]], [[1]], np.full((3, 2000, 1), NAN))
    with pytest.raises(ValueError, match=r"x has grown beyond 1e\+100 in row 1"):
        still(A=[[1e60]], P0=[[0]], x0=[1]).filter([[NAN]] * 3)
    with pytest.raises(ValueError, match=r"x has grown beyond 1e\+100"):
        kalman_batch([[1e60]], [[1]], [[0]], [[1]], np.full((1, 3, 1), NAN), [1], [[0]])
    with pytest.raises(ValueError, match=r"x has grown beyond 1e\+100: the filter diverges"):
        still(H=[[1e-60]], R=[[0]], x0=[0], P0=[[1]]).update([1e60])
    seen = still(A=[[1.5]], Q=[[1]]).filter(np.ones((2000, 1)))  # what is seen does not grow
    assert np.isfinite(seen.P).all() and abs(seen.x[-1, 0] - 1) < 1
