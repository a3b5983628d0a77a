"""What comes in: masks, text, complex and huge numbers, sizes; and parameters checked once."""

from __future__ import annotations

import pickle

import numpy as np
import pandas as pd
import pytest

from arkaq_edu.art import (
    ART1,
    ART2,
    ART2A,
    EuclideanART,
    coverage,
    learned_norm,
    match_norm,
    quantization_error,
    reset_cosine,
    reset_fact,
)
from arkaq_edu.art.geometry import six_colors, voronoi_cells

NETWORKS = [EuclideanART(0.5), ART1(0.5), ART2(0.9), ART2A(0.5)]
ROWS = [[1.0, 0.0], [0.0, 1.0]]

BAD_PATTERNS = [
    (np.ma.array(ROWS, mask=[[0, 1], [0, 0]]), "X must hold finite numbers, got nan"),
    ([["1", "0"]], "X must be an array of numbers"),
    (np.array([["1", "0"]], dtype=object), "X must be an array of numbers"),
    (pd.DataFrame({"a": ["1"], "b": ["0"]}), "X must be an array of numbers"),
    (pd.DataFrame({"a": pd.array([1.0, pd.NA], dtype="Float64"), "b": 0.0}), "contains NaN"),
    (np.array([[1 + 0j, 0j]]), "X must hold patterns as rows of finite numbers: Complex data"),
    ([[10**400, 1]], "X must "),
    ([[1e200, 1.0]], r"X must hold numbers of at most 1e\+100 in magnitude, got 1e\+200"),
    ([[np.inf, 1.0]], "X must hold patterns as rows of finite numbers: Input X contains inf"),
    ([[1.0], [1.0, 2.0]], "X must hold patterns as rows of finite numbers"),
    ([[np.datetime64("2020-01-01"), np.datetime64("2021-01-01")]], "X must be an array of numbers"),
    (np.empty((0, 2)), r"X must hold .* 0 sample\(s\)"),
    (np.empty((3, 0)), r"X must hold .* 0 feature\(s\)"),
    (
        np.broadcast_to(np.uint8(1), (1, 10**9)),
        "X must need at most 2,147,483,648 bytes, got 8,000",
    ),
    ("ball", "X must hold patterns"),
    (None, "X must hold patterns"),
]


@pytest.mark.parametrize("network", NETWORKS, ids=lambda network: type(network).__name__)
@pytest.mark.parametrize(("X", "message"), BAD_PATTERNS)
def test_patterns_that_are_not_numbers_are_refused_by_name(network, X, message):
    network = pickle.loads(pickle.dumps(network)).fit(ROWS)
    for method in (network.fit, network.partial_fit, network.predict):
        with pytest.raises(ValueError, match=message):
            method(X)
    assert network.n_features_in_ == 2 and network.counts_.tolist() == [1, 1]


@pytest.mark.parametrize("network", NETWORKS, ids=lambda network: type(network).__name__)
@pytest.mark.parametrize(
    "x",
    [
        np.ma.array([1.0, 0.0], mask=[1, 0]),
        ["1", "0"],
        [1j, 0],
        [10**400, 1],
        [1e200, 0.0],
        [1.0, None],
        [[1.0], [0.0, 1.0]],
    ],
)
def test_a_single_pattern_that_is_not_numbers_is_refused_by_name(network, x):
    fresh = pickle.loads(pickle.dumps(network))
    with pytest.raises(ValueError, match=r"^x must "):
        fresh.learn_one(x)
    fresh.fit(ROWS)
    for method in (fresh.learn_one, fresh.category):
        with pytest.raises(ValueError, match=r"^x must "):
            method(x)
    assert fresh.counts_.tolist() == [1, 1]


@pytest.mark.parametrize("network", NETWORKS, ids=lambda network: type(network).__name__)
def test_what_scikit_learn_calls_an_error_of_type_is_one(network):
    from scipy.sparse import csr_array

    for X in (csr_array(ROWS), [[1j, 0j]], [[{"a": 1}, 0]]):
        with pytest.raises(TypeError, match="X must hold patterns"):
            pickle.loads(pickle.dumps(network)).fit(X)


@pytest.mark.parametrize(
    ("network", "change", "message"),
    [
        (EuclideanART(0.5), {"vigilance": 0}, "vigilance must be"),
        (EuclideanART(0.5), {"vigilance": 1e150}, "vigilance must be"),
        (EuclideanART(0.5), {"max_clusters": 10**30}, "max_clusters must be"),
        (ART2(0.9), {"signal": np.ones(3)}, "signal must be"),
        (EuclideanART(0.5), {"learning_rate": np.ones(3)}, "learning_rate must be"),
        (ART1(0.5), {"L": 1}, "L must be"),
        (ART1(0.5), {"binarize": "1"}, "binarize must be"),
        (ART2(0.9), {"d": 1}, "d must be"),
        (ART2(0.9), {"signal": "x" * 1000}, "signal must be .* got 'x.{1,60}$"),
        (ART2A(0.5), {"theta": "0"}, "theta must be"),
    ],
)
def test_a_parameter_changed_at_any_time_is_checked_before_it_is_used(network, change, message):
    """Parameters are checked once, not for each pattern."""
    network = pickle.loads(pickle.dumps(network)).fit(ROWS)
    good = network.get_params()
    network.learn_one([1.0, 0.0])
    network.set_params(**change)
    for method in (network.learn_one, network.category):
        with pytest.raises(ValueError, match=message):
            method([1.0, 0.0])
    network.set_params(**good)
    assert network.category([1.0, 0.0]) == 0
    for name, value in change.items():  # assigned, without set_params
        setattr(network, name, value)
    for method in (network.predict, network.partial_fit):
        with pytest.raises(ValueError, match=message):
            method(ROWS)


def test_a_new_parameter_holds_from_the_next_pattern():
    network = EuclideanART(0.5).fit([[0.0], [1.0]])
    assert network.learn_one([0.4]) == 0
    network.vigilance = 0.05
    assert network.learn_one([0.4]) == 2
    deep = ART2(0.9).fit(ROWS)
    before = deep.cluster_centers_
    deep.d = 0.8
    np.testing.assert_allclose(deep.cluster_centers_, 2 * before)
    wide = ART2(0.9).fit(ROWS)
    wide.fit([[1.0, 2.0, 3.0]])  # the default theta follows the number of features
    fresh = ART2(0.9).fit([[1.0, 2.0, 3.0]])
    assert wide.top_down_.tobytes() == fresh.top_down_.tobytes()


def test_counts_beyond_what_is_exact_are_refused():
    for counts in ([1e30], [2**53 + 2], ["1"], np.ma.array([1], mask=[1])):
        with pytest.raises(ValueError, match="counts must"):
            EuclideanART.from_centers([[0.0]], counts, 0.1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: learned_norm(0.1, 1), r"d must be a number in \(0, 1\), got 1"),
        (lambda: learned_norm(0, 0.9), r"c must be a number in \(0, 1\), got 0"),
        (lambda: match_norm(1.5, 0.9, 0.1), r"cosine must be in \[-1, 1\], got 1.5"),
        (lambda: match_norm([0.5, np.nan], 0.9, 0.1), "cosine must hold finite numbers, got nan"),
        (lambda: match_norm(0.5, -0.9, 0.1), "cdz must be norms >= 0, got -0.9"),
        (lambda: match_norm(0.5, np.inf, 0.1), "cdz must hold finite numbers, got inf"),
        (lambda: match_norm(0.5, 0.9, -0.1), r"c must be a number in \(0, 1\), got -0.1"),
        (lambda: match_norm([0.5] * 3, [0.9] * 2, 0.1), r"cdz must have a shape that fits"),
        (lambda: match_norm("0.5", 0.9, 0.1), "cosine must be an array of numbers"),
        (lambda: reset_cosine(0.9, [0.5, -1], 0.1), "cdz must be norms >= 0, got -1"),
        (lambda: reset_fact(0.1, 1, 0.9), "d must be"),
        (lambda: reset_fact(0.1, 0.9, 2), "vigilance must be"),
        (lambda: coverage("net", ROWS), "network must be an ART2A or EuclideanART, got 'net'"),
        (lambda: coverage(EuclideanART().fit(ROWS), np.empty((0, 2))), "X must hold .* 0 sample"),
        (
            lambda: coverage(EuclideanART().fit(ROWS), np.ma.array(ROWS, mask=True)),
            "patterns must hold finite numbers, got nan",
        ),
        (lambda: quantization_error(np.empty((0, 1)), []), "places must hold at least one number"),
        (lambda: voronoi_cells(np.empty((0, 2))), "centers must be distinct points"),
        (lambda: voronoi_cells([[0, 0], [0, 0]]), "centers must be distinct points"),
        (lambda: voronoi_cells([[0, 99]]), "centers must be distinct points"),
        (lambda: six_colors(-1, []), "n must be an integer >= 0, got -1"),
        (lambda: six_colors(2, [0, 1]), r"pairs must have shape \(any, 2\), got \(2,\)"),
        (lambda: six_colors(2, [[0, 2]]), r"pairs must hold integers in \[0, 1\], got 2"),
        (
            lambda: six_colors(7, [[i, j] for j in range(7) for i in range(j)]),
            "pairs must be those of a map in the plane",
        ),
    ],
)
def test_the_helpers_refuse_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_a_cosine_of_one_but_for_rounding_is_one():
    assert match_norm(1 + 1e-12, 0.9, 0.1) == 1
    assert match_norm([], 0.9, 0.1).shape == (0,)
    assert six_colors(0, np.empty((0, 2), int)) == []
