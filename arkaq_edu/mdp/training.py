"""Learning by doing: the exploration and the exploitation phase of the thesis, made to run.

Figures 4.3 and 4.4 are one loop, `learn`. `explore` and `exploit` call it with their two ways to
select an action. Line for line::

    while Q matrix is not converged          until the last backups changed almost nothing
        select action a                      explore: at random, untried actions first (4.3)
                                             exploit: Boltzmann, cooling (3.2; 4.4 has "high Q")
        identify current state s             before a is selected, which depends on it
        while current state remains same     at most max_repeat times
            perform action a
        receive immediate reward r           the discounted sum of the rewards of all those steps
        receive new state s'
        evaluate Q[s][a]                     a semi-Markov backup: gamma^k for k steps;
                                             then reset an episode that is over

As printed, the procedures cannot run. Both say "while Q matrix is not converged", but the second
one starts when the first has converged. 4.4 selects a before it knows s. An action that never
changes the state, such as a kick, would be repeated for ever. Nothing resets an episode. And the
Boltzmann choice that chapter 3 announces is in neither.

`train` runs the same loop on a known model, compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Discrete
from numpy.typing import NDArray

from arkaq_edu._checks import affordable, array, integer, number
from arkaq_edu.mdp import compiled
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.prediction import discounted_returns
from arkaq_edu.mdp.q_learning import QLearner
from arkaq_edu.mdp.schedules import Schedule, value_at


class Held(NamedTuple):
    """The result of holding one action while the state remained the same.

    Attributes
    ----------
    rewards : list of float
        The reward of each step, at least one.
    s_next : int
        The next state.
    terminated, truncated : bool
        Whether the episode ended there, or was cut short there.
    """

    rewards: list[float]
    s_next: int
    terminated: bool
    truncated: bool


class TrainingRun(NamedTuple):
    """The course of learning.

    Attributes
    ----------
    changes : ndarray, shape (backups,)
        The change of Q(s, a) by each backup.
    returns : ndarray, shape (episodes,)
        The sum of the rewards, not discounted, of each finished episode.
    lengths : ndarray of int, shape (episodes,)
        The number of steps of each finished episode.
    """

    changes: NDArray[np.float64]
    returns: NDArray[np.float64]
    lengths: NDArray[np.int64]


class Quiet:
    """The backups since the last one that changed Q by more than a tolerance.

    Attributes
    ----------
    backups : int
        Their number.
    pairs : set of (int, int)
        The pairs (s, a) that they were made for.
    met : set of int
        All states that any backup was made for.
    """

    def __init__(self, tol: float) -> None:
        self.tol = number("tol", tol, 0)
        self.backups, self.pairs, self.met = 0, set[tuple[int, int]](), set[int]()

    def note(self, s: int, a: int, change: float) -> None:
        """Count a backup."""
        if abs(change) > self.tol:
            self.backups = 0
            self.pairs.clear()
        self.backups += 1
        self.pairs.add((s, a))
        self.met.add(s)


def hold(env: Any, s: int, a: int, max_repeat: int = 10) -> Held:
    """Perform an action again and again while the state remains the same.

    Parameters
    ----------
    env : gymnasium.Env
        An environment with discrete observations (the states) and discrete actions.
    s : int
        The current state.
    a : int
        The action.
    max_repeat : int, default 10
        The largest number of steps, at least 1.

    Returns
    -------
    Held

    Raises
    ------
    ValueError
        If `a` is not an action of the environment or `max_repeat` is not an integer >= 1.

    References
    ----------
    Thesis 4.3 ("while current state remains same do perform action a").

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("CliffWalking-v1")
    >>> s, _ = env.reset(seed=0)
    >>> hold(env, int(s), a=3, max_repeat=4)  # to the left, against the wall
    Held(rewards=[-1.0, -1.0, -1.0, -1.0], s_next=36, terminated=False, truncated=False)
    """
    s, a = integer("s", s), integer("a", a, 0, int(env.action_space.n) - 1)
    rewards = []
    for _ in range(integer("max_repeat", max_repeat, 1)):
        s_next, r, terminated, truncated, _ = env.step(a)
        rewards.append(float(r))
        if s_next != s or terminated or truncated:
            break
    return Held(rewards, int(s_next), bool(terminated), bool(truncated))


def learn(
    env: Any,
    learner: QLearner,
    select: Callable[[int, int], int],
    converged: Callable[[Quiet], bool],
    *,
    max_backups: int,
    tol: float,
    max_repeat: int,
    seed: int | None,
) -> TrainingRun:
    """Run the loop of figures 4.3 and 4.4, which `explore` and `exploit` share.

    Parameters
    ----------
    env, learner, max_backups, tol, max_repeat, seed
        As for `explore`.
    select : callable
        Returns an action for a state s and the number of the backup n = 1, 2, ...
    converged : callable
        Returns whether Q has converged, from the backups since the last change above `tol`.

    Returns
    -------
    TrainingRun

    Raises
    ------
    ValueError
        If an argument is out of range, or the learner's table does not fit the environment.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("CliffWalking-v1")
    >>> learner = QLearner(48, 4, alpha=1.0, gamma=0.9)
    >>> limits = {"max_backups": 2, "tol": 0.0, "max_repeat": 1, "seed": 0}
    >>> learn(env, learner, lambda s, n: 0, lambda quiet: False, **limits).changes  # up, up
    array([-1., -1.])
    """
    n_states, n_actions = learner.Q.shape
    if not _fits(env.observation_space, n_states) or not _fits(env.action_space, n_actions):
        raise ValueError(
            f"env must be Discrete, with the learner's {n_states} states and {n_actions} actions, "
            f"got observations {env.observation_space} and actions {env.action_space}"
        )
    if seed is not None:
        seed = integer("seed", seed)
    quiet = Quiet(tol)
    changes, returns, lengths, earned, length = [], [], [], 0.0, 0
    s = int(env.reset(seed=seed)[0])
    for n in range(1, integer("max_backups", max_backups, 1) + 1):
        a = select(s, n)
        rewards, s_next, terminated, truncated = hold(env, s, a, max_repeat)
        k = len(rewards)
        r = float(discounted_returns(rewards, learner.gamma)[0])
        changes.append(learner.update(s, a, r, s_next, terminated, n_steps=k))
        quiet.note(s, a, changes[-1])
        earned, length, s = earned + sum(rewards), length + k, s_next
        if terminated or truncated:
            returns.append(earned)
            lengths.append(length)
            earned, length, s = 0.0, 0, int(env.reset()[0])
        if converged(quiet):
            break
    return TrainingRun(np.array(changes), np.array(returns, float), np.array(lengths, np.int64))


def _fits(space: Any, n: int) -> bool:
    """Return whether the elements of a space are 0, 1, ... n - 1."""
    return isinstance(space, Discrete) and (space.start, space.n) == (0, n)


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
        An environment with discrete observations (the states) and discrete actions. It is reset
        first.
    learner : QLearner
        The learner; its generator draws the actions.
    max_backups : int, default 100000
        The largest number of backups, at least 1.
    tol : float, default 1e-6
        Q has converged when, since the last change greater than this, every action has been tried
        in every known state. If outcomes are certain, Q is then within tol / (1 - gamma) of Q*.
    max_repeat : int, default 10
        The largest number of steps for which an action is held while the state remains the same.
    seed : int, optional
        The seed of the first reset of the environment.

    Returns
    -------
    TrainingRun

    Raises
    ------
    ValueError
        If an argument is out of range, or the learner's table does not fit the environment.

    Notes
    -----
    If the learning rate falls, changes also become small because the rate is small. Then rely on
    `max_backups` instead.

    References
    ----------
    Thesis 4.3, figure 4.3.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("FrozenLake-v1", is_slippery=False)
    >>> learner = QLearner(16, 4, alpha=1.0, gamma=0.5, rng=0)
    >>> run = explore(env, learner, seed=0)
    >>> learner.Q[0]  # six steps from the goal; the first action is held ten times at the wall
    array([3.05175781e-05, 3.12500000e-02, 3.12500000e-02, 3.05175781e-05])
    >>> exploit(env, learner, max_backups=6).returns
    array([1.])
    """

    def select(s: int, n: int) -> int:
        return learner.explore(s)

    def converged(quiet: Quiet) -> bool:
        return len(quiet.pairs) == len(quiet.met) * learner.Q.shape[1]

    return learn(
        env, learner, select, converged,
        max_backups=max_backups, tol=tol, max_repeat=max_repeat, seed=seed,
    )  # fmt: skip


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
        An environment with discrete observations (the states) and discrete actions. It is reset
        first.
    learner : QLearner
        A learner that has explored; its generator draws the actions.
    temperature : float or callable, default 0.0
        The temperature of the Boltzmann choice, or a function of the backup n = 1, 2, ... that
        returns it. At 0, its limit, one of the best actions is drawn.
    max_backups : int, default 100000
        The largest number of backups, at least 1.
    tol : float, default 1e-6
        Q has converged when it has changed by no more than this in as many backups in a row as it
        has entries. (Not in every pair, as for `explore`: actions that look bad are rarely tried.)
    max_repeat : int, default 10
        The largest number of steps for which an action is held while the state remains the same.
    seed : int, optional
        The seed of the first reset of the environment.

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

    def select(s: int, n: int) -> int:
        T = value_at(temperature, n)
        return learner.boltzmann(s, T) if T != 0 else learner.greedy(s)

    def converged(quiet: Quiet) -> bool:
        return quiet.backups >= learner.Q.size

    return learn(
        env, learner, select, converged,
        max_backups=max_backups, tol=tol, max_repeat=max_repeat, seed=seed,
    )  # fmt: skip


def train(
    mdp: MDP,
    learner: QLearner,
    n_steps: int,
    *,
    temperature: float | Schedule = np.inf,
) -> TrainingRun:
    """Let a learner act in a known model, which it does not use, for a number of steps.

    This is `exploit` with ``max_repeat=1`` and without the test for convergence, in one compiled
    loop. A test holds the two equal.

    Parameters
    ----------
    mdp : MDP
        The world. Episodes start by ``mdp.start`` and end in ``mdp.ends``.
    learner : QLearner
        The learner, with the model's states and actions; its generator draws everything: three
        numbers for each step. An action that the model does not allow gets Q = -inf.
    n_steps : int
        The number of steps, at least 1; the last episode may stay unfinished.
    temperature : float or callable, default infinity
        The temperature of the Boltzmann choice, or a function of the step n = 1, 2, ... that
        returns it. At infinity actions are random; at 0 one of the best is drawn.

    Returns
    -------
    TrainingRun

    Raises
    ------
    ValueError
        If an argument is out of range, the learner's table has another shape or holds a value
        that is not a number, or every state of the model is an end.

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
    n_temperatures = n_steps if callable(temperature) else 1
    temperatures = [
        number("temperature", value_at(temperature, n + 1), 0) for n in range(n_temperatures)
    ]
    affordable("n_steps", (n_steps, 3))
    rates = learner.rates(n_steps)
    array("Q", learner.Q, mdp.R.shape, allow_minus_infinity=True)
    learner.Q[~mdp.allowed] = -np.inf
    if (learner.Q.max(axis=1) == -np.inf).any():
        s = int(learner.Q.max(axis=1).argmin())
        raise ValueError(f"learner must allow an action in every state, got only -inf in state {s}")
    starts = np.where(mdp.ends, 0.0, mdp.start).cumsum()
    if not starts[-1] > 0:
        raise ValueError("mdp must be able to start in a state that is not an end")
    changes, returns, lengths = np.empty(n_steps), np.empty(n_steps), np.empty(n_steps, np.int64)
    n_episodes = compiled.train(
        learner.Q, learner.visits, *mdp.outcomes, mdp.R, mdp.ends, starts / starts[-1],
        learner.rng.random((n_steps, 3)), np.array(temperatures), rates, learner.gamma,
        changes, returns, lengths,
    )  # fmt: skip
    return TrainingRun(changes, returns[:n_episodes].copy(), lengths[:n_episodes].copy())
