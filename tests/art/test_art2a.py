"""ART2A: angles by another way, unit norms, noise, and scikit-learn's rules."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.utils.estimator_checks import parametrize_with_checks

from arkaq_edu.art import ART2A


def unit(x):
    return x / np.linalg.norm(x)


def by_numpy(X, vigilance, rate, theta):
    """ART 2-A with numpy's dot products, one pattern after another."""
    templates, labels = [], []
    for x in X:
        x = unit(x)
        x = np.where(np.abs(x) < theta, 0, x)
        if not x.any():
            labels.append(-1)
            continue
        x = unit(x)
        cosines = [z @ x for z in templates]
        if cosines and max(cosines) > vigilance:
            j = int(np.argmax(cosines))
            z = templates[j]
            seen = np.where(np.abs(z) < theta, 0, x)
            if seen.any():
                templates[j] = unit(rate * unit(seen) + (1 - rate) * z)
        else:
            j = len(templates)
            templates.append(x)
        labels.append(j)
    return np.array(templates), labels


@settings(max_examples=100, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 150),
    dimension=st.integers(1, 6),
    vigilance=st.sampled_from([0.0, 0.5, 0.8, 0.95, 0.99]),
    rate=st.sampled_from([0.1, 0.5, 1.0]),
    theta=st.sampled_from([0.0, 0.1, 0.3]),
)
def test_templates_are_those_of_numpy(seed, n, dimension, vigilance, rate, theta):
    X = np.random.default_rng(seed).uniform(-1, 1, (n, dimension))
    templates, labels = by_numpy(X, vigilance, rate, theta)
    art = ART2A(vigilance, rate, theta).fit(X)
    assert art.labels_.tolist() == labels
    np.testing.assert_allclose(art.cluster_centers_, templates, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(art.cluster_centers_, axis=1), 1, atol=1e-12)
    assert art.counts_.sum() == sum(j >= 0 for j in labels)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), vigilance=st.sampled_from([0.5, 0.9, 0.99]))
def test_scale_does_not_matter(seed, vigilance):
    rng = np.random.default_rng(seed)
    X = rng.uniform(-1, 1, (80, 3))
    scale = 2.0 ** rng.integers(-300, 300, (80, 1))
    one, other = ART2A(vigilance).fit(X), ART2A(vigilance).fit(X * scale)
    assert one.labels_.tolist() == other.labels_.tolist()
    assert one.cluster_centers_.tobytes() == other.cluster_centers_.tobytes()


@pytest.mark.thesis("eqs 4.1 to 4.3, errata row 31")
def test_predict_is_the_largest_cosine_which_raw_dot_products_are_not():
    X = np.random.default_rng(0).uniform(-1, 1, (1000, 2))
    art = ART2A(0.95).fit(X)
    cosines = X @ art.cluster_centers_.T / np.linalg.norm(X, axis=1, keepdims=True)
    assert art.predict(X).tolist() == cosines.argmax(axis=1).tolist()
    # The thesis's reading: templates that are patterns in [-1, 1], compared by raw dot product.
    founders = X[[int(np.flatnonzero(art.labels_ == j)[0]) for j in range(art.n_clusters_)]]
    raw = (X @ founders.T).argmax(axis=1)
    true = (X @ founders.T / np.linalg.norm(founders, axis=1)).argmax(axis=1)
    assert np.mean(raw == true) < 0.5


def test_templates_that_stay_put_park_on_the_circle_as_cars_do():
    """Of arcs of one length that settle at random, Renyi's 0.7476 of those that would fit do."""
    rng = np.random.default_rng(0)
    X = rng.normal(size=(40, 4000, 2))
    counts = [ART2A(0.95, learning_rate=1e-9).fit(stream).n_clusters_ for stream in X]
    assert np.mean(counts) == pytest.approx(0.7476 * 2 * np.pi / np.arccos(0.95), abs=0.4)


def test_one_feature_leaves_two_patterns():
    X = np.linspace(-1, 1, 101)[:, None]
    art = ART2A(0.99).fit(X)
    assert sorted(art.cluster_centers_.ravel()) == [-1.0, 1.0]
    assert art.labels_[50] == -1 and art.predict([[0.0]]).tolist() == [-1]


def test_higher_vigilance_makes_more_categories():
    X = np.random.default_rng(0).normal(size=(2000, 3))
    counts = [ART2A(v).fit(X).n_clusters_ for v in (0.5, 0.8, 0.9, 0.95, 0.99)]
    assert counts == sorted(set(counts))


def test_noise_below_theta_is_cut_and_not_taken_up_again():
    art = ART2A(0.5, theta=0.2).fit([[1.0, 0.05, 0.0]])
    assert art.cluster_centers_.tolist() == [[1.0, 0.0, 0.0]]
    art.learn_one([1.0, 1.0, 0.0])
    assert art.cluster_centers_.tolist() == [[1.0, 0.0, 0.0]]


def test_a_template_between_opposite_patterns_stays_put():
    art = ART2A(-0.5, learning_rate=0.5, theta=0.1).fit([[0.0, 1.0], [0.9, -0.5]])
    assert art.labels_.tolist() == [0, 0]
    assert art.cluster_centers_.tolist() == [[0.0, 1.0]]


def test_a_pattern_at_exactly_the_vigilance_founds_a_template():
    assert ART2A(0.0).fit_predict([[1.0, 0.0], [0.0, 1.0]]).tolist() == [0, 1]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"vigilance": 1}, r"vigilance must be a number in \[-1, 1\), got 1"),
        ({"vigilance": 18.2}, r"vigilance .* got 18.2"),
        ({"learning_rate": 0}, r"learning_rate must be a number in \(0, 1\], got 0"),
        ({"theta": 1}, r"theta must be a number in \[0, 1\), got 1"),
    ],
)
def test_bad_parameters_are_refused(parameters, message):
    with pytest.raises(ValueError, match=message):
        ART2A(**parameters).fit([[0.0, 1.0]])


@parametrize_with_checks([ART2A(vigilance=0.5)])
def test_scikit_learn_estimator_checks(estimator, check):
    check(estimator)
