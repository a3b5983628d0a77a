"""The checks of the exercises on value functions: right answers pass, wrong ones are told how."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises
from arkaq_edu.pomdp import POMDP, PolicyTree, ValueFunction, tree_value


def two_steps(T_a, O_a, R, gamma, a, after):
    actions = R.shape[1]  # the others' transitions and observations do not matter
    pomdp = POMDP([T_a] * actions, [O_a] * actions, R, gamma)
    return tree_value(pomdp, PolicyTree(a, tuple(PolicyTree(int(then)) for then in after)))


def best(b, alphas, actions):
    V = ValueFunction(alphas, actions, np.empty((len(alphas), 0), int))
    return V.value(b), V.action(b)


def lead(b, alpha, others):
    return min(b @ alpha - b @ other for other in others)


def other_value(value):
    return lambda *given: (value(*given), best(*given)[1])


def other_action(action):
    return lambda *given: (best(*given)[0], action(*given))


def not_written(*_):
    raise NotImplementedError


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [(exercises.two_steps, two_steps), (exercises.best, best), (exercises.lead, lead)],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def loops(T_a, O_a, R, gamma, a, after):
    """The sums of equation 2.19, one by one."""
    states = range(len(R))
    return [
        R[s, a]
        + gamma
        * sum(
            T_a[s, t] * sum(O_a[t, z] * R[t, then] for z, then in enumerate(after)) for t in states
        )
        for s in states
    ]


def test_a_list_from_loops_will_do():
    exercises.two_steps.check(loops, rng=0)


def later(T_a, O_a, R, a, after):
    return T_a @ (O_a * R[:, after]).sum(axis=1)


WRONG = [
    (exercises.two_steps, not_written, "still empty"),
    (exercises.two_steps, lambda T_a, O_a, R, g, a, f: R[:, a], "second step"),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: g * later(T_a, O_a, R, a, f),
        "first action's reward",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + later(T_a, O_a, R, a, f),
        "but the discount",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: g * two_steps_free(T_a, O_a, R, 1, a, f),
        "only",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + g * (O_a * R[:, f]).sum(1),
        "not moved",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: two_steps_free(T_a.T, O_a, R, g, a, f),
        "backwards",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + g * (O_a * (T_a @ R[:, f])).sum(1),
        "before the state has moved",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + g * ((T_a @ O_a) * R[:, f]).sum(1),
        "for the state at the start",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + g * T_a @ R[:, f].mean(1),
        "all observations alike",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + g * T_a @ R[:, f].sum(1),
        "all observations alike",
    ),
    (
        exercises.two_steps,
        lambda T_a, O_a, R, g, a, f: R[:, a] + g * T_a @ R.max(axis=1),
        "the plan says",
    ),
    (exercises.two_steps, lambda *given: two_steps(*given).sum(), "for each state.*not one"),
    (exercises.two_steps, lambda *given: two_steps(*given) + 1, "too large"),
    (exercises.best, not_written, "still empty"),
    (exercises.best, lambda b, alphas, actions: (alphas @ b).max(), "value and action, not one"),
    (exercises.best, other_value(lambda b, alphas, actions: (alphas @ b).min()), "worst plan"),
    (
        exercises.best,
        other_value(lambda b, alphas, actions: alphas.max(axis=0) @ b),
        "as if the robot saw",
    ),
    (exercises.best, other_value(lambda b, alphas, _: alphas[:, b.argmax()].max()), "likeliest"),
    (exercises.best, other_value(lambda b, alphas, actions: alphas.max()), "could happen"),
    (exercises.best, other_value(lambda b, alphas, actions: (alphas @ b).mean()), "may choose"),
    (exercises.best, other_value(lambda b, alphas, _: alphas.mean(axis=1).max()), "states alike"),
    (exercises.best, lambda *given: best(*given)[::-1], "first the value"),
    (
        exercises.best,
        other_action(lambda b, alphas, actions: (alphas @ b).argmax()),
        "number of the",
    ),
    (
        exercises.best,
        other_action(lambda b, alphas, actions: actions[alphas[:, b.argmax()].argmax()]),
        "for the likeliest state",
    ),
    (exercises.best, other_action(lambda b, alphas, actions: actions.max()), "greatest number"),
    (exercises.best, other_action(lambda *given: best(*given)[1] + 1), "too large"),
    (exercises.lead, not_written, "still empty"),
    (exercises.lead, lambda *given: -lead(*given), "sign"),
    (
        exercises.lead,
        lambda b, alpha, others: b @ alpha - (others @ b).min(),
        "worst of the others",
    ),
    (
        exercises.lead,
        lambda b, alpha, others: b @ alpha - (others @ b).mean(),
        "mean of the others",
    ),
    (exercises.lead, lambda b, alpha, others: b @ (alpha - others.max(axis=0)), "own rival"),
    (exercises.lead, lambda b, alpha, others: (alpha - others).min(), "never used"),
    (exercises.lead, lambda b, alpha, others: b @ alpha, "what the plan earns"),
    (exercises.lead, lambda b, alpha, others: (others @ b).max(), "how far"),
    (exercises.lead, lambda *given: lead(*given) > 0, "by how much"),
    (exercises.lead, lambda b, alpha, others: others @ b - b @ alpha, "one number, not"),
    (exercises.lead, lambda b, alpha, others: alpha.sort(), "returned nothing"),
]


def two_steps_free(T_a, O_a, R, gamma, a, after):
    return R[:, a] + gamma * T_a @ (O_a * R[:, after]).sum(axis=1)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))
