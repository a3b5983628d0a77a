"""Exercises of chapter 4: a plan of two steps, the best plan, a witness."""

from typing import Any

import numpy as np

from arkaq_edu.exercises.belief import any_belief
from arkaq_edu.exercises.exercise import Draws, ExerciseError, Part, Rule, ask, exercise, judgement


def _plans_of_two_steps(rng: np.random.Generator) -> Draws:
    cases = []
    for S, A, Z in rng.integers([2, 2, 2], [5, 4, 5], (20, 3)).tolist():
        T_a, O_a = rng.dirichlet(np.ones(S), S), rng.dirichlet(np.ones(Z), S)
        after = rng.integers(A, size=Z)
        after[0] = (after[1] + 1) % A  # otherwise the observation would not matter
        R, gamma = rng.uniform(-5, 5, (S, A)), float(rng.uniform(0.5, 0.95))
        cases.append((T_a, O_a, R, gamma, int(rng.integers(A)), after))
    return cases


@exercise(Part(_plans_of_two_steps))
def two_steps(T_a, O_a, R, gamma, a, after):
    """Return what a plan of two steps earns from each state.

    Thesis, section 2.3.4, equations 2.18 and 2.19.
    """
    rest = (O_a * R[:, after]).sum(axis=1)
    return R[:, a] + gamma * T_a @ rest


def _plans(rng: np.random.Generator) -> Draws:
    return [
        (any_belief(rng, S), rng.uniform(-5, 5, (K, S)), rng.permutation(K) + 1)
        for S, K in rng.integers([2, 5], [5, 9], (20, 2)).tolist()
    ]


@exercise(value=Part(_plans), action=Part())
def best(b, alphas, actions):
    """Return the value of a belief, and what to do there.

    Thesis, section 2.3.4, equation 2.23.
    """
    values = alphas @ b
    return values.max(), actions[values.argmax()]


def _rivals(rng: np.random.Generator) -> Draws:
    plans = [rng.uniform(-5, 5, shape) for shape in rng.integers([3, 2], [7, 5], (20, 2))]
    return [(any_belief(rng, vectors.shape[1]), vectors[0], vectors[1:]) for vectors in plans]


def _how_much(function: Rule, *case: Any) -> Any:
    answer = ask(function, *case)
    if isinstance(answer, bool | np.bool_):
        raise ExerciseError("say by how much the plan is ahead, not only whether it is")
    return answer


@exercise(Part(_rivals, answer=_how_much))
def lead(b, alpha, others):
    """Return how much more a plan earns at a belief than the best of the others.

    Thesis, section 2.3.6.
    """
    return b @ alpha - (others @ b).max()


@exercise(judgement(4))
def worth_a_look():
    """Return the number of the right answer."""
    return 2
