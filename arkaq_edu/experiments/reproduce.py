"""The numbers of the thesis beside those measured here, over many seeds."""

from __future__ import annotations

import os

import pandas as pd

from arkaq_edu import _checks
from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import approach, goal
from arkaq_edu.experiments.runs import run_all, summary, tidy


def results(
    seeds: int = 20,
    approaches: int = 500,
    folder: str | os.PathLike[str] | None = None,
    jobs: int = -1,
    progress: bool = True,
    learning: TrainingSettings | None = None,
    goal_learning: TrainingSettings | None = None,
) -> pd.DataFrame:
    """Run both problems over many seeds and compare them with the thesis.

    Parameters
    ----------
    seeds : int
        Number of seeds. Each has its own stream, its own training and its own fresh starts.
    approaches : int
        Number of approaches, and of kicks, on which each policy of each seed is judged.
    folder : path, optional
        Where to keep the trained agents, so that an interrupted run continues.
    jobs : int
        Number of processes; -1 for one a core.
    progress : bool
        Whether to show a progress bar.
    learning, goal_learning : TrainingSettings, optional
        How agents are trained for `approach` and for `goal`.

    Returns
    -------
    DataFrame
        See `arkaq_edu.experiments.summary`.

    Notes
    -----
    Inside ``joblib.parallel_config(backend="dask")`` the runs go to a Dask cluster.

    References
    ----------
    Thesis 5.1.3.1, 5.2, 5.3; figures 5.5, 5.10-5.14, 5.16-5.30, 5.35-5.37, 5.39-5.41.

    Examples
    --------
    >>> brief = TrainingSettings(patterns=200, exploration=200, exploitation=0)
    >>> table = results(1, 2, jobs=1, progress=False, learning=brief, goal_learning=brief)
    >>> table.columns.tolist()
    ['quantity', 'thesis', 'mean', 'low', 'high', 'seeds']
    """
    tasks = []
    for seed in range(_checks.integer("seeds", seeds, 1)):
        tasks += approach.seed_runs(seed, approaches, folder, learning)
        tasks += goal.seed_runs(seed, approaches, folder, goal_learning)
    return summary(tidy(run_all(tasks, jobs, progress, "reproduce")))


def goal_table() -> pd.DataFrame:
    """Compare the stored study of the goal problem with the thesis.

    Returns
    -------
    DataFrame
        See `arkaq_edu.experiments.summary`. "ARKAQ" is the greedy policy at the end of training,
        on fresh starts.

    Examples
    --------
    >>> table = goal_table().set_index("quantity")
    >>> table.thesis["goals (%), near, ARKAQ"], int(table.seeds.min())
    (np.float64(60.0), 30)
    """
    counts = goal.load_center_counts().add_prefix("goal centers, vigilance ")
    shares = goal.rates(goal.load_study()).drop(columns="ARKAQ", level="who")
    names = {"ARKAQ, learned": "ARKAQ", "oracle": "planner that sees the truth"}
    shares.columns = [f"goals (%), {place}, {names.get(who, who)}" for place, who in shares.columns]
    rows = pd.concat([counts, shares], axis=1).rename_axis("seed").reset_index()
    return summary(rows.melt(id_vars="seed", var_name="quantity"))
