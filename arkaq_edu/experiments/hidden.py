"""ARKAQ where the state is hidden: small POMDPs, and three kinds of what the agent remembers.

The agent is the one that walks to the ball. Only its patterns are others: in place of a scaled
Kalman estimate they hold

- ``"last look"``: the last observation alone;
- ``"two looks"``: the last two observations, and the action between them;
- ``"belief"``: the belief, which Bayes' rule keeps (eq 2.15). That needs the model.

`arkaq study data/studies/hidden.toml` compares them; ``data/studies/hidden.csv`` is its result.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks, pomdp
from arkaq_edu.arkaq import Arkaq, Sensing, TrainingSettings
from arkaq_edu.experiments.runs import FRESH_SEEDS

#: Chooses an action for a pattern.
Act = Callable[[NDArray[np.float64]], int]
#: Begins an episode: returns how actions are chosen in it.
Choose = Callable[[], Act]

#: What the agent remembers.
REMEMBERS = ("last look", "two looks", "belief")
#: Steps after which an episode is cut short.
LONGEST = 40
#: How the agent learns: as long as it takes for the values of these problems to settle.
LEARNING = TrainingSettings(
    patterns=300, period=LONGEST, exploration=1000, exploitation=2500, hold=1, gamma=0.95,
    alpha_least=0.01, hot=20.0, cold=0.5,
)  # fmt: skip


class Remembered(gymnasium.Wrapper[Any, int, Any, int]):
    """A POMDP's environment whose observation is what the agent remembers.

    Parameters
    ----------
    env : gymnasium.Env
        ``arkaq_edu:POMDP-v0``.
    remembers : {"last look", "two looks", "belief"}

    Examples
    --------
    The ball has been seen on the right: the belief is nearly sure of it.

    >>> for remembers in ("belief", "last look"):
    ...     env = make_hidden("ball_side", remembers)
    ...     seen = env.reset(seed=1)[0], env.step(0)[0]
    ...     [look[:-1].round(2).tolist() for look in seen]
    [[0.5, 0.5], [0.13, 0.88]]
    [[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0]]
    """

    def __init__(self, env: gymnasium.Env[Any, int], remembers: str) -> None:
        super().__init__(env)
        self.remembers = _checks.choice("remembers", remembers, REMEMBERS)
        self.pomdp: pomdp.POMDP = env.unwrapped.pomdp  # type: ignore[attr-defined]
        self.looks = np.eye(self.pomdp.n_observations + 1)
        self.actions = np.eye(self.pomdp.n_actions)
        self.observation_space = gymnasium.spaces.Box(0.0, 1.0, (len(self.reset()[0]),))

    def reset(self, **options: Any) -> tuple[Any, dict[str, Any]]:
        """Start an episode; nothing has been seen yet."""
        z, info = self.env.reset(**options)
        self.belief = self.pomdp.start
        self.before, self.last, self.action = self.looks[z], self.looks[z], 0 * self.actions[0]
        return self._pattern(), info

    def step(self, action: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Act, and remember what was seen."""
        z, reward, terminated, truncated, info = self.env.step(action)
        self.belief = pomdp.belief_update(self.pomdp, self.belief, action, int(z))
        self.before, self.last, self.action = self.last, self.looks[z], self.actions[action]
        return self._pattern(), float(reward), terminated, truncated, info

    def _pattern(self) -> NDArray[np.float64]:
        kinds = {
            "last look": [self.last],
            "two looks": [self.before, self.action, self.last],
            "belief": [self.belief],
        }
        return np.concatenate([*kinds[self.remembers], [1.0]])


def make_hidden(name: str, remembers: str) -> Remembered:
    """Return the environment of one of the course's POMDPs, with what the agent remembers."""
    env = gymnasium.make("arkaq_edu:POMDP-v0", pomdp=name, max_episode_steps=LONGEST)
    return Remembered(env, remembers)


def direct(n: int) -> Sensing:
    """Return senses without a filter for `n` numbers between 0 and 1: each is believed as it is."""
    one = np.eye(n)
    return Sensing((0.0,) * n, (1.0,) * n, A=one, H=one, Q=1e6 * one, R=1e-3 * one, P0=1e6 * one)


def train(
    name: str, remembers: str, seed: int, *, vigilance: float = 0.1,
    learning: TrainingSettings = LEARNING,
) -> Arkaq:  # fmt: skip
    """Train an ARKAQ agent on a POMDP.

    Parameters
    ----------
    name : str
        See `arkaq_edu.pomdp.problem`.
    remembers : {"last look", "two looks", "belief"}
    seed : int
        The agent's seed.
    vigilance : float
        How far apart two patterns of one category may be. Only beliefs lie between each other.
    learning : TrainingSettings

    Examples
    --------
    >>> brief = TrainingSettings(patterns=100, exploration=100, exploitation=0, hold=1)
    >>> train("tiger", "last look", 0, learning=brief).art.n_clusters_
    3
    """
    env = make_hidden(name, remembers)
    senses = direct(env.observation_space.shape[0] - 1)  # type: ignore[index]
    agent = Arkaq(vigilance, sensing=senses, learning=learning, rng=seed)
    return agent.learn(env, progress=False)


def earned(env: Remembered, choose: Choose, episodes: int, seed: int) -> float:
    """Return the mean reward of fresh episodes."""
    total = 0.0
    for episode in range(episodes):
        act = choose()
        pattern, over = env.reset(seed=seed * episodes + episode)[0], False
        while not over:
            pattern, reward, terminated, truncated, _ = env.step(act(pattern))
            total, over = total + reward, terminated or truncated
    return total / episodes


def measure(seed: int, problem: str, remembers: str, episodes: int = 200) -> dict[str, float]:
    """Train one agent on a POMDP, and judge it.

    Parameters
    ----------
    seed : int
        The seed of the agent. The episodes that judge it have another.
    problem : str
        See `arkaq_edu.pomdp.problem`.
    remembers : {"last look", "two looks", "belief"}
    episodes : int
        The number of fresh episodes.

    Returns
    -------
    dict
        ``states``: the number of categories. ``reward``: the mean of an episode. ``regret``: how
        much more the best policy over beliefs earns (chapter 4), in the same episodes.
    """
    agent, env = train(problem, remembers, seed), make_hidden(problem, remembers)

    def learned() -> Act:
        agent.reset()
        return agent.act

    reward = earned(env, learned, episodes, FRESH_SEEDS + seed)
    most = best(problem, FRESH_SEEDS + seed, episodes)
    return {"states": float(agent.art.n_clusters_), "reward": reward, "regret": most - reward}


@lru_cache(maxsize=64)
def best(name: str, seed: int, episodes: int = 200) -> float:
    """Return the mean reward of an episode by the best policy over beliefs (chapter 4).

    Examples
    --------
    >>> best("ball_side", 0, episodes=20) > best("tiger", 0, episodes=20) > 0
    True
    """
    value = _value(name)

    def choose() -> Act:
        return lambda pattern: value.action(pattern[:-1])

    return earned(make_hidden(name, "belief"), choose, episodes, seed)


@lru_cache(maxsize=8)
def _value(name: str) -> pomdp.ValueFunction:
    return pomdp.solve_point_based(pomdp.problem(name), 0.01).lower
