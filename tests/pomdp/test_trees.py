"""Policy trees: what they earn, counted another way."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.pomdp import POMDP, PolicyTree, all_trees, belief_update, successors, tree_value

LOOK = [[0.9, 0.1], [0.1, 0.9]]


def random_pomdp(seed, max_states=4, max_actions=3, max_observations=3, gamma=None):
    """Return a small POMDP, its distributions from spiky to flat, some rewards alike."""
    rng = np.random.default_rng(seed)
    S = int(rng.integers(1, max_states + 1))
    A = int(rng.integers(1, max_actions + 1))
    Z = int(rng.integers(1, max_observations + 1))
    T = rng.dirichlet(np.full(S, rng.choice([0.05, 0.5, 2.0])), size=(A, S))
    O = rng.dirichlet(np.full(Z, rng.choice([0.05, 0.5, 2.0])), size=(A, S))  # noqa: E741
    if rng.random() < 0.3:  # moves and sights without chance: many zeros, many ties
        T, O = np.eye(S)[T.argmax(axis=2)], np.eye(Z)[O.argmax(axis=2)]  # noqa: E741
    R = rng.integers(-2, 3, size=(S, A)) if rng.random() < 0.5 else rng.normal(size=(S, A))
    return POMDP(T, O, R, rng.uniform(0.3, 0.95) if gamma is None else gamma)


def random_tree(pomdp, depth, rng):
    Z = pomdp.n_observations if depth > 1 else 0
    branches = [random_tree(pomdp, depth - 1, rng) for _ in range(Z)]
    return PolicyTree(int(rng.integers(pomdp.n_actions)), tuple(branches))


def earned(pomdp, tree, b):
    """Follow the belief, not the state: reward now, then each observation by its chance."""
    total = b @ pomdp.R[:, tree.action]
    if tree.branches:
        chances = successors(pomdp, b, tree.action).chances
        for z in np.flatnonzero(chances):
            after = belief_update(pomdp, b, tree.action, z)
            total += pomdp.gamma * chances[z] * earned(pomdp, tree.branches[z], after)
    return total


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4))
def test_a_tree_earns_b_alpha_from_every_belief(seed, depth):
    pomdp, rng = random_pomdp(seed), np.random.default_rng(seed)
    tree = random_tree(pomdp, depth, rng)
    alpha = tree_value(pomdp, tree)
    for b in rng.dirichlet(np.ones(pomdp.n_states), size=5):
        assert b @ alpha == pytest.approx(earned(pomdp, tree, b), abs=1e-10)


def test_one_step_earns_the_reward_and_two_the_hand_count():
    pomdp = POMDP([np.eye(2)] * 3, [LOOK] * 3, [[-1, 5, -7], [-1, -7, 5]], gamma=0.5)
    assert tree_value(pomdp, PolicyTree(1)).tolist() == [5, -7]
    look_then_act = PolicyTree(0, (PolicyTree(1), PolicyTree(2)))
    right, wrong = 0.9 * 5, 0.1 * -7
    np.testing.assert_allclose(tree_value(pomdp, look_then_act), -1 + 0.5 * (right + wrong))


@pytest.mark.parametrize(("A", "Z", "depth"), [(1, 1, 4), (2, 2, 3), (3, 1, 3), (2, 3, 2)])
def test_all_trees_are_all_and_each_once(A, Z, depth):
    pomdp = POMDP([np.eye(2)] * A, np.full((A, 2, Z), 1 / Z), np.zeros((2, A)), 0.9)
    trees = list(all_trees(pomdp, depth))
    nodes = sum(Z**level for level in range(depth))
    assert len(trees) == len(set(trees)) == A**nodes
    assert {tree.depth for tree in trees} == {depth}


def test_a_tree_is_printed_with_the_names():
    pomdp = POMDP(
        [np.eye(2)] * 2, [LOOK] * 2, np.zeros((2, 2)), 0.9,
        actions=["look", "kick"], observations=["left", "right"],
    )  # fmt: skip
    tree = PolicyTree(0, (PolicyTree(1, (PolicyTree(0), PolicyTree(1))),) * 2)
    assert tree.text(pomdp).splitlines() == [
        "look", "  left: kick", "    left: look", "    right: kick",
        "  right: kick", "    left: look", "    right: kick",
    ]  # fmt: skip
    assert str(tree).splitlines()[:2] == ["0", "  0: 1"]


def test_what_is_no_tree_is_refused():
    leaf = PolicyTree(0)
    with pytest.raises(ValueError, match=r"branches must all have the same depth, got \[1, 2\]"):
        PolicyTree(0, (leaf, PolicyTree(0, (leaf,))))
    with pytest.raises(ValueError, match="action must be an integer >= 0, got -1"):
        PolicyTree(-1)
    with pytest.raises(ValueError, match="branches must be policy trees"):
        PolicyTree(0, (1, 2))
    pomdp = POMDP([np.eye(2)], [LOOK], [[0], [0]], 0.9)
    with pytest.raises(ValueError, match=r"action must be an integer in \[0, 0\], got 1"):
        tree_value(pomdp, PolicyTree(1))
    with pytest.raises(ValueError, match="one for each of the 2 observations, got 1"):
        tree_value(pomdp, PolicyTree(0, (leaf,)))
    with pytest.raises(ValueError, match="depth must be an integer >= 1"):
        all_trees(pomdp, 0)
