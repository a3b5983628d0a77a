"""The loops of pruning: a small simplex method that looks for a belief where a vector is needed.

A vector w against vectors u_0 ... u_{K-1} is a game. One player picks a belief b, the other a
mixture m of the u; the first gains b . (w - m). Its value, max_b min_k b . (w - u_k), says what w
adds to the upper surface of the u: with b, the witness, at hand it adds that much there; with m at
hand it adds nowhere more. Each half is checked by plain arithmetic, so that nothing rests on the
simplex method's own rounding.

It runs on the mixture's side: minimize t over m >= 0 with sum m = 1 and (w - m)(s) <= t in every
state s. S states give S + 1 equations however many the vectors are, and a basis of as many columns:
t itself, some of the u, and for the other states what is lacking to t, their slack. The prices of
the equations are the belief. Where the belief is one and no u is better at it than t allows, both
have found their best.

The u stand in the columns of an array U, so that what is done to all of them is done along rows.
"""

from __future__ import annotations

import numpy as np

from arkaq_edu._compiled import kernel

# Numbers of this size are zero: who calls has scaled the vectors' differences to about one.
ZERO = 1e-13


@kernel
def heights_at(prices, constant, U, n, heights):
    """Set heights[k] = constant + prices . u_k for the first n vectors; return the largest."""
    for k in range(n):
        heights[k] = constant
    for s in range(U.shape[0]):
        price = prices[s]
        if price != 0.0:
            for k in range(n):
                heights[k] += price * U[s, k]
    top = -np.inf
    for k in range(n):
        top = max(top, heights[k])
    return top


@kernel
def gain(w, U, n, low, high, b, mixture, basis, inverse, solution, column, heights):
    """Return an upper bound on max_b min_k b . (w - u_k), over the first n vectors u.

    Leaves the belief in `b` and the mixture that proves the bound in `mixture`. Stops early where
    the bound is no more than `low`, or where a belief gains more than `high`.
    """
    S = w.size
    # The vector that w exceeds least anywhere is where to begin; alone it may already do.
    for k in range(n):
        heights[k] = -np.inf
    for s in range(S):
        for k in range(n):
            heights[k] = max(heights[k], w[s] - U[s, k])
    first = 0
    for k in range(n):
        if heights[k] < heights[first]:
            first = k
    bound = heights[first]
    corner = 0
    for s in range(S):
        b[s] = 0.0
        if w[s] - U[s, first] > w[corner] - U[corner, first]:
            corner = s
    b[corner] = 1.0
    if bound <= low:
        for k in range(n):
            mixture[k] = 0.0
        mixture[first] = 1.0
        return bound

    # Row i of the inverse belongs to basis[i]: k >= 0 is vector k, -1 is t, -2 - s a slack.
    for i in range(S + 1):
        for j in range(S + 1):
            inverse[i, j] = 0.0
    for s in range(S):
        basis[s] = -2 - s
        inverse[s, s] = -1.0
        inverse[s, corner] = 1.0
        inverse[s, S] = U[s, first] - U[corner, first]
        solution[s] = inverse[s, S] + w[corner] - w[s]
    basis[corner], basis[S] = -1, first
    inverse[corner, S] = -U[corner, first]
    inverse[S, S], solution[S] = 1.0, 1.0
    solution[corner] = w[corner] - U[corner, first]

    cautious = 20 * (S + 1)  # from here on the first that may enter does: so none comes for ever
    for step in range(10 * cautious):
        # The prices: a belief, as far as no entry is negative, and the price of sum m = 1.
        entering, best, lowest = -1, ZERO, 0.0
        for s in range(S):
            price = -inverse[corner, s]
            lowest = max(lowest, price)
            if price > best and (step < cautious or entering == -1):
                entering, best = -2 - s, price
        top = heights_at(inverse[corner], inverse[corner, S], U, n, heights)
        if top > best and (step < cautious or entering == -1):
            for k in range(n):
                if heights[k] == top or (step >= cautious and heights[k] > best):
                    entering = k
                    break
        # t exceeds what the belief gains by the height of the best answer to it.
        if lowest <= ZERO and solution[corner] - top > high + ZERO:
            break
        if entering == -1:
            break
        # How the basis answers to the entering column, and who is first to reach zero.
        for i in range(S + 1):
            if entering >= 0:
                total = inverse[i, S]
                for s in range(S):
                    total += inverse[i, s] * U[s, entering]
            else:
                total = -inverse[i, -2 - entering]
            column[i] = total
        leaving, ratio = -1, np.inf
        for i in range(S + 1):
            if i == corner or column[i] <= ZERO:
                continue
            r = max(solution[i], 0.0) / column[i]
            if leaving == -1 or r < ratio - ZERO:
                leaving, ratio = i, r
            elif r <= ratio + ZERO:
                larger = column[i] > column[leaving]
                if basis[i] < basis[leaving] if step >= cautious else larger:
                    leaving, ratio = i, min(r, ratio)
        if leaving == -1:
            break
        pivot = column[leaving]
        for j in range(S + 1):
            inverse[leaving, j] /= pivot
        solution[leaving] /= pivot
        for i in range(S + 1):
            if i != leaving and column[i] != 0.0:
                for j in range(S + 1):
                    inverse[i, j] -= column[i] * inverse[leaving, j]
                solution[i] -= column[i] * solution[leaving]
        basis[leaving] = entering
        if solution[corner] <= low:
            break

    # Whatever the steps came to: clean both answers, and see what the mixture proves.
    total = 0.0
    for s in range(S):
        b[s] = max(inverse[corner, s], 0.0)
        total += b[s]
    for s in range(S):
        b[s] /= total
    total = 0.0
    for i in range(S + 1):
        if basis[i] >= 0:
            total += max(solution[i], 0.0)
    for k in range(n):
        mixture[k] = 0.0
    for i in range(S + 1):
        if basis[i] >= 0:
            mixture[basis[i]] = max(solution[i], 0.0) / total
    bound = -np.inf
    for s in range(S):
        height = w[s]
        for i in range(S + 1):
            if basis[i] >= 0:
                height -= mixture[basis[i]] * U[s, basis[i]]
        bound = max(bound, height)
    return bound


@kernel
def furthest(A, U, low, b, mixture):
    """Return an upper bound on max_i max_b min_k b . (A[i] - u_k), or `low` where that is larger.

    Leaves the belief where it is, and the mixture of the u that proves it, in `b` and `mixture`.
    """
    S, K = U.shape
    w, belief, weights, heights = np.empty(S), np.empty(S), np.empty(K), np.empty(K)
    basis, inverse = np.empty(S + 1, np.int64), np.empty((S + 1, S + 1))
    solution, column = np.empty(S + 1), np.empty(S + 1)
    for i in range(A.shape[0]):
        for s in range(S):
            w[s] = A[i, s]
        bound = gain(
            w, U, K, low, np.inf, belief, weights, basis, inverse, solution, column, heights
        )
        if bound > low:
            low = bound
            for s in range(S):
                b[s] = belief[s]
            for k in range(K):
                mixture[k] = weights[k]
    return low


@kernel
def highest(b, A):
    """Return which row is best at b; of equals the lexicographic largest.

    That one is best somewhere alone too, however many meet at b.
    """
    best, top = 0, -np.inf
    for k in range(A.shape[0]):
        height = 0.0
        for s in range(b.size):
            height += b[s] * A[k, s]
        if height > top + ZERO:
            best, top = k, height
        elif height >= top - ZERO:
            for s in range(b.size):
                difference = A[k, s] - A[best, s]
                if difference > ZERO:
                    best, top = k, max(top, height)
                if abs(difference) > ZERO:
                    break
    return best


@kernel
def needed_sums(A, B, eps, seeds, apart, pairs, beliefs):
    """Keep the sums A[i] + B[j] that form the upper surface of all of them, up to `eps`.

    Leaves (i, j) and a belief where it is needed in `pairs` and `beliefs`, and returns how many, or
    -1 where there is no room for all. The seeds are beliefs to look at first; pairs that are apart
    need not be tried.
    """
    n, S = A.shape
    m, room = B.shape[0], pairs.shape[0]
    kept, done = np.empty((S, room)), np.zeros((n, m), np.bool_)
    w, b, mixture, heights = np.empty(S), np.empty(S), np.empty(room), np.empty(room)
    basis, inverse = np.empty(S + 1, np.int64), np.empty((S + 1, S + 1))
    solution, column = np.empty(S + 1), np.empty(S + 1)
    count = 0
    # Every seed is looked at once; then every pair until it is kept or proved to add nothing.
    for task in range(seeds.shape[0] + n * m):
        pair = task - seeds.shape[0]
        i, j = pair // m, pair % m
        while pair < 0 or not (done[i, j] or apart[i, j]):
            if pair < 0:
                for s in range(S):
                    b[s] = seeds[task, s]
            else:
                for s in range(S):
                    w[s] = A[i, s] + B[j, s]
                bound = gain(
                    w, kept, count, eps, eps, b, mixture, basis, inverse, solution, column, heights
                )
                if bound <= eps:
                    done[i, j] = True
                    break
            x, y = highest(b, A), highest(b, B)
            if pair < 0:
                gained = -heights_at(b, 0.0, kept, count, heights)
                for s in range(S):
                    gained += b[s] * (A[x, s] + B[y, s])
                if done[x, y] or gained <= eps:
                    break
            elif done[x, y]:  # rounding: keep the pair itself rather than lose it
                x, y = i, j
            if count == room:
                return -1
            done[x, y] = True
            pairs[count, 0], pairs[count, 1] = x, y
            for s in range(S):
                kept[s, count] = A[x, s] + B[y, s]
                beliefs[count, s] = b[s]
            count += 1
            if pair < 0:
                break
    return count
