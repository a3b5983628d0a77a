import copy
import math
import pickle
import subprocess
import sys
import warnings
from typing import ClassVar

import gymnasium
import numpy as np
import pytest
from hypothesis import given, settings
from scipy import sparse, stats

from arkaq_edu.mdp import MDP, model, value_iteration
from tests.mdp.worlds import as_sparse, forbidding, random_mdp, seeds


def test_steps_follow_the_model():
    mdp = random_mdp(21, max_states=4)
    mdp = MDP(np.random.default_rng(2).dirichlet(np.ones(4), size=(2, 4)), np.zeros((4, 2)), 0.9)
    n = 20_000
    s_next, r, _ = mdp.step(np.full(n, 2), 1, rng=5)
    assert stats.chisquare(np.bincount(s_next, minlength=4), n * mdp.T[1, 2]).pvalue > 1e-3
    assert not r.any()


def test_steps_never_go_where_the_probability_is_zero():
    mdp = MDP([[[0, 1, 0], [0.1, 0, 0.9], [0, 0, 1]]], [[1], [2], [3]], 0.9)
    s = np.random.default_rng(0).integers(3, size=5000)
    s_next, r, _ = mdp.step(s, 0, rng=1)
    assert (mdp.T[0, s, s_next] > 0).all()
    assert (r == s + 1).all()


class Last(np.random.Generator):
    """A generator that draws the largest number below 1."""

    def random(self, size=None):
        return np.full(size, np.nextafter(1, 0))


def test_a_row_that_sums_to_nearly_one_is_never_drawn_past():
    short = [0.5, 0.5 - 8e-10, 0.0]
    mdp = MDP([[short, short, [0, 0, 1]]], [[0.0]] * 3, 0.9)
    s_next, _, _ = mdp.step([0, 1], 0, rng=Last(np.random.PCG64(0)))
    assert s_next.tolist() == [1, 1]


def test_ends_are_left_by_no_action_and_earn_nothing():
    stay, go = np.eye(3), [[0, 1, 0], [0, 1, 0], [0, 0, 1]]
    mdp = MDP([stay, go], [[0, 0], [0, 5], [0, 0]], 0.9)
    assert mdp.ends.tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"T": [[[1.0, 0.1], [0, 1]]]},
            r"T must sum to 1 along its last axis, got 1.1 at \(0, 0\)",
        ),
        (
            {"T": [[[1.5, -0.5], [0, 1]]]},
            r"T must hold probabilities >= 0, got -0.5 at \(0, 0, 1\)",
        ),
        ({"T": [[[math.nan, 1], [0, 1]]]}, r"T must hold finite numbers, got nan at \(0, 0, 0\)"),
        ({"T": [[1.0, 0], [0, 1]]}, r"T must have shape \(any, any, any\), got \(2, 2\)"),
        ({"T": [[[0.5, 0.5]]]}, r"T must have shape \(A, S, S\), each at least 1, got \(1, 1, 2\)"),
        ({"T": np.zeros((0, 2, 2))}, "T must have no axis of length 0, got"),
        ({"R": [[1.0, 2.0]]}, r"R must have shape \(2, 1\), got \(1, 2\)"),
        ({"R": [[1.0], [math.inf]]}, r"R must hold finite numbers or -inf, got inf at \(1, 0\)"),
        ({"gamma": 1.1}, r"gamma must be a number in \[0, 1\], got 1.1"),
        (
            {"R": [[1.0], [-2e307]]},
            r"R must hold numbers of at most 1e\+100 in magnitude, got -2e\+307",
        ),
        ({"gamma": -0.1}, r"gamma must be a number in \[0, 1\], got -0.1"),
        ({"start": [0.5, 0.4]}, "start must sum to 1"),
        ({"start": np.ma.masked_equal([1.0, 0.0], 0)}, "start must hold finite numbers, got nan"),
        (
            {"T": [sparse.eye_array(2), sparse.eye_array(3)]},
            r"T must have shape \(any, 2, 2\), got \(2, 3, 3\)",
        ),
        (
            {"T": [sparse.csr_array([[0.5, 0.4], [0, 1]])]},
            r"T must sum to 1 .* got 0.9 at \(0, 0\)",
        ),
        ({"R": [[-math.inf], [0.0]]}, "R must allow an action in every state, .* in state 0"),
        ({"R": [sparse.eye_array(3)]}, r"R must hold 1 matrices of 2 x 2, got \[\(3, 3\)\]"),
        ({"R": np.zeros((2, 2, 2))}, r"R must have shape \(1, 2, 2\), got \(2, 2, 2\)"),
        ({"R": [sparse.csr_array([[math.nan, 0], [0, 0]])]}, "R must hold finite numbers or -inf"),
    ],
)
def test_bad_models_are_refused(change, message):
    good = {"T": [[[1.0, 0.0], [0.0, 1.0]]], "R": [[1.0], [2.0]], "gamma": 0.9}
    MDP(**good)
    with pytest.raises(ValueError, match=message):
        MDP(**(good | change))


def test_a_model_is_its_own_copy_and_cannot_be_written_to():
    T, R = np.eye(2)[None], np.ones((2, 1))
    mdp = MDP(T, R, 0.9)
    T[:], R[:] = 0.5, 7
    assert (np.eye(2) == mdp.T).all() and (mdp.R == 1).all()
    with pytest.raises(ValueError, match="read-only"):
        mdp.T[0, 0, 0] = 0


def test_the_table_of_an_environment_is_what_the_environment_does():
    env = gymnasium.make("FrozenLake-v1")
    mdp = MDP.from_gymnasium(env, gamma=0.9)
    s = int(env.reset(seed=3)[0])
    env.action_space.seed(3)
    counts, rewards = np.zeros((4, 17, 17)), []
    for _ in range(5000):
        a = int(env.action_space.sample())
        s_next, r, terminated, truncated, _ = env.step(a)
        counts[a, s, 16 if terminated else s_next] += 1
        rewards.append(r - mdp.R[s, a])
        s = int(env.reset()[0]) if terminated or truncated else int(s_next)
    tried = counts.sum(axis=2) > 100
    shares = counts[tried] / counts[tried].sum(axis=1, keepdims=True)
    np.testing.assert_allclose(shares, mdp.T[tried], atol=0.12)
    assert abs(np.mean(rewards)) < 0.01
    assert mdp.start.tolist() == [1.0] + [0.0] * 16


@pytest.mark.parametrize("name", ["CartPole-v1", "Blackjack-v1"])
def test_an_environment_without_a_table_is_refused(name):
    with pytest.raises(ValueError, match="env must have a transition table P, got <"):
        MDP.from_gymnasium(name)


def test_the_room_knows_nothing_of_the_rooms_above():
    code = (
        "import sys, arkaq_edu.mdp\n"
        "above = 'pymunk matplotlib ipywidgets sklearn arkaq_edu.field arkaq_edu.arkaq'.split()\n"
        "print([name for name in above if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: m.step(2, 0, rng=0), r"s must hold integers in \[0, 1\], got 2"),
        (lambda m: m.step(0, -1, rng=0), r"a must hold integers in \[0, 0\], got -1"),
        (
            lambda m: m.step([0, 1], [0, 0, 0], rng=0),
            r"s and a must have one shape, got \(2,\) and",
        ),
        (lambda m: m.step(0, 0, rng="0"), "rng must be a numpy Generator, an integer >= 0 or None"),
        (lambda m: MDP.from_gymnasium(m), "env must have a transition table P"),
        (
            lambda m: MDP.from_gymnasium("Nowhere-v0"),
            "env must name an environment, got 'Nowhere-v0'",
        ),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(MDP([np.eye(2)], [[1.0], [2.0]], 0.9))


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_a_sparse_model_is_the_same_world(seed):
    dense = random_mdp(seed, max_states=6, sparse=True)
    lean = as_sparse(dense)
    V = np.random.default_rng(seed).normal(size=dense.n_states)
    np.testing.assert_allclose(lean.action_values(V), dense.action_values(V), rtol=1e-12)
    assert (lean.ends == dense.ends).all()
    s = np.random.default_rng(seed).integers(dense.n_states, size=200)
    for one, other in zip(dense.step(s, 0, rng=seed), lean.step(s, 0, rng=seed), strict=True):
        assert one.tobytes() == other.tobytes()


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_rewards_of_transitions_are_taken_as_their_mean(seed):
    mdp = random_mdp(seed, max_states=5, sparse=True)
    R = np.random.default_rng(seed).normal(size=mdp.T.shape)
    expected = [[mdp.T[a, s] @ R[a, s] for a in range(mdp.n_actions)] for s in range(mdp.n_states)]
    for T in (mdp.T, [sparse.csc_array(T_a) for T_a in mdp.T]):
        for rewards in (R, R.tolist(), [sparse.coo_array(R_a) for R_a in R]):
            np.testing.assert_allclose(MDP(T, rewards, 0.5).R, expected, atol=1e-12)
    R[mdp.T == 0] = -math.inf  # what cannot happen costs nothing
    np.testing.assert_allclose(MDP(mdp.T, R, 0.5).R, expected, atol=1e-12)


def test_no_dense_table_is_made():
    n = 100_000  # a dense table would need 80 GB
    ahead = sparse.diags_array([np.ones(n - 1)], offsets=[1], shape=(n, n)).tocsr()
    ahead = ahead + sparse.csr_array(([1.0], ([n - 1], [n - 1])), shape=(n, n))
    R = np.zeros((n, 2))
    R[n - 2, 0] = 1.0
    mdp = MDP([ahead, sparse.eye_array(n)], R, 0.5, start=np.eye(1, n)[0])
    values, policy = value_iteration(mdp, tol=1e-6)
    np.testing.assert_allclose(values[-3:], [0.5, 1, 0], atol=1e-6)
    assert not policy[-20:].any() and mdp.step(n - 2, 0, rng=0) == (n - 1, 1.0, True)


def test_rows_that_nearly_sum_to_one_are_divided_by_their_sum():
    third = np.full((3, 3), 1 / 3, dtype=np.float32)
    assert MDP([third], np.zeros((3, 1)), 0.9).T.sum(axis=2) == pytest.approx(1, abs=1e-15)
    for T in ([[[1 - 1e-9]]], [sparse.csr_array([[1 + 1e-9]])]):
        assert MDP(T, [[0.0]], 0.9).ends.tolist() == [True]
    mdp = random_mdp(5, max_states=9)
    again = MDP(mdp.T, mdp.R, mdp.gamma, mdp.start)
    assert (again.T == mdp.T).all() and (again.start == mdp.start).all()


@pytest.mark.parametrize(
    "clone", [copy.copy, copy.deepcopy, lambda mdp: pickle.loads(pickle.dumps(mdp))]
)
@pytest.mark.parametrize("form", [lambda mdp: mdp, as_sparse])
def test_a_copy_cannot_be_written_to_either(clone, form):
    mdp = form(random_mdp(21, max_states=4))
    mdp.step(0, 0, rng=0)
    other = clone(mdp)
    tables = [other.R, other.start, other.ends, other.allowed, *other.outcomes]
    tables += [T_a.data if sparse.issparse(T_a) else T_a for T_a in other.T]
    tables += [other.stacked.data if sparse.issparse(other.stacked) else other.stacked]
    for table in tables:
        with pytest.raises(ValueError, match="read-only"):
            table[0] = 0
    assert other.step([0] * 50, 0, rng=3)[0].tolist() == mdp.step([0] * 50, 0, rng=3)[0].tolist()


def test_no_step_warns():
    mdp = random_mdp(21, max_states=4)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert mdp.step([0], 0, 0)[0].shape == (1,)
        assert np.shape(mdp.step(0, 0, np.random.default_rng(0))[0]) == ()


def test_actions_that_a_state_does_not_allow_make_no_difference_to_it():
    mdp = forbidding([np.eye(2), np.eye(2)[[1, 0]]], [[1.0, 2.0], [0.0, -math.inf]])
    assert mdp.allowed.tolist() == [[True, True], [True, False]]
    assert mdp.ends.tolist() == [False, True]  # it could only be left by what is not allowed
    with pytest.raises(ValueError, match="a must be an action that its state allows, got 1 in 1"):
        mdp.step(1, 1, rng=0)


@pytest.mark.parametrize("name", ["FrozenLake-v1", "CliffWalking-v1"])
def test_a_large_environment_becomes_a_sparse_model(name, monkeypatch):
    dense = MDP.from_gymnasium(name)
    monkeypatch.setattr(model, "MOST_DENSE_BYTES", 1000)
    lean = MDP.from_gymnasium(name)
    assert all(map(sparse.issparse, lean.T)) and (lean.R == dense.R).all()
    np.testing.assert_allclose(np.array([T_a.toarray() for T_a in lean.T]), dense.T, atol=1e-15)


def test_a_table_that_names_no_start_starts_anywhere():
    class Table:
        P: ClassVar = {s: {0: [(1.0, (s + 1) % 4, 1.0, s == 3)]} for s in range(4)}

    mdp = MDP.from_gymnasium(Table(), gamma=0.5)
    np.testing.assert_allclose(mdp.start, [0.25] * 4 + [0.0])
