"""Bounds from points: below and above the optimal value everywhere, together where it matters."""

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings
from scipy import sparse

from arkaq_edu.mdp import policy_iteration
from arkaq_edu.pomdp import (
    POMDP,
    UpperBound,
    belief_update,
    point_kernels,
    problem,
    solve_point_based,
    solve_pomdp,
    successors,
)
from arkaq_edu.pomdp.point_based import _Growing, _Lower, fast_informed_bound
from tests.pomdp.large import rock_sample_5_4, tag


@st.composite
def small_pomdps(draw):
    """Random models with many zeros among their probabilities."""
    n_states = draw(st.integers(1, 3))
    n_actions, n_observations = draw(st.integers(1, 2)), draw(st.integers(1, 2))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))

    def rows(*shape):
        x = rng.random(shape) * (rng.random(shape) < 0.6)
        x[..., 0] += x.sum(axis=-1) == 0
        return x / x.sum(axis=-1, keepdims=True)

    return POMDP(
        rows(n_actions, n_states, n_states),
        rows(n_actions, n_states, n_observations),
        rng.normal(size=(n_states, n_actions)) * 10 ** rng.uniform(-3, 3),
        draw(st.sampled_from([0.0, 0.3, 0.7])),
        rows(n_states),
    )


def beliefs_of(pomdp, rng, n=50):
    inside = rng.dirichlet(np.full(pomdp.n_states, 0.5), size=n)
    return np.concatenate([np.eye(pomdp.n_states), pomdp.start[np.newaxis], inside])


@settings(max_examples=40, deadline=None)
@given(pomdp=small_pomdps(), max_backups=st.sampled_from([0, 1, 7, 200]))
def test_the_optimal_value_lies_between(pomdp, max_backups):
    found = solve_point_based(pomdp, tol=1e-6, max_backups=max_backups)
    scale = np.abs(pomdp.R).max() / (1 - pomdp.gamma)
    exact = solve_pomdp(pomdp, tol=1e-4 * scale)
    beliefs = beliefs_of(pomdp, np.random.default_rng(0))
    optimal, slack = exact.value(beliefs), 2e-4 * scale
    lower, upper = found.lower.value(beliefs), found.upper(beliefs)
    assert (lower <= optimal + slack).all()
    assert (optimal <= upper + slack).all()
    assert (optimal - lower <= found.lower.error + slack).all()
    assert found.backups <= max_backups


@settings(max_examples=40, deadline=None)
@given(pomdp=small_pomdps())
def test_the_vectors_are_a_policy_graph_that_earns_at_least_them(pomdp):
    lower = solve_point_based(pomdp, tol=1e-6, max_backups=60).lower
    earned = lower.graph.values(pomdp)
    scale = np.abs(pomdp.R).max() / (1 - pomdp.gamma)
    assert (earned >= lower.alphas - 1e-9 * scale).all()


def test_the_tiger_to_a_thousandth():
    found = solve_point_based(problem("tiger"), tol=1e-3)
    assert found.gap <= 1e-3
    assert found.lower.value([0.5, 0.5]) <= 19.37137 <= found.upper([0.5, 0.5])
    assert found.lower.action([0.5, 0.5]) == 0
    assert found.backups < 2000
    # What others make superfluous is dropped; the exact value function has nine vectors.
    assert len(found.lower) < 20 and len(found.upper.points) < 200


@pytest.mark.parametrize("name", ["ball_side", "corridor", "floors", "three_places"])
def test_the_courses_problems_close(name):
    pomdp = problem(name)
    found = solve_point_based(pomdp)
    assert -1e-9 <= found.gap <= 1e-3
    optimal = solve_pomdp(pomdp, tol=1e-4).value(pomdp.start)
    assert found.lower.value(pomdp.start) - 1e-4 <= optimal <= found.upper(pomdp.start) + 1e-4


def test_more_backups_close_the_gap_further():
    gaps = [solve_point_based(problem("two_state"), max_backups=n).gap for n in (0, 30, 300)]
    assert gaps[0] > 2 * gaps[1] > 4 * gaps[2] > 0


def corridor_of(n):
    """A corridor with a goal half-way, and a sensor that tells its ends apart and often errs."""
    T = np.zeros((2, n, n))
    cells = np.arange(n)
    for a, way in enumerate((-1, 1)):
        T[a, cells, np.clip(cells + way, 0, n - 1)] += 0.8
        T[a, cells, cells] += 0.2
    T[:, n // 2] = 1 / n  # from the goal anywhere
    O = np.full((2, n, 3), [0.1, 0.8, 0.1])  # noqa: E741
    O[:, 0], O[:, -1] = [0.8, 0.1, 0.1], [0.1, 0.1, 0.8]
    R = np.zeros((n, 2))
    R[n // 2] = 1
    return POMDP(T, O, R, 0.95)


def test_forty_states_are_within_reach():
    pomdp = corridor_of(40)
    found = solve_point_based(pomdp, max_backups=400)
    blind = solve_point_based(pomdp, max_backups=0)
    assert found.lower.value(pomdp.start) > 1.25 * blind.lower.value(pomdp.start)
    assert found.gap < 0.5 * blind.gap
    # What it promises is earned: act by it from 200 starts for 90 steps.
    rng = np.random.default_rng(0)
    earned = []
    for s in rng.choice(40, size=200, p=pomdp.start):
        b, total = pomdp.start, 0.0
        for t in range(90):
            a = found.lower.action(b)
            total += pomdp.gamma**t * pomdp.R[s, a]
            s, z, _, _ = pomdp.step(int(s), a, rng)
            b = belief_update(pomdp, b, a, int(z))
        earned.append(total)
    error = np.std(earned) / np.sqrt(len(earned))
    low, high = found.lower.value(pomdp.start), found.upper(pomdp.start)
    assert low - 3 * error <= np.mean(earned) <= high + 3 * error


@settings(max_examples=40, deadline=None)
@given(pomdp=small_pomdps())
def test_the_informed_bound_is_between_v_star_and_the_mdp(pomdp):
    vectors = fast_informed_bound(pomdp)
    seen, _ = policy_iteration(pomdp.mdp)
    slack = 1e-8 * np.abs(pomdp.R).max() / (1 - pomdp.gamma)
    assert (vectors.max(axis=0) <= seen + slack).all()
    exact = solve_pomdp(pomdp, horizon=4)
    rest = pomdp.gamma**4 * np.abs(pomdp.R).max() / (1 - pomdp.gamma)
    beliefs = beliefs_of(pomdp, np.random.default_rng(0))
    assert (exact.value(beliefs) - rest <= (beliefs @ vectors.T).max(axis=1) + slack).all()


@settings(max_examples=20, deadline=None)
@given(pomdp=small_pomdps())
def test_the_upper_bound_is_nowhere_above_the_informed_one(pomdp):
    beliefs = beliefs_of(pomdp, np.random.default_rng(0))
    informed = (beliefs @ fast_informed_bound(pomdp).T).max(axis=1)
    found = solve_point_based(pomdp, max_backups=3)
    assert (found.upper(beliefs) <= informed + 1e-9 * np.abs(informed).max()).all()


def test_a_plan_goes_on_with_what_dominates_its_dominator():
    lower = _Lower(POMDP([np.eye(2)], np.ones((1, 2, 1)), [[0.0], [0.0]], 0.9))
    lower.alphas = _Growing(np.array([[0.0, 0], [1, 1], [5, 0], [2, 2]]))
    lower.actions = _Growing(np.zeros(4, int))
    lower.branches = _Growing(np.array([[0], [1], [0], [1]]))
    lower.limit = 3
    lower.tidy()
    assert lower.alphas.filled.tolist() == [[5, 0], [2, 2]]
    assert lower.branches.filled.tolist() == [[1], [1]]


def test_the_same_model_gives_the_same_bytes():
    one, other = (solve_point_based(problem("tiger"), max_backups=100) for _ in range(2))
    assert one.lower.alphas.tobytes() == other.lower.alphas.tobytes()
    assert one.upper.values.tobytes() == other.upper.values.tobytes()
    assert repr(one) == repr(other)


def sawtooth(b, corners, points, values, vectors):
    """The upper bound in plain NumPy, one point after the other."""
    deepest = 0.0
    for p, value in zip(points, values, strict=True):
        inside = p > 0
        r = (b[inside] / p[inside]).min()
        deepest = min(deepest, r * (value - p @ corners))
    return min(b @ corners + deepest, (vectors @ b).max())


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_compiled_bounds_are_the_plain_ones(seed):
    rng = np.random.default_rng(seed)
    S, N = int(rng.integers(1, 6)), int(rng.integers(0, 8))
    beliefs, points = (rng.dirichlet(np.full(S, 0.2), size=n).round(2) for n in (6, N))
    beliefs, points = (
        (x + 1e-300 * (x.sum(axis=1, keepdims=True) == 0)) for x in (beliefs, points)
    )
    beliefs, points = (x / x.sum(axis=1, keepdims=True) for x in (beliefs, points))
    corners, vectors = rng.normal(size=S) + 3, rng.normal(size=(2, S)) + 2
    upper = UpperBound(corners, points, points @ corners - rng.random(N), vectors)
    expected = [sawtooth(b, corners, points, upper.values, vectors) for b in beliefs]
    np.testing.assert_allclose(upper(beliefs), expected, atol=1e-12)
    assert upper(beliefs[0]) == upper(beliefs)[0]
    rows = sparse.csr_array(beliefs)
    bounds, best = point_kernels.lower((rows.indptr, rows.indices, rows.data), vectors)
    np.testing.assert_allclose(bounds, (beliefs @ vectors.T).max(axis=1), atol=1e-12)
    assert best.tolist() == (beliefs @ vectors.T).argmax(axis=1).tolist()


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_points_and_vectors_that_add_nothing_are_dropped(seed):
    rng = np.random.default_rng(seed)
    S, N = int(rng.integers(1, 4)), int(rng.integers(1, 9))
    points = rng.dirichlet(np.full(S, 0.5), size=N)
    points[rng.random(N) < 0.3] = points[0]
    below = -rng.random(N).round(1)
    rows = sparse.csr_array(points)
    found = point_kernels.needed((rows.indptr, rows.indices, rows.data), below, S)
    zero, far = np.zeros(S), np.full((1, S), 9.0)
    for b in [*points, *rng.dirichlet(np.ones(S), size=20)]:
        one, other = (sawtooth(b, zero, points[x], below[x], far) for x in (found, slice(None)))
        assert one == pytest.approx(other, abs=1e-12)
    alphas = rng.integers(0, 4, size=(N, S)).astype(float)
    by = np.arange(N)
    point_kernels.dominated(alphas, by)
    for i, j in enumerate(by):
        assert (alphas[i] <= alphas[j]).all()
    kept = alphas[by == np.arange(N)]
    assert (kept[:, np.newaxis] <= kept).all(axis=2).sum() == len(kept)


def test_a_sparse_model_has_the_bounds_of_the_dense_one():
    pomdp = corridor_of(12)
    T, O = ([sparse.csr_array(M) for M in table] for table in (pomdp.T, pomdp.O))  # noqa: E741
    twin = POMDP(T, O, pomdp.R, pomdp.gamma)
    one, other = (solve_point_based(p, max_backups=100) for p in (pomdp, twin))
    assert one.lower.alphas.tobytes() == other.lower.alphas.tobytes()
    assert one.upper.values.tobytes() == other.upper.values.tobytes()


def test_the_first_bounds_hold_wherever_their_iteration_stops(monkeypatch):
    pomdp = corridor_of(12)
    best = solve_point_based(pomdp, max_backups=200)
    before = solve_point_based(pomdp, max_backups=0)
    monkeypatch.setattr("arkaq_edu.pomdp.point_based.MOST_SOLVED", 0)
    repeated = solve_point_based(pomdp, max_backups=0)
    np.testing.assert_allclose(repeated.lower.alphas, before.lower.alphas, atol=1e-6)
    assert (repeated.lower.alphas <= before.lower.alphas + 1e-12).all()
    monkeypatch.setattr("arkaq_edu.pomdp.point_based.MOST_WORK", 1500)
    early = solve_point_based(pomdp, max_backups=0)
    beliefs = beliefs_of(pomdp, np.random.default_rng(0))
    assert (early.lower.value(beliefs) <= best.lower.value(beliefs) + 1e-9).all()
    assert (early.upper(beliefs) >= best.upper(beliefs) - 1e-9).all()
    assert early.gap > before.gap


def test_the_time_ends_the_search():
    pomdp = corridor_of(40)
    blind = solve_point_based(pomdp, seconds=0)
    assert blind.backups == 0
    found = solve_point_based(pomdp, tol=1e-9, max_backups=10**9, seconds=0.5)
    assert 0 < found.backups < 10**6
    beliefs = beliefs_of(pomdp, np.random.default_rng(0))
    assert (found.lower.value(beliefs) <= found.upper(beliefs) + 1e-9).all()
    assert found.gap <= blind.gap
    for seconds in (-1, np.inf, "1"):
        with pytest.raises(ValueError, match="seconds must be"):
            solve_point_based(pomdp, seconds=seconds)


def test_tag_and_rock_sample():
    """Bounds at the start that hold the values of the literature: about -6 and 17 to 18."""
    for pomdp, states, low, high in ((tag(), 870, -19, 0), (rock_sample_5_4(), 401, 12, 21)):
        assert pomdp.n_states == states and isinstance(pomdp.T, tuple)
        found = solve_point_based(pomdp, max_backups=60)
        assert low < found.lower.value(pomdp.start) < found.upper(pomdp.start) < high
        b = pomdp.start
        for _ in range(10):  # the vectors bound what their actions earn from where they lead
            a = found.lower.action(b)
            chances, beliefs = successors(pomdp, b, a)
            can = chances > 0
            assert found.lower.value(b) <= 1e-9 + b @ pomdp.R[:, a] + pomdp.gamma * (
                chances[can] @ found.lower.value(beliefs[can])
            )
            b = beliefs[chances.argmax()]


def test_what_is_refused():
    with pytest.raises(ValueError, match="pomdp must be a POMDP, got 'tiger'"):
        solve_point_based("tiger")
    tiger = problem("tiger")
    for tol in (0, -1, np.nan, "small"):
        with pytest.raises(ValueError, match="tol must be"):
            solve_point_based(tiger, tol=tol)
    for n in (-1, 2.5):
        with pytest.raises(ValueError, match="max_backups must be an integer >= 0"):
            solve_point_based(tiger, max_backups=n)
    upper = solve_point_based(tiger, max_backups=3).upper
    for b in ([0.5, 0.6], [1.0], [[0.5, 0.5], [0.2, 0.2]]):
        with pytest.raises(ValueError, match="b must"):
            upper(b)
