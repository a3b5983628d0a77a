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
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
