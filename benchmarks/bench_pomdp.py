"""Exact solving of POMDPs, compared with pomdp-solve and pomdp-py.

    python benchmarks/bench_pomdp.py                     the problems of this course
    python benchmarks/bench_pomdp.py a_folder            every .POMDP file in a folder
    POMDP_FILES=a_folder python benchmarks/bench_pomdp.py

A. Cassandra's published problems are not part of this project. They come with his pomdp-solve,
which is run if it is on the PATH. A round runs our solver and the peer once, so that a busy machine
slows both alike, and the ratio is the median of the ratios of the rounds. A problem that takes
longer than SLOW seconds is run once, and one that takes longer than PATIENCE is stopped.

All problems are solved to 1e-6 without a horizon, except for those in LIMITS. For pomdp-solve this
is a change from one step to the next, for us a proved distance from V*. "apart" is the difference
of the two values of the start. pomdp-py tries all policy trees from one belief, so only a short
horizon of the tiger can be compared.

The last rows are the update of a belief beside one line of NumPy, and the bounds for Tag and
RockSample(5,4): at first, and after BOUND seconds.
"""

from __future__ import annotations

import multiprocessing
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import timeit
from collections.abc import Callable
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

sys.path.insert(0, str(course_folder()))
from tests.pomdp.large import rock_sample_5_4, tag

ROUNDS, SLOW, PATIENCE, BOUND = 7, 5.0, 300.0, 60.0
# Horizon and tolerance of published problems that no solver solves to 1e-6 without a horizon.
LIMITS: dict[str, tuple[int | None, float]] = {
    "4x3.95": (8, 1e-6),
    "network": (None, 1e-3),
    "shuttle.95": (7, 1e-6),
}
SOLVER = shutil.which("pomdp-solve")


def seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def pomdp_solve(path: Path, horizon: int | None, tol: float) -> tuple[float, np.ndarray]:
    """Run pomdp-solve; return its seconds and its vectors."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "out")
        command = [str(SOLVER), "-pomdp", str(path.resolve()), "-o", str(out)]
        command += ["-epsilon", str(tol), "-stdout", str(Path(folder, "said"))]
        if horizon is not None:
            command += ["-horizon", str(horizon)]
        took = seconds(lambda: subprocess.run(command, stderr=subprocess.DEVNULL, check=True))
        rows = [line.split() for line in Path(f"{out}.alpha").read_text().splitlines()]
        return took, np.array([row for row in rows if len(row) > 1], dtype=float)


def solve(path: Path) -> None:
    """Time one problem and print its row."""
    pomdp = read_pomdp(path)
    horizon, tol = LIMITS.get(path.stem, (None, 1e-6))
    solve_pomdp(problem("tiger"), 2)  # compile, or load from the cache, before the clock starts
    rounds, peer_runs = [], SOLVER is not None
    while len(rounds) < ROUNDS and not (rounds and max(rounds[-1]) > SLOW):
        start = time.perf_counter()
        V = solve_pomdp(pomdp, horizon, tol)
        rounds.append([time.perf_counter() - start])
        if peer_runs:
            try:
                took, alphas = pomdp_solve(path, horizon, tol)
            except subprocess.CalledProcessError as error:
                peer_runs = False
                print(f"{path.stem}: pomdp-solve itself fails (exit status {error.returncode})")
            else:
                rounds[-1].append(took)
    mine = statistics.median(r[0] for r in rounds)
    steps = f"h={horizon}" if horizon else ""
    print(f"{path.stem:14} {steps:4} {len(V):6} vectors, error {V.error:7.1e} {mine:9.4f} s")
    if peer_runs:
        peer = statistics.median(r[1] for r in rounds)
        ratio = statistics.median(r[1] / r[0] for r in rounds)
        apart = abs(V.value(pomdp.start) - (alphas @ pomdp.start).max())
        name = f"    pomdp-solve, apart {apart:.1e}"
        print(f"{name:46} {peer:9.4f} s   we: {ratio:,.1f} times")


def trees() -> None:
    """Compare with pomdp-py's search through all policy trees."""
    try:
        import pomdp_py
        from pomdp_py.problems.tiger.tiger_problem import TigerProblem
    except ImportError:
        print("pomdp-py is not installed: left out")
        return
    tiger, rounds = problem("tiger"), []
    agent = TigerProblem.create("tiger-left", 0.5, 0.15).agent
    search = pomdp_py.ValueIteration(horizon=3, discount_factor=tiger.gamma)
    for _ in range(ROUNDS):
        ours = seconds(lambda: solve_pomdp(tiger, 3))
        rounds.append((ours, seconds(lambda: search.plan(agent))))
    mine, peer = (statistics.median(r[k] for r in rounds) for k in (0, 1))
    ratio = statistics.median(r[1] / r[0] for r in rounds)
    print(f"{'tiger, 3 steps, from every belief':46} {mine:9.4f} s")
    print(f"{'    pomdp-py, from one':46} {peer:9.4f} s   we: {ratio:,.1f} times")


def updates() -> None:
    """Compare the update of a belief, checks included, with one line of NumPy."""
    rng = np.random.default_rng(0)
    for S in (2, 5, 12, 36):
        T, O = rng.dirichlet(np.ones(S), (3, S)), rng.dirichlet(np.ones(4), (3, S))  # noqa: E741
        pomdp = POMDP(T, O, np.zeros((S, 3)), 0.9)
        b, rounds = belief_update(pomdp, pomdp.start, 0, 0), []

        def one_line(b: np.ndarray, T: np.ndarray = T, O: np.ndarray = O) -> np.ndarray:  # noqa: E741
            joint = O[0, :, 0] * (b @ T[0])
            return joint / joint.sum()

        for _ in range(ROUNDS):
            ours = timeit.timeit(lambda: belief_update(pomdp, b, 0, 0), number=5000)  # noqa: B023
            rounds.append((ours, timeit.timeit(lambda: one_line(b), number=5000)))  # noqa: B023
        mine, line = (statistics.median(r[k] for r in rounds) / 5000 * 1e6 for k in (0, 1))
        ratio = statistics.median(r[1] / r[0] for r in rounds)
        print(f"{f'belief update, {S} states':46} {mine:9.2f} us")
        print(f"{'    one line of numpy':46} {line:9.2f} us  we: {ratio:,.2f} times")


def bounds() -> None:
    """Time the bounds of two large problems."""
    solve_point_based(problem("tiger"))  # compile, or load from the cache
    for name, make in (("tag", tag), ("rock_sample 5,4", rock_sample_5_4)):
        pomdp = make()
        first = seconds(lambda: solve_point_based(pomdp, max_backups=0))  # noqa: B023
        found = solve_point_based(pomdp, max_backups=10**9, seconds=BOUND)
        print(f"{name:16} first bounds {first:6.2f} s; after {BOUND:g} s {found}")


def main(arguments: list[str]) -> None:
    folder = arguments[0] if arguments else os.environ.get("POMDP_FILES")
    where = Path(folder) if folder else course_folder() / "data" / "pomdp"
    paths = sorted(path for path in where.iterdir() if path.suffix.lower() == ".pomdp")
    if not SOLVER:
        print("pomdp-solve is not on the PATH: left out")
    for path in paths:
        child = multiprocessing.Process(target=solve, args=(path,))
        child.start()
        child.join(PATIENCE)
        if child.is_alive():
            child.kill()
            print(f"{path.stem:14} stopped after {PATIENCE:g} s")
    trees()
    updates()
    bounds()


if __name__ == "__main__":
    main(sys.argv[1:])
