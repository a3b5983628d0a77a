"""The task, and agents trained on it."""

from __future__ import annotations

import os
from typing import Any

import gymnasium

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, Learner, Segmenter, Sensing, TrainingSettings

#: The vigilance of the trained agent, as in figures 5.11 and 5.16.
VIGILANCE = 0.1


def make_task(**options: Any) -> gymnasium.Env:
    """Return the task as the agent is trained on it: the ball is placed by eq 5.1.

    Examples
    --------
    >>> make_task().unwrapped.supervisor.placement
    'thesis'
    """
    return gymnasium.make("arkaq_edu:BallApproach-v0", **{"placement": "thesis", **options})


def train(
    seed: int = 0,
    vigilance: float | None = None,
    *,
    sensing: Sensing | str | None = None,
    learning: TrainingSettings | None = None,
    segmenter: Segmenter | None = None,
    learner: Learner | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: bool = True,
    **options: Any,
) -> Arkaq:
    """Train an agent to walk to the ball.

    Parameters
    ----------
    seed : int
        The agent's seed.
    vigilance : float, optional
        See `Arkaq`; by default .1.
    sensing, segmenter, learner : optional
        See `Arkaq`.
    learning : TrainingSettings, optional
        How the agent is trained.
    checkpoint : path, optional
        A file that keeps the run; an interrupted run continues from it. See `Arkaq.learn`.
    progress : bool
        Whether to show progress bars.
    **options
        Options of the task, for example ``far``.

    Returns
    -------
    Arkaq

    References
    ----------
    Thesis 5.2.1 and 5.2.2, figures 5.6 and 5.15.

    Examples
    --------
    >>> brief = TrainingSettings(patterns=200, exploration=500, exploitation=0)
    >>> train(seed=1, learning=brief, progress=False).cycles >= 500
    True
    """
    agent = Arkaq(
        usual_vigilance() if vigilance is None else vigilance,
        sensing=sensing,  # type: ignore[arg-type]
        learning=learning,
        segmenter=segmenter,
        learner=learner,
        rng=_checks.integer("seed", seed),
    )
    return agent.learn(make_task(**options), checkpoint=checkpoint, progress=progress)


def usual_vigilance() -> float:
    """Return the vigilance of figures 5.11 and 5.16, .1."""
    return VIGILANCE


def usual_learning() -> TrainingSettings:
    """Return how an agent is trained: ``TrainingSettings()``."""
    return TrainingSettings()


def load_agent() -> Arkaq:
    """Return the trained agent that comes with the course: ``train(seed=0)``.

    Examples
    --------
    >>> load_agent().vigilance
    0.1
    """
    return Arkaq.load(data_file("ball_approach.npz"))
