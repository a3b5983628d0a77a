"""Exploration against exploitation: k gambling machines with different chances to pay."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import affordable, array, generator, integer, integers, number, shown
from arkaq_edu._frozen import Frozen
from arkaq_edu.mdp.choice import argmax_shared, draw_best, softmax
from arkaq_edu.mdp.schedules import Schedule, value_at


class Bandit(Frozen):
    """k gambling machines. Machine i pays 1 with probability p_i, and otherwise 0.

    Parameters
    ----------
    p : array_like, shape (k,)
        The probability that each machine pays, in [0, 1]; at least one machine.

    Attributes
    ----------
    p : ndarray, shape (k,)
    best : float
        The highest probability: what a pull of the best machine earns on average.

    Raises
    ------
    ValueError
        If a probability is outside [0, 1] or there is no machine.

    References
    ----------
    Thesis 2.1.3.

    Examples
    --------
    >>> bandit = Bandit([0.2, 0.5, 0.7])
    >>> bandit.best
    0.7
    >>> bandit.pull([2, 2, 2, 0], rng=0)
    array([1., 1., 1., 1.])
    """

    def __init__(self, p: ArrayLike) -> None:
        self.p = array("p", p, (None,)).copy()
        if not self.p.size or (self.p < 0).any() or (self.p > 1).any():
            raise ValueError(f"p must hold at least one probability in [0, 1], got {shown(p)}")
        self.best = float(self.p.max())
        self.freeze()

    def pull(self, arms: ArrayLike, rng: np.random.Generator | int) -> NDArray[np.float64]:
        """Pull machines and return what each pull pays, 0.0 or 1.0.

        Parameters
        ----------
        arms : array_like of int
            The machine of each pull, in an array of any shape.
        rng : numpy.random.Generator or int
            The random numbers.

        Returns
        -------
        ndarray
            With the shape of `arms`.

        Raises
        ------
        ValueError
            If a machine does not exist.
        """
        p = self.p[integers("arms", arms, 0, len(self.p) - 1)]
        return (generator("rng", rng).random(p.shape) < p).astype(np.float64)


class Strategy(Protocol):
    """A rule to choose a machine, for many players at once. Write your own like this."""

    def choose(
        self, counts: NDArray[np.int64], means: NDArray[np.float64], rng: np.random.Generator
    ) -> NDArray[np.intp]:
        """Choose a machine for each of N players.

        Parameters
        ----------
        counts : array_like of int, shape (N, k)
            How often each player has pulled each machine.
        means : array_like, shape (N, k)
            What each machine has paid that player on average; 0 if it was never pulled.
        rng : numpy.random.Generator
            The random numbers; for the strategies of this module, also a seed.

        Returns
        -------
        ndarray of int, shape (N,)
        """
        ...  # pragma: no cover


@dataclass(frozen=True)
class Random:
    """Always explore: pull every machine with the same probability.

    Examples
    --------
    >>> play(Bandit([0.2, 0.7]), Random(), pulls=5, rng=0).arms
    array([[1, 1, 0, 0, 1]])
    """

    def choose(
        self, counts: NDArray[np.int64], means: NDArray[np.float64], rng: np.random.Generator
    ) -> NDArray[np.intp]:
        """Choose a machine for each player."""
        counts, means, rng = _told(counts, means, rng)
        return rng.integers(counts.shape[1], size=len(counts))


@dataclass(frozen=True)
class EpsilonGreedy:
    """Explore with probability epsilon; otherwise pull the machine that paid best so far.

    Parameters
    ----------
    epsilon : float or callable, default 0.1
        In [0, 1], or a function of the pull n = 1, 2, ... that returns it.

    Raises
    ------
    ValueError
        If `epsilon` is outside [0, 1].

    Examples
    --------
    >>> np.bincount(play(Bandit([0.2, 0.7]), EpsilonGreedy(0.1), pulls=1000, rng=0).arms[0])
    array([ 54, 946])
    """

    epsilon: float | Schedule = 0.1

    def __post_init__(self) -> None:
        if not callable(self.epsilon):
            object.__setattr__(self, "epsilon", number("epsilon", self.epsilon, 0, 1))

    def choose(
        self, counts: NDArray[np.int64], means: NDArray[np.float64], rng: np.random.Generator
    ) -> NDArray[np.intp]:
        """Choose a machine for each player."""
        counts, means, rng = _told(counts, means, rng)
        epsilon = number("epsilon", value_at(self.epsilon, _pull(counts)), 0, 1)
        explore = rng.random(len(counts)) < epsilon
        return np.where(explore, Random().choose(counts, means, rng), argmax_shared(means, rng))


@dataclass(frozen=True)
class Boltzmann:
    """Pull each machine with a probability that grows with its mean (equation 3.2).

    Parameters
    ----------
    temperature : float or callable, default 0.1
        T > 0, or a function of the pull n = 1, 2, ... that returns it.

    Raises
    ------
    ValueError
        If `temperature` is not above 0.

    References
    ----------
    Thesis chapter 3 (equation 3.2).

    Examples
    --------
    >>> np.bincount(play(Bandit([0.2, 0.7]), Boltzmann(0.1), pulls=1000, rng=0).arms[0])
    array([   0, 1000])
    """

    temperature: float | Schedule = 0.1

    def __post_init__(self) -> None:
        if not callable(self.temperature):
            T = number("temperature", self.temperature, 0, open_low=True)
            object.__setattr__(self, "temperature", T)

    def choose(
        self, counts: NDArray[np.int64], means: NDArray[np.float64], rng: np.random.Generator
    ) -> NDArray[np.intp]:
        """Choose a machine for each player."""
        counts, means, rng = _told(counts, means, rng)
        below = softmax(means, value_at(self.temperature, _pull(counts))).cumsum(axis=1)
        return (rng.random((len(counts), 1)) >= below / below[:, -1:]).sum(axis=1)


@dataclass(frozen=True)
class UCB:
    """Pull the machine that could be best: the highest mean + c sqrt(ln(n) / its pulls).

    Parameters
    ----------
    c : float, default sqrt(2)
        The width of the margin, in [0, inf). With sqrt(2) this is UCB1. Its regret after n pulls is
        at most sum_i 8 ln(n) / d_i + (1 + pi^2 / 3) d_i, with d_i = max(p) - p_i > 0.

    Raises
    ------
    ValueError
        If `c` is out of range.

    References
    ----------
    P. Auer, N. Cesa-Bianchi, P. Fischer, "Finite-time analysis of the multiarmed bandit problem",
    Machine Learning 47, 2002.

    Examples
    --------
    >>> sorted(play(Bandit([0.2, 0.7, 0.4]), UCB(), pulls=3, rng=0).arms[0].tolist())
    [0, 1, 2]
    """

    c: float = 2**0.5

    def __post_init__(self) -> None:
        object.__setattr__(self, "c", number("c", self.c, 0, open_high=True))

    def choose(
        self, counts: NDArray[np.int64], means: NDArray[np.float64], rng: np.random.Generator
    ) -> NDArray[np.intp]:
        """Choose a machine for each player."""
        counts, means, rng = _told(counts, means, rng)
        n = np.maximum(counts.sum(axis=1, keepdims=True), 1)
        margin = self.c * np.sqrt(np.log(n) / np.maximum(counts, 1))
        return draw_best(np.where(counts > 0, means + margin, np.inf), rng)


def _told(
    counts: ArrayLike, means: ArrayLike, rng: np.random.Generator | int
) -> tuple[NDArray[np.int64], NDArray[np.float64], np.random.Generator]:
    """Return what a strategy is told, checked."""
    counts = integers("counts", counts, 0)
    if counts.ndim != 2 or not counts.size:
        raise ValueError(f"counts must have shape (N, k), each at least 1, got {counts.shape}")
    return counts, array("means", means, counts.shape), generator("rng", rng)


def _pull(counts: NDArray[np.int64]) -> int:
    """Return the number of the next pull, from 1; it is the same for all players."""
    return int(counts[0].sum()) + 1


class Play(NamedTuple):
    """What N players pulled and earned.

    Attributes
    ----------
    arms : ndarray of int, shape (N, pulls)
        The machine of each pull.
    rewards : ndarray, shape (N, pulls)
        What each pull paid.
    expected : ndarray, shape (N, pulls)
        What that machine pays on average. This judges the choice without the luck.
    """

    arms: NDArray[np.int64]
    rewards: NDArray[np.float64]
    expected: NDArray[np.float64]


def play(
    bandit: Bandit,
    strategy: Strategy,
    pulls: int,
    *,
    players: int = 1,
    rng: np.random.Generator | int,
) -> Play:
    """Let players play by one strategy, each on machines of their own.

    Parameters
    ----------
    bandit : Bandit
        The machines.
    strategy : Strategy
        `Random`, `EpsilonGreedy`, `Boltzmann`, `UCB`, or any object with their `choose`.
    pulls : int
        Pulls of each player, at least 1.
    players : int, default 1
        Number of players, at least 1. A claim about a strategy needs many.
    rng : numpy.random.Generator or int
        The random numbers.

    Returns
    -------
    Play

    Raises
    ------
    ValueError
        If `pulls` or `players` is below 1 or too large, or the strategy chooses a machine that
        does not exist.

    References
    ----------
    Thesis 2.1.3.

    Examples
    --------
    >>> from arkaq_edu.mdp import regret
    >>> bandit = Bandit([0.2, 0.5, 0.7])
    >>> game = play(bandit, UCB(), pulls=1000, players=100, rng=0)
    >>> regret(game.expected, bandit.best).mean(axis=0)[[9, 99, 999]].round()
    array([ 2., 12., 43.])
    """
    pulls, players = integer("pulls", pulls, 1), integer("players", players, 1)
    affordable("pulls and players", (players, max(pulls, len(bandit.p))))
    rng = generator("rng", rng)
    everyone = np.arange(players)
    counts = np.zeros((players, len(bandit.p)), dtype=np.int64)
    totals = np.zeros(counts.shape)
    arms = np.empty((pulls, players), dtype=np.int64)
    rewards = np.empty((pulls, players))
    for t in range(pulls):
        chosen = strategy.choose(counts, totals / np.maximum(counts, 1), rng)
        arms[t] = integers("arms", chosen, 0, len(bandit.p) - 1)
        rewards[t] = bandit.pull(arms[t], rng)
        counts[everyone, arms[t]] += 1
        totals[everyone, arms[t]] += rewards[t]
    return Play(arms.T, rewards.T, bandit.p[arms.T])
