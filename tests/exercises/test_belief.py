"""The checks of the belief exercises: right answers pass, wrong ones are told in what way."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises


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
    ("exercise", "answer"),
    [
        (exercises.predict, predict),
        (exercises.correct, correct),
        (exercises.observation_chances, chances),
        (exercises.expected_reward, expected_reward),
    ],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def not_written(*_):
    raise NotImplementedError


def in_place(b, likelihood):
    b *= likelihood
    return b / b.sum()


def normed(weights):
    return weights / weights.sum()


WRONG = [
    (exercises.predict, lambda b, T: T @ b, "backwards"),
    (exercises.predict, lambda b, T: (T * b).sum(axis=1), "backwards"),
    (exercises.predict, lambda b, T: b, "not moved"),
    (exercises.predict, lambda b, T: (b[:, np.newaxis] * T).sum(axis=1), "not moved"),
    (exercises.predict, lambda b, T: (b * T).sum(axis=0), "columns"),
    (exercises.predict, lambda b, T: T[np.argmax(b)], "likeliest state alone"),
    (exercises.predict, lambda b, T: T.mean(axis=0), "all starts alike"),
    (exercises.predict, lambda b, T: T.sum(axis=0), "all starts alike"),
    (exercises.predict, lambda b, T: b * np.diag(T), "stay where they are"),
    (
        exercises.predict,
        lambda b, T: b[:, np.newaxis] * T,
        r"not \d rows of \d numbers",
    ),
    (exercises.predict, lambda b, T: 2 * (b @ T), "too large"),
    (exercises.predict, lambda b, T: b @ T / 2, "too small"),
    (exercises.predict, lambda b, T: normed(1.0 * (b @ T > 0)), "figure 2.6"),
    (exercises.predict, lambda b, T: T[b > 0].mean(axis=0), "possible starts alike"),
    (exercises.correct, lambda b, seen: normed(1.0 * (b * seen > 0)), "figure 2.6"),
    (exercises.expected_reward, lambda b, R: R[b > 0].mean(axis=0), "possible states alike"),
    (exercises.expected_reward, lambda b, R: R @ b, "do not fit.*wrong side"),
    (exercises.expected_reward, lambda b, R: np.dot(R, b), "do not fit.*wrong side"),
    (exercises.expected_reward, lambda b, R: (b * R).sum(axis=0), "do not fit.*Number by number"),
    (exercises.observation_chances, lambda b, T, O_a: O_a @ (b @ T), "order of the products"),
    (exercises.predict, not_written, "still empty"),
    (exercises.predict, lambda b, T: None, "return"),
    (exercises.predict, lambda b, T: T[len(b)], "stopped with IndexError"),
    (exercises.correct, lambda b, seen: b * seen, "sums to 1"),
    (exercises.correct, lambda b, seen: b * seen / max(b * seen), "largest 1"),
    (exercises.correct, lambda b, seen: b * seen / np.sqrt(((b * seen) ** 2).sum()), "length 1"),
    (exercises.correct, lambda b, seen: normed(seen), "observation alone"),
    (exercises.correct, lambda b, seen: seen, "observation alone"),
    (exercises.correct, lambda b, seen: b, "changes nothing"),
    (exercises.correct, lambda b, seen: normed(b + seen), "you add"),
    (exercises.correct, lambda b, seen: (b + seen) / 2, "take the mean"),
    (exercises.correct, lambda b, seen: normed(b * b * seen), "belief is counted twice"),
    (exercises.correct, lambda b, seen: normed(b * seen**2), "observation is counted twice"),
    (exercises.correct, lambda b, seen: normed(b * (1 - seen)), "not seen"),
    (exercises.correct, lambda b, seen: normed(b / seen), "divide by the likelihood"),
    (exercises.correct, lambda b, seen: 1.0 * (b * seen == max(b * seen)), "forget the others"),
    (exercises.correct, lambda b, seen: (b * seen).sum(), r"\d numbers, not one number"),
    (exercises.correct, lambda b, seen: b / 0 * 0, "not all of it is a number"),
    (exercises.correct, lambda b, seen: correct(b, seen) + 1, "too large"),
    (exercises.correct, in_place, "copy"),
    (exercises.observation_chances, lambda b, T, O_a: b @ O_a, "first it acts"),
    (exercises.observation_chances, lambda b, T, O_a: T @ b @ O_a, "backwards"),
    (
        exercises.observation_chances,
        lambda b, T, O_a: O_a[np.argmax(b @ T)],
        "likeliest state alone",
    ),
    (exercises.observation_chances, lambda b, T, O_a: O_a.mean(axis=0), "all states alike"),
    (exercises.observation_chances, lambda b, T, O_a: O_a.sum(axis=0), "all states alike"),
    (exercises.observation_chances, lambda b, T, O_a: b @ T, r"\d numbers, not \d numbers"),
    (exercises.observation_chances, lambda b, T, O_a: 1 - chances(b, T, O_a), "is too"),
    (exercises.expected_reward, lambda b, R: R[np.argmax(b)], "as certain"),
    (exercises.expected_reward, lambda b, R: R.mean(axis=0), "all states alike"),
    (exercises.expected_reward, lambda b, R: R.sum(axis=0), "all states alike"),
    (exercises.expected_reward, lambda b, R: R.max(axis=0), "best state"),
    (
        exercises.expected_reward,
        lambda b, R: (b[:, np.newaxis] * R).mean(axis=0),
        "sum to 1 already",
    ),
    (exercises.expected_reward, lambda b, R: (b @ R).max(), r"\d numbers, not one number"),
    (exercises.expected_reward, lambda b, R: b @ R - 1, "too small"),
    (exercises.expected_reward, 3.0, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
@pytest.mark.filterwarnings("ignore:(divide|invalid):RuntimeWarning")
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed), re.DOTALL)
