import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu.mdp import (
    UCB,
    Bandit,
    Boltzmann,
    EpsilonGreedy,
    Exponential,
    Linear,
    Power,
    Random,
    argmax_shared,
    play,
    quality_of_convergence,
    regret,
    softmax,
    speed_of_convergence,
)

P = np.array([0.2, 0.5, 0.7, 0.4])


def test_machines_pay_as_they_say():
    n = 20_000
    paid = Bandit(P).pull(np.repeat(np.arange(4), n), rng=0).reshape(4, n)
    assert set(np.unique(paid)) == {0.0, 1.0}
    z = (paid.mean(axis=1) - P) / np.sqrt(P * (1 - P) / n)
    assert np.abs(z).max() < 4


def test_random_play_regrets_the_mean_gap_at_every_pull():
    game = play(Bandit(P), Random(), pulls=200, players=2000, rng=1)
    final = regret(game.expected, 0.7)[:, -1]
    gap = 0.7 - P
    expected, spread = 200 * gap.mean(), math.sqrt(200 * gap.var() / 2000)
    assert abs(final.mean() - expected) < 4 * spread
    assert stats.chisquare(np.bincount(game.arms.ravel(), minlength=4)).pvalue > 1e-3


def test_ucb_stays_within_its_proven_bound_and_tries_every_machine_first():
    n = 3000
    game = play(Bandit(P), UCB(), pulls=n, players=200, rng=2)
    assert (np.sort(game.arms[:, :4], axis=1) == np.arange(4)).all()
    gaps = 0.7 - P[P < 0.7]
    bound = (8 * math.log(n) / gaps + (1 + math.pi**2 / 3) * gaps).sum()
    final = regret(game.expected, 0.7)[:, -1]
    assert final.mean() < bound
    # And it grows like a logarithm: the second half costs far less than half.
    assert final.mean() - regret(game.expected, 0.7)[:, n // 2 - 1].mean() < 0.3 * final.mean()


def test_epsilon_is_the_share_of_random_pulls_in_the_end():
    game = play(Bandit([0.1, 0.9]), EpsilonGreedy(0.2), pulls=1500, players=400, rng=3)
    wrong = (game.arms[:, -500:] == 0).mean()
    assert wrong == pytest.approx(0.2 / 2, abs=0.005)


def test_without_exploration_a_player_can_stay_with_the_wrong_machine():
    game = play(Bandit([0.4, 0.6]), EpsilonGreedy(0.0), pulls=500, players=500, rng=4)
    stuck = (game.arms[:, -1] == 0).mean()
    assert 0.1 < stuck < 0.6
    assert (
        play(Bandit([0.4, 0.6]), UCB(), pulls=5000, players=50, rng=4).arms[:, -1] == 1
    ).mean() > 0.7


def test_boltzmann_is_random_when_hot_and_greedy_when_cold():
    hot = play(Bandit(P), Boltzmann(math.inf), pulls=100, players=200, rng=5).arms
    assert stats.chisquare(np.bincount(hot.ravel(), minlength=4)).pvalue > 1e-3
    means = np.array([[0.3, 0.6, 0.6, 0.1]] * 5000)
    cold = Boltzmann(1e-9).choose(np.ones((5000, 4), dtype=int), means, np.random.default_rng(0))
    assert set(cold) == {1, 2}
    assert abs((cold == 1).mean() - 0.5) < 0.04


def test_boltzmann_frequencies_are_equation_3_2():
    means = np.tile([0.1, 0.4, 0.9], (30_000, 1))
    arms = Boltzmann(0.3).choose(np.ones((30_000, 3), dtype=int), means, np.random.default_rng(6))
    weights = np.exp(np.array([0.1, 0.4, 0.9]) / 0.3)
    expected = 30_000 * weights / weights.sum()
    assert stats.chisquare(np.bincount(arms, minlength=3), expected).pvalue > 1e-3


def test_schedules_are_asked_for_the_pull_that_comes():
    asked = []
    play(Bandit(P), EpsilonGreedy(lambda n: asked.append(n) or 0.5), pulls=4, players=3, rng=0)
    assert asked == [1, 2, 3, 4]
    falling = play(
        Bandit([0.1, 0.9]), EpsilonGreedy(Power(exponent=0.5)), pulls=2000, players=200, rng=0
    )
    assert (falling.arms[:, :20] == 0).mean() > 0.15 > 0.05 > (falling.arms[:, -200:] == 0).mean()


def test_what_a_player_is_told_is_what_was_paid():
    class Copycat:
        def choose(self, counts, means, rng):
            self.counts, self.means = counts.copy(), means.copy()
            return rng.integers(4, size=len(counts))

    copycat = Copycat()
    game = play(Bandit(P), copycat, pulls=60, players=5, rng=7)
    for player in range(5):
        for arm in range(4):
            paid = game.rewards[player, :-1][game.arms[player, :-1] == arm]
            assert copycat.counts[player, arm] == len(paid)
            assert copycat.means[player, arm] == pytest.approx(paid.mean() if len(paid) else 0)


@pytest.mark.parametrize("strategy", [Random(), EpsilonGreedy(), Boltzmann(), UCB()])
def test_the_same_seed_is_the_same_game(strategy):
    one, two, other = (play(Bandit(P), strategy, pulls=50, players=3, rng=s) for s in (1, 1, 2))
    assert one.arms.tobytes() == two.arms.tobytes() != other.arms.tobytes()
    assert one.rewards.tobytes() == two.rewards.tobytes()
    assert one.arms.shape == (3, 50)


# --- measures -------------------------------------------------------------------------------------

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


def test_a_sure_strategy_can_be_slower_and_better():
    """What 2.1.2 weighs: UCB pays for certainty, greed is quick and sometimes wrong for ever."""
    bandit = Bandit([0.45, 0.55, 0.6])
    greedy = play(bandit, EpsilonGreedy(0.0), pulls=4000, players=100, rng=8).expected
    careful = play(bandit, UCB(c=0.5), pulls=4000, players=100, rng=8).expected
    early = [quality_of_convergence(x[:, :100], 0.6).mean() for x in (greedy, careful)]
    late = [quality_of_convergence(x, 0.6).mean() for x in (greedy, careful)]
    assert late[1] > late[0] + 0.02
    assert early[1] < late[1]


# --- choice ---------------------------------------------------------------------------------------


@given(
    st.lists(st.floats(-1e308, 1e308), min_size=1, max_size=6),
    st.floats(0, math.inf, exclude_min=True),
)
def test_softmax_is_a_distribution_in_the_order_of_the_values(values, temperature):
    p = softmax(values, temperature)
    assert p.sum() == pytest.approx(1) and (p >= 0).all()
    assert (np.diff(p[np.argsort(values)]) >= -1e-15).all()


def test_temperature_is_no_probability():
    """Chapter 3 calls T the chance of a non-greedy action; of two, that is 1 / (1 + e^(d/T))."""
    for T in (0.2, 0.5, 0.9, 3.0):
        p = softmax([0.0, 1.0], T)[0]
        assert p == pytest.approx(1 / (1 + math.exp(1 / T)))
        assert abs(p - T) > 0.1


def test_shared_argmax_shares():
    draws = argmax_shared(np.tile([1.0, 7.0, 7.0, 0.0, 7.0], (9000, 1)), rng=0)
    counts = np.bincount(draws, minlength=5)
    assert counts[[0, 3]].tolist() == [0, 0]
    assert stats.chisquare(counts[[1, 2, 4]]).pvalue > 1e-3


def test_schedules_fall_as_they_say():
    assert [Power(2.0, 0.5)(n) for n in (1, 4, 16)] == [2.0, 1.0, 0.5]
    cooling = Exponential(8.0, half_life=5, floor=0.5)
    assert [cooling(n) for n in (1, 6, 11, 500)] == [8.0, 4.0, 2.0, 0.5]
    fade = Linear(2.0, 1.0, 11)
    assert [fade(n) for n in (1, 6, 11, 12)] == [2.0, 1.5, 1.0, 1.0]


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Bandit([0.5, 1.5]), r"p must hold at least one probability in \[0, 1\], got"),
        (lambda: Bandit([]), "p must hold at least one probability"),
        (lambda: Bandit([[0.5]]), r"p must have shape \(any,\), got \(1, 1\)"),
        (lambda: Bandit(P).pull(-1, rng=0), r"arms must hold integers in \[0, 3\], got -1"),
        (lambda: EpsilonGreedy(1.2), r"epsilon must be a number in \[0, 1\], got 1.2"),
        (lambda: Boltzmann(0), r"temperature must be a number in \(0, inf\], got 0"),
        (lambda: UCB(-1), r"c must be a number in \[0, inf\), got -1"),
        (lambda: UCB(math.inf), r"c must be a number in \[0, inf\), got inf"),
        (lambda: argmax_shared([1.0, math.nan], rng=0), "values must be numbers"),
        (lambda: argmax_shared([], rng=0), "values must be numbers, at least one in a row"),
        (lambda: play(Bandit(P), UCB(), pulls=0, rng=0), "pulls must be an integer >= 1, got 0"),
        (
            lambda: play(Bandit(P), EpsilonGreedy(lambda n: 2.0), pulls=1, rng=0),
            r"epsilon must be a number in \[0, 1\], got 2.0",
        ),
        (lambda: softmax([0.0, math.nan], 1.0), "values must hold finite numbers, got nan"),
        (lambda: softmax([0.0], math.nan), "temperature must be a number in"),
        (lambda: regret([], 1.0), "earned must hold at least one trial"),
        (lambda: quality_of_convergence([1.0], 1.0, baseline=1.0), "baseline must be a number in"),
        (
            lambda: speed_of_convergence([1.0], 1.0, window=2),
            r"window must be an integer in \[1, 1",
        ),
        (lambda: Power(exponent=0), r"exponent must be a number in \(0, inf\], got 0"),
        (lambda: Exponential(1.0, 0), "half_life must be a number in"),
        (lambda: Linear(1.0, 0.0, 1), "n_steps must be an integer >= 2, got 1"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
