"""Q-learning against other libraries, run in turn in one process.

    python benchmarks/bench_q_learning.py

A peer that is not installed (mushroom-rl) is left out. "Limit" is the same
arithmetic in one plain compiled loop. Each number is the median of several rounds. A round runs our
code and every peer once, so that a busy machine slows all of them alike; the ratio is the median of
the ratios of the rounds.
"""

from __future__ import annotations

import statistics
import time
import warnings
from collections.abc import Callable

import numpy as np

from arkaq_edu._compiled import kernel
from arkaq_edu.mdp import MDP, QLearner, train

N_STATES, N_ACTIONS, GAMMA = 337, 3, 0.9
ROUNDS = 7


def world(n_states: int = N_STATES, n_actions: int = N_ACTIONS) -> MDP:
    """Return a random model where each action leads to a few states."""
    rng = np.random.default_rng(0)
    T = rng.dirichlet(np.full(n_states, 0.05), size=(n_actions, n_states))
    return MDP(T, rng.normal(size=(n_states, n_actions)), GAMMA)


def seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def compare(title: str, amount: int, ours: Callable[[], object], **peers: tuple[int, Callable]):
    """Time `ours` (doing `amount` of the work) and each peer (its own amount) in turn."""
    ours()
    rounds = []
    for _ in range(ROUNDS):
        mine = seconds(ours) / amount
        rounds.append((mine, {name: seconds(run) / n for name, (n, run) in peers.items()}))
    mine = statistics.median(r[0] for r in rounds)
    print(f"{title:34} {mine * 1e6:12.3f} us {1 / mine:16,.0f} /s")
    for name in peers:
        peer = statistics.median(r[1][name] for r in rounds)
        ratio = statistics.median(r[1][name] / r[0] for r in rounds)
        print(f"    {name:30} {peer * 1e6:12.3f} us {1 / peer:16,.0f} /s   we: {ratio:,.1f} times")


@kernel
def limit_of_replay(Q, visits, s, a, r, s_next, alpha, gamma, changes):
    for t in range(len(s)):
        best = Q[s_next[t], 0]
        for b in range(1, Q.shape[1]):
            best = max(best, Q[s_next[t], b])
        old = Q[s[t], a[t]]
        Q[s[t], a[t]] += alpha * (r[t] + gamma * best - old)
        visits[s[t], a[t]] += 1
        changes[t] = Q[s[t], a[t]] - old


@kernel
def limit_of_training(Q, visits, cumulative, R, ends, u, alpha, gamma, changes):
    s = 0
    for t in range(len(u)):
        a = int(u[t, 1] * Q.shape[1])
        s_next = np.searchsorted(cumulative[a, s], u[t, 2], side="right")
        best = Q[s_next, 0]
        for b in range(1, Q.shape[1]):
            best = max(best, Q[s_next, b])
        target = R[s, a] + (0.0 if ends[s_next] else gamma * best)
        old = Q[s, a]
        Q[s, a] += alpha * (target - old)
        visits[s, a] += 1
        changes[t] = Q[s, a] - old
        s = s_next


def mushroom(n: int) -> dict[str, Callable[[], object]]:
    """Return mushroom-rl's replay of n transitions and its learning loop of n steps."""
    try:
        from mushroom_rl.algorithms.value import QLearning
        from mushroom_rl.core import Core
        from mushroom_rl.environments import FiniteMDP
        from mushroom_rl.policy import EpsGreedy
        from mushroom_rl.utils.parameters import Parameter
    except ImportError:
        return {}
    model = world()
    reward = np.repeat(model.R[:, :, None], N_STATES, axis=2)
    env = FiniteMDP(model.T.transpose(1, 0, 2).copy(), reward, gamma=GAMMA, horizon=100)
    agent = QLearning(env.info, EpsGreedy(Parameter(1.0)), Parameter(0.5))
    core = Core(agent, env)
    rng = np.random.default_rng(1)
    s, s_next = rng.integers(N_STATES, size=(2, n, 1))
    a = rng.integers(N_ACTIONS, size=(n, 1))

    def replay() -> None:
        for t in range(n):
            agent._update(s[t], a[t], 1.0, s_next[t], False)

    def learn() -> None:
        core.learn(n_steps=n, n_steps_per_fit=1, quiet=True)

    return {"replay": replay, "learn": learn}


def q_updates() -> None:
    n = 200_000
    rng = np.random.default_rng(1)
    s, s_next = rng.integers(N_STATES, size=(2, n))
    a, r = rng.integers(N_ACTIONS, size=n), rng.normal(size=n)
    learner = QLearner(N_STATES, N_ACTIONS, alpha=0.5, gamma=GAMMA, rng=0)
    rows = list(zip(s.tolist(), a.tolist(), r.tolist(), s_next.tolist(), strict=True))
    model = world()
    cumulative = model.T.cumsum(axis=2)

    def updates() -> None:
        update = learner.update
        for s, a, r, s_next in rows:
            update(s, a, r, s_next)

    def decisions() -> None:
        for s, _, r, s_next in rows:
            learner.update(s, learner.boltzmann(s, 0.5), r, s_next)

    def replay_limit() -> None:
        limit_of_replay(learner.Q, learner.visits, s, a, r, s_next, 0.5, GAMMA, np.empty(n))

    def training_limit() -> None:
        u = learner.rng.random((n, 3))
        limit_of_training(
            learner.Q, learner.visits, cumulative, model.R, model.ends, u, 0.5, GAMMA, np.empty(n)
        )  # fmt: skip

    replay_limit(), training_limit()  # compiled now
    peer = mushroom(5000)
    replay = {"mushroom-rl replay": (5000, peer["replay"])} if peer else {}
    learn = {"mushroom-rl learning loop": (5000, peer["learn"])} if peer else {}
    compare("update, called from Python", n, updates, **replay, **learn)
    compare("boltzmann + update, from Python", n, decisions, **learn)
    compare(
        "replay, one call", n, lambda: learner.replay(s, a, r, s_next, False),
        **{"limit": (n, replay_limit)}, **replay,
    )  # fmt: skip
    compare(
        "train (model, choice, update)", n, lambda: train(model, learner, n),
        **{"limit": (n, training_limit)}, **learn,
    )  # fmt: skip


def main() -> None:
    warnings.simplefilter("ignore")
    q_updates()


if __name__ == "__main__":
    main()
