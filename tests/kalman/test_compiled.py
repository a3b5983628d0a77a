"""Whole tracks and batches give the numbers of the equations, step by step."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu import KalmanFilter, kalman_batch
from tests.kalman.systems import ball, systems, with_gaps

SHARES = st.sampled_from([0.0, 0.01, 0.4])


def assert_equal_to_rounding(ours, theirs):
    """Compare two lists of arrays, each by its largest entry or by 1."""
    for a, b in zip(ours, theirs, strict=True):
        scale = 1 + np.abs(np.nan_to_num(b)).max()
        np.testing.assert_allclose(np.divide(a, scale), b / scale, rtol=0, atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(systems(max_states=5), SHARES, st.sampled_from([None, 0.9]))
def test_a_track_is_its_steps(drawn, share, gate):
    """Also where P_prior has converged, and after gaps and refused sightings."""
    system, rng = drawn
    kf = KalmanFilter(**system, gate=gate)
    Z = with_gaps(rng, rng.normal(size=(120, system["H"].shape[0])), share)
    U = rng.normal(size=(120, system["B"].shape[1]))
    trace = kf.filter(Z, U)
    names = ("x", "P", "S", "K", "innovation", "nis")
    steps = {name: [] for name in ("x_prior", "P_prior", "accepted", "log_likelihood", *names)}
    for z, u in zip(Z, U, strict=True):
        steps["x_prior"].append(kf.predict(u))
        steps["P_prior"].append(kf.P)
        kf.update(z)
        for name in ("accepted", "log_likelihood", *names):
            steps[name].append(getattr(kf, name))
    for name in ("x_prior", "P_prior", *names):
        assert_equal_to_rounding(getattr(trace, name), np.array(steps[name]))
    np.testing.assert_array_equal(trace.accepted, steps["accepted"])
    assert trace.log_likelihood == pytest.approx(sum(steps["log_likelihood"]), rel=1e-12)


@settings(max_examples=40, deadline=None)
@given(systems(max_states=5), SHARES)
def test_a_batch_is_its_tracks_step_by_step(drawn, share):
    """Some tracks share their gaps, the others have gaps of their own."""
    system, rng = drawn
    system = {name: values for name, values in system.items() if name != "B"}
    Z = with_gaps(rng, rng.normal(size=(9, 40, system["H"].shape[0])), share)
    Z[5:8][np.isnan(Z[[4, 4, 4]])] = np.nan
    kf = KalmanFilter(**system)
    for track, x in zip(Z, kalman_batch(**system, Z=Z), strict=True):
        kf.reset()
        steps = []
        for z in track:
            kf.predict()
            steps.append(kf.update(z))
        assert_equal_to_rounding(x, np.array(steps))


def test_more_tracks_than_a_block():
    rng = np.random.default_rng(1)
    kf = ball(x0=[2000, 0, 0, 0])
    Z = with_gaps(rng, rng.normal(size=(150, 20, 2)) * [30, 0.03] + [1500, 0.1], 0.2)
    Z[70:] = np.nan_to_num(Z[70:], nan=1500.0)  # more than a block of them share no gaps
    x = kalman_batch(kf.A, kf.H, kf.Q, kf.R, Z, x0=kf.x0, P0=kf.P0)
    for track, z in zip(x, Z, strict=True):
        np.testing.assert_allclose(track, kf.filter(z).x, rtol=1e-12, atol=1e-12)


def test_smoothing_where_part_of_the_state_is_known_exactly():
    """P_prior is singular: the velocity is known, the distance is not."""
    still = {"Q": np.zeros((4, 4)), "P0": np.diag([100.0, 0.0, 0.0, 0.0]), "x0": [0, 0.1, 5, 0]}
    kf = ball(**still)
    Z = np.random.default_rng(2).normal(size=(30, 2)) * [20, 0.03] + [1500, 0.1]
    trace = kf.filter(Z)
    x, P = kf.smooth(trace)
    np.testing.assert_allclose(x[:, 0] - x[-1, 0], 0.64 * 5 * np.arange(-29, 1), atol=1e-9)
    np.testing.assert_allclose(P[:, 0, 0], trace.P[-1, 0, 0], rtol=1e-9)
    np.testing.assert_array_equal(x[:, 2], 5)


@pytest.mark.parametrize("odd", [1000.0, np.nan])
def test_a_sighting_that_is_not_used_does_not_look_like_convergence(odd):
    """Of a thing at rest, P_prior stays the same after such a row, and then falls on."""
    kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[1]], gate=0.99)
    for k in range(6):
        Z = np.zeros((12, 1))
        Z[k] = odd
        P = kf.filter(Z).P[:, 0, 0]
        np.testing.assert_allclose(np.delete(P, k), 1 / np.arange(2, 13), rtol=1e-12)
