"""The first problem over many seeds."""

from __future__ import annotations

import os
from typing import Any

import pandas as pd
from joblib import delayed

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.experiments import approach, streams
from arkaq_edu.experiments.policies import Policy
from arkaq_edu.experiments.runs import FRESH_SEEDS, Measured, checkpoint, run_all, summary, tidy
from arkaq_edu.field import World, motion

_Folder = str | os.PathLike[str] | None


def study(
    seeds: int = 20,
    approaches: int = 500,
    folder: _Folder = None,
    jobs: int = -1,
    progress: bool = True,
    learning: TrainingSettings | None = None,
) -> pd.DataFrame:
    """Train and judge agents over many seeds, beside a planner and random actions.

    Parameters
    ----------
    seeds, approaches, folder, jobs, progress, learning
        See `arkaq_edu.experiments.results`.

    Returns
    -------
    DataFrame
        See `arkaq_edu.experiments.summary`.

    References
    ----------
    Thesis 5.1.3.1 and 5.2; figures 5.5, 5.10-5.14, 5.16-5.30.

    Examples
    --------
    >>> brief = TrainingSettings(patterns=200, exploration=200, exploitation=0)
    >>> table = study(1, 2, jobs=1, progress=False, learning=brief)
    >>> set(table.quantity) == set(load_study().quantity)
    True
    """
    tasks = []
    for seed in range(_checks.integer("seeds", seeds, 1)):
        tasks += seed_runs(seed, approaches, folder, learning)
    return summary(tidy(run_all(tasks, jobs, progress, "approach")))


def load_study() -> pd.DataFrame:
    """Return the study that comes with the course: ``study()`` over twenty seeds.

    Examples
    --------
    >>> int(load_study().seeds.min())
    20
    """
    return pd.read_csv(data_file("approach_study.csv"))


def seed_runs(
    seed: int, approaches: int, folder: _Folder = None, learning: TrainingSettings | None = None
) -> list[Any]:
    """Return all runs of one seed as joblib's delayed tasks, each of which gives `Measured`."""
    return [
        delayed(_stream)(seed),
        delayed(_references)(seed, approaches),
        delayed(_training)(seed, "consistent", approaches, folder, learning),
        delayed(_training)(seed, "thesis", approaches, folder, learning),
    ]


def _stream(seed: int) -> Measured:
    """Measure a recorded stream, and a walk that is meant to go straight."""
    stream = approach.record_sightings(seed=seed)
    counts = streams.count_centers(approach.patterns(stream))
    measured = {f"centers, vigilance {rho:g}": float(n) for rho, n in counts.items()}
    for name in ("consistent", "thesis"):
        measured[f"mean NIS (2 is right), {name} Kalman filter"] = streams.mean_nis(
            stream, getattr(Sensing, name)()
        )
    _, y, heading = map(float, motion.straight_walk(World(rng=seed))[-1])
    measured["straight walk of 2 m: drift to the left (mm)"] = y
    measured["straight walk of 2 m: turn to the right (rad)"] = -heading
    return seed, measured


def _references(seed: int, approaches: int) -> Measured:
    return seed, {
        **_judge("planner that sees the truth", approach.planner(), approaches, seed),
        **_judge("random actions", approach.at_random(seed), approaches, seed),
    }


def _training(
    seed: int, sensing: str, approaches: int, folder: _Folder, learning: TrainingSettings | None
) -> Measured:
    agent = approach.train(
        seed,
        sensing=sensing,
        learning=learning,
        checkpoint=checkpoint(folder, "approach", sensing, seed),
        progress=False,
    )
    who = f"ARKAQ, {sensing} Kalman filter"
    return seed, _judge(who, approach.greedy(agent), approaches, seed)


def _judge(who: str, policy: Policy, approaches: int, seed: int) -> dict[str, float]:
    table = approach.evaluate(policy, approaches, FRESH_SEEDS + seed)
    return {
        f"ball reached (%), {who}": 100 * float(table.is_success.mean()),
        f"+50 earned (%), {who}": 100 * float(table.bonus.mean()),
        f"way walked over straight way (median), {who}": float(table.detour.median()),
    }
