"""A uniform grid, and segmenters of one's own, in place of the network."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arkaq_edu.arkaq import Arkaq, UniformGrid
from arkaq_edu.art import ART2A, EuclideanART
from tests.arkaq.brief import BRIEF, digest, near_task


@given(
    st.lists(st.integers(1, 9), min_size=1, max_size=3).flatmap(
        lambda cells: st.tuples(
            st.just(cells), st.lists(st.floats(-1.2, 1.2), min_size=len(cells), max_size=len(cells))
        )
    )
)
def test_a_pattern_belongs_to_the_cell_with_the_nearest_middle(case):
    cells, x = case
    grid = UniformGrid(cells)
    assert grid.n_clusters_ == np.prod(cells)
    off = np.abs(grid.cluster_centers_ - x)
    mine = off[grid.category(x)]
    assert (mine <= off.min(axis=0) + 1e-12).all()
    if np.abs(x).max() <= 1:
        assert (mine <= 1 / np.array(cells) + 1e-12).all()


def test_the_cells_of_many_patterns_are_those_of_each_and_learning_counts_them():
    X = np.random.default_rng(0).uniform(-1.1, 1.1, (200, 2))
    grid = UniformGrid((5, 3))
    cells = grid.predict(X)
    assert grid.counts_.sum() == 0
    assert [grid.learn_one(x) for x in X] == cells.tolist()
    assert np.array_equal(grid.counts_, np.bincount(cells, minlength=15))


@pytest.mark.parametrize("cells", [(0, 3), (2.5, 2), (-1,)])
def test_bad_cells_are_refused(cells):
    with pytest.raises(ValueError, match="cells"):
        UniformGrid(cells)


@pytest.mark.parametrize("x", [[0.1], [0.1, 0.2, 0.3], 0.1])
def test_patterns_of_another_length_are_refused(x):
    with pytest.raises(ValueError, match="2 features"):
        UniformGrid((4, 4)).category(x)


def test_an_agent_can_segment_by_a_grid():
    learned = Arkaq(segmenter=UniformGrid((6, 5)), learning=BRIEF, rng=4)
    learned.learn(near_task(), progress=False)
    assert learned.q.Q.shape == (30, 3)
    assert learned.art.counts_.sum() == BRIEF.patterns
    tried = learned.q.visits.any(axis=1)
    assert 3 <= tried.sum() < 30
    assert learned.act(np.array([900.0, 0.1, 1.0])) in (0, 1, 2)


def test_the_default_is_the_network_of_the_thesis(brief):
    given = Arkaq(0.2, segmenter=EuclideanART(0.2, 0.6), learning=BRIEF, rng=4)
    assert digest(given.learn(near_task(), progress=False)) == digest(brief)


def test_a_segmenter_that_is_given_is_copied():
    """One object serves many agents: none learns from another."""
    network, grid = EuclideanART(0.2, 0.6), UniformGrid((6, 5))
    for part in (network, grid):
        first, second = (
            Arkaq(segmenter=part, learning=BRIEF, rng=4).segment(near_task(), progress=False)
            for _ in range(2)
        )
        assert np.array_equal(first.art.counts_, second.art.counts_)
        assert first.art.counts_.sum() == BRIEF.patterns
    assert not hasattr(network, "n_clusters_") and grid.counts_.sum() == 0


def test_every_network_of_the_house_is_a_segmenter():
    learned = Arkaq(segmenter=ART2A(0.98, 0.1), learning=BRIEF, rng=4)
    learned.learn(near_task(), progress=False)
    assert learned.q.Q.shape == (learned.art.n_clusters_, 3)


@pytest.mark.parametrize("part", ["grid", 3, object()])
@pytest.mark.parametrize("role", ["segmenter", "learner"])
def test_what_is_no_part_is_refused(role, part):
    with pytest.raises(ValueError, match=f"{role} must have the methods"):
        Arkaq(**{role: part})


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        ((10**6, 10**6), r"cells \(their product\) must be an integer in \[1, 4194304\]"),
        ((10**30,), "cells must hold integers"),
        ((2.0, 2.0), "cells must hold integers"),
        (("2", "2"), "cells must hold integers"),
        (5, "cells must be a sequence of integers, got 5"),
        ((), "cells must be a sequence of integers"),
        ("22", "cells must hold integers"),
        (None, "cells must hold integers"),
    ],
)
def test_cells_that_nobody_means_are_refused(cells, words):
    with pytest.raises(ValueError, match=words):
        UniformGrid(cells)


@pytest.mark.parametrize("x", [[np.nan, 0.0], ["0", "0"], [0.0], None, 1e308, [1e308, 0.0]])
def test_what_is_no_pattern_is_refused_by_name(x):
    with pytest.raises(ValueError, match=r"^X must"):
        UniformGrid((4, 2)).category(x)


def test_a_pattern_far_beyond_the_border_belongs_to_a_border_cell():
    grid = UniformGrid((4, 2))
    assert grid.predict([[1e90, -1e90], [-1e90, 1e90]]).tolist() == [6, 1]
