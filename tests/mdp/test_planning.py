import itertools
import math
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import optimize, stats

from arkaq_edu.mdp import (
    MDP,
    average_reward,
    best_actions,
    delayed_rewards,
    discounted,
    error_bound,
    finite_horizon,
    grid_world,
    policy_chances,
    policy_evaluation,
    policy_iteration,
    policy_model,
    value_iteration,
)


def random_mdp(seed, max_states=4, max_actions=3, gamma=None, sparse=False):
    rng = np.random.default_rng(seed)
    S, A = int(rng.integers(1, max_states + 1)), int(rng.integers(1, max_actions + 1))
    T = rng.dirichlet(np.full(S, 0.5), size=(A, S))
    if sparse:  # chains that fall apart, rest, or turn in circles
        certain = rng.random((A, S)) < 0.7
        T[certain] = np.eye(S)[rng.integers(S, size=certain.sum())]
    gamma = rng.choice([0.0, 0.3, 0.9, 0.99]) if gamma is None else gamma
    return MDP(T, rng.normal(scale=3, size=(S, A)), gamma)


def all_policies(mdp):
    return itertools.product(range(mdp.n_actions), repeat=mdp.n_states)


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


seeds = st.integers(0, 2**32 - 1)


# --- planning -------------------------------------------------------------------------------------


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


# --- optimality models ----------------------------------------------------------------------------


def test_figure_2_2_to_the_printed_digits():
    world = delayed_rewards()
    assert finite_horizon(world, 5)[-1, 0].tolist() == [6, 0, 0]
    assert [f"{x:.3g}" for x in discounted(world)[0]] == ["16.2", "59", "58.5"]
    assert average_reward(world)[0].tolist() == [2, 10, 11]


def test_each_model_prefers_another_action():
    """The thesis reads from the discounted sums that the infinite horizon "must be preferred"."""
    world = delayed_rewards()
    models = finite_horizon(world, 5)[-1], discounted(world), average_reward(world)
    assert [int(Q[0].argmax()) for Q in models] == [0, 1, 2]


def test_the_sum_to_k_inclusive_is_one_reward_too_many_and_flips_the_choice():
    """Equation 2.1 sums t = 0..k; that gives 8, 10, 0 where figure 2.2 prints 6, 0, 0."""
    inclusive = finite_horizon(delayed_rewards(), 5 + 1)[-1, 0]
    assert inclusive.tolist() == [8, 10, 0]
    assert inclusive.argmax() != finite_horizon(delayed_rewards(), 5)[-1, 0].argmax()


@settings(max_examples=30, deadline=None)
@given(
    chains=st.lists(st.tuples(st.integers(1, 6), st.floats(-5, 20)), min_size=1, max_size=4),
    gamma=st.floats(0, 0.99),
    horizon=st.integers(1, 12),
)
def test_delayed_rewards_have_closed_forms(chains, gamma, horizon):
    delays, rewards = (list(x) for x in zip(*chains, strict=True))
    world = delayed_rewards(delays, rewards, gamma)
    later = [r * max(0, horizon - d) for d, r in chains]
    np.testing.assert_allclose(finite_horizon(world, horizon)[-1, 0], later, atol=1e-9)
    for_ever = [r * gamma**d / (1 - gamma) for d, r in chains]
    np.testing.assert_allclose(discounted(world)[0], for_ever, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(average_reward(world)[0], rewards, atol=1e-9)


def test_finite_depends_on_h_discounted_on_gamma_average_on_neither():
    choices = {g: int(discounted(delayed_rewards(gamma=g))[0].argmax()) for g in (0.3, 0.9, 0.95)}
    assert choices == {0.3: 0, 0.9: 1, 0.95: 2}
    horizons = {h: int(finite_horizon(delayed_rewards(), h)[-1, 0].argmax()) for h in (5, 10, 20)}
    assert horizons == {5: 0, 10: 1, 20: 2}
    averages = [average_reward(delayed_rewards(gamma=g))[0].tolist() for g in (0.0, 0.5, 0.99)]
    assert averages == [[2, 10, 11]] * 3


@settings(max_examples=60, deadline=None)
@given(seeds, st.booleans())
def test_average_reward_is_the_best_average_of_all_policies(seed, sparse):
    """Averages by brute force: the mean of the first 2^k powers of the chain, doubled up."""
    mdp = random_mdp(seed, gamma=0.5, sparse=sparse)
    best = np.full(mdp.n_states, -np.inf)
    for policy in all_policies(mdp):
        states = range(mdp.n_states)
        power = np.array([mdp.T[policy[s], s] for s in states])
        mean = np.eye(mdp.n_states)
        for _ in range(40):
            mean, power = (mean + power @ mean) / 2, power @ power
            power /= power.sum(axis=1, keepdims=True)
        best = np.maximum(best, mean @ np.array([mdp.R[s, policy[s]] for s in states]))
    expected = np.array([mdp.T[a] @ best for a in range(mdp.n_actions)]).T
    np.testing.assert_allclose(average_reward(mdp), expected, atol=1e-6)


@pytest.mark.parametrize("unit", [1e-15, 1e15])
def test_average_reward_does_not_depend_on_the_unit(unit):
    world = delayed_rewards(rewards=np.array([2.0, 10.0, 11.0]) * unit)
    np.testing.assert_allclose(average_reward(world)[0] / unit, [2, 10, 11])
    reached, missed = np.array([[0, 1], [0, 1.0]]), np.eye(2)
    mdp = MDP([missed, reached], np.array([[0, -1], [3, 3.0]]) * unit, 0.9)
    np.testing.assert_allclose(average_reward(mdp) / unit, [[3, 3], [3, 3]])


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_average_is_the_limit_of_the_discounted_value_per_step(seed):
    mdp = random_mdp(seed, max_states=6, gamma=0.5, sparse=True)
    gamma = 1 - 1e-7
    near = MDP(mdp.T, mdp.R, gamma)
    np.testing.assert_allclose((1 - gamma) * discounted(near), average_reward(mdp), atol=1e-3)


# --- the model ------------------------------------------------------------------------------------


def test_steps_follow_the_model():
    mdp = random_mdp(21, max_states=4)
    mdp = MDP(np.random.default_rng(2).dirichlet(np.ones(4), size=(2, 4)), np.zeros((4, 2)), 0.9)
    n = 20_000
    s_next, r, _ = mdp.step(np.full(n, 2), 1, rng=5)
    assert stats.chisquare(np.bincount(s_next, minlength=4), n * mdp.T[1, 2]).pvalue > 1e-3
    assert not r.any()


def test_steps_never_go_where_the_probability_is_zero():
    mdp = MDP([[[0, 1, 0], [0.1, 0, 0.9], [0, 0, 1]]], [[1], [2], [3]], 0.9)
    s = np.random.default_rng(0).integers(3, size=5000)
    s_next, r, _ = mdp.step(s, 0, rng=1)
    assert (mdp.T[0, s, s_next] > 0).all()
    assert (r == s + 1).all()


class Last(np.random.Generator):
    """A generator that draws the largest number below 1."""

    def random(self, size=None):
        return np.full(size, np.nextafter(1, 0))


def test_a_row_that_sums_to_nearly_one_is_never_drawn_past():
    short = [0.5, 0.5 - 8e-10, 0.0]
    mdp = MDP([[short, short, [0, 0, 1]]], [[0.0]] * 3, 0.9)
    s_next, _, _ = mdp.step([0, 1], 0, rng=Last(np.random.PCG64(0)))
    assert s_next.tolist() == [1, 1]


def test_ends_are_left_by_no_action_and_earn_nothing():
    stay, go = np.eye(3), [[0, 1, 0], [0, 1, 0], [0, 0, 1]]
    mdp = MDP([stay, go], [[0, 0], [0, 5], [0, 0]], 0.9)
    assert mdp.ends.tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"T": [[[1.0, 0.1], [0, 1]]]},
            r"T must sum to 1 along its last axis, got 1.1 at \(0, 0\)",
        ),
        (
            {"T": [[[1.5, -0.5], [0, 1]]]},
            r"T must hold probabilities >= 0, got -0.5 at \(0, 0, 1\)",
        ),
        ({"T": [[[math.nan, 1], [0, 1]]]}, r"T must hold finite numbers, got nan at \(0, 0, 0\)"),
        ({"T": [[1.0, 0], [0, 1]]}, r"T must have shape \(any, any, any\), got \(2, 2\)"),
        ({"T": [[[0.5, 0.5]]]}, r"T must have shape \(A, S, S\), none of them 0, got \(1, 1, 2\)"),
        ({"T": np.zeros((0, 2, 2))}, "T must have shape"),
        ({"R": [[1.0, 2.0]]}, r"R must have shape \(2, 1\), got \(1, 2\)"),
        ({"R": [[1.0], [math.inf]]}, r"R must hold finite numbers, got inf at \(1, 0\)"),
        ({"gamma": 1.0}, r"gamma must be a number in \[0, 1\), got 1.0"),
        ({"R": [[1.0], [-2e307]]}, r"R must lie in \[-1.798e\+307, 1.798e\+307\] .* got 2e\+307"),
        ({"gamma": -0.1}, r"gamma must be a number in \[0, 1\), got -0.1"),
        ({"start": [0.5, 0.4]}, "start must sum to 1"),
    ],
)
def test_bad_models_are_refused(change, message):
    good = {"T": [[[1.0, 0.0], [0.0, 1.0]]], "R": [[1.0], [2.0]], "gamma": 0.9}
    MDP(**good)
    with pytest.raises(ValueError, match=message):
        MDP(**(good | change))


def test_a_model_is_its_own_copy_and_cannot_be_written_to():
    T, R = np.eye(2)[None], np.ones((2, 1))
    mdp = MDP(T, R, 0.9)
    T[:], R[:] = 0.5, 7
    assert (np.eye(2) == mdp.T).all() and (mdp.R == 1).all()
    with pytest.raises(ValueError, match="read-only"):
        mdp.T[0, 0, 0] = 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: value_iteration(m, tol=0), "tol must be a number in"),
        (lambda m: value_iteration(m, horizon=0), "horizon must be an integer >= 1, got 0"),
        (lambda m: value_iteration(m, horizon=2.5), "horizon must be an integer >= 1, got 2.5"),
        (lambda m: error_bound(m, [0.0]), r"V must have shape \(2,\), got \(1,\)"),
        (lambda m: policy_evaluation(m, [0, 2]), r"policy must hold integers in \[0, 0\], got 2"),
        (lambda m: policy_evaluation(m, [0]), r"policy must have shape \(2,\), got \(1,\)"),
        (lambda m: policy_evaluation(m, [[1.0], [0.5]]), "policy must sum to 1"),
        (lambda m: m.step(2, 0, rng=0), r"s must hold integers in \[0, 1\], got 2"),
        (lambda m: m.step(0, -1, rng=0), r"a must hold integers in \[0, 0\], got -1"),
        (lambda m: delayed_rewards([0], [1.0]), "delays must hold integers >= 1, got 0"),
        (lambda m: delayed_rewards([1, 2], [1.0]), r"rewards must have shape \(2,\), got \(1,\)"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(MDP([np.eye(2)], [[1.0], [2.0]], 0.9))


# --- Gymnasium ------------------------------------------------------------------------------------


def undiscounted_return(mdp, policy, steps=3000):
    T, R = policy_model(mdp, policy)
    where, total = mdp.start, 0.0
    for _ in range(steps):
        total, where = total + where @ R, where @ T
    return total


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


def test_the_table_of_an_environment_is_what_the_environment_does():
    env = gymnasium.make("FrozenLake-v1")
    mdp = MDP.from_gymnasium(env, gamma=0.9)
    s = int(env.reset(seed=3)[0])
    env.action_space.seed(3)
    counts, rewards = np.zeros((4, 17, 17)), []
    for _ in range(5000):
        a = int(env.action_space.sample())
        s_next, r, terminated, truncated, _ = env.step(a)
        counts[a, s, 16 if terminated else s_next] += 1
        rewards.append(r - mdp.R[s, a])
        s = int(env.reset()[0]) if terminated or truncated else int(s_next)
    tried = counts.sum(axis=2) > 100
    shares = counts[tried] / counts[tried].sum(axis=1, keepdims=True)
    np.testing.assert_allclose(shares, mdp.T[tried], atol=0.12)
    assert abs(np.mean(rewards)) < 0.01
    assert mdp.start.tolist() == [1.0] + [0.0] * 16


@pytest.mark.parametrize("name", ["CartPole-v1", "Blackjack-v1"])
def test_an_environment_without_a_table_is_refused(name):
    with pytest.raises(ValueError, match="env must have a transition table P, got <"):
        MDP.from_gymnasium(name)


def test_the_room_knows_nothing_of_the_rooms_above():
    code = (
        "import sys, arkaq_edu.mdp\n"
        "above = 'pymunk matplotlib ipywidgets sklearn arkaq_edu.field arkaq_edu.arkaq'.split()\n"
        "print([name for name in above if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# --- the floor ------------------------------------------------------------------------------------


def neighbor(plan, x, y, dx, dy):
    """Where a step from column x, row y (from the top) leads, by looking at the plan."""
    x2, y2 = x + dx, y - dy
    inside = 0 <= y2 < len(plan) and 0 <= x2 < len(plan[0])
    return (x2, y2) if inside and plan[y2][x2] != "#" else (x, y)


def test_a_floor_is_what_its_plan_says():
    plan = ["..#o", "x...", ".#.."]
    grid = grid_world(plan, slip=0.4, gamma=0.9)
    ways = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    where = {(int(x), len(plan) - 1 - int(y)): s for s, (x, y) in enumerate(grid.places)}
    assert len(where) == grid.mdp.n_states == 10
    for (x, y), s in where.items():
        sign = plan[y][x]
        assert grid.mdp.ends[s] == (sign != ".")
        assert grid.mdp.start[s] == pytest.approx(1 / 8 if sign == "." else 0)
        for a in range(4):
            expected, reward = np.zeros(10), 0.0
            for turn, p in ((0, 0.6), (1, 0.2), (-1, 0.2)) if sign == "." else ():
                x2, y2 = neighbor(plan, x, y, *ways[(a + turn) % 4])
                expected[where[x2, y2]] += p
                reward += p * {".": 0, "o": 100, "x": -100}[plan[y2][x2]]
            expected[s] += sign != "."
            np.testing.assert_allclose(grid.mdp.T[a, s], expected, atol=1e-12)
            assert grid.mdp.R[s, a] == pytest.approx(reward)


def test_without_slipping_the_ball_is_worth_gamma_for_each_step_to_it():
    """The distances by flooding the plan from the ball; a hole is never entered."""
    grid = grid_world(slip=0.0, gamma=0.9)
    plan = grid.plan
    (ball,) = [(x, y) for y, row in enumerate(plan) for x, sign in enumerate(row) if sign == "o"]
    steps, border = {ball: 0}, [ball]
    while border:
        x, y = border.pop(0)
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            square = neighbor(plan, x, y, dx, dy)
            if plan[square[1]][square[0]] == "." and square not in steps:
                steps[square] = steps[x, y] + 1
                border.append(square)
    V, _ = value_iteration(grid.mdp)
    for (x, y), v in zip(grid.places, V, strict=True):
        k = steps.get((int(x), len(plan) - 1 - int(y)), 0)
        assert v == pytest.approx(100 * 0.9 ** (k - 1) if k else 0)


def test_feet_that_slip_turn_the_robot_away_from_the_bridge():
    bridge = (2, 3)  # its left end, column and row from below
    turned = {}
    for slip in (0.0, 0.1, 0.2, 0.5):
        grid = grid_world(slip=slip)
        _, policy = value_iteration(grid.mdp)
        turned[slip] = int(policy[grid.places.tolist().index(list(bridge))])
    assert turned == {0.0: 0, 0.1: 0, 0.2: 2, 0.5: 2}


@pytest.mark.parametrize(
    ("given_", "message"),
    [
        ({"plan": ["..", "."]}, "plan must have rows of one length"),
        ({"plan": [".z"]}, "plan must have rows of one length made of"),
        ({"plan": []}, "plan must have rows of one length"),
        ({"plan": ["#o"]}, "plan must have a free square"),
        ({"slip": 1.5}, r"slip must be a number in \[0, 1\], got 1.5"),
        ({"gamma": 1.0}, r"gamma must be a number in \[0, 1\), got 1.0"),
    ],
)
def test_a_floor_that_is_none_is_refused(given_, message):
    with pytest.raises(ValueError, match=message):
        grid_world(**given_)


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
