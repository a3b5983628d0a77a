"""The search for a recipe that gives the thesis's five counts of centers (figures 5.10 to 5.14).

The thesis gives neither the update factor eta nor the number of patterns. The search tries both on
streams of sightings of the ball. No recipe comes nearer to all five counts than 13 %, because they
do not fit one stream; with a number of patterns of its own, each count is reached exactly.

Examples
--------
>>> eta, patterns, worst = nearest(load_search())
>>> eta, patterns, 10 < worst < 16
(0.6, 6500, True)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.art import EuclideanART
from arkaq_edu.experiments import approach
from arkaq_edu.experiments.claims import thesis_numbers
from arkaq_edu.experiments.streams import VIGILANCES

#: The update factors and the numbers of patterns of the stored search.
ETAS = tuple(np.round(np.arange(0.1, 1.01, 0.1), 2).tolist())
PATTERNS = (3000, 4000, 5000, 6000, 6500, 7000, 8000, 10_000, 15_000, 20_000, 30_000)


def search(
    etas: Sequence[float] = ETAS, patterns: Sequence[int] = PATTERNS, seeds: int = 3
) -> pd.DataFrame:
    """Count the centers that each recipe founds.

    Parameters
    ----------
    etas : sequence of float
        Update factors of eq 4.6, each in (0, 1].
    patterns : sequence of int
        Numbers of patterns, each at least 1.
    seeds : int
        Number of streams; each has a seed of its own.

    Returns
    -------
    DataFrame
        One row for each eta, number of patterns and vigilance: centers, the mean over the streams.

    References
    ----------
    Thesis 4.2.2 and 5.2.1, figures 5.10 to 5.14.

    Examples
    --------
    >>> search([0.6], [50, 100], seeds=1).groupby("patterns").centers.sum().is_monotonic_increasing
    True
    """
    stops = sorted(_checks.integers("patterns", patterns, 1).tolist())
    rows = []
    for seed in range(_checks.integer("seeds", seeds, 1)):
        X = approach.patterns(approach.record_sightings(stops[-1], seed))
        for eta in etas:
            for vigilance in VIGILANCES:
                network, begin = EuclideanART(vigilance, eta), 0
                for stop in stops:
                    network.partial_fit(X[begin:stop])
                    begin = stop
                    rows.append((eta, stop, vigilance, network.n_clusters_))
    found = pd.DataFrame(rows, columns=["eta", "patterns", "vigilance", "centers"])
    keys = ["eta", "patterns", "vigilance"]
    return found.groupby(keys, sort=False).centers.mean().round(1).reset_index()


def load_search() -> pd.DataFrame:
    """Return the search that comes with the course: ``search()``.

    Examples
    --------
    >>> load_search().columns.tolist()
    ['eta', 'patterns', 'vigilance', 'centers']
    """
    return pd.read_csv(data_file("center_search.csv"))


def misses(found: pd.DataFrame) -> pd.DataFrame:
    """Return how far each recipe is from the count that it misses most.

    Parameters
    ----------
    found : DataFrame
        See `search`.

    Returns
    -------
    DataFrame
        Largest difference from the thesis (%), one row an eta, one column a number of patterns.

    Examples
    --------
    >>> found = pd.DataFrame({"eta": 0.5, "patterns": 9, "vigilance": [0.15, 0.1],
    ...                       "centers": [137, 222]})
    >>> float(misses(found).loc[0.5, 9].round(1))
    33.3
    """
    printed = found.vigilance.map(_printed)
    off = (100 * (found.centers / printed - 1)).abs()
    return off.groupby([found.eta, found.patterns]).max().unstack()


def nearest(found: pd.DataFrame) -> tuple[float, int, float]:
    """Return the eta and the number of patterns that miss least, and by how much (%)."""
    table = misses(found).stack()
    eta, patterns = table.idxmin()
    return float(eta), int(patterns), float(table.min())


def needed(found: pd.DataFrame, eta: float) -> pd.Series:
    """Return the number of patterns with which each vigilance would give the thesis's count.

    Parameters
    ----------
    found : DataFrame
        See `search`. Numbers between those of the search are interpolated.
    eta : float
        One of the search's.

    Returns
    -------
    Series
        Indexed by vigilance; NaN where no number in the search's range does.

    Examples
    --------
    >>> needed(load_search(), 0.6).index.tolist()
    [0.15, 0.1, 0.075, 0.05, 0.025]
    """
    own = found[np.isclose(found.eta, eta)]
    if own.empty:
        raise ValueError(f"eta must be one of {sorted(found.eta.unique())}, got {eta}")
    stops = {}
    for vigilance in VIGILANCES:
        part = own[own.vigilance == vigilance].sort_values("patterns")
        stops[vigilance] = np.interp(
            _printed(vigilance), np.maximum.accumulate(part.centers), part.patterns, np.nan, np.nan
        )
    return pd.Series(stops, name="patterns").rename_axis("vigilance")


def _printed(vigilance: float) -> float:
    return thesis_numbers()[f"centers, vigilance {vigilance:g}"]
