import math
import os
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Discrete
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.mdp import MDP, QLearner, compiled, exploit, train


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    alpha=st.sampled_from([0.3, 1.0, "1/visits", lambda n: 1 / (1 + n)]),
)
def test_replay_is_update_in_order_to_the_last_bit(seed, alpha):
    rng = np.random.default_rng(seed)
    n, S, A = 200, 5, 3
    rows = (
        rng.integers(S, size=n),
        rng.integers(A, size=n),
        rng.normal(size=n),
        rng.integers(S, size=n),
        rng.random(n) < 0.1,
        rng.integers(1, 10, size=n),
    )
    one, many = (QLearner(S, A, alpha=alpha, gamma=0.9) for _ in range(2))
    changes = [one.update(*(x.item() for x in row)) for row in zip(*rows, strict=True)]
    first = many.replay(*(x[:150] for x in rows))
    second = many.replay(*(x[150:] for x in rows))
    assert np.concatenate([first, second]).tolist() == changes
    assert one.Q.tobytes() == many.Q.tobytes()
    assert one.visits.tobytes() == many.visits.tobytes()


def test_compiled_loops_give_the_same_bits_without_compilation():
    if not hasattr(compiled.replay, "py_func"):
        pytest.skip("nothing is compiled here")
    code = (
        "import numpy as np; from arkaq_edu.mdp import MDP, QLearner, train\n"
        "rng = np.random.default_rng(3); q = QLearner(4, 3, 0.3, 0.9, rng=0)\n"
        "s, s_next = rng.integers(4, size=(2, 300)); a = rng.integers(3, size=300)\n"
        "ended, k = rng.random(300) < 0.1, rng.integers(1, 12, size=300)\n"
        "q.replay(s, a, rng.normal(size=300), s_next, ended, k)\n"
        "mdp = MDP(rng.dirichlet(np.ones(4), size=(3, 4)), rng.normal(size=(4, 3)), 0.9)\n"
        "for temperature in (np.inf, 0.3, 0.0):\n"
        "    train(mdp, q, 500, temperature=temperature)\n"
        "print(q.Q.tobytes().hex(), q.visits.tolist())\n"
    )
    outputs = [
        subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"NUMBA_DISABLE_JIT": disable},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for disable in ("0", "1")
    ]
    assert outputs[0] == outputs[1] != ""


class Model(gymnasium.Env):
    """A model as an environment that draws from given numbers, as the compiled loop does."""

    def __init__(self, mdp, u):
        self.observation_space, self.action_space = Discrete(mdp.n_states), Discrete(mdp.n_actions)
        self.mdp, self.u, self.t = mdp, u, 0
        self.sums = mdp.T.cumsum(axis=2)
        self.sums /= self.sums[:, :, -1:]
        starts = np.where(mdp.ends, 0, mdp.start)
        self.starts = (starts / starts.sum()).cumsum()

    def reset(self, *, seed=None, options=None):
        self.s = int((self.starts <= self.u[max(self.t - 1, 0), 0]).sum())
        return self.s, {}

    def step(self, a):
        r = self.mdp.R[self.s, a]
        self.s = int((self.sums[a, self.s] <= self.u[self.t, 2]).sum())
        self.t += 1
        return self.s, r, bool(self.mdp.ends[self.s]), False, {}


class Given:
    """A generator that draws given numbers."""

    def __init__(self, numbers):
        self.numbers = iter(numbers)

    def random(self):
        return next(self.numbers)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    temperature=st.sampled_from([0.0, 0.3, 5.0, math.inf, lambda n: 3 / n, lambda n: n % 2]),
    alpha=st.sampled_from([0.3, 1.0, "1/visits", lambda n: 1 / (1 + n)]),
)
def test_training_on_a_model_is_the_loop_of_figure_4_4_to_the_last_bit(seed, temperature, alpha):
    rng = np.random.default_rng(seed)
    n, S, A = 300, 6, 3
    T = rng.dirichlet(np.full(S, 0.5), size=(A, S))
    T[:, -1] = np.eye(S)[-1]
    R = np.vstack([rng.normal(size=(S - 1, A)), np.zeros(A)])
    R[0, 2] = -np.inf
    mdp = MDP(T, R, 0.9, start=rng.dirichlet(np.ones(S)))
    one, many = (QLearner(S, A, alpha, gamma=0.9, rng=seed) for _ in range(2))
    one.Q[0, 2] = -np.inf
    u = np.random.default_rng(seed).random((n, 3))
    one.rng = Given(u[:, 1])
    plain = exploit(
        Model(mdp, u), one, temperature=temperature, max_backups=n, max_repeat=1, tol=0.0
    )
    run = train(mdp, many, len(plain.changes), temperature=temperature)
    assert plain.changes.tobytes() == run.changes.tobytes()
    assert plain.returns.tolist() == run.returns.tolist()
    assert plain.lengths.tolist() == run.lengths.tolist()
    assert one.Q.tobytes() == many.Q.tobytes()
    assert one.visits.tobytes() == many.visits.tobytes()
