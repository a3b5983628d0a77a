"""Agents as files: arrays and JSON, no pickles. Opening a file never runs anything in it."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq.learners import ExpectedSarsa, QLearning, Sarsa, TableLearner
from arkaq_edu.arkaq.segmenters import UniformGrid
from arkaq_edu.arkaq.sensing import Sensing
from arkaq_edu.arkaq.settings import TrainingSettings
from arkaq_edu.arkaq.training import LEARNING, PHASES, SEGMENTING
from arkaq_edu.art import EuclideanART

if TYPE_CHECKING:
    from arkaq_edu.arkaq.agent import Arkaq

FORMAT = 1
SECONDS_BETWEEN_CHECKPOINTS = 5.0
# The parts that a file can hold. Others are refused by name: a file can hold their arrays, but
# not what their class does.
SEGMENTERS: dict[str, Any] = {cls.__name__: cls for cls in (EuclideanART, UniformGrid)}
LEARNERS: dict[str, Any] = {cls.__name__: cls for cls in (QLearning, Sarsa, ExpectedSarsa)}


def describe(role: str, part: Any, known: dict[str, Any]) -> dict[str, Any]:
    """Return the class and the parameters of a part as plain data.

    Raises
    ------
    ValueError
        If the part's class is not among the `known` ones.

    Examples
    --------
    >>> describe("segmenter", UniformGrid((4, 2)), SEGMENTERS)
    {'class': 'UniformGrid', 'cells': [4, 2]}
    >>> describe("learner", "rote", LEARNERS)
    Traceback (most recent call last):
    ValueError: learner must be one of QLearning, Sarsa, ExpectedSarsa to be saved, got str
    """
    name = type(part).__name__
    if known.get(name) is not type(part):
        raise ValueError(f"{role} must be one of {', '.join(known)} to be saved, got {name}")
    return json.loads(_json({"class": name} | part.get_params()))  # tuples become lists


def rebuild(role: str, settings: dict[str, Any] | None, known: dict[str, Any]) -> Any:
    """Return a part that has learned nothing yet, as `describe` described it; None for None."""
    if settings is None:
        return None
    name, parameters = settings["class"], {k: v for k, v in settings.items() if k != "class"}
    if name not in known:
        raise ValueError(f"{role} must be one of {', '.join(known)}, got {name!r}")
    return known[name](**parameters)


def save(agent: Arkaq, path: str | os.PathLike[str]) -> None:
    """Write an agent to a file; see `Arkaq.save`."""
    segmenter = describe("segmenter", agent.art, SEGMENTERS)
    learner = describe("learner", agent.learner if agent.q is None else agent.q, LEARNERS)
    settings = {
        "format": FORMAT,
        "vigilance": agent.vigilance,
        "seed": agent.seed,
        "sensing": agent.sensing.to_json(),
        "learning": agent.learning.to_json(),
        "phase": agent.phase,
        "done_in_phase": agent.done_in_phase,
        "cycles": agent.cycles,
    }
    # What is as the first version of the format had it is left out, so that files stay the same.
    if agent.task != "approach":
        settings["task"] = agent.task
    if segmenter != describe("segmenter", agent.default_segmenter(), SEGMENTERS):
        settings["segmenter"] = segmenter
    if learner["class"] != "QLearning":
        settings["learner"] = learner
    arrays: dict[str, Any] = {"settings": np.array(_json(settings))}
    if isinstance(agent.art, UniformGrid):
        arrays["counts"] = agent.art.counts_
    elif hasattr(agent.art, "n_clusters_"):  # ART has no categories before its first pattern
        arrays |= {"centers": agent.art.cluster_centers_, "counts": agent.art.counts_}
    if isinstance(agent.q, TableLearner):
        arrays |= {"Q": agent.q.Q, "visits": agent.q.visits}
    arrays["history"] = np.array(
        [(phase == LEARNING, *rest) for phase, *rest in agent.history], dtype=np.float64
    ).reshape(-1, 4)
    path = Path(path)
    unfinished = path.with_name(path.name + ".part")
    with open(unfinished, "wb") as file:
        np.savez_compressed(file, **arrays)
    os.replace(unfinished, path)


def load(cls: type[Arkaq], path: str | os.PathLike[str]) -> Arkaq:
    """Read an agent from a file; see `Arkaq.load`."""
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
            segmenter=rebuild("segmenter", settings.get("segmenter"), SEGMENTERS),
            learner=rebuild("learner", settings.get("learner"), LEARNERS),
            rng=settings["seed"],
        )
        _restore(agent, settings, arrays)
    except FileNotFoundError:
        raise
    except Exception as error:  # a damaged archive fails in more ways than can be listed
        raise ValueError(f"{path} is not an agent that can be read: {error}") from error
    return agent


def _restore(agent: Arkaq, settings: dict[str, Any], arrays: dict[str, NDArray]) -> None:
    if settings["phase"] not in PHASES:
        raise ValueError(f"phase must be one of {', '.join(PHASES)}, got {settings['phase']!r}")
    agent.phase = settings["phase"]
    agent.done_in_phase = _checks.integer("done_in_phase", settings["done_in_phase"])
    agent.cycles = _checks.integer("cycles", settings["cycles"])
    art = agent.art
    if isinstance(art, UniformGrid):
        counts = _checks.array("counts", arrays["counts"], (art.n_clusters_,))
        art.counts_ = counts.astype(np.int64)
    elif "centers" in arrays:
        _checks.array("centers", arrays["centers"], (None, len(agent.sensing.low)))
        parameters = art.get_params()  # type: ignore[attr-defined]
        agent.art = EuclideanART.from_centers(arrays["centers"], arrays["counts"], **parameters)
    if "Q" in arrays:
        n_states, n_actions = arrays["Q"].shape
        if n_states != agent.art.n_clusters_:
            raise ValueError(f"Q must have {agent.art.n_clusters_} rows, got {n_states}")
        table = agent.new_learner(n_actions).table  # type: ignore[attr-defined]
        table.restore(arrays | {"rng": table.rng.bit_generator.state})
    agent.history = [
        (LEARNING if late else SEGMENTING, int(n), float(reward), bool(success))
        for late, n, reward, success in arrays["history"].tolist()
    ]


class Checkpoint:
    """The file of a run, written between episodes, so that an interruption costs seconds.

    Parameters
    ----------
    agent : Arkaq
        The agent that learns.
    path : path or None
        The file; None for a run without one.
    """

    def __init__(self, agent: Arkaq, path: str | os.PathLike[str] | None) -> None:
        self.agent, self.path = agent, path
        self._written = time.monotonic()

    def resume(self) -> None:
        """Take over the run in the file, if there is one.

        Raises
        ------
        ValueError
            If the file holds a run with other settings or another seed.
        """
        if self.path is None or not Path(self.path).exists():
            return
        stored = load(type(self.agent), self.path)
        ours = _identity(self.agent)
        for name, value in _identity(stored).items():
            if value != ours[name]:
                raise ValueError(
                    f"checkpoint {self.path} holds a run with another {name}: "
                    f"{value!r}, not {ours[name]!r}"
                )
        for name in ("art", "q", "history", "cycles", "phase", "done_in_phase"):
            setattr(self.agent, name, getattr(stored, name))

    def write(self) -> None:
        """Write the agent to the file."""
        if self.path is not None:
            save(self.agent, self.path)
            self._written = time.monotonic()

    def write_if_due(self) -> None:
        """Write the agent to the file if the last time is some seconds ago."""
        if time.monotonic() - self._written > SECONDS_BETWEEN_CHECKPOINTS:
            self.write()


def _identity(agent: Arkaq) -> dict[str, Any]:
    """Return all that decides what a run comes to."""
    names = ("task", "vigilance", "seed", "learning", "sensing")
    return {name: getattr(agent, name) for name in names} | {
        "segmenter": describe("segmenter", agent.segmenter, SEGMENTERS),
        "learner": describe("learner", agent.learner, LEARNERS),
    }


def _json(settings: dict[str, Any]) -> str:
    # NumPy's numbers may be settings, but JSON does not know them.
    return json.dumps(settings, default=lambda number: number.item())
