"""The ARKAQ agent: a world model of a Kalman filter and an ART network, and a policy of Q."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from tqdm.auto import tqdm

from arkaq_edu import _checks
from arkaq_edu.arkaq.automata import (
    GOAL_Q_LEARNING,
    GOAL_SEGMENTATION,
    Q_LEARNING,
    SEGMENTATION,
    Automaton,
)
from arkaq_edu.arkaq.sensing import Estimator, Sensing
from arkaq_edu.arkaq.settings import TrainingSettings
from arkaq_edu.art import EuclideanART
from arkaq_edu.mdp import QLearner

if TYPE_CHECKING:
    import gymnasium

FORMAT = 1
_SEGMENTING, _LEARNING, _FINISHED = "segmentation", "Q-learning", "finished"
_SECONDS_BETWEEN_FILES = 5.0
_MOST_BLIND_LOOKS = 1000


class Arkaq:
    """An agent that cuts the world into states as it meets them and learns what to do in each.

    The way of the data: camera pixels -> sighting -> Kalman estimate -> scaled pattern -> ART
    category -> row of Q -> action.

    Parameters
    ----------
    vigilance : float
        The ART network's vigilance, a distance between scaled patterns, in (0, 2].
    task : {"approach", "goal"}
        The problem: it decides which automata the agent runs, and what the next two arguments
        are by default.
    sensing : {"consistent", "thesis", "goal"} or Sensing, optional
        The Kalman filter's settings and the intervals of the measurements: by default
        "consistent" for the ball, "goal" for the goal.
    learning : TrainingSettings, optional
        All that the thesis leaves open: schedules, discount, numbers of patterns and cycles; by
        default ``TrainingSettings()`` for the ball, ``TrainingSettings.goal()`` for the goal.
    rng : int or numpy.random.Generator, optional
        The seed of everything the agent draws and of every episode it starts.

    Attributes
    ----------
    art : EuclideanART
        The segmentation: `cluster_centers_`, shape (S, m).
    q : QLearner or None
        The values: `Q`, shape (S, A). None until Q-learning has begun.
    history : list of tuple
        One row an episode: phase, cycles, reward, whether the goal was reached.
    cycles : int
        Steps taken in the environment so far.

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
    >>> from arkaq_edu.arkaq import TrainingSettings
    >>> env = gymnasium.make("arkaq_edu:BallApproach-v0", far=1000.0)
    >>> short = TrainingSettings(patterns=300, exploration=2000, exploitation=0)
    >>> agent = Arkaq(vigilance=0.2, learning=short, rng=0).learn(env, progress=False)
    >>> observation, info = env.reset(seed=1)
    >>> agent.reset()
    >>> agent.act(observation) in (0, 1, 2)
    True

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
        rng: int | np.random.Generator | None = None,
    ) -> None:
        self.vigilance = _checks.number("vigilance", vigilance, 0, 2, open_low=True)
        if task not in _TASKS:
            raise ValueError(f"task must be 'approach' or 'goal', got {task!r}")
        self.task = task
        usual = _TASKS[task]
        presets = {
            "consistent": Sensing.consistent,
            "thesis": Sensing.thesis,
            "goal": Sensing.goal,
        }
        settings = usual.sensing if sensing is None else sensing
        if isinstance(settings, str):
            if settings not in presets:
                raise ValueError(
                    f"sensing must be {', '.join(map(repr, presets))} or a Sensing, got {sensing!r}"
                )
            settings = presets[settings]()
        self.sensing: Sensing = settings
        self.learning = learning or usual.learning()
        # A generator is asked once: episodes then have seeds of their own, so that a run that is
        # taken up again draws what it would have drawn.
        if rng is None or isinstance(rng, np.random.Generator):
            rng = int(np.random.default_rng(rng).integers(2**63))
        self.seed = _checks.integer("rng", rng)
        self.art = EuclideanART(self.vigilance, self.learning.learning_rate)
        self.q: QLearner | None = None
        self.history: list[tuple[str, int, float, bool]] = []
        self.cycles = 0
        self._phase, self._done_in_phase = _SEGMENTING, 0
        self._senses = Estimator(self.sensing)
        self.reset()

    # Acting -----------------------------------------------------------------------------------

    def reset(self) -> None:
        """Begin a new episode: forget where the ball, or the goal, was."""
        self._senses.reset()
        self._last_action: int | None = None

    def act(self, observation: NDArray[np.floating]) -> int:
        """Return the greedy action for what is seen now, after what was seen and done before.

        Parameters
        ----------
        observation : ndarray, shape (m + 1,)
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
        observation = _checks.array("observation", observation, (len(self.sensing.low) + 1,))
        state = self.art.category(self._senses.observe(observation, self._last_action))
        self._last_action = int(self.q.Q[state].argmax())
        return self._last_action

    # Learning ---------------------------------------------------------------------------------

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
            The task; its observation's last entry tells whether there was a sighting. Its
            episodes must end some time, as a time limit sees to.
        checkpoint : path, optional
            A file to keep the run in, written at once, between episodes every few seconds, and at
            the end.
            If it exists, the run in it is taken up where it stopped, and comes to the same result
            as if it had never been interrupted. Without a file, begin again with a new agent.
        progress : bool
            Whether to show progress bars.

        Returns
        -------
        Arkaq
            The agent itself.

        Raises
        ------
        ValueError
            If `checkpoint` holds another run: other settings or another seed; if the environment
            is of another task.
        RuntimeError
            If what is to be seen, the ball or the goal, never is.
        """
        self.segment(env, checkpoint, progress)
        keeper = _Keeper(self, checkpoint)
        if self._phase == _LEARNING:
            if self.q is None:
                n_actions = int(env.action_space.n)  # type: ignore[attr-defined]
                self.q = self._new_q(n_actions)
            _TASKS[self.task].q_learning(self, env, keeper, progress).run()
            self._phase = _FINISHED
        self.reset()
        keeper.keep()
        return self

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
            The agent itself. An agent that has segmented its world already is left as it is.
        """
        if checkpoint is not None and Path(checkpoint).exists():
            self._resume(Path(checkpoint))
        keeper = _Keeper(self, checkpoint)
        keeper.keep()
        if self._phase == _SEGMENTING:
            _TASKS[self.task].segmentation(self, env, keeper, progress).run()
            self._phase, self._done_in_phase = _LEARNING, 0
            keeper.keep()
        return self

    def _new_q(self, n_actions: int) -> QLearner:
        law = self.learning
        return QLearner(self.art.n_clusters_, n_actions, law.alpha, law.gamma, rng=self.seed)

    # Keeping ----------------------------------------------------------------------------------

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the agent to an npz file: arrays and JSON, no pickles; whole or not at all.

        Parameters
        ----------
        path : path
            The file; it is replaced.
        """
        settings = {
            "format": FORMAT,
            "vigilance": self.vigilance,
            "seed": self.seed,
            "sensing": self.sensing.to_json(),
            "learning": self.learning.to_json(),
            "phase": self._phase,
            "done_in_phase": self._done_in_phase,
            "cycles": self.cycles,
        }
        if self.task != "approach":  # files older than the second task do not name the first
            settings["task"] = self.task
        # NumPy's numbers are as good as Python's as settings, but not to JSON.
        text = json.dumps(settings, default=lambda number: number.item())
        arrays: dict[str, Any] = {"settings": np.array(text)}
        if self.art.__sklearn_is_fitted__():
            arrays |= {"centers": self.art.cluster_centers_, "counts": self.art.counts_}
        if self.q is not None:
            arrays |= {"Q": self.q.Q, "visits": self.q.visits}
        arrays["history"] = np.array(
            [(phase == _LEARNING, *rest) for phase, *rest in self.history], dtype=np.float64
        ).reshape(-1, 4)
        path = Path(path)
        fresh = path.with_name(path.name + ".part")
        with open(fresh, "wb") as file:
            np.savez_compressed(file, **arrays)
        os.replace(fresh, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Arkaq:
        """Read an agent that `save` wrote; nothing in the file is run.

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
            If the file is not one of ours, is damaged, or has a format this version cannot read.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
            settings = json.loads(str(arrays["settings"]))
            if settings["format"] != FORMAT:
                raise ValueError(f"format must be {FORMAT}, got {settings['format']!r}")
            agent = cls(
                settings["vigilance"],
                task=settings.get("task", "approach"),
                sensing=Sensing.from_json(settings["sensing"]),
                learning=TrainingSettings(**settings["learning"]),
                rng=settings["seed"],
            )
            agent._take_up(settings, arrays)
        except FileNotFoundError:
            raise
        except Exception as error:  # a damaged archive fails in more ways than can be listed
            raise ValueError(f"{path} is not an agent that can be read: {error}") from error
        return agent

    def _take_up(self, settings: dict[str, Any], arrays: dict[str, NDArray]) -> None:
        if settings["phase"] not in (_SEGMENTING, _LEARNING, _FINISHED):
            raise ValueError(f"phase must be one of ours, got {settings['phase']!r}")
        self._phase = settings["phase"]
        self._done_in_phase = _checks.integer("done_in_phase", settings["done_in_phase"])
        self.cycles = _checks.integer("cycles", settings["cycles"])
        if "centers" in arrays:
            _checks.array("centers", arrays["centers"], (None, len(self.sensing.low)))
            self.art = EuclideanART.from_centers(
                arrays["centers"], arrays["counts"], self.vigilance, self.learning.learning_rate
            )
        if "Q" in arrays:
            n_states, n_actions = arrays["Q"].shape
            if n_states != self.art.n_clusters_:
                raise ValueError(f"Q must have {self.art.n_clusters_} rows, got {n_states}")
            self.q = self._new_q(n_actions)
            self.q.restore(arrays | {"rng": self.q.rng.bit_generator.state})
        self.history = [
            (_LEARNING if late else _SEGMENTING, int(n), float(reward), bool(success))
            for late, n, reward, success in arrays["history"].tolist()
        ]

    def _resume(self, path: Path) -> None:
        kept = Arkaq.load(path)
        for name in ("task", "vigilance", "seed", "learning", "sensing"):
            if getattr(kept, name) != getattr(self, name):
                raise ValueError(
                    f"checkpoint {path} holds a run with another {name}: "
                    f"{getattr(kept, name)!r}, not {getattr(self, name)!r}"
                )
        for name in ("art", "q", "history", "cycles", "_phase", "_done_in_phase"):
            setattr(self, name, getattr(kept, name))


class _Keeper:
    """Writes the run to its file between episodes, so that an interruption costs seconds."""

    def __init__(self, agent: Arkaq, path: str | os.PathLike[str] | None) -> None:
        self.agent, self.path = agent, path
        self._written = time.monotonic()

    def keep_now_and_then(self) -> None:
        if self.path is not None and time.monotonic() - self._written > _SECONDS_BETWEEN_FILES:
            self.keep()

    def keep(self) -> None:
        if self.path is not None:
            self.agent.save(self.path)
            self._written = time.monotonic()


class _Phase:
    """What all phases share: episodes that begin at the supervisor, and the looks at the world.

    A phase runs its automaton: the work of each of its states is the method of that name.

    Every episode has a random stream of its own, made of the agent's seed, the phase and the
    episode's number. So nothing but the learned arrays must be kept to take up a run.
    """

    automaton: Automaton
    name: str
    number: int
    unit: str

    def __init__(self, agent: Arkaq, env: gymnasium.Env, keeper: _Keeper, progress: bool) -> None:
        wanted, given = (len(agent.sensing.low) + 1,), env.observation_space.shape
        if given != wanted:
            raise ValueError(
                f"env must give observations of shape {wanted}, the measurements and whether there "
                f"was a sighting, got {given}"
            )
        self.agent, self.env, self.keeper = agent, env, keeper
        self.law, self.senses = agent.learning, agent._senses
        self.bar = tqdm(
            total=self.total,
            initial=min(agent._done_in_phase, self.total),
            desc=self.name,
            unit=self.unit,
            disable=not progress,
        )
        self.episode = sum(row[0] == self.name for row in agent.history)
        self.begun, self.in_episode, self.reward, self.success = False, 0, 0.0, False

    @property
    def total(self) -> int:
        raise NotImplementedError

    def run(self) -> None:
        self.automaton.run({state: getattr(self, state) for state in self.automaton.states})

    def supervisor(self) -> str:
        """Close the episode that ended, keep the run, and reset the world."""
        agent = self.agent
        if self.begun:
            agent.history.append((self.name, self.in_episode, self.reward, self.success))
            agent.cycles += self.in_episode
            self.episode += 1
            self.bar.update(min(agent._done_in_phase, self.total) - self.bar.n)
            self.begun, self.in_episode = False, 0
            self.keeper.keep_now_and_then()
        if agent._done_in_phase >= self.total:
            self.bar.close()
            return "enough"
        self.rng = np.random.default_rng([agent.seed, self.number, self.episode])
        self.observation, _ = self.env.reset(seed=int(self.rng.integers(2**31)))
        self.senses.reset()
        self.pattern = self.senses.observe(self.observation, None)
        self.begun, self.reward, self.success = True, 0.0, False
        return "reset"

    def step(self, action: int) -> float:
        """Take one cycle and look; return its reward."""
        self.observation, reward, self.terminated, self.truncated, info = self.env.step(action)
        self.pattern = self.senses.observe(self.observation, action)
        self.in_episode += 1
        self.reward += float(reward)
        self.success = bool(info.get("is_success", False))
        return float(reward)


class _Segmentation(_Phase):
    """Figure 5.6: random actions; every sighting is a pattern for the network."""

    automaton = SEGMENTATION
    name, number, unit = _SEGMENTING, 0, " patterns"
    blind = 0

    @property
    def total(self) -> int:
        return self.law.patterns

    def observe(self) -> str:
        sought = {"approach": "ball", "goal": "goal"}[self.agent.task]
        return f"{sought} seen" if self.observation[-1] else f"no {sought}"

    def unknown(self) -> str:
        """Give a blind robot up, for it would ask for resets for ever."""
        self.blind += 1
        if self.blind == _MOST_BLIND_LOOKS:
            sought = {"approach": "ball", "goal": "goal"}[self.agent.task]
            raise RuntimeError(f"the {sought} was not seen in {self.blind} looks in a row")
        return "ask for reset"

    def network(self) -> str:
        self.blind = 0
        art = self.agent.art
        known = art.n_clusters_ if art.__sklearn_is_fitted__() else 0
        art.learn_one(self.pattern)
        self.agent._done_in_phase += 1
        return "category created" if art.n_clusters_ > known else "category updated"

    def act(self) -> str:
        self.step(int(self.rng.integers(self.env.action_space.n)))  # type: ignore[attr-defined]
        over = self.terminated or self.truncated or self.in_episode >= self.law.period
        enough = self.agent._done_in_phase >= self.total
        return "period over" if over or enough else "moved"


class _QLearning(_Phase):
    """Figure 5.15: explore what was never tried, later exploit what is known."""

    automaton = Q_LEARNING
    name, number, unit = _LEARNING, 1, " cycles"

    @property
    def total(self) -> int:
        return self.law.exploration + self.law.exploitation

    def run(self) -> None:
        assert self.agent.q is not None
        self.q, self.category = self.agent.q, self.agent.art.category
        self.experiences: list[tuple[int, int, float, int, bool, int]] = []
        super().run()

    def supervisor(self) -> str:
        event = super().supervisor()
        if event == "reset":
            self.q.rng, self.experiences = self.rng, []
            self.state = self.category(self.pattern)
        return event

    def identify(self) -> str:
        self.held, self.discounted = 0, 0.0
        if self.agent._done_in_phase < self.law.exploration:
            return "exploration"
        return "exploitation"

    def explore(self) -> str:
        """Take an action never tried here; where there is none, any."""
        untried = self.q.unvisited(self.state)
        choices = untried if len(untried) else np.arange(self.q.Q.shape[1])
        self.action = int(self.rng.choice(choices))
        return "action chosen"

    def exploit(self) -> str:
        """Draw from the Boltzmann distribution at a temperature that falls."""
        late = self.agent._done_in_phase - self.law.exploration
        progress = min(1.0, late / max(1, self.law.exploitation))
        self.action = self.q.boltzmann(self.state, self.law.temperature(progress))
        return "action chosen"

    def act(self) -> str:
        reward = self.step(self.action) + self.law.cycle_reward
        self.discounted += self.law.gamma**self.held * reward
        self.held += 1
        self.agent._done_in_phase += 1
        self.next_state = self.category(self.pattern)
        if self.terminated or self.truncated:
            return "episode over"
        stays = self.next_state == self.state and self.held < self.law.hold
        return "state remains" if stays else "state left"

    def evaluate(self) -> str:
        """Note the experience; once the episode is over, back all of it up (eq 2.12).

        The last experience comes first (Lin 1992): so what the end was worth reaches the start in
        one episode, where backups on the way would carry it back by one state an episode. A ball
        lost for good ends an episode; a time limit only cuts it short.
        """
        over = self.terminated or self.truncated
        lost = self.truncated and not self.observation[-1]
        if lost:
            self.discounted += self.law.gamma ** (self.held - 1) * self.law.lost_reward
        ended = self.terminated or lost
        self.experiences.append(
            (self.state, self.action, self.discounted, self.next_state, ended, self.held)
        )
        self.state = self.next_state
        if not over:
            return "next"
        for experience in reversed(self.experiences):
            self.q.update(*experience)
        return "episode over"


class _GoalSegmentation(_Segmentation):
    """Figure 5.34: as figure 5.6, with turns for footsteps."""

    automaton = GOAL_SEGMENTATION

    def turn(self) -> str:
        event = self.act()
        return "turned" if event == "moved" else event


class _GoalQLearning(_QLearning):
    """Figure 5.38: as figure 5.15, but no action is held, and the supervisor judges the kick."""

    automaton = GOAL_Q_LEARNING

    def act(self) -> str:
        event = super().act()
        return event if event == "episode over" else "turned"

    def judge(self) -> str:
        return "goal" if self.success else "no goal"


class _Task(NamedTuple):
    """The phases of a problem, and how an agent senses and learns in it if not told."""

    segmentation: type[_Segmentation]
    q_learning: type[_QLearning]
    sensing: str
    learning: Callable[[], TrainingSettings]


_TASKS = {
    "approach": _Task(_Segmentation, _QLearning, "consistent", TrainingSettings),
    "goal": _Task(_GoalSegmentation, _GoalQLearning, "goal", TrainingSettings.goal),
}
