"""Agents as files: arrays and JSON, no pickles. Opening a file never runs anything in it."""

from __future__ import annotations

import json
import math
import os
import time
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from inspect import signature
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu._files import replacing
from arkaq_edu.arkaq.learners import ExpectedSarsa, QLearning, Sarsa, TableLearner
from arkaq_edu.arkaq.segmenters import UniformGrid
from arkaq_edu.arkaq.sensing import Sensing
from arkaq_edu.arkaq.settings import TrainingSettings
from arkaq_edu.arkaq.training import FINISHED, LEARNING, PHASES, SEGMENTING, require_task
from arkaq_edu.art import EuclideanART

if TYPE_CHECKING:
    import gymnasium

    from arkaq_edu.arkaq.agent import Arkaq

FORMAT = 1
SECONDS_BETWEEN_CHECKPOINTS = 5.0
# An agent's arrays may take so much memory together: enough for some million states.
MOST_BYTES = 2**28
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
    if agent.environments:
        settings["environments"] = agent.environments
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
    with replacing(_path(path)) as fresh, open(fresh, "wb") as file:
        np.savez_compressed(file, **arrays)


def load(cls: type[Arkaq], path: str | os.PathLike[str]) -> Arkaq:
    """Read an agent from a file; see `Arkaq.load`."""
    path = _path(path)
    try:
        arrays = _read(path)
        settings = json.loads(str(arrays["settings"]))
        _checks.instance("settings", settings, dict)
        if settings["format"] != FORMAT:
            given = _checks.shown(settings["format"])
            raise ValueError(f"format must be {FORMAT}, got {given}")
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
    except KeyError as error:
        raise ValueError(f"{path} is not an agent that can be read: it has no {error}") from error
    except Exception as error:  # a damaged archive fails in more ways than can be listed
        said = shorten(str(error), 300)  # zipfile quotes what it finds, however long
        raise ValueError(f"{path} is not an agent that can be read: {said}") from error
    return agent


def _path(path: Any) -> Path:
    if not isinstance(path, (str, os.PathLike)):
        raise ValueError(f"path must be a path, got {_checks.shown(path)}")
    return Path(path)


def _read(path: Path) -> dict[str, NDArray]:
    """Return the arrays that an agent consists of, and leave all else in the archive alone."""
    arrays: dict[str, NDArray] = {}
    with zipfile.ZipFile(path) as archive:
        there = set(archive.namelist())
        for name in ("settings", "centers", "counts", "Q", "visits", "history"):
            if f"{name}.npy" in there:
                free = MOST_BYTES - sum(array.nbytes for array in arrays.values())
                arrays[name] = _read_array(archive, name, free)
    return arrays


def _read_array(archive: zipfile.ZipFile, name: str, most: int) -> NDArray:
    """Return one array, if it takes at most so many bytes; memory is taken only after that."""
    member = archive.getinfo(f"{name}.npy")
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{name} must be stored or deflated in the archive")
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        if version not in ((1, 0), (2, 0)):
            raise ValueError(f"{name} must be an npy array of version 1 or 2, got {version}")
        header = "read_array_header_1_0" if version == (1, 0) else "read_array_header_2_0"
        shape, _, dtype = getattr(np.lib.format, header)(file)
        if dtype.kind not in ("U" if name == "settings" else "iuf"):
            raise ValueError(f"{name} must not hold {_checks.shown(dtype)}")
        size = dtype.itemsize * math.prod(shape)
        if not 0 <= size <= most:
            raise ValueError(f"{name} must take at most {most:,} bytes of memory, got {size:,}")
        if file.tell() + size != member.file_size:
            raise ValueError(f"{name} must hold {size:,} bytes, as its header says")
    with archive.open(member) as file:
        array = np.lib.format.read_array(file, allow_pickle=False)
        file.read(1)  # the archive compares its checksum at the end of the data
    return array


def _restore(agent: Arkaq, settings: dict[str, Any], arrays: dict[str, NDArray]) -> None:
    agent.phase = _checks.choice("phase", settings["phase"], PHASES)
    agent.done_in_phase = _checks.integer("done_in_phase", settings["done_in_phase"])
    agent.cycles = _checks.integer("cycles", settings["cycles"])
    environments = _checks.instance("environments", settings.get("environments", {}), dict)
    for phase, known in environments.items():
        _checks.choice("environments", phase, PHASES[:2])
        agent.environments[phase] = _checks.instance("environments", known, dict)
    learned = agent.phase == FINISHED or (agent.phase == LEARNING and agent.done_in_phase)
    needed = ["counts"] if agent.phase != SEGMENTING or agent.done_in_phase else []
    for name in [*needed, *(["Q", "visits"] if learned else []), "history"]:
        if name not in arrays:
            raise ValueError(f"an agent in the phase {agent.phase} must have the array {name}")
    art = agent.art
    if isinstance(art, UniformGrid):
        _checks.array("counts", arrays["counts"], (art.n_clusters_,))
        art.counts_ = _checks.integers("counts", arrays["counts"])
    elif "counts" in arrays:
        _checks.array("centers", arrays["centers"], (None, len(agent.sensing.low)))
        counts = _checks.integers("counts", arrays["counts"], 1)
        parameters = art.get_params()  # type: ignore[attr-defined]
        agent.art = EuclideanART.from_centers(arrays["centers"], counts, **parameters)
    if "Q" in arrays:
        _, n_actions = _checks.array("Q", arrays["Q"], (agent.art.n_clusters_, None)).shape
        table = agent.new_learner(n_actions).table  # type: ignore[attr-defined]
        table.restore(arrays | {"rng": table.rng.bit_generator.state})
    history = _checks.array("history", arrays["history"], (None, 4))
    for name, column, most in (("phase", 0, 1), ("cycles", 1, 2**53), ("success", 3, 1)):
        values = history[:, column]
        if ((values < 0) | (values > most) | (values % 1 != 0)).any():
            raise ValueError(f"history must hold integers in [0, {most}] for the {name}")
    agent.history = [
        (LEARNING if late else SEGMENTING, int(n), float(reward), bool(success))
        for late, n, reward, success in history.tolist()
    ]


class Checkpoint:
    """The file of a run, written between episodes, so that an interruption costs seconds.

    As a context it keeps other runs from the file. The lock is a hidden file beside it, which the
    operating system opens again when the process ends, however it ends.

    Parameters
    ----------
    agent : Arkaq
        The agent that learns.
    path : path or None
        The file; None for a run without one.

    Raises
    ------
    ValueError
        If another run uses the file.
    """

    def __init__(self, agent: Arkaq, path: str | os.PathLike[str] | None) -> None:
        self.agent, self.path = agent, None if path is None else _path(path)
        self._written = time.monotonic()

    def __enter__(self) -> Checkpoint:
        """Keep other runs from the file."""
        if self.path is not None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._lock = FileLock(self.path.with_name(f".{self.path.name}.lock"))
            try:
                self._lock.acquire(timeout=0)
            except Timeout:
                raise ValueError(f"checkpoint {self.path} is in use by another run") from None
        return self

    def __exit__(self, *error: object) -> None:
        """Let other runs have the file."""
        if self.path is not None:
            with suppress(OSError):  # on Windows an open file cannot be removed
                os.unlink(self._lock.lock_file)
            self._lock.release()

    def resume(self, env: gymnasium.Env, learns: bool) -> None:
        """Take over the run in the file, if there is one, and note the environment it runs in.

        Parameters
        ----------
        env : gymnasium.Env
            The environment of the next phase.
        learns : bool
            Whether the run goes on to Q-learning in it.

        Raises
        ------
        ValueError
            If the run had other settings or another seed, or its environment had.
        """
        agent = stored = self.agent
        if self.path is not None and self.path.exists():
            stored = load(type(agent), self.path)
            self._compare(_identity(stored), _identity(agent))
            self._compare(stored.environments, agent.environments)
        require_task(agent, env)
        segmented = stored.phase != SEGMENTING
        known = stored.environments if segmented or stored.done_in_phase else {}
        phases = [SEGMENTING] * (not learns or not segmented) + [LEARNING] * learns
        here = dict.fromkeys(phases, describe_environment(env))
        self._compare(known, here)
        if stored is not agent:
            for name in ("art", "q", "history", "cycles", "phase", "done_in_phase"):
                setattr(agent, name, getattr(stored, name))
        to_come = PHASES[PHASES.index(agent.phase) :]
        agent.environments = known | {phase: here[phase] for phase in phases if phase in to_come}

    def _compare(self, theirs: dict[str, Any], ours: dict[str, Any]) -> None:
        """Refuse the run in the file, or in the agent, if a setting that both know differs."""
        for name in [name for name in theirs if name in ours]:
            found = difference(name, theirs[name], ours[name])
            if found:
                run = "this agent" if self.path is None else f"checkpoint {self.path}"
                name, value, other = found
                raise ValueError(
                    f"{run} holds a run with another {name}: "
                    f"{_checks.shown(value)}, not {_checks.shown(other)}"
                )

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
    """Return all that decides what a run comes to, but for the environment."""
    return {
        "task": agent.task,
        "vigilance": agent.vigilance,
        "seed": agent.seed,
        "learning": agent.learning.to_json(),
        "sensing": agent.sensing.to_json(),
        "segmenter": describe("segmenter", agent.segmenter, SEGMENTERS),
        "learner": describe("learner", agent.learner, LEARNERS),
    }


def describe_environment(env: gymnasium.Env) -> dict[str, Any]:
    """Return what decides how the episodes of an environment go, as plain data.

    These are its name, the number of its actions, the time limit, the wrappers with the arguments
    that they keep under their names, and the environment's own settings: a dictionary ``settings``
    if it has one, else what it was made with. Wrappers of Gymnasium that change nothing that the
    agent observes, earns or does are left out.

    Examples
    --------
    >>> import gymnasium
    >>> described = describe_environment(gymnasium.make("arkaq_edu:BallApproach-v0", far=1000))
    >>> described["environment"], described["far"], described["max_episode_steps"]
    ('BallApproach-v0', 1000.0, 150)
    """
    from gymnasium import ActionWrapper, ObservationWrapper, RewardWrapper, Wrapper

    bare, spec, wrappers = env, env.spec, []
    while isinstance(bare, Wrapper):
        changes = isinstance(bare, (ActionWrapper, ObservationWrapper, RewardWrapper))
        if changes or not type(bare).__module__.startswith("gymnasium."):
            keeps = signature(type(bare)).parameters.keys() - {"env"}
            kept = {name: value for name, value in vars(bare).items() if name in keeps}
            wrappers.append({"wrapper": type(bare).__name__, **kept})
        bare = bare.env
    settings = getattr(bare, "settings", None)
    if not isinstance(settings, Mapping):
        made_with = {} if spec is None else spec.kwargs
        settings = {name: value for name, value in made_with.items() if name != "render_mode"}
    described = {
        "environment": type(bare).__name__ if spec is None else spec.id,
        "actions": env.action_space,
        "max_episode_steps": None if spec is None else spec.max_episode_steps,
        "wrappers": wrappers,
        **settings,
    }
    return json.loads(json.dumps(described, default=_plain))


def _plain(value: Any) -> Any:
    """Return as plain data what JSON does not know."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    # The address in an object's representation is another one in each process.
    text = repr(value)
    return type(value).__name__ if " at 0x" in text else text


def difference(name: str, a: Any, b: Any) -> tuple[str, Any, Any] | None:
    """Return the name and the values of the first setting in which two runs differ, if any.

    Examples
    --------
    >>> difference("learning", {"hold": 1, "hot": 10.0}, {"hold": 1, "hot": 8.0})
    ('learning.hot', 10.0, 8.0)
    """
    if isinstance(a, dict) and isinstance(b, dict):
        parts = [(f"{name}.{key}", a.get(key), b.get(key)) for key in {**a, **b}]
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        parts = [(f"{name}[{i}]", *pair) for i, pair in enumerate(zip(a, b, strict=True))]
    else:
        return None if a == b else (name, a, b)
    return next((found for part in parts if (found := difference(*part))), None)


def _json(settings: dict[str, Any]) -> str:
    # NumPy's numbers may be settings, but JSON does not know them.
    return json.dumps(settings, default=lambda number: number.item())
