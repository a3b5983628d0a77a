import math
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from scipy import stats

from arkaq_edu.mdp import (
    MDP,
)
from tests.mdp.worlds import random_mdp


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
        ({"T": np.zeros((0, 2, 2))}, "T must have shape"),
        ({"R": [[1.0, 2.0]]}, r"R must have shape \(2, 1\), got \(1, 2\)"),
        ({"R": [[1.0], [math.inf]]}, r"R must hold finite numbers or -inf, got inf at \(1, 0\)"),
        ({"gamma": 1.1}, r"gamma must be a number in \[0, 1\], got 1.1"),
        ({"R": [[1.0], [-2e307]]}, r"R must hold numbers of at most 1e\+100 in magnitude, got -2e\+307"),
        ({"gamma": -0.1}, r"gamma must be a number in \[0, 1\], got -0.1"),
        ({"start": [0.5, 0.4]}, "start must sum to 1"),
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
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(MDP([np.eye(2)], [[1.0], [2.0]], 0.9))
