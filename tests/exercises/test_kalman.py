"""The checks of the Kalman exercises: right answers pass, wrong ones are told in what way."""

import numpy as np
import pytest

from arkaq_edu.exercises import ExerciseError, check_combine, check_nis, check_turn


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
    ("check", "answer"), [(check_combine, combine), (check_turn, turn), (check_nis, nis)]
)
def test_a_right_answer_is_praised(check, answer, seed):
    assert check(answer, rng=seed).startswith("Right")


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
    (check_combine, mean_of(lambda a, va, b, vb: (a + b) / 2), "middle"),
    (check_combine, mean_of(lambda a, va, b, vb: (a * va + b * vb) / (va + vb)), "worse ruler"),
    (check_combine, mean_of(lambda a, va, b, vb: combine(a, va**0.5, b, vb**0.5)[0]), "deviations"),
    (check_combine, mean_of(lambda a, va, b, vb: a / va + b / vb), "sum to 1"),
    (check_combine, mean_of(lambda a, va, b, vb: a if va < vb else b), "throw the other away"),
    (check_combine, mean_of(lambda a, va, b, vb: combine(a, va, b, vb)[0] + 1), "too large"),
    (check_combine, mean_of(lambda a, va, b, vb: combine(a, va, b, vb)[0] - 1), "too small"),
    (check_combine, variance_of(lambda a, va, b, vb: va + vb), "add up"),
    (check_combine, variance_of(lambda a, va, b, vb: (va + vb) / 2), "half way"),
    (check_combine, variance_of(lambda a, va, b, vb: (va + vb) / 4), "plain average"),
    (check_combine, variance_of(lambda a, va, b, vb: min(va, vb)), "better one alone"),
    (check_combine, variance_of(lambda a, va, b, vb: 1 / va + 1 / vb), "turn the sum over"),
    (check_combine, variance_of(lambda *g: combine(*g)[1] ** 0.5), "standard deviation"),
    (check_combine, variance_of(lambda *g: 2 * combine(*g)[1]), "variance is right in 0 of 20"),
    (check_combine, lambda a, va, b, vb: combine(a, va, b, vb)[0], r"shape \(2,\), not \(\)"),
    (check_combine, not_written, "still empty"),
    (check_combine, lambda *_: None, "return"),
    (check_turn, lambda x, P, u, z, Q, R: (x + u, P + Q), "prediction alone"),
    (check_turn, estimate_of(lambda x, P, u, z, Q, R: z), "sighting alone"),
    (check_turn, estimate_of(lambda x, P, u, z, Q, R: turn(x, P, 0, z, Q, R)[0]), "forget the"),
    (check_turn, estimate_of(lambda x, P, u, z, Q, R: turn(x, P, -u, z, Q, R)[0]), "taken off"),
    (check_turn, estimate_of(lambda x, P, u, z, Q, R: turn(x, P, u, z, 0, R)[0]), "old variance"),
    (
        check_turn,
        estimate_of(lambda x, P, u, z, Q, R: x + u + gain(R, P + Q) * (z - x - u)),
        "trust in the prediction",
    ),
    (
        check_turn,
        estimate_of(lambda x, P, u, z, Q, R: x + u - gain(P + Q, R) * (z - x - u)),
        "leads away",
    ),
    (
        check_turn,
        estimate_of(lambda x, P, u, z, Q, R: x + u + gain(P + Q, R) * (z - x)),
        "not less the old",
    ),
    (check_turn, left_over(lambda x, P, u, z, Q, R: P + Q), "as if nothing"),
    (check_turn, left_over(lambda x, P, u, z, Q, R: P), "never changes"),
    (check_turn, left_over(lambda x, P, u, z, Q, R: gain(P + Q, R) * (P + Q)), "what is left"),
    (check_turn, left_over(lambda x, P, u, z, Q, R: (1 - gain(P + Q, R)) * P), "of the old"),
    (check_turn, blind(lambda x, P, u, Q: (x + u, P)), "a step adds Q"),
    (check_turn, blind(lambda x, P, u, Q: (x, P + Q)), "nothing to correct by"),
    (check_turn, lambda x, P, u, z, Q, R: combine(x + u, P + Q, z, R), "stopped with TypeError"),
    (check_nis, lambda v, S: v @ v, "never use S"),
    (check_nis, lambda v, S: v @ S @ v, "multiply by S"),
    (check_nis, lambda v, S: nis(v, S) ** 0.5, "root"),
    (check_nis, lambda v, S: (v**2 / np.diag(S)).sum(), "diagonal"),
    (check_nis, lambda v, S: nis(v, S) / len(v), "how many"),
    (check_nis, lambda v, S: np.linalg.inv(S) @ v, r"shape \(\), not"),
    (check_nis, lambda v, S: -nis(v, S), "too small"),
    (check_nis, in_place, "copy"),
    (check_nis, 3.0, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("check", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(check, answer, hint, seed):
    with pytest.raises(ExerciseError, match=hint):
        check(answer, rng=seed)
