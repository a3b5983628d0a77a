"""Choosing among actions by their values: softly (equation 3.2) and greedily (equation 3.3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, generator, number


def softmax(values: ArrayLike, temperature: float) -> NDArray[np.float64]:
    """Return the Boltzmann probabilities of equation 3.2, along the last axis.

    Parameters
    ----------
    values : array_like, shape (..., A)
        The value of each action, at least one in each row; -inf for one that is not allowed.
    temperature : float
        T > 0, in the unit of the values. At infinity all actions are equally likely.

    Returns
    -------
    ndarray, shape (..., A)
        Probabilities; each row sums to 1. Actions that are not allowed have 0.

    Raises
    ------
    ValueError
        If there are no values, one is neither finite nor -inf, a row allows no action, or
        `temperature` is not above 0.

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
    Q, T = _rows(values), number("temperature", temperature, 0, open_low=True)
    below = Q - Q.max(axis=-1, keepdims=True)
    # A difference over a tiny T may become -inf: exp gives 0. And -inf / inf has no value.
    with np.errstate(over="ignore", invalid="ignore"):
        weights = np.where(below == -np.inf, 0.0, np.exp(below / T))
    return weights / weights.sum(axis=-1, keepdims=True)


def _rows(values: ArrayLike) -> NDArray[np.float64]:
    """Return the values of actions, checked: each row must allow at least one."""
    Q = array("values", values, None, allow_minus_infinity=True)
    if not Q.ndim or not Q.size:
        raise ValueError(f"values must hold at least one action in a row, got shape {Q.shape}")
    if (Q.max(axis=-1) == -np.inf).any():
        raise ValueError("values must allow an action in each row, got one of -inf only")
    return Q


def argmax_shared(values: ArrayLike, rng: np.random.Generator | int) -> NDArray[np.intp]:
    """Draw one of the largest values along the last axis, each of n ties with probability 1/n.

    Parameters
    ----------
    values : array_like, shape (..., A)
        The value of each action; -inf for one that is not allowed.
    rng : numpy.random.Generator or int
        The random numbers: one for each value.

    Returns
    -------
    ndarray of int, shape (...)

    Raises
    ------
    ValueError
        If there are no values, one is neither finite nor -inf, or a row allows no action.

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
    return draw_best(_rows(values), generator("rng", rng))


def draw_best(Q: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.intp]:
    """Draw as `argmax_shared` does, from values that may be infinite.

    Examples
    --------
    >>> draw_best(np.array([[1.0, np.inf]]), np.random.default_rng(0))
    array([1])
    """
    best = Q.max(axis=-1, keepdims=True) == Q
    return np.where(best, rng.random(Q.shape), -1.0).argmax(axis=-1)
