"""The checks of the exercises of chapter 1: right answers pass, wrong ones are told in what way."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises


def finite_sum(rewards, h):
    return sum(rewards[t] for t in range(h))


def discounted_sum(rewards, gamma):
    total = 0.0
    for r in reversed(rewards):
        total = r + gamma * total
    return total


def epsilon_greedy(means, epsilon, rng):
    if rng.random() < epsilon:
        return rng.integers(len(means))
    return rng.choice(np.flatnonzero(means == means.max()))


def regret(p, arms):
    lost, so_far = 0.0, []
    for arm in arms:
        lost += max(p) - p[arm]
        so_far.append(lost)
    return so_far


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [
        (exercises.finite_sum, finite_sum),
        (exercises.finite_sum, lambda rewards, h: np.cumsum(rewards)[h - 1]),
        (exercises.discounted_sum, discounted_sum),
        (exercises.discounted_sum, lambda r, g: np.polynomial.polynomial.polyval(g, r)),
        (exercises.epsilon_greedy, epsilon_greedy),
        (exercises.regret, regret),
    ],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def not_written(*_):
    raise NotImplementedError


def greedy(means, rng):
    return rng.choice(np.flatnonzero(means == means.max()))


def exploring(explore, share=lambda epsilon: epsilon):
    """Greedy, and with a probability `explore`."""
    return lambda means, epsilon, rng: (
        explore(means, rng) if rng.random() < share(epsilon) else greedy(means, rng)
    )


def lazily_tied(means, epsilon, rng):
    return rng.integers(len(means)) if rng.random() < epsilon else int(np.argmax(means))


def unfairly_tied(means, epsilon, rng):
    if rng.random() < epsilon:
        return rng.integers(len(means))
    best = np.flatnonzero(means == means.max())
    return best[0] if rng.random() < 0.6 else rng.choice(best)


def of_its_own(means, epsilon, rng):
    return epsilon_greedy(means, epsilon, np.random.default_rng())


def in_place(means, epsilon, rng):
    means += 1
    return 0


def others(means, rng):
    return rng.choice(np.flatnonzero(means < means.max()))


def sums(rewards):
    return np.cumsum(rewards)


def weighed(weights):
    return lambda r, g: float(np.dot(r, weights(g, np.arange(len(r)))))


WRONG = [
    (exercises.finite_sum, lambda r, h: sum(r[: h + 1]), r"h \+ 1 rewards"),
    (exercises.finite_sum, lambda r, h: sum(r[1 : h + 1]), "too late"),
    (exercises.finite_sum, lambda r, h: sum(r[1:h]), "immediate reward: the sum"),
    (exercises.finite_sum, lambda r, h: sum(r[: h - 1]), "h - 1 rewards"),
    (exercises.finite_sum, lambda r, h: sum(r), "all the rewards"),
    (exercises.finite_sum, lambda r, h: np.mean(r[:h]), "mean"),
    (exercises.finite_sum, lambda r, h: r[h - 1], "only the last reward"),
    (exercises.finite_sum, lambda r, h: sums(r[:h]), "sums up to each step"),
    (exercises.finite_sum, lambda r, h: finite_sum(r, h) + 1, "(?s)0 of 20 tries.*too large"),
    (exercises.finite_sum, lambda r, h: finite_sum(r, h) - 1, "too small"),
    (exercises.finite_sum, lambda r, h: [1.0, 2.0], r"one number, not 2 numbers"),
    (exercises.finite_sum, lambda r, h: "much", "numbers"),
    (exercises.finite_sum, lambda r, h: sum(r[t] for t in range(h + 1)), "stopped with IndexError"),
    (exercises.finite_sum, not_written, "still empty"),
    (exercises.finite_sum, lambda *_: None, "return"),
    (exercises.discounted_sum, lambda r, g: sum(r), "never use gamma"),
    (exercises.discounted_sum, lambda r, g: g * sum(r), "count alike"),
    (exercises.discounted_sum, lambda r, g: g * discounted_sum(r, g), "counts in full"),
    (exercises.discounted_sum, lambda r, g: discounted_sum(r[::-1], g), "order is reversed"),
    (exercises.discounted_sum, lambda r, g: discounted_sum(r, 1 - g), "1 - gamma: a gamma near 1"),
    (exercises.discounted_sum, lambda r, g: r[0] + g * sum(r[1:]), "later rewards count alike"),
    (exercises.discounted_sum, lambda r, g: discounted_sum(r, 1 / g), "do not divide$"),
    (exercises.discounted_sum, weighed(lambda g, t: g * t), "times t"),
    (exercises.discounted_sum, lambda r, g: (1 - g) * discounted_sum(r, g), "leave that out"),
    (exercises.discounted_sum, lambda r, g: r * g ** np.arange(len(r)), "add them up"),
    (exercises.discounted_sum, lambda r, g: 2 * discounted_sum(r, g), "too large"),
    (exercises.epsilon_greedy, lambda m, e, rng: greedy(m, rng), "never explores"),
    (
        exercises.epsilon_greedy,
        lambda m, e, rng: rng.integers(len(m)),
        "epsilon = 0 yours explores",
    ),
    (
        exercises.epsilon_greedy,
        lambda m, e, rng: epsilon_greedy(m, 1 - e, rng),
        "epsilon = 0 yours explores",
    ),
    (exercises.epsilon_greedy, lambda m, e, rng: epsilon_greedy(-m, e, rng), "worst"),
    (exercises.epsilon_greedy, lambda m, e, rng: epsilon_greedy(m, max(e, 0.1), rng), "not always"),
    (exercises.epsilon_greedy, exploring(others), "leave the best machine out"),
    (
        exercises.epsilon_greedy,
        exploring(lambda m, rng: (np.argmax(m) + rng.integers(2)) % 4),
        "some machine is never",
    ),
    (
        exercises.epsilon_greedy,
        exploring(lambda m, rng: rng.choice(4, p=[0.4, 0.3, 0.2, 0.1])),
        "equally likely",
    ),
    (
        exercises.epsilon_greedy,
        exploring(lambda m, rng: rng.integers(4), share=lambda e: e**2),
        "too frequent",
    ),
    (
        exercises.epsilon_greedy,
        exploring(lambda m, rng: rng.integers(4), share=lambda e: e**0.5),
        "too rare",
    ),
    (exercises.epsilon_greedy, lazily_tied, "should share"),
    (exercises.epsilon_greedy, unfairly_tied, "equally good should be equally likely"),
    (exercises.epsilon_greedy, of_its_own, "equal generators"),
    (exercises.epsilon_greedy, in_place, "copy"),
    (exercises.epsilon_greedy, lambda m, e, rng: m.max(), "index of a machine"),
    (exercises.epsilon_greedy, lambda m, e, rng: 4 if e else greedy(m, rng), "0 to 3, not 4"),
    (exercises.epsilon_greedy, not_written, "still empty"),
    (exercises.epsilon_greedy, lambda *_: None, "return"),
    (exercises.epsilon_greedy, lambda m, e: 0, "stopped with TypeError"),
    (exercises.regret, lambda p, arms: max(p) - p[arms], "by itself"),
    (exercises.regret, lambda p, arms: regret(p, arms)[-1], "after the last pull"),
    (exercises.regret, lambda p, arms: sums(p[arms] - max(p)), "negative"),
    (exercises.regret, lambda p, arms: sums(p.mean() - p[arms]), "mean of the machines"),
    (exercises.regret, lambda p, arms: sums(max(p[arms]) - p[arms]), "that was pulled"),
    (
        exercises.regret,
        lambda p, arms: sums(np.maximum.accumulate(p[arms]) - p[arms]),
        "best machine so far",
    ),
    (exercises.regret, lambda p, arms: sums(1 - p[arms]), "coin at every pull"),
    (exercises.regret, lambda p, arms: sums(p[arms]), "what was earned"),
    (exercises.regret, lambda p, arms: regret(p, arms) / np.arange(1, 10), "average regret"),
    (exercises.regret, lambda p, arms: regret(p, arms)[1:], r"9 numbers, not 8 numbers"),
    (exercises.regret, lambda p, arms: np.square(regret(p, arms)), "regret is right in 0 of 20"),
    (exercises.regret, 7, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))


def test_a_right_choice_is_hardly_ever_called_wrong():
    for seed in range(5):
        exercises.epsilon_greedy.check(epsilon_greedy, rng=seed)
