"""Refuse arrays of states and actions that are not integers of the table."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def indices(name: str, value: ArrayLike, low: int, high: int | None) -> NDArray[np.int64]:
    """Return `value` as int64 in [low, high], or raise ``ValueError`` as `integer` does.

    Examples
    --------
    >>> indices("s", [0, -1], 0, 9)
    Traceback (most recent call last):
    ValueError: s must hold integers in [0, 9], got -1 at (1,)
    """
    x = np.asarray(value)
    if x.size and x.dtype.kind not in "iu":
        raise ValueError(f"{name} must hold integers, got dtype {x.dtype}")
    outside = (x < low) if high is None else (x < low) | (x > high)
    if outside.any():
        where = tuple(int(i) for i in np.argwhere(outside)[0])
        allowed = f">= {low}" if high is None else f"in [{low}, {high}]"
        raise ValueError(f"{name} must hold integers {allowed}, got {x[where]} at {where}")
    return x.astype(np.int64)
