"""EuclideanART against a plain search through all centers, and against scikit-learn's rules."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.utils.estimator_checks import parametrize_with_checks

from arkaq_edu.art import EuclideanART


def distances(x, centers):
    """Distance to each center, summed over the features in order (equation 4.5)."""
    total = np.zeros(len(centers))
    for i, value in enumerate(x):
        gap = value - centers[:, i]
        total += gap * gap
    return np.sqrt(total), total


def brute_force(X, vigilance, rate, limit=None, centers=None, counts=None):
    """Thesis 4.2.2 by comparing every pattern with every center."""
    centers = [] if centers is None else [c.copy() for c in centers]
    counts = [] if counts is None else list(counts)
    labels = []
    for x in X:
        j = None
        if centers:
            far, squared = distances(x, np.array(centers))
            j = int(np.argmin(squared))
        if j is not None and far[j] < vigilance:
            counts[j] += 1
            eta = 1.0 / counts[j] if rate == "count" else rate
            centers[j] = centers[j] + eta * (x - centers[j])
        elif limit is None or len(centers) < limit:
            j = len(centers)
            centers.append(x.copy())
            counts.append(1)
        labels.append(j)
    return np.array(centers), np.array(counts), np.array(labels)


def make_patterns(kind, n, dimension, rng):
    """Patterns that are easy for a grid, and patterns made to trip it."""
    if kind == "uniform":
        return rng.uniform(-1, 1, (n, dimension))
    if kind == "clustered":
        return rng.integers(-2, 3, (n, dimension)) + 0.02 * rng.standard_normal((n, dimension))
    if kind == "lattice":  # ties in distance, distances of exactly the vigilance, cell borders
        return rng.integers(-6, 7, (n, dimension)) / 4
    if kind == "duplicate":
        return rng.uniform(-1, 1, (5, dimension))[rng.integers(0, 5, n)]
    if kind == "far out":  # further than the grid reaches, and next to the origin
        return rng.standard_normal((n, dimension)) * 10.0 ** rng.integers(-12, 13, (n, 1))
    return np.linspace(-1, 1, n)[:, None] * np.ones(dimension)  # "line": a drifting stream


KINDS = ["uniform", "clustered", "lattice", "duplicate", "far out", "line"]

streams = {
    "kind": st.sampled_from(KINDS),
    "n": st.integers(1, 250),
    "dimension": st.integers(1, 4),
    "seed": st.integers(0, 2**32 - 1),
    "vigilance": st.sampled_from([0.01, 0.05, 0.1, 0.25, 0.5, 1.0, 3.0]) | st.floats(1e-3, 2),
    "rate": st.sampled_from([0.5, 1.0, "count"]) | st.floats(0.01, 1),
    "scale": st.sampled_from([1.0, 1e-30, 1e-3, 1e6, 1e30]),
    "limit": st.none() | st.integers(1, 40),
}


@pytest.mark.thesis("eqs 4.4 to 4.6, errata row 32")
@settings(max_examples=150, deadline=None)
@given(**streams)
def test_centers_are_those_of_brute_force_to_the_last_bit(
    kind, n, dimension, seed, vigilance, rate, scale, limit
):
    X = scale * make_patterns(kind, n, dimension, np.random.default_rng(seed))
    vigilance *= scale
    centers, counts, labels = brute_force(X, vigilance, rate, limit)
    art = EuclideanART(vigilance, rate, limit).fit(X)
    assert art.cluster_centers_.tobytes() == centers.tobytes()
    assert art.counts_.tolist() == counts.tolist()
    assert art.labels_.tolist() == labels.tolist()


@settings(max_examples=100, deadline=None)
@given(**streams)
def test_predict_is_the_nearest_of_all_centers(
    kind, n, dimension, seed, vigilance, rate, scale, limit
):
    rng = np.random.default_rng(seed)
    art = EuclideanART(vigilance * scale, rate, limit)
    art.fit(scale * make_patterns(kind, n, dimension, rng))
    spread = 10.0 ** rng.integers(-2, 3, (60, 1))
    queries = scale * np.vstack(
        [make_patterns(kind, 60, dimension, rng), rng.uniform(-1, 1, (60, dimension)) * spread]
    )
    expected = [int(np.argmin(distances(x, art.cluster_centers_)[1])) for x in queries]
    assert art.predict(queries).tolist() == expected
    assert [art.category(x) for x in queries] == expected


@settings(max_examples=60, deadline=None)
@given(**streams, cut=st.floats(0, 1))
def test_a_stream_in_pieces_equals_the_stream_whole(
    kind, n, dimension, seed, vigilance, rate, scale, limit, cut
):
    X = scale * make_patterns(kind, n, dimension, np.random.default_rng(seed))
    whole = EuclideanART(vigilance * scale, rate, limit).fit(X)
    k = max(1, round(cut * n))
    parts = EuclideanART(vigilance * scale, rate, limit).partial_fit(X[:k])
    saved = EuclideanART.from_centers(
        parts.cluster_centers_, parts.counts_, vigilance * scale, rate, limit
    )
    pickled = pickle.loads(pickle.dumps(parts))
    parts_labels = [parts.learn_one(x) for x in X[k:]]
    pickled_labels = [pickled.learn_one(x) for x in X[k:]]
    if k < n:
        saved.partial_fit(X[k:])
        assert saved.labels_.tolist() == whole.labels_[k:].tolist()
    assert parts_labels == pickled_labels == whole.labels_[k:].tolist()
    for other in (parts, saved, pickled):
        assert other.cluster_centers_.tobytes() == whole.cluster_centers_.tobytes()
        assert other.counts_.tolist() == whole.counts_.tolist()


def test_learning_one_by_one_from_nothing_equals_fit():
    X = np.random.default_rng(3).uniform(-1, 1, (300, 2))
    art = EuclideanART(0.1)
    labels = [art.learn_one(x) for x in X]
    whole = EuclideanART(0.1).fit(X)
    assert labels == whole.labels_.tolist()
    assert art.cluster_centers_.tobytes() == whole.cluster_centers_.tobytes()
    assert art.n_features_in_ == 2 and art.n_clusters_ == len(art.counts_)


def test_with_count_a_center_is_the_mean_of_its_patterns():
    X = np.random.default_rng(1).normal(0, 0.01, (500, 3))
    art = EuclideanART(1.0, "count").fit(X)
    assert art.n_clusters_ == 1
    np.testing.assert_allclose(art.cluster_centers_[0], X.mean(axis=0), atol=1e-15)


@pytest.mark.thesis("errata row 19")
def test_smaller_vigilance_makes_more_centers():
    X = np.random.default_rng(0).uniform(-1, 1, (5000, 2))
    counts = [EuclideanART(v).fit(X).n_clusters_ for v in (0.15, 0.1, 0.075, 0.05, 0.025)]
    assert counts == sorted(set(counts))


def test_every_founding_pattern_was_at_least_a_vigilance_from_all_centers():
    X = np.random.default_rng(0).uniform(-1, 1, (2000, 2))
    art = EuclideanART(0.1)
    for x in X:
        before = art.n_clusters_ if hasattr(art, "labels_") else 0
        centers = art.cluster_centers_ if before else np.empty((0, 2))
        near = before and np.linalg.norm(centers - x, axis=1).min() < 0.1
        assert (art.learn_one(x) == before) == (not near)


def test_a_full_network_assigns_but_does_not_learn_from_strangers():
    art = EuclideanART(0.1, max_clusters=2).fit([[0.0], [1.0], [5.0], [-3.0]])
    assert art.labels_.tolist() == [0, 1, 1, 0]
    assert art.cluster_centers_.tolist() == [[0.0], [1.0]]
    assert art.counts_.tolist() == [1, 1]
    assert art.learn_one([1.05]) == 1 and art.cluster_centers_[1, 0] == 1.025


def test_new_parameters_hold_from_the_next_pattern():
    X = np.random.default_rng(5).uniform(-1, 1, (600, 2))
    art = EuclideanART(0.05).fit(X[:300])
    centers, counts = art.cluster_centers_, art.counts_
    art.set_params(vigilance=0.3, learning_rate=0.1)
    assert art.predict(X).tolist() == [int(np.argmin(distances(x, centers)[1])) for x in X]
    art.partial_fit(X[300:])
    expected = brute_force(X[300:], 0.3, 0.1, None, centers, counts)
    assert art.cluster_centers_.tobytes() == expected[0].tobytes()
    assert art.labels_.tolist() == expected[2].tolist()


def test_what_is_read_off_is_a_copy():
    art = EuclideanART(0.5).fit([[0.0, 0.0]])
    art.cluster_centers_[:] = 9
    art.counts_[:] = 9
    assert art.cluster_centers_.tolist() == [[0.0, 0.0]] and art.counts_.tolist() == [1]


def test_clone_is_unfitted_and_has_the_parameters():
    art = clone(EuclideanART(0.3, "count", 7).fit([[0.0]]))
    assert art.get_params() == {"vigilance": 0.3, "learning_rate": "count", "max_clusters": 7}
    with pytest.raises(NotFittedError):
        art.predict([[0.0]])
    with pytest.raises(NotFittedError):
        art.category([0.0])


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"vigilance": 0}, r"vigilance must be a number in .*, got 0"),
        ({"vigilance": -0.1}, r"vigilance .* got -0.1"),
        ({"vigilance": float("nan")}, r"vigilance .* got nan"),
        ({"vigilance": "high"}, r"vigilance .* got 'high'"),
        ({"learning_rate": 0}, r"learning_rate must be a number in \(0, 1\], got 0"),
        ({"learning_rate": 1.5}, r"learning_rate .* got 1.5"),
        ({"learning_rate": "fast"}, r"learning_rate .* 'count', got 'fast'"),
        ({"max_clusters": 0}, r"max_clusters must be an integer >= 1, got 0"),
        ({"max_clusters": 2.5}, r"max_clusters .* got 2.5"),
    ],
)
def test_bad_parameters_are_refused_and_harm_nothing(parameters, message):
    art = EuclideanART(0.5).fit([[0.0], [2.0]])
    art.set_params(**parameters)
    for learn in (art.fit, art.partial_fit):
        with pytest.raises(ValueError, match=message):
            learn([[1.0]])
    with pytest.raises(ValueError, match=message):
        art.learn_one([1.0])
    assert art.cluster_centers_.tolist() == [[0.0], [2.0]]
    with pytest.raises(ValueError, match=message):
        EuclideanART.from_centers([[0.0]], [1], **{"vigilance": 1, **parameters})


@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([1.0], r"x must have shape \(2,\), got \(1,\)"),
        ([1.0, 2.0, 3.0], r"x must have shape \(2,\), got \(3,\)"),
        (1.0, r"x must have shape \(2,\), got \(\)"),
        ([[1.0, 2.0]], r"x must have shape \(2,\), got \(1, 2\)"),
        ([1.0, float("nan")], r"x must hold finite numbers, got nan at \(1,\)"),
        ([float("inf"), 0.0], r"x must hold finite numbers, got inf at \(0,\)"),
        (["a", "b"], r"x must be an array of numbers"),
        (None, r"x must "),
    ],
)
def test_bad_single_patterns_are_refused(x, message):
    art = EuclideanART(0.5).fit([[0.0, 0.0]])
    for method in (art.category, art.learn_one):
        with pytest.raises(ValueError, match=message):
            method(x)
    assert art.counts_.tolist() == [1]


@pytest.mark.parametrize(
    ("X", "message"),
    [
        ([1.0, 2.0], "Expected 2D array, got 1D array instead"),
        ([[1.0, float("nan")]], "contains NaN"),
        ([[1.0]], "X has 1 features, but EuclideanART is expecting 2 features"),
    ],
)
def test_bad_batches_are_refused_as_scikit_learn_does(X, message):
    art = EuclideanART(0.5).fit([[0.0, 0.0]])
    for method in (art.predict, art.partial_fit):
        with pytest.raises(ValueError, match=message):
            method(X)


@pytest.mark.parametrize(
    ("centers", "counts", "message"),
    [
        ([1.0, 2.0], [1, 1], r"centers must have shape \(any, any\), got \(2,\)"),
        (np.empty((0, 2)), [], r"centers must have at least one row and one column, got \(0, 2\)"),
        ([[np.nan]], [1], r"centers must hold finite numbers"),
        ([[1.0]], [1, 2], r"counts must have shape \(1,\), got \(2,\)"),
        ([[1.0]], [0], r"counts must be integers in .1, 2..53., got \[0\]"),
        ([[1.0]], [1.5], r"counts must be integers in .* got \[1.5\]"),
    ],
)
def test_bad_centers_are_refused(centers, counts, message):
    with pytest.raises(ValueError, match=message):
        EuclideanART.from_centers(centers, counts, 0.1)


def test_from_centers_does_not_share_memory():
    centers = np.array([[0.0, 0.0]])
    EuclideanART.from_centers(centers, [1], 1.0).learn_one([0.5, 0.5])
    assert centers.tolist() == [[0.0, 0.0]]


@parametrize_with_checks([EuclideanART(vigilance=1.5)])
def test_scikit_learn_estimator_checks(estimator, check):
    check(estimator)
