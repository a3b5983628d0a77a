"""From a slider to its picture, as `make latency` has measured it in a browser."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import pandas as pd

from benchmarks.case import Figure

MEASURED = Path("build/latency.csv")


def slowest(column: str) -> Callable[[], float]:
    """Return a function that gives the time of the slowest slider (ms); NaN if there is none."""
    return lambda: pd.read_csv(MEASURED)[column].max() if MEASURED.exists() else math.nan


def cases() -> Iterator[Figure]:
    for column, wanted in (("median", 100.0), ("p90", 150.0)):
        title = f"slider to picture, slowest of all, {column} (make latency)"
        yield Figure(title, "ms", slowest(column), at_most=wanted)
