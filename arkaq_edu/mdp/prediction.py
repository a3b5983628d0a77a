"""Learn what a policy earns from episodes under it: Monte Carlo and temporal differences.

Both make the backup of `QLearner` with a single action, because there is nothing to maximize over.
Monte Carlo moves V(s_t) toward the whole return that followed, TD(0) toward one reward plus the
value of the next state.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import affordable, array, generator, integer, number, shown
from arkaq_edu.mdp import compiled
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.planning import policy_chances
from arkaq_edu.mdp.q_learning import QLearner


class Episode(NamedTuple):
    """One episode of T steps.

    Attributes
    ----------
    s : ndarray of int, shape (T + 1,)
        The states, including the last one.
    a : ndarray of int, shape (T,)
        The action taken in each state but the last.
    r : ndarray, shape (T,)
        The reward of each action.
    terminated : bool
        Whether the episode ended; otherwise it was only cut short.
    """

    s: NDArray[np.int64]
    a: NDArray[np.int64]
    r: NDArray[np.float64]
    terminated: bool


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
        The first state; without it, one is drawn from ``mdp.start``.
    max_steps : int, default 1000
        The number of steps after which an episode is cut short, at least 1.
    rng : numpy.random.Generator or int
        The random numbers: two for each of `max_steps`, however long the episode is.

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
    rng = generator("rng", rng)
    max_steps = integer("max_steps", max_steps, 1)
    if start is None:
        start = int(rng.choice(mdp.n_states, p=mdp.start))
    states, actions = [integer("start", start, 0, mdp.n_states - 1)], []
    below = policy_chances(mdp, policy).cumsum(axis=1)
    below /= below[:, -1:]
    for u, v in rng.random(affordable("max_steps", (max_steps, 2))):
        s = states[-1]
        if mdp.ends[s]:
            break
        actions.append(int(below[s].searchsorted(u, side="right")))
        row = actions[-1] * mdp.n_states + s
        states.append(int(compiled.draw(*mdp.outcomes, row, v)))
    visited, a = np.array(states), np.array(actions, dtype=np.int64)
    return Episode(visited, a, mdp.R[visited[:-1], a], bool(mdp.ends[states[-1]]))


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
    gamma, following = number("gamma", gamma, 0, 1), 0.0
    returns = array("r", r, (None,)).copy()
    for t in reversed(range(len(returns))):
        following = returns[t] = returns[t] + gamma * following
    return returns


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
        The episodes, each up to its end.
    n_states : int
        The number of states.
    gamma : float
        The discount rate, in [0, 1].
    alpha : float, "1/visits" or callable, default "1/visits"
        The learning rate, as for `QLearner`. The default gives the mean of the returns after all
        visits of a state.
    initial : float, default 0.0
        The first value of every V(s).

    Returns
    -------
    ndarray, shape (n_states,)

    Raises
    ------
    ValueError
        If an argument is out of range, or if an episode was cut short: its return is not known.

    Notes
    -----
    R_t in equation 2.10 is the return that follows t, not "the reward for time horizon t", as the
    thesis calls it.

    References
    ----------
    Thesis 2.2.2 (equation 2.10).

    Examples
    --------
    >>> episode = Episode(np.array([0, 1, 2]), np.array([0, 0]), np.array([0.0, 8.0]), True)
    >>> monte_carlo([episode], n_states=3, gamma=0.5)
    array([4., 8., 0.])
    """
    episodes = _checked(episodes)
    for i, episode in enumerate(episodes):
        if not episode.terminated:
            raise ValueError(f"episodes must have ended, got one cut short at ({i},)")
    learner = QLearner(n_states, 1, alpha, gamma, initial=initial)
    if episodes:
        s = np.concatenate([episode.s[:-1] for episode in episodes])
        returns = np.concatenate([discounted_returns(episode.r, gamma) for episode in episodes])
        learner.replay(s, 0, returns, s, terminated=True)
    return learner.Q[:, 0]


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
        The episodes; they may be cut short.
    n_states : int
        The number of states.
    gamma : float
        The discount rate, in [0, 1].
    alpha : float, "1/visits" or callable, default "1/visits"
        The learning rate, as for `QLearner`.
    initial : float, default 0.0
        The first value of every V(s).

    Returns
    -------
    ndarray, shape (n_states,)

    Raises
    ------
    ValueError
        If an argument is out of range.

    Notes
    -----
    The thesis prints r + gamma R_t - V(s_t). But after one step the return R_t is not known yet.
    The estimate of the next state takes its place: gamma V(s_t+1).

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
    episodes = _checked(episodes)
    learner = QLearner(n_states, 1, alpha, gamma, initial=initial)
    if episodes:
        s = np.concatenate([episode.s[:-1] for episode in episodes])
        s_next = np.concatenate([episode.s[1:] for episode in episodes])
        r = np.concatenate([episode.r for episode in episodes])
        # Only the last step of an episode ends it.
        ended = [(np.arange(len(e.r)) == len(e.r) - 1) & e.terminated for e in episodes]
        learner.replay(s, 0, r, s_next, np.concatenate(ended))
    return learner.Q[:, 0]


def _checked(episodes: Sequence[Episode]) -> list[Episode]:
    """Return the episodes as a list, or refuse what is none."""
    if not np.iterable(episodes) or not all(isinstance(episode, Episode) for episode in episodes):
        raise ValueError(f"episodes must be a sequence of Episode, got {shown(episodes)}")
    return list(episodes)
