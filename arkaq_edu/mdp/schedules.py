"""Schedules: values that change with time, such as a learning rate or a temperature that falls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from arkaq_edu._checks import integer, number

Schedule = Callable[[int], float]

_store = object.__setattr__  # a frozen dataclass stores what was checked


@dataclass(frozen=True)
class Power:
    """start / n^exponent for n = 1, 2, ...: a learning rate that lets Q-learning converge.

    Parameters
    ----------
    start : float, default 1.0
        The first value, above 0.
    exponent : float, default 1.0
        How fast it falls, in (0, 10]. Q-learning converges for exponents above 1/2 and up to 1:
        then the rates sum to infinity, and their squares to a finite number.

    Raises
    ------
    ValueError
        If an argument is out of range.

    References
    ----------
    Thesis 4.3 ("the learning rate can be decreased along with time").
    H. Robbins, S. Monro, "A stochastic approximation method", 1951.

    Examples
    --------
    >>> Power(exponent=0.5)(4)
    0.5
    """

    start: float = 1.0
    exponent: float = 1.0

    def __post_init__(self) -> None:
        _store(self, "start", number("start", self.start, 0, open_low=True))
        # Beyond 10, n to this power leaves the range of floats, or takes for ever.
        _store(self, "exponent", number("exponent", self.exponent, 0, 10, open_low=True))

    def __call__(self, n: int) -> float:
        """Return the n-th value, n >= 1."""
        return self.start / integer("n", n, 1) ** self.exponent


@dataclass(frozen=True)
class Exponential:
    """A value that falls by the same factor each time, down to a floor: a temperature that cools.

    Parameters
    ----------
    start : float
        The first value, above 0.
    half_life : float
        The number of steps in which it halves, above 0.
    floor : float, default 0.0
        The lowest value, at least 0.

    Raises
    ------
    ValueError
        If an argument is out of range.

    References
    ----------
    Thesis chapter 3 ("temperature, which decreases by exploration time").

    Examples
    --------
    >>> cooling = Exponential(start=8.0, half_life=10, floor=1.0)
    >>> cooling(1), cooling(11), cooling(21), cooling(1000)
    (8.0, 4.0, 2.0, 1.0)
    """

    start: float
    half_life: float
    floor: float = 0.0

    def __post_init__(self) -> None:
        _store(self, "start", number("start", self.start, 0, open_low=True))
        _store(self, "half_life", number("half_life", self.half_life, 0, open_low=True))
        _store(self, "floor", number("floor", self.floor, 0))

    def __call__(self, n: int) -> float:
        """Return the n-th value, n >= 1."""
        return max(self.start * 0.5 ** ((integer("n", n, 1) - 1) / self.half_life), self.floor)


def value_at(value: float | Schedule, n: int) -> float:
    """Return a constant, or the n-th value of a schedule.

    Examples
    --------
    >>> value_at(8.0, 4), value_at(Power(start=8.0), 4)
    (8.0, 2.0)
    """
    return value(n) if callable(value) else value
