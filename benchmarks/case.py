"""What a benchmark is, and how it is measured: in turns, with spread.

A round runs ours, the limit and every peer once, so that a busy machine slows all of them alike.
A ratio is the time of the other over ours in the same round. "Limit" is the same arithmetic in one
plain compiled loop, without checks. pyperf holds the values and describes the machine: its own
runner cannot take turns.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import math
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

Run = Callable[[], object]

#: A timing lasts at least so many seconds: what is shorter is repeated within it.
SHORTEST = 0.002
#: A case is measured for so many seconds, in at least `FEWEST` and at most `MOST` rounds.
SECONDS, FEWEST, MOST = 3.0, 5, 41


@dataclass
class Case:
    """A piece of work, done by us and by others.

    `ours` does the work of `size` units. Each of `others` is a run and its number of units, which
    differs where a peer is too slow for all of them. `wanted` says how many times faster than one
    of the others we should be: "limit": 1 / 1.3 is at most 1.3 times slower than the limit.
    """

    title: str
    unit: str
    size: float
    ours: Run
    others: dict[str, tuple[float, Run]]
    wanted: dict[str, float] = field(default_factory=dict)


@dataclass
class Figure:
    """A figure that is not a ratio: a function that returns it, and what is wanted of it."""

    title: str
    unit: str
    measure: Callable[[], float]
    at_most: float = math.inf
    at_least: float = -math.inf


@dataclass
class Growth:
    """How time grows with a size: `make` returns the run for each of `sizes`."""

    title: str
    axis: str
    sizes: Sequence[int]
    make: Callable[[int], Run]
    at_most: float = math.inf  # the exponent that is wanted


@dataclass
class Row:
    """A line of the report. `low` and `high` are the quartiles of the value or the ratio."""

    room: str
    work: str
    who: str
    value: float
    unit: str
    low: float
    high: float
    rounds: int
    ratio: float = math.nan
    wanted: str = ""
    met: str = ""


@dataclass
class Curve:
    """Times against sizes, with the exponent of the line through their logarithms."""

    room: str
    title: str
    axis: str
    sizes: list[int]
    seconds: list[float]
    exponent: float


def timed(run: Run, loops: int = 1) -> float:
    """Return the seconds of a run, without what it prints and warns."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        begin = time.perf_counter()
        for _ in range(loops):
            run()
        return (time.perf_counter() - begin) / loops


def in_turns(runs: dict[str, Run], seconds: float = SECONDS) -> dict[str, Any]:
    """Time all runs in turn, each first once in vain, which may compile it.

    Returns a `pyperf.Benchmark` for each.
    """
    import pyperf  # not in the course's own environment, in which the guard runs

    once = {name: min(timed(run), timed(run)) for name, run in runs.items()}
    loops = {name: max(1, math.ceil(SHORTEST / spent)) for name, spent in once.items()}
    a_round = sum(spent * loops[name] for name, spent in once.items())
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(min(MOST, max(FEWEST, int(seconds / a_round)))):
        for name, run in runs.items():
            times[name].append(timed(run, loops[name]))
    return {
        name: pyperf.Benchmark([pyperf.Run(spent, metadata={"name": name}, collect_metadata=False)])
        for name, spent in times.items()
    }


def compared(room: str, case: Case) -> Iterator[Row]:
    """Measure a case; yield a row for ours and one for each of the others."""
    sizes = {"ours": case.size} | {name: size for name, (size, _) in case.others.items()}
    runs = {"ours": case.ours} | {name: run for name, (_, run) in case.others.items()}
    times = {
        name: np.array(bench.get_values()) / sizes[name] for name, bench in in_turns(runs).items()
    }
    for name, spent in times.items():
        low, high = np.percentile(spent, [25, 75])
        row = Row(
            room, case.title, name, float(np.median(spent)), f"s a {case.unit}", low, high,
            len(spent),
        )  # fmt: skip
        if name != "ours":
            row.ratio = float(np.median(spent / times["ours"]))
        if name in case.wanted:
            row.wanted = f"ratio at least {case.wanted[name]:.3g}"
            row.met = met(row.ratio >= case.wanted[name])
        yield row
    for name in case.wanted.keys() - times.keys():
        row = Row(room, case.title, name, math.nan, "", math.nan, math.nan, 0)
        row.wanted, row.met = f"ratio at least {case.wanted[name]:.3g}", "not installed"
        yield row


def figured(room: str, figure: Figure) -> Row:
    """Measure a figure."""
    value = figure.measure()
    row = Row(room, figure.title, "ours", value, figure.unit, value, value, 1)
    if math.isfinite(figure.at_most):
        row.wanted, row.met = (
            f"at most {figure.at_most:.4g}",
            judged(value, value <= figure.at_most),
        )
    if math.isfinite(figure.at_least):
        row.wanted, row.met = (
            f"at least {figure.at_least:.4g}",
            judged(value, value >= figure.at_least),
        )
    return row


def grown(room: str, growth: Growth) -> tuple[Row, Curve]:
    """Measure how time grows, all sizes in turn."""
    runs = {str(n): growth.make(n) for n in growth.sizes}
    seconds = [bench.median() for bench in in_turns(runs).values()]
    x, y = np.log(growth.sizes), np.log(seconds)
    (slope, _), covariance = np.polyfit(x, y, 1, cov="unscaled")
    error = math.sqrt(covariance[0, 0]) * float(np.std(y - np.polyval(np.polyfit(x, y, 1), x)))
    row = Row(
        room, f"growth: {growth.title}", f"against {growth.axis}", float(slope), "exponent",
        slope - error, slope + error, len(seconds),
    )  # fmt: skip
    if math.isfinite(growth.at_most):
        row.wanted, row.met = f"at most {growth.at_most:.3g}", met(slope <= growth.at_most)
    return row, Curve(room, growth.title, growth.axis, [*growth.sizes], seconds, float(slope))


def met(good: bool) -> str:
    return "met" if good else "missed"


def judged(value: float, good: bool) -> str:
    return "not measured" if math.isnan(value) else met(good)


def installed(module: str) -> bool:
    """Tell whether a peer is there; if not, say so."""
    if importlib.util.find_spec(module) is None:
        print(f"    ({module} is not installed: left out)")
        return False
    return True
