"""Learn what a policy earns from what happened under it: Monte Carlo and temporal differences.

Each is a backup of `QLearner` with a single action, since there is nothing to maximize over:
Monte Carlo moves V(s_t) toward the whole return that followed it, TD(0) toward one reward and
the value of the state after it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, integer, number
from arkaq_edu._compiled import kernel
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.planning import policy_chances
from arkaq_edu.mdp.q_learning import QLearner


class Episode(NamedTuple):
    """One episode of T steps.

    Attributes
    ----------
    s : ndarray of int, shape (T + 1,)
        The states, the last one included.
    a : ndarray of int, shape (T,)
        The action taken in each but the last.
    r : ndarray, shape (T,)
        The reward of each action.
    terminated : bool
        Whether it ended, or was only cut short.
    """

    s: NDArray[np.int64]
    a: NDArray[np.int64]
    r: NDArray[np.float64]
    terminated: bool


@kernel
def _walk(cumulative, choices, ends, u, s, a):
    """Walk from s[0]; return the number of steps taken before an end or the last row of u."""
    for t in range(len(a)):
        if ends[s[t]]:
            return t
        a[t] = np.searchsorted(choices[s[t]], u[t, 0], side="right")
        s[t + 1] = np.searchsorted(cumulative[a[t], s[t]], u[t, 1], side="right")
    return len(a)


@kernel
def _sum_backwards(r, gamma, total):
    """Fill in total[t] = r[t] + gamma total[t + 1]."""
    following = 0.0
    for t in range(len(r) - 1, -1, -1):
        following = r[t] + gamma * following
        total[t] = following


def simulate(
    mdp: MDP,
    policy: ArrayLike,
    *,
    start: int | None = None,
    max_steps: int = 1000,
    rng: np.random.Generator | int,
) -> Episode:
    """Follow a policy through a model, until an end or for `max_steps`.

    Parameters
    ----------
    mdp : MDP
        The model.
    policy : array_like, shape (S,) or (S, A)
        The action of each state, or the probabilities of the actions in each state.
    start : int, optional
        The first state; without it, one drawn from ``mdp.start``.
    max_steps : int, default 1000
        After how many steps an episode is cut short, at least 1.
    rng : numpy.random.Generator or int
        Where the draws come from.

    Returns
    -------
    Episode

    Raises
    ------
    ValueError
        If an argument is out of range.

    Examples
    --------
    >>> mdp = MDP(T=[[[0, 1, 0], [0, 0, 1], [0, 0, 1]]], R=[[1], [2], [0]], gamma=0.5)
    >>> simulate(mdp, [0, 0, 0], start=0, rng=0)
    Episode(s=array([0, 1, 2]), a=array([0, 0]), r=array([1., 2.]), terminated=True)
    """
    rng = np.random.default_rng(rng)
    a = np.empty(integer("max_steps", max_steps, 1), dtype=np.int64)
    s = np.empty(len(a) + 1, dtype=np.int64)
    if start is None:
        start = int(rng.choice(mdp.n_states, p=mdp.start))
    s[0] = integer("start", start, 0, mdp.n_states - 1)
    choices = policy_chances(mdp, policy).cumsum(axis=1)
    n = _walk(mdp.cumulative, choices / choices[:, -1:], mdp.ends, rng.random((len(a), 2)), s, a)
    s, a = s[: n + 1].copy(), a[:n].copy()
    return Episode(s, a, mdp.R[s[:-1], a], bool(mdp.ends[s[-1]]))


def discounted_returns(r: ArrayLike, gamma: float) -> NDArray[np.float64]:
    """Return, for each step, the discounted sum of the rewards from there on.

    Parameters
    ----------
    r : array_like, shape (T,)
        The rewards.
    gamma : float
        The discount rate, in [0, 1].

    Returns
    -------
    ndarray, shape (T,)

    Raises
    ------
    ValueError
        If a reward is not finite or `gamma` is outside [0, 1].

    Examples
    --------
    >>> discounted_returns([0, 0, 8], gamma=0.5)
    array([2., 4., 8.])
    """
    r = array("r", r, (None,))
    total = np.empty(len(r))
    _sum_backwards(r, number("gamma", gamma, 0, 1), total)
    return total


def monte_carlo(
    episodes: Sequence[Episode],
    n_states: int,
    gamma: float,
    alpha: float | str | Callable[[int], float] = "1/visits",
    initial: float = 0.0,
) -> NDArray[np.float64]:
    """Estimate V from whole returns: V(s_t) moves by alpha (R_t - V(s_t)), equation 2.10.

    Parameters
    ----------
    episodes : sequence of Episode
        What happened, each up to its end.
    n_states : int
        The number of states.
    gamma : float
        The discount rate, in [0, 1].
    alpha : float, "1/visits" or callable, default "1/visits"
        The learning rate, as for `QLearner`. The default gives the mean of the returns that
        followed all visits of a state.
    initial : float, default 0.0
        What every V(s) starts from.

    Returns
    -------
    ndarray, shape (n_states,)

    Raises
    ------
    ValueError
        If an argument is out of range or an episode was cut short: what it would still have earned
        is not known.

    Notes
    -----
    In equation 2.10 R_t is the return that follows t. "The reward for time horizon t", as the
    thesis calls it, would be another thing.

    References
    ----------
    Thesis 2.2.2 (equation 2.10).

    Examples
    --------
    >>> episode = Episode(np.array([0, 1, 2]), np.array([0, 0]), np.array([0.0, 8.0]), True)
    >>> monte_carlo([episode], n_states=3, gamma=0.5)
    array([4., 8., 0.])
    """
    learner = QLearner(n_states, 1, alpha, gamma, initial=initial)
    for i, episode in enumerate(episodes):
        if not episode.terminated:
            raise ValueError(f"episodes must have ended, got one cut short at ({i},)")
        s = episode.s[:-1]
        learner.replay(s, 0, discounted_returns(episode.r, gamma), s, terminated=True)
    return learner.Q[:, 0].copy()


def td0(
    episodes: Sequence[Episode],
    n_states: int,
    gamma: float,
    alpha: float | str | Callable[[int], float] = "1/visits",
    initial: float = 0.0,
) -> NDArray[np.float64]:
    """Estimate V one step at a time: V(s) moves by alpha (r + gamma V(s') - V(s)), equation 2.11.

    Parameters
    ----------
    episodes : sequence of Episode
        What happened; an episode may be cut short.
    n_states : int
        The number of states.
    gamma : float
        The discount rate, in [0, 1].
    alpha : float, "1/visits" or callable, default "1/visits"
        The learning rate, as for `QLearner`.
    initial : float, default 0.0
        What every V(s) starts from.

    Returns
    -------
    ndarray, shape (n_states,)

    Raises
    ------
    ValueError
        If an argument is out of range.

    Notes
    -----
    The thesis prints r + gamma R_t - V(s_t). The return R_t is what one does not have yet after one
    step: in its place stands the estimate of the state reached, gamma V(s_t+1).

    References
    ----------
    Thesis 2.2.2 (equation 2.11). R. Sutton, "Learning to predict by the methods of temporal
    differences", Machine Learning 3, 1988.

    Examples
    --------
    >>> episode = Episode(np.array([0, 1, 2]), np.array([0, 0]), np.array([0.0, 8.0]), True)
    >>> td0([episode, episode], n_states=3, gamma=0.5, alpha=1.0)
    array([4., 8., 0.])
    """
    learner = QLearner(n_states, 1, alpha, gamma, initial=initial)
    for episode in episodes:
        ended = np.zeros(len(episode.r), dtype=bool)
        ended[-1:] = episode.terminated
        learner.replay(episode.s[:-1], 0, episode.r, episode.s[1:], ended)
    return learner.Q[:, 0].copy()
