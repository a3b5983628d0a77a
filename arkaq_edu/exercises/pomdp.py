"""Exercises of chapter 4: a plan of two steps, the best plan, a witness."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from arkaq_edu.exercises.belief import any_belief
from arkaq_edu.exercises.exercise import ExerciseError, Part, ask, exercise


def _plans_of_two_steps(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    cases = []
    for S, A, Z in rng.integers([2, 2, 2], [5, 4, 5], (20, 3)).tolist():
        T_a, O_a = rng.dirichlet(np.ones(S), S), rng.dirichlet(np.ones(Z), S)
        after = rng.integers(A, size=Z)
        after[0] = (after[1] + 1) % A  # otherwise the observation would not matter
        R, gamma = rng.uniform(-5, 5, (S, A)), float(rng.uniform(0.5, 0.95))
        cases.append((T_a, O_a, R, gamma, int(rng.integers(A)), after))
    return cases


@exercise(
    "Right: what is earned now, and what the branches earn from where the robot may end up.",
    "Work from the end: what does the second action earn, in the state it is taken in?",
    "In state t the rest earns (O_a * R[:, after]).sum(axis=1): each branch by its probability.",
    "Then R[:, a], plus gamma times what the rest earns from where T_a leads.",
    points=3,
    returns="one number for each state",
    cases=_plans_of_two_steps,
    wrong={
        "R[:, a]": "that is only the first action's reward: the plan has a second step",
        "two_steps(T_a, O_a, R, gamma, a, after) - R[:, a]": "that is what the second step earns: "
        "the first action's reward is missing",
        "two_steps(T_a, O_a, R, 1.0, a, after)": "all is there but the discount: what is earned "
        "later is multiplied by gamma",
        "gamma * two_steps(T_a, O_a, R, 1.0, a, after)": "discount only what comes later",
        "two_steps(np.eye(len(R)), O_a, R, gamma, a, after)": "the state has not moved: T says "
        "where the first action leads, and there the rest begins",
        "two_steps(T_a.T, O_a, R, gamma, a, after)": "you go backwards through T: T_a[s, t] leads "
        "from s to t, and the sum runs over t",
        "R[:, a] + gamma * (O_a * (T_a @ R[:, after])).sum(1)": "you observe before the state has "
        "moved: O is for the state that the action has led to",
        "R[:, a] + gamma * (T_a @ O_a * R[:, after]).sum(1)": "the second reward is for the state "
        "at the start: by then the state has moved",
        "R[:, a] + gamma * T_a @ R[:, after].mean(axis=1)": "you treat all observations alike: "
        "multiply each branch by its probability in O",
        "R[:, a] + gamma * T_a @ R[:, after].sum(axis=1)": "you treat all observations alike: "
        "multiply each branch by its probability in O",
        "R[:, a] + gamma * T_a @ R.max(axis=1)": "you take the best second action in each state: "
        "but the plan says which action follows, and the robot does not see the state",
    },
)
def two_steps(T_a, O_a, R, gamma, a, after):
    """Return what a plan of two steps earns from each state.

    Thesis, section 2.3.4, equations 2.18 and 2.19.
    """
    rest = (O_a * R[:, after]).sum(axis=1)
    return R[:, a] + gamma * T_a @ rest


def _plans(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    return [
        (any_belief(rng, S), rng.uniform(-5, 5, (K, S)), rng.permutation(K) + 1)
        for S, K in rng.integers([2, 5], [5, 9], (20, 2)).tolist()
    ]


@exercise(
    "Right: the best of the plans, and of that plan the first action.",
    "First compute what each plan earns at the belief: one number for each row of alphas.",
    "values = alphas @ b. The value of the belief is the largest of them.",
    "values.argmax() is the number of the best plan: look up its action in actions.",
    points=3,
    returns=("value", "action"),
    cases=_plans,
    of="value",
    wrong={
        "(alphas @ b).min()": "that is the worst plan",
        "alphas.max(axis=0) @ b": "you take the best plan for each state, as if the robot saw the "
        "state: it needs one plan for all of them",
        "alphas[:, b.argmax()].max()": "you treat the likeliest state as certain",
        "alphas.max()": "that is the best that could happen: multiply each state by its belief",
        "(alphas @ b).mean()": "that is the mean over the plans: the robot may choose",
        "alphas.mean(axis=1).max()": "you treat all states alike: multiply each by its belief",
        "actions[(alphas @ b).argmax()]": "the value comes first, the action second",
    },
    then=(
        Part(
            of="action",
            wrong={
                "(alphas @ b).argmax()": "that is the number of the plan: its action is in "
                "`actions`",
                "actions[alphas[:, b.argmax()].argmax()]": "that is for the likeliest state alone",
                "actions.max()": "that is the greatest number in `actions`: take that of the best "
                "plan",
            },
        ),
    ),
)
def best(b, alphas, actions):
    """Return the value of a belief, and what to do there.

    Thesis, section 2.3.4, equation 2.23.
    """
    values = alphas @ b
    return values.max(), actions[values.argmax()]


def _rivals(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    plans = [rng.uniform(-5, 5, shape) for shape in rng.integers([3, 2], [7, 5], (20, 2))]
    return [(any_belief(rng, vectors.shape[1]), vectors[0], vectors[1:]) for vectors in plans]


def _how_much(function: Callable[..., Any], *case: Any) -> Any:
    answer = ask(function, *case)
    if isinstance(answer, bool | np.bool_):
        raise ExerciseError("say by how much the plan is ahead, not only whether it is")
    return answer


@exercise(
    "Right: where the lead is above 0 the belief is a witness, and the plan is needed.",
    "What does the plan earn at this belief, and what does each of the others earn there?",
    "The others earn others @ b. Only the best of them matters.",
    "Subtract: b @ alpha minus the largest of others @ b.",
    cases=_rivals,
    answer=_how_much,
    wrong={
        "-lead(b, alpha, others)": "the sign is wrong: a plan that is ahead has a lead above 0",
        "b @ alpha - (others @ b).min()": "you compare with the worst of the others: to be needed "
        "the plan must beat the best of them",
        "b @ alpha - (others @ b).mean()": "you compare with the mean of the others: to be needed "
        "the plan must beat the best of them",
        "b @ (alpha - others.max(axis=0))": "you give each state its own rival: first what each "
        "plan earns at the belief, then the best of them",
        "(alpha - others).min()": "the belief is never used: compute the lead at this belief",
        "b @ alpha": "that is what the plan earns: subtract what the best of the others earns",
        "(others @ b).max()": "that is what the best of the others earns: how far ahead is the "
        "plan?",
    },
)
def lead(b, alpha, others):
    """Return how much more a plan earns at a belief than the best of the others.

    Thesis, section 2.3.6.
    """
    return b @ alpha - (others @ b).max()
