"""How the checks of the exercises write numbers, shapes and inputs."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import shown

_WIDEST = 90  # characters of a line of inputs


def as_floats(answer: Any) -> NDArray[np.float64] | None:
    """Return an answer as floats, or None for text, complex numbers and what has no one shape."""
    try:
        found = np.asarray(answer)
        return found.astype(float) if found.dtype.kind in "biufO" else None
    except (TypeError, ValueError, OverflowError):
        return None


def in_words(shape: tuple[int, ...]) -> str:
    """Return the shape of an array as a student would say it.

    Examples
    --------
    >>> in_words(()), in_words((1,)), in_words((2,)), in_words((3, 4))
    ('one number', 'an array with one number', '2 numbers', '3 rows of 4 numbers')
    """
    if shape == ():
        return "one number"
    if shape == (1,):
        return "an array with one number"
    if len(shape) == 1:
        return f"{shape[0]} numbers"
    if len(shape) == 2:
        rows, columns = shape
        return f"{rows} row{'s' * (rows != 1)} of {columns} number{'s' * (columns != 1)}"
    return f"an array of {' x '.join(map(str, shape))} numbers"


def short(value: Any, indent: int = 0) -> str:
    """Return a value in a few digits.

    Examples
    --------
    >>> short(np.float64(1882.1512)), short(3), short(np.array([0.25, 1 / 3]))
    ('1882', '3', '[0.25, 0.333]')
    """
    if isinstance(value, np.random.Generator):
        return "rng"
    if isinstance(value, np.ndarray) and value.ndim:
        return np.array2string(
            value, threshold=40, edgeitems=2, separator=", ", prefix=" " * indent,
            formatter={"float_kind": lambda x: f"{x:.3g}"},
        )  # fmt: skip
    if isinstance(value, float | np.ndarray | np.floating):
        number = float(value)
        return str(int(number)) if number.is_integer() and abs(number) < 1e6 else f"{number:.4g}"
    return shown(value.item() if isinstance(value, np.generic) else value)


def given(signature: inspect.Signature, case: tuple[Any, ...]) -> str:
    """Return the inputs of one try: in one line if they fit, else each in its own.

    Examples
    --------
    >>> print(given(inspect.signature(lambda b, T: b @ T), (np.ones(2), np.eye(2))))
        b = [1, 1]
        T = [[1, 0],
             [0, 1]]
    """
    pairs = zip(signature.parameters, case, strict=False)
    texts = [f"{name} = {short(value, len(name) + 7)}" for name, value in pairs]
    line = ", ".join(texts)
    if "\n" in line or len(line) > _WIDEST:
        line = "\n    ".join(texts)
    return f"    {line}"


def in_shapes(signature: inspect.Signature, case: tuple[Any, ...]) -> str:
    """Return how many numbers each array among the inputs of one try has.

    Examples
    --------
    >>> print(in_shapes(inspect.signature(lambda b, T, n: b @ T), (np.ones(2), np.eye(2), 3)))
        b: 2 numbers; T: 2 rows of 2 numbers
    """
    arrays = [(name, v) for name, v in zip(signature.parameters, case, strict=False) if np.ndim(v)]
    return "    " + "; ".join(f"{name}: {in_words(np.shape(value))}" for name, value in arrays)


def misfit(error: Exception) -> str:
    """Return what to look at if numpy says that two arrays do not fit, or nothing.

    Examples
    --------
    >>> misfit(ZeroDivisionError("division by zero"))
    ''
    """
    if not isinstance(error, ValueError):
        return ""
    if "matmul" in str(error) or "not aligned" in str(error):
        return (
            "In x @ M, x has a number for each row of M; in M @ x, one for each column. Is one of "
            "them on the wrong side, or is the order of the products another one?"
        )
    if "could not be broadcast" in str(error):
        return (
            "Number by number, both need equal shapes, or equal last lengths. b[:, np.newaxis] "
            "makes a column of b, and M.T exchanges the rows and columns of M."
        )
    return ""
