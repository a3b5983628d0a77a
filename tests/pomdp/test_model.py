"""A POMDP, and what is known in it: beliefs, their updates and where they lie."""

import copy
import math
import pickle

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import assume, given, settings
from scipy import sparse

from arkaq_edu.pomdp import (
    POMDP,
    BeliefAgent,
    ValueFunction,
    belief_update,
    entropy,
    expected_rewards,
    predict,
    problem,
    solve_pomdp,
    successors,
    to_triangle,
)

GOOD = {
    "T": [np.eye(2), [[0.5, 0.5], [0, 1]]],
    "O": [[[0.9, 0.1, 0], [0.1, 0.9, 0]], [[0, 0, 1], [0, 0, 1]]],
    "R": [[1, 0], [0, 2]],
    "gamma": 0.9,
}


# The model


def test_a_model_keeps_what_it_was_given():
    pomdp = POMDP(**GOOD, start=[0.25, 0.75], states=["near", "far"])
    for name in ("T", "O", "R"):
        np.testing.assert_array_equal(getattr(pomdp, name), GOOD[name])
    assert (pomdp.n_states, pomdp.n_actions, pomdp.n_observations) == (2, 2, 3)
    assert (pomdp.states, pomdp.actions) == (("near", "far"), ("0", "1"))
    assert pomdp.mdp.T is pomdp.T and pomdp.mdp.gamma == 0.9
    np.testing.assert_array_equal(POMDP(**GOOD).start, [0.5, 0.5])


@pytest.mark.parametrize("name", ["T", "O", "R", "start"])
def test_a_model_cannot_be_written_to_nor_through(name):
    given_arrays = {key: np.array(GOOD[key], dtype=float) for key in ("T", "O", "R")}
    start = np.array([0.5, 0.5])
    pomdp = POMDP(**given_arrays, gamma=0.9, start=start)
    before = getattr(pomdp, name).copy()
    (start if name == "start" else given_arrays[name])[...] = 7
    np.testing.assert_array_equal(getattr(pomdp, name), before)
    with pytest.raises(ValueError, match="read-only"):
        getattr(pomdp, name)[...] = 0


@pytest.mark.thesis("errata row 10")
@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"T": np.eye(2)}, "T must have shape"),
        ({"T": np.ones((2, 2, 3)) / 3}, "T must have shape"),
        ({"T": [np.eye(2), [[0.5, 0.6], [0, 1]]]}, r"T must sum to 1 .* got 1.1 at \(1, 0\)"),
        ({"O": np.ones((1, 2, 1))}, r"O must have shape \(2, 2, any\), got \(1, 2, 1\)"),
        ({"O": np.ones((2, 3, 1))}, r"O must have shape \(2, 2, any\), got \(2, 3, 1\)"),
        ({"O": np.ones((2, 2, 0))}, "O must have no axis of length 0"),
        ({"O": np.full((2, 2, 2), 0.4)}, r"O must sum to 1 .* got 0.8 at \(0, 0\)"),
        ({"O": [[[2, -1], [0, 1]]] * 2}, r"O must hold probabilities >= 0, got -1.0 at"),
        ({"O": [[[np.nan, 1], [0, 1]]] * 2}, "O must hold finite numbers, got nan at"),
        ({"O": "seen"}, "O must"),
        ({"R": [[1, 0]]}, "R must have shape"),
        ({"R": [[1, np.inf], [0, 2]]}, "R must hold finite numbers"),
        ({"gamma": 1.5}, r"gamma must be a number in \[0, 1\], got 1.5"),
        ({"gamma": np.nan}, "gamma must be"),
        ({"start": [0.5, 0.4]}, "start must sum to 1"),
        ({"start": [1]}, "start must have shape"),
        ({"states": ["a"]}, r"states must be 2 names, got \['a'\]"),
        ({"states": ["a", 1]}, "states must be 2 names"),
        ({"actions": ["a", ""]}, "actions must be 2 names"),
        ({"observations": ["x", "y", "x"]}, "observations must be different names, got 'x' twice"),
    ],
)
def test_a_model_that_is_none_is_refused(change, said):
    with pytest.raises(ValueError, match=said):
        POMDP(**{**GOOD, **change})


@pytest.mark.parametrize("states", [3, "ab", {"a": 1}, None, [["a"], ["b"]]])
def test_names_are_a_sequence_of_words(states):
    if states is None:
        assert POMDP(**GOOD, states=states).states == ("0", "1")
    else:
        with pytest.raises(ValueError, match="states must be 2 names"):
            POMDP(**GOOD, states=states)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_a_copy_of_a_model_is_as_protected_as_the_model(copied):
    pomdp = copied(POMDP(**GOOD))
    assert pomdp.T is pomdp.mdp.T
    for table in (pomdp.T, pomdp.O, pomdp.R, pomdp.start):
        with pytest.raises(ValueError, match="read-only"):
            table[...] = 0


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), dtype=st.sampled_from([np.float32, np.float64]))
def test_rows_within_rounding_of_one_are_divided_by_their_sums(seed, dtype):
    rng = np.random.default_rng(seed)
    S, A, Z = rng.integers(1, 7, size=3)
    off = 0 if dtype == np.float32 else rng.uniform(-1e-8, 1e-8)
    T, O, start = (  # noqa: E741
        (rng.dirichlet(np.full(shape[-1], 0.3), size=shape[:-1]) * (1 + off)).astype(dtype)
        for shape in ((A, S, S), (A, S, Z), (S,))
    )
    T[0, 0], O[0, 0] = np.eye(S)[0] * (1 + off), np.eye(Z)[0] * (1 + off)
    pomdp = POMDP(T, O, np.zeros((S, A)), 0.9, start)
    for given_, kept in ((T, pomdp.T), (O, pomdp.O), (start, pomdp.start)):
        np.testing.assert_allclose(kept, given_, rtol=0, atol=1e-6)
        np.testing.assert_allclose(kept.sum(axis=-1), 1, rtol=0, atol=2e-15)
        assert kept.max() <= 1 + 1e-15
    assert pomdp.T[0, 0, 0] == 1  # so that an end is known
    again = POMDP(pomdp.T, pomdp.O, pomdp.R, 0.9, pomdp.start)
    assert all(
        getattr(again, name).tobytes() == getattr(pomdp, name).tobytes()
        for name in ("T", "O", "start")
    )


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), dtype=st.sampled_from([np.float32, np.float64, list]))
def test_no_function_refuses_the_belief_of_another(seed, dtype):
    rng = np.random.default_rng(seed)
    S = int(rng.integers(1, 40))
    T, O = rng.dirichlet(np.full(S, 0.3), size=(2, S)), rng.dirichlet(np.ones(3), size=(2, S))  # noqa: E741
    pomdp = POMDP(T, O, rng.normal(size=(S, 2)), 0.9)
    V = ValueFunction(rng.normal(size=(3, S)), [0, 1, 0], np.empty((3, 0), int))
    b = pomdp.start
    for _ in range(20):
        b = belief_update(pomdp, b, int(rng.integers(2)), int(rng.integers(3)))
        b = b.tolist() if dtype is list else b.astype(dtype)
        for function in (V.value, V.action, entropy, BeliefAgent(pomdp, V).reset):
            function(b)
        for function in (predict, successors):
            function(pomdp, b, 1)
        expected_rewards(pomdp, b)
    if dtype is not list:
        assert V.value(b[np.newaxis]) == pytest.approx(V.value(b))


def test_actions_and_observations_of_one_element_arrays():
    tiger = problem("tiger")
    after = belief_update(tiger, [0.5, 0.5], 0, 1)
    for a, z in ((np.array(0), np.array([1])), (np.int8(0), np.uint64(1))):
        np.testing.assert_array_equal(belief_update(tiger, [0.5, 0.5], a, z), after)
    for rng in (-1, "1", 0.5):
        with pytest.raises(ValueError, match="rng must be a numpy Generator, an integer >= 0"):
            tiger.step(0, 0, rng)


# Beliefs


@st.composite
def looks(draw):
    """A random POMDP with many zeros, a belief, an action and an observation."""
    S, A, Z = draw(st.tuples(st.integers(1, 5), st.integers(1, 3), st.integers(1, 4)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))

    def rows(*shape):
        x = rng.random(shape) * (rng.random(shape) < 0.6)
        x[..., 0] += x.sum(axis=-1) == 0
        return x / x.sum(axis=-1, keepdims=True)

    pomdp = POMDP(rows(A, S, S), rows(A, S, Z), rng.normal(size=(S, A)), 0.9, rows(S))
    return pomdp, rows(S), int(rng.integers(A)), int(rng.integers(Z))


def by_enumeration(pomdp, b, a, z):
    """Pr(s' | z, b, a) from the joint probability of everything that can happen."""
    chance_of = np.zeros(pomdp.n_states)
    for s in range(pomdp.n_states):
        for s_next in range(pomdp.n_states):
            chance_of[s_next] += b[s] * pomdp.T[a, s, s_next] * pomdp.O[a, s_next, z]
    return chance_of


@pytest.mark.thesis("errata row 13")
@settings(max_examples=100, deadline=None)
@given(look=looks())
def test_equation_2_15_by_enumeration(look):
    pomdp, b, a, z = look
    joint = by_enumeration(pomdp, b, a, z)
    if joint.sum() == 0:
        with pytest.raises(ValueError, match=f"'{z}' has probability 0 after '{a}'"):
            belief_update(pomdp, b, a, z)
    else:
        after = belief_update(pomdp, b, a, z)
        np.testing.assert_allclose(after, joint / joint.sum(), rtol=0, atol=1e-12)
        assert abs(after.sum() - 1) < 1e-12


@settings(max_examples=100, deadline=None)
@given(look=looks())
def test_what_is_expected_after_all_observations_is_the_prediction(look):
    pomdp, b, a, _ = look
    chances, beliefs = successors(pomdp, b, a)
    np.testing.assert_allclose(chances.sum(), 1, atol=1e-12)
    mixed = sum(chance * belief for chance, belief in zip(chances, beliefs, strict=True) if chance)
    np.testing.assert_allclose(mixed, predict(pomdp, b, a), rtol=0, atol=1e-12)
    for z, chance in enumerate(chances):
        assert np.isclose(chance, by_enumeration(pomdp, b, a, z).sum(), rtol=0, atol=1e-12)
        if chance > 0:
            np.testing.assert_allclose(beliefs[z], belief_update(pomdp, b, a, z), atol=1e-12)
        else:
            assert np.isnan(beliefs[z]).all()


@pytest.mark.thesis("eq 2.17")
@settings(max_examples=50, deadline=None)
@given(look=looks(), mix=st.floats(0, 1))
def test_prediction_and_reward_are_linear_in_the_belief(look, mix):
    pomdp, b, a, _ = look
    both = mix * b + (1 - mix) * pomdp.start
    for f in (lambda x: predict(pomdp, x, a), lambda x: expected_rewards(pomdp, x)):
        np.testing.assert_allclose(f(both), mix * f(b) + (1 - mix) * f(pomdp.start), atol=1e-12)
    for s in range(pomdp.n_states):  # who sees the state is in the MDP
        np.testing.assert_array_equal(predict(pomdp, np.eye(pomdp.n_states)[s], a), pomdp.T[a, s])


@settings(max_examples=50, deadline=None)
@given(look=looks())
def test_the_order_of_looks_that_move_nothing_does_not_matter(look):
    pomdp, b, a, z = look
    still = POMDP(np.repeat([np.eye(len(b))], pomdp.n_actions, 0), pomdp.O, pomdp.R, 0.9)
    other = (z + 1) % pomdp.n_observations
    chance = (b * still.O[a, :, z] * still.O[a, :, other]).sum()
    assume(chance > 1e-9)
    one = belief_update(still, belief_update(still, b, a, z), a, other)
    two = belief_update(still, belief_update(still, b, a, other), a, z)
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-9)


@pytest.mark.parametrize("function", [predict, successors])
def test_a_belief_or_an_action_that_is_none_is_refused(function):
    tiger = problem("tiger")
    for b in ([0.5, 0.6], [1.5, -0.5], [1.0], [np.nan, 1], [[0.5, 0.5]]):
        with pytest.raises(ValueError, match="b must"):
            function(tiger, b, 0)
        with pytest.raises(ValueError, match="b must"):
            expected_rewards(tiger, b)
    for a in (-1, 3, 0.5, True):
        with pytest.raises(ValueError, match=r"a must be an integer in \[0, 2\]"):
            function(tiger, [0.5, 0.5], a)
    for z in (-1, 2, "hear-left"):
        with pytest.raises(ValueError, match=r"z must be an integer in \[0, 1\]"):
            belief_update(tiger, [0.5, 0.5], 0, z)


# Sparse tables


def sparse_twin(pomdp, seed=0):
    """The same model from sparse matrices of several formats."""
    forms = (sparse.csr_array, sparse.csc_array, sparse.coo_array, sparse.csr_matrix)
    T, O = (  # noqa: E741
        [forms[(a + seed) % 4](matrix) for a, matrix in enumerate(table)]
        for table in (pomdp.T, pomdp.O)
    )
    return POMDP(T, O, pomdp.R, pomdp.gamma, pomdp.start)


@settings(max_examples=60, deadline=None)
@given(look=looks(), seed=st.integers(0, 3))
def test_a_sparse_model_gives_what_the_dense_one_does(look, seed):
    pomdp, b, a, z = look
    twin = sparse_twin(pomdp, seed)
    assert repr(twin) == repr(pomdp)
    for one, other in zip((*twin.T, *twin.O), (*pomdp.T, *pomdp.O), strict=True):
        np.testing.assert_array_equal(one.toarray(), other)
    np.testing.assert_allclose(predict(twin, b, a), predict(pomdp, b, a), atol=1e-14)
    for one, other in zip(successors(twin, b, a), successors(pomdp, b, a), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-13)
    if successors(pomdp, b, a).chances[z] > 0:
        np.testing.assert_allclose(
            belief_update(twin, b, a, z), belief_update(pomdp, b, a, z), atol=1e-13
        )
    s = np.arange(pomdp.n_states)
    for one, other in zip(twin.step(s, a, 1), pomdp.step(s, a, 1), strict=True):
        np.testing.assert_array_equal(one, other)
    for name in ("T", "O", "R", "start"):
        np.testing.assert_array_equal(getattr(twin.dense(), name), getattr(pomdp, name))
    assert pomdp.dense() is pomdp


def test_sparse_tables_are_checked_and_protected_like_dense_ones():
    eye, seen = sparse.eye_array(2), np.ones((1, 2, 1))
    for T, said in (
        ([eye, sparse.eye_array(3)], "T must have shape"),
        ([sparse.csr_array([[0.5, 0.6], [0, 1]])], r"T must sum to 1 .* got 1.1 at \(0, 0\)"),
        ([sparse.csr_array([[2.0, -1], [0, 1]])], "T must hold probabilities >= 0, got -1"),
        ([sparse.csr_array([[np.nan, 1], [0, 1]])], r"T\[0\] must hold finite numbers"),
        ([sparse.csr_array((2, 2))], r"T must sum to 1 .* got 0 at \(0, 0\)"),
    ):
        with pytest.raises(ValueError, match=said):
            POMDP(T, seen, [[0], [0]], 0.9)
    with pytest.raises(ValueError, match="O must have shape"):
        POMDP([eye], [sparse.eye_array(3)], [[0], [0]], 0.9)
    rounded = sparse.csr_array(np.float32([[0.1, 0.9], [0, 1.0000001]]))
    pomdp = POMDP([rounded], seen, [[0], [0]], 0.9)
    assert pomdp.mdp.ends.tolist() == [False, True]
    for model in (pomdp, copy.deepcopy(pomdp), pickle.loads(pickle.dumps(pomdp))):
        with pytest.raises(ValueError, match="read-only"):
            model.T[0].data[0] = 1
    rounded.data[:] = 7
    assert pomdp.T[0].data.max() == 1


def test_dense_tables_that_do_not_fit_are_not_made():
    n = 30_000
    pomdp = POMDP([sparse.eye_array(n)], np.ones((1, n, 1)), np.zeros((n, 1)), 0.9)
    b = belief_update(pomdp, pomdp.start, 0, 0)
    np.testing.assert_allclose(b, pomdp.start)
    for solve in (pomdp.dense, lambda: solve_pomdp(pomdp, 1)):
        with pytest.raises(ValueError, match="dense tables of pomdp must need at most"):
            solve()


# The thesis


def test_errata_11_the_floors_after_one_step_down():
    floors = problem("floors")
    down = floors.actions.index("down")
    assert floors.states == ("fourth", "third", "second", "first")  # the order of the thesis
    np.testing.assert_array_equal(floors.start, [0.25] * 4)
    np.testing.assert_array_equal(
        belief_update(floors, floors.start, down, 0), [0, 0.25, 0.25, 0.5]
    )
    # The printed numbers are another thing: uniform over the floors that are still possible.
    possible = predict(floors, floors.start, down) > 0
    np.testing.assert_allclose(possible / possible.sum(), [0, 0.33, 0.33, 0.33], atol=0.005)
    # Three steps down and the robot knows where it is.
    b = floors.start
    for _ in range(3):
        b = belief_update(floors, b, down, 0)
    np.testing.assert_array_equal(b, [0, 0, 0, 1])


def test_errata_12_and_14_the_corridor():
    corridor = problem("corridor")
    right, nothing = corridor.actions.index("right"), corridor.observations.index("nothing")
    np.testing.assert_allclose(corridor.start, [1 / 3, 1 / 3, 0, 1 / 3])
    once = belief_update(corridor, corridor.start, right, nothing)
    np.testing.assert_allclose(once, [0.1, 0.45, 0, 0.45], atol=1e-12)
    # The first step needs that the goal was not observed, too: without it, goal has a third.
    assert predict(corridor, corridor.start, right)[2] == pytest.approx(1 / 3)
    twice = belief_update(corridor, once, right, nothing)
    np.testing.assert_allclose(twice, [0.1, 0.164, 0, 0.736], atol=5e-4)
    # With the belief under the sum twice, as equation 2.15 prints it, the step goes elsewhere.
    joint = (once**2 @ corridor.T[right]) * corridor.O[right, :, nothing]
    np.testing.assert_allclose(joint / joint.sum(), [0.1, 0.042, 0, 0.858], atol=5e-4)
    assert (twice[[0, 1, 3]] > 0).all()


def test_figure_2_16_the_rewards_at_a_quarter():
    np.testing.assert_allclose(expected_rewards(problem("two_state"), [0.25, 0.75]), [0.25, 1.125])


# Where beliefs lie


def test_a_belief_lies_as_far_from_a_side_as_its_opposite_corner_is_likely():
    corners = to_triangle(np.eye(3))
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    np.testing.assert_allclose(sides, 1)
    beliefs = np.random.default_rng(0).dirichlet(np.ones(3), size=50)
    xy = to_triangle(beliefs)
    for state in range(3):
        one, other = np.delete(corners, state, axis=0)
        across, away = other - one, xy - one
        area = np.abs(across[0] * away[:, 1] - across[1] * away[:, 0])
        np.testing.assert_allclose(area, beliefs[:, state] * math.sqrt(3) / 2, atol=1e-12)
    np.testing.assert_allclose(to_triangle(beliefs[5]), xy[5])
    np.testing.assert_allclose(to_triangle(np.full(3, 1 / 3)), corners.mean(axis=0))


def test_what_is_no_belief_over_three_states_has_no_place_in_the_triangle():
    for b in ([0.5, 0.5], [0.5, 0.5, 0.5], [[1, 0, 0], [0.3, 0.3, 0.3]]):
        with pytest.raises(ValueError, match="b must"):
            to_triangle(b)
