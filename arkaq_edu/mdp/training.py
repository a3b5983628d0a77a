"""Learning by doing: the exploration and the exploitation phase of the thesis, made to run.

Figures 4.3 and 4.4 read, line for line::

    while Q matrix is not converged          until the last backups changed next to nothing
        select action a                      explore: at random, the untried first (4.3)
                                             exploit: Boltzmann, cooling (3.2; 4.4 has "high Q")
        identify current state s             before a is selected: a depends on it
        while current state remains same     at most max_repeat times
            perform action a
        receive immediate reward r           the rewards of all those steps, discounted to the first
        receive new state s'
        evaluate Q[s][a]                     a semi-Markov backup: gamma^k for k steps
                                             an episode that is over begins anew

As printed, the procedures cannot run. Both say "while Q matrix is not converged", though the second
starts when the first is done; 4.4 selects a before it knows s; an action that never changes the
state (a kick) would be repeated for ever; nothing resets an episode; and the Boltzmann choice that
chapter 3 announces is in neither.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Discrete
from numpy.typing import NDArray

from arkaq_edu._checks import integer, number
from arkaq_edu.mdp.compiled import walk_and_learn
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.prediction import discounted_returns
from arkaq_edu.mdp.q_learning import QLearner
from arkaq_edu.mdp.schedules import Schedule, value_at


class Held(NamedTuple):
    """What came of holding one action while the state remained the same.

    Attributes
    ----------
    rewards : list of float
        The reward of each step, at least one.
    s_next : int
        The state it led to.
    terminated, truncated : bool
        Whether the episode ended there, or was cut short there.
    """

    rewards: list[float]
    s_next: int
    terminated: bool
    truncated: bool


class TrainingRun(NamedTuple):
    """How learning went.

    Attributes
    ----------
    changes : ndarray, shape (backups,)
        By how much each backup changed its Q(s, a).
    returns : ndarray, shape (episodes,)
        The sum of the rewards, not discounted, of each episode that was finished.
    lengths : ndarray of int, shape (episodes,)
        The number of steps of each.
    """

    changes: NDArray[np.float64]
    returns: NDArray[np.float64]
    lengths: NDArray[np.int64]


def hold(env: Any, s: int, a: int, max_repeat: int = 10) -> Held:
    """Perform an action again and again while the state remains the same.

    Parameters
    ----------
    env : gymnasium.Env
        With discrete observations, the states, and discrete actions.
    s : int
        The state it is in.
    a : int
        The action.
    max_repeat : int, default 10
        After how many steps to stop all the same, at least 1.

    Returns
    -------
    Held

    Raises
    ------
    ValueError
        If `max_repeat` is not an integer >= 1.

    References
    ----------
    Thesis 4.3 ("while current state remains same do perform action a").

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("CliffWalking-v1")
    >>> s, _ = env.reset(seed=0)
    >>> hold(env, int(s), a=3, max_repeat=4)  # to the left, where the wall is
    Held(rewards=[-1.0, -1.0, -1.0, -1.0], s_next=36, terminated=False, truncated=False)
    """
    rewards = []
    for _ in range(integer("max_repeat", max_repeat, 1)):
        s_next, r, terminated, truncated, _ = env.step(a)
        rewards.append(float(r))
        if s_next != s or terminated or truncated:
            break
    return Held(rewards, int(s_next), bool(terminated), bool(truncated))


def explore(
    env: Any,
    learner: QLearner,
    *,
    max_backups: int = 100_000,
    tol: float = 1e-6,
    max_repeat: int = 10,
    seed: int | None = None,
) -> TrainingRun:
    """Perform random actions, in each state the untried ones first, until Q has converged.

    Parameters
    ----------
    env : gymnasium.Env
        With discrete observations, the states, and discrete actions. It is reset first.
    learner : QLearner
        What learns; its generator draws the actions.
    max_backups : int, default 100000
        After how many backups to stop all the same, at least 1.
    tol : float, default 1e-6
        Q has converged when, since a change greater than this, every action has been tried anew in
        every state met. Where outcomes are certain, Q is then Q* to within tol / (1 - gamma).
    max_repeat : int, default 10
        How often an action is repeated at most while the state remains the same.
    seed : int, optional
        What the environment is first reset with.

    Returns
    -------
    TrainingRun

    Raises
    ------
    ValueError
        If an argument is out of range, or the learner's table does not fit the environment.

    Notes
    -----
    With a learning rate that falls, small changes are also the work of the small rate: then
    `max_backups` is the better guide.

    References
    ----------
    Thesis 4.3, figure 4.3.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("FrozenLake-v1", is_slippery=False)
    >>> learner = QLearner(16, 4, alpha=1.0, gamma=0.5, rng=0)
    >>> run = explore(env, learner, seed=0)
    >>> learner.Q[0]  # six steps from the goal; the first holds against the wall, ten times
    array([3.05175781e-05, 3.12500000e-02, 3.12500000e-02, 3.05175781e-05])
    >>> exploit(env, learner, max_backups=6).returns
    array([1.])
    """

    def choose(s: int, n: int) -> int:
        untried = learner.unvisited(s)
        return int(learner.rng.choice(untried if len(untried) else learner.Q.shape[1]))

    def converged(quiet: int, confirmed: set[tuple[int, int]], met: set[int]) -> bool:
        return len(confirmed) == len(met) * learner.Q.shape[1]

    return _learn(env, learner, choose, converged, max_backups, tol, max_repeat, seed)


def exploit(
    env: Any,
    learner: QLearner,
    *,
    temperature: float | Schedule = 0.0,
    max_backups: int = 100_000,
    tol: float = 1e-6,
    max_repeat: int = 10,
    seed: int | None = None,
) -> TrainingRun:
    """Perform the actions that Q says are best, and go on learning, until Q has converged.

    Parameters
    ----------
    env : gymnasium.Env
        With discrete observations, the states, and discrete actions. It is reset first.
    learner : QLearner
        What has explored; its generator draws the actions.
    temperature : float or callable, default 0.0
        Of the Boltzmann choice, or a function of the backup n = 1, 2, ... that returns it. 0 is its
        limit: one of the best actions.
    max_backups : int, default 100000
        After how many backups to stop all the same, at least 1.
    tol : float, default 1e-6
        Q has converged when it changed by no more than this in as many backups in a row as it has
        entries: actions that do not look good are seldom tried, and may never be.
    max_repeat : int, default 10
        How often an action is repeated at most while the state remains the same.
    seed : int, optional
        What the environment is first reset with.

    Returns
    -------
    TrainingRun

    Raises
    ------
    ValueError
        If an argument is out of range, or the learner's table does not fit the environment.

    References
    ----------
    Thesis chapter 3 (equations 3.2 and 3.3) and 4.3, figure 4.4.

    Examples
    --------
    >>> import gymnasium
    >>> from arkaq_edu.mdp import Exponential
    >>> env = gymnasium.make("CliffWalking-v1")
    >>> learner = QLearner(48, 4, alpha=1.0, gamma=0.99, rng=0)
    >>> cooling = Exponential(start=10.0, half_life=200)
    >>> exploit(env, learner, temperature=cooling, seed=0).returns[-1:]
    array([-13.])
    """

    def choose(s: int, n: int) -> int:
        T = value_at(temperature, n)
        return learner.boltzmann(s, T) if T != 0 else learner.greedy(s)

    def converged(quiet: int, confirmed: set[tuple[int, int]], met: set[int]) -> bool:
        return quiet >= learner.Q.size

    return _learn(env, learner, choose, converged, max_backups, tol, max_repeat, seed)


def _learn(
    env: Any,
    learner: QLearner,
    choose: Callable[[int, int], int],
    converged: Callable[[int, set[tuple[int, int]], set[int]], bool],
    max_backups: int,
    tol: float,
    max_repeat: int,
    seed: int | None,
) -> TrainingRun:
    """Run the loop that figures 4.3 and 4.4 share; they differ in how they choose."""
    tol = number("tol", tol, 0)
    n_states, n_actions = learner.Q.shape
    if not _holds(env.observation_space, n_states) or not _holds(env.action_space, n_actions):
        raise ValueError(
            f"env must be Discrete, with the learner's {n_states} states and {n_actions} actions, "
            f"got observations {env.observation_space} and actions {env.action_space}"
        )
    changes: list[float] = []
    episodes: list[tuple[float, int]] = []
    earned, length = 0.0, 0
    # Since the last change above tol: how many backups, and of which pairs. And all states met.
    quiet = 0
    confirmed: set[tuple[int, int]] = set()
    met: set[int] = set()
    s = int(env.reset(seed=seed)[0])
    for n in range(1, integer("max_backups", max_backups, 1) + 1):
        a = choose(s, n)
        held = hold(env, s, a, max_repeat)
        r = float(discounted_returns(held.rewards, learner.gamma)[0])
        k = len(held.rewards)
        changes.append(learner.update(s, a, r, held.s_next, held.terminated, n_steps=k))
        if abs(changes[-1]) > tol:
            quiet = 0
            confirmed.clear()
        quiet += 1
        confirmed.add((s, a))
        met.add(s)
        earned, length, s = earned + sum(held.rewards), length + k, held.s_next
        if held.terminated or held.truncated:
            episodes.append((earned, length))
            earned, length, s = 0.0, 0, int(env.reset()[0])
        if converged(quiet, confirmed, met):
            break
    returns = np.array([earned for earned, _ in episodes], dtype=np.float64)
    lengths = np.array([length for _, length in episodes], dtype=np.int64)
    return TrainingRun(np.array(changes), returns, lengths)


def _holds(space: Any, n: int) -> bool:
    """Return whether a table of n entries has one for each element of a space, and no more."""
    return isinstance(space, Discrete) and (space.start, space.n) == (0, n)


def train(
    mdp: MDP,
    learner: QLearner,
    n_steps: int,
    *,
    temperature: float | Schedule = np.inf,
) -> TrainingRun:
    """Let a learner live in a model, which it does not look at, in one compiled loop.

    Parameters
    ----------
    mdp : MDP
        The world. Episodes start as ``mdp.start`` says and end in ``mdp.ends``.
    learner : QLearner
        What learns, with a state and an action for each of the model's; its generator draws all.
    n_steps : int
        How many steps it lives, at least 1; the last episode may stay unfinished.
    temperature : float or callable, default infinity
        Of the Boltzmann choice, or a function of the step n = 1, 2, ... that returns it. Infinity
        chooses at random, 0 one of the best actions.

    Returns
    -------
    TrainingRun

    Raises
    ------
    ValueError
        If an argument is out of range, the learner's table has another shape, or every state of
        the model is an end.

    References
    ----------
    Thesis 2.2.3 and chapter 3 (equations 2.12 and 3.2).

    Examples
    --------
    >>> mdp = MDP.from_gymnasium("CliffWalking-v1", gamma=0.99)
    >>> learner = QLearner(49, 4, alpha=1.0, gamma=0.99, rng=0)
    >>> run = train(mdp, learner, 100_000)
    >>> train(mdp, learner, 13, temperature=0.0).returns
    array([-13.])
    """
    n_steps = integer("n_steps", n_steps, 1)
    if learner.Q.shape != mdp.R.shape:
        raise ValueError(f"learner must have a table of {mdp.R.shape}, got {learner.Q.shape}")
    starts = np.where(mdp.ends, 0.0, mdp.start).cumsum()
    if not starts[-1] > 0:
        raise ValueError("mdp must start somewhere else than in its ends")
    n_temperatures = n_steps if callable(temperature) else 1
    temperatures = [value_at(temperature, n + 1) for n in range(n_temperatures)]
    u = learner.rng.random((n_steps, 3))
    changes, returns = np.empty((2, n_steps))
    lengths = np.empty(n_steps, dtype=np.int64)
    n_episodes = walk_and_learn(
        learner._pairs,
        mdp.cumulative,
        mdp.R,
        mdp.ends,
        starts / starts[-1],
        u,
        np.array([number("temperature", T, 0) for T in temperatures]),
        learner._rates(int(learner.visits.max()) + n_steps),
        learner.gamma,
        changes,
        returns,
        lengths,
    )
    if n_episodes < 0:
        raise ValueError("Q must stay finite")
    return TrainingRun(changes, returns[:n_episodes].copy(), lengths[:n_episodes].copy())
