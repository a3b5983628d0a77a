"""Pruning: the small simplex method against HiGHS, sums against all sums, who dominates whom."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from arkaq_edu.pomdp import dominated, prune
from arkaq_edu.pomdp.pruning import distance, gain, needed_sums

seeds = st.integers(0, 2**32 - 1)


def random_vectors(seed, max_vectors=25, max_states=8):
    """Return vectors of a kind that makes trouble: ties, near copies, zeros, large offsets."""
    rng = np.random.default_rng(seed)
    K, S = rng.integers(1, max_vectors + 1), rng.integers(1, max_states + 1)
    kind = rng.integers(5)
    A = rng.normal(size=(K, S))
    if kind == 1:
        A = rng.integers(0, 4, size=(K, S)).astype(float)
    elif kind == 2:  # copies, some a little off
        A = A[rng.integers(0, max(1, K // 2), size=K)]
        A += rng.choice([0, 0, 1e-13, 1e-7], size=(K, 1)) * rng.normal(size=(K, S))
    elif kind == 3:  # most states decide nothing
        A *= rng.random(S) < 0.4
    elif kind == 4:  # tangents of a bowl, so that many are needed, high up
        x = rng.dirichlet(np.ones(S), size=K)
        A = 1000 + 20 * (2 * x - (x**2).sum(axis=1, keepdims=True))
    return A


def highs_gain(w, others):
    """Return max_b min_k b . (w - u_k) by SciPy's HiGHS."""
    K, S = others.shape
    found = linprog(
        np.r_[np.zeros(S), -1],
        A_ub=np.c_[others - w, np.ones(K)], b_ub=np.zeros(K),
        A_eq=[np.r_[np.ones(S), 0]], b_eq=[1], bounds=[(0, 1)] * S + [(None, None)],
    )  # fmt: skip
    assert found.status == 0
    return -found.fun


@settings(max_examples=150, deadline=None)
@given(seeds)
def test_the_gain_is_that_of_highs_and_both_its_proofs_hold(seed):
    A = random_vectors(seed)
    w, others = A[0], A[1:] if len(A) > 1 else A
    bound, b, mixture = gain(A[:1], others)
    assert bound == pytest.approx(highs_gain(w, others), abs=1e-5)  # as close as HiGHS is
    for weights in (b, mixture):
        assert weights.min() >= 0
        assert weights.sum() == pytest.approx(1)
    # The belief earns the gain; the mixture allows no more.
    assert (w @ b - others @ b).min() == pytest.approx(bound, abs=1e-10)
    assert (w - mixture @ others).max() == pytest.approx(bound, abs=1e-10)


@settings(max_examples=60, deadline=None)
@given(seeds)
def test_what_is_pruned_adds_nothing_and_what_is_kept_is_needed(seed):
    A = random_vectors(seed, max_vectors=15, max_states=5)
    kept = prune(A, tol=1e-9)
    assert (np.diff(kept) > 0).all()
    for k in np.setdiff1d(np.arange(len(A)), kept):
        assert gain(A[[k]], A[kept])[0] <= 1.1e-9
        assert highs_gain(A[k], A[kept]) <= 1e-5  # as close as HiGHS is
    for k in kept:
        if len(kept) > 1:
            assert gain(A[[k]], A[kept[kept != k]])[0] >= -1e-9


def test_two_states_are_a_sort():
    """On two states the vectors are lines: walk along their upper envelope."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        A = rng.normal(size=(12, 2))
        on_top, x = [int(A[:, 1].argmax())], 0.0  # x is p(s1)
        while x < 1:
            here = A[on_top[-1]]
            with np.errstate(divide="ignore", invalid="ignore"):
                rise = (A[:, 0] - A[:, 1]) - (here[0] - here[1])
                cross = np.where(rise > 1e-12, (here[1] - A[:, 1]) / rise, np.inf)
            cross[on_top] = np.inf
            x = cross.min()
            if x < 1:
                on_top.append(int(cross.argmin()))
        assert prune(A).tolist() == sorted(on_top)


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_the_needed_sums_are_those_of_all_sums(seed):
    rng = np.random.default_rng(seed)
    A, B = random_vectors(seed, 8, 4), random_vectors(seed + 1, 8, 4)
    S = min(A.shape[1], B.shape[1])
    A, B = A[:, :S].copy(), B[:, :S].copy()
    everything = (A[:, np.newaxis] + B).reshape(-1, S)
    looked_at = rng.dirichlet(np.ones(S), size=3)
    for given_seeds in (None, looked_at):
        pairs, beliefs, lost = needed_sums(A, B, 1e-9, given_seeds)
        sums = A[pairs[:, 0]] + B[pairs[:, 1]]
        assert len(np.unique(pairs, axis=0)) == len(pairs)
        assert lost <= 2e-9 + 1e-11 * (np.ptp(A) + np.ptp(B))
        assert gain(everything, sums)[0] <= lost * (1 + 1e-6) + 1e-12
        np.testing.assert_allclose(
            (beliefs * sums).sum(axis=1), (beliefs @ everything.T).max(axis=1), atol=1e-8
        )


def test_more_sums_than_there_was_room_for():
    x = np.random.default_rng(1).dirichlet(np.ones(6), size=(2, 30))
    bowl, other = 2 * x - (x**2).sum(axis=2, keepdims=True)
    pairs, _, _ = needed_sums(bowl, other, 0.0)
    assert len(pairs) > 2 * (30 + 30) + 64
    everything = (bowl[:, np.newaxis] + other).reshape(-1, 6)
    assert gain(everything, bowl[pairs[:, 0]] + other[pairs[:, 1]])[0] <= 1e-10


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_the_distance_of_two_surfaces_is_that_of_highs(seed):
    A, C = random_vectors(seed, 8, 4), random_vectors(seed + 1, 8, 4)
    S = min(A.shape[1], C.shape[1])
    A, C = A[:, :S], C[:, :S]
    expected = max(highs_gain(w, C) for w in A), max(highs_gain(w, A) for w in C)
    found, b = distance(A, C)
    assert found == pytest.approx(max(0, *expected), rel=1e-6, abs=1e-7)
    assert abs((A @ b).max() - (C @ b).max()) == pytest.approx(found, rel=1e-9, abs=1e-9)


def test_a_coarse_tolerance_leaves_out_what_adds_little():
    A = [[1, 0], [0, 1], [0.51, 0.51]]
    assert prune(A).tolist() == [0, 1, 2]
    assert prune(A, tol=0.02).tolist() == [0, 1]


# --- domination: thesis 2.3.6 and figure 2.17 -----------------------------------------------------


@pytest.mark.thesis("errata row 18")
def test_figure_2_17_pc_is_dominated_only_jointly():
    pa, pb, pc, pd = A = np.array([[4, 0], [0, 4], [1.8, 1.8], [1.5, 1.5]])
    # Comparing two at a time finds only p_d.
    assert (pd <= pc).all() and not (pc <= pa).all() and not (pc <= pb).all()
    by_pc, by_pd = dominated(A)
    assert (by_pc.index, by_pc.by) == (2, (0, 1))
    assert (by_pd.index, by_pd.by, by_pd.weights.tolist()) == (3, (2,), [1])
    assert by_pc.at([0.6, 0.4]) == 0 and by_pc.at([0.4, 0.6]) == 1


@settings(max_examples=60, deadline=None)
@given(seeds)
def test_every_domination_comes_with_its_proof(seed):
    A = random_vectors(seed, max_vectors=15, max_states=5)
    found = dominated(A)
    assert [d.index for d in found] == sorted(set(range(len(A))) - set(prune(A).tolist()))
    for d in found:
        assert d.index not in d.by and len(set(d.by)) == len(d.by) == len(d.weights)
        assert d.weights.min() > 0 and d.weights.sum() == pytest.approx(1)
        assert (d.weights @ A[list(d.by)] >= A[d.index] - 2e-9).all()
        np.testing.assert_array_equal(d.lead, A[list(d.by)] - A[d.index])
        alone = [k for k in range(len(A)) if k != d.index and (A[k] >= A[d.index] - 1e-9).all()]
        assert (len(d.by) == 1) == bool(alone)


def test_of_equal_vectors_one_stays():
    A = np.array([[1.0, 2.0], [1.0, 2.0], [2.0, 1.0]])
    assert prune(A).tolist() == [0, 2]
    (copy,) = dominated(A)
    assert (copy.index, copy.by) == (1, (0,))


def test_bad_vectors_are_refused():
    with pytest.raises(ValueError, match=r"alphas must have shape \(any, any\), got \(2,\)"):
        prune([1, 2])
    with pytest.raises(ValueError, match="alphas must hold finite numbers, got nan"):
        dominated([[np.nan, 1]])
    with pytest.raises(ValueError, match="alphas must have at least one row"):
        prune(np.empty((0, 2)))
    with pytest.raises(ValueError, match="tol must be"):
        prune([[1, 2]], tol=-1)
    for function in (prune, dominated):
        with pytest.raises(ValueError, match=r"tol must be a number in \[0, inf\), got inf"):
            function([[1, 2], [2, 1]], tol=np.inf)
    assert prune([[1, 2], [2, 1]], tol=1e99).size == 1


def test_who_is_ahead_is_asked_of_a_belief():
    (found,) = dominated([[1.0, 0.0], [0.0, 1.0], [0.4, 0.4]])
    assert found.at([0.9, 0.1]) == 0 and found.at([0.1, 0.9]) == 1
    with pytest.raises(ValueError, match="b must sum to 1"):
        found.at([3.0, 0.0])
