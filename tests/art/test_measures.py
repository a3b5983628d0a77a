"""What a partition covers, and how precisely it says where a pattern lies."""

import copy

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arkaq_edu.art import ART2A, EuclideanART, coverage, quantization_error
from tests.stand_in import triangle_stream


@pytest.mark.parametrize("rate", [0.1, 0.6, 1.0])
@pytest.mark.parametrize(
    ("method", "vigilance"),
    [(EuclideanART, 0.1), (EuclideanART, 0.4), (ART2A, 0.6), (ART2A, 0.98)],
)
def test_a_recognized_pattern_is_one_that_founds_nothing(method, vigilance, rate):
    network = method(vigilance, rate).fit(triangle_stream(300))
    asked = np.vstack([np.random.default_rng(3).uniform(-1, 1, (150, 2)), [[0.0, 0.0]]])
    founds = []
    for pattern in asked:
        twin = copy.deepcopy(network).partial_fit([pattern])
        founds.append(twin.n_clusters_ > network.n_clusters_ or twin.labels_[0] == -1)
    assert coverage(network, asked) == pytest.approx(1 - np.mean(founds))


@given(st.integers(1, 80), st.integers(1, 9), st.integers(0, 10**6))
def test_the_quantization_error_is_the_spread_about_the_means(n, k, seed):
    rng = np.random.default_rng(seed)
    places, labels = rng.normal(0, 100, (n, 2)), rng.integers(-1, k, n)
    squares = sum(
        ((places[labels == label] - places[labels == label].mean(axis=0)) ** 2).sum()
        for label in set(labels.tolist())
    )
    assert quantization_error(places, labels) == pytest.approx((squares / n) ** 0.5)


@pytest.mark.parametrize(("places", "labels"), [([[0.0]], [0, 1]), ([0.0, 1.0], [0, 1])])
def test_the_quantization_error_needs_one_label_for_each_place(places, labels):
    with pytest.raises(ValueError, match=r"(labels|places) must"):
        quantization_error(places, labels)
