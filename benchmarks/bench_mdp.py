"""Planning in a known model against other libraries, run in turn in one process.

    python benchmarks/bench_mdp.py

A peer that is not installed (quantecon, pymdptoolbox) is left out. All solve the same model to the
same tolerance. Each number is the median of several rounds. A round runs our code and every peer
once, so that a busy machine slows all of them alike; the ratio is the median of the ratios of the
rounds.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy import sparse

sys.path.insert(0, str(Path(__file__).parent))
from bench_q_learning import compare, world

from arkaq_edu.mdp import MDP, modified_policy_iteration, policy_iteration, value_iteration

TOL = 1e-6
#: Solved so many times in a round: one solution is shorter than a turn on a busy machine.
TIMES = 20


def sparse_world(n_states: int, n_actions: int, n_successors: int, gamma: float) -> MDP:
    """Return a random sparse model where each action leads to a few states."""
    rng = np.random.default_rng(0)
    first = np.arange(0, n_states * n_successors + 1, n_successors)
    T = []
    for _ in range(n_actions):
        successors = [rng.choice(n_states, n_successors, replace=False) for _ in range(n_states)]
        chances = rng.dirichlet(np.ones(n_successors), size=n_states)
        T.append(sparse.csr_array((chances.ravel(), np.concatenate(successors), first)))
    return MDP(T, rng.normal(size=(n_states, n_actions)), gamma)


def repeated(run: Callable[[], object]) -> Callable[[], object]:
    """Return a function that runs another one `TIMES` times."""
    return lambda: [run() for _ in range(TIMES)]


def quantecon(model: MDP, method: str) -> dict[str, tuple[int, Callable[[], object]]]:
    """Return quantecon's solver for the model, in the form (dense or sparse) that it has."""
    try:
        from quantecon.markov import DiscreteDP
    except ImportError:
        return {}
    if sparse.issparse(model.stacked):
        s = np.tile(np.arange(model.n_states), model.n_actions)
        a = np.repeat(np.arange(model.n_actions), model.n_states)
        order = np.lexsort((a, s))
        Q = sparse.csr_matrix(model.stacked[order])
        ddp = DiscreteDP(model.R[s, a][order], Q, model.gamma, s[order], a[order])
    else:
        R = np.ascontiguousarray(model.R)
        ddp = DiscreteDP(R, model.T.transpose(1, 0, 2).copy(), model.gamma)
    solve = repeated(lambda: ddp.solve(method=method, epsilon=TOL))
    return {f"quantecon {method}": (TIMES, solve)}


def toolbox(model: MDP, name: str) -> dict[str, tuple[int, Callable[[], object]]]:
    """Return pymdptoolbox's solver for the model; building it is not counted."""
    try:
        from mdptoolbox import mdp
    except ImportError:
        return {}
    T = tuple(map(sparse.csr_matrix, model.T)) if sparse.issparse(model.stacked) else model.T
    extra = {} if name == "PolicyIteration" else {"epsilon": TOL}

    def run() -> None:
        getattr(mdp, name)(T, np.array(model.R), model.gamma, **extra).run()

    return {f"pymdptoolbox {name}": (1, run)}


def compare_all(title: str, model: MDP, exact: bool = True) -> None:
    methods: list[tuple[str, Callable[[], object], str, str]] = [
        ("value", lambda: value_iteration(model, TOL), "value_iteration", "ValueIteration"),
        (
            "modified policy",
            lambda: modified_policy_iteration(model, TOL),
            "modified_policy_iteration",
            "PolicyIterationModified",
        ),
    ]
    if exact:
        exactly = lambda: policy_iteration(model)  # noqa: E731
        methods.append(("policy", exactly, "policy_iteration", "PolicyIteration"))
    for name, ours, theirs, others in methods:
        peers = quantecon(model, theirs) | toolbox(model, others)
        compare(f"{name} it., {title}", TIMES, repeated(ours), **peers)


def main() -> None:
    warnings.simplefilter("ignore")
    compare_all("200 x 4, dense", world(200, 4))
    # A sparse linear system of a random graph fills up: no library solves it exactly in good time.
    compare_all("2,000 x 4, sparse", sparse_world(2000, 4, 10, 0.95), exact=False)


if __name__ == "__main__":
    main()
