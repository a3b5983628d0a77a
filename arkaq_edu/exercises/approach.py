"""Exercises of chapter 10: reward a walk, draw an action, back up a value."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Cases, Part, ask, exercise


def _places(rng: np.random.Generator) -> list[tuple[float, ...]]:
    low = [(200, -0.049), (200, 0.051), (200, -0.5), (501, -0.049)]
    high = [(499, 0.049), (499, 0.5), (499, -0.051), (4100, 0.049)]
    places = rng.uniform(low, high, (15, 4, 2)).reshape(-1, 2).tolist()
    return [*map(tuple, places), (500.0, 0.0), (300.0, 0.05), (300.0, -0.05)]


@exercise(
    "Right: that is all the robot will ever be told about its task.",
    "There are three rewards: 0, 100 and 150. Which question decides about 0?",
    "At 500 mm or more the reward is 0, wherever the ball is.",
    "Nearer than that: 150 if abs(orientation) <= 0.05, otherwise 100.",
    cases=_places,
    wrong={
        "100 * (distance < 500)": "you never give the extra 50 for a ball straight ahead",
        "100 * (distance < 500) + 50 * (abs(orientation) <= 0.05)": "you give the extra 50 to a "
        "ball straight ahead at any distance: it is only for a ball that is reached",
        "(50 if abs(orientation) <= 0.05 else 100) * (distance < 500)": "the 50 comes in place of "
        "the 100: it is given in addition, 150 in all",
        "(100 + 50 * (orientation <= 0.05)) * (distance < 500)": "any ball to the right earns your "
        "extra 50: an orientation to the right is negative",
        "(100 + 50 * (0 <= orientation <= 0.05)) * (distance < 500)": "only balls to the left earn "
        "your extra 50: the interval goes to both sides",
        "(100 + 50 * (abs(orientation) <= 0.05)) * (distance <= 500)": "at exactly 500 mm you give "
        "a reward: it takes a distance smaller than 500",
        "(100 + 50 * (abs(orientation) < 0.05)) * (distance < 500)": "at exactly .05 rad you give "
        "no extra 50: the ends belong to the interval [-.05, .05]",
    },
    tell=lambda found, wanted, d, o: (
        f"a ball {d:.4g} mm away at {o:+.3g} rad is worth {wanted:.4g}, yours is {found:.4g}"
    ),
)
def reward(distance, orientation):
    """Return what the ball's place (mm, rad) is worth.

    Thesis, section 5.2.2.
    """
    if distance >= 500:
        return 0
    return 150 if abs(orientation) <= 0.05 else 100


def _normed(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    return weights / weights.sum()


def _or_nothing(function: Callable[..., Any], *case: Any) -> Any:
    """Ask for values that overflow, and take what is not a number as 0."""
    return np.nan_to_num(np.asarray(ask(function, *case), dtype=float))


@exercise(
    "Right: and however large the values or low the temperature, nothing overflows.",
    "Each action gets a weight first. What turns weights into probabilities?",
    "The weight is exp(q / temperature): divide the weights by their sum.",
    "Take q.max() away from all values before exp. The probabilities stay the same.",
    points=3,
    returns="one probability for each action",
    cases=lambda rng: [(rng.uniform(-2, 2, n), rng.uniform(1.5, 3)) for n in (2, 3, 3, 3, 4, 5)],
    wrong={
        "np.exp(q / temperature)": "your probabilities do not sum to 1: divide each by the sum of "
        "all",
        "np.exp((q - q.max()) / temperature)": "your probabilities do not sum to 1: divide each by "
        "the sum of all",
        "boltzmann(-q, temperature)": "the worst action is the likeliest: check the sign of the "
        "exponent",
        "boltzmann(q, 1 / temperature)": "you multiply by the temperature: a hot agent should "
        "choose more evenly, yours is surer",
        "boltzmann(q, 1.0)": "the temperature changes nothing: divide the values by it, inside exp",
        "np.eye(len(q))[q.argmax()]": "you always take the best action: the limit of temperature 0",
        "np.full(len(q), 1 / len(q))": "all actions are equal: the limit of an infinite "
        "temperature",
        "_normed(q)": "you normalize the values, which may be negative: use exp(value / "
        "temperature)",
    },
    tell=lambda found, wanted, q, t: (
        f"for values {np.round(q, 2)} at temperature {t:.2f} you give the first action "
        f"{found[0]:.4f}, and it should have {wanted[0]:.4f}"
    ),
    then=(
        Part(
            # exp(709) is the largest that a float can hold; exp(-746) is 0.
            cases=lambda rng: [(s * np.array([1490.0, 1500.0, 1480.0]), 1.0) for s in (1, -1)],
            answer=_or_nothing,
            tell=lambda found, wanted, q, t: (
                f"values of {q[0]:g} at temperature 1 are too much for exp: subtract the largest "
                "value from all of them first, which changes no probability"
            ),
        ),
    ),
)
def boltzmann(q, temperature):
    """Return the probability of each action, from their values q, shape (A,).

    Thesis, chapter 3, equation 3.2.
    """
    weights = np.exp((q - q.max()) / temperature)
    return weights / weights.sum()


def _experiences(*ends: bool, several: bool = False) -> Cases:
    return lambda rng: [
        (
            rng.uniform(0, 100),
            rng.uniform(1, 50, rng.integers(2, 6) if several else 1),
            rng.uniform(0, 100, 3),
            ended,
            rng.uniform(0.1, 0.4),
            rng.uniform(0.8, 0.95),
        )
        for ended in ends
        for _ in range(10)
    ]


def _toward(q, gain, later, v, end, alpha):
    """Step toward a target: what the rewards earn, and `later` times what follows."""
    return q + alpha * (gain + later * v.max() * (not end) - q)


def _tell_backup(when: str) -> Callable[..., str]:
    return lambda found, wanted, q, *_: (
        f"{when}: from Q = {q:.2f} the new value is {wanted:.4g}, yours is {found:.4g}"
    )


@exercise(
    "Right: one number moves a little way toward what was really found. That is learning.",
    "Compute the target first, then go a step of size alpha from q toward it.",
    "With n = len(rewards), the rewards earn np.sum(rewards * gamma ** np.arange(n)).",
    "Unless the episode ended, add gamma**n * np.max(next_values). Return q + alpha * (target "
    "- q).",
    points=4,
    cases=_experiences(False),
    tell=_tell_backup("one cycle"),
    wrong={
        "rewards[0] + gamma * next_values.max()": "you put the target in place of the old value: "
        "go only a step of size alpha toward it",
        "backup(q, rewards, next_values, ended, alpha, gamma) - q": "that is the change of Q: add "
        "it",
        "backup(q, rewards, next_values, ended, 1 - alpha, gamma)": "alpha and 1 - alpha have "
        "changed places: alpha is the weight of what is new",
        "q + alpha * (rewards[0] + gamma * next_values.max())": "the target is added on top of the "
        "old value: what counts is the difference between them",
        "backup(q, rewards, next_values, ended, alpha, 1.0)": "what follows is not discounted: one "
        "cycle later it is worth gamma times as much",
        "backup(q, gamma * rewards, next_values, ended, alpha, gamma)": "the reward of the first "
        "cycle is discounted, though it is earned at once",
        "backup(q, rewards, next_values, True, alpha, gamma)": "nothing that follows counts in "
        "your target: gamma times the best next value is missing",
        "backup(q, rewards, [next_values.mean()], ended, alpha, gamma)": "you take the mean of the "
        "next values: the robot will choose the best",
        "backup(q, rewards, next_values[:1], ended, alpha, gamma)": "you take the first of the "
        "next values: the robot will choose the best",
    },
    then=(
        Part(
            cases=_experiences(True),
            tell=_tell_backup("one cycle that ended the episode"),
            wrong={
                "backup(q, rewards, next_values, False, alpha, gamma)": "where the episode has "
                "ended nothing can follow: leave the next value out of the target there",
                "rewards[0]": "you put the target in place of the old value where the episode "
                "ends: there, too, go only a step of size alpha",
                "q": "you learn nothing from the last experience, though it holds the reward",
            },
        ),
        Part(
            cases=_experiences(False, True, several=True),
            tell=_tell_backup("an action held for several cycles"),
            wrong={
                "_toward(q, rewards.sum(), gamma**len(rewards), next_values, ended, alpha)": "held "
                "for several cycles, later rewards are worth less: the k-th after the first is "
                "worth gamma to the k",
                "_toward(q, rewards.sum(), gamma, next_values, ended, alpha)": "held for several "
                "cycles, later rewards are worth less, and the next state comes later: one factor "
                "of gamma for each cycle",
                "backup(q, rewards, next_values * gamma ** (1 - len(rewards)), ended, "
                "alpha, gamma)": "the rewards are right; but the next state is only reached after "
                "all the cycles held, and you discount it by one",
                "backup(q, rewards, next_values / gamma, ended, alpha, gamma)": "the next state is "
                "reached after as many cycles as there are rewards: you discount it by one too "
                "few",
                "backup(q, gamma * rewards, next_values, ended, alpha, gamma)": "the first reward "
                "is discounted, though it is earned at once",
                "_toward(q, rewards[0], gamma**len(rewards), next_values, ended, alpha)": "only "
                "the first of the rewards counts in your target",
                "backup(q, rewards[:1], next_values, ended, alpha, gamma)": "an action held for "
                "several cycles is treated like one: all its rewards count, and the next state "
                "comes later",
                "_toward(q, rewards[-1], gamma**len(rewards), next_values, ended, alpha)": "only "
                "the last of the rewards counts in your target",
            },
        ),
    ),
)
def backup(q, rewards, next_values, ended, alpha, gamma):
    """Return the new Q(s, a), from the old one and what was found when a was held.

    Thesis, equation 2.12 and figure 4.3, with the discount of a semi-Markov process.
    """
    n = len(rewards)
    target = np.sum(rewards * gamma ** np.arange(n))
    if not ended:
        target += gamma**n * np.max(next_values)
    return q + alpha * (target - q)
