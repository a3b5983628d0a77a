"""The few operations on vectors that the networks need, in one fixed order of summation.

NumPy's own sums group their terms by length and processor. These loops do not, so a network gives
the same bytes on every machine, compiled or not.
"""

import math

import numpy as np

from arkaq_edu._compiled import kernel


@kernel
def dot(a, b):
    """Return the dot product of two vectors (equation 4.1)."""
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@kernel
def norm(x):
    """Return the length of a vector."""
    return math.sqrt(dot(x, x))


@kernel
def unit(x):
    """Return `x` scaled to norm 1, and zeros as they are."""
    largest = np.abs(x).max()
    if largest == 0.0:
        return x
    x = x / largest  # so that no square leaves the range of a float
    return x / norm(x)


@kernel
def change(a, b):
    """Return the largest difference between components of two vectors."""
    largest = 0.0
    for i in range(len(a)):
        largest = max(largest, abs(a[i] - b[i]))
    return largest
