"""Millions of steps: memory does not grow, and no number drifts."""

import gc
import os
from itertools import count
from pathlib import Path

import gymnasium
import ipywidgets
import numpy as np
import pytest

from arkaq_edu import art, kalman, mdp, widgets
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.widgets.explorer import START_AGAIN, is_offered
from tests.soak.command import SHARE

MEGABYTES = 12  # what the allocator may keep
STATM = Path("/proc/self/statm")
pytestmark = pytest.mark.skipif(not STATM.exists(), reason="memory is read from /proc")


def memory():
    gc.collect()
    return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def repeated(call, n, at_once=1):
    """Call with 0, 1, 2, ... for n things; from half of the way on, memory may not grow.

    By then kernels are compiled, and what keeps the last results is full, in a short run too.
    """
    calls, before = max(20, int(n * SHARE / at_once)), None
    for i in range(calls):
        call(i)
        if i == calls // 2:
            before = memory()
    grown = memory() - before
    print(f"{calls * at_once:,} done, memory grown by {grown:.1f} MB")
    assert grown < MEGABYTES


def test_a_million_kalman_steps():
    A, H = kalman.constant_velocity(0.1, 2)
    G = np.kron(np.eye(2), [[0.005], [0.1]]) if A[0, 1] else np.kron([[0.005], [0.1]], np.eye(2))
    Q, R = G @ G.T, np.eye(2)
    truth, rng = np.zeros(4), np.random.default_rng(0)
    one = kalman.KalmanFilter(A, H, Q, R, x0=truth, P0=np.eye(4))
    nis, errors = [], []

    def step(i):
        nonlocal truth
        truth = A @ truth + G @ rng.standard_normal(2)
        if np.abs(truth).max() > 1e6:  # the target turns back; a filter does not care where it is
            one.x[:] -= truth
            truth = np.zeros(4)
        one.predict()
        one.update(H @ truth + rng.standard_normal(2))
        if i % 100 == 99:
            nis.append(one.nis)
            error = truth - one.x
            errors.append(error @ np.linalg.solve(one.P, error))

    repeated(step, 1_000_000)
    low, high = kalman.chi_square_band(2, len(nis), 0.9999)
    assert low < np.mean(nis) < high
    late = errors[len(errors) // 2 :]
    assert abs(np.mean(late) / 4 - 1) < 5 / np.sqrt(len(late))  # neighbors are not independent
    steady = kalman.KalmanFilter(A, H, Q, R, x0=np.zeros(4), P0=np.eye(4))
    for _ in range(2000):
        steady.predict()
        steady.update(np.zeros(2))
    np.testing.assert_allclose(one.P, steady.P, rtol=1e-9, atol=1e-12)


NETWORKS = {
    "ART1": (art.ART1(0.4), lambda rng, n: rng.random((n, 8)) < 0.4),
    "ART2": (art.ART2(0.95), lambda rng, n: rng.random((n, 4))),
    "ART2A": (art.ART2A(0.95, 0.1), lambda rng, n: rng.random((n, 4))),
    "EuclideanART": (art.EuclideanART(0.3, 0.1), lambda rng, n: rng.uniform(-1, 1, (n, 2))),
    "EuclideanART that counts": (
        art.EuclideanART(0.3, "count"), lambda rng, n: rng.uniform(-1, 1, (n, 2))),
}  # fmt: skip


@pytest.mark.parametrize("name", NETWORKS)
def test_a_million_patterns(name):
    network, draw = NETWORKS[name]
    rng, sizes = np.random.default_rng(0), []

    def present(i):
        network.partial_fit(draw(rng, 1000))
        sizes.append(len(network.cluster_centers_))

    repeated(present, 1_000_000, at_once=1000)
    assert sizes[-1] <= 1.1 * sizes[len(sizes) // 2] + 2  # few are founded late
    assert np.isfinite(network.cluster_centers_).all()
    assert np.abs(network.cluster_centers_).max() <= 1 + 1e-9 or name == "ART2"


def test_ten_million_q_updates():
    model = mdp.grid_world(slip=0.1, gamma=0.9)
    model = getattr(model, "mdp", model)
    learner = mdp.QLearner(model.R.shape[0], model.R.shape[1], mdp.Power(1.0, 0.6), 0.9, rng=0)
    rng, at_once = np.random.default_rng(0), 10_000
    T = np.asarray(model.T)
    chances = T.cumsum(axis=2)

    def learn(i):
        s = rng.integers(T.shape[1], size=at_once)
        a = rng.integers(T.shape[0], size=at_once)
        after = (rng.random((at_once, 1)) > chances[a, s]).sum(1).clip(max=T.shape[1] - 1)
        rewards = model.R[s, a]
        for each in zip(s.tolist(), a.tolist(), rewards.tolist(), after.tolist(), strict=True):
            learner.update(*each)

    repeated(learn, 10_000_000, at_once=at_once)
    values, _ = mdp.value_iteration(model)
    np.testing.assert_allclose(learner.Q.max(axis=1), values, atol=0.05 * np.ptp(values))


@pytest.mark.parametrize("name", ["BallApproach-v0", "ScoreGoal-v0"])
def test_ten_thousand_resets(name):
    env = gymnasium.make(f"arkaq_edu:{name}")

    def begin(i):
        env.reset(seed=i)
        env.step(i % env.action_space.n)

    repeated(begin, 10_000)


def test_a_thousand_saves(tmp_path):
    path, course = tmp_path / "agent.npz", data_file("ball_approach.npz")
    whole = course.read_bytes()
    Arkaq.load(course).save(path)

    def save(i):
        Arkaq.load(path).save(path)

    repeated(save, 1000)
    assert path.read_bytes() == whole and [p.name for p in tmp_path.iterdir()] == [path.name]


def buttons(widget):
    if isinstance(widget, ipywidgets.Button):
        return [widget]
    return [found for part in getattr(widget, "children", ()) for found in buttons(part)]


def move(control, rng, number):
    """Do what a hand does to a control."""
    if hasattr(control, "press"):
        offered = [each for each in buttons(control) if is_offered(each)]
        if number % 30 == 0:
            offered = [each for each in offered if each.description == START_AGAIN]
        offered[rng.integers(len(offered))].click()
    elif isinstance(control, ipywidgets.Checkbox | ipywidgets.ToggleButton):
        control.value = not control.value
    elif hasattr(control, "options"):
        control.index = int(rng.integers(len(control.options)))
    elif hasattr(control, "step"):
        stops = round((control.max - control.min) / control.step)
        control.value = control.min + control.step * int(rng.integers(stops + 1))
    else:
        for part in control.children:
            move(part, rng, number)


@pytest.mark.parametrize("name", widgets.EXPLORERS)
def test_twenty_thousand_callbacks(name):
    explorer, rng, turn = widgets.EXPLORERS[name](), np.random.default_rng(0), count()
    controls = list(explorer.controls.values())
    alive = []

    def touch(i):
        move(controls[rng.integers(len(controls))], rng, next(turn))
        assert explorer.error is None
        if i % 100 == 0:
            alive.append(len(ipywidgets.widgets.widget._instances))

    repeated(touch, 20_000)
    assert max(alive) == alive[0]
    explorer.close()
