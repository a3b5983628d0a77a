"""Thesis against here: every number it prints of its problems, and what is measured beside."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from tqdm.auto import tqdm

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Estimator, Sensing, TrainingSettings
from arkaq_edu.experiments import approach, goal, streams
from arkaq_edu.field import World, motion

VIGILANCE = 0.1


def thesis_numbers() -> pd.Series:
    """Return the numbers the thesis prints of its two problems, by quantity.

    Examples
    --------
    >>> int(thesis_numbers()["centers, vigilance 0.1"])
    333
    """
    return pd.read_csv(data_file("thesis.csv"), index_col="quantity").thesis


def load_study() -> pd.DataFrame:
    """Return the study kept with the course: ``results()`` over twenty seeds.

    Examples
    --------
    >>> int(load_study().seeds.min())
    20
    """
    return pd.read_csv(data_file("approach_study.csv"))


def goal_table() -> pd.DataFrame:
    """Return the goal problem set against the thesis, from the study kept with the course.

    Returns
    -------
    DataFrame
        See `results`; "ARKAQ" is the greedy policy it ends with, on fresh starts.

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


def agent_file(folder: str | os.PathLike[str], kind: str, seed: int) -> Path:
    """Return where `results` keeps one of its agents.

    Parameters
    ----------
    folder : path
        Where `results` keeps them.
    kind : {"consistent", "thesis", "near", "far"}
        With which Kalman filter it walks to the ball, or from where it scores.
    seed : int
        Its seed.

    Examples
    --------
    >>> agent_file("out", "thesis", 3).as_posix()
    'out/agents/ball-thesis-seed03.npz'
    """
    task = "goal" if kind in goal.VIGILANCE else "approach"
    return Path(folder) / "agents" / f"{task}-{kind}-seed{seed:02d}.npz"


def results(
    seeds: int = 20,
    approaches: int = 500,
    folder: str | os.PathLike[str] | None = None,
    jobs: int = -1,
    progress: bool = True,
    learning: TrainingSettings | None = None,
    goal_learning: TrainingSettings | None = None,
) -> pd.DataFrame:
    """Run both problems over many seeds and set them against the thesis.

    Parameters
    ----------
    seeds : int
        How many seeds; each has its own stream, its own training and its own fresh starts.
    approaches : int
        Approaches, and kicks, by which each policy of each seed is judged; approaches begin
        uniform over the visible field from 600 to 4100 mm.
    folder : path, optional
        Where to keep the trained agents, so that an interrupted run goes on where it was.
    jobs : int
        Processes at once; -1 for one a core.
    progress : bool
        Whether to show a progress bar.
    learning, goal_learning : TrainingSettings, optional
        Schedules and lengths of the trainings for the ball, and for the goal.

    Returns
    -------
    DataFrame
        Columns quantity, thesis (NaN where it prints none), mean, low and high (the lowest and
        highest of the seeds), seeds.

    Notes
    -----
    Within ``joblib.parallel_config(backend="dask")`` the runs go to a Dask cluster.

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
    numbers = range(_checks.integer("seeds", seeds, 1))
    if jobs == 0:
        raise ValueError("jobs must be a number of processes, or -1 for one a core, got 0")
    tasks: list[Any] = []
    for seed in numbers:
        tasks += [delayed(_stream)(seed), delayed(_references)(seed, approaches)]
        for sensing in ("consistent", "thesis"):
            tasks.append(delayed(_training)(seed, sensing, approaches, folder, learning))
        tasks.append(delayed(_orientations)(seed, goal_learning))
        for distance in goal.VIGILANCE:
            tasks.append(delayed(_goals)(seed, distance, approaches, folder, goal_learning))
    done = Parallel(n_jobs=jobs, return_as="generator_unordered")(tasks)
    bar = tqdm(done, total=len(tasks), desc="reproduce", unit=" runs", disable=not progress)
    return summary(pd.DataFrame(_flatten(bar)))


def summary(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the table of thesis against here from single measurements.

    Parameters
    ----------
    rows : DataFrame
        Columns quantity, seed, value.

    Returns
    -------
    DataFrame
        See `results`.

    Examples
    --------
    >>> rows = pd.DataFrame({"quantity": "centers, vigilance 0.15", "seed": [0, 1],
    ...                      "value": [150, 152]})
    >>> summary(rows)[["quantity", "thesis", "mean", "seeds"]].values.tolist()
    [['centers, vigilance 0.15', 137, 151.0, 2]]
    """
    rows = rows.sort_values(["quantity", "seed"])
    by_quantity = rows.groupby("quantity").value
    table = pd.DataFrame(
        {
            "mean": by_quantity.mean(),
            "low": by_quantity.min(),
            "high": by_quantity.max(),
            "seeds": by_quantity.count(),
        }
    )
    printed = thesis_numbers()
    table.insert(0, "thesis", printed.reindex(table.index))
    order = [*printed.index, *table.index.difference(printed.index)]
    table = table.reindex([quantity for quantity in order if quantity in table.index])
    return table.rename_axis("quantity").reset_index()


def _flatten(runs: Iterable[tuple[int, dict[str, float]]]) -> list[dict[str, Any]]:
    return [
        {"quantity": quantity, "seed": seed, "value": value}
        for seed, measured in runs
        for quantity, value in measured.items()
    ]


def _stream(seed: int) -> tuple[int, dict[str, float]]:
    """Measure one recorded stream, and one walk meant to go straight."""
    stream = streams.record_sightings(seed=seed)
    counts = streams.count_centers(streams.patterns(stream))
    measured = {f"centers, vigilance {rho:g}": float(n) for rho, n in counts.items()}
    for name in ("consistent", "thesis"):
        measured[f"mean NIS (2 is right), {name} Kalman filter"] = mean_nis(
            stream, getattr(Sensing, name)()
        )
    _, y, heading = map(float, motion.straight_walk(World(rng=seed))[-1])
    measured["straight walk of 2 m: drift to the left (mm)"] = y
    measured["straight walk of 2 m: turn to the right (rad)"] = -heading
    return seed, measured


def mean_nis(stream: pd.DataFrame, sensing: Sensing) -> float:
    """Return the mean normalized innovation squared of a filter on a stream.

    Parameters
    ----------
    stream : DataFrame
        As `streams.record_sightings` returns it.
    sensing : Sensing
        The filter's settings.

    Returns
    -------
    float
        2, the number of measurements, if innovations are as large as the filter believes; more
        if it is too sure of itself. The first sighting of an episode, which meets the prior, is
        left out.

    References
    ----------
    Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001,
    section 5.4.

    Examples
    --------
    >>> stream = streams.record_sightings(n=2000)
    >>> bool(1.7 < mean_nis(stream, Sensing.consistent()) < 2.3)
    True
    """
    senses, values = Estimator(sensing), []
    looks = stream[["distance", "orientation", "visible"]].to_numpy()
    for look, cycle, action in zip(looks, stream.cycle, stream.action, strict=True):
        if cycle == 0:
            senses.reset()
        senses.observe(look, None if cycle == 0 else int(action))
        if cycle > 0 and look[2]:
            values.append(senses.kalman.nis)
    return float(np.mean(values))


def _training(
    seed: int,
    sensing: str,
    approaches: int,
    folder: str | os.PathLike[str] | None,
    learning: TrainingSettings | None,
) -> tuple[int, dict[str, float]]:
    agent = approach.train(
        seed,
        VIGILANCE,
        sensing=sensing,
        learning=learning,
        checkpoint=_checkpoint(folder, sensing, seed),
        progress=False,
    )
    who = f"ARKAQ, {sensing} Kalman filter"
    return seed, _judged(who, approach.greedy(agent), approaches, seed)


def _checkpoint(folder: str | os.PathLike[str] | None, kind: str, seed: int) -> Path | None:
    if folder is None:
        return None
    path = agent_file(folder, kind, seed)
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _orientations(seed: int, learning: TrainingSettings | None) -> tuple[int, dict[str, float]]:
    looks = (learning or TrainingSettings.goal()).patterns
    counts = goal.center_counts([seed], n=looks).loc[seed]
    return seed, {f"goal centers, vigilance {rho:g}": float(n) for rho, n in counts.items()}


def _goals(
    seed: int,
    distance: goal.Distance,
    kicks: int,
    folder: str | os.PathLike[str] | None,
    learning: TrainingSettings | None,
) -> tuple[int, dict[str, float]]:
    agent = goal.train(
        seed,
        goal_distance=distance,
        learning=learning,
        checkpoint=_checkpoint(folder, distance, seed),
        progress=False,
    )
    policies = {
        "ARKAQ": approach.greedy(agent),
        "random actions": goal.at_random(seed),
        "planner that sees the truth": goal.oracle(),
    }
    return seed, {
        f"goals (%), {distance}, {who}": 100
        * float(goal.shots(policy, kicks, distance, 10_000 + seed).is_success.mean())
        for who, policy in policies.items()
    }


def _references(seed: int, approaches: int) -> tuple[int, dict[str, float]]:
    return seed, {
        **_judged("planner that sees the truth", approach.planner(), approaches, seed),
        **_judged("random actions", approach.at_random(seed), approaches, seed),
    }


def _judged(who: str, policy: approach.Policy, approaches: int, seed: int) -> dict[str, float]:
    # Starts that no training has seen: their seeds begin far above the agents'.
    table = approach.evaluate(policy, approaches, seed=10_000 + seed)
    return {
        f"ball reached (%), {who}": 100 * float(table.is_success.mean()),
        f"+50 earned (%), {who}": 100 * float(table.bonus.mean()),
        f"way walked over straight way (median), {who}": float(table.detour.median()),
    }
