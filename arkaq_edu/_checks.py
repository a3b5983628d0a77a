"""The gate: every number that enters the package is checked here, by one rule.

A refusal names the argument, what was given and what is allowed. The rule for numbers:

- a number is real and finite, and its magnitude is at most `LARGEST`;
- text is not a number, even if it looks like one; nor is a date or a complex number;
- a masked entry (``numpy.ma``), a NaN and a ``pandas.NA`` are the same thing: a missing number.
  They are allowed only where the documentation says so.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Larger magnitudes are refused, so that no method has to guard its products against overflow.
LARGEST = 1e100

#: Tables of more bytes than this are refused: they are typing errors, not plans.
MOST_BYTES = 2**31

#: So many numbers are checked faster one by one than as an array.
FEW = 16

#: Larger integers do not fit a table of int64.
MOST_INTEGER = 2**63 - 1

_MOST_SHOWN = 60  # characters of a value in a message

_T = TypeVar("_T")


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

    Infinity is allowed only where it is a bound that was asked for, as in a temperature
    in (0, inf].

    Examples
    --------
    >>> number("vigilance", 0.1, 0, 1, open_low=True)
    0.1
    >>> number("vigilance", -2, 0, 1, open_low=True)
    Traceback (most recent call last):
    ValueError: vigilance must be a number in (0, 1], got -2
    """
    x = value if type(value) is float else _real(value)
    unbounded = low == -math.inf and high == math.inf
    inside = (low < x if open_low else low <= x) and (x < high if open_high else x <= high)
    if not inside or (unbounded and math.isinf(x)):  # NaN is inside nothing
        left, right = "(" if open_low else "[", ")" if open_high else "]"
        allowed = "a finite number" if unbounded else f"a number in {left}{low:g}, {high:g}{right}"
        raise ValueError(f"{name} must be {allowed}, got {shown(value)}")
    if abs(x) > LARGEST and not math.isinf(x):
        raise ValueError(f"{name} must be at most {LARGEST:g} in magnitude, got {shown(value)}")
    return x


def _real(value: Any) -> float:
    """Return one real number as a float, and NaN for all that is not one."""
    if isinstance(value, np.ndarray):
        value = value.item() if value.ndim == 0 and not np.ma.is_masked(value) else None
    if isinstance(value, (str, bytes, np.complexfloating, np.datetime64, np.timedelta64)):
        return math.nan
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan


def integer(name: str, value: Any, low: int = 0, high: int | None = None) -> int:
    """Return `value` as an int in [low, high], or raise ``ValueError``.

    Arrays without axes and arrays of one element are integers too, as environments hand them out.

    Examples
    --------
    >>> integer("action", np.array([2]), 0, 3)
    2
    >>> integer("n_states", 2.5, 1)
    Traceback (most recent call last):
    ValueError: n_states must be an integer >= 1, got 2.5
    """
    if type(value) is int and low <= value <= (MOST_INTEGER if high is None else high):
        return value
    if isinstance(value, np.ndarray) and value.size == 1 and not np.ma.is_masked(value):
        value = value.item()
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_integer or not low <= value <= (MOST_INTEGER if high is None else high):
        allowed = f">= {low}" if high is None else f"in [{low}, {high}]"
        raise ValueError(f"{name} must be an integer {allowed}, got {shown(value)}")
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
    n_axes(name, value)
    x = np.asarray(value)
    if np.ma.is_masked(value):
        raise ValueError(f"{name} must hold integers, got a masked array")
    if x.size and x.dtype.kind not in "iu":
        raise ValueError(f"{name} must hold integers, got {shown(value)}")
    most = MOST_INTEGER if high is None else high
    if x.size and not low <= x.min() <= x.max() <= most:
        where = tuple(int(i) for i in np.argwhere((x < low) | (x > most))[0])
        allowed = f">= {low}" if high is None else f"in [{low}, {high}]"
        raise ValueError(f"{name} must hold integers {allowed}, got {x[where]} at {where}")
    return x.astype(np.int64, copy=False)


def array(
    name: str,
    value: ArrayLike,
    shape: tuple[int | None, ...] | None,
    *,
    allow_nan: bool = False,
    allow_minus_infinity: bool = False,
) -> NDArray[np.float64]:
    """Return `value` as a float64 array of `shape` (``None`` stands for any length, or any shape).

    With `allow_nan` a missing entry is returned as NaN. With `allow_minus_infinity` an entry may
    be -inf, which marks an action that is not allowed.

    Examples
    --------
    >>> array("Q", [[1, 0]], (2, 2))
    Traceback (most recent call last):
    ValueError: Q must have shape (2, 2), got (1, 2)
    >>> array("Z", np.ma.masked_equal([3.0, -1.0], -1.0), (2,), allow_nan=True)
    array([ 3., nan])
    """
    if type(value) is np.ndarray and value.dtype.kind in "biuf":  # nothing is masked or text
        x = value.astype(np.float64, copy=False)
    elif isinstance(value, (tuple, list)) and all(type(entry) is float for entry in value):
        x = np.array(value, dtype=np.float64)
    else:
        x = _floats(name, value)
    fits = (
        shape is None
        or x.shape == shape
        or (
            x.ndim == len(shape)
            and all(want is None or want == have for want, have in zip(shape, x.shape, strict=True))
        )
    )
    if not fits:
        wanted = str(tuple("any" if s is None else s for s in shape or ())).replace("'any'", "any")
        raise ValueError(f"{name} must have shape {wanted}, got {x.shape}")
    # The norm is at least as large as each entry, and not <= anything if one is NaN.
    if x.size <= FEW and math.hypot(*x.ravel().tolist()) <= LARGEST:
        return x
    # A NaN compares as False, so a missing entry is not "too large".
    good = ~(np.abs(x) > LARGEST) if allow_nan else np.abs(x) <= LARGEST
    if allow_minus_infinity:
        good |= x == -np.inf
    if np.count_nonzero(good) < x.size:  # faster than good.all() on a small array
        where = tuple(int(i) for i in np.argwhere(~good)[0])
        allowed = "finite numbers" + " or NaN" * allow_nan + " or -inf" * allow_minus_infinity
        if math.isfinite(x[where]):
            allowed = f"numbers of at most {LARGEST:g} in magnitude"
        raise ValueError(f"{name} must hold {allowed}, got {x[where]} at {where}")
    return x


def n_axes(name: str, value: ArrayLike) -> int:
    """Return the number of axes of an array, or refuse what has no one shape.

    Examples
    --------
    >>> n_axes("b", [[0.5, 0.5]])
    2
    >>> n_axes("b", [[1.0], [0.5, 0.5]])
    Traceback (most recent call last):
    ValueError: b must be an array of numbers, got [[1.0], [0.5, 0.5]]
    """
    if isinstance(value, (int, float, np.ndarray)):
        return np.ndim(value)  # it cannot be ragged, and to silence a warning takes longer
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # NumPy says that a mask becomes NaN
            return np.ndim(value)
    except ValueError:
        raise ValueError(f"{name} must be an array of numbers, got {shown(value)}") from None


def _floats(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return `value` as a float64 array in which every missing entry is NaN."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # NumPy says that a mask becomes NaN
            x = value if isinstance(value, np.ndarray) else np.asarray(value)
        if x.dtype.kind not in "biufO":
            raise TypeError
        if type(x) is np.ndarray and x.dtype.kind != "O":
            return x.astype(np.float64)
        if x.dtype.kind == "O":  # mixed entries: missing ones become NaN, text is refused
            entries = [_entry(entry) for entry in np.ma.filled(x, np.nan).flat]
            return np.array(entries, dtype=np.float64).reshape(x.shape)
        return np.asarray(np.ma.filled(np.ma.asarray(x).astype(np.float64), np.nan))
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be an array of numbers, got {shown(value)}") from None


def _entry(entry: Any) -> float:
    """Return one entry of an array of objects as a float."""
    if isinstance(entry, (str, bytes, complex)) or np.ndim(entry):
        raise TypeError
    missing = entry is None or type(entry).__name__ in ("NAType", "MaskedConstant")
    return math.nan if missing else float(entry)


def covariance(name: str, value: ArrayLike, n: int, *, stack: bool = False) -> NDArray[np.float64]:
    """Return `value` as a symmetric positive semi-definite (n, n) matrix, or a stack (T, n, n).

    Examples
    --------
    >>> covariance("R", [[1.0, 0.0], [0.0, -4.0]], 2)
    Traceback (most recent call last):
    ValueError: R must be a covariance (positive semi-definite), got an eigenvalue of -4
    >>> covariance("R", [[[1.0]], [[-4.0]]], 1, stack=True)
    Traceback (most recent call last):
    ValueError: R must be a covariance (positive semi-definite), got an eigenvalue of -4 in row 1
    """
    x = array(name, value, (None, n, n) if stack else (n, n))
    if x.size == 0:
        return x
    variances = x.diagonal(0, -2, -1)
    if np.count_nonzero(x) == np.count_nonzero(variances > 0):
        return x  # a diagonal shows its eigenvalues
    transposed = x.swapaxes(-2, -1)
    scale = np.maximum(np.abs(x).max(axis=(-2, -1)), np.finfo(float).tiny)
    gaps = np.abs(x - transposed)
    uneven = gaps.max(axis=(-2, -1)) > 1e-9 * scale
    if uneven.any():
        row = int(np.argmax(uneven)) if stack else ()
        i, j = (int(k) for k in np.unravel_index(gaps[row].argmax(), (n, n)))
        raise ValueError(
            f"{name} must be a covariance (symmetric), got {x[row][i, j]:g} at ({i}, {j}) "
            f"and {x[row][j, i]:g} at ({j}, {i}){f' in row {row}' if stack else ''}"
        )
    x = (x + transposed) / 2
    lowest = np.linalg.eigvalsh(x)[..., 0]
    negative = lowest < -1e-9 * scale
    if negative.any():
        row = int(np.argmax(negative)) if stack else ()
        raise ValueError(
            f"{name} must be a covariance (positive semi-definite), got an eigenvalue of "
            f"{lowest[row]:g}{f' in row {row}' if stack else ''}"
        )
    return x


def distribution(
    name: str, value: ArrayLike, shape: tuple[int | None, ...] | None = None, *, axis: int = -1
) -> NDArray[np.float64]:
    """Return `value` as probabilities of `shape` that are >= 0 and sum to one along `axis`.

    Sums are allowed to miss 1 by the square root of the precision of the given type (1.5e-8 for
    float64, 3.5e-4 for float32). What is returned is divided by its sum, and what was returned once
    is returned unchanged.

    Examples
    --------
    >>> distribution("b", np.float32([0.1, 0.2, 0.7])).sum()
    np.float64(1.0)
    >>> distribution("b", [0.5, 0.6])
    Traceback (most recent call last):
    ValueError: b must sum to 1 along its last axis, got 1.1
    """
    x = array(name, value, shape)
    if (x < 0).any():
        where = tuple(int(i) for i in np.argwhere(x < 0)[0])
        raise ValueError(f"{name} must hold probabilities >= 0, got {x[where]} at {where}")
    sums = x.sum(axis=axis, keepdims=True)
    off = np.abs(sums - 1) > _slack(value)
    if off.any():
        which = "its last axis" if axis == -1 else f"axis {axis}"
        row = tuple(int(i) for i in np.argwhere(off.squeeze(axis))[0])
        place = f" at {row}" if row else ""
        got = f"{float(np.asarray(sums.squeeze(axis))[row]):.10g}"
        raise ValueError(f"{name} must sum to 1 along {which}, got {got}{place}")
    rough = _rough(sums, np.count_nonzero(x, axis=axis, keepdims=True))
    return x / np.where(rough, sums, 1) if rough.any() else x


def _slack(value: Any) -> float:
    """Return how far the sums of some probabilities may be from 1."""
    dtype = value.dtype if hasattr(value, "dtype") else np.asarray(value).dtype
    return math.sqrt(np.finfo(dtype if dtype.kind == "f" else np.float64).eps)


def _rough(sums: NDArray[np.float64], counts: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which sums of so many probabilities are further from 1 than rounding explains.

    A single probability has to be exactly 1, for a state that is never left is known by it.
    """
    return np.abs(sums - 1) > np.where(counts == 1, 0, np.finfo(float).eps * counts)


def transitions(
    name: str, value: Any, shape: tuple[int | None, int | None, int | None]
) -> NDArray[np.float64] | tuple[Any, ...]:
    """Return distributions for each action and state, as an array or as a tuple of sparse matrices.

    Parameters
    ----------
    name : str
        The name of the argument.
    value : array_like of shape (A, S, N), or a list of A scipy.sparse matrices of shape (S, N)
        The distributions.
    shape : tuple of int or None
        The shape that is asked for; ``None`` stands for any length of at least 1.

    Returns
    -------
    ndarray, or tuple of scipy.sparse.csr_array
        A copy; sparse if `value` was.

    Examples
    --------
    >>> from scipy.sparse import eye_array
    >>> [stay] = transitions("T", [eye_array(3)], (1, 3, 3))
    >>> stay.shape, stay.nnz
    ((3, 3), 3)
    """
    if not (isinstance(value, (list, tuple)) and any(hasattr(M, "tocsr") for M in value)):
        if n_axes(name, value) and 0 in np.shape(value):
            raise ValueError(f"{name} must have no axis of length 0, got shape {np.shape(value)}")
        return distribution(name, value, shape).copy()
    from scipy.sparse import csr_array

    matrices: list[Any] = []
    for a, M in enumerate(value):
        given = (len(value), *np.shape(M))
        wanted = (shape[0], *(shape[1:] if not matrices else matrices[0].shape))
        fits = len(given) == 3 and all(
            n > 0 and want in (None, n) for want, n in zip(wanted, given, strict=True)
        )
        if not fits:
            asked = str(tuple("any" if n is None else n for n in wanted)).replace("'any'", "any")
            raise ValueError(f"{name} must have shape {asked}, got {given}")
        rows = csr_array(M) if hasattr(M, "tocsr") else csr_array(np.asarray(M))
        slack = _slack(rows)
        data = array(f"{name}[{a}]", rows.data, (None,))
        rows = csr_array((data, rows.indices, rows.indptr), rows.shape, copy=True)
        rows.sum_duplicates()
        rows.eliminate_zeros()
        if (rows.data < 0).any():
            raise ValueError(f"{name} must hold probabilities >= 0, got {rows.data.min()} for {a}")
        sums, counts = rows.sum(axis=1), np.diff(rows.indptr)
        if (np.abs(sums - 1) > slack).any():
            s = int(np.argmax(np.abs(sums - 1) > slack))
            raise ValueError(
                f"{name} must sum to 1 along its last axis, got {sums[s]:.10g} at {(a, s)}"
            )
        rows.data /= np.repeat(np.where(_rough(sums, counts), sums, 1), counts)
        matrices.append(rows)
    return tuple(matrices)


def generator(name: str, value: Any) -> np.random.Generator:
    """Return a random generator made from a seed, or the generator that was given.

    Examples
    --------
    >>> int(generator("rng", 0).integers(100))
    85
    >>> generator("rng", -1)
    Traceback (most recent call last):
    ValueError: rng must be a numpy Generator, an integer >= 0 or None, got -1
    """
    if isinstance(value, np.random.Generator):
        return value
    if value is not None:
        try:
            value = integer(name, value)
        except ValueError:
            raise ValueError(
                f"{name} must be a numpy Generator, an integer >= 0 or None, got {shown(value)}"
            ) from None
    return np.random.default_rng(value)


def seed(name: str, value: Any) -> int | None:
    """Return `value` as the seed of an environment: an integer >= 0, or None.

    Examples
    --------
    >>> seed("seed", np.int64(3)), seed("seed", None)
    (3, None)
    """
    return None if value is None else integer(name, value)


def choice(name: str, value: Any, allowed: Iterable[str]) -> str:
    """Return `value` if it is one of the `allowed` names, or raise ``ValueError``.

    Examples
    --------
    >>> choice("placement", "aera", ["area", "thesis"])
    Traceback (most recent call last):
    ValueError: placement must be 'area' or 'thesis', got 'aera'
    """
    names = list(allowed)
    if not (isinstance(value, str) and value in names):
        raise ValueError(f"{name} must be {' or '.join(map(repr, names))}, got {shown(value)}")
    return value


def instance(name: str, value: Any, kind: type[_T]) -> _T:
    """Return `value` if it is an instance of `kind`, or raise ``ValueError``.

    Examples
    --------
    >>> instance("blurs", "no", bool)
    Traceback (most recent call last):
    ValueError: blurs must be of the class bool, got 'no'
    """
    if not isinstance(value, kind):
        raise ValueError(f"{name} must be of the class {kind.__name__}, got {shown(value)}")
    return value


def affordable(name: str, shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return the `shape` of a table of float64, or refuse it where it is larger than memory.

    Examples
    --------
    >>> affordable("n_states and n_actions", (10**9, 2))
    Traceback (most recent call last):
    ValueError: n_states and n_actions must need at most 2,147,483,648 bytes, got 16,000,000,000 \
bytes for a table of 1000000000 x 2
    """
    size = 8 * math.prod(shape)
    if size > MOST_BYTES:
        table = " x ".join(map(str, shape))
        raise ValueError(
            f"{name} must need at most {MOST_BYTES:,} bytes, got {size:,} bytes "
            f"for a table of {table}"
        )
    return shape


def shown(value: Any) -> str:
    """Return `value` for a message, cut where it is long.

    Examples
    --------
    >>> shown("a" * 100)
    "'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa..."
    """
    try:
        text = " ".join(repr(value).split())
    except Exception as error:  # a huge integer, or an object that cannot describe itself
        text = f"<{type(value).__name__}: {error}>"
    return text if len(text) <= _MOST_SHOWN else text[: _MOST_SHOWN - 3] + "..."
