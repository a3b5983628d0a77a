"""A game on four gambling machines, and many players who play beside the student."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.mdp.bandits import UCB, Bandit, Boltzmann, EpsilonGreedy, Random, Strategy, play
from arkaq_edu.mdp.performance import regret

#: The names on the buttons; machine i of the bandit is the i-th.
MACHINES = ("machine 1", "machine 2", "machine 3", "machine 4")
#: The strategies that play beside the student, with their default parameters.
STRATEGIES: dict[str, Strategy] = {
    "random": Random(),
    "epsilon-greedy": EpsilonGreedy(),
    "Boltzmann": Boltzmann(),
    "UCB": UCB(),
}
PLAYERS = 300  # players of each strategy


#: The mean and the standard deviation of the regret after no pull, one, ..., by strategy.
Crowd = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]


class Game(NamedTuple):
    """The student's game: the machines, which were pulled, and what each pull paid."""

    bandit: Bandit
    arms: NDArray[np.int64]
    rewards: NDArray[np.float64]

    def regret(self, *, luck: bool) -> NDArray[np.float64]:
        """Return the regret after no pull, after one, ...: as paid, or as paid on average.

        Examples
        --------
        >>> game(3, MACHINES).regret(luck=False).round(2)
        array([0.  , 0.29, 0.71, 0.71, 0.94])
        """
        earned = self.rewards if luck else self.bandit.p[self.arms]
        return np.append(0.0, np.cumsum(self.bandit.best - earned))

    def fact(self, others: Crowd, *, luck: bool) -> str:
        """Say what was paid, and how large the regret is beside that of the others.

        Examples
        --------
        >>> game(3, MACHINES[:1]).fact(crowd(3, 1, luck=False), luck=False).split("; ")[0]
        '1 pull, 1 coin: regret 0.3 without luck'
        """
        n, coins = len(self.arms), int(self.rewards.sum())
        if not n:
            return "no pull yet: which of the four machines pays best?"
        ends = ", ".join(f"{name} {mean[n]:.1f}" for name, (mean, _) in others.items())
        return (
            f"{n} pull{'s' * (n != 1)}, {coins} coin{'s' * (coins != 1)}: regret "
            f"{self.regret(luck=luck)[n]:.1f} with{'out' * (not luck)} luck; {ends}"
        )


def game(machines: int, pulls: Sequence[str]) -> Game:
    """Return what a series of presses pays.

    Parameters
    ----------
    machines : int
        The number of a set of machines, with its own probabilities and its own luck.
    pulls : sequence of str
        Names of `MACHINES` in the order of the presses.

    Returns
    -------
    Game

    Examples
    --------
    >>> long = game(1, MACHINES * 2).rewards
    >>> bool((game(1, MACHINES).rewards == long[:4]).all())
    True
    """
    chances, luck = np.random.default_rng(machines).spawn(2)
    bandit = Bandit(chances.uniform(0.1, 0.9, len(MACHINES)).round(2))
    arms = np.array([MACHINES.index(name) for name in pulls], dtype=np.int64)
    # Each pull takes one random number, in their order: later pulls change nothing.
    return Game(bandit, arms, bandit.pull(arms, luck))


@lru_cache(maxsize=32)
def crowd(machines: int, length: int, *, luck: bool) -> Crowd:
    """Return the mean and standard deviation of the regret of the players of each strategy.

    Parameters
    ----------
    machines : int
        The number of a set of machines, as for `game`.
    length : int
        The number of pulls, at least 1. A short game is the beginning of a longer one.
    luck : bool
        Whether regret counts what the pulls paid, or what they pay on average.

    Returns
    -------
    dict of str to (mean, std), each of shape (length + 1,)
        After no pull, after one, ...

    Examples
    --------
    >>> {name: float(mean[40].round(1)) for name, (mean, std) in crowd(3, 40, luck=False).items()}
    {'random': 9.4, 'epsilon-greedy': 6.6, 'Boltzmann': 6.6, 'UCB': 7.3}
    """
    bandit = game(machines, ()).bandit
    # The first two generators belong to the student's game.
    rngs = np.random.default_rng(machines).spawn(2 + len(STRATEGIES))[2:]
    found = {}
    for (name, strategy), rng in zip(STRATEGIES.items(), rngs, strict=True):
        played = play(bandit, strategy, length, players=PLAYERS, rng=rng)
        so_far = regret(played.rewards if luck else played.expected, bandit.best)
        found[name] = np.append(0.0, so_far.mean(axis=0)), np.append(0.0, so_far.std(axis=0))
    return found
