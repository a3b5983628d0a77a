"""Exact solving: against all policy trees, closed forms, and what is known of the tiger."""

import itertools
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import arkaq_edu
from arkaq_edu.mdp import policy_iteration
from arkaq_edu.pomdp import (
    POMDP,
    PolicyGraph,
    ValueFunction,
    all_trees,
    bellman_error,
    problem,
    solve_point_based,
    solve_pomdp,
    successors,
    tree_value,
)
from arkaq_edu.pomdp.pruning import distance

seeds = st.integers(0, 2**32 - 1)


def random_pomdp(seed, max_states=4, max_actions=3, max_observations=3, high=0.9):
    """Return a small POMDP, its distributions from spiky to flat, some without any chance."""
    rng = np.random.default_rng(seed)
    S = int(rng.integers(1, max_states + 1))
    A = int(rng.integers(1, max_actions + 1))
    Z = int(rng.integers(1, max_observations + 1))
    T = rng.dirichlet(np.full(S, rng.choice([0.05, 0.5, 2.0])), size=(A, S))
    O = rng.dirichlet(np.full(Z, rng.choice([0.05, 0.5, 2.0])), size=(A, S))  # noqa: E741
    if rng.random() < 0.3:  # many zeros, many ties
        T, O = np.eye(S)[T.argmax(axis=2)], np.eye(Z)[O.argmax(axis=2)]  # noqa: E741
    R = rng.integers(-2, 3, size=(S, A)) if rng.random() < 0.5 else rng.normal(size=(S, A))
    return POMDP(T, O, R, rng.uniform(0.2, high))


def random_beliefs(n_states, seed, n=200):
    rng = np.random.default_rng(seed)
    spread = rng.dirichlet(np.ones(n_states), size=n // 2)
    spiky = rng.dirichlet(np.full(n_states, 0.2), size=n // 2)
    return np.concatenate([np.eye(n_states), spread, spiky])


def backed_up(pomdp, V, b):
    """Return (H V)(b) from the beliefs that can follow: nothing of vectors in it."""
    best = -np.inf
    for a in range(pomdp.n_actions):
        chances, beliefs = successors(pomdp, b, a)
        can = chances > 0
        later = chances[can] @ np.atleast_1d(V.value(beliefs[can]))
        best = max(best, b @ pomdp.R[:, a] + pomdp.gamma * later)
    return best


# --- a horizon ------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 3))
def test_no_policy_tree_earns_more_and_one_earns_as_much(seed, horizon):
    few = {1: (4, 3, 3), 2: (4, 3, 3), 3: (4, 2, 2)}[horizon]
    pomdp = random_pomdp(seed, *few)
    V = solve_pomdp(pomdp, horizon)
    every = np.array([tree_value(pomdp, tree) for tree in all_trees(pomdp, horizon)])
    b = random_beliefs(pomdp.n_states, seed)
    np.testing.assert_allclose(V.value(b), (b @ every.T).max(axis=1), atol=1e-9)
    assert distance(V.alphas, every)[0] <= 1e-9  # everywhere
    assert V.error <= 1e-9


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 4))
def test_every_vector_is_what_its_tree_earns(seed, horizon):
    pomdp = random_pomdp(seed, 4, 3, 2)
    V = solve_pomdp(pomdp, horizon)
    for k in range(min(len(V), 10)):
        tree = V.tree(k)
        assert tree.depth == horizon and tree.action == V.actions[k]
        np.testing.assert_allclose(tree_value(pomdp, tree), V.alphas[k], atol=1e-10)


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_one_more_step_is_one_backup(seed):
    pomdp = random_pomdp(seed)
    V = solve_pomdp(pomdp, 4)
    for b in random_beliefs(pomdp.n_states, seed, 20):
        assert V.horizon == 4 and V.shorter.horizon == 3
        assert V.value(b) == pytest.approx(backed_up(pomdp, V.shorter, b), abs=1e-9)
        assert V.value(b) == pytest.approx(b @ V.alphas[V.best(b)], abs=1e-12)
        assert V.action(b) == V.actions[V.best(b)]


@pytest.mark.thesis("errata row 16")
def test_figure_2_16_a1_is_preferred_on_the_right():
    """By figure 2.8's axis p(s1) grows to the right, and a1 wins above 0.6."""
    pomdp = POMDP([np.eye(2)] * 2, np.full((2, 2, 1), 1.0), [[1, 0], [0, 1.5]], 0.9)
    V = solve_pomdp(pomdp, 1)
    assert V.value([0.25, 0.75]) == 1.125
    p = np.array([0.0, 0.59, 0.61, 1.0])
    assert V.action(np.c_[p, 1 - p]).tolist() == [1, 1, 0, 0]


# --- no horizon: closed forms ---------------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_where_the_state_is_seen_it_is_the_mdp(seed):
    """Seen after every step, the first belief is all there is to be uncertain of."""
    hidden = random_pomdp(seed, 4, 3)
    S, A = hidden.n_states, hidden.n_actions
    pomdp = POMDP(hidden.T, [np.eye(S)] * A, hidden.R, hidden.gamma)
    values, _ = policy_iteration(pomdp.mdp)
    b = random_beliefs(S, seed)
    best = (b @ pomdp.mdp.action_values(values)).max(axis=1)
    np.testing.assert_allclose(solve_pomdp(pomdp, tol=1e-7).value(b), best, atol=1e-7)


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_where_nothing_is_seen_it_is_the_best_sequence_of_actions(seed):
    pomdp = random_pomdp(seed, 3, 2, 1, high=0.5)
    V = solve_pomdp(pomdp, tol=1e-6)
    n, tail = 8, pomdp.gamma**8 * np.abs(pomdp.R).max() / (1 - pomdp.gamma)
    for b in random_beliefs(pomdp.n_states, seed, 4):
        best = -np.inf
        for actions in itertools.product(range(pomdp.n_actions), repeat=n):
            now, total = b, 0.0
            for t, a in enumerate(actions):
                total += pomdp.gamma**t * (now @ pomdp.R[:, a])
                now = now @ pomdp.T[a]
            best = max(best, total)
        assert abs(V.value(b) - best) <= tail + 1e-6


def test_without_a_future_only_the_reward_counts():
    pomdp = POMDP([np.eye(2)] * 2, np.full((2, 2, 2), 0.5), [[1, 0], [0, 1.5]], 0.0)
    b = random_beliefs(2, 0)
    np.testing.assert_allclose(solve_pomdp(pomdp).value(b), (b @ pomdp.R).max(axis=1), atol=1e-12)


def test_the_tiger():
    """Listen until it was heard twice more on one side: 19.3714 from not knowing."""
    pomdp = problem("tiger")
    V = solve_pomdp(pomdp)
    assert V.value([0.5, 0.5]) == pytest.approx(19.3714, abs=1e-4)
    assert V.error <= 1e-6 and len(V) == len(V.graph) == 9
    # By hand. Nodes: how many times more it was heard on the left, -2 ... 2.
    wait, left, right = (pomdp.actions.index(a) for a in ("listen", "open-left", "open-right"))
    by_hand = PolicyGraph([left, wait, wait, wait, right], [[2, 2], [2, 0], [3, 1], [4, 2], [2, 2]])
    assert by_hand.values(pomdp)[2] @ [0.5, 0.5] == pytest.approx(V.value([0.5, 0.5]), abs=1e-6)


# --- no horizon: what is certified ----------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(seeds, st.sampled_from([1.0, 1e-1, 1e-2]))
def test_the_error_is_certified(seed, tol):
    pomdp = random_pomdp(seed, 3, 3, 2, high=0.7)
    rough, fine = solve_pomdp(pomdp, tol=tol), solve_pomdp(pomdp, tol=tol / 10)
    assert rough.error <= tol and fine.error <= tol / 10
    assert distance(rough.alphas, fine.alphas)[0] <= rough.error + fine.error
    # A long horizon comes as near by itself.
    h = 1 + int(np.log(tol / 4 * (1 - pomdp.gamma)) / np.log(pomdp.gamma))
    if h <= 6:
        V = solve_pomdp(pomdp, h)
        tail = pomdp.gamma**h * np.abs(pomdp.R).max() / (1 - pomdp.gamma)
        assert distance(rough.alphas, V.alphas)[0] <= rough.error + tail + 1e-9


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_no_belief_has_a_larger_bellman_error_and_one_has_it(seed):
    pomdp = random_pomdp(seed, 3, 2, 2)
    rng = np.random.default_rng(seed)
    V = ValueFunction(rng.normal(size=(3, pomdp.n_states)), np.zeros(3, int), np.empty((3, 0), int))
    bound = bellman_error(pomdp, V)
    at = [abs(backed_up(pomdp, V, b) - V.value(b)) for b in random_beliefs(pomdp.n_states, seed)]
    assert max(at) <= bound + 1e-9
    # H V with nothing pruned: a reward and, for each observation, any vector of V.
    every = []
    for a in range(pomdp.n_actions):
        after = pomdp.gamma * np.einsum("st,tz,kt->zks", pomdp.T[a], pomdp.O[a], V.alphas)
        for choice in itertools.product(range(3), repeat=pomdp.n_observations):
            every.append(pomdp.R[:, a] + sum(after[z, k] for z, k in enumerate(choice)))
    assert bound == pytest.approx(distance(np.array(every), V.alphas)[0], abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_a_policy_graph_earns_what_is_said(seed):
    pomdp = random_pomdp(seed, 3, 3, 2, high=0.8)
    V = solve_pomdp(pomdp, tol=1e-2)
    graph = V.graph
    if graph is None:  # some go on with ever new plans
        assert V.branches.shape == (len(V), 0)
        return
    # Followed for so long that nothing is left, from any guess.
    values = np.zeros(V.alphas.shape)
    for _ in range(200):
        later = np.einsum("ktz,kzt->kt", pomdp.O[graph.actions], values[graph.branches])
        step = np.einsum("kst,kt->ks", pomdp.T[graph.actions], later)
        values = pomdp.R[:, graph.actions].T + pomdp.gamma * step
    np.testing.assert_allclose(graph.values(pomdp), values, atol=1e-9)
    np.testing.assert_allclose(V.alphas, values, atol=1e-9)


def test_a_large_policy_graph_is_evaluated_alike(monkeypatch):
    pomdp = problem("tiger")
    graph = solve_pomdp(pomdp).graph
    at_once = graph.values(pomdp)
    monkeypatch.setattr("arkaq_edu.pomdp.graph.LARGE", 0)
    np.testing.assert_allclose(graph.values(pomdp), at_once, atol=1e-10)


@pytest.mark.thesis("errata row 17")
@pytest.mark.parametrize("name", ["floors", "corridor", "tiger", "two_state", "ball_side"])
def test_the_problems_of_the_course(name):
    pomdp = problem(name)
    V = solve_pomdp(pomdp)
    assert V.error <= 1e-6
    for b in random_beliefs(pomdp.n_states, 1, 50):
        assert V.value(b) == pytest.approx(backed_up(pomdp, V, b), abs=2e-6)


def test_what_is_finer_than_rounding_is_not_claimed():
    pomdp = POMDP([np.eye(2)] * 2, [[[0.9, 0.1], [0.1, 0.9]]] * 2, [[1e6, 0], [0, 1e6]], 0.99)
    with pytest.warns(RuntimeWarning, match="finer than rounding"):
        V = solve_pomdp(pomdp, tol=1e-9)
    assert 1e-9 < V.error < 1  # of values near 1e8


def test_it_runs_without_numba_and_gives_the_same():
    script = (
        "import numpy as np; from arkaq_edu.pomdp import problem, solve_pomdp\n"
        "p = problem('tiger')\n"
        "print(solve_pomdp(p, 3).alphas.tolist(), solve_pomdp(p, tol=1e-2).alphas.tolist())"
    )
    plain = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    pomdp = problem("tiger")
    compiled = solve_pomdp(pomdp, 3).alphas.tolist(), solve_pomdp(pomdp, tol=1e-2).alphas.tolist()
    assert plain.stdout.strip() == f"{compiled[0]} {compiled[1]}"


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(1, 3))
def test_without_a_discount_a_horizon_earns_the_plain_sum(seed, horizon):
    some = random_pomdp(seed, 3, 2, 2)
    pomdp = POMDP(some.T, some.O, some.R, 1)
    V = solve_pomdp(pomdp, horizon)
    every = np.array([tree_value(pomdp, tree) for tree in all_trees(pomdp, horizon)])
    b = random_beliefs(pomdp.n_states, seed)
    np.testing.assert_allclose(V.value(b), (b @ every.T).max(axis=1), atol=1e-9)
    assert V.error <= 1e-9


def test_without_a_discount_and_without_an_end_there_is_no_value():
    some = random_pomdp(0)
    pomdp = POMDP(some.T, some.O, some.R, 1)
    with pytest.raises(ValueError, match="horizon must be an integer >= 1, because gamma is 1"):
        solve_pomdp(pomdp)
    with pytest.raises(ValueError, match="pomdp must have a discount below 1"):
        solve_point_based(pomdp)
    with pytest.raises(ValueError, match="pomdp must have a discount below 1"):
        PolicyGraph([0], [[0] * pomdp.n_observations]).values(pomdp)
    for horizon in (10**9, 10**30):
        with pytest.raises(ValueError, match=r"horizon must be an integer in \[1, 1000000\]"):
            solve_pomdp(pomdp, horizon)


def test_a_sparse_model_is_solved_like_a_dense_one():
    tiger = problem("tiger")
    T, O = ([sparse.csr_array(M) for M in table] for table in (tiger.T, tiger.O))  # noqa: E741
    twin = POMDP(T, O, tiger.R, tiger.gamma)
    V = solve_pomdp(twin)
    assert V.alphas.tobytes() == solve_pomdp(tiger).alphas.tobytes()
    np.testing.assert_array_equal(V.graph.values(twin), V.graph.values(tiger))
    assert bellman_error(twin, V) == bellman_error(tiger, V)


def test_bad_input_is_refused():
    assert arkaq_edu.solve_pomdp is solve_pomdp
    pomdp = problem("tiger")
    with pytest.raises(ValueError, match=r"horizon must be an integer in \[1, 1000000\], got 0"):
        solve_pomdp(pomdp, 0)
    with pytest.raises(ValueError, match="tol must be"):
        solve_pomdp(pomdp, tol=0)
    V = solve_pomdp(pomdp, 2)
    with pytest.raises(ValueError, match="b must sum to 1"):
        V.value([0.5, 0.6])
    with pytest.raises(ValueError, match=r"k must be an integer in \[0, 4\], got 5"):
        V.tree(5)
    with pytest.raises(ValueError, match="go on for ever"):
        solve_pomdp(pomdp).tree(0)
    with pytest.raises(ValueError, match=r"branches must hold integers in \[0, 1\], got 2"):
        PolicyGraph([0, 0], [[0, 2], [0, 0]])
    with pytest.raises(ValueError, match=r"branches must have shape \(1, 2\), got \(1, 1\)"):
        PolicyGraph([0], [[0]]).values(pomdp)
    with pytest.raises(ValueError, match="pomdp must be a POMDP, got 'tiger'"):
        solve_pomdp("tiger")
    with pytest.raises(ValueError, match="V must be over 2 states, got one over 4"):
        bellman_error(pomdp, solve_pomdp(problem("floors"), 1))
    with pytest.raises(ValueError, match=r"actions must have shape \(1,\), got \(2,\)"):
        ValueFunction(np.eye(2)[:1], np.array([0, 1]), np.empty((1, 0), int))
    none = np.empty((2, 0), int)
    for alphas, actions, branches, said in (
        (np.eye(2), [0, np.nan], none, r"actions must hold integers, got \[0, nan\]"),
        (np.eye(2), [0, -1], none, "actions must hold integers >= 0, got -1"),
        (np.eye(2), [0, 1], [[0, 1], [2, 0]], r"branches must hold integers in \[0, 1\], got 2"),
        ([[1, np.nan]], [0], none[:1], "alphas must hold finite numbers, got nan"),
    ):
        with pytest.raises(ValueError, match=said):
            ValueFunction(alphas, actions, branches)
    kept = ValueFunction([[1, 0], [0, 1]], [1, 0], [[0, 1], [1, 0]])
    assert (kept.alphas.dtype, kept.action([1, 0]), len(kept.graph)) == (np.float64, 1, 2)


def test_a_plan_of_more_steps_than_python_calls_deep_can_be_written_out():
    steps = sys.getrecursionlimit() + 10
    V = solve_pomdp(problem("floors"), steps)
    assert V.tree(V.best([1, 0, 0, 0])).depth == steps
