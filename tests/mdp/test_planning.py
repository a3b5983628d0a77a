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
    policy_chances,
    policy_evaluation,
    policy_iteration,
    policy_model,
    value_iteration,
)
from tests.mdp.worlds import all_policies, random_mdp, seeds, undiscounted_return


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
    for values, policy in (value_iteration(mdp), policy_iteration(mdp)):
        np.testing.assert_allclose(values, best, atol=2e-9)
        np.testing.assert_allclose(value_by_series(mdp, policy), best, atol=1e-6)


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_values_agree_with_the_linear_program(seed):
    mdp = random_mdp(seed, max_states=12, max_actions=4)
    np.testing.assert_allclose(value_iteration(mdp)[0], value_by_linear_program(mdp), atol=1e-5)


@settings(max_examples=40, deadline=None)
@given(seeds, st.sampled_from([1.0, 1e-3, 1e-8]))
def test_value_iteration_is_as_close_as_it_says(seed, tol):
    mdp = random_mdp(seed, max_states=10)
    exact, _ = policy_iteration(mdp)
    assert np.abs(value_iteration(mdp, tol=tol)[0] - exact).max() <= tol * (1 + 1e-6)


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
        (lambda m: value_iteration(m, horizon=0), "horizon must be an integer in .1, 1000000., got 0"),
        (lambda m: value_iteration(m, horizon=2.5), "horizon must be an integer in .1, 1000000., got 2.5"),
        (lambda m: error_bound(m, [0.0]), r"values must have shape \(2,\), got \(1,\)"),
        (lambda m: policy_evaluation(m, [0, 2]), r"policy must hold integers in \[0, 0\], got 2"),
        (lambda m: policy_evaluation(m, [0]), r"policy must have shape \(2,\), got \(1,\)"),
        (lambda m: policy_evaluation(m, [[1.0], [0.5]]), "policy must sum to 1"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(MDP([np.eye(2)], [[1.0], [2.0]], 0.9))
