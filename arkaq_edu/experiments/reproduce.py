"""The thesis's experiments over many seeds, with a verdict on every number and claim."""

from __future__ import annotations

import json
import os
import platform
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from arkaq_edu import _checks
from arkaq_edu._files import replacing
from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import approach, goal
from arkaq_edu.experiments.claims import computed, judge, with_derived
from arkaq_edu.experiments.runs import Folder, Plan, run_all, tidy

#: The packages on which the numbers depend.
PACKAGES = (
    "arkaq-edu", "gymnasium", "joblib", "matplotlib", "numba", "numpy", "pandas", "pymunk", "scipy",
)  # fmt: skip

#: How agents are trained in a rehearsal: enough to show every row and figure, not to judge.
QUICK = (
    TrainingSettings(patterns=800, exploration=1000, exploitation=1000),
    TrainingSettings.goal(patterns=200, exploration=200, exploitation=400),
)


class Measurements(NamedTuple):
    """What the runs of both problems measured.

    Attributes
    ----------
    runs : DataFrame
        One row a measurement: quantity, seed, value. What is computed without a seed has none.
    curves : DataFrame
        Goals against kicks; see `goal.study`.
    """

    runs: pd.DataFrame
    curves: pd.DataFrame


def results(
    seeds: int = 30,
    approaches: int = 500,
    folder: Folder = None,
    jobs: int = -1,
    progress: bool = True,
    learning: TrainingSettings | None = None,
    goal_learning: TrainingSettings | None = None,
) -> pd.DataFrame:
    """Run both problems over many seeds and judge what the thesis prints.

    Parameters
    ----------
    seeds : int
        Number of seeds. Each has its own stream, its own training and its own fresh starts.
    approaches : int
        Number of approaches, and of kicks, on which each policy of each seed is judged.
    folder : path, optional
        Where to keep agents and measurements, so that an interrupted run continues.
    jobs : int
        Number of processes; -1 for one a core.
    progress : bool
        Whether to show a progress bar.
    learning, goal_learning : TrainingSettings, optional
        How agents are trained for `approach` and for `goal`.

    Returns
    -------
    DataFrame
        See `arkaq_edu.experiments.judge`.

    Notes
    -----
    Inside ``joblib.parallel_config(backend="dask")`` the runs go to a Dask cluster.

    References
    ----------
    Thesis 5.1.3.1, 5.2, 5.3; figures 5.5, 5.10-5.14, 5.16-5.30, 5.35-5.37, 5.39-5.41.

    Examples
    --------
    >>> results(seeds=0)
    Traceback (most recent call last):
    ValueError: seeds must be an integer >= 1, got 0

    ``results(seeds=3, folder="mine")`` takes some minutes, and continues in the same folder.
    """
    plan = Plan(folder, approaches, learning, goal_learning)
    return judge(measure(seeds, plan, jobs, progress).runs)


def measure(
    seeds: int, plan: Plan | None = None, jobs: int = -1, progress: bool = True
) -> Measurements:
    """Run both problems over many seeds, and compute what needs no seed.

    Parameters
    ----------
    seeds, jobs, progress
        See `results`.
    plan : Plan, optional
        How every seed is run.

    Returns
    -------
    Measurements
    """
    plan = plan or Plan()
    tasks = []
    for seed in range(_checks.integer("seeds", seeds, 1)):
        tasks += approach.seed_runs(seed, plan) + goal.seed_runs(seed, plan)
    measured = run_all(tasks, jobs, progress, "reproduce")
    exact = pd.DataFrame({"quantity": computed().keys(), "value": computed().values()})
    runs = with_derived(pd.concat([exact, tidy(measured)], ignore_index=True))
    runs = runs[["quantity", "seed", "value"]].astype({"seed": "Int64"})
    return Measurements(runs, goal.curves(measured))


def write(folder: str | os.PathLike[str], measured: Measurements, settings: dict[str, Any]) -> None:
    """Write results.csv, runs.csv, curves.csv and run.json, each completely or not at all.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    measured : Measurements
        See `measure`.
    settings : dict
        What was asked for, for run.json.

    Examples
    --------
    >>> import tempfile
    >>> runs = pd.DataFrame({"quantity": ["reward"], "seed": [0], "value": [140.0]})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(folder, Measurements(runs, pd.DataFrame()), {"seeds": 1})
    ...     sorted(os.listdir(folder))
    ['curves.csv', 'results.csv', 'run.json', 'runs.csv']
    """
    tables = {"results": judge(measured.runs), **measured._asdict()}
    for name, table in tables.items():
        with replacing(Path(folder) / f"{name}.csv") as fresh:
            table.to_csv(fresh, index=False)
    with replacing(Path(folder) / "run.json") as fresh:
        fresh.write_text(json.dumps(_manifest(Path(folder), settings), indent=1) + "\n")


def _manifest(folder: Path, settings: dict[str, Any]) -> dict[str, Any]:
    """Return what the numbers were made with, and how long each run took."""
    runs = sorted((folder / "runs").glob("*.json"))
    seconds = {path.stem: json.loads(path.read_text())["seconds"] for path in runs}
    return {
        "settings": settings,
        "versions": {"python": platform.python_version()} | {p: version(p) for p in PACKAGES},
        "machine": {"system": platform.platform(), "cores": os.cpu_count()},
        "written": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "processor_seconds": round(sum(seconds.values()), 1),
        "seconds": seconds,
    }
