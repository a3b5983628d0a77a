import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.mdp import (
    MDP,
    average_reward,
    best_chains,
    delayed_rewards,
    discounted,
    finite_horizon,
)
from arkaq_edu.mdp.optimality import chain_curves, chosen_chains, coins
from tests.mdp.worlds import all_policies, as_sparse, random_mdp, seeds


def test_figure_2_2_to_the_printed_digits():
    world = delayed_rewards()
    assert finite_horizon(world, 5)[-1, 0].tolist() == [6, 0, 0]
    assert [f"{x:.3g}" for x in discounted(world)[0]] == ["16.2", "59", "58.5"]
    assert average_reward(world)[0].tolist() == [2, 10, 11]


@pytest.mark.thesis("errata row 2")
def test_each_model_prefers_another_action():
    """The thesis reads from the discounted sums that the infinite horizon "must be preferred"."""
    world = delayed_rewards()
    models = finite_horizon(world, 5)[-1], discounted(world), average_reward(world)
    assert [int(Q[0].argmax()) for Q in models] == [0, 1, 2]


@pytest.mark.thesis("errata row 1")
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
    assert world.start.tolist() == [1.0] + [0.0] * sum(delays)


@pytest.mark.thesis("errata row 3")
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
    gamma = 1 - 1e-10
    near = MDP(mdp.T, mdp.R, gamma)
    np.testing.assert_allclose((1 - gamma) * discounted(near), average_reward(mdp), atol=1e-3)


def test_the_average_reward_of_a_sparse_model_with_forbidden_actions():
    swap, stay = [[0, 1], [1, 0]], [[1, 0], [0, 1]]
    mdp = MDP([swap, stay], [[3, -np.inf], [0, 1]], gamma=1.0)
    for model in (mdp, as_sparse(mdp)):
        assert average_reward(model).tolist() == [[1.5, -np.inf], [1.5, 1.5]]


def test_where_the_best_chain_changes_along_an_axis():
    """The lines of three chains meet at 2 (two of them), and all are equal from 6 on."""
    x = np.arange(8)
    curves = np.column_stack([2 - x, 0 * x, x - 2.0]) * (x < 6)[:, None]
    ends, chosen = chosen_chains(x, curves)
    assert ends.tolist() == [0, 1.5, 2.5, 5.5, 7] and chosen == [0, 3, 2, 3]
    assert [coins(x) for x in (0, 0.12345, 58.46, 999.4, 999.6, 12345.6)] == [
        "0", "0.123", "58.5", "999", "1000", "12346",
    ]  # fmt: skip


def test_the_curves_are_what_the_models_earn_per_step():
    finite, geometric = chain_curves(12, (0.5, 0.9))
    delays, rewards = np.array([2, 5, 6]), np.array([2.0, 10.0, 11.0])
    steps = np.arange(1, 13)[:, None]
    np.testing.assert_allclose(finite, rewards * np.maximum(steps - delays, 0) / steps)
    np.testing.assert_allclose(geometric, rewards * np.array([[0.5], [0.9]]) ** delays)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: delayed_rewards([0], [1.0]), "delays must hold integers >= 1, got 0"),
        (lambda: delayed_rewards(3, [1.0]), r"delays must have shape \(n,\), got \(\)"),
        (lambda: delayed_rewards([10**6], [1.0]), "delays must need at most 2,147,483,648 bytes"),
        (lambda: best_chains([1.0, np.nan, 2.0]), "earned must hold finite numbers, got nan"),
        (lambda: delayed_rewards([1, 2], [1.0]), r"rewards must have shape \(2,\), got \(1,\)"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
