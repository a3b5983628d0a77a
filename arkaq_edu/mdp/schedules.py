"""Choosing among values: softly, greedily, and on a schedule that goes from one to the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, integer, number

Schedule = Callable[[int], float]


def softmax(values: ArrayLike, temperature: float) -> NDArray[np.float64]:
    """Return the Boltzmann probabilities of equation 3.2, along the last axis.

    Parameters
    ----------
    values : array_like, shape (..., A)
        The value of each action, finite; of any size.
    temperature : float
        T > 0, in the unit of the values; infinity makes all actions alike.

    Returns
    -------
    ndarray, shape (..., A)
        Not negative; each row sums to 1.

    Raises
    ------
    ValueError
        If a value is not finite or `temperature` is not above 0.

    Notes
    -----
    exp(Q / T) overflows for Q / T above 709, so the largest value is taken away first, which
    leaves every ratio as it is; on halves, because a difference of two floats can overflow too.

    References
    ----------
    Thesis chapter 3 (equation 3.2).

    Examples
    --------
    >>> softmax([0.0, np.log(3.0)], temperature=1.0)
    array([0.25, 0.75])
    >>> softmax([1e300, 2e300], temperature=1e-9)
    array([0., 1.])
    """
    half = array("values", values, (None,) * max(1, np.ndim(values))) / 2
    T = number("temperature", temperature, 0, open_low=True)
    with np.errstate(over="ignore", under="ignore"):
        weights = np.exp(2 * ((half - half.max(axis=-1, keepdims=True)) / T))
    return weights / weights.sum(axis=-1, keepdims=True)


def argmax_shared(values: ArrayLike, rng: np.random.Generator | int) -> NDArray[np.intp]:
    """Draw one of the largest along the last axis; n ties have probability 1/n each (3.3).

    Parameters
    ----------
    values : array_like, shape (..., A)
        The value of each action.
    rng : numpy.random.Generator or int
        Where the draws come from.

    Returns
    -------
    ndarray of int, shape (...)

    Raises
    ------
    ValueError
        If there is no action, or a value is NaN.

    Notes
    -----
    Equation 3.3 prints Q(s, a) = argmax Q, and gives every best action probability 1; right is
    "a is in the argmax", and 1/n.

    References
    ----------
    Thesis chapter 3 (equation 3.3).

    Examples
    --------
    >>> argmax_shared([[1, 2, 0], [7, 5, 3]], rng=0)
    array([1, 0])
    """
    values = np.asarray(values)
    if not values.size or np.isnan(values).any():
        raise ValueError(f"values must be numbers, at least one in a row, got {values}")
    lots = np.random.default_rng(rng).random(values.shape)
    best = values == values.max(axis=-1, keepdims=True)
    return np.where(best, lots, -1.0).argmax(axis=-1)


@dataclass(frozen=True)
class Power:
    """start / n^exponent for n = 1, 2, ...: a learning rate that lets Q-learning converge.

    Parameters
    ----------
    start : float, default 1.0
        The first value, above 0.
    exponent : float, default 1.0
        How fast it falls, above 0. The rates sum to infinity up to 1, and their squares to
        something finite above 1/2: between the two, Q-learning converges.

    Raises
    ------
    ValueError
        If an argument is not above 0.

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
        number("start", self.start, 0, open_low=True)
        number("exponent", self.exponent, 0, open_low=True)

    def __call__(self, n: int) -> float:
        """Return the value for the n-th time, n >= 1."""
        return self.start / n**self.exponent


@dataclass(frozen=True)
class Exponential:
    """A value that loses the same share every time, down to a floor: a temperature that falls.

    Parameters
    ----------
    start : float
        The first value, above 0.
    half_life : float
        After how many times it has halved, above 0.
    floor : float, default 0.0
        What it does not fall below, at least 0.

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
        number("start", self.start, 0, open_low=True)
        number("half_life", self.half_life, 0, open_low=True)
        number("floor", self.floor, 0)

    def __call__(self, n: int) -> float:
        """Return the value for the n-th time, n >= 1."""
        return max(self.start * 0.5 ** ((n - 1) / self.half_life), self.floor)


@dataclass(frozen=True)
class Linear:
    """From `start` to `stop` in equal steps over the first `n_steps` times, and `stop` after that.

    Parameters
    ----------
    start, stop : float
        The first value and the last.
    n_steps : int
        How many times it takes, at least 2.

    Raises
    ------
    ValueError
        If an argument is out of range.

    Examples
    --------
    >>> fade = Linear(start=1.0, stop=0.0, n_steps=5)
    >>> [fade(n) for n in (1, 2, 5, 9)]
    [1.0, 0.75, 0.0, 0.0]
    """

    start: float
    stop: float
    n_steps: int

    def __post_init__(self) -> None:
        number("start", self.start)
        number("stop", self.stop)
        integer("n_steps", self.n_steps, 2)

    def __call__(self, n: int) -> float:
        """Return the value for the n-th time, n >= 1."""
        done = min((n - 1) / (self.n_steps - 1), 1.0)
        return (1 - done) * self.start + done * self.stop


def value_at(value: float | Schedule, n: int) -> float:
    """Return a constant, or what a schedule says for the n-th time.

    Examples
    --------
    >>> value_at(8.0, 4), value_at(Power(start=8.0), 4)
    (8.0, 2.0)
    """
    return value(n) if callable(value) else value
