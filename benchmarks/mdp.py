"""Planning in a known model, and Q-learning in a table."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy import sparse

from arkaq_edu._compiled import kernel
from arkaq_edu.mdp import (
    MDP,
    QLearner,
    modified_policy_iteration,
    policy_iteration,
    train,
    value_iteration,
)
from benchmarks.case import Case, Growth, Run, installed

TOL, GAMMA, ALPHA = 1e-6, 0.9, 0.5
S, A = 337, 3


def dense_world(n_states: int, n_actions: int) -> MDP:
    """Return a random model where each action leads to a few states."""
    rng = np.random.default_rng(0)
    T = rng.dirichlet(np.full(n_states, 0.05), size=(n_actions, n_states))
    return MDP(T, rng.normal(size=(n_states, n_actions)), GAMMA)


def sparse_world(n_states: int, n_actions: int = 4, n_successors: int = 10) -> MDP:
    """Return a random sparse model."""
    rng = np.random.default_rng(0)
    first = np.arange(0, n_states * n_successors + 1, n_successors)
    T = []
    for _ in range(n_actions):
        successors = [rng.choice(n_states, n_successors, replace=False) for _ in range(n_states)]
        chances = rng.dirichlet(np.ones(n_successors), size=n_states)
        T.append(sparse.csr_array((chances.ravel(), np.concatenate(successors), first)))
    return MDP(T, rng.normal(size=(n_states, n_actions)), 0.95)


def quantecon(model: MDP, method: str) -> dict[str, tuple[float, Run]]:
    """Return quantecon's solver for the model, in the form (dense or sparse) that it has."""
    if not installed("quantecon"):
        return {}
    from quantecon.markov import DiscreteDP

    if sparse.issparse(model.stacked):
        s = np.tile(np.arange(model.n_states), model.n_actions)
        a = np.repeat(np.arange(model.n_actions), model.n_states)
        order = np.lexsort((a, s))
        Q = sparse.csr_matrix(model.stacked[order])
        ddp = DiscreteDP(model.R[s, a][order], Q, model.gamma, s[order], a[order])
    else:
        R = np.ascontiguousarray(model.R)
        ddp = DiscreteDP(R, model.T.transpose(1, 0, 2).copy(), model.gamma)
    return {"quantecon": (1, lambda: ddp.solve(method=method, epsilon=TOL))}


def toolbox(model: MDP, name: str) -> dict[str, tuple[float, Run]]:
    """Return pymdptoolbox's solver for a dense model; on a sparse one it takes a minute."""
    if sparse.issparse(model.stacked) or not installed("mdptoolbox"):
        return {}
    from mdptoolbox import mdp

    solver, R = getattr(mdp, name), np.array(model.R)
    extra = {} if name == "PolicyIteration" else {"epsilon": TOL}
    return {"pymdptoolbox": (1, lambda: solver(model.T, R, model.gamma, **extra).run())}


@kernel
def replay_limit(Q, visits, s, a, r, s_next, alpha, gamma, changes):
    for t in range(len(s)):
        best = Q[s_next[t], 0]
        for b in range(1, Q.shape[1]):
            best = max(best, Q[s_next[t], b])
        old = Q[s[t], a[t]]
        Q[s[t], a[t]] += alpha * (r[t] + gamma * best - old)
        visits[s[t], a[t]] += 1
        changes[t] = Q[s[t], a[t]] - old


@kernel
def training_limit(Q, visits, cumulative, R, ends, u, alpha, gamma, changes):
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


def mushroom(model: MDP, n: int) -> tuple[dict[str, tuple[float, Run]], ...]:
    """Return mushroom-rl's replay of n transitions and its learning loop of n steps."""
    if not installed("mushroom_rl"):
        return {}, {}
    from mushroom_rl.algorithms.value import QLearning
    from mushroom_rl.core import Core
    from mushroom_rl.environments import FiniteMDP
    from mushroom_rl.policy import EpsGreedy
    from mushroom_rl.utils.parameters import Parameter

    reward = np.repeat(model.R[:, :, None], S, axis=2)
    env = FiniteMDP(model.T.transpose(1, 0, 2).copy(), reward, gamma=GAMMA, horizon=100)
    agent = QLearning(env.info, EpsGreedy(Parameter(1.0)), Parameter(ALPHA))
    core = Core(agent, env)
    rng = np.random.default_rng(1)
    s, s_next = rng.integers(S, size=(2, n, 1))
    a = rng.integers(A, size=(n, 1))

    def replay() -> None:
        for t in range(n):
            agent._update(s[t], a[t], 1.0, s_next[t], False)

    def learn() -> None:
        core.learn(n_steps=n, n_steps_per_fit=1, quiet=True)

    return {"mushroom-rl": (n, replay)}, {"mushroom-rl": (n, learn)}


def q_learning() -> Iterator[Case]:
    n = 200_000
    rng = np.random.default_rng(1)
    s, s_next = rng.integers(S, size=(2, n))
    a, r = rng.integers(A, size=n), rng.normal(size=n)
    learner = QLearner(S, A, alpha=ALPHA, gamma=GAMMA, rng=0)
    few = list(zip(s.tolist(), a.tolist(), r.tolist(), s_next.tolist(), strict=True))[:5000]
    model = dense_world(S, A)
    cumulative = model.T.cumsum(axis=2)
    tables = learner.Q, learner.visits
    replayed, learned = mushroom(model, 2000)

    def updates() -> None:
        for experience in few:
            learner.update(*experience)

    yield Case("QLearner.update, from Python", "step", len(few), updates, replayed)
    limit: tuple[float, Run] = (
        n, lambda: replay_limit(*tables, s, a, r, s_next, ALPHA, GAMMA, np.empty(n)),
    )  # fmt: skip
    yield Case(
        "QLearner.replay, one call", "step", n, lambda: learner.replay(s, a, r, s_next, False),
        {"limit": limit} | replayed, {"limit": 1 / 1.3},
    )  # fmt: skip
    limit = n, lambda: training_limit(
        *tables, cumulative, model.R, model.ends, learner.rng.random((n, 3)), ALPHA, GAMMA,
        np.empty(n),
    )  # fmt: skip
    yield Case(
        "train on a model, random actions", "step", n, lambda: train(model, learner, n),
        {"limit": limit} | learned, {"limit": 1 / 1.3},
    )  # fmt: skip


def cases() -> Iterator[Case | Growth]:
    for title, model, at_least in (
        ("200 x 4, dense", dense_world(200, 4), (1.0, 1.0)),
        ("2,000 x 4, sparse", sparse_world(2000), (3.0, 1.0)),
    ):
        others = quantecon(model, "value_iteration") | toolbox(model, "ValueIteration")
        ours = lambda model=model: value_iteration(model, TOL)  # noqa: E731
        wanted = {"quantecon": at_least[0]}
        yield Case(f"value_iteration, {title}", "solution", 1, ours, others, wanted)
        others = quantecon(model, "modified_policy_iteration")
        others |= toolbox(model, "PolicyIterationModified")
        ours = lambda model=model: modified_policy_iteration(model, TOL)  # noqa: E731
        wanted = {"quantecon": at_least[1]}
        yield Case(f"modified_policy_iteration, {title}", "solution", 1, ours, others, wanted)
    # A sparse linear system of a random graph fills up: no library solves it exactly in good time.
    model = dense_world(200, 4)
    others = quantecon(model, "policy_iteration") | toolbox(model, "PolicyIteration")
    ours = lambda: policy_iteration(model)  # noqa: E731
    title = "policy_iteration, 200 x 4, dense"
    yield Case(title, "solution", 1, ours, others, {"quantecon": 1.0})
    yield from q_learning()
    yield Growth(
        "value_iteration, sparse", "states", [500, 2000, 8000],
        lambda n: partial(value_iteration, sparse_world(n), TOL), at_most=1.3,
    )  # fmt: skip
