"""Choosing among actions by their values: softly (equation 3.2) and greedily (equation 3.3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, number


def softmax(values: ArrayLike, temperature: float) -> NDArray[np.float64]:
    """Return the Boltzmann probabilities of equation 3.2, along the last axis.

    Parameters
    ----------
    values : array_like, shape (..., A)
        The value of each action, finite.
    temperature : float
        T > 0, in the unit of the values. At infinity all actions are equally likely.

    Returns
    -------
    ndarray, shape (..., A)
        Probabilities; each row sums to 1.

    Raises
    ------
    ValueError
        If a value is not finite or `temperature` is not above 0.

    Notes
    -----
    exp(Q / T) overflows for Q / T above 709. So the largest value is subtracted first, which
    changes no ratio of two probabilities.

    References
    ----------
    Thesis chapter 3 (equation 3.2).

    Examples
    --------
    >>> softmax([0.0, np.log(3.0)], temperature=1.0)
    array([0.25, 0.75])
    """
    Q = array("values", values, (None,) * max(1, np.ndim(values)))
    T = number("temperature", temperature, 0, open_low=True)
    with np.errstate(over="ignore"):  # a difference over a tiny T may become -inf: exp gives 0
        weights = np.exp((Q - Q.max(axis=-1, keepdims=True)) / T)
    return weights / weights.sum(axis=-1, keepdims=True)


def argmax_shared(values: ArrayLike, rng: np.random.Generator | int) -> NDArray[np.intp]:
    """Draw one of the largest values along the last axis, each of n ties with probability 1/n.

    Parameters
    ----------
    values : array_like, shape (..., A)
        The value of each action.
    rng : numpy.random.Generator or int
        The random numbers: one for each value.

    Returns
    -------
    ndarray of int, shape (...)

    Raises
    ------
    ValueError
        If there is no action, or a value is NaN.

    Notes
    -----
    Equation 3.3 prints Q(s, a) = argmax Q and gives every best action probability 1. Correct is
    that a is in the argmax, and that n best actions have probability 1/n each.

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
    tickets = np.random.default_rng(rng).random(values.shape)
    best = values == values.max(axis=-1, keepdims=True)
    return np.where(best, tickets, -1.0).argmax(axis=-1)
