"""The bounds of `point_based` at many beliefs, compiled.

Beliefs come without their zeros, as (ends, states, chances): row i holds the probabilities
``chances[j]`` of ``states[j]`` for j from ``ends[i]`` to ``ends[i + 1]``. A row may sum to less
than 1; its bound is in proportion.
"""

from __future__ import annotations

import numpy as np

from arkaq_edu._compiled import kernel


@kernel
def lower(rows, alphas):
    """Return max_k b . alphas[k] for each row b, and the first k that attains it."""
    ends, states, chances = rows
    bounds, best = np.empty(len(ends) - 1), np.zeros(len(ends) - 1, dtype=np.int64)
    support = np.empty(alphas.shape[1], dtype=np.int64)
    for i in range(len(bounds)):
        n = 0
        for j in range(ends[i], ends[i + 1]):
            if chances[j] > 0:
                support[n] = j
                n += 1
        bounds[i] = -np.inf if n else 0.0
        for k in range(len(alphas) if n else 0):
            value = 0.0
            for m in range(n):
                value += chances[support[m]] * alphas[k, states[support[m]]]
            if value > bounds[i]:
                bounds[i], best[i] = value, k
    return bounds, best


@kernel
def upper(rows, corners, points, below, vectors):
    """Return the upper bound for each row b. It is the lowest of three.

    The plane through the corners; that plane minus the sawtooth of a point; and the fast informed
    bound. below[i] <= 0 is how far point p_i lies below the plane. With r = min_s b(s) / p_i(s), b
    is r p_i plus a rest, and because V* is convex, the bound at b is lower by r below[i] at least.
    """
    ends, states, chances = rows
    point_ends, point_states, point_chances = points
    bounds = np.zeros(len(ends) - 1)
    b = np.zeros(len(corners))
    for k in range(len(bounds)):
        mass, flat = 0.0, 0.0
        for j in range(ends[k], ends[k + 1]):
            b[states[j]] = chances[j]
            mass += chances[j]
            flat += chances[j] * corners[states[j]]
        if mass == 0.0:
            continue
        deepest = 0.0
        for i in range(len(below)):
            r = mass
            for j in range(point_ends[i], point_ends[i + 1]):
                if r * below[i] >= deepest:
                    break
                r = min(r, b[point_states[j]] / point_chances[j])
            deepest = min(deepest, r * below[i])
        informed = -np.inf
        for a in range(len(vectors)):
            value = 0.0
            for j in range(ends[k], ends[k + 1]):
                value += chances[j] * vectors[a, states[j]]
            informed = max(informed, value)
        bounds[k] = min(flat + deepest, informed)
        for j in range(ends[k], ends[k + 1]):
            b[states[j]] = 0.0
    return bounds


@kernel
def dominated(alphas, by):
    """Set by[i] = j for each row i that is nowhere above another row j; by[i] = i before."""
    for i in range(len(alphas)):
        for j in range(len(alphas)):
            if i == j or by[j] != j:
                continue
            s = 0
            while s < alphas.shape[1] and alphas[i, s] <= alphas[j, s]:
                s += 1
            if s == alphas.shape[1]:
                by[i] = j
                break


@kernel
def needed(points, below, n_states):
    """Return which points are below the sawtooth of all others."""
    ends, states, chances = points
    found = np.ones(len(below), dtype=np.bool_)
    b = np.zeros(n_states)
    for i in range(len(below)):
        for j in range(ends[i], ends[i + 1]):
            b[states[j]] = chances[j]
        for other in range(len(below)):
            if i == other or not found[other] or below[other] > below[i]:
                continue
            r = 1.0
            for j in range(ends[other], ends[other + 1]):
                r = min(r, b[states[j]] / chances[j])
                if r == 0.0:
                    break
            if r * below[other] <= below[i]:
                found[i] = False
                break
        for j in range(ends[i], ends[i + 1]):
            b[states[j]] = 0.0
    return found
