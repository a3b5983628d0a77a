"""A POMDP as a Gymnasium environment, and an agent that acts in it on its belief."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import arkaq_edu as ae
from arkaq_edu._paths import data_file
from arkaq_edu.pomdp import (
    POMDP,
    BeliefAgent,
    belief_update,
    problem,
    solve_point_based,
    solve_pomdp,
)

NAMES = ["ball_side", "corridor", "floors", "three_places", "tiger", "two_state"]


def make(pomdp, **settings):
    return gymnasium.make("arkaq_edu:POMDP-v0", pomdp=pomdp, **settings)


def walk(env, seed, n=60):
    """What an episode of actions drawn at random shows: the same for the same seed."""
    rng = np.random.default_rng(seed)
    seen = [env.reset(seed=seed)]
    for _ in range(n):
        seen.append(env.step(np.int64(rng.integers(env.action_space.n))))
    return seen


@pytest.mark.parametrize("name", NAMES)
def test_gymnasium_finds_nothing_to_complain_of(name, recwarn):
    check_env(make(name).unwrapped)
    assert [str(warning.message) for warning in recwarn] == []


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_gives_the_same_run(name):
    assert walk(make(name), 3) == walk(make(name), 3)


def test_a_model_a_name_and_a_path_make_the_same_environment(tmp_path):
    path = tmp_path / "OTHER.POMDP"
    path.write_bytes(data_file("pomdp/corridor.pomdp").read_bytes())
    runs = [walk(make(pomdp), 1) for pomdp in ("corridor", problem("corridor"), path, str(path))]
    assert runs[0] == runs[1] == runs[2] == runs[3]


@pytest.mark.parametrize("given", ["chess", 3, None])
def test_what_is_no_pomdp_is_refused(given):
    with pytest.raises(ValueError, match=r"must be (one of ball_side|a POMDP, a name or a path)"):
        make(given)


def test_at_the_start_there_is_nothing_to_observe():
    env = make("corridor")
    states = {env.reset(seed=seed)[1]["state"] for seed in range(50)}
    assert env.reset()[0] == env.unwrapped.pomdp.n_observations
    assert states == {0, 1, 3}  # never the goal


def test_an_episode_can_start_in_a_given_state():
    env = make("corridor")
    assert env.reset(options={"state": 2})[1] == {"state": 2}
    for options in (
        {"state": 4},
        {"state": -1},
        {"state": [0, 1]},
        {"place": 1},
        3,
        {"state": 1, "place": 1},
    ):
        with pytest.raises(ValueError, match=r"options must hold a state in \[0, 3\]"):
            env.reset(options=options)


def test_actions_and_seeds_pass_the_gate():
    env = make("corridor").unwrapped
    for seed in (-1, 1.5, "1", [1]):
        with pytest.raises(ValueError, match="seed must be an integer >= 0"):
            env.reset(seed=seed)
    steps = []
    for action in (1, np.int64(1), np.array(1), np.array([1])):
        env.reset(seed=3)
        steps.append(env.step(action))
    assert steps[0] == steps[1] == steps[2] == steps[3]
    for action in (-1, 2, 0.5, "left", None, [0, 1]):
        with pytest.raises(ValueError, match=r"action must be an integer in \[0, 1\]"):
            env.step(action)


def test_steps_follow_the_model():
    """How often each (s', z) follows each (s, a), against T and O; and the reward is R(s, a)."""
    pomdp = problem("three_places")
    env = make(pomdp).unwrapped
    env.reset(seed=0)
    n = 3000
    for s, a in ((0, 0), (1, 0), (2, 3)):
        counts = np.zeros((pomdp.n_states, pomdp.n_observations))
        for _ in range(n):
            env.state = s
            z, r, terminated, truncated, info = env.step(np.int64(a))
            assert (r, terminated, truncated) == (pomdp.R[s, a], False, False)
            counts[info["state"], z] += 1
        expected = pomdp.T[a, s][:, np.newaxis] * pomdp.O[a]
        error = np.sqrt(expected * (1 - expected) / n)
        assert (np.abs(counts / n - expected) <= 4.5 * error + 1e-12).all()


def test_many_walkers_step_as_one_does():
    pomdp = problem("ball_side")
    n = 20_000
    s, z, r, terminated = pomdp.step(np.zeros(n, int), 0, rng=1)
    frequencies = np.histogram2d(s, z, bins=[np.arange(3), np.arange(4)])[0] / n
    np.testing.assert_allclose(frequencies, pomdp.T[0, 0][:, None] * pomdp.O[0], atol=0.015)
    assert (r == -1).all() and not terminated.any()


def test_observations_that_sum_to_nearly_one_are_never_drawn_past():
    class Last(np.random.Generator):
        def random(self, size=None):
            return np.full(size, np.nextafter(1, 0))

    pomdp = POMDP([np.eye(2)], [[[0.5, 0.5 - 8e-10, 0.0]] * 2], [[1.0], [0.0]], 0.9)
    assert pomdp.step([0, 1], 0, rng=Last(np.random.PCG64(0)))[1].tolist() == [1, 1]
    for s, a in ((2, 0), (0, 3), (-1, 0)):
        with pytest.raises(ValueError, match="must hold integers in"):
            pomdp.step(s, a, rng=0)


def test_it_ends_where_the_mdp_ends_and_where_time_is_up():
    walk_on = [[0, 1, 0], [0, 0, 1], [0, 0, 1]]
    pomdp = POMDP([walk_on], np.ones((1, 3, 1)), [[1], [1], [0]], 0.9, [1, 0, 0])
    env = make(pomdp)
    env.reset(seed=0)
    assert [env.step(0)[2:4] for _ in range(2)] == [(False, False), (True, False)]
    env = make("tiger", max_episode_steps=3)
    env.reset(seed=0)
    assert [env.step(0)[2:4] for _ in range(3)] == [(False, False)] * 2 + [(False, True)]


def earned(agent, env, n_episodes, n_steps):
    """The discounted return of each episode of an agent in an environment."""
    totals = []
    for seed in range(n_episodes):
        env.reset(seed=seed)
        agent.reset()
        total = 0.0
        for t in range(n_steps):
            observation, reward, _, _, _ = env.step(agent.act())
            agent.observe(observation)
            total += env.pomdp.gamma**t * reward
        totals.append(total)
    return np.array(totals)


@pytest.mark.parametrize("solve", [solve_pomdp, lambda pomdp: solve_point_based(pomdp).lower])
def test_in_the_tiger_problem_the_agent_earns_what_its_value_function_says(solve):
    tiger = problem("tiger")
    agent = BeliefAgent(tiger, solve(tiger))
    totals = earned(agent, make(tiger).unwrapped, n_episodes=300, n_steps=100)
    # Later steps are worth at most .95^100 = .006 times what the first are.
    error = totals.std(ddof=1) / np.sqrt(len(totals))
    assert abs(totals.mean() - agent.value_function.value(tiger.start)) < 3 * error + 0.13
    assert error < 2.5  # so that an agent that only listens (-20) or opens at once (-900) fails


def test_the_agent_keeps_the_belief():
    corridor = problem("corridor")
    agent = BeliefAgent(corridor, solve_pomdp(corridor, horizon=3))
    belief = corridor.start
    for z in (0, 0, 1, 0):
        a = agent.act()
        assert a == agent.value_function.action(belief)
        agent.observe(z)
        belief = belief_update(corridor, belief, a, z)
        np.testing.assert_array_equal(agent.belief, belief)
    agent.reset()
    np.testing.assert_array_equal(agent.belief, corridor.start)
    agent.reset([0, 1, 0, 0])
    np.testing.assert_array_equal(agent.belief, [0, 1, 0, 0])


def test_what_the_agent_refuses():
    tiger, corridor = problem("tiger"), problem("corridor")
    with pytest.raises(ValueError, match="value_function must be over 4 states, got one over 2"):
        BeliefAgent(corridor, solve_pomdp(tiger, horizon=1))
    agent = BeliefAgent(corridor, solve_pomdp(corridor, horizon=2))
    with pytest.raises(ValueError, match="observe must follow act"):
        agent.observe(0)
    with pytest.raises(ValueError, match="belief must"):
        agent.reset([0.5, 0.5])
    agent.act()
    with pytest.raises(ValueError, match="z must be"):
        agent.observe(2)
    agent.observe(0)
    with pytest.raises(ValueError, match="observe must follow act"):
        agent.observe(0)


def test_importing_the_package_registers_it():
    assert "POMDP-v0" in gymnasium.registry
    assert ae.envs.POMDPEnv is type(make("tiger").unwrapped)
