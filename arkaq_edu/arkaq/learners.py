"""What learns to act in the states: the protocol of a learner, Q-learning, and two kinds of SARSA.

A learner gets whole episodes, once they are finished. The ones here back an episode up from its
end (Lin 1992): so the reward at the end reaches the start in one episode, where backups on the
way would carry it back by one state an episode.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from arkaq_edu import _checks
from arkaq_edu.arkaq.settings import TrainingSettings
from arkaq_edu.mdp import QLearner, softmax


class Experience(NamedTuple):
    """One action, held while the state stayed the same, and what it led to.

    Attributes
    ----------
    s, a : int
        The state, and the action taken in it.
    r : float
        The reward. For an action held for k cycles, the rewards discounted to the first.
    s_next : int
        The next state.
    terminated : bool
        Whether the episode ended there. False for an episode that was only cut short.
    n_steps : int
        The number of cycles k that the action was held.
    """

    s: int
    a: int
    r: float
    s_next: int
    terminated: bool
    n_steps: int


class Learner(Protocol):
    """What `Arkaq` needs of a learner.

    Most learners only change how an episode is learned: they are subclasses of `TableLearner`
    with a method `learn`.

    Attributes
    ----------
    Q : ndarray, shape (n_states, n_actions)
        The value of each action in each state, once `begin` has been called.
    """

    @property
    def Q(self) -> NDArray[np.float64]:
        """The value of each action in each state."""

    def begin(self, n_states: int, n_actions: int, settings: TrainingSettings) -> None:
        """Make the table: the world has been segmented into `n_states` states."""

    def explore(self, s: int, rng: np.random.Generator) -> int:
        """Draw an action while exploring."""

    def exploit(self, s: int, temperature: float, rng: np.random.Generator) -> int:
        """Draw an action while exploiting, at a temperature that falls."""

    def greedy(self, s: int) -> int:
        """Return the best action known, as `Arkaq.act` takes it."""

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Learn from a finished episode.

        `temperature` is the one at which its last action was drawn, infinity while exploring.
        """


class TableLearner(BaseEstimator):
    """A table of values, and the choices of the thesis. A subclass says how to learn.

    `Q` and `visits` are arrays to write into, not to replace. `explore` reads `visits`; `exploit`
    and `greedy` read `Q`. A `learn` that needs chance keeps the generator that `explore` and
    `exploit` are given, for only that one belongs to the agent's seed.

    Examples
    --------
    A learner of one's own: Monte Carlo, which takes the discounted return as the target.

    >>> import gymnasium
    >>> from arkaq_edu.arkaq import Arkaq, TableLearner, TrainingSettings
    >>> class MonteCarlo(TableLearner):
    ...     def learn(self, episode, temperature):
    ...         G = 0.0
    ...         for s, a, r, s_next, terminated, n_steps in reversed(episode):
    ...             G = r + self.gamma**n_steps * G
    ...             self.back_up(s, a, G)
    >>> short = TrainingSettings(patterns=300, exploration=1000, exploitation=0)
    >>> env = gymnasium.make("arkaq_edu:BallApproach-v0", far=1000.0)
    >>> agent = Arkaq(0.2, learner=MonteCarlo(), learning=short, rng=0)
    >>> bool(agent.learn(env, progress=False).q.Q.max() > 100)
    True
    """

    table: QLearner

    @property
    def Q(self) -> NDArray[np.float64]:
        """Expected return of each pair, shape (n_states, n_actions)."""
        return self.table.Q

    @property
    def visits(self) -> NDArray[np.int64]:
        """Number of backups of each pair, shape (n_states, n_actions)."""
        return self.table.visits

    @property
    def gamma(self) -> float:
        """The discount per cycle."""
        return self.table.gamma

    def begin(self, n_states: int, n_actions: int, settings: TrainingSettings) -> None:
        """Make a table of zeros."""
        _checks.instance("settings", settings, TrainingSettings)
        self.table = QLearner(n_states, n_actions, settings.alpha, settings.gamma)
        self._alpha = settings.alpha

    def explore(self, s: int, rng: np.random.Generator) -> int:
        """Draw an action never backed up in `s`; where there is none, any action."""
        self.table.rng = _checks.generator("rng", rng)
        return self.table.explore(s)

    def exploit(self, s: int, temperature: float, rng: np.random.Generator) -> int:
        """Draw from the Boltzmann distribution (eq 3.2)."""
        self.table.rng = _checks.generator("rng", rng)
        return self.table.boltzmann(s, temperature)

    def greedy(self, s: int) -> int:
        """Return the action with the highest Q; of several, the first (eq 3.3)."""
        return int(self.Q[self._state("s", s)].argmax())

    def back_up(self, s: int, a: int, target: float) -> None:
        """Move Q(s, a) toward a target."""
        s, a = self._state("s", s), _checks.integer("a", a, 0, self.Q.shape[1] - 1)
        target = _checks.number("target", target)
        self.visits[s, a] += 1
        alpha = self._alpha(int(self.visits[s, a]))
        self.Q[s, a] += alpha * (target - self.Q[s, a])

    def expected(self, s: int, temperature: float) -> float:
        """Return the expected value of `s` under the Boltzmann policy."""
        s = self._state("s", s)
        return float(softmax(self.Q[s], temperature) @ self.Q[s])

    def _state(self, name: str, s: int) -> int:
        return _checks.integer(name, s, 0, len(self.Q) - 1)


class QLearning(TableLearner):
    """Q-learning (eq 2.12): the next state is worth its best action.

    References
    ----------
    Thesis 2.2.3 and chapter 3.
    """

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Back an episode up from its end."""
        for experience in reversed(episode):
            self.table.update(*experience)


class Sarsa(TableLearner):
    """SARSA: the next state is worth the action that was taken there.

    It learns the value of what the agent does, exploring included; Q-learning learns the value
    of the best it could do. Where the episode was cut short, no next action was taken: the
    expected value of the next state stands in for it.

    References
    ----------
    R. Sutton, A. Barto, "Reinforcement Learning", 2nd edition, 2018, section 6.4.

    Examples
    --------
    >>> from arkaq_edu.arkaq import TrainingSettings
    >>> learner = Sarsa()
    >>> learner.begin(2, 2, TrainingSettings(gamma=0.5, alpha_power=0.0))
    >>> learner.learn([Experience(0, 0, 0.0, 1, False, 1), Experience(1, 1, 8.0, 0, True, 1)], 1.0)
    >>> learner.Q
    array([[4., 0.],
           [0., 8.]])
    """

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Back an episode up from its end."""
        a_next = None
        for s, a, r, s_next, terminated, n_steps in reversed(episode):
            if terminated:
                value = 0.0
            elif a_next is None:
                value = self.expected(s_next, temperature)
            else:
                value = float(self.Q[s_next, a_next])
            self.back_up(s, a, r + self.gamma**n_steps * value)
            a_next = a


class ExpectedSarsa(TableLearner):
    """Expected SARSA: the next state is worth its actions' mean under the Boltzmann policy.

    As SARSA, without the chance of the next action. As the temperature falls to 0 it becomes
    Q-learning.

    References
    ----------
    R. Sutton, A. Barto, "Reinforcement Learning", 2nd edition, 2018, section 6.6.
    """

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Back an episode up from its end."""
        for s, a, r, s_next, terminated, n_steps in reversed(episode):
            value = 0.0 if terminated else self.expected(s_next, temperature)
            self.back_up(s, a, r + self.gamma**n_steps * value)
