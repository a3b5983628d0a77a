"""The loops of the Kalman filter: the equations of thesis section 2.5, one line of maths a loop.

Every array is C-contiguous float64 and written in place, so each kernel has one signature and a
step allocates nothing. `W` is scratch of shape (n + m, n + m).
"""

from __future__ import annotations

import math

import numpy as np

from arkaq_edu._compiled import kernel

LOG_2PI = math.log(2 * math.pi)
# A pivot this small against its own variance is rounding: that row says nothing new.
NEGLIGIBLE = 16 * np.finfo(np.float64).eps


@kernel
def is_covariance(R):
    """Tell whether R is finite, exactly symmetric and has no negative pivot."""
    m = R.shape[0]
    L = R.copy()
    for j in range(m):
        for i in range(m):
            if not math.isfinite(R[i, j]) or R[i, j] != R[j, i]:
                return False
        if L[j, j] < 0.0:
            return False
        for i in range(j + 1, m):
            if L[j, j] == 0.0:
                if L[i, j] != 0.0:
                    return False
                continue
            ratio = L[i, j] / L[j, j]
            for k in range(j + 1, i + 1):
                L[i, k] -= ratio * L[k, j]
    return True


@kernel
def factor(S, y, L):
    """Factor S = L D L', with D on the diagonal of L; rows that say nothing get D = 0.

    A row says nothing when it was not seen (y is NaN) or when the rows before it determine it.
    """
    for i in range(S.shape[0]):
        pivot = 0.0 if math.isnan(y[i]) else S[i, i]
        for j in range(i):
            L[i, j] = 0.0
            if pivot > 0.0 and L[j, j] > 0.0:
                total = S[i, j]
                for k in range(j):
                    total -= L[i, k] * L[j, k]
                L[i, j] = total  # l d, until the row is whole
        for j in range(i):
            if L[j, j] > 0.0:
                scaled = L[i, j] / L[j, j]
                pivot -= scaled * L[i, j]
                L[i, j] = scaled
        L[i, i] = pivot
        if pivot <= NEGLIGIBLE * S[i, i]:
            for j in range(i + 1):
                L[i, j] = 0.0


@kernel
def solve(L, b):
    """Replace b by the solution of S x = b, given S = L D L'; rows with D = 0 get 0."""
    m = b.size
    for i in range(m):
        for j in range(i):
            b[i] -= L[i, j] * b[j]
        if L[i, i] == 0.0:
            b[i] = 0.0
    for i in range(m - 1, -1, -1):
        if L[i, i] > 0.0:
            b[i] /= L[i, i]
            for j in range(i + 1, m):
                b[i] -= L[j, i] * b[j]


@kernel
def predict(A, Q, B, u, x, P, W):
    """Time update, eq 2.55 and 2.56: x = A x + B u and P = A P A' + Q."""
    n = x.size
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += A[i, j] * x[j]
        for j in range(u.size):
            total += B[i, j] * u[j]
        W[0, i] = total
    for i in range(n):
        x[i] = W[0, i]
    for i in range(n):  # W = A P
        for k in range(n):
            W[i, k] = 0.0
        for j in range(n):
            if A[i, j] != 0.0:  # a motion model is mostly zeros
                for k in range(n):
                    W[i, k] += A[i, j] * P[j, k]
    for i in range(n):  # P = W A' + Q, one triangle and its mirror
        for k in range(i, n):
            total = Q[i, k]
            for j in range(n):
                total += W[i, j] * A[k, j]
            P[i, k] = total
            P[k, i] = total


@kernel
def update(H, R, gates, z, x, P, K, y, S, W):
    """Measurement update, eq 2.57 to 2.59; return (NIS, log-likelihood, whether z was used).

    The NIS is NaN where nothing was seen, and -1 where z holds an infinity (nothing is changed).
    """
    n, m = x.size, z.size
    G, V, L = W[:n, n:], W[:n, :n], W[n:, n:]
    for i in range(m):
        if math.isinf(z[i]):
            return -1.0, 0.0, False
    for i in range(m):  # y = z - H x and G = P H'
        y[i] = z[i]
        for k in range(n):
            G[k, i] = 0.0
        for j in range(n):
            if H[i, j] != 0.0:
                y[i] -= H[i, j] * x[j]
                for k in range(n):
                    G[k, i] += P[k, j] * H[i, j]
    for i in range(m):  # S = H G + R
        for j in range(i + 1):
            total = R[i, j]
            for k in range(n):
                total += H[i, k] * G[k, j]
            S[i, j] = total
            S[j, i] = total
    factor(S, y, L)

    nis = 0.0  # y' S^-1 y, as the squares of the innovations that each row adds
    seen = 0
    log_det = 0.0
    white = K[0]  # a row of the gain, lent for a moment
    for i in range(m):
        white[i] = 0.0
        if L[i, i] > 0.0:
            white[i] = y[i]
            for j in range(i):
                white[i] -= L[i, j] * white[j]
            seen += 1
            nis += white[i] * white[i] / L[i, i]
            log_det += math.log(L[i, i])
    used = seen > 0 and nis <= gates[seen]
    if not used:
        for i in range(n):
            for j in range(m):
                K[i, j] = 0.0
        return (nis if seen > 0 else math.nan), 0.0, False

    for i in range(n):  # K S = G, row by row, and x = x + K y
        for j in range(m):
            K[i, j] = 0.0 if L[j, j] == 0.0 else G[i, j]
        solve(L, K[i])
        for j in range(m):
            if L[j, j] > 0.0:
                x[i] += K[i, j] * y[j]

    # P = (I - K H) P (I - K H)' + K R K' (Joseph) equals eq 2.59 for this K and stays positive
    # under rounding. With V = (I - K H) P = P - K G' it is V - (V H' - K R) K'.
    for i in range(n):
        for j in range(n):
            V[i, j] = P[i, j]
            for k in range(m):
                V[i, j] -= K[i, k] * G[j, k]
    for i in range(n):  # G is free now: G = V H' - K R
        for j in range(m):
            total = 0.0
            for k in range(n):
                total += V[i, k] * H[j, k]
            for k in range(m):
                total -= K[i, k] * R[k, j]
            G[i, j] = total
    for i in range(n):
        for j in range(i, n):
            total = V[i, j]
            for k in range(m):
                total -= G[i, k] * K[j, k]
            P[i, j] = total
            P[j, i] = total
    return nis, -0.5 * (seen * LOG_2PI + log_det + nis), True


@kernel
def track(A, H, Q, R, B, gates, x0, P0, Z, U, x, P, x_prior, P_prior, K, y, S, nis, used):
    """Filter a whole track, keeping everything; return the log-likelihood of what was used.

    R is (T, m, m), or (1, m, m) where it never changes.
    """
    n, m = x0.size, Z.shape[1]
    W = np.empty((n + m, n + m))
    x_now, P_now = x0.copy(), P0.copy()
    log_likelihood = 0.0
    for t in range(Z.shape[0]):
        predict(A, Q, B, U[t], x_now, P_now, W)
        x_prior[t] = x_now
        P_prior[t] = P_now
        R_now = R[t if R.shape[0] > 1 else 0]
        nis[t], gained, used[t] = update(H, R_now, gates, Z[t], x_now, P_now, K[t], y[t], S[t], W)
        x[t] = x_now
        P[t] = P_now
        log_likelihood += gained
    return log_likelihood


@kernel
def follow(A, H, x0, K, Z, members, x):
    """Filter the tracks Z[members] with gains K that are known already."""
    T, n, m = K.shape
    prior = np.empty(n)
    y = np.empty(m)
    for track_number in members:
        now = x0
        for t in range(T):
            z, after = Z[track_number, t], x[track_number, t]
            for i in range(n):
                prior[i] = 0.0
                for j in range(n):
                    prior[i] += A[i, j] * now[j]
            for i in range(m):
                y[i] = 0.0
                if not math.isnan(z[i]):
                    y[i] = z[i]
                    for j in range(n):
                        y[i] -= H[i, j] * prior[j]
            for i in range(n):
                after[i] = prior[i]
                for j in range(m):
                    after[i] += K[t, i, j] * y[j]
            now = after
