"""Belief states: what is known about a hidden state from the actions and observations so far."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, distribution, integer
from arkaq_edu.pomdp.model import POMDP

Floats = NDArray[np.float64]

# A belief whose sum is this close to 1 is taken as it is.
NEARLY = 1e-12


class Successors(NamedTuple):
    """Where one action can take a belief.

    Attributes
    ----------
    chances : ndarray, shape (Z,)
        The probability of each observation.
    beliefs : ndarray, shape (Z, S)
        The belief after each; a row of NaN if the observation cannot happen.
    """

    chances: Floats
    beliefs: Floats


class Trajectory(NamedTuple):
    """The beliefs along a history of actions and observations.

    Attributes
    ----------
    beliefs : list of ndarray, shape (S,)
        The belief at the start, then after each half step: predicted, corrected, predicted, ...
    steps : list of tuple of int
        The action and the observation of each complete step.
    pending : int or None
        The last action, if its observation has not come yet.
    """

    beliefs: list[Floats]
    steps: list[tuple[int, int]]
    pending: int | None


class Calibration(NamedTuple):
    """How often claims came true, sorted by the claimed probability.

    Attributes
    ----------
    claimed : ndarray, shape (n,)
        The mean claim of each bin.
    held : ndarray, shape (seeds, n)
        The share of the claims in the bin that came true, a row for each seed; NaN if it made none.
    """

    claimed: Floats
    held: Floats

    @property
    def mean(self) -> Floats:
        """The mean of `held` over the seeds, shape (n,)."""
        return np.nanmean(self.held, axis=0)

    @property
    def std(self) -> Floats:
        """The standard deviation of `held` over the seeds, shape (n,)."""
        return np.nanstd(self.held, axis=0)


def predict(pomdp: POMDP, b: ArrayLike, a: int) -> Floats:
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
        If `b` is not a distribution over the states or there is no such action.

    References
    ----------
    Thesis 2.3.2: the sum in equation 2.15.

    Examples
    --------
    >>> pomdp = POMDP(T=[[[0.1, 0.9], [0, 1]]], O=[[[1], [1]]], R=[[0], [0]], gamma=0.9)
    >>> predict(pomdp, [0.5, 0.5], 0)
    array([0.05, 0.95])
    """
    b, a, T = _belief(pomdp, b), integer("a", a, 0, pomdp.n_actions - 1), pomdp.T
    return b @ T[a]


def belief_update(pomdp: POMDP, b: ArrayLike, a: int, z: int) -> Floats:
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
        If `b` is not a distribution over the states, an index does not exist, or `z` cannot be
        observed after `a` from this belief.

    Notes
    -----
    This differs from the printed equations in two places. In 2.13 and 2.15 the observation is that
    of time t, as the text says, not of t - 1. And the sum of 2.15 holds both b(s) and
    Pr(s_{t-1} | a, b), which are the same: with both, the belief before is counted twice.

    References
    ----------
    Thesis 2.3.2 (equations 2.13-2.15). K. Astrom, "Optimal control of Markov processes with
    incomplete state information", Journal of Mathematical Analysis and Applications 10, 1965.

    Examples
    --------
    The ball is left or right of the robot. A look errs in one of ten cases.

    >>> pomdp = POMDP(T=[np.eye(2)], O=[[[0.9, 0.1], [0.1, 0.9]]], R=[[0], [0]], gamma=0.9)
    >>> once = belief_update(pomdp, [0.5, 0.5], 0, 0)
    >>> twice = belief_update(pomdp, once, 0, 0)
    >>> once, twice.round(3)
    (array([0.9, 0.1]), array([0.988, 0.012]))
    """
    b, T, O = _belief(pomdp, b), pomdp.T, pomdp.O  # noqa: E741
    a = integer("a", a, 0, pomdp.n_actions - 1)
    z = integer("z", z, 0, pomdp.n_observations - 1)
    predicted, seen = b @ T[a], _column(O[a], z)
    chance = seen @ predicted  # the denominator of equation 2.15: Pr(z | a, b)
    if not chance > 0:
        raise ValueError(
            f"z must be an observation that can follow: {pomdp.observations[z]!r} has probability "
            f"0 after {pomdp.actions[a]!r} from this belief"
        )
    return seen * predicted / chance


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
        If `b` is not a distribution over the states or there is no such action.

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
    predicted, O = predict(pomdp, b, a), pomdp.O  # noqa: E741
    joint = O[a].T * predicted  # the numerator of equation 2.15 for every z, shape (Z, S)
    if not isinstance(joint, np.ndarray):  # O is sparse
        joint = joint.toarray()
    chances = joint.sum(axis=1)
    beliefs = np.full(joint.shape, np.nan)
    np.divide(joint, chances[:, np.newaxis], out=beliefs, where=chances[:, np.newaxis] > 0)
    return Successors(chances, beliefs)


def trajectory(pomdp: POMDP, history: Iterable[str | None], seed: int = 0) -> Trajectory:
    """Return the beliefs along a history: an action, an observation, an action, ...

    Parameters
    ----------
    pomdp : POMDP
        The model. Its start is the belief before the first action.
    history : iterable of (str or None)
        The names of actions and observations, in turn. An observation that is None is drawn with
        its probability given the belief.
    seed : int, default 0
        The seed of these draws. Each depends on the seed and on the number of its step only.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If a name does not exist, an observation cannot follow, or `seed` is not an integer >= 0.

    References
    ----------
    Thesis 2.3.2 (equation 2.15).

    Examples
    --------
    >>> from arkaq_edu.pomdp import problem
    >>> trajectory(problem("floors"), ["down", "dark", "down"]).beliefs[-1]
    array([0.  , 0.  , 0.25, 0.75])
    """
    beliefs: list[Floats] = [pomdp.start]
    steps: list[tuple[int, int]] = []
    pending: int | None = None
    seed = integer("seed", seed)
    for name in history:
        if pending is None:
            pending = _index("action", name, pomdp.actions)
            beliefs.append(predict(pomdp, beliefs[-1], pending))
            continue
        if name is None:
            chances = beliefs[-1] @ pomdp.O[pending]
            rng = np.random.default_rng([seed, len(steps)])
            z = int(rng.choice(pomdp.n_observations, p=chances / chances.sum()))
        else:
            z = _index("observation", name, pomdp.observations)
        beliefs.append(belief_update(pomdp, beliefs[-2], pending, z))
        steps.append((pending, z))
        pending = None
    return Trajectory(beliefs, steps, pending)


def entropy(b: ArrayLike) -> float:
    """Return the uncertainty of a belief in bits: 0 if it is certain, 1 for two equal chances.

    Parameters
    ----------
    b : array_like, shape (S,)
        The belief.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If `b` is not a distribution.

    Examples
    --------
    >>> entropy([0.5, 0.5]), entropy([1.0, 0.0])
    (1.0, 0.0)
    """
    p = distribution("b", b, (None,))
    p = p[p > 0]
    return abs(float(p @ np.log2(p)))


def expected_rewards(pomdp: POMDP, b: ArrayLike) -> Floats:
    """Return rho(b, a) = sum_s b(s) R(s, a) for every action (equation 2.17).

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
        If `b` is not a distribution over the states.

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
    """Return how often claims came true, sorted by the claimed probability.

    Parameters
    ----------
    claims : array_like, shape (seeds, T)
        The claimed probabilities.
    true : array_like of bool, shape (seeds, T)
        Whether each claim came true.
    edges : array_like, shape (k,)
        The borders between the bins of claims, rising. Bins without claims are left out.

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


def _column(O: Any, z: int) -> Floats:  # noqa: E741
    """Return O[:, z], dense."""
    return O[:, z] if isinstance(O, np.ndarray) else O[:, [z]].toarray()[:, 0]


def _belief(pomdp: POMDP, b: ArrayLike) -> Floats:
    if type(b) is np.ndarray and b.dtype == np.float64 and b.shape == pomdp.start.shape:
        p = b.tolist()
        if abs(sum(p) - 1) < NEARLY and min(p) >= 0:
            return b  # as an update returned it: the gate would take longer than the next update
    return distribution("b", b, pomdp.start.shape)


def _index(kind: str, name: str | None, names: tuple[str, ...]) -> int:
    if name not in names:
        raise ValueError(f"{kind} must be one of {', '.join(names)}, got {name!r}")
    return names.index(name)
