"""Small matrices in compiled code: products, symmetry and the inverse (thesis 4.1).

Each function returns a new array. Sums run in a fixed order, so the same input gives the same bits
on every machine, which a linear algebra library does not promise.
"""

from __future__ import annotations

import math

import numpy as np

from arkaq_edu._compiled import kernel

LOG_2PI = math.log(2 * math.pi)
# If only this fraction of a variance is left once the rows before are known, it is rounding error.
NEGLIGIBLE = 16 * float(np.finfo(np.float64).eps)
# If less than this fraction is left, rounding has taken about half of its digits. The default P0
# leaves more: a second sensor of the same state has about 1e-6 left.
HALF_LOST = 1e-7


@kernel
def mul(A, B):
    """Return the product A B of two matrices."""
    C = np.zeros((A.shape[0], B.shape[1]))
    for i in range(A.shape[0]):
        for k in range(A.shape[1]):
            for j in range(B.shape[1]):
                C[i, j] += A[i, k] * B[k, j]
    return C


@kernel
def vec(A, x):
    """Return the product A x of a matrix and a vector."""
    y = np.zeros(A.shape[0])
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            y[i] += A[i, j] * x[j]
    return y


@kernel
def transpose(A):
    """Return the transpose A' as an array of its own, which `mul` reads faster than a view."""
    B = np.empty((A.shape[1], A.shape[0]))
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            B[j, i] = A[i, j]
    return B


@kernel
def quadratic(A, x):
    """Return the quadratic form x' A x."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += x[i] * A[i, j] * x[j]
    return total


@kernel
def symmetric(P):
    """Return P with its lower triangle replaced by the mirror image of the upper one."""
    for i in range(P.shape[0]):
        for j in range(i):
            P[i, j] = P[j, i]
    return P


@kernel
def without_missing(z):
    """Return z with 0 in place of NaN, and which entries are not NaN."""
    y, seen = np.zeros(len(z)), np.zeros(len(z), np.bool_)
    for i in range(len(z)):
        if not math.isnan(z[i]):
            y[i], seen[i] = z[i], True
    return y, seen


@kernel
def outer(x, y):
    """Return the outer product x y'."""
    A = np.empty((len(x), len(y)))
    for i in range(len(x)):
        for j in range(len(y)):
            A[i, j] = x[i] * y[j]
    return A


@kernel
def inverse(S, seen, negligible):
    """Invert the rows and columns of a covariance that are used; return zeros elsewhere.

    A row is used if it is `seen` and the used rows before it leave more than a `negligible`
    fraction of its variance. So S may be singular.

    Returns
    -------
    S_inverse : ndarray, shape (m, m)
    used : int
        Number of rows used.
    log_det : float
        Logarithm of the determinant of 2 pi S over these rows.
    """
    m = S.shape[0]
    V = S.copy()
    used, log_det = 0, 0.0
    for k in range(m):  # Gauss-Jordan elimination; V[k, k] is the variance that is left in row k
        pivot, ratio = V[k, k], 0.0
        if seen[k] and pivot > negligible * S[k, k]:
            ratio = 1.0 / pivot
            used += 1
            log_det += LOG_2PI + math.log(pivot)
        for i in range(m):
            if i != k:
                for j in range(m):
                    if j != k:
                        V[i, j] -= V[i, k] * ratio * V[k, j]
        for i in range(m):
            V[i, k] *= -ratio
            V[k, i] *= ratio
        V[k, k] = ratio
    return V, used, log_det
