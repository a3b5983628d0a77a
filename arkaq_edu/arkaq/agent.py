"""The ARKAQ agent: a world model (Kalman filter and segmenter) and a policy (learner)."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.arkaq import storage
from arkaq_edu.arkaq.learners import Learner, QLearning
from arkaq_edu.arkaq.segmenters import Segmenter
from arkaq_edu.arkaq.sensing import PRESETS, Estimator, Sensing
from arkaq_edu.arkaq.settings import TrainingSettings
from arkaq_edu.arkaq.training import FINISHED, LEARNING, SEGMENTING, TASKS, Phase
from arkaq_edu.art import EuclideanART

if TYPE_CHECKING:
    import gymnasium


class Arkaq:
    """An agent that first divides what it sees into states, then learns what to do in each.

    From a look to a step: camera pixels -> sighting -> Kalman estimate -> scaled pattern ->
    category -> row of Q -> action.

    Parameters
    ----------
    vigilance : float
        The ART network's vigilance, a distance between scaled patterns, in (0, 2]. Only the
        default segmenter uses it.
    task : {"approach", "goal"}
        What the agent learns. It decides which automata the agent runs, and the defaults of the
        next two arguments.
    sensing : {"consistent", "thesis", "goal"} or Sensing, optional
        The settings of the Kalman filter and the intervals of the measurements. The default is
        "consistent" for the ball and "goal" for the goal.
    learning : TrainingSettings, optional
        All that the thesis leaves open: schedules, discount, numbers of patterns and cycles. The
        default is ``TrainingSettings()`` for the ball and ``TrainingSettings.goal()`` for the
        goal.
    segmenter : Segmenter, optional
        What makes states of patterns. The agent works on a copy. The default is
        ``EuclideanART(vigilance, learning.learning_rate)``.
    learner : Learner, optional
        What learns the values and chooses the actions. The agent works on a copy. The default is
        ``QLearning()``, which backs an episode up from its end.
    rng : int or numpy.random.Generator, optional
        The seed of everything the agent draws and of every episode it starts.

    Attributes
    ----------
    art : Segmenter
        The segmentation. By default an `EuclideanART` with `cluster_centers_` of shape (S, m).
    q : Learner or None
        The values: `Q`, shape (S, A). None until Q-learning has begun.
    history : list of tuple
        One row per episode: phase, cycles, reward, and whether the goal was reached.
    cycles : int
        Steps taken in the environment so far.
    phase : {"segmentation", "Q-learning", "finished"}
        The phase that `learn` goes on with.
    done_in_phase : int
        The patterns, or the cycles, of that phase so far.
    environments : dict
        What decides how episodes go in the environment of each phase, as plain data by name.

    Raises
    ------
    ValueError
        If an argument is out of range or unknown.

    References
    ----------
    Thesis chapter 3 (figures 3.1 and 3.2), 5.2 (figures 5.6 and 5.15) and 5.3 (figures 5.34 and
    5.38).
    Sardag and Akin, ARKAQ-Learning, ISCIS 2005.
    Lin, Self-improving reactive agents based on reinforcement learning, planning and teaching,
    Machine Learning 8, 1992 (backing an episode up from its end).

    Examples
    --------
    >>> import gymnasium
    >>> from arkaq_edu.arkaq import Sarsa, TrainingSettings, UniformGrid
    >>> env = gymnasium.make("arkaq_edu:BallApproach-v0", far=1000.0)
    >>> short = TrainingSettings(patterns=300, exploration=2000, exploitation=0)
    >>> agent = Arkaq(vigilance=0.2, learning=short, rng=0).learn(env, progress=False)
    >>> observation, info = env.reset(seed=1)
    >>> agent.reset()
    >>> agent.act(observation) in (0, 1, 2)
    True

    With other parts: cells of equal size, and SARSA.

    >>> agent = Arkaq(segmenter=UniformGrid((20, 10)), learner=Sarsa(), learning=short, rng=0)
    >>> agent.learn(env, progress=False).q.Q.shape
    (200, 3)

    The same class learns to score.

    >>> env = gymnasium.make("arkaq_edu:ScoreGoal-v0")
    >>> short = TrainingSettings.goal(patterns=200, exploration=200, exploitation=0)
    >>> agent = Arkaq(0.06, task="goal", learning=short, rng=0).learn(env, progress=False)
    >>> agent.q.Q.shape[1]
    3
    """

    def __init__(
        self,
        vigilance: float = 0.1,
        *,
        task: Literal["approach", "goal"] = "approach",
        sensing: Sensing | Literal["consistent", "thesis", "goal"] | None = None,
        learning: TrainingSettings | None = None,
        segmenter: Segmenter | None = None,
        learner: Learner | None = None,
        rng: int | np.random.Generator | None = None,
    ) -> None:
        self.vigilance = _checks.number("vigilance", vigilance, 0, 2, open_low=True)
        self.task = _checks.choice("task", task, TASKS)
        if isinstance(sensing, str):
            if sensing not in PRESETS:
                names = ", ".join(map(repr, PRESETS))
                given = _checks.shown(sensing)
                raise ValueError(f"sensing must be {names} or a Sensing, got {given}")
            sensing = PRESETS[sensing]()
        sensing = TASKS[task].sensing() if sensing is None else sensing
        learning = TASKS[task].learning() if learning is None else learning
        self.sensing = _checks.instance("sensing", sensing, Sensing)
        self.learning = _checks.instance("learning", learning, TrainingSettings)
        # A generator is asked only once. Every episode then makes its own seed from this one, so
        # that a resumed run draws the same numbers.
        if rng is None or isinstance(rng, np.random.Generator):
            rng = int(_checks.generator("rng", rng).integers(2**63))
        self.seed = _checks.integer("rng", rng)
        self.segmenter: Segmenter = self.default_segmenter() if segmenter is None else segmenter
        self.learner: Learner = QLearning() if learner is None else learner
        _require("segmenter", self.segmenter, ("learn_one", "category"))
        _require("learner", self.learner, ("begin", "explore", "exploit", "greedy", "learn"))
        self.art: Any = copy.deepcopy(self.segmenter)  # a Segmenter; figures ask for more
        self.q: Learner | None = None
        self.history: list[tuple[str, int, float, bool]] = []
        self.cycles = 0
        self.phase, self.done_in_phase = SEGMENTING, 0
        self.environments: dict[str, dict[str, Any]] = {}
        self.estimator = Estimator(self.sensing)
        self.reset()

    def default_segmenter(self) -> EuclideanART:
        """Return the segmenter of the thesis with this agent's settings."""
        return EuclideanART(self.vigilance, self.learning.learning_rate)

    def new_learner(self, n_actions: int) -> Learner:
        """Put a learner with an empty table in `q`, with a row for each category, and return it."""
        self.q = copy.deepcopy(self.learner)
        self.q.begin(self.art.n_clusters_, n_actions, self.learning)
        return self.q

    def reset(self) -> None:
        """Start a new episode: forget where the ball, or the goal, was."""
        self.estimator.reset()
        self._last_action: int | None = None

    def act(self, observation: ArrayLike) -> int:
        """Return the greedy action, given this observation and all before it in the episode.

        Parameters
        ----------
        observation : array_like, shape (m + 1,)
            The environment's observation; its last entry is 1 with a sighting and 0 without.

        Returns
        -------
        int
            The action with the highest Q; of several, the first.

        Raises
        ------
        ValueError
            If the observation has the wrong shape or is not finite.
        RuntimeError
            If the agent has not learned yet.
        """
        if self.q is None:
            raise RuntimeError("this agent has not learned yet: call learn first")
        pattern = self.estimator.observe(observation, self._last_action)
        self._last_action = self.q.greedy(self.art.category(pattern))
        return self._last_action

    def learn(
        self,
        env: gymnasium.Env,
        checkpoint: str | os.PathLike[str] | None = None,
        progress: bool = True,
    ) -> Arkaq:
        """Segment the world, then learn what to do in it.

        Parameters
        ----------
        env : gymnasium.Env
            The task. The last entry of its observations says whether there was a sighting. Its
            episodes must end at some time, for example by a time limit.
        checkpoint : path, optional
            A file for the run. It is written at the start, between episodes every few seconds,
            and at the end. If it exists, the run in it is resumed, with the same result as if it
            had never been interrupted. No other run can use the file at the same time.
        progress : bool
            Whether to show progress bars.

        Returns
        -------
        Arkaq
            The agent itself.

        Raises
        ------
        ValueError
            If `checkpoint` holds a run with other settings, another seed or another environment,
            if it is in use by another run, if a part cannot be saved there (see `save`), or if the
            environment belongs to another task.
        RuntimeError
            If the ball, or the goal, is never seen.
        """
        for _ in self.events(env, checkpoint, progress):
            pass
        return self

    def events(
        self,
        env: gymnasium.Env,
        checkpoint: str | os.PathLike[str] | None = None,
        progress: bool = False,
        learns: bool = True,
    ) -> Iterator[Event]:
        """Learn as `learn` does, and stop after each event of the automata to be watched.

        Parameters
        ----------
        env, checkpoint, progress
            As for `learn`.
        learns : bool
            If False, stop where `segment` does.

        Yields
        ------
        Event
            The phase, its state that has worked, the event, and the state that follows.

        Examples
        --------
        >>> import gymnasium
        >>> agent = Arkaq(learning=TrainingSettings(patterns=1, exploration=5), rng=0)
        >>> for event in agent.events(gymnasium.make("arkaq_edu:BallApproach-v0"), learns=False):
        ...     print(event.state, "--", event.event, "->", event.then)
        supervisor -- reset -> observe
        observe -- ball seen -> network
        network -- category created -> act
        act -- period over -> supervisor
        supervisor -- enough -> done
        """
        with storage.Checkpoint(self, checkpoint) as file:
            file.resume(env, learns=learns)
            file.write()
            task = TASKS[self.task]
            if self.phase == SEGMENTING:
                yield from _watched(task.segmentation(self, env, file, progress))
                self.phase, self.done_in_phase = LEARNING, 0
                file.write()
            if not learns:
                return
            if self.phase == LEARNING:
                if self.q is None:
                    self.new_learner(int(env.action_space.n))  # type: ignore[attr-defined]
                yield from _watched(task.q_learning(self, env, file, progress))
                self.phase = FINISHED
            self.reset()
            file.write()

    def segment(
        self,
        env: gymnasium.Env,
        checkpoint: str | os.PathLike[str] | None = None,
        progress: bool = True,
    ) -> Arkaq:
        """Segment the world and stop there; `learn` goes on, in the same or another environment.

        Parameters
        ----------
        env, checkpoint, progress
            As for `learn`.

        Returns
        -------
        Arkaq
            The agent itself. An agent that has already segmented its world does nothing.
        """
        for _ in self.events(env, checkpoint, progress, learns=False):
            pass
        return self

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the agent to an npz file of arrays and JSON, without pickles.

        Parameters
        ----------
        path : path
            The file. It is replaced only when the new one is complete.

        Raises
        ------
        ValueError
            If `art` or `q` is of another class than the package's own: `EuclideanART` or
            `UniformGrid`, `QLearning`, `Sarsa` or `ExpectedSarsa`. A file could hold the arrays of
            such a part, but not what its class does.
        """
        storage.save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Arkaq:
        """Read an agent that `save` wrote. Nothing in the file is run.

        Parameters
        ----------
        path : path
            The file.

        Returns
        -------
        Arkaq

        Raises
        ------
        ValueError
            If the file is not an agent, is damaged, or has a format this version cannot read.
        """
        return storage.load(cls, path)


class Event(NamedTuple):
    """Something that happened while an agent learned.

    Attributes
    ----------
    phase : Phase
        The phase of training; see `arkaq_edu.arkaq.training`.
    state, event, then : str
        The state of the automaton that has worked, the event, and the state that follows.
    """

    phase: Phase
    state: str
    event: str
    then: str


def _watched(phase: Phase) -> Iterator[Event]:
    for state, event, then in phase.events():
        yield Event(phase, state, event, then)


def _require(role: str, part: Any, methods: tuple[str, ...]) -> None:
    if isinstance(part, type):
        raise ValueError(f"{role} must be an object, got the class {part.__name__}")
    for name in methods:
        if not callable(getattr(part, name, None)):
            given = _checks.shown(part)
            raise ValueError(f"{role} must have the methods {', '.join(methods)}, got {given}")
