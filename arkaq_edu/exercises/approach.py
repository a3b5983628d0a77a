"""Exercises of chapter 10: reward a walk, draw an action, back up a value."""

from typing import Any

import numpy as np

from arkaq_edu.exercises.exercise import Cases, Draws, Part, Rule, ask, exercise, judgement


def _places(rng: np.random.Generator) -> Draws:
    low = [(200, -0.049), (200, 0.051), (200, -0.5), (501, -0.049)]
    high = [(499, 0.049), (499, 0.5), (499, -0.051), (4100, 0.049)]
    places = rng.uniform(low, high, (15, 4, 2)).reshape(-1, 2).tolist()
    return [*map(tuple, places), (500.0, 0.0), (300.0, 0.05), (300.0, -0.05)]


@exercise(Part(_places))
def reward(distance, orientation):
    """Return what the ball's place (mm, rad) is worth.

    Thesis, section 5.2.2.
    """
    if distance >= 500:
        return 0
    return 150 if abs(orientation) <= 0.05 else 100


def _or_nothing(function: Rule, *case: Any) -> Any:
    """Ask for values that overflow, and take what is not a number as 0."""
    return np.nan_to_num(np.asarray(ask(function, *case), dtype=float))


@exercise(
    usual=Part(
        lambda rng: [(rng.uniform(-2, 2, n), rng.uniform(1.5, 3)) for n in (2, 3, 3, 3, 4, 5)]
    ),
    huge=Part(
        # exp(709) is the largest that a float can hold; exp(-746) is 0.
        lambda rng: [(s * np.array([1490.0, 1500.0, 1480.0]), 1.0) for s in (1, -1)],
        answer=_or_nothing,
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


@exercise(
    one_cycle=Part(_experiences(False)),
    ended=Part(_experiences(True)),
    held=Part(_experiences(False, True, several=True)),
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


@exercise(judgement(4))
def which_recipe():
    """Return the number of the right answer."""
    return 3
