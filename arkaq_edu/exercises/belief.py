"""Checks for the notebook on belief states: predict, correct, what will be seen and earned."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import Rule, judge

Rng = np.random.Generator | int | None
Floats = NDArray[np.float64]


def check_predict(predict: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``predict(b, T_a)``: the belief after an action, before a look.

    Parameters
    ----------
    predict : callable
        Takes a belief, shape (S,), and the transitions of one action, shape (S, S), from row to
        column; returns the belief after it, shape (S,).
    rng : numpy.random.Generator or int, optional
        Where the random beliefs and transitions come from.

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
    Thesis, section 2.3.2: the sum in equation 2.15.

    Examples
    --------
    >>> check_predict(lambda b, T: T @ b)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you go backwards: T[s, t] leads from s to t, and the \
sum runs over s, where the robot comes from
    """
    rng = np.random.default_rng(rng)
    cases = [(any_belief(rng, n), rng.dirichlet(np.ones(n), n)) for n in _sizes(rng)]
    judge("predict", predict, cases, lambda b, T: b @ T, WRONG_PREDICT)
    return "Right: every way there counts, weighed by how likely the robot was at its start."


def check_correct(correct: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``correct(b, likelihood)``: Bayes' rule, after a look.

    Parameters
    ----------
    correct : callable
        Takes a belief, shape (S,), and how likely each state would have shown what was observed,
        shape (S,); returns the belief after it, shape (S,).
    rng : numpy.random.Generator or int, optional
        Where the random beliefs and likelihoods come from.

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
    Thesis, section 2.3.2, equations 2.14 and 2.15.

    Examples
    --------
    >>> check_correct(lambda b, likelihood: b * likelihood)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: the proportions are right, but a belief sums to 1: \
divide by the sum
    """
    rng = np.random.default_rng(rng)
    cases = [(any_belief(rng, n), rng.uniform(0.05, 0.95, n)) for n in _sizes(rng)]
    judge("correct", correct, cases, lambda b, seen: _normed(b * seen), WRONG_CORRECT)
    return "Right: what was believed times what was seen, and made to sum to 1 again."


def check_chances(chances: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``chances(b, T_a, O_a)``: how likely each observation is.

    Parameters
    ----------
    chances : callable
        Takes a belief, shape (S,), the transitions of one action, shape (S, S), and its
        observations, shape (S, Z); returns Pr(z | b, a) of each z, shape (Z,).
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
    Thesis, sections 2.3.2 and 2.3.3: what stands below in equation 2.15 and in the sum of 2.16.

    Examples
    --------
    >>> check_chances(lambda b, T_a, O_a: b @ O_a)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you look from where the robot is now: first it acts, \
and O is for the state that the action has led to
    """
    rng = np.random.default_rng(rng)
    cases = []
    for n in _sizes(rng):
        T, O_a = rng.dirichlet(np.ones(n), n), rng.dirichlet(np.ones(n + 1), n)
        cases.append((any_belief(rng, n), T, O_a))
    judge("chances", chances, cases, lambda b, T, O_a: b @ T @ O_a, WRONG_CHANCES)
    return "Right: first where the action may lead, then what may be seen from there."


def check_expected_reward(expected_reward: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``expected_reward(b, R)``: what each action earns, as far as is known.

    Parameters
    ----------
    expected_reward : callable
        Takes a belief, shape (S,), and rewards, shape (S, A); returns the reward expected for
        each action, shape (A,).
    rng : numpy.random.Generator or int, optional
        Where the random beliefs and rewards come from.

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
    Thesis, section 2.3.3, equation 2.17.

    Examples
    --------
    >>> check_expected_reward(lambda b, R: R[b.argmax()])
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you take the likeliest state for certain: the others \
earn something too, each with its probability
    """
    rng = np.random.default_rng(rng)
    cases = [(any_belief(rng, n), rng.uniform(-5, 10, (n, n + 1))) for n in _sizes(rng)]
    judge("expected_reward", expected_reward, cases, lambda b, R: b @ R, WRONG_REWARD)
    return "Right: a mean over what the state may be. It is the true expected reward."


# What is often done instead, and what to say of it.
WRONG_PREDICT: list[Rule] = [
    (
        lambda b, T: T @ b,
        "you go backwards: T[s, t] leads from s to t, and the sum runs over s, where the robot "
        "comes from",
    ),
    (
        lambda b, T: b,
        "the belief has not moved: the action changes the state, and so what is known of it",
    ),
    (
        lambda b, T: b * T.sum(axis=0),
        "your b weighs the columns of T, where the robot arrives: it belongs to the rows, where "
        "it starts",
    ),
    (
        lambda b, T: T[b.argmax()],
        "you go on from the likeliest state alone: the robot may have been in any of them",
    ),
    (
        lambda b, T: T.mean(axis=0),
        "you treat all starts alike: weigh each row of T by the belief",
    ),
    (
        lambda b, T: T.sum(axis=0),
        "you treat all starts alike: weigh each row of T by the belief",
    ),
    (
        lambda b, T: b * T.diagonal(),
        "you count only the robots that stay where they are",
    ),
]
WRONG_CORRECT: list[Rule] = [
    (
        lambda b, seen: b * seen,
        "the proportions are right, but a belief sums to 1: divide by the sum",
    ),
    (
        lambda b, seen: b * seen / (b * seen).max(),
        "the proportions are right, but you made the largest 1: a belief sums to 1",
    ),
    (
        lambda b, seen: b * seen / np.linalg.norm(b * seen),
        "the proportions are right, but you gave it length 1: a belief sums to 1",
    ),
    (
        lambda b, seen: _normed(seen),
        "you believe the observation alone: what was known before is thrown away",
    ),
    (
        lambda b, seen: seen,
        "you believe the observation alone: what was known before is thrown away",
    ),
    (
        lambda b, seen: b,
        "the observation changes nothing: states that seldom show it should lose",
    ),
    (
        lambda b, seen: _normed(b + seen),
        "you add: a state must have been likely before and likely to show this, so multiply",
    ),
    (
        lambda b, seen: (b + seen) / 2,
        "you take the middle: a state must have been likely before and likely to show this, so "
        "multiply",
    ),
    (
        lambda b, seen: _normed(b * b * seen),
        "the belief is counted twice",
    ),
    (
        lambda b, seen: _normed(b * seen * seen),
        "the observation is counted twice",
    ),
    (
        lambda b, seen: _normed(b * (1 - seen)),
        "you take the chance that it was not observed, and it was",
    ),
    (
        lambda b, seen: _normed(b / seen),
        "you divide by the likelihood: then the states that seldom show it would gain",
    ),
    (
        lambda b, seen: np.eye(len(b))[(b * seen).argmax()],
        "you keep the likeliest state and forget the others: they may be right after all",
    ),
]
WRONG_CHANCES: list[Rule] = [
    (
        lambda b, T, O_a: b @ O_a,
        "you look from where the robot is now: first it acts, and O is for the state that the "
        "action has led to",
    ),
    (
        lambda b, T, O_a: T @ b @ O_a,
        "you go backwards through T: T[s, t] leads from s to t, and the belief is over s",
    ),
    (
        lambda b, T, O_a: O_a[(b @ T).argmax()],
        "you look from the likeliest state alone: the robot may be in any of them",
    ),
    (
        lambda b, T, O_a: O_a.mean(axis=0),
        "you treat all states alike: weigh each row of O by how likely the action leads there",
    ),
    (
        lambda b, T, O_a: O_a.sum(axis=0),
        "you treat all states alike: weigh each row of O by how likely the action leads there",
    ),
]
WRONG_REWARD: list[Rule] = [
    (
        lambda b, R: R[b.argmax()],
        "you take the likeliest state for certain: the others earn something too, each with its "
        "probability",
    ),
    (
        lambda b, R: R.mean(axis=0),
        "you treat all states alike: weigh each by the belief",
    ),
    (
        lambda b, R: R.sum(axis=0),
        "you treat all states alike: weigh each by the belief",
    ),
    (
        lambda b, R: R.max(axis=0),
        "you hope for the best state: weigh each by the belief",
    ),
    (
        lambda b, R: (b @ R) / len(b),
        "the weights sum to 1 already: nothing is left to divide by",
    ),
]


def _sizes(rng: np.random.Generator) -> list[int]:
    return rng.integers(2, 6, 20).tolist()


def any_belief(rng: np.random.Generator, n: int) -> Floats:
    """Return a belief in which nothing is impossible."""
    return _normed(rng.uniform(0.1, 1, n))


def _normed(weights: Floats) -> Floats:
    return weights / weights.sum()
