"""The checks of the exercises on decision processes: right answers pass, wrong ones are told."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises


def q(T, R, gamma, V):
    return R + gamma * np.einsum("ast,t->sa", T, V)


def bellman(T, R, gamma, V, s):
    """By sums, as equation 2.8 stands."""
    actions, states = range(len(T)), range(len(V))
    return max(R[s, a] + gamma * sum(T[a, s, t] * V[t] for t in states) for a in actions)


def greedy(T, R, gamma, V):
    return np.argmax(q(T, R, gamma, V), axis=1)


def td(v, r, v_next, ended, alpha, gamma):
    target = r if ended else r + gamma * v_next
    return (1 - alpha) * v + alpha * target


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [(exercises.bellman, bellman), (exercises.greedy, greedy), (exercises.td, td)],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


@pytest.mark.parametrize(
    "rate",
    [
        lambda n: 0.5 / n**0.6,
        lambda n: n**-0.55,
        lambda n: 10 / (9 + n),
        lambda n: 100 / (99 + n),
        lambda n: min(1, 5 / n),
        lambda n: 0.2 if n < 1000 else 0.2 * 1000 / n,
    ],
)
def test_a_rate_that_forgets_and_settles_is_praised(rate, capsys):
    exercises.rate.check(rate)
    assert capsys.readouterr().out.startswith("Right")


def not_written(*_):
    raise NotImplementedError


def printed_2_7(T, R, gamma, V, s):
    return gamma * max(R[s])


def after_an_end(answer):
    """Right while the episode goes on, `answer` where it has ended."""
    return lambda v, r, n, ended, a, g: answer(v, r, n, a, g) if ended else td(v, r, n, False, a, g)


WRONG = [
    (exercises.bellman, lambda T, R, gamma, V, s: max(R[s]), "only the best immediate"),
    (exercises.bellman, printed_2_7, "2.7 as printed"),
    (
        exercises.bellman,
        lambda T, R, g, V, s: g * bellman(T, R, 1, V, s),
        "reward is discounted too",
    ),
    (
        exercises.bellman,
        lambda T, R, g, V, s: bellman(T, 0 * R, g, V, s),
        "reward is missing",
    ),
    (exercises.bellman, lambda T, R, g, V, s: bellman(T, R, 1, V, s), "follows is not discounted"),
    (exercises.bellman, lambda T, R, g, V, s: max(R[s]) + bellman(T, 0 * R, g, V, s), "two maxima"),
    (exercises.bellman, lambda T, R, g, V, s: np.mean(q(T, R, g, V)[s]), "mean over the actions"),
    (exercises.bellman, lambda T, R, g, V, s: np.sum(q(T, R, g, V)[s]), "add the actions up"),
    (exercises.bellman, lambda T, R, g, V, s: min(q(T, R, g, V)[s]), "worst action"),
    (exercises.bellman, lambda T, R, g, V, s: np.argmax(q(T, R, g, V)[s]), "how much it is worth"),
    (exercises.bellman, lambda T, R, g, V, s: q(T, R, g, V)[s], "take the best of them"),
    (exercises.bellman, lambda T, R, g, V, s: max(R[s]) + g * max(V), "the best next state"),
    (exercises.bellman, lambda T, R, g, V, s: max(R[s]) + g * sum(V), "values that may follow"),
    (
        exercises.bellman,
        lambda T, R, g, V, s: bellman(T.transpose(0, 2, 1), R, g, V, s),
        "states before",
    ),
    (
        exercises.bellman,
        lambda *case: bellman(*case) + 1,
        "(?s)right in 0 of 20 tries.*yours: .*too l",
    ),
    (exercises.bellman, lambda *case: bellman(*case) - 1, "too small"),
    (exercises.bellman, lambda T, R, V: 0, "stopped with TypeError"),
    (exercises.bellman, not_written, "still empty"),
    (exercises.greedy, lambda T, R, g, V: [np.argmax(row) for row in R], "equation 2.6"),
    (exercises.greedy, lambda T, R, g, V: greedy(T, 0 * R, g, V), "the reward is missing"),
    (exercises.greedy, lambda T, R, g, V: np.max(q(T, R, g, V), axis=1), "values of the best"),
    (exercises.greedy, lambda T, R, g, V: q(T, R, g, V), "which of a row"),
    (exercises.greedy, lambda T, R, g, V: np.argmin(q(T, R, g, V), axis=1), "worst"),
    (exercises.greedy, lambda T, R, g, V: np.argmax(q(T, R, g, V), axis=0), "best state of each"),
    (exercises.greedy, lambda *case: greedy(*case) + 1, "count from 1"),
    (exercises.greedy, lambda T, R, g, V: greedy(T, R, 1, V), "not discounted"),
    (
        exercises.greedy,
        lambda T, R, g, V: greedy(T.transpose(0, 2, 1), R, g, V),
        "states before",
    ),
    (exercises.greedy, lambda T, R, g, V: 0, r"\d numbers, not one number"),
    (exercises.greedy, lambda *case: None, "return"),
    (exercises.td, lambda v, r, n, end, a, g: r + g * n, "in place of the old"),
    (exercises.td, lambda v, r, n, end, a, g: a * (r + g * n - v), "add it to the old"),
    (exercises.td, lambda v, r, n, end, a, g: v + a * (r + g * n), "on top of the old"),
    (exercises.td, lambda v, r, n, end, a, g: td(v, r, n, end, a, 1), "not discounted"),
    (exercises.td, lambda v, r, n, end, a, g: td(v, r, n, True, a, g), "only the reward counts"),
    (exercises.td, lambda v, r, n, end, a, g: td(v, 0, n, end, a, g), "reward is missing"),
    (exercises.td, lambda v, r, n, end, a, g: td(v, g * r, n, end, a, g), "reward is discounted"),
    (exercises.td, lambda v, r, n, end, a, g: td(v, r, n, end, 1 - a, g), "changed places"),
    (exercises.td, lambda v, r, n, end, a, g: 2 * v - td(v, r, n, end, a, g), "away from"),
    (exercises.td, lambda v, r, n, end, a, g: td(v, r, n, False, a, g), "leave the next value out"),
    (exercises.td, after_an_end(lambda v, r, n, a, g: v), "learn nothing"),
    (exercises.td, after_an_end(lambda v, r, n, a, g: r), "too, go only a step"),
    (exercises.td, after_an_end(lambda v, r, n, a, g: 3 * v), "too large"),
    (exercises.td, 3.0, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))


@pytest.mark.parametrize(
    ("rate", "hint"),
    [
        (
            lambda n: 0.1,
            "too slowly, or not at all: after 100,000 visits 23% of a",
        ),
        (lambda n: 1.0, "too slowly, or not at all: after 100,000 visits 100%"),
        (lambda n: n**-0.3, "too slowly, or not at all"),
        (lambda n: n**-0.5, "too slowly, or not at all: after 100,000 visits 4% of"),
        (lambda n: 1 / n**2, "stops too soon"),
        (lambda n: 0.5**n, "29% of the value is still what it began with"),
        (lambda n: 0.1 / n, "of the value is still what it began with"),
        (lambda n: 0.0, "100% of the value is still"),
        (lambda n: 1 / n, "falls as fast as 1 / n"),
        (lambda n: 1 / (n + 1), "falls as fast as 1 / n"),
        (lambda n: 2 / n, r"rate\(1\) is 2: a learning rate lies between 0 and 1"),
        (lambda n: 1 - n / 40_000, r"rate\(40001\) is -"),
        (lambda n: 1 / (n - 1), r"\(1\) stopped with ZeroDivisionError"),
        (lambda n: "fast", "should return numbers"),
        (lambda n: None, "returned nothing"),
        (not_written, "still empty"),
    ],
)
def test_a_wrong_rate_is_told_what_is_wrong(rate, hint):
    assert re.search(hint, exercises.rate.problem(rate))


def test_what_the_check_computes_is_what_twenty_learners_do():
    """1/n^2 and 0.1 leave as much of a target's scatter as targets drawn at random show."""
    targets = np.random.default_rng(0).standard_normal((2000, 400))
    for rate, said in ((lambda n: 0.1, (0.1 / 1.9) ** 0.5), (lambda n: 1 / n, 400**-0.5)):
        value = np.zeros(2000)
        for n in range(1, 401):
            value += rate(n) * (targets[:, n - 1] - value)
        assert value.std() == pytest.approx(said, rel=0.05)
