"""ART1: the search by another way, stability, the 2/3 rule, and scikit-learn's rules."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.exceptions import NotFittedError
from sklearn.utils.estimator_checks import parametrize_with_checks

from arkaq_edu.art import ART1

letters = st.integers(2, 10).flatmap(
    lambda m: st.lists(st.lists(st.sampled_from([0, 1]), min_size=m, max_size=m), min_size=1)
)
vigilances = st.sampled_from([0.0, 0.25, 0.5, 2 / 3, 0.9, 1.0]) | st.floats(0, 1)


def by_sets(X, vigilance, L):
    """Fast-learning ART1 on sets of active inputs, nodes sorted by signal instead of searched."""
    templates, labels = [], []
    for x in X:
        active = frozenset(np.flatnonzero(x).tolist())
        if not active:
            labels.append(-1)
            continue
        signal = [L * len(active & z) / (L - 1 + len(z)) for z in templates]
        order = sorted(range(len(templates)), key=lambda j: (-signal[j], j))
        for j in order:
            if signal[j] > 0 and len(active & templates[j]) / len(active) >= vigilance:
                templates[j] &= active
                labels.append(j)
                break
        else:
            labels.append(len(templates))
            templates.append(active)
    return templates, labels


@settings(max_examples=200, deadline=None)
@given(X=letters, vigilance=vigilances, L=st.sampled_from([1.001, 2.0, 10.0]))
def test_categories_are_those_found_with_sets(X, vigilance, L):
    templates, labels = by_sets(X, vigilance, L)
    art = ART1(vigilance, L).fit(X)
    assert art.labels_.tolist() == labels
    assert [frozenset(np.flatnonzero(z).tolist()) for z in art.cluster_centers_] == templates
    assert art.counts_.tolist() == [labels.count(j) for j in range(len(templates))]


@settings(max_examples=100, deadline=None)
@given(X=letters, vigilance=vigilances)
def test_a_pattern_just_learned_keeps_its_category(X, vigilance):
    art = ART1(vigilance)
    for x in X:
        label = art.learn_one(x)
        before = art.cluster_centers_
        assert art.category(x) == label
        assert art.learn_one(x) == label
        assert np.array_equal(art.cluster_centers_, before)


@settings(max_examples=60, deadline=None)
@given(X=letters, vigilance=vigilances)
def test_learning_becomes_stable_and_search_is_then_disengaged(X, vigilance):
    m = len(X[0])
    art = ART1(vigilance, L=1 + 1e-3).fit(X)  # below (m - 1) / (m - 2): contained templates first
    # A template only ever loses components, so there are at most so many changes.
    for _ in range(m * len(X) + 1):
        before = art.cluster_centers_
        art.partial_fit(X)
        if np.array_equal(art.cluster_centers_, before):
            break
    else:
        pytest.fail("templates still change")
    assert art.labels_.tolist() == art.predict(X).tolist()
    for x in X:
        table = art.trace(x)
        assert not table.reset.any()
        assert table.winner.any() == any(x)


@settings(max_examples=60, deadline=None)
@given(X=letters, vigilance=vigilances)
def test_the_trace_obeys_the_two_thirds_rule_and_ends_as_the_network_does(X, vigilance):
    art = ART1(vigilance).fit(X[:-1] or X)
    table = art.trace(X[-1])
    two_of_three = table.input + table.gain1 + table.expectation >= 2
    assert (table.activity == two_of_three).all()
    assert (table[table.step == 0].activity == X[-1]).all()
    steps = table.groupby("step").first()
    assert (steps.gain1 == 0)[1:].all()
    if not any(X[-1]):
        assert len(steps) == 1 and not steps.gain1[0] and not steps.gain2[0]
        return
    assert steps.node[1:].is_unique and not steps.reset[steps.index[-1]]
    assert steps.reset[1:-1].all() and (steps.match[steps.reset] < vigilance).all()
    winner = steps.node[steps.winner].item()
    committed = winner < art.n_clusters_
    assert art.category(X[-1]) == (winner if committed else -1)
    assert art.learn_one(X[-1]) == winner


def test_uncommitted_nodes_are_never_reset():
    art = ART1(vigilance=1.0).fit([[1, 1, 0, 0]])
    table = art.trace([0, 0, 1, 1])
    assert table.node.max() == art.n_clusters_ and not table.reset.any()


def test_a_match_of_exactly_the_vigilance_is_enough():
    patterns = [[1, 1, 0, 0], [1, 1, 1, 0]]
    assert ART1(vigilance=2 / 3).fit_predict(patterns).tolist() == [0, 0]
    assert ART1(vigilance=np.nextafter(2 / 3, 1)).fit_predict(patterns).tolist() == [0, 1]


@pytest.mark.thesis("errata row 19")
def test_higher_vigilance_makes_more_categories():
    X = np.random.default_rng(0).random((300, 12)) < 0.4
    counts = [ART1(v).fit(X).n_clusters_ for v in (0.2, 0.5, 0.7, 0.9)]
    assert counts == sorted(set(counts))


def test_bottom_up_traces_are_the_normalized_templates():
    art = ART1(0.5, L=3.0).fit([[1, 1, 0, 0, 0], [0, 0, 1, 1, 1]])
    expected = [[3 / 4, 3 / 4, 0, 0, 0], [0, 0, 3 / 5, 3 / 5, 3 / 5]]
    np.testing.assert_allclose(art.bottom_up_, expected)


def test_binarize_cuts_above_the_threshold():
    art = ART1(0.9, binarize=0.5).fit([[0.2, 0.5, 0.7]])
    assert art.cluster_centers_.tolist() == [[0, 0, 1]]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"vigilance": -0.1}, r"vigilance must be a number in \[0, 1\], got -0.1"),
        ({"vigilance": 1.1}, r"vigilance .* got 1.1"),
        ({"L": 1}, r"L must be a number in \(1, inf\), got 1"),
        ({"binarize": "high"}, r"binarize must be a finite number, got 'high'"),
    ],
)
def test_bad_parameters_are_refused(parameters, message):
    with pytest.raises(ValueError, match=message):
        ART1(**parameters).fit([[0, 1]])


def test_patterns_that_are_not_binary_are_refused():
    art = ART1().fit([[0, 1]])
    for learn in (art.fit, art.partial_fit, art.predict):
        with pytest.raises(ValueError, match=r"binary \(0 or 1\), got 0.5"):
            learn([[0, 0.5]])
    for one in (art.learn_one, art.category, art.trace):
        with pytest.raises(ValueError, match="binary"):
            one([2, 0])
    with pytest.raises(NotFittedError):
        ART1().trace([0, 1])


@parametrize_with_checks([ART1(vigilance=0.5, binarize=0.0)])
def test_scikit_learn_estimator_checks(estimator, check):
    check(estimator)
