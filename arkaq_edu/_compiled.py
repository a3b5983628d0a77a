"""Compile kernels with numba if it is installed; otherwise run them as plain Python.

A kernel is a function that numba compiles at its first call, never at import. The machine code is
cached on disk, so later processes start at once. Set the environment variable
``NUMBA_DISABLE_JIT=1`` to step through a kernel in a debugger.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

try:
    import numba
except ImportError:  # as in a browser's Python, where the same loops run slowly
    numba = None  # type: ignore[assignment]

HAVE_NUMBA = numba is not None


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` compiled (nopython mode, cached on disk), or unchanged without numba.

    Kernels of several threads run at the same time. Floating-point operations keep their order (no
    ``fastmath``), so compiled and plain runs give exactly the same numbers.

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
    # A function typed at a prompt has no file beside which its machine code could be cached.
    cached = os.path.exists(function.__code__.co_filename)
    return numba.njit(cache=cached, nogil=True)(function)


def word_before_compiling(function: Callable[..., Any], what: str) -> None:
    """Say on a terminal that a kernel is about to be compiled, if that takes long.

    In a notebook it says nothing, because the output of a cell must be the same every time.

    Examples
    --------
    >>> word_before_compiling(kernel(lambda x: x), "nothing")
    """
    if not sys.stderr.isatty() or getattr(function, "signatures", True):
        return  # no reader, no numba, or already compiled
    cache = Path(function.stats.cache_path or "")  # type: ignore[attr-defined]
    if not any(cache.glob(f"*{function.__name__}-*.nbi")):
        print(f"Compiling {what}. This happens once and takes about ten seconds.", file=sys.stderr)
