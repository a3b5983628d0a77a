"""The checks of the belief exercises: right answers pass, wrong ones are told in what way."""

import numpy as np
import pytest

from arkaq_edu.exercises import (
    ExerciseError,
    check_chances,
    check_correct,
    check_expected_reward,
    check_predict,
)


def predict(b, T):
    return [sum(b[s] * T[s, t] for s in range(len(b))) for t in range(len(b))]


def correct(b, likelihood):
    weights = np.array([p * q for p, q in zip(b, likelihood, strict=True)])
    return weights / sum(weights)


def chances(b, T, O_a):
    return np.einsum("s,st,tz->z", b, T, O_a)


def expected_reward(b, R):
    return [sum(p * r for p, r in zip(b, column, strict=True)) for column in R.T]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("check", "answer"),
    [
        (check_predict, predict),
        (check_correct, correct),
        (check_chances, chances),
        (check_expected_reward, expected_reward),
    ],
)
def test_a_right_answer_is_praised(check, answer, seed):
    assert check(answer, rng=seed).startswith("Right")


def not_written(*_):
    raise NotImplementedError


def in_place(b, likelihood):
    b *= likelihood
    return b / b.sum()


def normed(weights):
    return weights / weights.sum()


WRONG = [
    (check_predict, lambda b, T: T @ b, "backwards"),
    (check_predict, lambda b, T: (T * b).sum(axis=1), "backwards"),
    (check_predict, lambda b, T: b, "not moved"),
    (check_predict, lambda b, T: (b[:, np.newaxis] * T).sum(axis=1), "not moved"),
    (check_predict, lambda b, T: (b * T).sum(axis=0), "columns"),
    (check_predict, lambda b, T: T[np.argmax(b)], "likeliest state alone"),
    (check_predict, lambda b, T: T.mean(axis=0), "all starts alike"),
    (check_predict, lambda b, T: T.sum(axis=0), "all starts alike"),
    (check_predict, lambda b, T: b * np.diag(T), "stay where they are"),
    (check_predict, lambda b, T: b[:, np.newaxis] * T, r"shape \(\d,\), not \(\d, \d\)"),
    (check_predict, lambda b, T: 2 * (b @ T), "too large"),
    (check_predict, lambda b, T: b @ T / 2, "too small"),
    (check_predict, not_written, "still empty"),
    (check_predict, lambda b, T: None, "return"),
    (check_predict, lambda b, T: T[len(b)], "stopped with IndexError"),
    (check_correct, lambda b, seen: b * seen, "sums to 1"),
    (check_correct, lambda b, seen: b * seen / max(b * seen), "largest 1"),
    (check_correct, lambda b, seen: b * seen / np.sqrt(((b * seen) ** 2).sum()), "length 1"),
    (check_correct, lambda b, seen: normed(seen), "observation alone"),
    (check_correct, lambda b, seen: seen, "observation alone"),
    (check_correct, lambda b, seen: b, "changes nothing"),
    (check_correct, lambda b, seen: normed(b + seen), "you add"),
    (check_correct, lambda b, seen: (b + seen) / 2, "middle"),
    (check_correct, lambda b, seen: normed(b * b * seen), "belief is counted twice"),
    (check_correct, lambda b, seen: normed(b * seen**2), "observation is counted twice"),
    (check_correct, lambda b, seen: normed(b * (1 - seen)), "not observed"),
    (check_correct, lambda b, seen: normed(b / seen), "divide by the likelihood"),
    (check_correct, lambda b, seen: 1.0 * (b * seen == max(b * seen)), "forget the others"),
    (check_correct, lambda b, seen: (b * seen).sum(), r"shape \(\d,\), not \(\)"),
    (check_correct, lambda b, seen: b / 0 * 0, "not all of it is a number"),
    (check_correct, lambda b, seen: correct(b, seen) + 1, "too large"),
    (check_correct, in_place, "copy"),
    (check_chances, lambda b, T, O_a: b @ O_a, "first it acts"),
    (check_chances, lambda b, T, O_a: T @ b @ O_a, "backwards"),
    (check_chances, lambda b, T, O_a: O_a[np.argmax(b @ T)], "likeliest state alone"),
    (check_chances, lambda b, T, O_a: O_a.mean(axis=0), "all states alike"),
    (check_chances, lambda b, T, O_a: O_a.sum(axis=0), "all states alike"),
    (check_chances, lambda b, T, O_a: b @ T, r"shape \(\d,\), not \(\d,\)"),
    (check_chances, lambda b, T, O_a: 1 - chances(b, T, O_a), "is too"),
    (check_expected_reward, lambda b, R: R[np.argmax(b)], "for certain"),
    (check_expected_reward, lambda b, R: R.mean(axis=0), "all states alike"),
    (check_expected_reward, lambda b, R: R.sum(axis=0), "all states alike"),
    (check_expected_reward, lambda b, R: R.max(axis=0), "best state"),
    (check_expected_reward, lambda b, R: (b[:, np.newaxis] * R).mean(axis=0), "sum to 1 already"),
    (check_expected_reward, lambda b, R: (b @ R).max(), r"shape \(\d,\), not \(\)"),
    (check_expected_reward, lambda b, R: b @ R - 1, "too small"),
    (check_expected_reward, 3.0, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("check", "answer", "hint"), WRONG)
@pytest.mark.filterwarnings("ignore:(divide|invalid):RuntimeWarning")
def test_a_wrong_answer_is_told_what_is_wrong(check, answer, hint, seed):
    with pytest.raises(ExerciseError, match=hint):
        check(answer, rng=seed)
