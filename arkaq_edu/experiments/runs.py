"""Many runs at once, and their summary: what the studies of both problems share."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel
from numpy.typing import ArrayLike, NDArray
from tqdm.auto import tqdm

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.experiments.policies import Policy

#: Seeds of fresh starts begin here, far above the seeds that agents are trained with.
FRESH_SEEDS = 10_000

#: What a run returns: its seed, and a value for each quantity it measured.
Measured = tuple[int, dict[str, float]]


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

    Examples
    --------
    >>> tidy([(0, {"x": 1.0, "y": 2.0})]).values.tolist()
    [['x', 0, 1.0], ['y', 0, 2.0]]
    """
    rows = [(name, seed, value) for seed, values in measured for name, value in values.items()]
    return pd.DataFrame(rows, columns=["quantity", "seed", "value"])


def summary(rows: pd.DataFrame) -> pd.DataFrame:
    """Return mean and range over the seeds, beside the number that the thesis prints.

    Parameters
    ----------
    rows : DataFrame
        Columns quantity, seed, value.

    Returns
    -------
    DataFrame
        Columns quantity, thesis (NaN where it prints none), mean, low and high (the lowest and
        the highest of the seeds), seeds (how many). First come the quantities of the thesis, in
        its order.

    Examples
    --------
    >>> rows = tidy([(0, {"centers, vigilance 0.15": 150}), (1, {"centers, vigilance 0.15": 152})])
    >>> summary(rows)[["quantity", "thesis", "mean", "seeds"]].values.tolist()
    [['centers, vigilance 0.15', 137, 151.0, 2]]
    """
    values = rows.sort_values(["quantity", "seed"]).groupby("quantity").value
    table = values.agg(mean="mean", low="min", high="max", seeds="count")
    printed = thesis_numbers()
    table.insert(0, "thesis", printed.reindex(table.index))
    order = [*printed.index, *table.index.difference(printed.index)]
    table = table.reindex([quantity for quantity in order if quantity in table.index])
    return table.rename_axis("quantity").reset_index()


def thesis_numbers() -> pd.Series:
    """Return the numbers that the thesis prints of its two problems, by quantity.

    Examples
    --------
    >>> int(thesis_numbers()["centers, vigilance 0.1"])
    333
    """
    return pd.read_csv(data_file("thesis.csv"), index_col="quantity").thesis


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
    kind : {"consistent", "thesis", "near", "far"}
        The Kalman filter of an approach, or the distance of a goal.
    seed : int
        The agent's seed.

    Examples
    --------
    >>> agent_file("out", "approach", "thesis", 3).as_posix()
    'out/agents/approach-thesis-seed03.npz'
    """
    return Path(folder) / "agents" / f"{task}-{kind}-seed{seed:02d}.npz"


def checkpoint(
    folder: str | os.PathLike[str] | None, task: str, kind: str, seed: int
) -> Path | None:
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
