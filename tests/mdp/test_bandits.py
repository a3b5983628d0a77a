import copy
import math
import pickle

import numpy as np
import pytest
from scipy import stats

from arkaq_edu.mdp import (
    UCB,
    Bandit,
    Boltzmann,
    EpsilonGreedy,
    Power,
    Random,
    play,
    regret,
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


def test_ucb_takes_the_machine_whose_mean_could_be_highest():
    """Mean + c sqrt(ln n / n_arm): the means are chosen so that these differ by 0.01."""
    counts, rng = np.array([[65, 20, 4, 8], [100, 0, 0, 3]]), np.random.default_rng(0)
    margin = 0.5 * np.sqrt(np.log(97) / np.array([65, 20, 4, 8]))
    for best in range(4):
        means = 0.6 - margin + 0.01 * (np.arange(4) == best)
        chosen = UCB(0.5).choose(counts, np.array([means, [1.0, 0.0, 0.0, 1.0]]), rng)
        assert chosen[0] == best and chosen[1] in (1, 2)
    once = np.ones((1, 3), int)
    wide = [UCB().choose(once, [[0.0, 0.1, 0.05]], rng).item() for _ in range(5)]
    assert wide == [1] * 5 and UCB().c == pytest.approx(np.sqrt(2))


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


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Bandit([0.5, 1.5]), r"p must hold at least one probability in \[0, 1\], got"),
        (lambda: Bandit([]), "p must hold at least one probability"),
        (lambda: Bandit([[0.5]]), r"p must have shape \(any,\), got \(1, 1\)"),
        (lambda: Bandit(P).pull(-1, rng=0), r"arms must hold integers in \[0, 3\], got -1"),
        (lambda: EpsilonGreedy(1.2), r"epsilon must be a number in \[0, 1\], got 1.2"),
        (lambda: Boltzmann(0), r"temperature must be a number in \(0, inf\], got 0"),
        (lambda: UCB("1"), r"c must be a number in \[0, inf\), got '1'"),
        (lambda: EpsilonGreedy("0.1"), r"epsilon must be a number in \[0, 1\], got '0.1'"),
        (lambda: Boltzmann(None), r"temperature must be a number in \(0, inf\], got None"),
        (lambda: Bandit(P).pull(0, rng=0.5), "rng must be a numpy Generator, an integer >= 0 or"),
        (
            lambda: UCB().choose([[1, 2]], [[0.5]], 0),
            r"means must have shape \(1, 2\), got \(1, 1\)",
        ),
        (lambda: UCB().choose([1, 2], [0.5, 0.5], 0), r"counts must have shape \(N, k\), each"),
        (lambda: UCB().choose([[-1]], [[0.5]], 0), "counts must hold integers >= 0, got -1"),
        (
            lambda: play(Bandit(P), UCB(), pulls=10**9, rng=0),
            "pulls and players must need at most 2,147,483,648 bytes, got 8,000,000,000 bytes",
        ),
        (lambda: Bandit(P).pull([[0], [0, 1]], rng=0), "arms must be an array of numbers, got"),
        (lambda: play(Bandit(P), UCB(), pulls=1, players=10**9, rng=0), "pulls and players must"),
        (lambda: UCB(-1), r"c must be a number in \[0, inf\), got -1"),
        (lambda: UCB(math.inf), r"c must be a number in \[0, inf\), got inf"),
        (lambda: play(Bandit(P), UCB(), pulls=0, rng=0), "pulls must be an integer >= 1, got 0"),
        (
            lambda: play(Bandit(P), EpsilonGreedy(lambda n: 2.0), pulls=1, rng=0),
            r"epsilon must be a number in \[0, 1\], got 2.0",
        ),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("strategy", [Random(), EpsilonGreedy(), Boltzmann(), UCB()])
def test_lists_and_seeds_are_as_good_as_arrays_and_generators(strategy):
    counts, means = [[3, 0], [1, 1], [0, 9]], [[0.2, 0.0], [1.0, 0.0], [0.0, 0.4]]
    chosen = strategy.choose(counts, means, 4)
    again = strategy.choose(np.array(counts), np.array(means), np.random.default_rng(4))
    assert chosen.tolist() == again.tolist()


def test_what_was_checked_is_what_is_used():
    assert EpsilonGreedy(np.array(0)) == EpsilonGreedy(0.0)
    assert type(UCB(np.float32(1)).c) is type(Boltzmann(1).temperature) is float


def test_a_strategy_that_chooses_a_machine_that_does_not_exist_is_refused():
    class Blind:
        def choose(self, counts, means, rng):
            return self.arms

    for Blind.arms in ([4], [-1], [0.5], ["0"]):
        with pytest.raises(ValueError, match="arms must hold integers"):
            play(Bandit(P), Blind(), pulls=1, rng=0)


def test_the_machines_of_a_copy_cannot_be_changed_either():
    for bandit in (Bandit(P), copy.deepcopy(Bandit(P)), pickle.loads(pickle.dumps(Bandit(P)))):
        with pytest.raises(ValueError, match="read-only"):
            bandit.p[0] = 1.0
