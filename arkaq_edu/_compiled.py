"""Compile a kernel with numba where numba is there; run it as plain Python where it is not.

A kernel is a readable loop: it is the lesson. Numba compiles it at its first call, never at
import, and keeps the machine code in a cache on disk, so that later processes start at once.
Set the environment variable ``NUMBA_DISABLE_JIT=1`` to step through a kernel in a debugger.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

try:
    import numba
except ImportError:  # a browser's Python has none: the same loops then run, slowly
    numba = None  # type: ignore[assignment]

HAVE_NUMBA = numba is not None


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` compiled (nopython mode, cached on disk), or as it is without numba.

    Floating-point arithmetic keeps its order (no ``fastmath``), so compiled and plain runs agree
    to the last bit.

    Examples
    --------
    >>> @kernel
    ... def total(x):
    ...     s = 0.0
    ...     for value in x:
    ...         s += value
    ...     return s
    >>> import numpy as np
    >>> total(np.array([1.0, 2.0, 3.5]))
    6.5
    """
    if numba is None:
        return function
    # What was typed at a prompt has no file beside which the machine code could be kept.
    return numba.njit(cache=os.path.exists(function.__code__.co_filename))(function)


def word_before_compiling(function: Callable[..., Any], what: str) -> None:
    """Say on a terminal that a kernel is about to be compiled, where that takes long.

    In a notebook nothing is said: what a cell shows must be the same every time.

    Examples
    --------
    >>> word_before_compiling(kernel(lambda x: x), "nothing")
    """
    if not sys.stderr.isatty() or getattr(function, "signatures", True):
        return  # nobody to read it, no numba, or compiled already
    cache = Path(function.stats.cache_path or "")  # type: ignore[attr-defined]
    if not any(cache.glob(f"*{function.__name__}-*.nbi")):
        print(f"Compiling {what}, once: this takes some ten seconds.", file=sys.stderr)
