"""The task, and agents trained on it."""

from __future__ import annotations

import os
from typing import Any, Literal

import gymnasium
from gymnasium import spaces

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, Learner, Segmenter, Sensing, TrainingSettings
from arkaq_edu.envs.score_goal import KICK, STARTS, Start
from arkaq_edu.field.goal import MAX_GOAL_DISTANCE, MIN_GOAL_DISTANCE

Distance = Literal["near", "far"]

#: The vigilance of the trained agents: .06 in figures 5.39 and 5.40, .05 in figure 5.41.
VIGILANCE = {"near": 0.06, "far": 0.05}


def start_of(goal_distance: str) -> Start:
    """Return where the robot starts.

    Examples
    --------
    >>> start_of("close")
    Traceback (most recent call last):
    ValueError: goal_distance must be 'near' or 'far', got 'close'
    """
    if goal_distance not in STARTS:
        raise ValueError(f"goal_distance must be 'near' or 'far', got {goal_distance!r}")
    return STARTS[goal_distance]


def usual_vigilance(goal_distance: Distance | float = "near") -> float:
    """Return the vigilance of the thesis.

    Examples
    --------
    >>> usual_vigilance("far"), usual_vigilance(2000.0)
    (0.05, 0.06)
    """
    return VIGILANCE["far" if _is_far(goal_distance) else "near"]


def _is_far(goal_distance: Distance | float) -> bool:
    """Tell the far place from the near one and from a number (mm), and refuse all else."""
    if not isinstance(goal_distance, str):
        _checks.number("goal_distance", goal_distance, MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE)
        return False
    return start_of(goal_distance) is STARTS["far"]


def usual_learning(goal_distance: Distance | float = "near") -> TrainingSettings:
    """Return how an agent is trained: as `TrainingSettings.goal` says, from far twice as long.

    From far, two kicks in three miss even at best: telling the best action takes twice as long.

    Examples
    --------
    >>> usual_learning("far").exploration
    1000
    """
    if _is_far(goal_distance):
        return TrainingSettings.goal(exploration=1000, exploitation=11_000)
    return TrainingSettings.goal()


class LookAround(gymnasium.Wrapper):
    """The task without the kick: every episode starts with the goal straight ahead.

    References
    ----------
    Thesis 5.3 ("from a specified location") and 5.3.1.

    Examples
    --------
    >>> task = LookAround(make_task())
    >>> observation, info = task.reset(seed=3)
    >>> info["orientation"], task.action_space
    (0.0, Discrete(2))
    """

    def __init__(self, env: gymnasium.Env) -> None:
        super().__init__(env)
        self.action_space = spaces.Discrete(KICK)  # both turns

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode with the goal straight ahead."""
        return self.env.reset(seed=seed, options={"orientation": 0.0})


def make_task(goal_distance: Distance | float = "near", **options: Any) -> gymnasium.Env:
    """Return the task as the agent is trained on it.

    Examples
    --------
    >>> make_task("far").unwrapped.start == STARTS["far"]
    True
    """
    return gymnasium.make("arkaq_edu:ScoreGoal-v0", goal_distance=goal_distance, **options)


def make_look_around(
    goal_distance: Distance | float = "near", period: int | None = None, **options: Any
) -> gymnasium.Env:
    """Return the task in which the agent segments its view of the goal; see `LookAround`.

    Examples
    --------
    >>> make_look_around().unwrapped.patience
    51
    """
    usual = TrainingSettings.goal().period
    period = usual if period is None else _checks.integer("period", period, 1)
    return LookAround(make_task(goal_distance, **options | {"patience": period + 1}))


def train(
    seed: int = 0,
    vigilance: float | None = None,
    *,
    goal_distance: Distance | float = "near",
    sensing: Sensing | None = None,
    learning: TrainingSettings | None = None,
    segmenter: Segmenter | None = None,
    learner: Learner | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: bool = True,
    **options: Any,
) -> Arkaq:
    """Train an agent to score: it looks around, then it learns kick by kick.

    Parameters
    ----------
    seed : int
        The agent's seed.
    vigilance : float, optional
        See `Arkaq`; by default the thesis's, .06 near and .05 far.
    goal_distance : {"near", "far"} or float
        Where the robot stands; see `arkaq_edu.envs.ScoreGoalEnv`.
    sensing, segmenter, learner : optional
        See `Arkaq`.
    learning : TrainingSettings, optional
        How the agent is trained; by default `usual_learning`.
    checkpoint : path, optional
        A file that keeps the run; an interrupted run continues from it. See `Arkaq.learn`.
    progress : bool
        Whether to show progress bars.
    **options
        Other options of the task, for example ``patience``.

    Returns
    -------
    Arkaq

    Notes
    -----
    Some luck is left at the end. After 700 kicks in a state the last kick still has a weight of
    700 ** -.6 = .02. The reward of a kick has a standard deviation of 96, so the value of a kick
    varies with one of sqrt(.02 / 2) * 96 = 10. From far, the values of a turn and of the best kick
    are hardly farther apart. A few runs in thirty end with a policy that turns back and forth
    before it kicks, or never kicks; `rates` counts them. Weights that fall faster would vary less,
    but never correct the first, optimistic values.

    References
    ----------
    Thesis 5.3.1 and 5.3.2, figures 5.34 and 5.38.

    Examples
    --------
    >>> brief = TrainingSettings.goal(patterns=100, exploration=50, exploitation=0)
    >>> train(seed=1, learning=brief, progress=False).q.Q.shape[1]
    3
    """
    vigilance = usual_vigilance(goal_distance) if vigilance is None else vigilance
    learning = usual_learning(goal_distance) if learning is None else learning
    agent = Arkaq(
        vigilance,
        task="goal",
        sensing=sensing,
        learning=learning,
        segmenter=segmenter,
        learner=learner,
        rng=_checks.integer("seed", seed),
    )
    look_around = make_look_around(goal_distance, agent.learning.period, **options)
    agent.segment(look_around, checkpoint=checkpoint, progress=progress)
    return agent.learn(
        make_task(goal_distance, **options), checkpoint=checkpoint, progress=progress
    )


def load_agent(goal_distance: Distance = "near") -> Arkaq:
    """Return a trained agent that comes with the course: ``train(seed=0, goal_distance=...)``.

    Examples
    --------
    >>> load_agent("far").vigilance
    0.05
    """
    start_of(goal_distance)
    return Arkaq.load(data_file(f"goal_{goal_distance}.npz"))
