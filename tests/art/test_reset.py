"""The reset in closed form: against the norm of r, and against the network."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arkaq_edu.art import ART2, learned_norm, match_norm, reset_cosine


@given(st.floats(0.01, 0.99), st.floats(0.01, 1.0), st.floats(0.71, 0.999))
def test_the_reset_cosine_is_where_the_norm_of_r_meets_the_vigilance(c, cdz, vigilance):
    cosine = float(reset_cosine(vigilance, cdz, c))
    assert 0 <= cosine <= 1
    if cosine > 0:
        assert match_norm(cosine, cdz, c) == pytest.approx(vigilance, abs=1e-9)
        assert match_norm(min(cosine + 0.01, 1), cdz, c) > vigilance - 1e-12
    assert (match_norm(np.linspace(cosine, 1, 50), cdz, c) >= vigilance - 1e-9).all()


def test_an_uncommitted_node_is_reset_at_no_cosine():
    assert reset_cosine(0.999, [0.0, 0.9], 0.1)[0] == 0


@pytest.mark.parametrize("vigilance", [0.85, 0.95, 0.99])
def test_the_network_resets_below_that_cosine(vigilance):
    c, d = 0.2, 0.8
    cosine = float(reset_cosine(vigilance, learned_norm(c, d), c))
    network = ART2(vigilance, c=c, d=d, theta=0.0, start=0.1).fit([[1.0, 0.0]])
    for off, reset in [(-0.01, True), (0.01, False)]:
        angle = np.arccos(cosine + off)
        # The first comparison is with u as the input left it, before the expectation bends it.
        trace = network.trace([np.cos(angle), np.sin(angle)])
        first = trace[trace.node == 0].iloc[0]
        assert first.reset == reset


@pytest.mark.parametrize(("c", "vigilance"), [(0, 0.9), (1, 0.9), (-0.1, 0.9), (0.1, 1), (0.1, 0)])
def test_a_reset_cosine_outside_its_range_is_refused(c, vigilance):
    with pytest.raises(ValueError, match="c must" if vigilance == 0.9 else "vigilance must"):
        reset_cosine(vigilance, 0.5, c)
