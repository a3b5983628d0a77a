"""The recorded stream in other orders."""

import numpy as np
import pytest

from arkaq_edu.experiments.segmentation import ORDERS, in_order
from tests.stand_in import triangle_stream


@pytest.mark.parametrize("order", ORDERS)
def test_an_order_loses_no_pattern_and_is_always_the_same(order):
    patterns = triangle_stream(300)
    ordered = in_order(patterns, order)
    assert sorted(ordered.tolist()) == sorted(patterns.tolist())
    assert (ordered == in_order(patterns, order)).all()
    assert (ordered == patterns).all() == (order == "as recorded")
    assert (np.diff(ordered[:, 0]) >= 0).all() == (order == "sorted by distance")


def test_an_unknown_order_is_refused():
    with pytest.raises(ValueError, match=r"order must be one of .*got 'backwards'"):
        in_order([[0, 0]], "backwards")
