import numpy as np
import pytest

from arkaq_edu.mdp import (
    Exponential,
    Power,
)


def test_schedules_fall_as_they_say():
    assert [Power(2.0, 0.5)(n) for n in (1, 4, 16)] == [2.0, 1.0, 0.5]
    cooling = Exponential(8.0, half_life=5, floor=0.5)
    assert [cooling(n) for n in (1, 6, 11, 500)] == [8.0, 4.0, 2.0, 0.5]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Power(exponent=0), r"exponent must be a number in \(0, 10\], got 0"),
        (lambda: Exponential(1.0, 0), "half_life must be a number in"),
        (lambda: Power("1"), r"start must be a number in \(0, inf\], got '1'"),
        (lambda: Power(exponent=2**63), r"exponent must be a number in \(0, 10\], got 92"),
        (lambda: Exponential("8", 10), r"start must be a number in \(0, inf\], got '8'"),
        (lambda: Exponential(8, 10, None), r"floor must be a number in \[0, inf\], got None"),
        (lambda: Power()(0), "n must be an integer >= 1, got 0"),
        (lambda: Exponential(8, 10)("1"), "n must be an integer >= 1, got '1'"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_what_was_checked_is_what_is_used():
    assert type(Power(2**63, 1).start) is float
    assert Power(2**63, 10)(2**63 - 1) == pytest.approx(2.0**-567)
    assert Exponential(np.array(8.0), np.float32(2))(3) == 4.0
