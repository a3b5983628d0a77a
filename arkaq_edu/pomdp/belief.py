"""Belief states: what is known of a state that cannot be seen, after what was done and observed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integer
from arkaq_edu.pomdp.model import POMDP


class Successors(NamedTuple):
    """Where one action can take a belief.

    Attributes
    ----------
    chances : ndarray, shape (Z,)
        How likely each observation is.
    beliefs : ndarray, shape (Z, S)
        The belief after each; a row of NaN where the observation cannot happen.
    """

    chances: NDArray[np.float64]
    beliefs: NDArray[np.float64]


class Calibration(NamedTuple):
    """What became of the claims of beliefs, sorted by what was claimed.

    Attributes
    ----------
    claimed : ndarray, shape (n,)
        The mean claim of each bin.
    held : ndarray, shape (seeds, n)
        Which part of the claims in it came true, a row for each seed; NaN where it made none.
    """

    claimed: NDArray[np.float64]
    held: NDArray[np.float64]


def predict(pomdp: POMDP, b: ArrayLike, a: int) -> NDArray[np.float64]:
    """Return Pr(s' | b, a): the belief after an action, before anything is observed.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    b : array_like, shape (S,)
        The belief: probabilities that sum to 1.
    a : int
        The action.

    Returns
    -------
    ndarray, shape (S,)

    Raises
    ------
    ValueError
        If `b` is no distribution over the states or there is no such action.

    References
    ----------
    Thesis 2.3.2: the sum in equation 2.15.

    Examples
    --------
    >>> pomdp = POMDP(T=[[[0.1, 0.9], [0, 1]]], O=[[[1], [1]]], R=[[0], [0]], gamma=0.9)
    >>> predict(pomdp, [0.5, 0.5], 0)
    array([0.05, 0.95])
    """
    return _belief(pomdp, b) @ pomdp.T[integer("a", a, 0, pomdp.n_actions - 1)]


def belief_update(pomdp: POMDP, b: ArrayLike, a: int, z: int) -> NDArray[np.float64]:
    """Return the belief after action `a` and observation `z`, by Bayes' rule (equation 2.15).

    Parameters
    ----------
    pomdp : POMDP
        The model.
    b : array_like, shape (S,)
        The belief before: probabilities that sum to 1.
    a : int
        The action taken.
    z : int
        The observation that followed.

    Returns
    -------
    ndarray, shape (S,)
        b'(s') = O(a, s', z) sum_s T(a, s, s') b(s) / Pr(z | b, a).

    Raises
    ------
    ValueError
        If `b` is no distribution over the states, an index does not exist, or `z` cannot be
        observed after `a` from this belief.

    Notes
    -----
    Where the thesis prints otherwise: in 2.13 and 2.15 the observation is that of time t, as its
    text says, not t - 1; and the sum of 2.15 holds both b(s) and Pr(s_{t-1} | a, b), which are the
    same thing: with both, the belief before is counted twice.

    References
    ----------
    Thesis 2.3.2 (equations 2.13-2.15). K. Astrom, "Optimal control of Markov processes with
    incomplete state information", Journal of Mathematical Analysis and Applications 10, 1965.

    Examples
    --------
    The ball is left or right of the robot; a look errs in one of ten cases.

    >>> pomdp = POMDP(T=[np.eye(2)], O=[[[0.9, 0.1], [0.1, 0.9]]], R=[[0], [0]], gamma=0.9)
    >>> once = belief_update(pomdp, [0.5, 0.5], 0, 0)
    >>> twice = belief_update(pomdp, once, 0, 0)
    >>> once, twice.round(3)
    (array([0.9, 0.1]), array([0.988, 0.012]))
    """
    joint = predict(pomdp, b, a) * pomdp.O[a, :, integer("z", z, 0, pomdp.n_observations - 1)]
    chance = joint.sum()
    if not chance > 0:
        raise ValueError(
            f"z must be an observation that can follow: {pomdp.observations[z]!r} has probability "
            f"0 after {pomdp.actions[a]!r} from this belief"
        )
    return joint / chance


def successors(pomdp: POMDP, b: ArrayLike, a: int) -> Successors:
    """Return every belief that action `a` can lead to, and how likely each is.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    b : array_like, shape (S,)
        The belief before: probabilities that sum to 1.
    a : int
        The action.

    Returns
    -------
    Successors
        ``chances`` of the observations, shape (Z,), and ``beliefs`` after them, shape (Z, S).

    Raises
    ------
    ValueError
        If `b` is no distribution over the states or there is no such action.

    References
    ----------
    Thesis 2.3.3 (equation 2.16) and figure 2.13.

    Examples
    --------
    >>> pomdp = POMDP(T=[np.eye(2)], O=[[[0.9, 0.1], [0.1, 0.9]]], R=[[0], [0]], gamma=0.9)
    >>> chances, beliefs = successors(pomdp, [0.5, 0.5], 0)
    >>> chances, beliefs
    (array([0.5, 0.5]), array([[0.9, 0.1],
           [0.1, 0.9]]))
    """
    joint = (predict(pomdp, b, a)[:, np.newaxis] * pomdp.O[a]).T
    chances = joint.sum(axis=1)
    beliefs = np.full(joint.shape, np.nan)
    np.divide(joint, chances[:, np.newaxis], out=beliefs, where=chances[:, np.newaxis] > 0)
    return Successors(chances, beliefs)


def expected_rewards(pomdp: POMDP, b: ArrayLike) -> NDArray[np.float64]:
    """Return rho(b, a) = sum_s b(s) R(s, a) of every action (equation 2.17).

    Parameters
    ----------
    pomdp : POMDP
        The model.
    b : array_like, shape (S,)
        The belief: probabilities that sum to 1.

    Returns
    -------
    ndarray, shape (A,)

    Raises
    ------
    ValueError
        If `b` is no distribution over the states.

    References
    ----------
    Thesis 2.3.3 (equation 2.17).

    Examples
    --------
    Figure 2.16: a1 earns 1 in s1, a2 earns 1.5 in s2.

    >>> pomdp = POMDP(T=[np.eye(2)] * 2, O=[[[1], [1]]] * 2, R=[[1, 0], [0, 1.5]], gamma=0.9)
    >>> expected_rewards(pomdp, [0.25, 0.75])
    array([0.25 , 1.125])
    """
    return _belief(pomdp, b) @ pomdp.R


def calibration(claims: ArrayLike, true: ArrayLike, edges: ArrayLike) -> Calibration:
    """Return how often what was claimed with some probability came true.

    Parameters
    ----------
    claims : array_like, shape (seeds, T)
        Probabilities that were claimed.
    true : array_like of bool, shape (seeds, T)
        Whether each came true.
    edges : array_like, shape (k,)
        Where one bin of claims ends and the next begins, rising; a bin without claims is left out.

    Returns
    -------
    Calibration
        ``claimed``, shape (n,), and ``held``, shape (seeds, n).

    Raises
    ------
    ValueError
        If a claim is outside [0, 1], or the shapes differ.

    References
    ----------
    A. Dawid, "The well-calibrated Bayesian", Journal of the American Statistical Association 77,
    1982. Not in the thesis.

    Examples
    --------
    >>> calibration([[0.6, 0.9, 0.9, 0.9]], [[True, True, True, False]], edges=[0.8])
    Calibration(claimed=array([0.6, 0.9]), held=array([[1.        , 0.66666667]]))
    """
    p = array("claims", claims, (None, None))
    if ((p < 0) | (p > 1)).any():
        raise ValueError(f"claims must be probabilities, in [0, 1], got {p.min()} to {p.max()}")
    came = array("true", true, p.shape)
    bins = np.digitize(p, array("edges", edges, (None,)))
    kept = np.unique(bins)
    here = bins == kept[:, np.newaxis, np.newaxis]
    made = here.sum(axis=2).T
    held = np.full(made.shape, np.nan)
    np.divide((here * came).sum(axis=2).T, made, out=held, where=made > 0)
    return Calibration((here * p).sum(axis=(1, 2)) / made.sum(axis=0), held)


def _belief(pomdp: POMDP, b: ArrayLike) -> NDArray[np.float64]:
    return distribution("b", array("b", b, (pomdp.n_states,)))
