"""The phases of training: each runs one automaton of the thesis, episode by episode.

The Q-learning phases are the loop of figures 4.3 and 4.4, which `arkaq_edu.mdp.explore` and
`arkaq_edu.mdp.exploit` run on discrete environments. The choices, the holding of an action and
the experiences are the same, and a test compares them. One thing differs: here the learner gets
an episode when it is finished, there after each experience.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from tqdm.auto import tqdm

from arkaq_edu import _checks
from arkaq_edu.arkaq.automata import (
    GOAL_Q_LEARNING,
    GOAL_SEGMENTATION,
    Q_LEARNING,
    SEGMENTATION,
    Automaton,
)
from arkaq_edu.arkaq.learners import Experience
from arkaq_edu.arkaq.sensing import Sensing
from arkaq_edu.arkaq.settings import TrainingSettings

if TYPE_CHECKING:
    import gymnasium

    from arkaq_edu.arkaq.agent import Arkaq
    from arkaq_edu.arkaq.storage import Checkpoint

SEGMENTING, LEARNING, FINISHED = PHASES = "segmentation", "Q-learning", "finished"
# In the task as it is, the target is seen at nearly every start. So many misses in a row mean
# that it never will be, and the automaton would ask for resets forever.
MISSES_BEFORE_GIVING_UP = 1000


def require_task(agent: Arkaq, env: Any) -> None:
    """Refuse what is not an environment, or one whose observations the agent does not measure."""
    from gymnasium import Env

    wanted = (len(agent.sensing.low) + 1,)
    given = _checks.instance("env", env, Env).observation_space.shape
    if given != wanted:
        raise ValueError(
            f"env must have an observation_space of shape {wanted}, the measurements and whether "
            f"there was a sighting, got {given}"
        )


class Phase:
    """What all phases share: the supervisor, who starts and ends episodes, and one cycle.

    A phase runs its automaton. The work of each state is the method of that name.

    Every episode has a random stream of its own, made from the agent's seed, the phase and the
    number of the episode. So a run can be resumed from what has been learned alone.
    """

    automaton: Automaton
    name: str
    number: int
    unit: str
    target: str

    def __init__(
        self, agent: Arkaq, env: gymnasium.Env, checkpoint: Checkpoint, progress: bool
    ) -> None:
        self.agent, self.env, self.checkpoint = agent, env, checkpoint
        self.settings, self.estimator = agent.learning, agent.estimator
        self.bar = tqdm(
            total=self.total,
            initial=min(agent.done_in_phase, self.total),
            desc=self.name,
            unit=self.unit,
            disable=not progress,
        )
        self.episode = sum(row[0] == self.name for row in agent.history)
        self.in_progress, self.cycles, self.reward, self.success = False, 0, 0.0, False

    @property
    def total(self) -> int:
        """Patterns or cycles after which the phase is finished."""
        raise NotImplementedError

    def events(self) -> Iterator[tuple[str, str, str]]:
        """Run the automaton to its end, event by event; see `Automaton.events`."""
        states = self.automaton.states
        return self.automaton.events({state: getattr(self, state) for state in states})

    def supervisor(self) -> str:
        """Record the episode that ended, write the checkpoint, and reset the world."""
        agent = self.agent
        if self.in_progress:
            agent.history.append((self.name, self.cycles, self.reward, self.success))
            agent.cycles += self.cycles
            self.episode += 1
            self.bar.update(min(agent.done_in_phase, self.total) - self.bar.n)
            self.in_progress = False
            self.checkpoint.write_if_due()
        if agent.done_in_phase >= self.total:
            self.bar.close()
            return "enough"
        self.rng = np.random.default_rng([agent.seed, self.number, self.episode])
        self.observation, _ = self.env.reset(seed=int(self.rng.integers(2**31)))
        self.estimator.reset()
        self.pattern = self.estimator.observe(self.observation, None)
        self.in_progress, self.cycles, self.reward, self.success = True, 0, 0.0, False
        return "reset"

    def step(self, action: int) -> float:
        """Act for one cycle and observe; return the reward."""
        self.observation, reward, self.terminated, self.truncated, info = self.env.step(action)
        self.pattern = self.estimator.observe(self.observation, action)
        reward = _checks.number("reward", reward)
        self.cycles += 1
        self.reward += reward
        self.success = bool(info.get("is_success", False))
        return reward


class Segmentation(Phase):
    """Figure 5.6: random actions; every sighting is a pattern for the segmenter."""

    automaton = SEGMENTATION
    name, number, unit, target = SEGMENTING, 0, " patterns", "ball"
    misses = 0

    @property
    def total(self) -> int:
        """Patterns to present."""
        return self.settings.patterns

    def observe(self) -> str:
        """Look whether the target is in the picture."""
        return f"{self.target} seen" if self.observation[-1] else f"no {self.target}"

    def unknown(self) -> str:
        """Ask for a reset, or give up after too many misses."""
        self.misses += 1
        if self.misses == MISSES_BEFORE_GIVING_UP:
            raise RuntimeError(f"the {self.target} was not seen in {self.misses} looks in a row")
        return "ask for reset"

    def network(self) -> str:
        """Give the pattern to the segmenter."""
        self.misses = 0
        art = self.agent.art
        known = getattr(art, "n_clusters_", 0)  # ART has no categories before its first pattern
        art.learn_one(self.pattern)
        self.agent.done_in_phase += 1
        return "category created" if art.n_clusters_ > known else "category updated"

    def act(self) -> str:
        """Take a random action."""
        self.step(int(self.rng.integers(self.env.action_space.n)))  # type: ignore[attr-defined]
        over = self.terminated or self.truncated or self.cycles >= self.settings.period
        enough = self.agent.done_in_phase >= self.total
        return "period over" if over or enough else "moved"


class QLearningPhase(Phase):
    """Figure 5.15: first explore, later exploit; every finished episode goes to the learner."""

    automaton = Q_LEARNING
    name, number, unit = LEARNING, 1, " cycles"

    @property
    def total(self) -> int:
        """Cycles to take."""
        return self.settings.exploration + self.settings.exploitation

    def events(self) -> Iterator[tuple[str, str, str]]:
        """Run the automaton to its end, event by event."""
        assert self.agent.q is not None
        self.learner, self.category = self.agent.q, self.agent.art.category
        return super().events()

    def supervisor(self) -> str:
        """Start the next episode with no experience in it."""
        event = super().supervisor()
        if event == "reset":
            self.experiences: list[Experience] = []
            self.state = self.category(self.pattern)
        return event

    def identify(self) -> str:
        """Find out which part of the phase this is; the state is known already."""
        self.held, self.discounted, self.temperature = 0, 0.0, math.inf
        if self.agent.done_in_phase < self.settings.exploration:
            return "exploration"
        return "exploitation"

    def explore(self) -> str:
        """Choose an action as the learner explores."""
        self.action = self.learner.explore(self.state, self.rng)
        return "action chosen"

    def exploit(self) -> str:
        """Choose an action as the learner exploits, at a temperature that falls."""
        late = self.agent.done_in_phase - self.settings.exploration
        progress = min(1.0, late / max(1, self.settings.exploitation))
        self.temperature = self.settings.temperature(progress)
        self.action = self.learner.exploit(self.state, self.temperature, self.rng)
        return "action chosen"

    def act(self) -> str:
        """Take the action for one cycle, and hold it while the state remains the same."""
        reward = self.step(self.action) + self.settings.cycle_reward
        self.discounted += self.settings.gamma**self.held * reward
        self.held += 1
        self.agent.done_in_phase += 1
        self.next_state = self.category(self.pattern)
        if self.terminated or self.truncated:
            return "episode over"
        remains = self.next_state == self.state and self.held < self.settings.hold
        return "state remains" if remains else "state left"

    def evaluate(self) -> str:
        """Record the experience; when the episode is over, let the learner learn from all of it.

        A time limit only cuts an episode short. A ball that is lost for good ends it.
        """
        over = self.terminated or self.truncated
        lost = self.truncated and not self.observation[-1]
        if lost:
            self.discounted += self.settings.gamma ** (self.held - 1) * self.settings.lost_reward
        ended = bool(self.terminated or lost)
        self.experiences.append(
            Experience(self.state, self.action, self.discounted, self.next_state, ended, self.held)
        )
        self.state = self.next_state
        if not over:
            return "next"
        self.learner.learn(self.experiences, self.temperature)
        return "episode over"


class GoalSegmentation(Segmentation):
    """Figure 5.34: as figure 5.6, with turns instead of footsteps."""

    automaton = GOAL_SEGMENTATION
    target = "goal"

    def turn(self) -> str:
        """Take a random action; the environment should offer turns only."""
        event = self.act()
        return "turned" if event == "moved" else event


class GoalQLearningPhase(QLearningPhase):
    """Figure 5.38: as figure 5.15, but no action is held, and the supervisor judges the kick."""

    automaton = GOAL_Q_LEARNING

    def act(self) -> str:
        """Take the action for one cycle."""
        event = super().act()
        return event if event == "episode over" else "turned"

    def judge(self) -> str:
        """See where the ball has come to rest."""
        return "goal" if self.success else "no goal"


class Task(NamedTuple):
    """The phases of a task, and the defaults of an agent that learns it."""

    segmentation: type[Segmentation]
    q_learning: type[QLearningPhase]
    sensing: Callable[[], Sensing]
    learning: Callable[[], TrainingSettings]


TASKS = {
    "approach": Task(Segmentation, QLearningPhase, Sensing.consistent, TrainingSettings),
    "goal": Task(GoalSegmentation, GoalQLearningPhase, Sensing.goal, TrainingSettings.goal),
}
