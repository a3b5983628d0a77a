"""The checks of the Kalman exercises: right answers pass, wrong ones are told in what way."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises


def combine(a, va, b, vb):
    precision = 1 / va + 1 / vb
    return (a / va + b / vb) / precision, 1 / precision


def turn(x, P, u, z, Q, R):
    x, P = x + u, P + Q
    return (x, P) if z is None else combine(x, P, z, R)


def nis(v, S):
    return np.linalg.multi_dot([v, np.linalg.inv(S), v])


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [(exercises.combine, combine), (exercises.turn, turn), (exercises.nis, nis)],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def mean_of(mean):
    return lambda *given: (mean(*given), combine(*given)[1])


def variance_of(variance):
    return lambda *given: (combine(*given)[0], variance(*given))


def estimate_of(estimate):
    return lambda *given: (estimate(*given), turn(*given)[1])


def left_over(variance):
    return lambda *given: (turn(*given)[0], variance(*given))


def gain(P, R):
    return P / (P + R)


def blind(answer):
    """Right with a sighting, `answer(x, P, u, Q)` without."""
    return lambda x, P, u, z, Q, R: answer(x, P, u, Q) if z is None else turn(x, P, u, z, Q, R)


def not_written(*_):
    raise NotImplementedError


def in_place(v, S):
    S /= 2
    return nis(v, S)


WRONG = [
    (exercises.combine, mean_of(lambda a, va, b, vb: (a + b) / 2), "middle"),
    (exercises.combine, mean_of(lambda a, va, b, vb: (a * va + b * vb) / (va + vb)), "worse ruler"),
    (
        exercises.combine,
        mean_of(lambda a, va, b, vb: combine(a, va**0.5, b, vb**0.5)[0]),
        "deviations",
    ),
    (exercises.combine, mean_of(lambda a, va, b, vb: a / va + b / vb), "sum to 1"),
    (exercises.combine, mean_of(lambda a, va, b, vb: a if va < vb else b), "throw the other away"),
    (exercises.combine, mean_of(lambda a, va, b, vb: combine(a, va, b, vb)[0] + 1), "too large"),
    (exercises.combine, mean_of(lambda a, va, b, vb: combine(a, va, b, vb)[0] - 1), "too small"),
    (exercises.combine, variance_of(lambda a, va, b, vb: va + vb), "added up"),
    (exercises.combine, variance_of(lambda a, va, b, vb: (va + vb) / 2), "halfway"),
    (exercises.combine, variance_of(lambda a, va, b, vb: (va + vb) / 4), "plain average"),
    (exercises.combine, variance_of(lambda a, va, b, vb: min(va, vb)), "better one alone"),
    (exercises.combine, variance_of(lambda a, va, b, vb: 1 / va + 1 / vb), "take 1 over it"),
    (exercises.combine, variance_of(lambda *g: combine(*g)[1] ** 0.5), "standard deviation"),
    (exercises.combine, variance_of(lambda *g: 2 * combine(*g)[1]), "variance is right in 0 of 20"),
    (
        exercises.combine,
        lambda a, va, b, vb: combine(a, va, b, vb)[0],
        "two numbers: .*not one",
    ),
    (exercises.combine, not_written, "still empty"),
    (exercises.combine, lambda *_: None, "return"),
    (exercises.turn, lambda x, P, u, z, Q, R: (x + u, P + Q), "prediction alone"),
    (exercises.turn, estimate_of(lambda x, P, u, z, Q, R: z), "sighting alone"),
    (exercises.turn, estimate_of(lambda x, P, u, z, Q, R: turn(x, P, 0, z, Q, R)[0]), "forget the"),
    (
        exercises.turn,
        estimate_of(lambda x, P, u, z, Q, R: turn(x, P, -u, z, Q, R)[0]),
        "you subtract",
    ),
    (
        exercises.turn,
        estimate_of(lambda x, P, u, z, Q, R: turn(x, P, u, z, 0, R)[0]),
        "old variance",
    ),
    (
        exercises.turn,
        estimate_of(lambda x, P, u, z, Q, R: x + u + gain(R, P + Q) * (z - x - u)),
        "trust in the prediction",
    ),
    (
        exercises.turn,
        estimate_of(lambda x, P, u, z, Q, R: x + u - gain(P + Q, R) * (z - x - u)),
        "leads away",
    ),
    (
        exercises.turn,
        estimate_of(lambda x, P, u, z, Q, R: x + u + gain(P + Q, R) * (z - x)),
        "not minus the old",
    ),
    (exercises.turn, left_over(lambda x, P, u, z, Q, R: P + Q), "as if nothing"),
    (exercises.turn, left_over(lambda x, P, u, z, Q, R: P), "never changes"),
    (exercises.turn, left_over(lambda x, P, u, z, Q, R: gain(P + Q, R) * (P + Q)), "what is left"),
    (exercises.turn, left_over(lambda x, P, u, z, Q, R: (1 - gain(P + Q, R)) * P), "of the old"),
    (exercises.turn, blind(lambda x, P, u, Q: (x + u, P)), "a step adds Q"),
    (exercises.turn, blind(lambda x, P, u, Q: (x, P + Q)), "nothing can be corrected"),
    (
        exercises.turn,
        lambda x, P, u, z, Q, R: combine(x + u, P + Q, z, R),
        "stopped with TypeError",
    ),
    (exercises.nis, lambda v, S: v @ v, "never use S"),
    (exercises.nis, lambda v, S: v @ S @ v, "multiply by S"),
    (exercises.nis, lambda v, S: nis(v, S) ** 0.5, "root"),
    (exercises.nis, lambda v, S: (v**2 / np.diag(S)).sum(), "diagonal"),
    (exercises.nis, lambda v, S: nis(v, S) / len(v), "how many"),
    (exercises.nis, lambda v, S: np.linalg.inv(S) @ v, "once more"),
    (exercises.nis, lambda v, S: np.linalg.inv(S), "one number, not"),
    (exercises.nis, lambda v, S: v @ v / S, "by itself"),
    (exercises.nis, lambda v, S: sum(v / S @ v), "by itself"),
    (exercises.combine, lambda *given: combine(*given)[::-1], "first the mean, then the variance"),
    (exercises.turn, lambda *given: turn(*given)[::-1], "first the estimate, then the variance"),
    (exercises.turn, lambda x, P, u, z, Q, R: turn(x, P, u, z, Q**2, R**2), "you square Q and R"),
    (exercises.turn, lambda x, P, u, z, Q, R: turn(x, P, u, z, Q, R**2), "you square R"),
    (exercises.turn, lambda x, P, u, z, Q, R: turn(x, P, u, z, Q**0.5, R**0.5), "take the roots"),
    (exercises.turn, lambda x, P, u, z, Q, R: turn(x, P, u, z or None, Q, R), "`if z is None`"),
    (exercises.nis, lambda v, S: -nis(v, S), "too small"),
    (exercises.nis, in_place, "copy"),
    (exercises.nis, 3.0, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))
