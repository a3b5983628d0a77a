"""Exact solving, bounds of large problems, and the update of a belief.

A. Cassandra's published problems are not part of this project: ``POMDP_FILES=a_folder`` adds them.
pomdp-solve and SARSOP (pomdpsol) are run if they are on the PATH.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from arkaq_edu._paths import course_folder
from arkaq_edu.pomdp import (
    POMDP,
    belief_update,
    problem,
    read_pomdp,
    solve_point_based,
    solve_pomdp,
)
from benchmarks.case import Case, Figure, Growth, Run, installed, timed
from tests.pomdp.large import rock_sample_5_4, tag

#: Horizon and tolerance of published problems that take long, and those left out.
LIMITS: dict[str, tuple[int | None, float]] = {"4x3.95": (8, 1e-6), "shuttle.95": (7, 1e-6)}
#: The gap of the bounds that SARSOP, built on a machine like ours, reached after 8 s.
GAPS = {"hallway": 0.255, "hallway2": 0.686, "tiger-grid": 0.511, "mit": 0.116, "cit": 0.099}
#: So many seconds the bounds may take in a benchmark.
PATIENCE = 60.0


def files() -> list[Path]:
    """Return the problems of the course, and those of the folder POMDP_FILES."""
    folders = [course_folder() / "data" / "pomdp", os.environ.get("POMDP_FILES")]
    paths = [path for folder in folders if folder for path in sorted(Path(folder).iterdir())]
    return [path for path in paths if path.suffix.lower() == ".pomdp"]


def pomdp_solve(path: Path, horizon: int | None, tol: float) -> dict[str, tuple[float, Run]]:
    """Return a run of pomdp-solve. Its tolerance is a change, ours a proved distance from V*."""
    solver = shutil.which("pomdp-solve")
    if not solver:
        return {}

    def run() -> None:
        with tempfile.TemporaryDirectory() as folder:
            command = [solver, "-pomdp", str(path.resolve()), "-epsilon", str(tol)]
            command += ["-o", str(Path(folder, "out")), "-stdout", str(Path(folder, "said"))]
            command += ["-horizon", str(horizon)] if horizon else []
            subprocess.run(command, stderr=subprocess.DEVNULL, check=True)

    return {"pomdp-solve": (1, run)}


def trees() -> dict[str, tuple[float, Run]]:
    """Return pomdp-py's search through all policy trees of the tiger, from one belief."""
    if not installed("pomdp_py"):
        return {}
    import pomdp_py
    from pomdp_py.problems.tiger.tiger_problem import TigerProblem

    agent = TigerProblem.create("tiger-left", 0.5, 0.15).agent
    search = pomdp_py.ValueIteration(horizon=3, discount_factor=problem("tiger").gamma)
    return {"pomdp-py (from one belief)": (1, lambda: search.plan(agent))}


def updates() -> Iterator[Case]:
    rng = np.random.default_rng(0)
    for S in (2, 5, 12, 36):
        T, O = rng.dirichlet(np.ones(S), (3, S)), rng.dirichlet(np.ones(4), (3, S))  # noqa: E741
        pomdp = POMDP(T, O, np.zeros((S, 3)), 0.9)
        b = belief_update(pomdp, pomdp.start, 0, 0)

        def one_line(b=b, T=T, O=O) -> np.ndarray:  # noqa: E741
            joint = O[0, :, 0] * (b @ T[0])
            return joint / joint.sum()

        yield Case(
            f"belief_update, {S} states", "update", 1,
            lambda pomdp=pomdp, b=b: belief_update(pomdp, b, 0, 0),
            {"limit (one line of numpy)": (1, one_line)}, {"limit (one line of numpy)": 0.5},
        )  # fmt: skip


def bounds() -> Iterator[Figure]:
    """Yield what the bounds reach; the search stops early where it has reached it."""
    solve_point_based(problem("tiger"))  # compile, or load from the cache
    for name, make in (("Tag", tag), ("RockSample(5,4)", rock_sample_5_4)):
        pomdp = make()
        yield Figure(
            f"first bounds, {name}", "s",
            lambda pomdp=pomdp: timed(lambda: solve_point_based(pomdp, max_backups=0)), at_most=2.0,
        )  # fmt: skip

    def lower_bound_of_tag() -> float:
        pomdp = tag()
        return solve_point_based(pomdp, 4.2, 10**9, PATIENCE).lower.value(pomdp.start)

    def gap_of_rock_sample() -> float:
        found = solve_point_based(rock_sample_5_4(), 1.0, 10**9, PATIENCE)
        return 100 * found.gap / found.upper(found.start)

    yield Figure(f"lower bound, Tag, {PATIENCE:.0f} s", "", lower_bound_of_tag, at_least=-6.4)
    title = f"gap, RockSample(5,4), {PATIENCE:.0f} s"
    yield Figure(title, "%", gap_of_rock_sample, at_most=15.0)
    for path in files():
        if path.stem.lower() in GAPS:
            yield Figure(
                f"gap, {path.stem}, {PATIENCE:.0f} s (SARSOP after 8 s)", "",
                lambda path=path: solve_point_based(
                    read_pomdp(path), GAPS[path.stem.lower()], 10**9, PATIENCE
                ).gap,
                at_most=GAPS[path.stem.lower()],
            )  # fmt: skip


def world(n_states: int) -> POMDP:
    """Return a random problem with 2 actions and 2 observations."""
    rng = np.random.default_rng(0)
    T, O = rng.dirichlet(np.ones(n_states), (2, n_states)), rng.dirichlet([1, 1], (2, n_states))  # noqa: E741
    return POMDP(T, O, rng.normal(size=(n_states, 2)), 0.9)


def cases() -> Iterator[Case | Figure | Growth]:
    for path in files():
        if path.stem.lower() not in GAPS:
            horizon, tol = LIMITS.get(path.stem, (None, 1e-6))
            pomdp = read_pomdp(path)
            ours = lambda args=(pomdp, horizon, tol): solve_pomdp(*args)  # noqa: E731
            peers = pomdp_solve(path, horizon, tol)
            yield Case(f"solve_pomdp, {path.stem}", "solution", 1, ours, peers)
    title = "solve_pomdp, tiger, 3 steps, every belief"
    yield Case(title, "solution", 1, lambda: solve_pomdp(problem("tiger"), 3), trees())
    yield from updates()
    yield from bounds()
    yield Growth(
        "solve_point_based, 200 backups", "states", [10, 30, 90, 270],
        lambda n: lambda model=world(n): solve_point_based(model, 1e-9, 200),  # noqa: B008
    )  # fmt: skip
