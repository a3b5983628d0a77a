import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from arkaq_edu.mdp import (
    argmax_shared,
    softmax,
)


@given(
    st.lists(st.floats(-1e100, 1e100), min_size=1, max_size=6),
    st.floats(0, 1e100, exclude_min=True) | st.just(math.inf),
)
def test_softmax_is_a_distribution_in_the_order_of_the_values(values, temperature):
    p = softmax(values, temperature)
    assert p.sum() == pytest.approx(1) and (p >= 0).all()
    assert (np.diff(p[np.argsort(values)]) >= -1e-15).all()


def test_temperature_is_no_probability():
    """Chapter 3 calls T the chance of a non-greedy action; of two, that is 1 / (1 + e^(d/T))."""
    for T in (0.2, 0.5, 0.9, 3.0):
        p = softmax([0.0, 1.0], T)[0]
        assert p == pytest.approx(1 / (1 + math.exp(1 / T)))
        assert abs(p - T) > 0.1


def test_shared_argmax_shares():
    draws = argmax_shared(np.tile([1.0, 7.0, 7.0, 0.0, 7.0], (9000, 1)), rng=0)
    counts = np.bincount(draws, minlength=5)
    assert counts[[0, 3]].tolist() == [0, 0]
    assert stats.chisquare(counts[[1, 2, 4]]).pvalue > 1e-3


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: argmax_shared([1.0, math.nan], rng=0),
            "values must hold finite numbers or -inf, got nan",
        ),
        (lambda: argmax_shared([], rng=0), "values must hold at least one action in a row"),
        (lambda: softmax([0.0, math.nan], 1.0), "values must hold finite numbers or -inf, got nan"),
        (lambda: softmax([0.0], math.nan), "temperature must be a number in"),
        (
            lambda: softmax([], 1.0),
            r"values must hold at least one action in a row, got shape \(0,\)",
        ),
        (
            lambda: softmax(5.0, 1.0),
            r"values must hold at least one action in a row, got shape \(\)",
        ),
        (lambda: softmax([[1.0], [-math.inf]], 1.0), "values must allow an action in each row"),
        (lambda: softmax([[1.0], [1.0, 2.0]], 1.0), "values must be an array of numbers"),
        (lambda: argmax_shared([math.inf, 0.0], rng=0), "values must hold finite numbers or -inf"),
        (lambda: argmax_shared([0.0], rng="0"), "rng must be a numpy Generator"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("temperature", [5e-324, 0.3, 1e100, math.inf])
def test_an_action_that_is_not_allowed_is_never_chosen(temperature):
    values = [[0.0, -math.inf, 1.0], [-math.inf, -math.inf, -7.0]]
    with np.errstate(all="raise", under="ignore"):
        p = softmax(values, temperature)
    assert p[0, 1] == 0 and p[1].tolist() == [0, 0, 1]
    np.testing.assert_array_equal(p[0, [0, 2]], softmax([0.0, 1.0], temperature))
    assert argmax_shared(values, rng=0).tolist() == [2, 2]
