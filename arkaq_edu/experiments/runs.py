"""Many runs at once, each kept when it is done: what the studies of both problems share."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel
from numpy.typing import ArrayLike, NDArray
from tqdm.auto import tqdm

from arkaq_edu import __version__, _checks
from arkaq_edu._files import replacing
from arkaq_edu.arkaq import Arkaq, TrainingSettings
from arkaq_edu.experiments.claims import rounded_value, thesis_numbers
from arkaq_edu.experiments.policies import Policy

#: Seeds of fresh starts begin here, far above the seeds that agents are trained with.
FRESH_SEEDS = 10_000

#: What a run returns: its seed, and a value for each quantity it measured. A curve is a list.
Measured = tuple[int, dict[str, Any]]

Folder = str | os.PathLike[str] | None


@dataclass(frozen=True)
class Plan:
    """How every seed of a study is run.

    Parameters
    ----------
    folder : path, optional
        Where agents and results are kept, so that an interrupted study continues.
    episodes : int
        Fresh episodes that judge each policy.
    learning, goal_learning : TrainingSettings, optional
        How agents are trained for `approach` and for `goal`.
    """

    folder: Folder = None
    episodes: int = 500
    learning: TrainingSettings | None = None
    goal_learning: TrainingSettings | None = None

    def __post_init__(self) -> None:
        _checks.integer("episodes", self.episodes, 1)

    def settings(self) -> dict[str, Any]:
        """Return what the results depend on, as plain numbers."""
        chosen = {"learning": self.learning, "goal_learning": self.goal_learning}
        return {"version": __version__, "episodes": self.episodes} | {
            name: None if value is None else value.to_json() for name, value in chosen.items()
        }


def kept(
    measure: Callable[..., dict[str, Any]],
    name: str,
    seed: int,
    plan: Plan,
    *more: Any,
) -> Measured:
    """Return what a run measures, from the plan's folder if the run has been done already.

    Parameters
    ----------
    measure : function
        Takes the seed, the plan and `more`, and returns a value for each quantity.
    name : str
        The name of the run, for its file.
    seed : int
        The seed of the run.
    plan : Plan
        A file that was written with other settings is not used.
    *more
        Passed to `measure`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     plan = Plan(folder=folder)
    ...     first = kept(lambda seed, plan: {"x": 0.1 + 0.2}, "sum", 7, plan)
    ...     again = kept(lambda seed, plan: {"x": 1 / 0}, "sum", 7, plan)
    >>> first, again == first
    ((7, {'x': 0.3}), True)
    """
    file = f"{name}-seed{seed:02d}.json"
    path = None if plan.folder is None else Path(plan.folder) / "runs" / file
    if path is not None and path.exists():
        done = json.loads(path.read_text(encoding="utf-8"))
        if done["settings"] == plan.settings():
            return seed, done["values"]
    start = time.process_time()
    values = {
        quantity: value if isinstance(value, list) else rounded_value(value)
        for quantity, value in measure(seed, plan, *more).items()
    }
    if path is not None:
        seconds = round(time.process_time() - start, 1)
        text = json.dumps({"settings": plan.settings(), "seconds": seconds, "values": values})
        with replacing(path) as fresh:
            fresh.write_text(text + "\n", encoding="utf-8")
    return seed, values


def run_all(tasks: list[Any], jobs: int, progress: bool, label: str) -> list[Any]:
    """Run joblib's delayed `tasks` on `jobs` processes and return their results in order.

    Examples
    --------
    >>> from joblib import delayed
    >>> run_all([delayed(abs)(-1), delayed(abs)(2)], jobs=1, progress=False, label="abs")
    [1, 2]
    """
    if jobs == 0:
        raise ValueError("jobs must be a number of processes, or -1 for one a core, got 0")
    done = Parallel(n_jobs=jobs, return_as="generator")(tasks)
    return list(tqdm(done, total=len(tasks), desc=label, unit=" runs", disable=not progress))


def tidy(measured: Iterable[Measured]) -> pd.DataFrame:
    """Return one row a measurement, with columns quantity, seed, value.

    Curves are left out, and what could not be measured (NaN: the way of walks that never arrived).

    Examples
    --------
    >>> tidy([(0, {"x": 1.0, "y": 2.0})]).values.tolist()
    [['x', 0, 1.0], ['y', 0, 2.0]]
    """
    rows = [
        (name, seed, value)
        for seed, values in measured
        for name, value in values.items()
        if not isinstance(value, list) and value == value
    ]
    return pd.DataFrame(rows, columns=["quantity", "seed", "value"])


def policy_fact(agent: Arkaq, actions: ArrayLike, names: tuple[str, ...], quantity: str) -> str:
    """Say how many states an agent has, how many the thesis prints, and how many do what.

    Parameters
    ----------
    agent : Arkaq
        Its vigilance is compared with those of the thesis.
    actions : array_like of int, shape (S,)
        The action of each state.
    names : tuple of str
        The name of each action.
    quantity : str
        The name of the thesis's number in `thesis_numbers`, without the vigilance.

    Examples
    --------
    >>> policy_fact(Arkaq(vigilance=0.1, rng=0), [0, 0, 1], ("go", "turn"), "centers, vigilance")
    '3 states (thesis 333) at vigilance 0.1: 2 go, 1 turn'
    """
    actions = np.asarray(actions)
    parts = ", ".join(f"{(actions == i).sum()} {name}" for i, name in enumerate(names))
    printed = thesis_numbers().get(f"{quantity} {agent.vigilance:g}")
    beside = "" if printed is None else f" (thesis {printed})"
    return f"{len(actions)} states{beside} at vigilance {agent.vigilance:g}: {parts}"


def agent_file(folder: str | os.PathLike[str], task: str, kind: str, seed: int) -> Path:
    """Return the file in which a study keeps one of its agents.

    Parameters
    ----------
    folder : path
        The folder of the study.
    task : {"approach", "goal"}
    kind : str
        The Kalman filter of an approach, "consistent" or "thesis", and the vigilance if it is not
        the usual one; or the distance of a goal, "near" or "far".
    seed : int
        The agent's seed.

    Examples
    --------
    >>> agent_file("out", "approach", "thesis", 3).as_posix()
    'out/agents/approach-thesis-seed03.npz'
    """
    return Path(folder) / "agents" / f"{task}-{kind}-seed{seed:02d}.npz"


def checkpoint(folder: Folder, task: str, kind: str, seed: int) -> Path | None:
    """Return `agent_file` and make its folder; None if there is no folder to keep agents in."""
    if folder is None:
        return None
    path = agent_file(folder, task, kind, seed)
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def evaluate(
    run_episode: Callable[..., dict[str, Any]], policy: Policy, n: int, seed: int
) -> pd.DataFrame:
    """Play `n` episodes of a policy, each with a generator of its own, and return a row each.

    Examples
    --------
    >>> def draw(choose, rng):
    ...     return {"drawn": int(rng.integers(10))}
    >>> evaluate(draw, lambda episode: None, n=3, seed=0).drawn.tolist()
    [8, 5, 9]
    """
    n, seed = _checks.integer("n", n, 1), _checks.integer("seed", seed)
    return pd.DataFrame(
        [run_episode(policy(i), np.random.default_rng([seed, i])) for i in range(n)]
    )


def learning_curve(agent: Arkaq, window: int = 50) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return how the reward of an episode grew while an agent learned.

    Parameters
    ----------
    agent : Arkaq
        An agent of either task that has learned.
    window : int
        Episodes over which the reward is averaged.

    Returns
    -------
    cycles : ndarray of int, shape (n - window + 1,)
        Cycles of Q-learning up to the end of each window; n is the number of episodes.
    reward : ndarray, shape (n - window + 1,)
        The mean reward of the episodes in the window.

    Raises
    ------
    ValueError
        If the agent has been through fewer episodes than `window`.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> cycles, reward = learning_curve(approach.load_agent())
    >>> bool(reward[-1] > reward[0])
    True
    """
    episodes = [row for row in agent.history if row[0] == "Q-learning"]
    window = _checks.integer("window", window, 1, len(episodes))
    cycles = np.cumsum([row[1] for row in episodes])[window - 1 :]
    reward = np.convolve([row[2] for row in episodes], np.full(window, 1 / window), "valid")
    return cycles, reward
