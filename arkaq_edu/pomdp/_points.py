"""Cheap steps of value iteration, at some beliefs only: what is done between two exact ones.

They prove nothing, but every vector they find is what some plan really earns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._compiled import kernel
from arkaq_edu.pomdp.model import POMDP

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]


@kernel
def follow(steps, rewards, actions, branches, enough, values):
    """Turn guessed values of a policy graph's nodes into its own, until they change no more.

    `steps[a, z, s, t]` is gamma T(s, a, t) O(t, a, z) and `rewards[a, s]` is R(s, a).
    """
    N, S = values.shape
    change = np.inf
    for _ in range(1000):
        change = 0.0
        for n in range(N):
            a = actions[n]
            for s in range(S):
                total = rewards[a, s]
                for z in range(branches.shape[1]):
                    rest = branches[n, z]
                    for t in range(S):
                        total += steps[a, z, s, t] * values[rest, t]
                change = max(change, abs(total - values[n, s]))
                values[n, s] = total
        if change <= enough:
            break
    return change


def point_backup(pomdp: POMDP, alphas: Floats, points: Floats) -> tuple[Floats, Ints, Ints]:
    """Return, for each of some beliefs, the vector of H V that is best there, and its choices."""
    A, Z, N = pomdp.n_actions, pomdp.n_observations, len(points)
    vectors = np.empty((A, N, pomdp.n_states))
    branches = np.empty((A, N, Z), np.int64)
    for a in range(A):
        joint = (points @ pomdp.T[a])[:, np.newaxis] * pomdp.O[a].T  # (N, Z, S')
        branches[a] = (joint @ alphas.T).argmax(axis=2)
        later = (pomdp.O[a].T * alphas[branches[a]]).sum(axis=1)
        vectors[a] = pomdp.R[:, a] + pomdp.gamma * later @ pomdp.T[a].T
    actions = (vectors * points).sum(axis=2).argmax(axis=0)
    rows = np.arange(N)
    return vectors[actions, rows], actions, branches[actions, rows]


def improve(pomdp: POMDP, alphas: Floats, points: Floats, enough: float) -> Floats:
    """Return a vector for each point, no worse there than the best of `alphas`.

    Policy iteration: choose at each point, follow the choices, until no point rises by more than
    `enough`. What would be worse at its point is not taken, so that the heights only rise.
    """
    steps = pomdp.gamma * pomdp.T[:, np.newaxis] * pomdp.O.transpose(0, 2, 1)[:, :, np.newaxis]
    rewards = np.ascontiguousarray(pomdp.R.T)
    # A little of every state, so that a choice is also good where it does not matter at the point.
    points = (1 - 1e-6) * points + 1e-6 / pomdp.n_states
    alphas = alphas[(points @ alphas.T).argmax(axis=1)]
    heights = (points * alphas).sum(axis=1)
    rows = np.arange(len(points))
    while True:
        once, actions, branches = point_backup(pomdp, alphas, points)
        always = once.copy()
        follow(steps, rewards, actions, branches, enough / 10, always)
        improved = np.concatenate([once, always])
        now = points @ improved.T
        best = now.argmax(axis=1)
        rise = now[rows, best] - heights
        up = rise > 0
        alphas[up], heights[up] = improved[best[up]], now[rows, best][up]
        if not rise.max() > enough:
            return alphas
