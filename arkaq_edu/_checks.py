"""Refuse bad input at the door: what it was called, what came, what is allowed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def number(
    name: str,
    value: Any,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    open_low: bool = False,
    open_high: bool = False,
) -> float:
    """Return `value` as a float inside an interval, or raise ``ValueError``.

    Examples
    --------
    >>> number("vigilance", 0.1, 0, 1, open_low=True)
    0.1
    >>> number("vigilance", -2, 0, 1, open_low=True)
    Traceback (most recent call last):
    ValueError: vigilance must be a number in (0, 1], got -2
    """
    try:
        x = float(value)
    except (TypeError, ValueError):
        x = math.nan
    inside = (low < x if open_low else low <= x) and (x < high if open_high else x <= high)
    unbounded = low == -math.inf and high == math.inf
    if not inside or (unbounded and math.isinf(x)):
        left, right = "(" if open_low else "[", ")" if open_high else "]"
        allowed = "a finite number" if unbounded else f"a number in {left}{low:g}, {high:g}{right}"
        raise ValueError(f"{name} must be {allowed}, got {value!r}")
    return x


def integer(name: str, value: Any, low: int = 0, high: int | None = None) -> int:
    """Return `value` as an int in [low, high], or raise ``ValueError``.

    Examples
    --------
    >>> integer("n_states", 2.5, 1)
    Traceback (most recent call last):
    ValueError: n_states must be an integer >= 1, got 2.5
    """
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_integer or value < low or (high is not None and value > high):
        allowed = f">= {low}" if high is None else f"in [{low}, {high}]"
        raise ValueError(f"{name} must be an integer {allowed}, got {value!r}")
    return int(value)


def integers(
    name: str, value: ArrayLike, low: int = 0, high: int | None = None
) -> NDArray[np.int64]:
    """Return `value` as an int64 array with all entries in [low, high], or raise ``ValueError``.

    Examples
    --------
    >>> integers("s", [0, -1], 0, 9)
    Traceback (most recent call last):
    ValueError: s must hold integers in [0, 9], got -1 at (1,)
    """
    x = np.asarray(value)
    if x.size and x.dtype.kind not in "iu":
        raise ValueError(f"{name} must hold integers, got dtype {x.dtype}")
    if x.size and (x.min() < low or (high is not None and x.max() > high)):
        outside = (x < low) if high is None else (x < low) | (x > high)
        where = tuple(int(i) for i in np.argwhere(outside)[0])
        allowed = f">= {low}" if high is None else f"in [{low}, {high}]"
        raise ValueError(f"{name} must hold integers {allowed}, got {x[where]} at {where}")
    return x.astype(np.int64, copy=False)


def array(
    name: str, value: ArrayLike, shape: tuple[int | None, ...], *, allow_nan: bool = False
) -> NDArray[np.float64]:
    """Return `value` as a float64 array of `shape` (``None`` stands for any length).

    Examples
    --------
    >>> array("Q", [[1, 0]], (2, 2))
    Traceback (most recent call last):
    ValueError: Q must have shape (2, 2), got (1, 2)
    """
    try:
        x = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array of numbers, got {value!r}") from None
    fits = x.shape == shape or (
        x.ndim == len(shape)
        and all(want is None or want == have for want, have in zip(shape, x.shape, strict=True))
    )
    if not fits:
        wanted = str(tuple("any" if s is None else s for s in shape)).replace("'any'", "any")
        raise ValueError(f"{name} must have shape {wanted}, got {x.shape}")
    bad = ~np.isfinite(x) if not allow_nan else np.isinf(x)
    if np.count_nonzero(bad):  # faster than bad.any() on a small array
        where = tuple(int(i) for i in np.argwhere(bad)[0])
        allowed = "finite numbers or NaN" if allow_nan else "finite numbers"
        raise ValueError(f"{name} must hold {allowed}, got {x[where]} at {where}")
    return x


def covariance(name: str, value: ArrayLike, n: int) -> NDArray[np.float64]:
    """Return `value` as a symmetric positive semi-definite (n, n) matrix.

    Examples
    --------
    >>> covariance("R", [[1.0, 0.0], [0.0, -4.0]], 2)
    Traceback (most recent call last):
    ValueError: R must be a covariance (positive semi-definite), got an eigenvalue of -4
    """
    x = array(name, value, (n, n))
    variances = x.diagonal().tolist()
    if min(variances, default=0.0) >= 0 and np.count_nonzero(x) == n - variances.count(0.0):
        return x  # a diagonal shows its eigenvalues
    scale = max(float(np.abs(x).max(initial=0.0)), np.finfo(float).tiny)
    if not np.allclose(x, x.T, rtol=0, atol=1e-9 * scale):
        i, j = (int(k) for k in np.unravel_index(np.abs(x - x.T).argmax(), x.shape))
        raise ValueError(
            f"{name} must be a covariance (symmetric), got {x[i, j]:g} at ({i}, {j}) "
            f"and {x[j, i]:g} at ({j}, {i})"
        )
    x = (x + x.T) / 2
    lowest = float(np.linalg.eigvalsh(x).min()) if n else 0.0
    if lowest < -1e-9 * scale:
        raise ValueError(
            f"{name} must be a covariance (positive semi-definite), got an eigenvalue of {lowest:g}"
        )
    return x


def distribution(name: str, value: ArrayLike, *, axis: int = -1) -> NDArray[np.float64]:
    """Return `value` as probabilities that are >= 0 and sum to one along `axis`.

    Examples
    --------
    >>> distribution("b", [0.5, 0.6])
    Traceback (most recent call last):
    ValueError: b must sum to 1 along its last axis, got 1.1
    """
    x = array(name, value, (None,) * np.ndim(value))
    if (x < 0).any():
        where = tuple(int(i) for i in np.argwhere(x < 0)[0])
        raise ValueError(f"{name} must hold probabilities >= 0, got {x[where]} at {where}")
    sums = x.sum(axis=axis)
    off = np.abs(sums - 1) > 1e-9
    if off.any():
        which = "its last axis" if axis == -1 else f"axis {axis}"
        row = tuple(int(i) for i in np.argwhere(off)[0])
        place = f" at {row}" if row else ""
        got = f"{float(np.asarray(sums)[row]):.10g}"
        raise ValueError(f"{name} must sum to 1 along {which}, got {got}{place}")
    return x
