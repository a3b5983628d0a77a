"""The reproduction of the thesis: what one of its seeds costs."""

from __future__ import annotations

import time
from collections.abc import Iterator

from arkaq_edu.experiments import approach, goal
from arkaq_edu.experiments.approach.studies import SWEEP_EVERY
from arkaq_edu.experiments.runs import Plan
from benchmarks.case import Figure

#: 30 seeds on two cores should take at most 15 minutes.
SECONDS = 15 * 60 * 2 / 30


def a_seed() -> float:
    """Return the processor time of a seed (s). Only every few seeds sweep over the vigilance."""
    spent = 0.0
    for run, arguments, _ in approach.seed_runs(0, Plan()) + goal.seed_runs(0, Plan()):
        begin = time.process_time()
        _, name, *_ = arguments
        run(*arguments)
        share = SWEEP_EVERY if name.startswith("approach-vigilance") else 1
        spent += (time.process_time() - begin) / share
    return spent


def cases() -> Iterator[Figure]:
    yield Figure("arkaq reproduce, one of 30 seeds", "s of a processor", a_seed, at_most=SECONDS)
