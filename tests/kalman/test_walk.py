"""The simulated walk, and the filter that fits it."""

import numpy as np
import pytest

from arkaq_edu.kalman import chi_square_band, fit_noise
from arkaq_edu.kalman.walk import simulated_walk, walk_filter

WALK = simulated_walk()


def test_over_many_walks_the_noises_are_as_named():
    walks = [simulated_walk(seed) for seed in range(200)]
    errors = np.concatenate([one.Z[:, 0] - one.truth for one in walks])
    steps = np.concatenate([np.diff(one.truth) + 100 * one.U[1:, 0] for one in walks])
    assert errors.std() == pytest.approx(100, rel=0.03)
    assert steps.std() == pytest.approx(25, rel=0.03)
    traces = [walk_filter(100, 25).filter(one.Z, one.U) for one in walks]
    nis = np.concatenate([trace.nis for trace in traces])
    low, high = chi_square_band(1, len(nis), 0.999)
    assert low < nis.mean() < high
    assert {one.U.sum() for one in walks} == {30.0}


def test_a_walk_is_its_seeds():
    assert (simulated_walk(7).Z == simulated_walk(7).Z).all()
    assert (simulated_walk(7).Z != simulated_walk(8).Z).any()


def test_likelihood_finds_the_noise_by_itself():
    found = fit_noise(walk_filter(10, 10), WALK.Z, WALK.U)
    assert np.sqrt(found.R[0, 0]) == pytest.approx(100, rel=0.2)
    trace = found.filter(WALK.Z, WALK.U)
    told = walk_filter(100, 25).filter(WALK.Z, WALK.U)
    assert trace.log_likelihood >= told.log_likelihood


@pytest.mark.parametrize("r, q, name", [(-1.0, 1.0, "r must"), (1.0, -1.0, "q must")])
def test_a_negative_deviation_is_refused(r, q, name):
    with pytest.raises(ValueError, match=name):
        walk_filter(r, q)
