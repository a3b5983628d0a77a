"""How well something was learned: how near to the best, how fast, at what cost (thesis 2.1.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, integer, n_axes, number


def regret(earned: ArrayLike, optimal: float) -> NDArray[np.float64]:
    """Return how much less was earned so far than by the optimal policy.

    Parameters
    ----------
    earned : array_like, shape (..., T)
        What was earned, or was expected, at each of T trials.
    optimal : float
        What the optimal policy earns at each trial.

    Returns
    -------
    ndarray, shape (..., T)
        The sum of the differences up to and including each trial.

    Raises
    ------
    ValueError
        If a number is not finite.

    References
    ----------
    Thesis 2.1.2, third measure.

    Examples
    --------
    >>> regret([0.2, 0.7, 0.2], optimal=0.7)
    array([0.5, 0.5, 1. ])
    """
    return np.cumsum(number("optimal", optimal) - _trials(earned), axis=-1)


def quality_of_convergence(
    earned: ArrayLike, optimal: float, *, baseline: float = 0.0, last: int = 100
) -> NDArray[np.float64]:
    """Return the share of the optimum that is earned in the end.

    Parameters
    ----------
    earned : array_like, shape (..., T)
        What was earned at each of T trials.
    optimal : float
        What the optimal policy earns at each trial.
    baseline : float, default 0.0
        What counts as zero, for example what random actions earn; below `optimal`.
    last : int, default 100
        The number of last trials to average over, at least 1 (all, if there are fewer).

    Returns
    -------
    ndarray, shape (...)
        1 for optimal behavior, 0 for the baseline.

    Raises
    ------
    ValueError
        If a number is not finite or out of range.

    References
    ----------
    Thesis 2.1.2, first measure ("up to 99 percent optimality").

    Examples
    --------
    >>> quality_of_convergence([[0.0, 0.5, 0.75, 0.75], [0, 0, 0, 1]], optimal=1.0, last=2)
    array([0.75, 0.5 ])
    """
    optimal = number("optimal", optimal)
    baseline = number("baseline", number("baseline", baseline), high=optimal, open_high=True)
    final = _trials(earned)[..., -integer("last", last, 1) :].mean(axis=-1)
    return (final - baseline) / (optimal - baseline)


def speed_of_convergence(earned: ArrayLike, target: float, *, window: int = 1) -> NDArray[np.intp]:
    """Return the number of trials after which the earnings stay at a target.

    "The definition of convergence must be well defined", says the thesis. Here learning has
    converged at the first trial after which the mean of the last `window` trials never falls below
    `target` again.

    Parameters
    ----------
    earned : array_like, shape (..., T)
        What was earned at each of T trials.
    target : float
        What counts as converged, for example 99 percent of the optimum.
    window : int, default 1
        The number of trials to average over, from 1 to T.

    Returns
    -------
    ndarray of int, shape (...)
        The number of trials up to the end of that first window; T + 1 if it never converged.

    Raises
    ------
    ValueError
        If a number is not finite or out of range.

    References
    ----------
    Thesis 2.1.2, second measure.

    Examples
    --------
    >>> speed_of_convergence([[0, 1, 0, 1, 1], [0, 0, 0, 1, 0]], target=1)
    array([4, 6])
    """
    x = _trials(earned)
    n_trials = x.shape[-1]
    window = integer("window", window, 1, n_trials)
    smooth = np.lib.stride_tricks.sliding_window_view(x, window, axis=-1).mean(axis=-1)
    below = smooth < number("target", target)
    windows_since = np.where(below.any(axis=-1), below[..., ::-1].argmax(axis=-1), below.shape[-1])
    return (n_trials + 1 - windows_since)[()]


def _trials(earned: ArrayLike) -> NDArray[np.float64]:
    x = array("earned", earned, (None,) * max(1, n_axes("earned", earned)))
    if not x.shape[-1]:
        raise ValueError(f"earned must hold at least one trial, got shape {x.shape}")
    return x
