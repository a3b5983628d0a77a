"""The game on four machines: what a press pays, and how the others play."""

import numpy as np
import pytest
from scipy import stats

from arkaq_edu.mdp import UCB, play
from arkaq_edu.mdp.machines import MACHINES, PLAYERS, STRATEGIES, crowd, game


def test_the_others_play_the_same_machines_as_many_pulls():
    # Seen from the mathematics: random play loses the mean gap at every pull, give or take.
    for number in (3, 20):
        chances = game(number, ()).bandit.p
        gaps = max(chances) - chances
        for luck in (False, True):
            found = crowd(number, 100, luck=luck)
            mean, std = found["random"]
            error = std[100] / np.sqrt(PLAYERS)
            assert abs(mean[100] - 100 * gaps.mean()) < 4 * error
            spread = 100 * (gaps.var() if not luck else chances.mean() * (1 - chances.mean()))
            ratio = std[100] ** 2 * (PLAYERS - 1) / spread
            assert stats.chi2.cdf(ratio, PLAYERS - 1) == pytest.approx(0.5, abs=0.4999)
            assert found["UCB"][0][100] < mean[100]
    four = game(3, ()).bandit
    again = play(four, UCB(), 100, players=3000, rng=99)
    gap = (four.best - again.expected).sum(axis=1)
    mean, std = crowd(3, 100, luck=False)["UCB"]
    assert abs(mean[100] - gap.mean()) < 4 * std[100] / np.sqrt(PLAYERS)


def test_a_longer_axis_changes_nothing_of_what_was():
    short, long = (crowd(5, length, luck=True) for length in (40, 100))
    for name in STRATEGIES:
        for one, other in zip(short[name], long[name], strict=True):
            assert (one == other[:41]).all()


def test_a_press_is_a_function_of_the_machines_and_the_history():
    history = [MACHINES[i] for i in (0, 3, 1, 1, 2, 0, 3, 3, 2, 1)]
    whole = game(7, history).rewards
    for n in range(len(history)):
        assert (game(7, history[:n]).rewards == whole[:n]).all()
    changed = [*history[:4], MACHINES[0], *history[5:]]
    other = game(7, changed).rewards
    assert (np.delete(other, 4) == np.delete(whole, 4)).all(), "the rest of the luck stays"
    games = [game(s, history).rewards.tolist() for s in range(1, 31)]
    assert len(set(map(tuple, games))) > 25


def test_over_all_machines_the_buttons_pay_as_they_say():
    paid, chances = [], []
    for number in range(1, 31):
        played = game(number, MACHINES * 25)
        assert ((played.bandit.p >= 0.1) & (played.bandit.p <= 0.9)).all()
        paid.append(played.rewards.reshape(25, 4).mean(axis=0))
        chances.append(played.bandit.p)
    z = (np.array(paid) - chances) / np.sqrt(np.array(chances) * (1 - np.array(chances)) / 25)
    assert abs(z.mean()) < 4 / np.sqrt(z.size) and z.std() == pytest.approx(1, abs=0.25)
