import copy
import json
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu.mdp import QLearner, compiled


def optimal_q(T, R, gamma, sweeps=5000):
    """Q* by plain repeated substitution; T (S, A, S), R (S, A)."""
    Q = np.zeros_like(R)
    for _ in range(sweeps):
        Q = R + gamma * T @ Q.max(axis=1)
    return Q


def random_mdp(rng, S, A, deterministic=False):
    if deterministic:
        T = np.eye(S)[rng.integers(S, size=(S, A))]
    else:
        T = rng.dirichlet(np.full(S, 0.5), size=(S, A))
    return T, rng.normal(size=(S, A))


def test_chain_learned_backwards_is_exact():
    learner = QLearner(5, 1, alpha=1.0, gamma=0.9)
    for s in (3, 2, 1, 0):
        learner.update(s, 0, 100.0 if s == 3 else 0.0, s + 1, terminated=s == 3)
    expected = [0.9 * (0.9 * (0.9 * 100.0)), 0.9 * (0.9 * 100.0), 0.9 * 100.0, 100.0, 0.0]
    assert learner.Q[:, 0].tolist() == expected
    assert learner.visits[:, 0].tolist() == [1, 1, 1, 1, 0]


@pytest.mark.thesis("eq 2.12")
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), S=st.integers(1, 8), A=st.integers(1, 4))
def test_deterministic_outcomes_with_alpha_one_reach_optimal_q(seed, S, A):
    rng = np.random.default_rng(seed)
    T, R = random_mdp(rng, S, A, deterministic=True)
    learner = QLearner(S, A, alpha=1.0, gamma=0.6)
    successors = T.argmax(axis=2)
    for _ in range(100):
        for s in range(S):
            for a in range(A):
                learner.update(s, a, R[s, a], successors[s, a], False)
    np.testing.assert_allclose(learner.Q, optimal_q(T, R, 0.6), rtol=1e-13, atol=1e-13)


@pytest.mark.thesis("errata row 9")
def test_random_outcomes_converge_under_robbins_monro_and_not_under_alpha_one():
    rng = np.random.default_rng(5)
    T, R = random_mdp(rng, 4, 2)
    n = 400_000
    s, a = rng.integers(4, size=n), rng.integers(2, size=n)  # exploring starts
    u = rng.random(n)
    s_next = (u[:, None] > T[s, a].cumsum(axis=1)).sum(axis=1).clip(max=3)
    reward = R[s, a] + rng.normal(scale=0.5, size=n)
    best = optimal_q(T, R, 0.5)
    error = {}
    for name, alpha in {
        "1/visits": "1/visits",
        "power": lambda n: n**-0.7,
        "one": 1.0,
    }.items():
        learner = QLearner(4, 2, alpha=alpha, gamma=0.5)
        learner.replay(s, a, reward, s_next, False)
        error[name] = np.abs(learner.Q - best).max()
    assert error["1/visits"] < 0.03
    assert error["power"] < 0.05
    assert error["one"] > 0.3


@pytest.mark.thesis("eq 2.12")
def test_one_over_visits_is_the_mean_of_the_targets():
    rewards = np.random.default_rng(0).normal(size=100)
    learner = QLearner(1, 1, alpha="1/visits", gamma=0.0, initial=1e6)
    for r in rewards:
        learner.update(0, 0, r, 0)
    assert learner.Q[0, 0] == pytest.approx(rewards.mean(), abs=1e-12)


def test_schedule_is_called_with_the_visit_of_that_pair():
    seen = []
    learner = QLearner(2, 1, alpha=lambda n: seen.append(n) or 0.5, gamma=0.0)
    for s in (0, 0, 1, 0):
        learner.update(s, 0, 1.0, 0)
    assert seen == [1, 2, 1, 3]


@given(
    k=st.integers(1, 40),
    gamma=st.floats(0, 1),
    rewards=st.lists(st.floats(-10, 10), min_size=40, max_size=40),
)
def test_held_action_is_worth_what_its_steps_are_worth(k, gamma, rewards):
    """k steps of one action through k states, backed up one by one, or as one held action."""
    chain = QLearner(k + 1, 1, alpha=1.0, gamma=gamma, initial=7.0)
    for s in reversed(range(k)):
        chain.update(s, 0, rewards[s], s + 1)
    held = QLearner(2, 1, alpha=1.0, gamma=gamma, initial=7.0)
    total = sum(gamma**i * rewards[i] for i in range(k))
    held.update(0, 0, total, 1, n_steps=k)
    assert held.Q[0, 0] == pytest.approx(chain.Q[0, 0], rel=1e-9, abs=1e-9)


def test_a_terminated_episode_earns_nothing_more_and_a_truncated_one_does():
    learner = QLearner(2, 2, alpha=1.0, gamma=0.9, initial=5.0)
    learner.update(0, 0, 1.0, 1, terminated=True)
    learner.update(0, 1, 1.0, 1, terminated=False)
    assert learner.Q[0].tolist() == [1.0, 1.0 + 0.9 * 5.0]


def test_update_returns_the_change():
    learner = QLearner(2, 1, alpha=0.25, gamma=0.5, initial=8.0)
    assert learner.update(0, 0, 2.0, 1) == 0.25 * (2.0 + 4.0 - 8.0)
    assert learner.update(0, 0, 2.0, 1) == 0.25 * (2.0 + 4.0 - 7.5)


def test_boltzmann_frequencies_follow_the_stated_probabilities():
    learner = QLearner(2, 4, alpha=1.0, gamma=0.0, rng=11)
    learner.Q[1] = [0.0, 1.0, 2.0, -1.0]
    n = 20_000
    counts = np.bincount([learner.boltzmann(1, 0.8) for _ in range(n)], minlength=4)
    expected = np.exp(np.array([0.0, 1.0, 2.0, -1.0]) / 0.8)
    expected /= expected.sum()
    np.testing.assert_allclose(learner.probabilities(1, 0.8), expected, rtol=1e-14)
    assert stats.chisquare(counts, n * expected).pvalue > 1e-3


@given(
    q=st.lists(st.floats(-1e100, 1e100), min_size=1, max_size=6),
    temperature=st.floats(0, 1e100, exclude_min=True) | st.just(math.inf),
)
def test_boltzmann_never_overflows(q, temperature):
    learner = QLearner(1, len(q), alpha=1.0, gamma=0.0, rng=0)
    learner.Q[0] = q
    with np.errstate(all="raise", under="ignore"):
        p = learner.probabilities(0, temperature)
        a = learner.boltzmann(0, temperature)
    assert p.sum() == pytest.approx(1.0) and (p >= 0).all()
    assert p[a] > 0
    assert p[int(np.argmax(q))] == p.max()


def test_boltzmann_limits():
    learner = QLearner(1, 4, alpha=1.0, gamma=0.0)
    learner.Q[0] = [3.0, 1e100, 1e100, -1e100]
    assert learner.probabilities(0, 5e-324).tolist() == [0.0, 0.5, 0.5, 0.0]
    assert learner.probabilities(0, math.inf).tolist() == [0.25] * 4
    learner.Q[0] = [3.0, 2.0, 1.0, 0.0]
    np.testing.assert_allclose(learner.probabilities(0, 1e12), 0.25, rtol=1e-11)
    assert learner.probabilities(0, 1e-3)[0] == 1.0


@pytest.mark.thesis("errata row 28")
def test_boltzmann_sees_differences_only():
    """A constant on all values leaves the choice alone, even one that swallows small gaps."""
    learner = QLearner(1, 2, alpha=1.0, gamma=0.0)
    learner.Q[0] = [2.0**40, 2.0**40 + 1]
    assert learner.probabilities(0, 1.0)[1] == pytest.approx(1 / (1 + math.exp(-1)), rel=1e-14)


@pytest.mark.thesis("errata row 29")
def test_greedy_shares_ties_evenly():
    learner = QLearner(1, 5, alpha=1.0, gamma=0.0, rng=4)
    learner.Q[0] = [2.0, -1.0, 2.0, 1.999, 2.0]
    counts = np.bincount([learner.greedy(0) for _ in range(9000)], minlength=5)
    assert counts[[1, 3]].tolist() == [0, 0]
    assert stats.chisquare(counts[[0, 2, 4]]).pvalue > 1e-3


def test_unvisited_actions_go_one_by_one():
    learner = QLearner(2, 3, alpha=1.0, gamma=0.0)
    learner.update(0, 1, 0.0, 1)
    assert learner.unvisited(0).tolist() == [0, 2]
    assert learner.unvisited(1).tolist() == [0, 1, 2]
    assert {learner.explore(0) for _ in range(50)} == {0, 2}
    learner.replay(0, [0, 2], 0.0, 1, False)
    assert learner.unvisited(0).tolist() == []
    assert {learner.explore(0) for _ in range(50)} == {0, 1, 2}


def run(learner, n):
    """A run that depends on everything the state must hold: values, counts and the generator."""
    trace = []
    for t in range(n):
        s = t % 3
        a = learner.boltzmann(s, 1.0)
        trace.append((a, learner.update(s, a, learner.rng.normal(), (s + a) % 3)))
        trace.append(learner.greedy(s))
    return trace


def test_restored_run_continues_bit_for_bit():
    learner = QLearner(3, 2, alpha="1/visits", gamma=0.9, rng=8)
    run(learner, 50)
    state = learner.state()
    text = json.dumps(
        {"Q": state["Q"].tolist(), "visits": state["visits"].tolist(), "rng": state["rng"]}
    )
    onward = run(learner, 50)
    again = QLearner(3, 2, alpha="1/visits", gamma=0.9, rng=12345)
    again.restore(json.loads(text))
    assert run(again, 50) == onward
    assert again.Q.tobytes() == learner.Q.tobytes()
    assert again.visits.tobytes() == learner.visits.tobytes()


@pytest.mark.parametrize("clone", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_are_independent_and_equal(clone):
    learner = QLearner(3, 2, alpha=0.5, gamma=0.9, rng=8)
    run(learner, 20)
    twin = clone(learner)
    assert run(learner, 20) == run(twin, 20)
    before = twin.Q.copy()
    learner.Q[:] = 0
    assert (before == twin.Q).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"Q": np.zeros((2, 3))}, r"Q must have shape \(3, 2\), got \(2, 3\)"),
        ({"Q": np.full((3, 2), np.nan)}, "Q must hold finite numbers or -inf, got nan"),
        ({"visits": np.zeros((2, 2), int)}, r"visits must have shape \(3, 2\), got \(2, 2\)"),
        ({"visits": np.full((3, 2), -1)}, "visits must hold integers >= 0, got -1"),
        ({"visits": np.zeros((3, 2))}, "visits must hold integers, got array"),
        ({"rng": {"bit_generator": "MT19937"}}, "rng must be the state of a PCG64 generator"),
        ({"rng": None}, "rng must be the state of a PCG64 generator"),
    ],
)
def test_restore_refuses_and_leaves_the_table_alone(change, message):
    learner = QLearner(3, 2, alpha=0.5, gamma=0.9, initial=4.0)
    with pytest.raises(ValueError, match=message):
        learner.restore(learner.state() | change)
    assert (learner.Q == 4.0).all() and not learner.visits.any()


def test_restore_names_what_is_missing():
    with pytest.raises(ValueError, match="state must be a dict, got None"):
        QLearner(1, 1, 0.5, 0.9).restore(None)
    with pytest.raises(ValueError, match="got no visits"):
        QLearner(1, 1, 0.5, 0.9).restore({"Q": [[0.0]], "rng": {}})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 2, 0.5, 0.9), "n_states must be an integer >= 1, got 0"),
        ((3, 2.0, 0.5, 0.9), "n_actions must be an integer >= 1, got 2.0"),
        ((3, 2, 1.5, 0.9), r"alpha must be a number in \[0, 1\], got 1.5"),
        ((3, 2, math.nan, 0.9), r"alpha must be a number in \[0, 1\], got nan"),
        ((3, 2, "1/n", 0.9), "alpha must be a number, '1/visits' or a callable, got '1/n'"),
        ((3, 2, 0.5, -0.1), r"gamma must be a number in \[0, 1\], got -0.1"),
        (
            (10**9, 2, 0.5, 0.9),
            "n_states and n_actions must need at most 2,147,483,648 bytes, got 16,000,000,000",
        ),
    ],
)
def test_constructor_refuses(arguments, message):
    with pytest.raises(ValueError, match=message):
        QLearner(*arguments)


def test_an_initial_value_beyond_all_rewards_is_refused():
    with pytest.raises(ValueError, match=r"initial must be at most 1e\+100 in magnitude"):
        QLearner(3, 2, 0.5, 0.9, initial=1e101)


BAD_UPDATES = [
    ((-1, 0, 1.0, 1), r"s must be an integer in \[0, 2\], got -1"),
    ((3, 0, 1.0, 1), r"s must be an integer in \[0, 2\], got 3"),
    ((1.5, 0, 1.0, 1), r"s must be an integer in \[0, 2\], got 1.5"),
    (("1", 0, 1.0, 1), r"s must be an integer in \[0, 2\], got '1'"),
    ((2**70, 0, 1.0, 1), r"s must be an integer in \[0, 2\]"),
    ((0, -1, 1.0, 1), r"a must be an integer in \[0, 1\], got -1"),
    ((0, 2, 1.0, 1), r"a must be an integer in \[0, 1\], got 2"),
    ((0, 0, 1.0, -1), r"s_next must be an integer in \[0, 2\], got -1"),
    ((0, 0, 1.0, 3, True), r"s_next must be an integer in \[0, 2\], got 3"),
    ((0, 0, math.nan, 1), "r must be a finite number, got nan"),
    ((0, 0, math.inf, 1), "r must be a finite number, got inf"),
    ((0, 0, None, 1), "r must be a finite number, got None"),
    ((0, 0, 1.0, 1, False, 0), "n_steps must be an integer >= 1, got 0"),
    ((0, 0, 1.0, 1, False, 1.5), "n_steps must be an integer >= 1, got 1.5"),
    ((0, 0, 1.0, 1, "no"), "terminated must hold integers, got 'no'"),
    ((0, 0, 1.0, 1, 2), r"terminated must .*\[0, 1\], got 2"),
    ((0, 0, 1.0, 1, [True, False]), r"terminated must be true or false, got \[True, False\]"),
    ((0, 0, 1.0, 1, [[1], [0, 1]]), "terminated must be an array of numbers, got"),
    ((0, 0, -2e100, 1), r"r must be at most 1e\+100 in magnitude, got -2e\+100"),
]


@pytest.mark.parametrize("alpha", [0.9, "1/visits", lambda n: 0.9])
@pytest.mark.parametrize(("arguments", "message"), BAD_UPDATES)
def test_update_refuses_and_learns_nothing(alpha, arguments, message):
    learner = QLearner(3, 2, alpha=alpha, gamma=1.0, initial=1e99)
    with pytest.raises(ValueError, match=message):
        learner.update(*arguments)
    assert (learner.Q == 1e99).all() and not learner.visits.any()


def test_a_schedule_out_of_range_is_named():
    learner = QLearner(1, 1, alpha=lambda n: 2.0 / n, gamma=0.9)
    with pytest.raises(ValueError, match=r"alpha\(1\) must be a number in \[0, 1\], got 2.0"):
        learner.update(0, 0, 1.0, 0)


def test_numpy_scalars_and_whole_rewards_are_welcome():
    learner = QLearner(3, 2, alpha=0.5, gamma=0.9)
    learner.update(np.int64(1), np.int32(1), 7, np.uint8(2), np.bool_(True))
    assert learner.Q[1, 1] == 3.5


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (([0, 3], 0, 0.0, 0, False), r"s must hold integers in \[0, 2\], got 3 at \(1,\)"),
        ((0, [0, -1], 0.0, 0, False), r"a must hold integers in \[0, 1\], got -1 at \(1,\)"),
        ((0, 0, [0.0, np.nan], 0, False), r"r must hold finite numbers, got nan at \(1,\)"),
        ((0, 0, 0.0, [0.5], False), r"s_next must hold integers, got \[0.5\]"),
        (([0, 1], [0, 1, 0], 0.0, 0, False), "the columns must have one length"),
        (
            (0, 0, [0.0, 1e101], 0, False),
            r"r must hold numbers of at most 1e\+100 in magnitude, got 1e\+101",
        ),
        (([[0]], 0, 0.0, 0, False), r"the columns must have shape \(N,\), got \(1, 1\)"),
        ((0, 0, 0.0, 0, False, [1, 0]), r"n_steps must hold integers >= 1, got 0 at \(1,\)"),
        ((0, 0, 0.0, 0, ["no"]), "terminated must hold integers, got"),
        ((0, 0, 0.0, 0, [1, 0, 2]), r"terminated must hold integers in \[0, 1\], got 2"),
        (
            ([0, 1], 1, 0.0, 0, False),
            r"a must be an action that state 1 allows, got 1 .* at \(1,\)",
        ),
        ((0, 0, 0.0, [0, 2], False), r"s_next must allow an action, .* in state 2 at \(1,\)"),
    ],
)
def test_replay_refuses_and_learns_nothing(columns, message):
    learner = QLearner(3, 2, alpha=0.5, gamma=0.9, initial=2.0)
    learner.Q[1, 1] = -np.inf
    learner.Q[2] = -np.inf
    before = learner.Q.copy()
    with pytest.raises(ValueError, match=message):
        learner.replay(*columns)
    assert (before == learner.Q).all() and not learner.visits.any()


@pytest.mark.parametrize(
    ("column", "wrong", "message"),
    [
        (0, 3, r"s must hold integers in \[0, 2\], got 3 at \(7,\)"),
        (1, -1, r"a must hold integers in \[0, 1\], got -1 at \(7,\)"),
        (2, np.inf, r"r must hold finite numbers, got inf at \(7,\)"),
        (3, 2, r"s_next must allow an action, .* in state 2 at \(7,\)"),
    ],
)
def test_replay_learns_nothing_before_a_fault_either(column, wrong, message):
    learner = QLearner(3, 2, alpha=0.5, gamma=0.9, initial=2.0)
    learner.Q[2] = -np.inf
    before = learner.Q.copy()
    columns = [np.arange(9) % 2, np.arange(9) % 2, np.ones(9), np.arange(9) % 2]
    columns[column][7] = wrong
    with pytest.raises(ValueError, match=message):
        learner.replay(*columns, False)
    assert (before == learner.Q).all() and not learner.visits.any()


def test_replay_of_nothing_changes_nothing():
    learner = QLearner(3, 2, alpha="1/visits", gamma=0.9)
    nothing = np.array([], dtype=int)
    assert learner.replay(nothing, nothing, [], nothing, []).tolist() == []


@pytest.mark.parametrize("s", [-1, 2, 0.0, None])
def test_choices_refuse_a_state_outside_the_table(s):
    learner = QLearner(2, 2, alpha=0.5, gamma=0.9)
    calls = [learner.greedy, learner.explore, learner.unvisited]
    calls += [lambda s: learner.boltzmann(s, 1.0), lambda s: learner.probabilities(s, 1.0)]
    for call in calls:
        with pytest.raises(ValueError, match=r"s must be an integer in \[0, 1\], got"):
            call(s)


@pytest.mark.parametrize("temperature", [0, -1.0, math.nan, None])
def test_choices_refuse_a_temperature_that_is_not_positive(temperature):
    learner = QLearner(1, 2, alpha=0.5, gamma=0.9)
    for call in (learner.boltzmann, learner.probabilities):
        with pytest.raises(ValueError, match="temperature must be a number in"):
            call(0, temperature)


def test_choices_name_a_value_that_is_no_number():
    learner = QLearner(1, 2, alpha=0.5, gamma=0.9)
    learner.Q[0, 1] = math.nan
    for call in (learner.greedy, lambda s: learner.boltzmann(s, 1.0)):
        with pytest.raises(ValueError, match="Q must hold finite numbers"):
            call(0)


@pytest.mark.parametrize("temperature", [5e-324, 0.3, math.inf])
def test_what_is_not_allowed_is_never_drawn(temperature):
    learner = QLearner(2, 4, alpha=0.5, gamma=0.9, rng=1)
    learner.Q[0] = [-math.inf, 1.0, 1.0, -math.inf]
    assert {learner.boltzmann(0, temperature) for _ in range(60)} == {1, 2}
    assert {learner.greedy(0) for _ in range(60)} == {1, 2} == set(learner.unvisited(0).tolist())
    assert {learner.explore(0) for _ in range(60)} == {1, 2}
    learner.replay(0, [1, 2, 1], 0.0, 1, False)
    assert {learner.explore(0) for _ in range(60)} == {1, 2}
    learner.update(1, 0, 4.0, 0, n_steps=1)
    assert learner.Q[1, 0] == 0.5 * (4 + 0.9 * learner.Q[0].max())
    again = QLearner(2, 4, alpha=0.5, gamma=0.9)
    again.restore(learner.state())
    assert np.isneginf(again.Q[0, [0, 3]]).all()


def test_a_state_that_allows_nothing_is_named():
    learner = QLearner(2, 2, alpha=0.5, gamma=0.9)
    learner.Q[1] = -math.inf
    calls = [learner.greedy, learner.explore, lambda s: learner.boltzmann(s, 1.0)]
    for call in calls:
        with pytest.raises(ValueError, match=r"Q must allow an action in every state, .* state 1"):
            call(1)
    with pytest.raises(ValueError, match=r"s_next must allow an action, got only .* in state 1"):
        learner.update(0, 0, 0.0, 1)
    with pytest.raises(ValueError, match="s_next must allow"):
        learner.update(1, 0, 0.0, 1, terminated=True)
    learner.Q[1, 0] = 0.0
    with pytest.raises(ValueError, match="a must be an action that state 1 allows, got 1"):
        learner.update(1, 1, 0.0, 0)
    assert not learner.visits.any()


class Last(np.random.Generator):
    """A generator that draws the largest number below 1."""

    def random(self, size=None):
        return math.nextafter(1, 0)


@settings(deadline=None)  # the first call compiles
@given(st.lists(st.floats(0, 3) | st.just(-math.inf), min_size=1, max_size=6))
def test_the_last_draw_is_never_past_what_is_allowed(q):
    learner = QLearner(1, len(q) + 1, 0.5, 0.9, rng=Last(np.random.PCG64(0)))
    learner.Q[0] = [0.0, *q]
    a = learner.boltzmann(0, 1.0)
    assert learner.Q[0, a] > -math.inf
    assert a == compiled.boltzmann(learner.Q, 0, 1.0, math.nextafter(1, 0))


@pytest.mark.parametrize("yes", [True, np.True_, 1, np.array([True]), np.int64(1)])
def test_an_end_can_be_told_in_many_ways(yes):
    learner = QLearner(2, 1, alpha=1.0, gamma=0.5, initial=8.0)
    learner.update(0, 0, 1.0, 1, terminated=yes)
    assert learner.Q[0, 0] == 1.0
    assert learner.replay([0], 0, 1.0, 1, np.atleast_1d(yes)).tolist() == [0.0]


@pytest.mark.parametrize("schedule", [lambda n: "0.5", lambda n: None, lambda n: math.nan])
def test_a_schedule_without_numbers_is_named(schedule):
    learner = QLearner(2, 1, alpha=schedule, gamma=0.5)
    with pytest.raises(ValueError, match="alpha"):
        learner.replay([0, 0], 0, 1.0, 1, False)
    with pytest.raises(ValueError, match=r"alpha\(1\) must be a number in \[0, 1\]"):
        learner.update(0, 0, 1.0, 1)
    with pytest.raises(ValueError, match="rng must be a numpy Generator"):
        QLearner(2, 1, 0.5, 0.5, rng="0")
