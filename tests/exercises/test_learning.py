"""The checks of the exercises of chapter 1: right answers pass, wrong ones are told in what way."""

import numpy as np
import pytest

from arkaq_edu.exercises import (
    ExerciseError,
    check_discounted_sum,
    check_epsilon_greedy,
    check_finite_sum,
    check_regret,
)


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
    ("check", "answer"),
    [
        (check_finite_sum, finite_sum),
        (check_finite_sum, lambda rewards, h: np.cumsum(rewards)[h - 1]),
        (check_discounted_sum, discounted_sum),
        (check_discounted_sum, lambda r, g: np.polynomial.polynomial.polyval(g, r)),
        (check_epsilon_greedy, epsilon_greedy),
        (check_regret, regret),
    ],
)
def test_a_right_answer_is_praised(check, answer, seed):
    assert check(answer, rng=seed).startswith("Right")


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
    (check_finite_sum, lambda r, h: sum(r[: h + 1]), r"h \+ 1 rewards"),
    (check_finite_sum, lambda r, h: sum(r[1 : h + 1]), "too late"),
    (check_finite_sum, lambda r, h: sum(r[1:h]), "reward of now"),
    (check_finite_sum, lambda r, h: sum(r[: h - 1]), "h - 1 rewards"),
    (check_finite_sum, lambda r, h: sum(r), "all the rewards"),
    (check_finite_sum, lambda r, h: np.mean(r[:h]), "mean"),
    (check_finite_sum, lambda r, h: r[h - 1], "last reward alone"),
    (check_finite_sum, lambda r, h: sums(r[:h]), "sums up to each step"),
    (check_finite_sum, lambda r, h: finite_sum(r, h) + 1, "0 of 20 tries.*too large"),
    (check_finite_sum, lambda r, h: finite_sum(r, h) - 1, "too small"),
    (check_finite_sum, lambda r, h: [1.0, 2.0], r"shape \(\), not \(2,\)"),
    (check_finite_sum, lambda r, h: "much", "numbers"),
    (check_finite_sum, lambda r, h: sum(r[t] for t in range(h + 1)), "stopped with IndexError"),
    (check_finite_sum, not_written, "still empty"),
    (check_finite_sum, lambda *_: None, "return"),
    (check_discounted_sum, lambda r, g: sum(r), "never use gamma"),
    (check_discounted_sum, lambda r, g: g * sum(r), "count alike"),
    (check_discounted_sum, lambda r, g: g * discounted_sum(r, g), "counts in full"),
    (check_discounted_sum, lambda r, g: discounted_sum(r[::-1], g), "far end"),
    (check_discounted_sum, lambda r, g: discounted_sum(r, 1 - g), "1 - gamma: a gamma near 1"),
    (check_discounted_sum, lambda r, g: r[0] + g * sum(r[1:]), "later rewards count alike"),
    (check_discounted_sum, lambda r, g: discounted_sum(r, 1 / g), "divided by"),
    (check_discounted_sum, weighed(lambda g, t: g * t), "times t"),
    (check_discounted_sum, lambda r, g: (1 - g) * discounted_sum(r, g), "leave that out"),
    (check_discounted_sum, lambda r, g: r * g ** np.arange(len(r)), "add them up"),
    (check_discounted_sum, lambda r, g: 2 * discounted_sum(r, g), "too large"),
    (check_epsilon_greedy, lambda m, e, rng: greedy(m, rng), "never explores"),
    (check_epsilon_greedy, lambda m, e, rng: rng.integers(len(m)), "epsilon = 0 yours explores"),
    (
        check_epsilon_greedy,
        lambda m, e, rng: epsilon_greedy(m, 1 - e, rng),
        "epsilon = 0 yours explores",
    ),
    (check_epsilon_greedy, lambda m, e, rng: epsilon_greedy(-m, e, rng), "worst"),
    (check_epsilon_greedy, lambda m, e, rng: epsilon_greedy(m, max(e, 0.1), rng), "not always"),
    (check_epsilon_greedy, exploring(others), "leave the best machine out"),
    (
        check_epsilon_greedy,
        exploring(lambda m, rng: (np.argmax(m) + rng.integers(2)) % 4),
        "some machine is never",
    ),
    (
        check_epsilon_greedy,
        exploring(lambda m, rng: rng.choice(4, p=[0.4, 0.3, 0.2, 0.1])),
        "equally likely",
    ),
    (
        check_epsilon_greedy,
        exploring(lambda m, rng: rng.integers(4), share=lambda e: e**2),
        "too frequent",
    ),
    (
        check_epsilon_greedy,
        exploring(lambda m, rng: rng.integers(4), share=lambda e: e**0.5),
        "too rare",
    ),
    (check_epsilon_greedy, lazily_tied, "should share"),
    (check_epsilon_greedy, unfairly_tied, "equally good should be equally likely"),
    (check_epsilon_greedy, of_its_own, "equal generators"),
    (check_epsilon_greedy, in_place, "copy"),
    (check_epsilon_greedy, lambda m, e, rng: m.max(), "index of a machine"),
    (check_epsilon_greedy, lambda m, e, rng: 4 if e else greedy(m, rng), "0 to 3, not 4"),
    (check_epsilon_greedy, not_written, "still empty"),
    (check_epsilon_greedy, lambda *_: None, "return"),
    (check_epsilon_greedy, lambda m, e: 0, "stopped with TypeError"),
    (check_regret, lambda p, arms: max(p) - p[arms], "by itself"),
    (check_regret, lambda p, arms: regret(p, arms)[-1], "after the last pull"),
    (check_regret, lambda p, arms: sums(p[arms] - max(p)), "negative"),
    (check_regret, lambda p, arms: sums(p.mean() - p[arms]), "mean of the machines"),
    (check_regret, lambda p, arms: sums(max(p[arms]) - p[arms]), "that was pulled"),
    (
        check_regret,
        lambda p, arms: sums(np.maximum.accumulate(p[arms]) - p[arms]),
        "best machine so far",
    ),
    (check_regret, lambda p, arms: sums(1 - p[arms]), "coin at every pull"),
    (check_regret, lambda p, arms: sums(p[arms]), "what was earned"),
    (check_regret, lambda p, arms: regret(p, arms) / np.arange(1, 10), "on average"),
    (check_regret, lambda p, arms: regret(p, arms)[1:], r"shape \(9,\), not \(8,\)"),
    (check_regret, lambda p, arms: np.square(regret(p, arms)), "regret is right in 0 of 20"),
    (check_regret, 7, "by its name"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("check", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(check, answer, hint, seed):
    with pytest.raises(ExerciseError, match=hint):
        check(answer, rng=seed)


def test_a_right_choice_is_hardly_ever_called_wrong():
    assert [check_epsilon_greedy(epsilon_greedy, rng=seed)[:5] for seed in range(20)] == [
        "Right"
    ] * 20
