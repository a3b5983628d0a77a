"""Checks for the notebook on decision processes: a backup, greedy actions, TD(0), a rate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, judge, numbers
from arkaq_edu.mdp import MDP

Rng = np.random.Generator | int | None
Floats = NDArray[np.float64]

BACKED_UP = "Right: what the best action earns now, and what the states after it are worth."
CHOSEN = "Right: from good values the best actions follow in one step."
STEPPED = "Right: a guess, moved toward a better guess. No model was needed."
SETTLED = "Right: it forgets where it began, and it comes to rest."

#: How many visits a rate is tried on, and what may be left of the start and of a target's scatter.
VISITS, START_LEFT, SCATTER_LEFT = 100_000, 0.01, 0.035


def check_bellman(bellman: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``bellman(T, R, gamma, V, s)``: the right-hand side of equation 2.8.

    Parameters
    ----------
    bellman : callable
        Takes ``T`` (A, S, S), ``R`` (S, A), the discount, values ``V`` (S,) and a state; returns
        the state's new value.
    rng : numpy.random.Generator or int, optional
        Where the random models come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 2.2.1, equation 2.8.

    Examples
    --------
    >>> check_bellman(lambda T, R, gamma, V, s: R[s].max())
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: that is the best reward of now alone: what follows \
counts too
    """
    rng = np.random.default_rng(rng)
    cases = []
    for _ in range(20):
        T, R, gamma, V = _world(rng)
        cases.append((T, R, gamma, V, int(rng.integers(len(V)))))
    judge("bellman", bellman, cases, lambda *case: _values(*case).max(), WRONG_BELLMAN)
    return BACKED_UP


def check_greedy(greedy: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``greedy(T, R, gamma, V)``: the best action of each state, equation 2.9.

    Parameters
    ----------
    greedy : callable
        Takes ``T`` (A, S, S), ``R`` (S, A), the discount and values ``V`` (S,); returns the number
        of an action for each state.
    rng : numpy.random.Generator or int, optional
        Where the random models come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 2.2.1, equations 2.6 and 2.9.

    Examples
    --------
    >>> check_greedy(lambda T, R, gamma, V: R.argmax(axis=1))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: those are the actions of equation 2.6, best for now \
alone: V is never used
    """
    rng = np.random.default_rng(rng)
    cases = [_world(rng) for _ in range(20)]
    judge("greedy", greedy, cases, lambda *case: _q(*case).argmax(axis=1), WRONG_GREEDY)
    return CHOSEN


def check_td(td: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``td(v, r, v_next, ended, alpha, gamma)``: the new value by TD(0).

    Parameters
    ----------
    td : callable
        Takes the value of a state, the reward, the value of the state that followed, whether the
        episode ended there, the learning rate and the discount; returns the new value.
    rng : numpy.random.Generator or int, optional
        Where the random experiences come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 2.2.2, equation 2.11.

    Examples
    --------
    >>> check_td(lambda v, r, v_next, ended, alpha, gamma: v + alpha * (r - v))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: the reward is all that counts for you: add what the \
next state is worth
    """
    rng = np.random.default_rng(rng)
    for ended, wrong in ((False, WRONG_TD), (True, WRONG_END)):
        cases = [
            (v, r, v_next, ended, alpha, gamma)
            for v, r, v_next, alpha, gamma in rng.uniform(
                [10, 1, 10, 0.1, 0.7], [90, 40, 90, 0.4, 0.95], (20, 5)
            ).tolist()
        ]
        judge("td", td, cases, _td, wrong)
    return STEPPED


def check_rate(rate: Callable[..., Any]) -> str:
    """Check a student's ``rate(n)``: a learning rate by which Q forgets its start and settles.

    It is tried on 100,000 visits: no more than 1 % of the start may be left then, and of a target's
    scatter no more than 3.5 %. 1/n passes and its kin, and n^-p with p from 0.55 to 1.

    Parameters
    ----------
    rate : callable
        Takes the number of the visit, 1, 2, ...; returns a learning rate in [0, 1].

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, sections 2.2.3 and 4.3. H. Robbins, S. Monro, "A stochastic approximation method", 1951.

    Examples
    --------
    >>> check_rate(lambda n: 0.1)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: it never settles: ...
    """
    for n in (1, 2, 3):
        numbers("rate", ask(rate, n), ())
    start, variance, alpha = 1.0, 0.0, 0.0
    for n in range(1, VISITS + 1):
        alpha = float(rate(n))
        if not 0 <= alpha <= 1:
            raise ExerciseError(f"rate({n}) is {alpha:.4g}: a learning rate lies from 0 to 1")
        start *= 1 - alpha
        variance = (1 - alpha) ** 2 * variance + alpha**2
    if start > START_LEFT:
        raise ExerciseError(
            f"after {VISITS:,} visits {start:.0%} of the value is still what it began with: the "
            "rates die out before they have done their work"
        )
    if variance**0.5 > SCATTER_LEFT and alpha > 1 / VISITS**0.5 / 2:
        raise ExerciseError(
            f"it never settles: after {VISITS:,} visits {variance**0.5:.0%} of a target's scatter "
            "is still in the value, and the rate falls no more, or too slowly"
        )
    if variance**0.5 > SCATTER_LEFT:
        raise ExerciseError(
            "it stands still too soon: the first few targets make nearly all of the value, and the "
            "later ones can mend nothing"
        )
    return SETTLED


def _world(rng: np.random.Generator) -> tuple[Floats, Floats, float, Floats]:
    """Return T, R, gamma and V of a small random world, where no two actions are near equal."""
    while True:
        n_states, n_actions = int(rng.integers(3, 6)), int(rng.integers(2, 5))
        T = rng.dirichlet(np.ones(n_states), size=(n_actions, n_states))
        R, V = rng.uniform(-5, 20, (n_states, n_actions)), rng.uniform(0, 60, n_states)
        gamma = float(rng.uniform(0.6, 0.95))
        Q = np.sort(_q(T, R, gamma, V), axis=1)
        if np.diff(Q, axis=1).min() > 0.1 and n_states != n_actions:
            return T, R, gamma, V


def _q(T: Floats, R: Floats, gamma: float, V: Floats) -> Floats:
    return MDP(T, R, gamma).action_values(V)


def _values(T: Floats, R: Floats, gamma: float, V: Floats, s: int) -> Floats:
    return _q(T, R, gamma, V)[s]


def _td(v: float, r: float, v_next: float, ended: bool, alpha: float, gamma: float) -> float:
    return v + alpha * (r + gamma * v_next * (not ended) - v)


WRONG_BELLMAN: list[Rule] = [
    (
        lambda T, R, gamma, V, s: R[s].max(),
        "that is the best reward of now alone: what follows counts too",
    ),
    (
        lambda T, R, gamma, V, s: gamma * R[s].max(),
        "that is equation 2.7 as printed: now is not discounted, and what follows counts too",
    ),
    (
        lambda T, R, gamma, V, s: gamma * (R[s] + T[:, s] @ V).max(),
        "the reward of now is discounted too: only what comes a step later is worth gamma times it",
    ),
    (
        lambda T, R, gamma, V, s: gamma * (T[:, s] @ V).max(),
        "the reward of now is missing",
    ),
    (
        lambda T, R, gamma, V, s: (R[s] + T[:, s] @ V).max(),
        "what follows is not discounted: a step later it is worth gamma times as much",
    ),
    (
        lambda T, R, gamma, V, s: R[s].max() + gamma * (T[:, s] @ V).max(),
        "you take two maxima: but one and the same action earns the reward and leads on",
    ),
    (
        lambda T, R, gamma, V, s: _values(T, R, gamma, V, s).mean(),
        "you take the mean over the actions: the robot may choose the best",
    ),
    (
        lambda T, R, gamma, V, s: _values(T, R, gamma, V, s).sum(),
        "you add the actions up: the robot takes one of them, the best",
    ),
    (
        lambda T, R, gamma, V, s: _values(T, R, gamma, V, s).min(),
        "that is the worst action: the best is asked for",
    ),
    (
        lambda T, R, gamma, V, s: _values(T, R, gamma, V, s).argmax(),
        "that is which action is best: how much it is worth is asked for",
    ),
    (
        lambda T, R, gamma, V, s: _values(T, R, gamma, V, s),
        "those are the values of all actions: take the best of them",
    ),
    (
        lambda T, R, gamma, V, s: (R[s] + gamma * V.max()).max(),
        "you hope for the best state to follow: T says how likely each is",
    ),
    (
        lambda T, R, gamma, V, s: (R[s] + gamma * V.sum()).max(),
        "the values that may follow are added up: each counts by its probability in T",
    ),
    (
        lambda T, R, gamma, V, s: (R[s] + gamma * T[:, :, s] @ V).max(),
        "you sum over where one may have come from: T[a, s] holds where one goes",
    ),
]
WRONG_GREEDY: list[Rule] = [
    (
        lambda T, R, gamma, V: R.argmax(axis=1),
        "those are the actions of equation 2.6, best for now alone: V is never used",
    ),
    (
        lambda T, R, gamma, V: (T @ V).T.argmax(axis=1),
        "those lead to the best states, whatever they cost: the reward is missing",
    ),
    (
        lambda T, R, gamma, V: _q(T, R, gamma, V).max(axis=1),
        "those are the values of the best actions: their numbers are asked for",
    ),
    (
        lambda T, R, gamma, V: _q(T, R, gamma, V),
        "those are the values of all actions: which of a row is the largest?",
    ),
    (
        lambda T, R, gamma, V: _q(T, R, gamma, V).argmin(axis=1),
        "those are the worst actions",
    ),
    (
        lambda T, R, gamma, V: _q(T, R, gamma, V).argmax(axis=0),
        "that is the best state of each action: the best action of each state is asked for",
    ),
    (
        lambda T, R, gamma, V: _q(T, R, gamma, V).argmax(axis=1) + 1,
        "your actions count from 1: Python's count from 0",
    ),
    (
        lambda T, R, gamma, V: (R + (T @ V).T).argmax(axis=1),
        "what follows is not discounted: a step later it is worth gamma times as much",
    ),
    (
        lambda T, R, gamma, V: (R + gamma * np.einsum("ats,t->sa", T, V)).argmax(axis=1),
        "you sum over where one may have come from: T[a, s] holds where one goes",
    ),
]
WRONG_TD: list[Rule] = [
    (
        lambda v, r, v_next, ended, alpha, gamma: r + gamma * v_next,
        "you put the target in place of the old value: only a step of size alpha leads to it",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: alpha * (r + gamma * v_next - v),
        "that is the change: add it to the old value",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v + alpha * (r + gamma * v_next),
        "the target is added on top of the old value: what counts is the difference between them",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v + alpha * (r + v_next - v),
        "what follows is not discounted: a step later it is worth gamma times as much",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v + alpha * (r - v),
        "the reward is all that counts for you: add what the next state is worth",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v + alpha * (gamma * v_next - v),
        "the reward is missing from the target",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v + alpha * gamma * (r + v_next) - alpha * v,
        "the reward is discounted too: only what comes a step later is worth gamma times it",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: alpha * v + (1 - alpha) * (r + gamma * v_next),
        "alpha and 1 - alpha have changed places: alpha is the weight of what is new",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v - alpha * (r + gamma * v_next - v),
        "the value moves away from the target: look at the sign",
    ),
]
WRONG_END: list[Rule] = [
    (
        lambda v, r, v_next, ended, alpha, gamma: v + alpha * (r + gamma * v_next - v),
        "where the episode has ended nothing follows: no next value belongs into the target there",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: v,
        "where the episode has ended you learn nothing: but the reward was real",
    ),
    (
        lambda v, r, v_next, ended, alpha, gamma: r,
        "where the episode has ended, too, only a step of size alpha leads to the target",
    ),
]
