"""The first problem over many seeds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from joblib import delayed

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, Estimator, Sensing, TrainingSettings
from arkaq_edu.art import ART2A, EuclideanART, quantization_error
from arkaq_edu.envs.ball_approach import ACTIONS
from arkaq_edu.experiments import approach, streams
from arkaq_edu.experiments.claims import judge
from arkaq_edu.experiments.policies import Policy
from arkaq_edu.experiments.runs import (
    FRESH_SEEDS,
    Folder,
    Plan,
    checkpoint,
    kept,
    run_all,
    tidy,
)
from arkaq_edu.field import World, motion

#: Straight walks of each seed. One is noisy; the mean of many shows the drift.
WALKS = 50
#: Agents at the other vigilances are trained at every third seed, since they take longest.
SWEEP_EVERY = 3

_FAR = 3000.0  # mm; "high distances" in the thesis


def study(
    seeds: int = 30,
    approaches: int = 500,
    folder: Folder = None,
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
        See `arkaq_edu.experiments.judge`.

    References
    ----------
    Thesis 5.1.3.1 and 5.2; figures 5.5, 5.10-5.14, 5.16-5.30.

    Examples
    --------
    >>> study(seeds=0)
    Traceback (most recent call last):
    ValueError: seeds must be an integer >= 1, got 0
    """
    plan, tasks = Plan(folder, approaches, learning), []
    for seed in range(_checks.integer("seeds", seeds, 1)):
        tasks += seed_runs(seed, plan)
    return judge(tidy(run_all(tasks, jobs, progress, "approach")))


def load_study() -> pd.DataFrame:
    """Return the study that comes with the course.

    Examples
    --------
    >>> study = load_study().set_index("quantity")
    >>> float(study.loc["ball reached (%), planner that sees the truth", "mean"])
    100.0
    """
    return pd.read_csv(data_file("approach_study.csv"))


def seed_runs(seed: int, plan: Plan) -> list[Any]:
    """Return all runs of one seed as joblib's delayed tasks, each of which gives `Measured`."""
    tasks = [
        delayed(kept)(_stream, "approach-stream", seed, plan),
        delayed(kept)(_references, "approach-references", seed, plan),
        delayed(kept)(_training, "approach-consistent", seed, plan, "consistent"),
        delayed(kept)(_training, "approach-thesis", seed, plan, "thesis"),
    ]
    if seed % SWEEP_EVERY == 0:
        for rho in streams.VIGILANCES:
            if rho != approach.VIGILANCE:
                tasks.append(delayed(kept)(_sweep, f"approach-vigilance{rho}", seed, plan, rho))
    return tasks


def _stream(seed: int, plan: Plan) -> dict[str, float]:
    """Measure a recorded stream, and walks that are meant to go straight."""
    n = (plan.learning or TrainingSettings()).patterns
    stream = approach.record_sightings(n, seed)
    X = approach.patterns(stream)
    counts = streams.count_centers(X)
    measured = {f"centers, vigilance {rho:g}": float(n) for rho, n in counts.items()}
    for name in ("consistent", "thesis"):
        measured[f"mean NIS (2 is right), {name} Kalman filter"] = streams.mean_nis(
            stream, getattr(Sensing, name)()
        )
    return measured | _errors(stream) | _angular(stream, X) | _straight_walks(seed)


def _errors(stream: pd.DataFrame) -> dict[str, float]:
    """Return the errors of far sightings, and what the thesis's filter makes of them."""
    senses = Estimator(Sensing.thesis())
    looks = stream[["distance", "orientation", "visible"]].to_numpy(dtype=float)
    estimates = []
    for look, cycle in zip(looks, stream.cycle, strict=True):
        if cycle == 0:
            senses.reset()
        estimates.append(senses.observe(look, None if cycle == 0 else 0))
    true = stream[["true_distance", "true_orientation"]].to_numpy()
    far = ((stream.visible == 1) & (stream.cycle > 0) & (stream.true_distance > _FAR)).to_numpy()
    seen = np.sqrt(((looks[:, :2] - true)[far] ** 2).mean(axis=0))
    estimated = senses.sensing.unscale(np.array(estimates))
    filtered = np.sqrt(((estimated - true)[far] ** 2).mean(axis=0))
    measured = {}
    for i, (name, unit) in enumerate((("distance", "mm"), ("orientation", "rad"))):
        what = f"error of the {name} beyond 3 m ({unit}, one standard deviation)"
        measured[what] = float((looks[:, i] - true[:, i])[far].std())
        what = f"{name} beyond 3 m: error of the thesis's filter over that of a sighting"
        measured[what] = float(filtered[i] / seen[i])
    return measured


def _angular(stream: pd.DataFrame, X: np.ndarray) -> dict[str, float]:
    """Return how well angles tell the distance (section 4.2.1)."""
    distance = stream.distance[stream.visible == 1].to_numpy()[:, np.newaxis]
    angular, euclidean = ART2A(0.95, 0.1).fit(X), EuclideanART(approach.VIGILANCE, 0.6).fit(X)
    errors = [quantization_error(distance, network.predict(X)) for network in (angular, euclidean)]
    return {
        "largest norm of a scaled pattern": float(np.linalg.norm(X, axis=1).max()),
        "angular templates, vigilance 0.95": float(angular.n_clusters_),
        "distance within a category: angular at 0.95 minus Euclidean at 0.1 (mm)": float(
            errors[0] - errors[1]
        ),
    }


def _straight_walks(seed: int) -> dict[str, float]:
    """Return the mean end of many walks that are meant to go straight (figure 5.5)."""
    worlds = (World(rng=np.random.default_rng([seed, walk])) for walk in range(WALKS))
    ends = np.array([motion.straight_walk(world)[-1] for world in worlds])
    return {
        "straight walk of 2 m: drift to the left (mm)": float(ends[:, 1].mean()),
        "straight walk of 2 m: turn to the right (rad)": float(-ends[:, 2].mean()),
    }


def _references(seed: int, plan: Plan) -> dict[str, float]:
    policies = {
        "planner that sees the truth": approach.planner(),
        "random actions": approach.at_random(seed),
    }
    return {
        name: value
        for who, policy in policies.items()
        for name, value in _judge(who, policy, seed, plan).items()
    }


def _train(seed: int, plan: Plan, sensing: str, vigilance: float, kind: str) -> Arkaq:
    return approach.train(
        seed,
        vigilance,
        sensing=sensing,
        learning=plan.learning,
        checkpoint=checkpoint(plan.folder, "approach", kind, seed),
        progress=False,
    )


def _training(seed: int, plan: Plan, sensing: str) -> dict[str, float]:
    agent = _train(seed, plan, sensing, approach.VIGILANCE, sensing)
    measured = _judge(f"ARKAQ, {sensing} Kalman filter", approach.greedy(agent), seed, plan)
    if sensing == "consistent":
        measured |= _pictured(agent) | _at_vigilance(agent, approach.VIGILANCE, measured, sensing)
    return measured


def _pictured(agent: Arkaq) -> dict[str, float]:
    """Return what figures 5.16 to 5.30 show of an agent."""
    orientation = agent.sensing.unscale(agent.art.cluster_centers_)[:, 1]
    left = agent.q.Q[orientation > 0.4].argmax(axis=1) == ACTIONS.index("left")  # type: ignore[union-attr]
    walks = range(1, len(approach.TRAJECTORY_STARTS) + 1)
    reached = sum(approach.trajectory(number, agent).is_success for number in walks)
    return {
        "states at the left edge that turn left (%)": 100 * float(left.mean()),
        "walks that reach the ball, of eleven": float(reached),
    }


def _sweep(seed: int, plan: Plan, vigilance: float) -> dict[str, float]:
    """Train and judge an agent at one of the other vigilances of figures 5.10 to 5.14."""
    agent = _train(seed, plan, "consistent", vigilance, f"vigilance{vigilance}")
    judged = _judge("ARKAQ", approach.greedy(agent), seed, plan)
    return _at_vigilance(agent, vigilance, judged, "")


def _at_vigilance(
    agent: Arkaq, vigilance: float, judged: dict[str, float], sensing: str
) -> dict[str, float]:
    """Return what was judged under names that hold the vigilance, and the number of states."""
    measured = {f"states, ARKAQ, vigilance {vigilance:g}": float(agent.art.n_clusters_)}
    for name, value in judged.items():
        what = name.removesuffix(f", {sensing} Kalman filter").removesuffix(", ARKAQ")
        measured[f"{what}, ARKAQ, vigilance {vigilance:g}"] = value
    return measured


def _judge(who: str, policy: Policy, seed: int, plan: Plan) -> dict[str, float]:
    table = approach.evaluate(policy, plan.episodes, FRESH_SEEDS + seed)
    return {
        f"ball reached (%), {who}": 100 * float(table.is_success.mean()),
        f"+50 earned (%), {who}": 100 * float(table.bonus.mean()),
        f"reward, {who}": float(table.reward.mean()),
        f"way walked over straight way (median), {who}": float(table.detour.median()),
    }
