"""The checks of the ball problem's exercises: right passes, wrong is told in what way."""

import numpy as np
import pytest
from scipy.special import softmax

from arkaq_edu.exercises import ExerciseError, check_backup, check_boltzmann, check_reward


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
    ("check", "answer"),
    [(check_reward, reward), (check_boltzmann, boltzmann), (check_backup, backup)],
)
def test_a_right_answer_is_praised(check, answer, seed):
    assert check(answer, rng=seed).startswith("Right")


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
    (check_reward, bonus(lambda d, o: 0), "never give the extra 50"),
    (check_reward, bonus(lambda d, o: abs(o) <= 0.05), "at any distance"),
    (check_reward, lambda d, o: (50 if abs(o) <= 0.05 else 100) * (d < 500), "in addition"),
    (check_reward, bonus(lambda d, o: d < 500 and o <= 0.05), "to the right is negative"),
    (check_reward, bonus(lambda d, o: d < 500 and 0 <= o <= 0.05), "both sides"),
    (check_reward, lambda d, o: reward(np.nextafter(d, 0), o), "exactly 500 mm"),
    (check_reward, lambda d, o: reward(d, np.nextafter(abs(o), 1)), r"exactly \.05 rad"),
    (check_reward, lambda d, o: reward(o, d), "a ball .* mm away .* is worth"),
    (check_reward, lambda d, o: reward(d, o) / 100, "is worth 1[05]0, yours is 1"),
    (check_reward, lambda d, o: [reward(d, o)], r"shape \(\), not \(1,\)"),
    (check_reward, lambda d, o: "much", "numbers, not 'much'"),
    (check_reward, lambda d, o: None, "return"),
    (check_reward, not_written, "still empty"),
    (check_boltzmann, lambda q, t: np.exp(q / t), "do not sum to 1"),
    (check_boltzmann, lambda q, t: np.exp((q - max(q)) / t), "do not sum to 1"),
    (check_boltzmann, lambda q, t: softmax(-q / t), "the worst action is the likeliest"),
    (check_boltzmann, lambda q, t: softmax(q * t), "multiply by the temperature"),
    (check_boltzmann, lambda q, t: softmax(q), "changes nothing"),
    (check_boltzmann, lambda q, t: naive(q, 1.0) / t * t, "changes nothing"),
    (check_boltzmann, lambda q, t: np.eye(len(q))[q.argmax()], "temperature 0"),
    (check_boltzmann, lambda q, t: np.ones(len(q)) / len(q), "infinite temperature"),
    (check_boltzmann, lambda q, t: q / q.sum(), "may be negative"),
    (check_boltzmann, lambda q, t: softmax(q / t**2), "you give the first action"),
    (check_boltzmann, lambda q, t: softmax(q / t).max(), r"shape \(2,\), not \(\)"),
    (check_boltzmann, naive, "too much for exp"),
    (check_boltzmann, lambda q, t: naive(q - abs(q).max(), t), "too much for exp"),
    (check_boltzmann, not_written, "still empty"),
    (check_backup, plain(lambda q, r, v, a, g: r + g * max(v)), "in place of the old value"),
    (check_backup, plain(lambda q, r, v, a, g: a * (r + g * max(v) - q)), "the change of Q"),
    (
        check_backup,
        plain(lambda q, r, v, a, g: a * q + (1 - a) * (r + g * max(v))),
        "changed places",
    ),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (r + g * max(v))), "the difference"),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (r + max(v) - q)), "not discounted"),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (g * (r + max(v)) - q)), "at once"),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (r - q)), "nothing that follows counts"),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (r + g * np.mean(v) - q)), "the mean"),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (r + g * v[0] - q)), "the first of"),
    (check_backup, plain(lambda q, r, v, a, g: q + a * (r + g * min(v) - q)), "one cycle: from Q"),
    (
        check_backup,
        lambda q, r, v, end, a, g: backup(q, r, v, False, a, g),
        "nothing can follow",
    ),
    (
        check_backup,
        lambda q, r, v, end, a, g: r[0] if end else backup(q, r, v, end, a, g),
        "a step of size alpha",
    ),
    (
        check_backup,
        lambda q, r, v, end, a, g: q if end else backup(q, r, v, end, a, g),
        "it holds the reward",
    ),
    (check_backup, held(lambda r, g: sum(r)), "gamma to the k"),
    (check_backup, held(lambda r, g: sum(r), lambda n: 1), "one factor of gamma for each"),
    (check_backup, held(discounted, lambda n: 1), "you discount it by one$"),
    (check_backup, held(discounted, lambda n: n - 1), "one too few"),
    (check_backup, held(lambda r, g: g * discounted(r, g)), "the first reward is discounted"),
    (check_backup, held(lambda r, g: r[0]), "only the first of the rewards"),
    (check_backup, held(lambda r, g: r[0], lambda n: 1), "is treated like one"),
    (check_backup, held(lambda r, g: r[-1]), "only the last of the rewards"),
    (check_backup, held(lambda r, g: max(r)), "held for several cycles: from Q"),
    (check_backup, lambda q, r, v, end, a, g: v, r"shape \(\), not \(3,\)"),
    (check_backup, not_written, "still empty"),
]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("check", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(check, answer, hint, seed):
    with pytest.raises(ExerciseError, match=hint):
        check(answer, rng=seed)


@pytest.mark.parametrize(
    ("check", "answer"),
    [(check_reward, reward), (check_boltzmann, boltzmann), (check_backup, backup)],
)
def test_fresh_inputs_come_from_the_given_generator(check, answer):
    asked = []

    def spy(*arguments):
        asked.append(repr(arguments))
        return answer(*arguments)

    for seed in (1, 1, 2):
        check(spy, rng=seed)
    once = len(asked) // 3
    assert asked[:once] == asked[once : 2 * once] != asked[2 * once :]
