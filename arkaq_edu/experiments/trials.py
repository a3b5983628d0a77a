"""One cell of a study: settings by name and a seed in, an agent's measurements out."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from functools import partial
from inspect import signature
from typing import Any

import numpy as np

from arkaq_edu import _checks
from arkaq_edu.arkaq import (
    Arkaq,
    ExpectedSarsa,
    QLearning,
    Sarsa,
    Sensing,
    TrainingSettings,
    UniformGrid,
)
from arkaq_edu.art import ART2, ART2A, EuclideanART
from arkaq_edu.experiments import approach, goal
from arkaq_edu.experiments.parts import (
    AsPrinted,
    AtRandom,
    AveragedQ,
    ComplementCoding,
    EpsilonGreedy,
    TileCoding,
    uncontrolled,
    unfiltered,
)
from arkaq_edu.experiments.runs import FRESH_SEEDS
from arkaq_edu.field import Camera, Head, Kick, Legs
from arkaq_edu.mdp import speed_of_convergence

#: The segmenters, the learners and the senses that a study knows by name.
SEGMENTERS: dict[str, Any] = {
    cls.__name__: cls for cls in (EuclideanART, ART2A, ART2, ComplementCoding, UniformGrid)
}
LEARNERS: dict[str, Any] = {
    cls.__name__: cls
    for cls in (
        QLearning, Sarsa, ExpectedSarsa, AsPrinted, AtRandom, AveragedQ, EpsilonGreedy, TileCoding,
    )
}  # fmt: skip
SENSES: dict[str, Any] = {
    "consistent": Sensing.consistent,
    "goal": Sensing.goal,
    "thesis": Sensing.thesis,
    "uncontrolled": uncontrolled,
    "unfiltered": unfiltered,
}
PROBLEMS: dict[str, Any] = {"approach": approach, "goal": goal}

_BODY = {"camera": Camera, "head": Head, "kick": Kick, "legs": Legs}
_LEARNING = {field.name for field in fields(TrainingSettings)}
_SENSING = {field.name for field in fields(Sensing)}

#: Learning has converged when an agent earns such a share of what the planner does ...
CONVERGED = 0.75
#: ... over so many episodes.
WINDOW = 200


def part(role: str, given: Any, known: Mapping[str, Any] | None = None, **usual: Any) -> Any:
    """Return a part of an agent or a task that is given by name.

    Parameters
    ----------
    role : str
        What the part is, for the message.
    given : str, mapping or object
        A name among the `known`, or "module:name" for a part of one's own. A mapping has such a
        ``name``, and the parameters, which may be parts themselves. Anything else is the part.
    known : mapping of str to class
    **usual
        Parameters for a class that knows them, where none are given.

    Raises
    ------
    ValueError
        If there is no such part, or it refuses its parameters.

    Examples
    --------
    >>> part("segmenter", {"name": "UniformGrid", "cells": [4, 2]}, SEGMENTERS).n_clusters_
    8
    >>> part("learner", "collections:Counter")
    Counter()
    """
    known = known or {}
    parameters = {
        key: part(key, value, known, **usual) if isinstance(value, Mapping) else value
        for key, value in (given.items() if isinstance(given, Mapping) else ())
    }
    name = parameters.pop("name", None) if isinstance(given, Mapping) else given
    if not isinstance(name, str):
        if isinstance(given, Mapping):
            raise ValueError(f"{role} must have a name, got {_checks.shown(given)}")
        return given
    made = known[name] if name in known else imported(role, name, known)
    if not callable(made):
        return made
    takes = made._get_param_names() if hasattr(made, "_get_param_names") else ()
    parameters = {k: v for k, v in usual.items() if k in takes} | parameters
    try:
        return made(**parameters)
    except TypeError as error:
        raise ValueError(f"{role} {name} cannot be made: {error}") from error


def imported(role: str, name: str, known: Mapping[str, Any] | None = None) -> Any:
    """Return the object that "module:name" names.

    Examples
    --------
    >>> imported("task", "math:pi")
    3.141592653589793
    >>> imported("task", "golf", PROBLEMS)
    Traceback (most recent call last):
    ValueError: task must be approach, goal or "module:name", got 'golf'
    """
    module, _, attribute = name.partition(":")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, ValueError, AttributeError) as error:
        names = f"{', '.join(known)} or " if known else ""
        why = f" ({error})" if attribute else ""
        raise ValueError(
            f'{role} must be {names}"module:name", got {_checks.shown(name)}{why}'
        ) from error


@dataclass(frozen=True)
class Arranged:
    """What a cell runs: the arguments of `train`, and the options of the task."""

    agent: dict[str, Any]
    task: dict[str, Any]


def arrange(problem: str, setting: Mapping[str, Any]) -> Arranged:
    """Sort the settings of a cell: which belong to the agent, which to the task.

    Parameters
    ----------
    problem : {"approach", "goal"}
    setting : mapping
        See `arkaq_edu.experiments.study`.

    Raises
    ------
    ValueError
        If a setting is unknown or out of range.

    Examples
    --------
    >>> found = arrange("goal", {"gamma": 0.9, "goal_distance": "far"})
    >>> found.agent["learning"].gamma, found.agent["learning"].exploration, found.task
    (0.9, 1000, {'goal_distance': 'far'})
    """
    room, rest = PROBLEMS[problem], dict(setting)
    learning = {name: rest.pop(name) for name in [*rest] if name in _LEARNING}
    senses = {name: rest.pop(name) for name in [*rest] if name in _SENSING}
    parts = {name: rest.pop(name, None) for name in ("vigilance", "segmenter", "learner")}
    sensing = part("sensing", rest.pop("sensing", None), SENSES)
    task = {name: _bodily(name, value) for name, value in rest.items()}
    _refuse_unknown(problem, task)
    where = {k: v for k, v in task.items() if k == "goal_distance"}
    vigilance = parts["vigilance"]
    vigilance = room.usual_vigilance(**where) if vigilance is None else vigilance
    settings = replace(room.usual_learning(**where), **learning)
    usual = {"vigilance": vigilance, "learning_rate": settings.learning_rate}
    agent = Arkaq(
        vigilance,
        task=problem,  # type: ignore[arg-type]
        sensing=sensing,
        learning=settings,
        segmenter=part("segmenter", parts["segmenter"], SEGMENTERS, **usual),
        learner=part("learner", parts["learner"], LEARNERS),
        rng=0,
    )
    room.make_task(**task).close()  # it refuses what is out of range
    return Arranged(
        {
            "vigilance": vigilance,
            "sensing": replace(agent.sensing, **senses),
            "learning": settings,
            "segmenter": None if parts["segmenter"] is None else agent.segmenter,
            "learner": agent.learner,
        },
        task,
    )


def _refuse_unknown(problem: str, task: Mapping[str, Any]) -> None:
    """Refuse settings that the task does not have."""
    env = PROBLEMS[problem].make_task().unwrapped
    own = [*signature(type(env)).parameters, "max_episode_steps"]  # the latter is Gymnasium's
    known = [*own, *_LEARNING, *_SENSING, "vigilance", "sensing", "segmenter", "learner"]
    for name in task:
        if name not in own:
            like = "".join(f"; did you mean {near}?" for near in get_close_matches(name, known, 1))
            raise ValueError(f"settings of {problem} must be known, got {name!r}{like}")


def _bodily(name: str, value: Any) -> Any:
    """Return an option of a task; parts of the body may be given by their parameters."""
    if name in _BODY and isinstance(value, Mapping):
        return part(name, {"name": name, **value}, _BODY)
    return value


def measure(problem: str, seed: int, *, episodes: int = 500, **setting: Any) -> dict[str, float]:
    """Train one agent, and judge it.

    Parameters
    ----------
    problem : {"approach", "goal"}
    seed : int
        The seed of the agent. The fresh starts that judge it have another, which is the same
        for all settings.
    episodes : int
        The number of fresh starts.
    **setting
        See `arkaq_edu.experiments.study`.

    Returns
    -------
    dict of str to float
        See `arkaq_edu.experiments.study`.

    Examples
    --------
    >>> brief = {"patterns": 200, "exploration": 300, "exploitation": 0}
    >>> [*measure("goal", 0, episodes=5, **brief)]
    ['states', 'learning_time', 'success', 'turns', 'reward', 'regret']
    """
    room, arranged = PROBLEMS[problem], arrange(problem, setting)
    agent = room.train(seed, **arranged.agent, **arranged.task, progress=False)
    shown, best = (
        room.evaluate(policy, episodes, FRESH_SEEDS + seed, **arranged.task)
        for policy in (room.greedy(agent), room.planner())
    )
    return {
        "states": float(agent.art.n_clusters_),
        "learning_time": learning_time(agent, CONVERGED * float(best.is_success.mean())),
        **room.score(shown),
        "regret": float(best.reward.mean() - shown.reward.mean()),
    }


def learning_time(agent: Arkaq, target: float, window: int = WINDOW) -> float:
    """Return the cycles of Q-learning until the share of successes stays at a target.

    It is `arkaq_edu.mdp.speed_of_convergence`, in cycles: all cycles of the training if the share
    was below the target in the end.

    Parameters
    ----------
    agent : Arkaq
        An agent that has learned.
    target : float
        The share of episodes, in [0, 1].
    window : int
        Over how many episodes the share is taken.

    Examples
    --------
    >>> agent = approach.load_agent()
    >>> 0 < learning_time(agent, 0.5) < learning_time(agent, 0.9) < agent.cycles
    True
    """
    episodes = [row for row in agent.history if row[0] == "Q-learning"]
    cycles = np.cumsum([row[1] for row in episodes])
    scored = [row[3] for row in episodes]
    window = min(_checks.integer("window", window, 1), len(scored))
    n = int(speed_of_convergence(np.array(scored, dtype=float), target, window=window))
    return float(cycles[min(n, len(cycles)) - 1])


#: What a study calls for each cell of the two problems.
MEASURES: dict[str, Callable[..., dict[str, float]]] = {
    name: partial(measure, name) for name in PROBLEMS
}
