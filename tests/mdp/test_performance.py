import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arkaq_edu.mdp import (
    UCB,
    Bandit,
    EpsilonGreedy,
    play,
    quality_of_convergence,
    regret,
    speed_of_convergence,
)

earnings = st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=1, max_size=30)


@given(earnings, st.integers(1, 30), st.sampled_from([0.25, 0.5, 0.9]))
def test_speed_is_the_first_trial_after_which_nothing_falls_back(earned, window, target):
    window = min(window, len(earned))
    ends = range(window, len(earned) + 1)
    good = {e: np.mean(earned[e - window : e]) >= target for e in ends}
    expected = next((e for e in ends if all(good[f] for f in ends if f >= e)), len(earned) + 1)
    assert speed_of_convergence(earned, target, window=window) == expected


@given(earnings)
def test_regret_adds_up_the_shortfalls(earned):
    expected = [sum(1.0 - x for x in earned[: i + 1]) for i in range(len(earned))]
    np.testing.assert_allclose(regret(earned, 1.0), expected)


def test_quality_is_one_at_the_optimum_and_zero_at_the_baseline():
    returns = np.repeat([[-13.0], [-100.0], [-56.5]], 200, axis=1)
    quality = quality_of_convergence(returns, -13.0, baseline=-100.0)
    np.testing.assert_allclose(quality, [1.0, 0.0, 0.5])


def test_quality_is_that_of_the_last_trials():
    earned = np.random.default_rng(0).uniform(-50, 10, (3, 150))
    for last in (1, 7, 150, 400):
        means = [np.mean(row[max(0, 150 - last) :]) for row in earned]
        expected = (np.array(means) + 20) / 30
        quality = quality_of_convergence(earned, 10.0, baseline=-20.0, last=last)
        np.testing.assert_allclose(quality, expected)
    hundred = quality_of_convergence(earned, 10.0)
    np.testing.assert_allclose(hundred, earned[:, 50:].mean(axis=1) / 10)


def test_a_sure_strategy_can_be_slower_and_better():
    """What 2.1.2 weighs: UCB pays for certainty, greed is quick and sometimes wrong for ever."""
    bandit = Bandit([0.45, 0.55, 0.6])
    greedy = play(bandit, EpsilonGreedy(0.0), pulls=4000, players=100, rng=8).expected
    careful = play(bandit, UCB(c=0.5), pulls=4000, players=100, rng=8).expected
    early = [quality_of_convergence(x[:, :100], 0.6).mean() for x in (greedy, careful)]
    late = [quality_of_convergence(x, 0.6).mean() for x in (greedy, careful)]
    assert late[1] > late[0] + 0.02
    assert early[1] < late[1]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: regret([], 1.0), "earned must hold at least one trial"),
        (lambda: quality_of_convergence([1.0], 1.0, baseline=1.0), "baseline must be a number in"),
        (
            lambda: speed_of_convergence([1.0], 1.0, window=2),
            r"window must be an integer in \[1, 1",
        ),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
