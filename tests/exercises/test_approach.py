"""The checks of the ball problem's exercises: right passes, wrong is told in what way."""

import re

import numpy as np
import pytest
from scipy.special import softmax

from arkaq_edu import exercises


def reward(distance, orientation):
    if distance >= 500:
        return 0
    return 150 if abs(orientation) <= 0.05 else 100


def boltzmann(q, temperature):
    return softmax(q / temperature)


def backup(q, rewards, next_values, ended, alpha, gamma):
    target = 0.0 if ended else max(next_values)
    for r in reversed(rewards):
        target = r + gamma * target
    return (1 - alpha) * q + alpha * target


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [(exercises.reward, reward), (exercises.boltzmann, boltzmann), (exercises.backup, backup)],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def bonus(rule):
    return lambda d, o: 100 * (d < 500) + 50 * rule(d, o)


def plain(rule):
    """A backup that is wrong already where an action is taken once."""
    return lambda q, r, v, end, alpha, gamma: rule(q, r[0], v, alpha, gamma)


def held(gain, later=lambda n: n):
    """A backup that is right for one cycle, and for several counts its rewards by `gain`."""

    def answer(q, r, v, end, alpha, gamma):
        if len(r) == 1:
            return backup(q, r, v, end, alpha, gamma)
        follows = 0 if end else gamma ** later(len(r)) * max(v)
        return q + alpha * (gain(r, gamma) + follows - q)

    return answer


def discounted(r, gamma):
    return sum(x * gamma**k for k, x in enumerate(r))


def naive(q, temperature):
    weights = np.exp(q / temperature)
    return weights / weights.sum()


def not_written(*_):
    raise NotImplementedError


WRONG = [
    (exercises.reward, bonus(lambda d, o: 0), "never give the extra 50"),
    (exercises.reward, bonus(lambda d, o: abs(o) <= 0.05), "at any distance"),
    (exercises.reward, lambda d, o: (50 if abs(o) <= 0.05 else 100) * (d < 500), "in addition"),
    (exercises.reward, bonus(lambda d, o: d < 500 and o <= 0.05), "to the right is negative"),
    (exercises.reward, bonus(lambda d, o: d < 500 and 0 <= o <= 0.05), "both sides"),
    (exercises.reward, lambda d, o: reward(np.nextafter(d, 0), o), "exactly 500 mm"),
    (exercises.reward, lambda d, o: reward(d, np.nextafter(abs(o), 1)), r"exactly \.05 rad"),
    (exercises.reward, lambda d, o: reward(o, d), "a ball .* mm away .* is worth"),
    (exercises.reward, lambda d, o: reward(d, o) / 100, "is worth 1[05]0, yours is 1"),
    (exercises.reward, lambda d, o: "much", "numbers, not 'much'"),
    (exercises.reward, lambda d, o: None, "return"),
    (exercises.reward, not_written, "still empty"),
    (exercises.boltzmann, lambda q, t: np.exp(q / t), "do not sum to 1"),
    (exercises.boltzmann, lambda q, t: np.exp((q - max(q)) / t), "do not sum to 1"),
    (exercises.boltzmann, lambda q, t: softmax(-q / t), "the worst action is the likeliest"),
    (exercises.boltzmann, lambda q, t: softmax(q * t), "multiply by the temperature"),
    (exercises.boltzmann, lambda q, t: softmax(q), "changes nothing"),
    (exercises.boltzmann, lambda q, t: naive(q, 1.0) / t * t, "changes nothing"),
    (exercises.boltzmann, lambda q, t: np.eye(len(q))[q.argmax()], "temperature 0"),
    (exercises.boltzmann, lambda q, t: np.ones(len(q)) / len(q), "infinite temperature"),
    (exercises.boltzmann, lambda q, t: q / q.sum(), "may be negative"),
    (exercises.boltzmann, lambda q, t: softmax(q / t**2), "you give the first action"),
    (exercises.boltzmann, lambda q, t: softmax(q / t).max(), r"2 numbers, not one number"),
    (exercises.boltzmann, naive, "too much for exp"),
    (exercises.boltzmann, lambda q, t: naive(q - abs(q).max(), t), "too much for exp"),
    (exercises.boltzmann, not_written, "still empty"),
    (exercises.backup, plain(lambda q, r, v, a, g: r + g * max(v)), "in place of the old value"),
    (exercises.backup, plain(lambda q, r, v, a, g: a * (r + g * max(v) - q)), "the change of Q"),
    (
        exercises.backup,
        plain(lambda q, r, v, a, g: a * q + (1 - a) * (r + g * max(v))),
        "changed places",
    ),
    (exercises.backup, plain(lambda q, r, v, a, g: q + a * (r + g * max(v))), "the difference"),
    (exercises.backup, plain(lambda q, r, v, a, g: q + a * (r + max(v) - q)), "not discounted"),
    (exercises.backup, plain(lambda q, r, v, a, g: q + a * (g * (r + max(v)) - q)), "at once"),
    (exercises.backup, plain(lambda q, r, v, a, g: q + a * (r - q)), "nothing that follows counts"),
    (exercises.backup, plain(lambda q, r, v, a, g: q + a * (r + g * np.mean(v) - q)), "the mean"),
    (exercises.backup, plain(lambda q, r, v, a, g: q + a * (r + g * v[0] - q)), "the first of"),
    (
        exercises.backup,
        plain(lambda q, r, v, a, g: q + a * (r + g * min(v) - q)),
        "one cycle: from Q",
    ),
    (
        exercises.backup,
        lambda q, r, v, end, a, g: backup(q, r, v, False, a, g),
        "nothing can follow",
    ),
    (
        exercises.backup,
        lambda q, r, v, end, a, g: r[0] if end else backup(q, r, v, end, a, g),
        "a step of size alpha",
    ),
    (
        exercises.backup,
        lambda q, r, v, end, a, g: q if end else backup(q, r, v, end, a, g),
        "it holds the reward",
    ),
    (exercises.backup, held(lambda r, g: sum(r)), "gamma to the k"),
    (exercises.backup, held(lambda r, g: sum(r), lambda n: 1), "one factor of gamma for each"),
    (exercises.backup, held(discounted, lambda n: 1), "you discount it by one$"),
    (exercises.backup, held(discounted, lambda n: n - 1), "one too few"),
    (exercises.backup, held(lambda r, g: g * discounted(r, g)), "the first reward is discounted"),
    (exercises.backup, held(lambda r, g: r[0]), "only the first of the rewards"),
    (exercises.backup, held(lambda r, g: r[0], lambda n: 1), "is treated like one"),
    (exercises.backup, held(lambda r, g: r[-1]), "only the last of the rewards"),
    (exercises.backup, held(lambda r, g: max(r)), "held for several cycles: from Q"),
    (exercises.backup, lambda q, r, v, end, a, g: v, r"one number, not 3 numbers"),
    (exercises.backup, not_written, "still empty"),
]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))
