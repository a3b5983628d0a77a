"""Checks for the notebook on value functions: a plan of two steps, the best plan, a witness."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, judge, numbers
from arkaq_edu.exercises.belief import any_belief

Rng = np.random.Generator | int | None
Floats = NDArray[np.float64]

VALUED = "Right: what is earned now, and what the branches earn from where the robot may end up."
CHOSEN = "Right: the best of the plans, and of that plan the first action."
LED = "Right: where the lead is above 0 the belief is a witness, and the plan is needed."


def check_two_steps(two_steps: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``two_steps(T_a, O_a, R, gamma, a, after)``: the vector of a policy tree.

    Parameters
    ----------
    two_steps : callable
        Takes the transitions of the first action, shape (S, S), and its observations, shape (S, Z),
        the rewards, shape (S, A), the discount, the first action, and the action after each
        observation, shape (Z,); returns what the plan earns from each state, shape (S,).
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
    Thesis, section 2.3.4, equations 2.18 and 2.19.

    Examples
    --------
    >>> check_two_steps(lambda T_a, O_a, R, gamma, a, after: R[:, a])
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: that is the first action's reward alone: the plan has \
a second step
    """
    rng = np.random.default_rng(rng)
    cases = []
    for S, A, Z in rng.integers([2, 2, 2], [5, 4, 5], (20, 3)).tolist():
        T_a, O_a = rng.dirichlet(np.ones(S), S), rng.dirichlet(np.ones(Z), S)
        after = rng.integers(A, size=Z)
        after[0] = (after[1] + 1) % A  # otherwise it would not matter what is observed
        R, gamma = rng.uniform(-5, 5, (S, A)), float(rng.uniform(0.5, 0.95))
        cases.append((T_a, O_a, R, gamma, int(rng.integers(A)), after))
    judge("two_steps", two_steps, cases, _two_steps, WRONG_TWO_STEPS)
    return VALUED


def check_best(best: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``best(b, alphas, actions)``: the value of a belief and what to do there.

    Parameters
    ----------
    best : callable
        Takes a belief, shape (S,), the vectors of some plans, shape (K, S), and their first
        actions, shape (K,); returns the value of the best plan and its action.
    rng : numpy.random.Generator or int, optional
        Where the random beliefs and plans come from.

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
    Thesis, section 2.3.4, equation 2.23.

    Examples
    --------
    >>> check_best(lambda b, alphas, actions: ((alphas @ b).max(), (alphas @ b).argmax()))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: the value is right; but you return the number of the \
plan: its action stands in `actions`
    """
    rng = np.random.default_rng(rng)
    cases = []
    for S, K in rng.integers([2, 5], [5, 9], (20, 2)).tolist():
        alphas = rng.uniform(-5, 5, (K, S))
        cases.append((any_belief(rng, S), alphas, rng.permutation(K) + 1))
    found = np.array([numbers("best", ask(best, *case), (2,)) for case in cases])

    def given(column: int) -> Callable[..., float]:
        answers = iter(found[:, column].tolist())
        return lambda *_: next(answers)

    judge("the value of best", given(0), cases, _value, WRONG_VALUE)
    judge("the action of best", given(1), cases, _action, WRONG_ACTION)
    return CHOSEN


def check_lead(lead: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``lead(b, alpha, others)``: how far a plan is ahead of others at a belief.

    Parameters
    ----------
    lead : callable
        Takes a belief, shape (S,), the vector of a plan, shape (S,), and those of others, shape
        (K, S); returns how much more the plan earns there than the best of the others.
    rng : numpy.random.Generator or int, optional
        Where the random beliefs and plans come from.

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
    Thesis, section 2.3.6.

    Examples
    --------
    >>> check_lead(lambda b, alpha, others: (b @ (alpha - others).T).max())
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you compare with the worst of the others: to be needed \
the plan must beat the best of them
    """
    rng = np.random.default_rng(rng)
    cases = []
    for S, K in rng.integers([2, 3], [5, 7], (20, 2)).tolist():
        vectors = rng.uniform(-5, 5, (K, S))
        cases.append((any_belief(rng, S), vectors[0], vectors[1:]))
    if isinstance(ask(lead, *cases[0]), bool | np.bool_):
        raise ExerciseError("say by how much the plan is ahead, not only whether it is")
    judge("lead", lead, cases, _lead, WRONG_LEAD)
    return LED


def _two_steps(T_a: Floats, O_a: Floats, R: Floats, gamma: float, a: int, after: Any) -> Floats:
    return R[:, a] + gamma * T_a @ (O_a * R[:, after]).sum(axis=1)


# What is often done instead, and what to say of it.
WRONG_TWO_STEPS: list[Rule] = [
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a],
        "that is the first action's reward alone: the plan has a second step",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: gamma * T_a @ (O_a * R[:, after]).sum(axis=1),
        "that is what the second step earns: the first action's reward is missing",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: _two_steps(T_a, O_a, R, 1.0, a, after),
        "all is there but the discount: what is earned later counts gamma of what is earned now",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: gamma * _two_steps(T_a, O_a, R, 1.0, a, after),
        "only what comes later is discounted, not the first reward",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a] + gamma * (O_a * R[:, after]).sum(axis=1),
        "the state has not moved: T says where the first action leads, and there the rest begins",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: (
            R[:, a] + gamma * T_a.T @ (O_a * R[:, after]).sum(axis=1)
        ),
        "you go backwards through T: T_a[s, t] leads from s to t, and the sum runs over t",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a] + gamma * (O_a * (T_a @ R[:, after])).sum(1),
        "you observe before the state has moved: O is for the state that the action has led to",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a] + gamma * ((T_a @ O_a) * R[:, after]).sum(1),
        "the second reward is for the state at the start: by then the state has moved",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a] + gamma * T_a @ R[:, after].mean(axis=1),
        "you treat all observations alike: weigh each branch by how likely it is, which O says",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a] + gamma * T_a @ R[:, after].sum(axis=1),
        "you treat all observations alike: weigh each branch by how likely it is, which O says",
    ),
    (
        lambda T_a, O_a, R, gamma, a, after: R[:, a] + gamma * T_a @ R.max(axis=1),
        "you take the best second action in each state: the plan says which one is taken, and the "
        "robot does not see the state",
    ),
]


def _value(b: Floats, alphas: Floats, actions: Any) -> float:
    return float((alphas @ b).max())


def _action(b: Floats, alphas: Floats, actions: Any) -> float:
    return float(actions[(alphas @ b).argmax()])


WRONG_VALUE: list[Rule] = [
    (
        lambda b, alphas, actions: (alphas @ b).min(),
        "that is the worst plan",
    ),
    (
        lambda b, alphas, actions: alphas.max(axis=0) @ b,
        "you take the best plan for each state, as if the state could be seen: one plan has to do "
        "for all of them",
    ),
    (
        lambda b, alphas, actions: alphas[:, b.argmax()].max(),
        "you take the likeliest state for certain",
    ),
    (
        lambda b, alphas, actions: alphas.max(),
        "that is the best that could happen: weigh the states by the belief",
    ),
    (
        lambda b, alphas, actions: (alphas @ b).mean(),
        "that is the mean over the plans: the robot may choose",
    ),
    (
        lambda b, alphas, actions: alphas.mean(axis=1).max(),
        "you treat all states alike: weigh them by the belief",
    ),
    (
        lambda b, alphas, actions: actions[(alphas @ b).argmax()],
        "the value comes first, the action second",
    ),
]
WRONG_ACTION: list[Rule] = [
    (
        lambda b, alphas, actions: (alphas @ b).argmax(),
        "the value is right; but you return the number of the plan: its action stands in `actions`",
    ),
    (
        lambda b, alphas, actions: actions[alphas[:, b.argmax()].argmax()],
        "the value is right; but the action is that for the likeliest state",
    ),
    (
        lambda b, alphas, actions: actions.max(),
        "the value is right; but the action is the greatest number in `actions`: take that of the "
        "best plan",
    ),
]


def _lead(b: Floats, alpha: Floats, others: Floats) -> float:
    return float(b @ alpha - (others @ b).max())


WRONG_LEAD: list[Rule] = [
    (
        lambda b, alpha, others: -_lead(b, alpha, others),
        "the sign is turned round: a plan that is ahead has a lead above 0",
    ),
    (
        lambda b, alpha, others: b @ alpha - (others @ b).min(),
        "you compare with the worst of the others: to be needed the plan must beat the best of "
        "them",
    ),
    (
        lambda b, alpha, others: b @ alpha - (others @ b).mean(),
        "you compare with the mean of the others: to be needed the plan must beat the best of them",
    ),
    (
        lambda b, alpha, others: b @ (alpha - others.max(axis=0)),
        "you give each state its own rival: first what each plan earns at the belief, then the "
        "best of them",
    ),
    (
        lambda b, alpha, others: (alpha - others).min(),
        "the belief is never used: the lead is that at one belief",
    ),
    (
        lambda b, alpha, others: b @ alpha,
        "that is what the plan earns: subtract what the best of the others does",
    ),
    (
        lambda b, alpha, others: (others @ b).max(),
        "that is what the best of the others earns: how far is the plan ahead of it?",
    ),
]
