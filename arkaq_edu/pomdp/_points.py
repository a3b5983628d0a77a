"""Cheap steps of value iteration, at some beliefs only: what is done between two exact ones.

They prove nothing, but every vector they find is what some plan really earns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.pomdp.graph import follow, steps_and_rewards
from arkaq_edu.pomdp.model import POMDP

Floats = NDArray[np.floating]
Ints = NDArray[np.int64]


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
    steps, rewards = steps_and_rewards(pomdp)
    # A little of every state, so that a choice is also good where it does not matter at the point.
    points = (1 - 1e-6) * points + 1e-6 / pomdp.n_states
    alphas = alphas[(points @ alphas.T).argmax(axis=1)]
    heights = (points * alphas).sum(axis=1)
    rows = np.arange(len(points))
    enough = max(enough, 1e-14 * np.abs(alphas).max())  # no rise by rounding alone
    while True:
        once, actions, branches = point_backup(pomdp, alphas, points)
        always = once.copy()
        follow(steps, rewards, actions, branches, enough / 10, 1000, always)
        improved = np.concatenate([once, always])
        now = points @ improved.T
        best = now.argmax(axis=1)
        rise = now[rows, best] - heights
        up = rise > 0
        alphas[up], heights[up] = improved[best[up]], now[rows, best][up]
        if not rise.max() > enough:
            return alphas
