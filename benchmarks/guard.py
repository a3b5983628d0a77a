"""A short guard against slow code: ``make guard``.

Ours beside a plain limit, the minimum of many repeats of each, so that a busy machine does not
matter. A ratio may be twice what was measured when the line was written.
"""

from __future__ import annotations

import sys

import numpy as np

from arkaq_edu.art import EuclideanART
from arkaq_edu.kalman import KalmanFilter, kalman_batch
from arkaq_edu.mdp import QLearner, modified_policy_iteration, train, value_iteration
from arkaq_edu.pomdp import POMDP, belief_update
from benchmarks import art, kalman, mdp
from benchmarks.case import Run, timed

REPEATS = 15


def brute_batch(Z: np.ndarray) -> None:
    """Filter all tracks, without gaps, by the plain equations on stacked matrices."""
    A, H, Q, R = kalman.A, kalman.H, kalman.Q, kalman.R
    x, P = np.zeros((len(Z), 4, 1)), kalman.P0
    for t in range(Z.shape[1]):
        x, P = A @ x, A @ P @ A.T + Q
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
        x, P = x + K @ (Z[:, t, :, np.newaxis] - H @ x), P - K @ H @ P


def sweeps(model, n: int) -> None:
    """Make n plain sweeps of value iteration."""
    V = np.zeros(model.n_states)
    for _ in range(n):
        V = (model.R.T + model.gamma * (model.stacked @ V).reshape(model.R.T.shape)).max(axis=0)


def pairs() -> dict[str, tuple[Run, Run, float]]:
    """Return ours, the limit, and the ratio of the times that was measured."""
    n = 20_000
    rng = np.random.default_rng(1)
    s, s_next = rng.integers(mdp.S, size=(2, n))
    a, r = rng.integers(mdp.A, size=n), rng.normal(size=n)
    learner, model = QLearner(mdp.S, mdp.A, 0.5, 0.9, rng=0), mdp.dense_world(mdp.S, mdp.A)
    tables, cumulative = (learner.Q, learner.visits), model.T.cumsum(axis=2)
    sparse, X = mdp.sparse_world(500), art.square(5000)
    short, many = kalman.sightings(2000), kalman.sightings(200, 100)
    kf = KalmanFilter(kalman.A, kalman.H, kalman.Q, kalman.R, P0=kalman.P0)
    pomdp = POMDP(rng.dirichlet(np.ones(12), (2, 12)), rng.dirichlet(np.ones(3), (2, 12)),
                  np.zeros((12, 2)), 0.9)  # fmt: skip
    b, T, O = belief_update(pomdp, pomdp.start, 0, 0), pomdp.T, pomdp.O  # noqa: E741

    def one_line() -> None:
        joint = O[0, :, 0] * (b @ T[0])
        joint / joint.sum()

    system = kalman.A, kalman.H, kalman.Q, kalman.R
    changes = np.empty(n)
    return {
        "QLearner.replay": (
            lambda: learner.replay(s, a, r, s_next, False),
            lambda: mdp.replay_limit(*tables, s, a, r, s_next, 0.5, 0.9, changes),
            2.2,
        ),
        "train on a model": (
            lambda: train(model, learner, n),
            lambda: mdp.training_limit(
                *tables, cumulative, model.R, model.ends, learner.rng.random((n, 3)), 0.5, 0.9,
                changes,
            ),
            2.0,
        ),
        "value_iteration": (lambda: value_iteration(sparse, 1e-6), lambda: sweeps(sparse, 50), 0.7),
        "modified_policy_iteration": (
            lambda: modified_policy_iteration(sparse, 1e-6), lambda: sweeps(sparse, 50), 1.3,
        ),
        "EuclideanART.fit": (
            lambda: EuclideanART(0.05).fit(X),
            lambda: art.limit(X, 0.05, 0.5, np.empty_like(X)),
            0.2,
        ),
        "KalmanFilter.filter": (
            lambda: kf.filter(short), lambda: brute_batch(short[np.newaxis, :200]), 0.12,
        ),
        "kalman_batch": (
            lambda: kalman_batch(*system, many, P0=kalman.P0), lambda: brute_batch(many), 0.3,
        ),
        "belief_update": (lambda: belief_update(pomdp, b, 0, 0), one_line, 1.7),
    }  # fmt: skip


def least(ours: Run, limit: Run) -> float:
    """Return the ratio of the shortest times, both taken in turns."""
    loops = [max(1, round(0.001 / min(timed(run) for _ in range(3)))) for run in (ours, limit)]
    times = [[timed(run, n) for run, n in zip((ours, limit), loops, strict=True)]
             for _ in range(REPEATS)]  # fmt: skip
    best = np.min(times, axis=0)
    return float(best[0] / best[1])


def main() -> None:
    slow = []
    for name, (ours, limit, usual) in pairs().items():
        ratio = least(ours, limit)
        for _ in range(2):  # the whole first measurement may have been disturbed
            ratio = ratio if ratio <= 2 * usual else min(ratio, least(ours, limit))
        print(f"{name:28} {ratio:6.2f} times the limit, at most {2 * usual:.2f}")
        slow += [name] if ratio > 2 * usual else []
    if slow:
        sys.exit(f"more than twice as slow as they were: {', '.join(slow)}")


if __name__ == "__main__":
    main()
