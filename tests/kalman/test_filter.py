"""The Kalman filter against filterpy, closed forms and its own promises."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter as Peer
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu import KalmanFilter, constant_velocity, kalman_batch
from tests.kalman.systems import ball, systems, with_gaps


def peer_of(system):
    n, m = system["A"].shape[0], system["H"].shape[0]
    peer = Peer(dim_x=n, dim_z=m)
    peer.F, peer.H, peer.Q, peer.R = (system[name] for name in "AHQR")
    peer.B, peer.x, peer.P = system["B"], system["x0"].copy(), system["P0"].copy()
    return peer


def assert_close(ours, theirs, tolerance=1e-10, beside=0):
    """Compare arrays by their largest entry, or by the size of what they are the sum of."""
    scale = max(np.abs(theirs).max(), beside)
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * scale)


@pytest.mark.thesis("eqs 2.53 to 2.59")
@settings(max_examples=60, deadline=None)
@given(systems())
def test_agrees_with_filterpy(drawn):
    system, rng = drawn
    kf, peer = KalmanFilter(**system), peer_of(system)
    Z = rng.normal(size=(20, system["H"].shape[0]))
    U = rng.normal(size=(20, system["B"].shape[1]))
    trace = kf.filter(Z, U)
    log_likelihood = 0.0
    for t, (z, u) in enumerate(zip(Z, U, strict=True)):
        peer.predict(u)
        assert_close(kf.predict(u), peer.x, beside=1)
        assert_close(kf.P, peer.P)
        assert_close(trace.x_prior[t], peer.x, beside=1)
        assert_close(trace.P_prior[t], peer.P)
        peer.update(z)
        assert_close(kf.update(z), peer.x, beside=1)
        for name, theirs, beside in [
            ("x", peer.x, 1), ("P", peer.P, 0), ("K", peer.K, 0), ("S", peer.S, 0),
            ("innovation", peer.y, 1),
        ]:  # fmt: skip
            assert_close(getattr(kf, name), theirs, beside=beside)
            assert_close(getattr(trace, name)[t], theirs, beside=beside)
        for nis in (kf.nis, trace.nis[t]):
            assert nis == pytest.approx(peer.mahalanobis**2, rel=1e-8)
        assert kf.log_likelihood == pytest.approx(peer.log_likelihood, rel=1e-8)
        log_likelihood += peer.log_likelihood
    assert trace.log_likelihood == pytest.approx(log_likelihood, rel=1e-8)


def test_scalar_gain_settles_where_the_riccati_equation_says():
    q, r = 3.0, 7.0
    kf = KalmanFilter([[1]], [[1]], [[q]], [[r]])
    P_prior = q / 2 + np.sqrt(q**2 / 4 + q * r)
    trace = kf.filter(np.zeros((100, 1)))
    assert trace.P_prior[-1, 0, 0] == pytest.approx(P_prior, rel=1e-13)
    assert trace.K[-1, 0, 0] == pytest.approx(P_prior / (P_prior + r), rel=1e-13)


@pytest.mark.thesis("eq 2.54, errata row 27")
@pytest.mark.parametrize("r", [1e-9, 0.0])
def test_without_noise_the_gain_is_a_right_inverse(r):
    """After eq 2.54 the thesis says K = H^-1, but H is 2 x 4: what holds is H K = I."""
    kf = ball(R=r * np.eye(2))
    kf.predict()
    kf.update([1500.0, 0.1])
    np.testing.assert_allclose(kf.H @ kf.K, np.eye(2), atol=1e-10)
    np.testing.assert_allclose(kf.H @ kf.x, [1500.0, 0.1], rtol=1e-10)
    assert not np.allclose(kf.K @ kf.H, np.eye(4), atol=0.1)


@pytest.mark.thesis("errata row 35")
def test_a_jump_of_the_distance_takes_the_thesis_filter_thirty_updates():
    A, H = constant_velocity(1.0, 2)
    kf = KalmanFilter(A, H, np.diag([0.001, 0.0001, 0.0001, 0.000001]), np.diag([100.0, 0.05]))
    Z = np.zeros((5000, 2))
    Z[4000:] = 1
    arrived = kf.filter(Z).x[4000:, 0] >= 0.9
    assert np.argmax(arrived) + 1 == 30


def test_a_known_footstep_as_control_input_leaves_no_lag():
    Z = np.column_stack([1500.0 - 100.0 * np.arange(1, 9), np.zeros(8)])
    start = {"x0": [1500, 0, 0, 0], "P0": np.diag([1.0, 1e-4, 1e-4, 1e-6]), "Q": np.zeros((4, 4))}
    steps = np.ones((8, 1))
    told = ball(B=[[-100.0], [0], [0], [0]], **start).filter(Z, steps)
    untold = ball(**start).filter(Z)
    np.testing.assert_allclose(told.x[:, 0], Z[:, 0], atol=1e-9)
    assert np.abs(untold.x[-1, 0] - Z[-1, 0]) > 200


def test_the_first_sighting_overrules_an_unknown_start_in_any_unit():
    for unit in (1.0, 1e-3, 1e6):
        kf = KalmanFilter([[1]], [[1 / unit]], [[0]], [[9.0]])
        kf.update([4.0])
        assert kf.x[0] == pytest.approx(4.0 * unit, rel=2e-6)
        assert kf.P[0, 0] == pytest.approx(9.0 * unit**2, rel=2e-6)


def test_a_missing_sighting_is_a_prediction():
    Z = np.column_stack([np.linspace(1500, 900, 12), np.linspace(0.2, 0, 12)])
    Z[5:8] = np.nan
    trace = ball().filter(Z)
    for t in (5, 6, 7):
        np.testing.assert_array_equal(trace.x[t], trace.x_prior[t])
        np.testing.assert_array_equal(trace.P[t], trace.P_prior[t])
        assert not trace.K[t].any()
        assert np.isnan(trace.nis[t]) and np.isnan(trace.innovation[t]).all()
    np.testing.assert_array_equal(trace.accepted, ~np.isnan(Z[:, 0]))
    longer = ball()
    longer.x, longer.P = trace.x[4], trace.P[4]
    for _ in range(3):
        longer.predict()
    np.testing.assert_allclose(trace.x[7], longer.x, rtol=1e-14)
    assert np.linalg.det(trace.P[7]) > np.linalg.det(trace.P[4])


@settings(max_examples=40, deadline=None)
@given(systems(max_states=6), st.data())
def test_a_partly_missing_sighting_is_one_of_the_rest(drawn, data):
    system, rng = drawn
    m = system["H"].shape[0]
    seen = np.array(data.draw(st.lists(st.booleans(), min_size=m, max_size=m)))
    z = np.where(seen, rng.normal(size=m), np.nan)
    kf = KalmanFilter(**system)
    kf.update(z)
    if not seen.any():
        np.testing.assert_array_equal(kf.x, kf.x0)
        np.testing.assert_array_equal(kf.P, kf.P0)
        return
    rest = KalmanFilter(**(system | {"H": system["H"][seen], "R": system["R"][np.ix_(seen, seen)]}))
    rest.update(z[seen])
    assert_close(kf.x, rest.x, 1e-12)
    assert_close(kf.P, rest.P, 1e-12)
    assert_close(kf.K[:, seen], rest.K, 1e-12)
    assert not kf.K[:, ~seen].any()
    assert kf.nis == pytest.approx(rest.nis, rel=1e-12)
    assert kf.log_likelihood == pytest.approx(rest.log_likelihood, rel=1e-12)


def test_an_entry_that_says_nothing_new_is_passed_over():
    """Two exact copies of one sensor make S singular."""
    kf = KalmanFilter(np.eye(2), [[1, 0], [1, 0]], np.zeros((2, 2)), np.zeros((2, 2)), P0=np.eye(2))
    np.testing.assert_allclose(kf.update([5.0, 5.0]), [5.0, 0.0])
    np.testing.assert_allclose(kf.P, np.diag([0.0, 1.0]), atol=1e-15)
    np.testing.assert_allclose(kf.update([5.0, 5.0]), [5.0, 0.0])
    assert np.isfinite(kf.P).all()


def test_a_sighting_may_bring_its_own_noise():
    far, near = ball(), ball(R=np.diag([1.0, 1e-6]))
    usual = far.R
    expected = near.update([1500.0, 0.1])
    np.testing.assert_array_equal(far.update([1500.0, 0.1], R=np.diag([1.0, 1e-6])), expected)
    np.testing.assert_array_equal(far.P, near.P)
    np.testing.assert_array_equal(far.R, usual)
    with pytest.raises(ValueError, match="z must have shape"):
        far.update([1.0], R=np.eye(2))
    np.testing.assert_array_equal(far.R, usual)


def test_each_row_of_a_track_may_bring_its_own_noise():
    rng = np.random.default_rng(4)
    Z = rng.normal(size=(30, 2))
    R = np.exp(rng.normal(size=(30, 1, 1))) * np.eye(2)
    kf = ball()
    trace = kf.filter(Z, R=R)
    for t in range(30):
        kf.predict()
        kf.R = R[t]
        np.testing.assert_allclose(kf.update(Z[t]), trace.x[t], rtol=1e-12)
    np.testing.assert_allclose(kf.P, trace.P[-1], rtol=1e-12)


def test_the_gate_refuses_an_outlier_and_few_others():
    rng = np.random.default_rng(0)
    Z = np.array([1500.0, 0.1]) + rng.normal(size=(4000, 2)) * [20.0, 0.03]
    still = {"Q": np.zeros((4, 4)), "R": np.diag([400.0, 9e-4])}
    still |= {"x0": [1500, 0.1, 0, 0], "P0": np.zeros((4, 4))}
    trace = ball(gate=0.95, **still).filter(Z)
    assert 0.94 < trace.accepted.mean() < 0.96

    Z[2000] = [4000.0, -0.4]
    gated, open_ = ball(gate=0.999).filter(Z), ball().filter(Z)
    assert not gated.accepted[2000] and open_.accepted[2000]
    np.testing.assert_array_equal(gated.x[2000], gated.x_prior[2000])
    np.testing.assert_array_equal(gated.P[2000], gated.P_prior[2000])
    assert gated.nis[2000] > 1000
    assert abs(gated.x[2000, 0] - 1500) < 50 < abs(open_.x[2000, 0] - 1500)


def test_the_covariance_stays_positive_for_a_million_steps():
    """With P from 1e10 down to 1e-8 and a third missing; eq 2.59 as printed fails at once."""
    A, H = constant_velocity(0.64, 2)
    Q, R, P = np.diag([0, 0, 1.0, 1e-6]), 1e-8 * np.eye(2), 1e10 * np.eye(4)
    Z = with_gaps(np.random.default_rng(0), np.zeros((250_000, 2)), 0.3)
    for _ in range(4):
        P = KalmanFilter(A, H, Q, R, P0=P).filter(Z).P
        np.testing.assert_array_equal(P, P.transpose(0, 2, 1))
        some = np.concatenate([P[:1000], P[1000::100]])
        sigma = np.sqrt(np.einsum("tii->ti", some))
        correlations = some / sigma[:, :, None] / sigma[:, None, :]
        assert np.linalg.eigvalsh(correlations).min() > 0
        P = P[-1]


def test_a_batch_is_its_tracks():
    rng = np.random.default_rng(1)
    kf = ball(x0=[2000, 0, 0, 0])
    Z = rng.normal(size=(12, 200, 2)) * [30, 0.03] + [1500, 0.1]
    Z[3:7] = with_gaps(rng, Z[3:7], 0.2)
    Z[8, 50:60] = np.nan
    x = kalman_batch(kf.A, kf.H, kf.Q, kf.R, Z, x0=kf.x0, P0=kf.P0)
    for track, expected in zip(x, Z, strict=True):
        np.testing.assert_allclose(track, kf.filter(expected).x, rtol=1e-10, atol=1e-10)
    assert kalman_batch(kf.A, kf.H, kf.Q, kf.R, np.empty((0, 5, 2))).shape == (0, 5, 4)


def test_what_was_read_stays_and_what_is_assigned_is_checked():
    kf = ball()
    x, P, K = kf.x, kf.P, kf.K
    kept = x.copy(), P.copy(), K.copy()
    returned = kf.predict()
    corrected = kf.update([1500.0, 0.1])
    for before, now in zip(kept, (x, P, K), strict=True):
        np.testing.assert_array_equal(before, now)
    returned[:] = corrected[:] = np.nan
    assert np.isfinite(kf.x).all()
    with pytest.raises(ValueError, match="read-only"):
        kf.P[0, 0] = 3
    kf.P = np.eye(4)
    kf.x = [1, 2, 3, 4]
    np.testing.assert_array_equal(kf.x, [1, 2, 3, 4])
    with pytest.raises(ValueError, match=r"P must be a covariance \(positive semi-definite\)"):
        kf.P = -np.eye(4)
    with pytest.raises(ValueError, match=r"x must have shape \(4,\), got \(3,\)"):
        kf.x = [1, 2, 3]
    with pytest.raises(AttributeError, match="Q is fixed"):
        kf.Q = np.eye(4)


def test_reset_filter_copies_and_pickles():
    kf, fresh = ball(), ball()
    Z = np.array([[1500.0, 0.1], [1450.0, 0.12]])
    first = kf.filter(Z)
    np.testing.assert_array_equal(kf.x, fresh.x)
    for z in Z:
        kf.predict()
        kf.update(z)
    for twin in (copy.deepcopy(kf), pickle.loads(pickle.dumps(kf))):
        np.testing.assert_array_equal(twin.P, kf.P)
        twin.predict()
        twin.update([0.0, 0.0])
    np.testing.assert_array_equal(kf.P, first.P[-1])
    np.testing.assert_array_equal(kf.filter(Z).x, first.x)
    kf.reset()
    for name in ("x", "P", "K", "S", "innovation", "nis", "log_likelihood", "accepted"):
        np.testing.assert_array_equal(getattr(kf, name), getattr(fresh, name))


def test_any_sequence_of_numbers_will_do():
    expected = ball().update([1500.0, 1.0])
    frozen = np.array([1500.0, 1.0])
    frozen.setflags(write=False)
    strided = np.arange(0, 3000.0).reshape(2, 1500)[:, :1].T * 0 + frozen
    for z in ([1500, 1], (1500.0, 1), frozen, np.array([1500, 1]), strided[0], frozen[::-1][::-1]):
        np.testing.assert_array_equal(ball().update(z), expected)


BAD_MATRICES = [
    ({"A": np.eye(3)[:2]}, r"A must have shape \(2, 2\), got \(2, 3\)"),
    ({"A": 1.0}, r"A must have shape \(any, any\), got \(\)"),
    ({"A": np.full((4, 4), np.nan)}, r"A must hold finite numbers, got nan at \(0, 0\)"),
    ({"H": np.eye(3)}, r"H must have shape \(any, 4\), got \(3, 3\)"),
    ({"Q": np.eye(2)}, r"Q must have shape \(4, 4\), got \(2, 2\)"),
    ({"Q": np.diag([1.0, -2, 1, 1])}, "Q must be .* got an eigenvalue of -2"),
    ({"R": [[1.0, 0.5], [0.2, 1.0]]}, r"R must be a covariance \(symmetric\), got 0.5 at"),
    ({"R": [[1.0, 2.0], [2.0, 1.0]]}, "R must be .* got an eigenvalue of -1"),
    ({"R": [100.0, 0.05]}, r"R must have shape \(2, 2\), got \(2,\)"),
    ({"R": "wide"}, "R must be an array of numbers, got 'wide'"),
    ({"B": np.eye(3)}, r"B must have shape \(4, any\), got \(3, 3\)"),
    ({"x0": [0.0]}, r"x0 must have shape \(4,\), got \(1,\)"),
    ({"P0": -np.eye(4)}, "P0 must be a covariance"),
    ({"gate": 1.5}, r"gate must be a number in \(0, 1\), got 1.5"),
]


@pytest.mark.parametrize(("change", "message"), BAD_MATRICES)
def test_bad_matrices_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        ball(**change)


BAD_CALLS = [
    (lambda kf: kf.update([1.0]), r"z must have shape \(2,\), got \(1,\)"),
    (lambda kf: kf.update(3.0), r"z must have shape \(2,\), got \(\)"),
    (lambda kf: kf.update([[1.0, 2.0]]), r"z must have shape \(2,\), got \(1, 2\)"),
    (lambda kf: kf.update([1.0, np.inf]), r"z must hold finite numbers or NaN, got inf at \(1,\)"),
    (lambda kf: kf.update("ball"), "z must be an array of numbers, got 'ball'"),
    (lambda kf: kf.update([1.0, 1.0], R=-np.eye(2)), "R must be .* got an eigenvalue of -1"),
    (lambda kf: kf.update([1.0, 1.0], R=[[1, np.nan], [np.nan, 1]]), "R must hold finite"),
    (lambda kf: kf.predict([1.0]), "u must be None for a filter without B"),
    (lambda kf: kf.filter([[1.0]]), r"Z must have shape \(any, 2\), got \(1, 1\)"),
    (lambda kf: kf.filter([[1.0, -np.inf]]), "Z must hold finite numbers or NaN, got -inf"),
    (lambda kf: kf.filter([[1.0, 1.0]], [[1.0]]), "U must be None for a filter without B"),
    (lambda kf: kf.filter([[1.0, 1.0]], R=np.eye(2)), r"R must have shape \(1, 2, 2\)"),
    (lambda kf: kf.filter([[1.0, 1.0]], R=[-np.eye(2)]), "R must be .* got an eigenvalue of -1"),
    (lambda kf: ball(B=np.eye(4)[:, :1]).predict([1.0, 2.0]), r"u must have shape \(1,\)"),
    (lambda kf: ball(B=np.eye(4)[:, :1]).predict([np.nan]), "u must hold finite numbers"),
    (lambda kf: kalman_batch(kf.A, kf.H, kf.Q, kf.R, np.ones((3, 2))), r"Z must have shape"),
    (lambda kf: constant_velocity(0, 2), r"dt must be a number in \(0, inf\), got 0"),
    (lambda kf: constant_velocity(1.0, 0), "n_axes must be an integer >= 1, got 0"),
]


@pytest.mark.parametrize(("call", "message"), BAD_CALLS)
def test_bad_calls_are_refused_and_change_nothing(call, message):
    kf = ball()
    kf.predict()
    kf.update([1500.0, 0.1])
    before = pickle.dumps(kf)
    with pytest.raises(ValueError, match=message):
        call(kf)
    assert pickle.dumps(kf) == before


PLAIN = """
import sys
sys.modules["numba"] = None  # as where it is not installed
import numpy as np
from arkaq_edu import KalmanFilter, kalman_batch
from arkaq_edu._compiled import HAVE_NUMBA
assert not HAVE_NUMBA
data = np.load(sys.argv[1])
system = {name: data[name] for name in ("A", "H", "Q", "R", "P0")}
kf = KalmanFilter(**system, gate=0.99)
trace = kf.filter(data["Z"])
x, P = kf.smooth(trace)
for z in data["Z"]:
    kf.predict()
    kf.update(z)
np.savez(sys.argv[2], x=trace.x, P=trace.P, nis=trace.nis, stepped=kf.P, smoothed=x, sure=P,
         log_likelihood=trace.log_likelihood, batch=kalman_batch(**system, Z=data["Z"][None]))
"""


def test_without_numba_the_numbers_are_the_same(tmp_path):
    rng = np.random.default_rng(5)
    Z = with_gaps(rng, rng.normal(size=(120, 2)) * [20, 0.03] + [1500, 0.1], 0.05)
    kf = ball(gate=0.99)
    system = {name: getattr(kf, name) for name in ("A", "H", "Q", "R", "P0")}
    np.savez(tmp_path / "in.npz", **system, Z=Z)
    command = [sys.executable, "-c", PLAIN, tmp_path / "in.npz", tmp_path / "out.npz"]
    subprocess.run(command, check=True)
    plain = np.load(tmp_path / "out.npz")
    trace = kf.filter(Z)
    x, P = kf.smooth(trace)
    for z in Z:
        kf.predict()
        kf.update(z)
    for name, compiled in [
        ("x", trace.x), ("P", trace.P), ("nis", trace.nis), ("stepped", kf.P), ("smoothed", x),
        ("sure", P), ("batch", kalman_batch(**system, Z=Z[None])),
    ]:  # fmt: skip
        np.testing.assert_array_equal(plain[name], compiled)
    assert plain["log_likelihood"] == pytest.approx(trace.log_likelihood, rel=1e-14)
