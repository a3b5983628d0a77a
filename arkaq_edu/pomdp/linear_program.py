"""The linear program of pruning: how much a vector adds to the upper surface of others.

For a vector w and vectors u_0 ... u_{n-1} the answer is the gain

    max over beliefs b of min over k of b . (w - u_k).

A belief that attains it is a witness: w is needed there if the gain is positive. The dual program
has the same value. It looks for a mixture m of the vectors u, and minimizes a bound t:

    minimize t  subject to  m >= 0,  sum m = 1,  (w - U m)(s) <= t in every state s.

If the mixture is nowhere more than t below w, then w gains at most t anywhere.

The simplex method runs on the dual program. With S states it has S + 1 equations, however many
vectors there are, and so S + 1 basic variables: the bound t, some of the weights m, and the slacks
of the other states (what their inequality leaves up to t). The prices of the equations are the
belief. Its steps stand below in their order: `start`, then `price`, `enter`, `ratio` and `pivot`
again and again, then `finish`. `finish` computes the bound from the mixture itself, so the rounding
errors of the steps before do not make it wrong.

The vectors u are the columns of an array U, so that loops over all of them run along its rows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._compiled import kernel

Floats = NDArray[np.floating]

# Numbers below this count as zero. The caller scales the vectors to differences of about one.
ZERO = 1e-13
# Codes in the basis. A code k >= 0 is the weight of vector k, and SLACK - s the slack of state s.
# The bound t never leaves the basis, so its code is free to mean "no column" and "no row".
T = NONE = -1
SLACK = -2
# After this many steps for each equation the simplex method is probably going in a circle. From
# then on Bland's rule applies, which never does; ten times as many steps are the end in any case.
PATIENCE = 20


class Tableau(NamedTuple):
    """The variables of the simplex method. Row i of the first four belongs to basis[i]."""

    basis: NDArray[np.int64]  # shape (S + 1,): the code of each basic variable
    inverse: Floats  # shape (S + 1, S + 1): the inverse of the basis columns
    solution: Floats  # shape (S + 1,): the values of the basic variables
    column: Floats  # shape (S + 1,): the entering column, as a sum of the basis columns
    values: Floats  # shape (K,): room for one number for each vector u


@kernel
def tableau(S, K):
    """Return an empty tableau for S states and up to K vectors."""
    n = S + 1
    return Tableau(np.empty(n, np.int64), np.empty((n, n)), np.empty(n), np.empty(n), np.empty(K))


@kernel
def values_at(b, constant, U, n, values):
    """Set values[k] = constant + b . u_k for the first n vectors; return the largest."""
    for k in range(n):
        values[k] = constant
    for s in range(U.shape[0]):
        if b[s] != 0.0:
            for k in range(n):
                values[k] += b[s] * U[s, k]
    top = -np.inf
    for k in range(n):
        top = max(top, values[k])
    return top


@kernel
def start(w, U, n, table):
    """Begin with the one vector that leaves w the smallest lead in its best state.

    Return that state: the row of its equation holds t.
    """
    S = w.size
    basis, inverse, solution, lead = table.basis, table.inverse, table.solution, table.values
    for k in range(n):
        lead[k] = -np.inf
    for s in range(S):
        for k in range(n):
            lead[k] = max(lead[k], w[s] - U[s, k])
    first = lead[:n].argmin()
    corner = (w - U[:, first]).argmax()
    inverse[:] = 0.0
    for s in range(S):
        basis[s] = SLACK - s
        inverse[s, s] = -1.0
        inverse[s, corner] = 1.0
        inverse[s, S] = U[s, first] - U[corner, first]
        solution[s] = inverse[s, S] + w[corner] - w[s]
    basis[corner], solution[corner] = T, w[corner] - U[corner, first]
    inverse[corner, corner], inverse[corner, S] = 1.0, -U[corner, first]
    basis[S], solution[S], inverse[S, S] = first, 1.0, 1.0
    return corner


@kernel
def price(U, n, corner, bland, table):
    """Choose the column that enters the basis, or NONE where the solution is optimal.

    Return it with what the belief gains if the prices are one, else with minus infinity.
    """
    prices, values = table.inverse[corner], table.values
    S = U.shape[0]
    entering, best, most_negative = NONE, ZERO, 0.0
    for s in range(S):
        most_negative = max(most_negative, -prices[s])
        if -prices[s] > best and (entering == NONE or not bland):
            entering, best = SLACK - s, -prices[s]
    top = values_at(prices, prices[S], U, n, values)
    if top > best and (entering == NONE or not bland):
        for k in range(n):
            if values[k] == top or (bland and values[k] > best):
                entering = k
                break
    gained = table.solution[corner] - top if most_negative <= ZERO else -np.inf
    return entering, gained


@kernel
def enter(U, entering, table):
    """Write the entering column as a sum of the basis columns."""
    inverse, column = table.inverse, table.column
    S = U.shape[0]
    for i in range(S + 1):
        if entering >= 0:
            total = inverse[i, S]
            for s in range(S):
                total += inverse[i, s] * U[s, entering]
        else:
            total = -inverse[i, SLACK - entering]
        column[i] = total


@kernel
def ratio(corner, bland, table):
    """Return the row whose variable reaches zero first while the entering one grows, or NONE.

    Of equal ratios the largest pivot is the most accurate; Bland's rule takes the lowest code.
    """
    basis, solution, column = table.basis, table.solution, table.column
    leaving, smallest = NONE, np.inf
    for i in range(basis.size):
        if i == corner or column[i] <= ZERO:
            continue
        r = max(solution[i], 0.0) / column[i]
        if leaving == NONE or r < smallest - ZERO:
            leaving, smallest = i, r
        elif r <= smallest + ZERO:
            preferred = basis[i] < basis[leaving] if bland else column[i] > column[leaving]
            if preferred:
                leaving, smallest = i, min(r, smallest)
    return leaving


@kernel
def pivot(leaving, entering, table):
    """Exchange the leaving variable for the entering one."""
    basis, inverse, solution, column = table.basis, table.inverse, table.solution, table.column
    for j in range(basis.size):
        inverse[leaving, j] /= column[leaving]
    solution[leaving] /= column[leaving]
    for i in range(basis.size):
        if i != leaving and column[i] != 0.0:
            for j in range(basis.size):
                inverse[i, j] -= column[i] * inverse[leaving, j]
            solution[i] -= column[i] * solution[leaving]
    basis[leaving] = entering


@kernel
def normalize(x):
    """Set negative entries to zero and divide by the sum."""
    total = 0.0
    for i in range(x.size):
        x[i] = max(x[i], 0.0)
        total += x[i]
    for i in range(x.size):
        x[i] /= total


@kernel
def finish(w, U, n, corner, table, b, mixture):
    """Fill in the belief and the mixture; return the bound that the mixture proves."""
    basis, weights = table.basis, table.column
    S = w.size
    for s in range(S):
        b[s] = table.inverse[corner, s]
    normalize(b)
    for i in range(S + 1):
        weights[i] = table.solution[i] if basis[i] >= 0 else 0.0
    normalize(weights)
    mixture[:n] = 0.0
    for i in range(S + 1):
        if basis[i] >= 0:
            mixture[basis[i]] = weights[i]
    bound = -np.inf
    for s in range(S):
        lead = w[s]
        for i in range(S + 1):
            if basis[i] >= 0:
                lead -= weights[i] * U[s, basis[i]]
        bound = max(bound, lead)
    return bound


@kernel
def witness(w, U, n, low, high, b, mixture, table):
    """Return an upper bound on max_b min_k b . (w - u_k) over the first n columns u_k of U.

    `b` becomes the belief and `mixture` the weights that prove the bound. The search stops early
    where the bound is not above `low`, or where a belief gains more than `high`.
    """
    corner = start(w, U, n, table)
    patience = PATIENCE * (w.size + 1)
    for step in range(10 * patience):
        if table.solution[corner] <= low:
            break
        bland = step >= patience
        entering, gained = price(U, n, corner, bland, table)
        if entering == NONE or gained > high + ZERO:
            break
        enter(U, entering, table)
        leaving = ratio(corner, bland, table)
        if leaving == NONE:
            break
        pivot(leaving, entering, table)
    return finish(w, U, n, corner, table, b, mixture)


@kernel
def greatest_gain(A, U, low, b, mixture):
    """Return an upper bound on max_i max_b min_k b . (A[i] - u_k), or `low` if that is larger.

    `b` becomes the belief where the gain is greatest, and `mixture` the weights that prove it.
    """
    S, K = U.shape
    belief, weights, table = np.empty(S), np.empty(K), tableau(S, K)
    for i in range(A.shape[0]):
        bound = witness(A[i], U, K, low, np.inf, belief, weights, table)
        if bound > low:
            low = bound
            b[:] = belief
            mixture[:] = weights
    return low


@kernel
def best_row(b, A):
    """Return the row of A that is best at b; of equal ones the lexicographically largest.

    However many rows meet at b, that one is the only best row at some belief nearby.
    """
    best, top = 0, -np.inf
    for k in range(A.shape[0]):
        value = 0.0
        for s in range(b.size):
            value += b[s] * A[k, s]
        if value > top + ZERO:
            best, top = k, value
        elif value >= top - ZERO:
            for s in range(b.size):
                difference = A[k, s] - A[best, s]
                if difference > ZERO:
                    best, top = k, max(top, value)
                if abs(difference) > ZERO:
                    break
    return best


class Kept(NamedTuple):
    """The sums that are known to be needed."""

    done: NDArray[np.bool_]  # shape (N, M): kept, or proved to add nothing
    sums: Floats  # shape (S, room): the sums, as columns
    pairs: NDArray[np.int64]  # shape (room, 2): the rows of A and of B
    beliefs: Floats  # shape (room, S): a belief where each is needed


@kernel
def keep(A, B, i, j, b, count, kept):
    """Enter the sum A[i] + B[j], which is needed at b; return how many there are now."""
    kept.done[i, j] = True
    kept.pairs[count, 0], kept.pairs[count, 1] = i, j
    for s in range(b.size):
        kept.sums[s, count] = A[i, s] + B[j, s]
        kept.beliefs[count, s] = b[s]
    return count + 1


@kernel
def prune_sums(A, B, eps, seeds, apart, pairs, beliefs):
    """Find the sums A[i] + B[j] that form the upper surface of all of them, up to `eps`.

    `pairs` and `beliefs` receive (i, j) and a belief where the sum is needed. Return how many there
    are, or -1 where there is not enough room. `seeds` are beliefs to look at first; pairs that
    are `apart` need no test.
    """
    n, S = A.shape
    m, room = B.shape[0], pairs.shape[0]
    kept = Kept(np.zeros((n, m), np.bool_), np.empty((S, room)), pairs, beliefs)
    w, b, mixture, table = np.empty(S), np.empty(S), np.empty(room), tableau(S, room)
    count = 0
    for p in range(seeds.shape[0]):
        x, y = best_row(seeds[p], A), best_row(seeds[p], B)
        gained = -values_at(seeds[p], 0.0, kept.sums, count, table.values)
        for s in range(S):
            gained += seeds[p, s] * (A[x, s] + B[y, s])
        if gained > eps and not kept.done[x, y]:
            if count == room:
                return -1
            count = keep(A, B, x, y, seeds[p], count, kept)
    for i in range(n):
        for j in range(m):
            while not (kept.done[i, j] or apart[i, j]):
                for s in range(S):
                    w[s] = A[i, s] + B[j, s]
                if witness(w, kept.sums, count, eps, eps, b, mixture, table) <= eps:
                    kept.done[i, j] = True
                    break
                # The witness shows that some sum is missing there: keep the best one.
                x, y = best_row(b, A), best_row(b, B)
                if kept.done[x, y]:  # by rounding: keep the pair itself rather than lose it
                    x, y = i, j
                if count == room:
                    return -1
                count = keep(A, B, x, y, b, count, kept)
    return count
