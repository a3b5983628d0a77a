"""The compiled twin of `filter`, for whole tracks and batches: same equations, order and notation.

`track` calls the equations of `filter` themselves; once the covariances have converged, it computes
only the states. `batch` works on many tracks at once: every state and covariance has one more axis,
the last, with an entry for each track, x (n, N) and P (n, n, L), and the helpers write into an
array that is given last. Tests compare both with `filter`.
"""

from __future__ import annotations

import math

import numpy as np

from arkaq_edu._checks import LARGEST
from arkaq_edu._compiled import kernel
from arkaq_edu.kalman.filter import gain, measurement_update, time_update
from arkaq_edu.kalman.matrices import (
    HALF_LOST,
    NEGLIGIBLE,
    inverse,
    mul,
    quadratic,
    symmetric,
    transpose,
    vec,
)

ROUNDING = float(np.finfo(np.float64).eps)


@kernel
def row(stack, t):
    """Return the entry for row t of a stack that has one for each row, or one for all."""
    return stack[min(t, len(stack) - 1)]


@kernel
def track(
    A, B, H, Q, R, gates, x0, P0, Z, U,
    x, P, x_prior, P_prior, innovation, S, K, nis, accepted,
):  # fmt: skip
    """Filter one track and fill in the rows of its trace; return its log-likelihood.

    A, B, H, Q, R and U have an entry for each row of Z, or one for all.
    """
    x_now, P_now, log_likelihood = x0, P0, 0.0
    constant = len(A) == len(B) == len(H) == len(Q) == len(R) == 1
    BU = mul(U, transpose(B[0]))
    T, t = Z.shape[0], 0
    while t < T:
        x_now, P_now = time_update(row(A, t), row(B, t), row(Q, t), x_now, P_now, row(U, t))
        copy_vec(x_now, x_prior[t])
        copy(P_now, P_prior[t])
        x_now, P_now, K_now, y, S_now, nis[t], added, accepted[t] = measurement_update(
            row(H, t), row(R, t), x_now, P_now, Z[t], gates
        )
        log_likelihood += added
        copy_vec(x_now, x[t])
        copy(P_now, P[t])
        copy(K_now, K[t])
        copy_vec(y, innovation[t])
        copy(S_now, S[t])
        t += 1
        if t > 1 and constant and converged(P_prior, accepted, innovation, t - 1):
            P_last, H_last = P_prior[t - 1], H[0]
            every = np.ones(len(S_now), np.bool_)
            K_now, S_inverse, used, log_det = gain(
                H_last, R[0], P_last, mul(H_last, P_last), S_now, every
            )
            start = t
            t = steady(
                A[0], H_last, K_now, S_inverse, gates[used], BU, Z, t, x, x_prior, innovation, nis
            )
            for s in range(start, t):
                copy(P_last, P_prior[s])
                copy(P_now, P[s])
                copy(S_now, S[s])
                copy(K_now, K[s])
                accepted[s] = True
                log_likelihood -= 0.5 * (log_det + nis[s])
            copy_vec(x[t - 1], x_now)
    return log_likelihood


@kernel
def steady(A, H, K, S_inverse, gate, BU, Z, t, x, x_prior, innovation, nis):
    """Filter on from row t with a constant gain; return the first row where that fails.

    It fails where an entry is missing, so that the NIS is NaN, or where the gate refuses.
    """
    while t < Z.shape[0]:
        plus(row(BU, t), 1.0, A, x[t - 1], x_prior[t])  # eq 2.55
        plus(Z[t], -1.0, H, x_prior[t], innovation[t])
        nis[t] = quadratic(S_inverse, innovation[t])
        if not nis[t] <= gate:
            break
        plus(x_prior[t], 1.0, K, innovation[t], x[t])  # eq 2.58
        t += 1
    return t


@kernel
def converged(P_prior, accepted, innovation, t):
    """Tell whether rows t - 1 and t used all entries, with a P_prior that is equal to rounding."""
    for i in range(innovation.shape[1]):
        if math.isnan(innovation[t, i] + innovation[t - 1, i]):
            return False
    now, before = P_prior[t], P_prior[t - 1]
    for i in range(now.shape[0]):
        rounding = ROUNDING * math.sqrt(now[i, i])
        for j in range(i + 1):
            if abs(now[i, j] - before[i, j]) > rounding * math.sqrt(now[j, j]):
                return False
    return accepted[t] and accepted[t - 1]


@kernel
def plus(b, sign, A, x, out):
    """Set out = b + sign A x."""
    for i in range(A.shape[0]):
        total = 0.0
        for j in range(A.shape[1]):
            total += A[i, j] * x[j]
        out[i] = b[i] + sign * total


@kernel
def copy(A, out):
    """Set out = A; as a loop, since a slice compiles and runs more slowly."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = A[i, j]


@kernel
def copy_vec(x, out):
    """Set out = x."""
    for i in range(x.shape[0]):
        out[i] = x[i]


@kernel
def smoothed(As, Qs, x, P, x_prior, P_prior):
    """Smooth a filtered track in place, from its last row to its first."""
    n = x.shape[1]
    every, identity = np.ones(n, np.bool_), np.eye(n)
    for t in range(len(x) - 2, -1, -1):
        A, Q = row(As, t + 1), row(Qs, t + 1)  # of the step from row t to row t + 1
        P_prior_inverse, _, _ = inverse(P_prior[t + 1], every, NEGLIGIBLE)
        C = mul(mul(P[t], transpose(A)), P_prior_inverse)  # C = P A' P_prior^-1
        copy_vec(x[t] + vec(C, x[t + 1] - x_prior[t + 1]), x[t])  # x += C (x_next - x_prior_next)
        # P += C (P_next - P_prior_next) C', in Joseph's form, which stays positive
        F = identity - mul(C, A)
        P_now = mul(mul(F, P[t]), transpose(F)) + mul(mul(C, Q + P[t + 1]), transpose(C))
        copy(symmetric(P_now), P[t])


@kernel
def vec_shared(A, x, out):
    """Set out = A x, with one A for all tracks."""
    for i in range(A.shape[0]):
        for c in range(x.shape[1]):
            out[i, c] = 0.0
        for j in range(A.shape[1]):
            for c in range(x.shape[1]):
                out[i, c] += A[i, j] * x[j, c]


@kernel
def mul_shared(A, B, out):
    """Set out = A B, with one A for all tracks."""
    for i in range(A.shape[0]):
        for k in range(B.shape[1]):
            for c in range(B.shape[2]):
                out[i, k, c] = 0.0
        for j in range(A.shape[1]):
            if A[i, j] != 0.0:  # a motion model is mostly zeros
                for k in range(B.shape[1]):
                    for c in range(B.shape[2]):
                        out[i, k, c] += A[i, j] * B[j, k, c]


@kernel
def mul_shared_transpose(B, A, out):
    """Set out = B A', with one A for all tracks."""
    for i in range(B.shape[0]):
        for k in range(A.shape[0]):
            for c in range(out.shape[2]):
                out[i, k, c] = 0.0
            for j in range(A.shape[1]):
                if A[k, j] != 0.0:
                    for c in range(out.shape[2]):
                        out[i, k, c] += B[i, j, c] * A[k, j]


@kernel
def mul_each(K, B, out):
    """Set out = K B for each track."""
    for i in range(K.shape[0]):
        for j in range(B.shape[1]):
            for c in range(out.shape[2]):
                out[i, j, c] = 0.0
            for k in range(K.shape[1]):
                for c in range(out.shape[2]):
                    out[i, j, c] += K[i, k, c] * B[k, j, c]


@kernel
def vec_each(K, y, out):
    """Set out = K y for each track; tracks may share one K."""
    step = 0 if K.shape[2] == 1 else 1
    for i in range(K.shape[0]):
        for c in range(y.shape[1]):
            out[i, c] = 0.0
        for j in range(K.shape[1]):
            for c in range(y.shape[1]):
                out[i, c] += K[i, j, c * step] * y[j, c]


@kernel
def transpose_each(B, out):
    """Set out = B'."""
    for i in range(B.shape[0]):
        for j in range(B.shape[1]):
            for c in range(B.shape[2]):
                out[j, i, c] = B[i, j, c]


@kernel
def add(P, Q):
    """Set P = P + Q, symmetric, with one Q for all tracks."""
    for i in range(Q.shape[0]):
        for j in range(i, Q.shape[0]):
            for c in range(P.shape[2]):
                P[i, j, c] += Q[i, j]
                P[j, i, c] = P[i, j, c]


@kernel
def subtract(P, B, out):
    """Set out = P - B."""
    for i in range(P.shape[0]):
        for j in range(P.shape[1]):
            for c in range(P.shape[2]):
                out[i, j, c] = P[i, j, c] - B[i, j, c]


@kernel
def mirror(P):
    """Set the lower triangle of P to the mirror image of the upper one."""
    for i in range(P.shape[0]):
        for j in range(i):
            for c in range(P.shape[2]):
                P[i, j, c] = P[j, i, c]


@kernel
def inverse_each(S, seen, V):
    """Set V to the inverse of the rows of S that are seen, as `matrices.inverse` does.

    Returns False if some row could not be used.
    """
    m, _, L = S.shape
    ratio, all_used = np.empty(L), True
    for i in range(m):
        for j in range(m):
            for c in range(L):
                V[i, j, c] = S[i, j, c]
    for k in range(m):
        for c in range(L):
            usable = V[k, k, c] > HALF_LOST * S[k, k, c]
            ratio[c] = 1.0 / V[k, k, c] if seen[k, c] and usable else 0.0
            all_used = all_used and (usable or not seen[k, c])
        for i in range(m):
            for j in range(m):
                if i != k and j != k:
                    for c in range(L):
                        V[i, j, c] -= V[i, k, c] * ratio[c] * V[k, j, c]
        for i in range(m):
            for c in range(L):
                V[i, k, c] *= -ratio[c]
                V[k, i, c] *= ratio[c]
        for c in range(L):
            V[k, k, c] = ratio[c]
    return all_used


@kernel
def bounded_each(P):
    """Tell whether all variances are numbers that the package allows."""
    largest = 0.0
    for i in range(P.shape[0]):
        for c in range(P.shape[2]):
            largest = largest if P[i, i, c] <= largest else P[i, i, c]  # takes a NaN, too
    return largest <= LARGEST


@kernel
def innovate(z, Hx, y, seen):
    """Set y = z - H x with 0 where z is missing, and which entries are seen."""
    for i in range(z.shape[0]):
        for c in range(z.shape[1]):
            y[i, c] = 0.0 if math.isnan(z[i, c]) else z[i, c] - Hx[i, c]
        for c in range(seen.shape[1]):
            seen[i, c] = not math.isnan(z[i, c])


@kernel
def batch(A, H, Q, R, x0, P0, Z, x, L):
    """Filter the N tracks of Z (T, m, N) into x (T, n, N).

    L = 1 if all tracks miss the same entries and so share their covariances, otherwise L = N.
    Returns False where this plain arithmetic does not do: where `gain_by_rows` is needed, or where
    a track diverges.
    """
    n, m, N = A.shape[0], H.shape[0], Z.shape[2]
    P, P_prior = np.empty((n, n, L)), np.empty((n, n, L))
    AP, KHP = np.empty((n, n, L)), np.empty((n, n, L))
    HP, K_transpose = np.empty((m, n, L)), np.empty((m, n, L))
    K, PH, KR = np.empty((n, m, L)), np.empty((n, m, L)), np.empty((n, m, L))
    S, S_inverse, seen = np.empty((m, m, L)), np.empty((m, m, L)), np.empty((m, L), np.bool_)
    x_now, x_prior, Ky = np.empty((n, N)), np.empty((n, N)), np.empty((n, N))
    Hx, y = np.empty((m, N)), np.empty((m, N))
    for i in range(n):
        x_now[i, :] = x0[i]
        for j in range(n):
            P[i, j, :] = P0[i, j]
    for t in range(Z.shape[0]):
        vec_shared(A, x_now, x_prior)  # eq 2.55: x = A x
        mul_shared(A, P, AP)
        mul_shared_transpose(AP, A, P_prior)
        add(P_prior, Q)  # eq 2.56: P = A P A' + Q

        vec_shared(H, x_prior, Hx)
        innovate(Z[t], Hx, y, seen)
        mul_shared(H, P_prior, HP)
        mul_shared_transpose(HP, H, S)
        add(S, R)
        if not (bounded_each(P_prior) and inverse_each(S, seen, S_inverse)):
            return False
        transpose_each(HP, PH)
        mul_each(PH, S_inverse, K)  # eq 2.57: K = P H' (H P H' + R)^-1
        vec_each(K, y, Ky)
        for i in range(n):
            for c in range(N):
                x_now[i, c] = x[t, i, c] = x_prior[i, c] + Ky[i, c]  # eq 2.58: x = x + K y
        mul_each(K, HP, KHP)
        subtract(P_prior, KHP, P)  # eq 2.59: P = P - K H P

        mul_shared_transpose(P, H, PH)
        mul_shared_transpose(K, R, KR)
        subtract(PH, KR, PH)
        transpose_each(K, K_transpose)
        mul_each(PH, K_transpose, KHP)
        subtract(P, KHP, P)  # Joseph's form: P = P - (P H' - K R) K'
        mirror(P)
    return True
