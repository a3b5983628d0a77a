"""Spare a kernel the calls in its innermost loop."""

from collections.abc import Callable
from typing import Any

from arkaq_edu._compiled import HAVE_NUMBA


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` such that kernels take its body over instead of calling it.

    A call costs as much as a few distances, for its arrays have to be counted in and out.
    """
    if not HAVE_NUMBA:
        return function
    from numba import njit

    return njit(inline="always")(function)
