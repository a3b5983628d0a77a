"""The NIS of a track so far, and the band of a correct filter."""

import numpy as np
import pytest
from scipy import stats

from arkaq_edu import KalmanFilter


def walker():
    return KalmanFilter([[1.0]], [[1.0]], [[30.0**2]], [[60.0**2]], x0=[1500.0], P0=[[40.0**2]])


def test_the_running_nis_ends_at_the_tracks_own_mean_and_band():
    rng = np.random.default_rng(3)
    Z = rng.normal(1500, 60, (40, 1))
    Z[5:15] = np.nan
    trace = walker().filter(Z)
    n, mean, low, high = trace.running_nis()
    assert n.tolist() == list(range(1, 31))
    assert (mean[-1], low[-1], high[-1]) == pytest.approx(trace.nis_band())
    assert mean[:2] == pytest.approx([trace.nis[0], trace.nis[:2].mean()])
    assert low == pytest.approx(stats.chi2.ppf(0.025, n) / n)
    assert high == pytest.approx(stats.chi2.ppf(0.975, n) / n)


def test_a_blind_track_has_no_running_nis():
    assert [len(part) for part in walker().filter([[np.nan]] * 3).running_nis()] == [0] * 4
