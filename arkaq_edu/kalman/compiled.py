"""The loops of the Kalman filter: the equations of thesis section 2.5.

Handing an array from Python to a kernel costs some 60 ns, about as much as the work of a kernel on
four states. So all matrices of a filter live in one array, its memory M, each in a plane of its
own: ``M[P, i, j]`` is element (i, j) of P. n and m are the numbers of states and measurements, x
is the state and y the innovation. Every array is C-contiguous float64 and written in place, so
that each kernel compiles once.
"""

from __future__ import annotations

import math

import numpy as np

from arkaq_edu._compiled import kernel

# The matrices of the thesis, then scratch: V (n, n), G = H P (m, n) and L (m, m), a factor of S.
A, Q, P, H, R, K, S, V, G, L = PLANES = range(10)

LOG_2PI = math.log(2 * math.pi)
ROUNDING = float(np.finfo(np.float64).eps)
# A variance that shrinks to this part of itself, once the rows before are known, is rounding.
NEGLIGIBLE = 16 * ROUNDING


@kernel
def is_covariance(R):
    """Tell whether R is finite, exactly symmetric and has no negative pivot."""
    m = R.shape[0]
    rest = R.copy()  # what is left of R as its columns are eliminated
    for j in range(m):
        for i in range(m):
            if not math.isfinite(R[i, j]) or R[i, j] != R[j, i]:
                return False
        if rest[j, j] < 0.0:
            return False
        for i in range(j + 1, m):
            if rest[j, j] == 0.0:
                if rest[i, j] != 0.0:
                    return False
                continue
            ratio = rest[i, j] / rest[j, j]
            for k in range(j + 1, i + 1):
                rest[i, k] -= ratio * rest[k, j]
    return True


# Numba takes seconds to compile an assignment to a slice; these loops it compiles at once.
@kernel
def fill(M, plane, values):
    """Put a matrix into a plane."""
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            M[plane, i, j] = values[i, j]


@kernel
def keep(M, plane, out):
    """Copy a matrix out of its plane."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = M[plane, i, j]


@kernel
def copy(values, out):
    """Copy a vector."""
    for i in range(out.size):
        out[i] = values[i]


@kernel
def predict_mean(M, push, x):
    """Set x = A x + B u (eq 2.55), with push = B u."""
    for i in range(x.size):
        total = push[i]
        for j in range(x.size):
            total += M[A, i, j] * x[j]
        M[V, 0, i] = total
    for i in range(x.size):
        x[i] = M[V, 0, i]


@kernel
def predict_covariance(M, n):
    """Set P = A P A' + Q (eq 2.56)."""
    for i in range(n):  # V = A P
        for k in range(n):
            M[V, i, k] = 0.0
        for j in range(n):
            a = M[A, i, j]
            if a != 0.0:  # a motion model is mostly zeros
                for k in range(n):
                    M[V, i, k] += a * M[P, j, k]
    for i in range(n):  # P = V A' + Q, one triangle and its mirror
        for k in range(i, n):
            total = M[Q, i, k]
            for j in range(n):
                total += M[V, i, j] * M[A, k, j]
            M[P, i, k] = total
            M[P, k, i] = total


@kernel
def predict(M, push, x):
    """Time update, eq 2.55 and 2.56."""
    predict_mean(M, push, x)
    predict_covariance(M, x.size)


@kernel
def innovate(M, z, x, y):
    """Set y = z - H x, NaN where z is missing; tell whether all of z was seen."""
    whole = True
    for i in range(z.size):
        total = z[i]
        for j in range(x.size):
            total -= M[H, i, j] * x[j]
        y[i] = total
        whole = whole and not math.isnan(z[i])
    return whole


@kernel
def factor(M, y):
    """Factor S = L D L', with 1/D on the diagonal of L; return the rows used and log |2 pi S|.

    A row is not used, and its 1/D is 0, when it was not seen (y is NaN) or when the rows before
    determine it: then it says nothing new, and S may as well be singular.
    """
    used = 0
    log_det = 0.0
    for i in range(y.size):
        rest = M[S, i, i]
        for j in range(i):
            total = M[S, i, j]
            for k in range(j):
                total -= M[L, i, k] * M[L, j, k]
            M[L, i, j] = total  # still times D
        for j in range(i):
            total = M[L, i, j]
            M[L, i, j] = total * M[L, j, j]
            rest -= total * M[L, i, j]
        if rest > NEGLIGIBLE * M[S, i, i] and not math.isnan(y[i]):
            M[L, i, i] = 1.0 / rest
            used += 1
            log_det += LOG_2PI + math.log(rest)
        else:
            for j in range(i + 1):
                M[L, i, j] = 0.0
    return used, log_det


@kernel
def squared_norm(M, y):
    """Return y' S^-1 y, with S in factors, as the sum of what each row used adds."""
    total = 0.0
    for i in range(y.size):
        M[V, 0, i] = 0.0
        if M[L, i, i] > 0.0:
            rest = y[i]
            for j in range(i):
                rest -= M[L, i, j] * M[V, 0, j]
            M[V, 0, i] = rest
            total += rest * rest * M[L, i, i]
    return total


@kernel
def gain(M, y, n):
    """Set S = H P H' + R and K = P H' S^-1 (eq 2.57); return what `factor` does.

    Rows not used leave a column of zeros in K.
    """
    m = y.size
    for i in range(m):  # G = H P
        for k in range(n):
            M[G, i, k] = 0.0
        for j in range(n):
            h = M[H, i, j]
            if h != 0.0:
                for k in range(n):
                    M[G, i, k] += h * M[P, j, k]
    for i in range(m):  # S = H G' + R, one triangle and its mirror
        for j in range(i + 1):
            M[S, i, j] = M[R, i, j]
        for k in range(n):
            h = M[H, i, k]
            if h != 0.0:
                for j in range(i + 1):
                    M[S, i, j] += h * M[G, j, k]
        for j in range(i):
            M[S, j, i] = M[S, i, j]
    used, log_det = factor(M, y)
    for r in range(n):  # K L D L' = G', row by row
        for i in range(m):
            total = M[G, i, r]
            for j in range(i):
                total -= M[L, i, j] * M[K, r, j]
            M[K, r, i] = total
        for i in range(m - 1, -1, -1):
            total = M[K, r, i] * M[L, i, i]
            for j in range(i + 1, m):
                total -= M[L, j, i] * M[K, r, j]
            M[K, r, i] = total
    return used, log_det


@kernel
def correct_mean(M, y, x):
    """Set x = x + K y (eq 2.58), leaving out what was not seen."""
    for j in range(y.size):
        if not math.isnan(y[j]):
            for i in range(x.size):
                x[i] += M[K, i, j] * y[j]


@kernel
def correct_covariance(M, n, m):
    """Set P = (I - K H) P (I - K H)' + K R K', given G = H P.

    Joseph's form: for this K it equals eq 2.59, and rounding leaves it positive. With
    V = (I - K H) P = P - K G it is V - (V H' - K R) K'.
    """
    for i in range(n):
        for j in range(n):
            M[V, i, j] = M[P, i, j]
    for k in range(m):
        for i in range(n):
            c = M[K, i, k]
            for j in range(n):
                M[V, i, j] -= c * M[G, k, j]
    for k in range(m):  # G has served: from here on it is (V H' - K R)'
        for i in range(n):
            total = 0.0
            for j in range(m):
                total -= M[K, i, j] * M[R, j, k]
            M[G, k, i] = total
        for j in range(n):
            h = M[H, k, j]
            if h != 0.0:
                for i in range(n):
                    M[G, k, i] += M[V, i, j] * h
    for i in range(n):
        for j in range(i, n):
            total = M[V, i, j]
            for k in range(m):
                total -= M[G, k, i] * M[K, j, k]
            M[P, i, j] = total
            M[P, j, i] = total


@kernel
def update(M, gates, z, x, y):
    """Measurement update, eq 2.57 to 2.59; return (NIS, log-likelihood, accepted).

    The NIS is NaN where nothing was seen, and -1 where z holds an infinity (nothing is changed).
    """
    n, m = x.size, z.size
    for i in range(m):
        if math.isinf(z[i]):
            return -1.0, 0.0, False
    innovate(M, z, x, y)
    used, log_det = gain(M, y, n)
    nis = squared_norm(M, y) if used > 0 else math.nan
    if nis <= gates[used]:
        correct_mean(M, y, x)
        correct_covariance(M, n, m)
        return nis, -0.5 * (log_det + nis), True
    M[K] = 0.0
    return nis, 0.0, False


@kernel
def settled(now, before):
    """Tell whether a covariance moved by no more than a rounding of its standard deviations."""
    for i in range(now.shape[0]):
        rounding = ROUNDING * math.sqrt(abs(now[i, i]))
        for j in range(i + 1):
            if abs(now[i, j] - before[i, j]) > rounding * math.sqrt(abs(now[j, j])):
                return False
    return True


@kernel
def coast(M, pushes, gate, Z, t, xs, x_priors, ys, nis):
    """Filter on from row t with a gain that stays; return the first row that has no part in that.

    It has none when something is missing, or when its NIS is beyond the gate.
    """
    n, m = xs.shape[1], Z.shape[1]
    while t < Z.shape[0]:
        for i in range(n):
            total = pushes[min(t, pushes.shape[0] - 1), i]
            for j in range(n):
                total += M[A, i, j] * xs[t - 1, j]
            x_priors[t, i] = total
        whole = True
        for i in range(m):
            total = Z[t, i]
            for j in range(n):
                total -= M[H, i, j] * x_priors[t, j]
            ys[t, i] = total
            whole = whole and not math.isnan(total)
        nis[t] = squared_norm(M, ys[t])
        if not whole or nis[t] > gate:
            return t
        for i in range(n):
            total = x_priors[t, i]
            for j in range(m):
                total += M[K, i, j] * ys[t, j]
            xs[t, i] = total
        t += 1
    return t


@kernel
def track(M, Rs, pushes, gates, x, Z, xs, Ps, x_priors, P_priors, ys, Ss, Ks, nis, accepted):
    """Filter a whole track from x and P, keeping everything; return its log-likelihood.

    `Rs` has a row for each of Z, or none if R never changes; `pushes` a row for each, or one.
    Covariances do not depend on what is seen, only on whether it is: once P_prior has settled, it,
    S, K and P stay as they are, and the filter coasts until something is missing or refused. That
    makes a long track several times faster.
    """
    n, m = x.size, Z.shape[1]
    y = np.empty(m)
    log_likelihood = 0.0
    full = False
    t = 0
    while t < Z.shape[0]:
        predict_mean(M, pushes[min(t, pushes.shape[0] - 1)], x)
        predict_covariance(M, n)
        copy(x, x_priors[t])
        keep(M, P, P_priors[t])
        if Rs.shape[0] > 0:
            fill(M, R, Rs[t])
        whole = innovate(M, Z[t], x, y)
        used, log_det = gain(M, y, n)
        nis[t] = squared_norm(M, y) if used > 0 else math.nan
        accepted[t] = nis[t] <= gates[used]
        if accepted[t]:
            correct_mean(M, y, x)
            correct_covariance(M, n, m)
            log_likelihood -= 0.5 * (log_det + nis[t])
        else:
            M[K] = 0.0
        copy(x, xs[t])
        keep(M, P, Ps[t])
        copy(y, ys[t])
        keep(M, S, Ss[t])
        keep(M, K, Ks[t])
        was_full = full
        full = whole and accepted[t]
        t += 1
        if full and was_full and Rs.shape[0] == 0 and settled(P_priors[t - 1], P_priors[t - 2]):
            end = coast(M, pushes, gates[used], Z, t, xs, x_priors, ys, nis)
            for s in range(t, end):
                keep(P_priors, t - 1, P_priors[s])
                keep(Ps, t - 1, Ps[s])
                keep(Ss, t - 1, Ss[s])
                keep(Ks, t - 1, Ks[s])
                accepted[s] = True
                log_likelihood -= 0.5 * (log_det + nis[s])
            t = end
            copy(xs[t - 1], x)
    return log_likelihood


@kernel
def follow(A, H, x0, K, Z, members, x):
    """Filter the tracks Z[members] with gains K that are known already."""
    T, n, m = K.shape
    prior, y = np.empty(n), np.empty(m)
    for member in members:
        for t in range(T):
            for i in range(n):
                total = 0.0
                for j in range(n):
                    total += A[i, j] * (x[member, t - 1, j] if t > 0 else x0[j])
                prior[i] = total
            for i in range(m):
                total = Z[member, t, i]
                for j in range(n):
                    total -= H[i, j] * prior[j]
                y[i] = 0.0 if math.isnan(total) else total
            for i in range(n):
                total = prior[i]
                for j in range(m):
                    total += K[t, i, j] * y[j]
                x[member, t, i] = total


@kernel
def smooth(M, xs, Ps, x_priors):
    """Smooth a filtered track in place, from its last row back.

    The next state is a sighting of A x with noise Q: so the gain is that of a measurement update
    with A in the plane of H and Q in that of R. What is unsure of the next state comes back
    through it: P = (I - K A) P (I - K A)' + K (Q + P_next) K'.
    """
    n = xs.shape[1]
    y = np.zeros(n)
    for t in range(xs.shape[0] - 2, -1, -1):
        fill(M, P, Ps[t])
        gain(M, y, n)
        for i in range(n):
            y[i] = xs[t + 1, i] - x_priors[t + 1, i]
        correct_mean(M, y, xs[t])
        for i in range(n):
            for j in range(n):
                total = 1.0 if i == j else 0.0
                for k in range(n):
                    total -= M[K, i, k] * M[H, k, j]
                M[A, i, j] = total
                M[Q, i, j] = 0.0
        predict_covariance(M, n)
        fill(M, Q, M[P])
        fill(M, A, M[K])
        for i in range(n):
            for j in range(n):
                M[P, i, j] = M[R, i, j] + Ps[t + 1, i, j]
        predict_covariance(M, n)
        keep(M, P, Ps[t])


@kernel
def squared_norms(M, errors, Ps, norms):
    """Set norms_t = e_t' P_t^-1 e_t."""
    for t in range(errors.shape[0]):
        fill(M, S, Ps[t])
        factor(M, errors[t])
        norms[t] = squared_norm(M, errors[t])
