import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Discrete

from arkaq_edu.mdp import (
    MDP,
    Exponential,
    QLearner,
    exploit,
    explore,
    hold,
    policy_iteration,
    train,
)
from tests.mdp.worlds import as_sparse, corridor, undiscounted_return


class Script(gymnasium.Env):
    """An environment that plays back (state, reward, terminated, truncated) whatever is done."""

    def __init__(self, *steps, start=0, n_states=1, n_actions=1):
        self.observation_space, self.action_space = Discrete(n_states), Discrete(n_actions)
        self.steps, self.start, self.actions, self.resets = steps, start, [], 0

    def reset(self, *, seed=None, options=None):
        self.at, self.resets = 0, self.resets + 1
        return self.start, {}

    def step(self, action):
        self.actions.append(action)
        self.at += 1
        return *self.steps[self.at - 1], {}


def test_holding_ends_when_the_state_changes():
    env = Script(*((s, r, False, False) for s, r in ((0, 1.0), (0, 2.0), (3, 4.0))), n_actions=8)
    env.reset()
    assert hold(env, 0, 7) == ([1.0, 2.0, 4.0], 3, False, False)
    assert env.actions == [7, 7, 7]


@pytest.mark.thesis("errata row 33")
def test_holding_an_action_that_never_changes_the_state_is_capped():
    env = Script(*[(0, 1.0, False, False)] * 50, n_actions=3)
    env.reset()
    assert hold(env, 0, 2, max_repeat=6) == ([1.0] * 6, 0, False, False)
    with pytest.raises(ValueError, match="max_repeat must be an integer >= 1, got 0"):
        hold(env, 0, 2, max_repeat=0)
    with pytest.raises(ValueError, match=r"a must be an integer in \[0, 2\], got 3"):
        hold(env, 0, 3)


@pytest.mark.parametrize(("terminated", "truncated"), [(True, False), (False, True)])
def test_an_episode_that_is_over_begins_anew_and_only_a_cut_one_has_a_future(terminated, truncated):
    env = Script((0, 1.0, False, False), (0, 2.0, terminated, truncated))
    learner = QLearner(1, 1, alpha=1.0, gamma=0.5, initial=8.0)
    run = explore(env, learner, max_backups=1)
    assert learner.Q[0, 0] == 1 + 0.5 * 2 + (0.25 * 8 if truncated else 0)
    assert env.resets == 2
    assert (run.returns.tolist(), run.lengths.tolist()) == ([3.0], [2])


def test_exploring_tries_the_untried_first():
    env = Script(*[(0, 0.0, False, False)] * 10, n_actions=5)
    learner = QLearner(1, 5, alpha=1.0, gamma=0.5, rng=3)
    explore(env, learner, max_backups=5, max_repeat=1)
    assert sorted(env.actions) == [0, 1, 2, 3, 4]


def test_exploring_a_certain_world_ends_at_the_optimum():
    """Figure 4.3 with alpha = 1; held against a wall an action is worth less, else just as much."""
    env = gymnasium.make("FrozenLake-v1", is_slippery=False)
    mdp = MDP.from_gymnasium(env, gamma=0.9)
    V, _ = policy_iteration(mdp)
    learner = QLearner(16, 4, alpha=1.0, gamma=0.9, rng=0)
    run = explore(env, learner, seed=1, max_repeat=10)
    assert len(run.changes) < 100_000
    met = learner.visits.any(axis=1)
    np.testing.assert_allclose(learner.Q[met].max(axis=1), V[:16][met], atol=1e-9)
    walls = np.array([[mdp.T[a, s, s] == 1 for a in range(4)] for s in range(16)])
    exact = np.where(walls, 0.9**10 * V[:16, None], mdp.action_values(V)[:16])
    np.testing.assert_allclose(learner.Q[met], exact[met], atol=1e-9)
    assert exploit(env, learner, max_backups=6).returns.tolist() == [1.0]


def test_exploiting_cools_down_to_the_shortest_way():
    env = gymnasium.make("CliffWalking-v1")
    for seed in range(3):
        learner = QLearner(48, 4, alpha=1.0, gamma=0.99, rng=seed)
        run = exploit(env, learner, temperature=Exponential(10.0, half_life=200), seed=seed)
        assert run.returns[-1] == -13
        assert run.returns[:3].mean() < -30
        assert len(run.changes) < 100_000


def test_exploiting_draws_by_temperature_and_asks_its_schedule_once_a_backup():
    asked = []

    def cooling(n):
        asked.append(n)
        return 0.5 if n <= 2000 else 0.0

    env = Script(*[(0, 5.0, False, False)] * 2050, n_actions=2)
    learner = QLearner(1, 2, alpha=1e-12, gamma=0.0, rng=3)  # it changes, and learns nothing
    learner.Q[0] = [0.0, 1.0]
    exploit(env, learner, temperature=cooling, max_backups=2050, max_repeat=1, tol=0.0)
    assert asked == list(range(1, 2051))
    assert np.mean(env.actions[:2000]) == pytest.approx(1 / (1 + np.exp(-2)), abs=0.03)
    assert set(env.actions[2000:]) == {1}


def test_the_same_seed_is_the_same_run():
    runs = []
    for _ in range(2):
        env = gymnasium.make("FrozenLake-v1")
        learner = QLearner(16, 4, alpha=0.1, gamma=0.9, rng=5)
        runs.append((explore(env, learner, max_backups=500, seed=9), learner))
    assert runs[0][0].changes.tobytes() == runs[1][0].changes.tobytes()
    assert runs[0][1].Q.tobytes() == runs[1][1].Q.tobytes()


@pytest.mark.parametrize(
    ("name", "gamma", "alpha", "steps", "known"),
    [
        ("FrozenLake-v1", 0.99, lambda n: 100 / (99 + n), 2_000_000, 14 / 17),
        ("CliffWalking-v1", 0.99, 1.0, 500_000, -13.0),
        ("Taxi-v4", 0.99, 1.0, 2_000_000, 7.93),
    ],
)
def test_training_reaches_the_known_optimal_returns(name, gamma, alpha, steps, known):
    mdp = MDP.from_gymnasium(name, gamma)
    learner = QLearner(mdp.n_states, mdp.n_actions, alpha, gamma, rng=0)
    train(mdp, learner, steps)
    assert undiscounted_return(mdp, learner.Q.argmax(axis=1)) == pytest.approx(known, abs=1e-4)


def test_training_adds_up():
    mdp = corridor()
    learner = QLearner(7, 1, alpha="1/visits", gamma=0.9, rng=2)
    run = train(mdp, learner, 10_000)
    assert learner.visits.sum() == len(run.changes) == 10_000
    assert not learner.visits[[0, 6]].any()
    assert 0 <= 10_000 - run.lengths.sum() < 200
    assert set(run.returns) <= {0.5 * k for k in range(60)}
    assert (run.lengths % 2 == 1).all()  # from the middle of five, an end is an odd number away


def test_training_at_temperature_zero_takes_the_best_action_and_hot_any():
    stay = [[0.0, 1.0], [0.0, 1.0]]
    mdp = MDP([stay, stay, stay], [[1, 2, 3], [0, 0, 0]], 0.5)
    learner = QLearner(2, 3, alpha=0.0, gamma=0.5, rng=0)
    learner.Q[0] = [1.0, 5.0, 2.0]
    assert set(train(mdp, learner, 300, temperature=0.0).returns) == {2.0}
    assert set(train(mdp, learner, 300).returns) == {1.0, 2.0, 3.0}
    hot_then_cold = train(mdp, learner, 300, temperature=lambda n: 1e9 if n <= 150 else 0.0)
    assert set(hot_then_cold.returns[150:]) == {2.0} != set(hot_then_cold.returns[:150])


def test_training_calls_a_schedule_of_the_learning_rate():
    mdp = MDP([[[0.0, 1.0], [0.0, 1.0]]], [[8.0], [0.0]], 0.5, start=[1, 0])
    learner = QLearner(2, 1, alpha=lambda n: 0.5 if n == 1 else 0.25, gamma=0.5, rng=0)
    train(mdp, learner, 2)
    assert learner.Q[0, 0] == 4 + (8 - 4) / 4


def test_training_never_tries_what_is_not_allowed_dense_or_sparse():
    rng = np.random.default_rng(3)
    T = rng.dirichlet(np.ones(5), size=(3, 5))
    T[:, -1] = np.eye(5)[-1]
    R = np.vstack([rng.normal(size=(4, 3)), np.zeros(3)])
    R[[0, 1, 1, 3], [2, 0, 1, 0]] = -np.inf
    tables = []
    for model in (MDP(T, R, 0.9), as_sparse(MDP(T, R, 0.9))):
        for temperature in (np.inf, 0.5, 0.0):
            learner = QLearner(5, 3, "1/visits", 0.9, rng=1)
            run = train(model, learner, 20_000, temperature=temperature)
            assert not learner.visits[~model.allowed].any() and np.isfinite(run.changes).all()
            assert (np.isneginf(learner.Q) == ~model.allowed).all()
            tables.append(learner.Q.tobytes())
            tried = learner.visits[:-1][model.allowed[:-1]] > 0
            assert tried.all() or temperature == 0
    assert tables[:3] == tables[3:]


def bar(mdp, learner):
    learner.Q[3] = -np.inf
    return train(mdp, learner, 9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m, q: train(m, q, 0), "n_steps must be an integer >= 1, got 0"),
        (lambda m, q: train(m, q, 9, temperature=-1), "temperature must be a number in"),
        (lambda m, q: train(m, q, 9, temperature="1"), "temperature must be a number in"),
        (lambda m, q: train(m, q, 10**9), "n_steps must need at most 2,147,483,648 bytes"),
        (
            lambda m, q: bar(m, q),
            "learner must allow an action in every state, got only -inf in state 3",
        ),
        (
            lambda m, q: explore(
                gymnasium.make("FrozenLake-v1"), QLearner(16, 4, 1.0, 0.9), seed=-1
            ),
            "seed must be an integer >= 0, got -1",
        ),
        (
            lambda m, q: train(m, QLearner(2, 1, 1.0, 0.9), 9),
            r"learner must have a table of \(7, 1\)",
        ),
        (
            lambda m, q: train(MDP([np.eye(7)], np.zeros((7, 1)), 0.9), q, 9),
            "mdp must be able to start in a state that is not an end",
        ),
        (
            lambda m, q: exploit(gymnasium.make("CartPole-v1"), q),
            "env must be Discrete, with the learner's 7 states and 1 actions, got observations Box",
        ),
        (
            lambda m, q: explore(gymnasium.make("FrozenLake-v1"), q),
            r"env must be Discrete, .* got observations Discrete\(16\) and actions Discrete\(4\)",
        ),
        (lambda m, q: explore(Script(n_states=7), q, tol=-1), "tol must be a number in"),
        (
            lambda m, q: exploit(Script(n_states=7), q, max_backups=0),
            "max_backups must be an integer >= 1",
        ),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(corridor(), QLearner(7, 1, alpha=1.0, gamma=0.9))
