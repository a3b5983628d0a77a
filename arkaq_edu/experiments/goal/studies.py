"""The second problem over many seeds: goals against kicks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from joblib import delayed
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, TrainingSettings
from arkaq_edu.experiments import goal
from arkaq_edu.experiments.goal.task import Distance
from arkaq_edu.experiments.policies import Policy
from arkaq_edu.experiments.runs import FRESH_SEEDS, Measured, Plan, checkpoint, kept, run_all
from arkaq_edu.experiments.streams import count_centers

_DISTANCES: tuple[Distance, ...] = ("near", "far")

#: Kicks shown in a curve: every seed of the study has at least as many while it learns.
KICKS = {"near": 1350, "far": 1500}
#: Kicks in one entry of a curve.
BLOCK = 50
#: Columns of a table of curves.
COLUMNS = ["goal_distance", "seed", "who", "kicks", "goals"]
#: Fresh kicks that judge a policy that no longer learns.
FRESH = 300


def curve(scored: ArrayLike, block: int = BLOCK) -> pd.DataFrame:
    """Return goals against kicks, one row for every `block` kicks; an incomplete row is left out.

    Parameters
    ----------
    scored : array_like of bool, shape (n,)
        Whether each kick scored, in order.
    block : int
        Kicks in a row.

    Returns
    -------
    DataFrame
        kicks so far, and goals among the last `block` of them.

    Examples
    --------
    >>> curve([True, False, True, True, False], block=2).values.tolist()
    [[2, 1], [4, 2]]
    """
    scored = _checks.array("scored", scored, (None,)).astype(int)
    rows = len(scored) // _checks.integer("block", block, 1)
    goals = scored[: rows * block].reshape(rows, block).sum(axis=1)
    return pd.DataFrame({"kicks": block * np.arange(1, rows + 1), "goals": goals})


def scored_while_learning(agent: Arkaq) -> NDArray[np.bool_]:
    """Return, for each kick of the agent's Q-learning, whether it scored.

    Examples
    --------
    >>> scored = scored_while_learning(goal.load_agent())
    >>> bool(scored[:100].mean() < scored[-100:].mean())
    True
    """
    return np.array([row[3] for row in agent.history if row[0] == "Q-learning"], dtype=bool)


def play(
    seed: int,
    goal_distance: Distance,
    kicks: int | None = None,
    fresh: int = FRESH,
    learning: TrainingSettings | None = None,
) -> pd.DataFrame:
    """Run one seed of the study: an agent that learns, random actions, and the planner.

    Parameters
    ----------
    seed : int
        The seed of all of it.
    goal_distance : {"near", "far"}
    kicks : int, optional
        Kicks of the agent while it learns, and of random actions; by default `KICKS`.
    fresh : int
        Kicks of the others.
    learning : TrainingSettings, optional
        See `train`.

    Returns
    -------
    DataFrame
        Columns goal_distance, seed, who, kicks, goals; see `curve`. "ARKAQ" is the agent while it
        learns, "ARKAQ, learned" its greedy policy afterward, on fresh starts; "oracle" is the
        planner.

    References
    ----------
    Thesis figures 5.40 and 5.41.

    Examples
    --------
    >>> brief = TrainingSettings.goal(patterns=100, exploration=200, exploitation=0)
    >>> play(0, "near", kicks=50, fresh=50, learning=brief).who.tolist()
    ['ARKAQ', 'ARKAQ, learned', 'random actions', 'oracle']
    """
    kicks = KICKS[goal_distance] if kicks is None else kicks
    agent = goal.train(seed, goal_distance=goal_distance, learning=learning, progress=False)
    return _curves(seed, goal_distance, _scored(agent, seed, goal_distance, kicks, fresh))


def _scored(
    agent: Arkaq, seed: int, distance: Distance, kicks: int, fresh: int
) -> dict[str, NDArray[np.bool_]]:
    """Return whether each kick scored: of the agent, learning and learned, and of the others."""

    def scored(policy: Policy, n: int) -> NDArray[np.bool_]:
        shots = goal.evaluate(policy, n, FRESH_SEEDS + seed, goal_distance=distance)
        return shots.is_success.to_numpy()

    return {
        "ARKAQ": scored_while_learning(agent)[:kicks],
        "ARKAQ, learned": scored(goal.greedy(agent), fresh),
        "random actions": scored(goal.at_random(seed), kicks),
        "oracle": scored(goal.planner(), fresh),
    }


def _curves(seed: int, distance: Distance, scored: Mapping[str, NDArray[np.bool_]]) -> pd.DataFrame:
    table = pd.concat([curve(goals).assign(who=who) for who, goals in scored.items()])
    table = table.assign(goal_distance=distance, seed=seed).reset_index(drop=True)
    return table[COLUMNS]


def study(seeds: int = 30, jobs: int = -1, progress: bool = True) -> pd.DataFrame:
    """Play near and far over many seeds.

    Parameters
    ----------
    seeds : int
        Number of seeds.
    jobs : int
        Number of processes; -1 for one a core.
    progress : bool
        Whether to show a progress bar.

    Returns
    -------
    DataFrame
        See `play`.
    """
    numbers = range(_checks.integer("seeds", seeds, 1))
    tasks = [delayed(play)(seed, distance) for distance in _DISTANCES for seed in numbers]
    return pd.concat(run_all(tasks, jobs, progress, "goal"), ignore_index=True)


def load_study() -> pd.DataFrame:
    """Return the study that comes with the course: ``study()`` over thirty seeds.

    Examples
    --------
    >>> sorted(load_study().who.unique())
    ['ARKAQ', 'ARKAQ, learned', 'oracle', 'random actions']
    """
    return pd.read_csv(data_file("goal_study.csv"))


def mean_curves(table: pd.DataFrame, goal_distance: Distance) -> tuple[pd.Series, pd.Series]:
    """Return goals in a hundred kicks: mean and standard deviation over the seeds.

    Parameters
    ----------
    table : DataFrame
        See `play` and `study`.
    goal_distance : {"near", "far"}

    Returns
    -------
    mean, std : Series, indexed by who and kicks

    Examples
    --------
    >>> mean, std = mean_curves(load_study(), "near")
    >>> bool(mean["ARKAQ"].iloc[-1] > mean["random actions"].iloc[-1] + 20)
    True
    """
    chosen = table[table.goal_distance == goal_distance]
    rate = (100 * chosen.goals / BLOCK).groupby([chosen.who, chosen.kicks])
    return rate.mean(), rate.std(ddof=0)


def rates(table: pd.DataFrame, last: int = 200) -> pd.DataFrame:
    """Return the percentage of kicks that scored, seed by seed.

    Parameters
    ----------
    table : DataFrame
        See `play` and `study`.
    last : int
        How many of the last kicks count for the agent that learns, at least a row's 50. For the
        others all kicks count.

    Returns
    -------
    DataFrame
        One row a seed; columns (goal_distance, who).

    Examples
    --------
    >>> mean = rates(load_study()).mean()
    >>> bool(mean["near", "ARKAQ"] > mean["near", "random actions"] + 20)
    True

    From far, one run does not end well.

    >>> int((rates(load_study())["far", "ARKAQ, learned"] < 28).sum())
    1
    """
    end = table.groupby(["goal_distance", "who", "seed"]).kicks.transform("max")
    last = _checks.integer("last", last, BLOCK)
    counted = table[(table.who != "ARKAQ") | (table.kicks > end - last)]
    share = 100 * counted.groupby(["seed", "goal_distance", "who"]).goals.mean() / BLOCK
    return share.unstack(["goal_distance", "who"])


def seed_runs(seed: int, plan: Plan) -> list[Any]:
    """Return all runs of one seed as joblib's delayed tasks, each of which gives `Measured`."""
    return [
        delayed(kept)(_stream, "goal-stream", seed, plan),
        *(delayed(kept)(_training, f"goal-{name}", seed, plan, name) for name in _DISTANCES),
    ]


def _stream(seed: int, plan: Plan) -> dict[str, float]:
    n = (plan.goal_learning or TrainingSettings.goal()).patterns
    X = goal.patterns(goal.record_sightings(n, seed))
    counts = count_centers(X, goal.VIGILANCES)
    return {f"goal centers, vigilance {rho:g}": float(n) for rho, n in counts.items()}


def _training(seed: int, plan: Plan, distance: Distance) -> dict[str, Any]:
    """Train an agent, and return its curve, as in `play`, and how often who scores."""
    agent = goal.train(
        seed,
        goal_distance=distance,
        learning=plan.goal_learning,
        checkpoint=checkpoint(plan.folder, "goal", distance, seed),
        progress=False,
    )
    learning = scored_while_learning(agent)
    kicks, fresh = min(KICKS[distance], len(learning)), max(plan.episodes, BLOCK)
    scored = _scored(agent, seed, distance, kicks, fresh)
    share = {who: 100 * float(goals.mean()) for who, goals in scored.items()}
    first = {who: 100 * float(goals[:100].mean()) for who, goals in scored.items()}
    grown = 100 * float(learning[-200:].mean()) - first["ARKAQ"]
    return {
        f"goals (%), {distance}, ARKAQ": share["ARKAQ, learned"],
        f"goals (%), {distance}, random actions": share["random actions"],
        f"goals (%), {distance}, planner that sees the truth": share["oracle"],
        f"goals in the first 100 kicks (%), {distance}: ARKAQ minus random actions": (
            first["ARKAQ"] - first["random actions"]
        ),
        f"goals (%), {distance}: the last 200 kicks minus the first 100": grown,
        f"states, ARKAQ that scores, {distance}": float(agent.art.n_clusters_),
        f"curve, {distance}": _curves(seed, distance, scored).to_numpy().tolist(),
    }


def curves(measured: Iterable[Measured]) -> pd.DataFrame:
    """Return the curves of many runs, as `study` does.

    Examples
    --------
    >>> curves([(7, {"x": 1.0, "curve, near": [["near", 7, "ARKAQ", 50, 20]]})]).values.tolist()
    [['near', 7, 'ARKAQ', 50, 20]]
    """
    rows = [
        row
        for _, values in measured
        for name, value in values.items()
        if name.startswith("curve, ")
        for row in value
    ]
    return pd.DataFrame(rows, columns=COLUMNS).sort_values(
        COLUMNS[:2], ascending=[False, True], kind="stable", ignore_index=True
    )
