"""One's own patterns: a table of two columns, scaled for an ART network and back."""

from __future__ import annotations

import io
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing

FEWEST, MOST = 3, 200_000  # rows


class Patterns(NamedTuple):
    """Patterns in two dimensions, and what their scaled values stand for.

    Attributes
    ----------
    scaled : ndarray, shape (n, 2)
        In [-1, 1], in the order of the rows.
    names : tuple of two str
        Of the columns.
    low, high : tuple of two float
        What -1 and 1 stand for, in the units of the columns.
    """

    scaled: NDArray[np.float64]
    names: tuple[str, str]
    low: tuple[float, ...]
    high: tuple[float, ...]

    def unscale(self, scaled: ArrayLike) -> NDArray[np.float64]:
        """Return scaled values, shape (..., 2), in the units of the columns.

        Examples
        --------
        >>> read_patterns("x,y\\n0,0\\n10,5\\n5,4").unscale([[-1.0, 1.0]])
        array([[0., 5.]])
        """
        low, high = np.array(self.low), np.array(self.high)
        return low + (np.asarray(scaled) + 1) / 2 * (high - low)

    def to_csv(self, scaled: ArrayLike) -> str:
        """Return scaled values as the text of a csv, in the units of the columns.

        Examples
        --------
        >>> read_patterns("x,y\\n0,0\\n10,5\\n5,4").to_csv([[-1.0, 1.0]])
        'x,y\\n0.0,5.0\\n'
        """
        table = pd.DataFrame(self.unscale(scaled).round(6), columns=list(self.names))
        return table.to_csv(index=False, lineterminator="\n")


def read_patterns(text: str) -> Patterns:
    """Read patterns from the text of a csv.

    Parameters
    ----------
    text : str
        Rows of numbers, with a line of names above them or without. Columns with the names
        distance (mm) and orientation (rad) are scaled as the robot scales them. Otherwise the
        first two columns are taken. They stay as they are if all their values lie in [-1, 1]; if
        not, the smallest value becomes -1 and the largest 1. Rows with a gap are left out, and
        what is out of the robot's view.

    Returns
    -------
    Patterns

    Raises
    ------
    ValueError
        If there are no two columns of numbers, or less than 3 rows, or more than 200,000.

    Examples
    --------
    >>> read_patterns("width,height\\n2,10\\n4,30\\n3,20").scaled.tolist()
    [[-1.0, -1.0], [1.0, 1.0], [0.0, 0.0]]
    >>> read_patterns("distance,orientation\\n2150,0.25\\n200,0\\n4100,-0.5").scaled.tolist()
    [[0.0, 0.5], [-1.0, 0.0], [1.0, -1.0]]
    >>> read_patterns("a b\\nc d")
    Traceback (most recent call last):
    ValueError: patterns must be two columns of numbers, got 'a b\\nc d'
    """
    robot = Sensing.thesis()
    table = _table(text)
    known = {"distance", "orientation"} <= set(table)
    table = table[["distance", "orientation"]] if known else table.iloc[:, :2]
    table = table.replace([np.inf, -np.inf], np.nan).dropna()
    values = table.to_numpy(dtype=float)
    low, high = np.array(robot.low), np.array(robot.high)
    if known:
        values = values[((values >= low) & (values <= high)).all(axis=1)]
    _checks.integer("rows of patterns", len(values), FEWEST, MOST)
    if not known:
        inside = np.abs(values).max() <= 1
        low, high = (
            (-np.ones(2), np.ones(2)) if inside else (values.min(axis=0), values.max(axis=0))
        )
        high = np.where(high > low, high, low + 1)  # a column that never changes
    scaled = (values - low) / (high - low) * 2 - 1
    one, two = (str(name) for name in table)
    return Patterns(scaled, (one, two), tuple(low.tolist()), tuple(high.tolist()))


def _table(text: str) -> pd.DataFrame:
    """Return the columns of numbers, named by the first line or, without names, x and y."""
    try:
        table = pd.read_csv(io.StringIO(text), sep=None, engine="python", skipinitialspace=True)
        nameless = not pd.to_numeric(pd.Series(list(table)), errors="coerce").isna().any()
        if nameless:
            table = pd.read_csv(io.StringIO(text), sep=None, engine="python", header=None)
            table = table.rename(columns={0: "x", 1: "y"})
    except ValueError:  # pandas' words for it name neither the rows nor the rule
        table = pd.DataFrame()
    table = table.select_dtypes("number")
    if table.shape[1] < 2:
        raise ValueError(f"patterns must be two columns of numbers, got {_checks.shown(text[:40])}")
    return table
