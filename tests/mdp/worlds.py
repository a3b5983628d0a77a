import itertools

import numpy as np
from hypothesis import strategies as st
from scipy import sparse

from arkaq_edu.mdp import (
    MDP,
    policy_model,
)


def random_mdp(seed, max_states=4, max_actions=3, gamma=None, sparse=False):
    rng = np.random.default_rng(seed)
    S, A = int(rng.integers(1, max_states + 1)), int(rng.integers(1, max_actions + 1))
    T = rng.dirichlet(np.full(S, 0.5), size=(A, S))
    if sparse:  # chains that fall apart, rest, or turn in circles
        certain = rng.random((A, S)) < 0.7
        T[certain] = np.eye(S)[rng.integers(S, size=certain.sum())]
    gamma = rng.choice([0.0, 0.3, 0.9, 0.99]) if gamma is None else gamma
    return MDP(T, rng.normal(scale=3, size=(S, A)), gamma)


def as_sparse(mdp):
    return MDP([sparse.coo_array(T_a) for T_a in mdp.T], mdp.R, mdp.gamma, mdp.start)


def forbidding(T, R, gamma=0.9):
    """A model in which the last state is where an episode ends."""
    return MDP(T, R, gamma, start=np.eye(len(R))[0])


def random_shortest_path(seed, max_states=5, max_actions=3):
    """Costs on the way to an end, which some policies may never reach; some actions not allowed."""
    rng = np.random.default_rng(seed)
    S, A = int(rng.integers(2, max_states + 1)), int(rng.integers(1, max_actions + 1))
    T = np.eye(S)[rng.integers(S, size=(A, S))]
    random = rng.random((A, S)) < 0.5
    T[random] = rng.dirichlet(np.full(S, 0.3), size=random.sum())
    T[0, :-1, -1] += 0.2  # the first action may always end it
    T[0] /= T[0].sum(axis=1, keepdims=True)
    T[:, -1] = np.eye(S)[-1]
    R = -rng.integers(0, 4, size=(S, A)).astype(float)
    R[:, 1:][rng.random((S, A - 1)) < 0.2] = -np.inf
    R[-1] = 0
    return MDP(T, R, 1.0)


def all_policies(mdp):
    """Each allowed policy without chance."""
    return itertools.product(*(np.flatnonzero(row).tolist() for row in mdp.allowed))


seeds = st.integers(0, 2**32 - 1)


def undiscounted_return(mdp, policy, steps=3000):
    T, R = policy_model(mdp, policy)
    where, total = mdp.start, 0.0
    for _ in range(steps):
        total, where = total + where @ R, where @ T
    return total


def corridor(n=5, gamma=1.0 - 1e-12):
    """A walk to either side with equal chance, paid 1 for leaving on the right: V = i / (n + 1)."""
    T = np.zeros((1, n + 2, n + 2))
    T[0, 0, 0] = T[0, n + 1, n + 1] = 1
    R = np.zeros((n + 2, 1))
    for s in range(1, n + 1):
        T[0, s, [s - 1, s + 1]] = 0.5
    R[n] = 0.5
    return MDP(T, R, gamma, start=np.eye(n + 2)[(n + 1) // 2])
