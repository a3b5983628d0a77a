import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import optimize

from arkaq_edu.mdp import (
    MDP,
    best_actions,
    error_bound,
    finite_horizon,
    grid_world,
    modified_policy_iteration,
    policy_chances,
    policy_evaluation,
    policy_iteration,
    policy_model,
    value_iteration,
)
from tests.mdp.worlds import (
    all_policies,
    as_sparse,
    forbidding,
    random_mdp,
    random_shortest_path,
    seeds,
    undiscounted_return,
)

SOLVERS = (value_iteration, modified_policy_iteration, policy_iteration)


def value_by_series(mdp, policy):
    """The sum of gamma^t T^t R over t < 2^14, each round doubling the number of terms."""
    power = mdp.gamma * np.array([mdp.T[policy[s], s] for s in range(mdp.n_states)])
    total = np.array([mdp.R[s, policy[s]] for s in range(mdp.n_states)])
    for _ in range(14):
        total, power = total + power @ total, power @ power
    return total


def value_by_linear_program(mdp):
    """The least V that no action improves on: min sum V, V >= R(., a) + gamma T_a V."""
    rows = [mdp.gamma * mdp.T[a] - np.eye(mdp.n_states) for a in range(mdp.n_actions)]
    result = optimize.linprog(
        np.ones(mdp.n_states), np.vstack(rows), -mdp.R.T.ravel(), bounds=(None, None)
    )
    assert result.success
    return result.x


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_no_policy_earns_more_and_the_one_found_earns_as_much(seed):
    mdp = random_mdp(seed)
    best = np.max([value_by_series(mdp, p) for p in all_policies(mdp)], axis=0)
    for values, policy in (solve(mdp) for solve in SOLVERS):
        np.testing.assert_allclose(values, best, atol=2e-9)
        np.testing.assert_allclose(value_by_series(mdp, policy), best, atol=1e-6)


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_values_agree_with_the_linear_program(seed):
    mdp = random_mdp(seed, max_states=12, max_actions=4)
    np.testing.assert_allclose(value_iteration(mdp)[0], value_by_linear_program(mdp), atol=1e-5)


@pytest.mark.thesis("eq 2.6, eq 2.8, errata row 6")
@settings(max_examples=40, deadline=None)
@given(seeds, st.sampled_from([1.0, 1e-3, 1e-8]))
def test_value_iteration_is_as_close_as_it_says(seed, tol):
    mdp = random_mdp(seed, max_states=10)
    exact, _ = policy_iteration(mdp)
    for solve in (value_iteration, modified_policy_iteration):
        assert np.abs(solve(mdp, tol=tol)[0] - exact).max() <= tol * (1 + 1e-6)


@settings(max_examples=40, deadline=None)
@given(seeds, st.floats(0, 100))
def test_error_bound_is_one_and_is_tight_for_a_constant_error(seed, error):
    mdp = random_mdp(seed)
    exact, _ = policy_iteration(mdp)
    guess = exact + np.random.default_rng(seed).normal(scale=error, size=len(exact))
    assert np.abs(guess - exact).max() <= error_bound(mdp, guess) * (1 + 1e-9) + 1e-9
    assert error_bound(mdp, exact + error) == pytest.approx(error, abs=1e-9)


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(1, 4), st.sampled_from([1.0, 0.5, 0.0]))
def test_finite_horizon_is_the_best_of_all_plans(seed, horizon, gamma):
    mdp = random_mdp(seed, max_states=3, max_actions=3)

    def earn(s, a, steps):
        if steps == 1:
            return mdp.R[s, a]
        onward = [max(earn(t, b, steps - 1) for b in range(mdp.n_actions)) for t in states]
        return mdp.R[s, a] + gamma * sum(mdp.T[a, s, t] * onward[t] for t in states)

    states = range(mdp.n_states)
    expected = [[earn(s, a, horizon) for a in range(mdp.n_actions)] for s in states]
    np.testing.assert_allclose(finite_horizon(mdp, horizon, gamma)[-1], expected, atol=1e-9)


def test_horizons_one_by_one_lead_to_the_endless_one():
    mdp = random_mdp(7, gamma=0.9)
    exact, _ = policy_iteration(mdp)
    for h in (1, 5, 50):
        values, policy = value_iteration(mdp, horizon=h)
        Q = finite_horizon(mdp, h, mdp.gamma)[-1]
        assert (values == Q.max(axis=1)).all() and (policy == Q.argmax(axis=1)).all()
        assert np.abs(values - exact).max() <= 0.9**h * np.abs(mdp.R).max() / 0.1


@pytest.mark.thesis("errata row 5")
def test_the_first_reward_is_not_discounted():
    """Thesis equation 2.7 prints V1 = gamma max R; from V0 = 0, equation 2.8 gives max R."""
    mdp = random_mdp(3, gamma=0.5)
    assert (value_iteration(mdp, horizon=1)[0] == mdp.R.max(axis=1)).all()
    two_from_the_print = mdp.action_values(mdp.gamma * mdp.R.max(axis=1)).max(axis=1)
    assert not np.allclose(value_iteration(mdp, horizon=2)[0], two_from_the_print)


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_evaluation_of_a_random_policy_is_a_fixed_point_and_a_mean(seed):
    mdp = random_mdp(seed)
    chances = np.random.default_rng(seed).dirichlet(np.ones(mdp.n_actions), size=mdp.n_states)
    V = policy_evaluation(mdp, chances)
    np.testing.assert_allclose(V, (chances * mdp.action_values(V)).sum(axis=1), atol=1e-8)
    pure = [0] * mdp.n_states
    np.testing.assert_allclose(policy_evaluation(mdp, pure), value_by_series(mdp, pure), atol=1e-7)


def test_policies_that_never_differ_end_at_the_lowest_action():
    T = np.random.default_rng(0).dirichlet(np.ones(30), size=30)
    mdp = MDP([T] * 5, np.repeat(np.random.default_rng(1).normal(size=(30, 1)), 5, axis=1), 0.999)
    assert not policy_iteration(mdp)[1].any()
    assert not value_iteration(mdp, tol=1e-6)[1].any()


def test_value_iteration_ends_when_nothing_changes_any_more():
    class Counting(MDP):
        sweeps = 0

        def action_values(self, V):
            self.sweeps += 1
            return super().action_values(V)

    mdp = Counting([np.eye(2)[[1, 1]]], [[1.0], [0.0]], gamma=0.999)
    assert value_iteration(mdp)[0].tolist() == [1, 0]
    assert mdp.sweeps <= 3  # the bound alone would ask for more than 20,000


def test_actions_that_a_loose_tolerance_cannot_tell_apart_count_as_equal():
    """To wait for 1 a step, for ever, is worth 9 at the start; the other action pays 9 at once."""
    wait, take = [[0, 1, 0], [0, 1, 0], [0, 0, 1]], [[0, 0, 1], [0, 1, 0], [0, 0, 1]]
    mdp = MDP([wait, take], [[0, 9], [1, 1], [0, 0]], 0.9)
    values, policy = value_iteration(mdp, tol=0.5)
    assert 9.5 < values[1] < 10 and policy.tolist() == [0, 0, 0]


def test_gamma_near_one_and_a_tolerance_below_the_floats_still_end():
    mdp = MDP([[[0.5, 0.5], [0.5, 0.5]]], [[1e6], [-1e6 / 3]], 0.999)
    values, _ = value_iteration(mdp, tol=1e-12)
    np.testing.assert_allclose(values, policy_iteration(mdp)[0], rtol=1e-10)


def test_policy_forms_agree():
    mdp = random_mdp(11)
    policy = np.zeros(mdp.n_states, dtype=int)
    for one, other in zip(
        policy_model(mdp, policy), policy_model(mdp, policy_chances(mdp, policy)), strict=True
    ):
        assert (one == other).all()


@pytest.mark.parametrize(
    ("name", "gamma", "known"),
    [
        ("FrozenLake-v1", 0.999, 14 / 17),
        ("FrozenLake8x8-v1", 0.9999, 1.0),
        ("CliffWalking-v1", 0.99, -13.0),
        ("Taxi-v4", 0.99, 7.93),
    ],
)
def test_known_optimal_returns(name, gamma, known):
    mdp = MDP.from_gymnasium(name, gamma)
    values, policy = value_iteration(mdp, tol=1e-7)
    assert undiscounted_return(mdp, policy) == pytest.approx(known, abs=2e-3)
    np.testing.assert_allclose(values, policy_iteration(mdp)[0], atol=1e-6)
    assert values[-1] == 0


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_the_best_actions_are_all_that_earn_as_much(seed):
    Q = np.random.default_rng(seed).integers(-2, 3, size=(6, 3)).astype(float)
    best = best_actions(Q)
    for row, marks in zip(Q, best, strict=True):
        assert marks.tolist() == [q == max(row) for q in row]
    assert best_actions(Q + 1e-12 * np.arange(3), slack=1e-9).tolist() == best.tolist()
    with pytest.raises(ValueError, match=r"slack must be a number in \[0, inf\], got -1"):
        best_actions(Q, slack=-1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: value_iteration(m, tol=0), "tol must be a number in"),
        (
            lambda m: value_iteration(m, horizon=0),
            "horizon must be an integer in .1, 1000000., got 0",
        ),
        (
            lambda m: value_iteration(m, horizon=2.5),
            "horizon must be an integer in .1, 1000000., got 2.5",
        ),
        (lambda m: error_bound(m, [0.0]), r"values must have shape \(2,\), got \(1,\)"),
        (lambda m: policy_evaluation(m, [0, 2]), r"policy must hold integers in \[0, 0\], got 2"),
        (lambda m: policy_evaluation(m, [[1.0], [0.5, 0.5]]), "policy must be an array of numbers"),
        (
            lambda m: best_actions([[]]),
            r"Q must have shape \(S, A\), each at least 1, got \(1, 0\)",
        ),
        (lambda m: policy_evaluation(m, [0]), r"policy must have shape \(2,\), got \(1,\)"),
        (lambda m: policy_evaluation(m, [[1.0], [0.5]]), "policy must sum to 1"),
        (lambda m: value_iteration(m, horizon=10**9), r"in \[1, 1000000\], got 1000000000"),
        (lambda m: modified_policy_iteration(m, sweeps=-1), "sweeps must be an integer in"),
        (
            lambda m: finite_horizon(MDP([np.eye(300)], np.zeros((300, 1)), 0.9), 10**6),
            "horizon must need at most 2,147,483,648 bytes, got 2,400,000,000 bytes",
        ),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(MDP([np.eye(2)], [[1.0], [2.0]], 0.9))


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_sparse_models_have_the_same_plans(seed):
    dense = random_mdp(seed, max_states=8, sparse=True)
    lean = as_sparse(dense)
    for solve in SOLVERS:
        (values, policy), (same, same_policy) = solve(dense), solve(lean)
        np.testing.assert_allclose(same, values, atol=2e-9)
        np.testing.assert_array_equal(same_policy, policy)
    chances = np.random.default_rng(seed).dirichlet(np.ones(dense.n_actions), size=dense.n_states)
    for policy in ([0] * dense.n_states, chances):
        (T, R), (lean_T, lean_R) = policy_model(dense, policy), policy_model(lean, policy)
        np.testing.assert_allclose(lean_T.toarray(), T, atol=1e-15)
        np.testing.assert_allclose(lean_R, R, atol=1e-12)
        np.testing.assert_allclose(
            policy_evaluation(lean, policy), policy_evaluation(dense, policy), atol=1e-8
        )


@pytest.mark.parametrize("sweeps", [0, 1, 8, 200])
def test_sweeps_between_improvements_change_only_the_time(sweeps):
    mdp = random_mdp(7, max_states=12, gamma=0.99)
    values, policy = modified_policy_iteration(mdp, sweeps=sweeps)
    np.testing.assert_allclose(values, policy_iteration(mdp)[0], atol=1e-9)
    assert (policy == policy_iteration(mdp)[1]).all()


def test_the_bounds_end_value_iteration_long_before_the_change_is_small():
    class Counting(MDP):
        sweeps = 0

        def action_values(self, V):
            self.sweeps += 1
            return super().action_values(V)

    T = np.random.default_rng(0).dirichlet(np.ones(30), size=(3, 30))
    mdp = Counting(T, np.random.default_rng(1).normal(size=(30, 3)), 0.9999)
    values, _ = value_iteration(mdp)
    assert mdp.sweeps < 50  # until the change itself is small: 200,000
    np.testing.assert_allclose(values, policy_iteration(mdp)[0], atol=2e-9)


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_what_is_not_allowed_is_never_planned(seed):
    rng = np.random.default_rng(seed)
    mdp = random_mdp(seed, max_actions=4)
    R = mdp.R.copy()
    R[:, 1:][rng.random((mdp.n_states, mdp.n_actions - 1)) < 0.5] = -np.inf
    mdp = MDP(mdp.T, R, mdp.gamma)
    best = np.max([value_by_series(mdp, p) for p in all_policies(mdp)], axis=0)
    for solve in SOLVERS:
        for model in (mdp, as_sparse(mdp)):
            values, policy = solve(model)
            np.testing.assert_allclose(values, best, atol=2e-9)
            assert mdp.allowed[np.arange(mdp.n_states), policy].all()
    values, policy = value_iteration(mdp, horizon=3)
    assert mdp.allowed[np.arange(mdp.n_states), policy].all() and np.isfinite(values).all()
    assert (np.isneginf(finite_horizon(mdp, 3)) == ~mdp.allowed).all()


def test_a_policy_that_is_not_allowed_is_refused():
    mdp = forbidding([np.eye(2)] * 2, [[1.0, -np.inf], [0.0, 0.0]])
    assert policy_evaluation(mdp, [0, 1]).tolist() == pytest.approx([10, 0])
    for policy in ([1, 0], [[0.5, 0.5], [1, 0]]):
        with pytest.raises(ValueError, match="policy must take allowed actions, got action 1 in"):
            policy_evaluation(mdp, policy)


@settings(max_examples=60, deadline=None)
@given(seeds)
def test_with_a_discount_of_one_the_plan_is_the_best_proper_policy(seed):
    mdp = random_shortest_path(seed)
    values = []
    for policy in all_policies(mdp):
        try:
            values.append(policy_evaluation(mdp, policy))
        except ValueError as error:
            assert "policy must be proper when gamma is 1" in str(error)
            chain = policy_model(mdp, policy)[0]
            assert (np.linalg.matrix_power(chain, 1000)[:, mdp.ends].sum(axis=1) < 1e-3).any()
    for model in (mdp, as_sparse(mdp)):
        for solve in SOLVERS:
            V, policy = solve(model)
            np.testing.assert_allclose(V, np.max(values, axis=0), atol=1e-8)
            np.testing.assert_allclose(policy_evaluation(model, policy), V, atol=1e-8)


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("FrozenLake-v1", 14 / 17),
        ("FrozenLake8x8-v1", 1.0),
        ("CliffWalking-v1", -13.0),
        ("Taxi-v4", 7.93),
    ],
)
def test_undiscounted_environments_have_their_known_returns(name, known):
    mdp = MDP.from_gymnasium(name, gamma=1)
    values, policy = value_iteration(mdp)
    assert values @ mdp.start == pytest.approx(known, abs=5e-4)
    assert policy_evaluation(mdp, policy) @ mdp.start == pytest.approx(known, abs=5e-4)


def test_standing_still_for_nothing_is_no_way_out_of_a_cost():
    """To wait costs nothing, to leave costs 5: the best policy that ends leaves."""
    wait, leave = np.eye(2), [[0, 1], [0, 1]]
    values, policy = policy_iteration(MDP([wait, leave], [[0, -5], [0, 0]], 1.0))
    assert values.tolist() == [-5, 0] and policy[0] == 1


def test_what_has_no_value_at_a_discount_of_one_is_refused():
    wait, leave = np.eye(2), [[0, 1], [0, 1]]
    earns = MDP([wait, leave], [[1, 0], [0, 0]], 1.0)
    with pytest.raises(ValueError, match="R must let no loop earn without end when gamma is 1"):
        value_iteration(earns)
    with pytest.raises(ValueError, match=r"policy must be proper when gamma is 1 .* from state 0"):
        policy_evaluation(earns, [0, 0])
    assert value_iteration(earns, horizon=7)[0].tolist() == [7, 0]
    endless = MDP([wait], [[1.0], [0.0]], 1.0)
    with pytest.raises(ValueError, match=r"mdp must reach an end from every state .* from state 0"):
        modified_policy_iteration(endless)
    with pytest.raises(ValueError, match=r"gamma must be a number in \[0, 1\), got 1"):
        error_bound(endless, [0.0, 0.0])


def test_what_is_zero_up_to_rounding_is_a_positive_zero():
    row = grid_world(["x.....o"], slip=0.0).mdp
    wander = np.tile([0.5, 0.0, 0.5, 0.0], (7, 1))
    for mdp in (row, as_sparse(row)):
        V = policy_evaluation(mdp, wander)
        assert V[[0, 3, 6]].tolist() == [0.0, 0.0, 0.0] and not np.signbit(V[[0, 3, 6]]).any()
    chain = np.diag(np.ones(60), 1)
    chain[-1, -1] = 1
    R = np.eye(61)[:, [59]]
    small = policy_evaluation(MDP([chain], R, 0.5), [0] * 61)
    assert small.tolist() == [*(0.5 ** np.arange(59, -1, -1)), 0.0]


@pytest.mark.parametrize("unit", [1.0, 1e12])
def test_of_actions_that_are_equal_but_for_rounding_the_first_is_taken(unit):
    """0.1 + 0.2 is more than 0.3 by rounding."""
    T = np.zeros((2, 3, 3))
    T[0, 0, 2] = T[1, 0, 1] = 1
    T[:, 1:, 2] = 1
    R = np.array([[0.3, 0.1], [0.2, 0.2], [0.0, 0.0]]) * unit
    assert R[0, 1] + R[1, 0] > R[0, 0] or unit > 1
    for values, policy in (
        value_iteration(MDP(T, R, 1.0), horizon=2),
        value_iteration(MDP(T, R, 1.0)),
    ):
        np.testing.assert_allclose(values, np.array([0.3, 0.2, 0.0]) * unit)
        assert policy[0] == 0
    R[0, 1] += 1e-9 * unit
    assert value_iteration(MDP(T, R, 1.0), horizon=2)[1][0] == 1
