"""Checks for the notebook on reinforcement learning: two sums of rewards, a choice, the regret."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, judge

Rng = np.random.Generator | int | None

SUMMED = "Right: h rewards, from now on, and not one more."
DISCOUNTED = "Right: each reward counts gamma times as much as if it came a step sooner."
CHOSEN = "Right: mostly the best so far, now and then any of them."
REGRETTED = "Right: what the best machine would have paid, less what yours pay, so far."


def check_finite_sum(finite_sum: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``finite_sum(rewards, h)``: what the next h steps earn.

    Parameters
    ----------
    finite_sum : callable
        Takes rewards, shape (T,), the first of them now, and a horizon of 1 to T; returns a number.
    rng : numpy.random.Generator or int, optional
        Where the random rewards come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, equation 2.1.

    Examples
    --------
    >>> check_finite_sum(lambda rewards, h: sum(rewards[: h + 1]))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you add h + 1 rewards: the first is at t = 0, so the \
last of h is at t = h - 1
    """
    rng = np.random.default_rng(rng)
    cases = [(rng.uniform(0.5, 9, 12).round(1), int(h)) for h in rng.integers(2, 10, 19)]
    cases.append((rng.uniform(0.5, 9, 6).round(1), 6))
    judge("finite_sum", finite_sum, cases, _finite_sum, WRONG_SUM)
    return SUMMED


def check_discounted_sum(discounted_sum: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``discounted_sum(rewards, gamma)``: each reward weighed by its delay.

    Parameters
    ----------
    discounted_sum : callable
        Takes rewards, shape (T,), the first of them now, and a discount rate; returns a number.
    rng : numpy.random.Generator or int, optional
        Where the random rewards come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, equation 2.2.

    Examples
    --------
    >>> check_discounted_sum(lambda rewards, gamma: gamma * sum(rewards))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: all your rewards count alike: a reward t steps away \
counts gamma to the power of t
    """
    rng = np.random.default_rng(rng)
    cases = [(rng.uniform(0.5, 9, 8).round(1), float(rng.uniform(0.3, 0.95))) for _ in range(20)]
    judge("discounted_sum", discounted_sum, cases, _discounted_sum, WRONG_DISCOUNT)
    return DISCOUNTED


def check_epsilon_greedy(epsilon_greedy: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``epsilon_greedy(means, epsilon, rng)``: which machine to pull.

    Parameters
    ----------
    epsilon_greedy : callable
        Takes what each machine has paid on average, shape (k,), the chance to explore, and a
        generator; returns the index of a machine.
    rng : numpy.random.Generator or int, optional
        Where the random numbers come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 2.1.3, and equation 3.3 for ties.

    Examples
    --------
    >>> check_epsilon_greedy(lambda means, epsilon, rng: int(means.argmax()))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: yours never explores: with probability epsilon any \
machine should be pulled
    """
    rng = np.random.default_rng(rng)
    best = int(rng.integers(4))
    means = rng.uniform(0.1, 0.5, 4)
    means[best] = 0.8
    greedy, mixed, wild = (
        _shares(epsilon_greedy, means, epsilon, rng) for epsilon in (0.0, 0.4, 1.0)
    )
    if greedy[best] < 1:
        raise ExerciseError(_greedy_words(greedy, means, best))
    if wild[best] == 1 and mixed[best] == 1:
        raise ExerciseError(
            "yours never explores: with probability epsilon any machine should be pulled"
        )
    if wild[best] == 0:
        raise ExerciseError(
            "where you explore you leave the best machine out: any of them may be pulled, that one "
            "too"
        )
    if (wild == 0).any():
        raise ExerciseError("where you explore, some machine is never pulled: all should be alike")
    if not _fits(wild, np.full(4, 0.25)):
        raise ExerciseError("where you explore, all machines should be equally likely")
    if not _fits(mixed, 0.6 * np.eye(4)[best] + 0.1):
        raise ExerciseError(
            f"with epsilon = 0.4 and four machines the best is pulled in {mixed[best]:.0%} of the "
            "cases: that is too " + ("rare" if mixed[best] < 0.7 else "frequent")
        )
    tied = np.array([0.5, 0.2, 0.5, 0.5])
    shares = _shares(epsilon_greedy, tied, 0.0, rng)
    if (shares[[0, 2, 3]] == 0).any():
        raise ExerciseError(
            "of machines that are equally good, you always take the same: they should share"
        )
    if not _fits(shares, np.array([1, 0, 1, 1]) / 3):
        raise ExerciseError("machines that are equally good should be equally likely")
    return CHOSEN


def check_regret(regret: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``regret(p, arms)``: how much was lost up to each pull.

    Parameters
    ----------
    regret : callable
        Takes the chance of each machine, shape (k,), and the machine of each pull, shape (T,) of
        int; returns an array of shape (T,).
    rng : numpy.random.Generator or int, optional
        Where the random machines and pulls come from.

    Returns
    -------
    str
        A line of praise.

    Raises
    ------
    ExerciseError
        With the way in which the answer is wrong.

    References
    ----------
    Thesis, section 2.1.2, third measure.

    Examples
    --------
    >>> check_regret(lambda p, arms: p.max() - p[arms])
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: that is the loss of each pull by itself: add up what \
was lost so far
    """
    rng = np.random.default_rng(rng)
    # The best machine is neither the first nor the last; nobody pulls it at first, and some never.
    arms = rng.integers(0, 4, (20, 9))
    arms[:, 0] = 0
    arms[:5][arms[:5] == 2] = 3
    chances = rng.uniform(0.1, 0.6, (20, 4)).round(2)
    chances[:, 2] = 0.9
    cases = list(zip(chances, arms, strict=True))
    judge("regret", regret, cases, _regret, WRONG_REGRET)
    return REGRETTED


def _finite_sum(rewards: NDArray[np.float64], h: int) -> float:
    return float(rewards[:h].sum())


# What is often done instead, and what to say of it.
WRONG_SUM: list[Rule] = [
    (
        lambda r, h: r[: h + 1].sum(),
        "you add h + 1 rewards: the first is at t = 0, so the last of h is at t = h - 1",
    ),
    (
        lambda r, h: r[1 : h + 1].sum(),
        "you leave out the reward of now, t = 0, and add one that comes too late",
    ),
    (
        lambda r, h: r[1:h].sum(),
        "you leave out the reward of now: the sum begins at t = 0",
    ),
    (
        lambda r, h: r[: h - 1].sum(),
        "you add h - 1 rewards: the last one counts too",
    ),
    (
        lambda r, h: r.sum(),
        "you add all the rewards: only the first h of them count",
    ),
    (
        lambda r, h: r[:h].mean(),
        "that is their mean: the finite-horizon model takes the sum",
    ),
    (
        lambda r, h: r[h - 1],
        "that is the last reward alone: all h of them count",
    ),
    (
        lambda r, h: r[:h].cumsum(),
        "those are the sums up to each step: the last of them is asked for",
    ),
]


def _discounted_sum(rewards: NDArray[np.float64], gamma: float) -> float:
    return float(rewards @ gamma ** np.arange(len(rewards)))


WRONG_DISCOUNT: list[Rule] = [
    (
        lambda r, g: r.sum(),
        "you never use gamma: a reward t steps away counts gamma to the power of t",
    ),
    (
        lambda r, g: g * r.sum(),
        "all your rewards count alike: a reward t steps away counts gamma to the power of t",
    ),
    (
        lambda r, g: g * _discounted_sum(r, g),
        "you discount the first reward too: it is earned now, at t = 0, and counts in full",
    ),
    (
        lambda r, g: _discounted_sum(r[::-1], g),
        "you have the far end of time first: the last reward is the one that counts least",
    ),
    (
        lambda r, g: r @ (1 - g) ** np.arange(len(r)),
        "you weigh by powers of 1 - gamma: a gamma near 1 should make the future count",
    ),
    (
        lambda r, g: r[0] + g * r[1:].sum(),
        "all the later rewards count alike: each step away costs another factor of gamma",
    ),
    (
        lambda r, g: r @ (1 / g) ** np.arange(len(r)),
        "your later rewards count more: gamma is to be multiplied by, not divided by",
    ),
    (
        lambda r, g: r @ (g * np.arange(len(r))),
        "you weigh by gamma times t: it is gamma to the power of t",
    ),
    (
        lambda r, g: (1 - g) * _discounted_sum(r, g),
        "that is the sum made comparable per step, times 1 - gamma: leave that out here",
    ),
    (
        lambda r, g: r * g ** np.arange(len(r)),
        "each reward is weighed as it should be: now add them up",
    ),
]


def _shares(
    epsilon_greedy: Callable[..., Any],
    means: NDArray[np.float64],
    epsilon: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return how often each machine is pulled, of 2,000 times; refuse what is no machine."""
    k = len(means)
    seed = int(rng.integers(2**32))
    draws = [np.random.default_rng(seed), np.random.default_rng(seed)]
    pulled = [[_machine(epsilon_greedy, means, epsilon, lots) for _ in range(20)] for lots in draws]
    if pulled[0] != pulled[1]:
        raise ExerciseError(
            "with equal generators yours chooses differently: draw from rng and nothing else"
        )
    pulls = [_machine(epsilon_greedy, means, epsilon, rng) for _ in range(2000)]
    return np.bincount(pulls, minlength=k) / len(pulls)


def _machine(
    epsilon_greedy: Callable[..., Any],
    means: NDArray[np.float64],
    epsilon: float,
    rng: np.random.Generator,
) -> int:
    answer = ask(_drawing_from(rng, epsilon_greedy), means, epsilon)
    found = np.asarray(answer)
    if found.shape != () or found.dtype.kind not in "iu" or not 0 <= found < len(means):
        raise ExerciseError(
            f"epsilon_greedy should return the index of a machine, 0 to {len(means) - 1}, "
            f"not {answer!r}"
        )
    return int(found)


def _drawing_from(rng: np.random.Generator, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function with its last argument filled in: drawing is no change to a generator."""
    if not callable(function):
        return function

    def drawing(*arguments: Any) -> Any:
        return function(*arguments, rng)

    drawing.__name__ = getattr(function, "__name__", "epsilon_greedy")
    return drawing


def _greedy_words(shares: NDArray[np.float64], means: NDArray[np.float64], best: int) -> str:
    if shares[int(means.argmin())] == 1:
        return "with epsilon = 0 yours pulls the worst machine"
    if shares[best] < 0.5:
        return (
            "with epsilon = 0 yours explores: it should do so with probability epsilon, and else "
            "pull the best"
        )
    return "with epsilon = 0 yours does not always pull the best machine"


def _fits(shares: NDArray[np.float64], wanted: NDArray[np.float64]) -> bool:
    """Return whether shares of 2,000 pulls are within what chance explains, at five sigma."""
    return bool((np.abs(shares - wanted) <= 5 * np.sqrt(wanted * (1 - wanted) / 2000)).all())


def _regret(p: NDArray[np.float64], arms: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.cumsum(p.max() - p[arms])


WRONG_REGRET: list[Rule] = [
    (
        lambda p, arms: p.max() - p[arms],
        "that is the loss of each pull by itself: add up what was lost so far",
    ),
    (
        lambda p, arms: _regret(p, arms)[-1],
        "that is the regret after the last pull: after each of them is asked for",
    ),
    (
        lambda p, arms: -_regret(p, arms),
        "your regret is negative: it is what the best would have paid, less what yours pay",
    ),
    (
        lambda p, arms: np.cumsum(p.mean() - p[arms]),
        "you compare with the mean of the machines: regret compares with the best of them",
    ),
    (
        lambda p, arms: np.cumsum(p[arms].max() - p[arms]),
        "you compare with the best machine that was pulled: regret compares with the best there is",
    ),
    (
        lambda p, arms: np.cumsum(np.maximum.accumulate(p[arms]) - p[arms]),
        "you compare with the best machine so far: regret compares with the best there is",
    ),
    (
        lambda p, arms: np.cumsum(1 - p[arms]),
        "you compare with a coin at every pull: not even the best machine pays that",
    ),
    (
        lambda p, arms: np.cumsum(p[arms]),
        "that is what was earned: regret is what the best machine would have paid beyond it",
    ),
    (
        lambda p, arms: _regret(p, arms) / np.arange(1, len(arms) + 1),
        "that is the regret of a pull on average: add up, and do not divide",
    ),
]
