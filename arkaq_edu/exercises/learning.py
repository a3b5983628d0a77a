"""Exercises of chapter 1: two sums of rewards, a choice, the regret."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Cases, ExerciseError, Part, exercise, index

#: How often each machine is pulled is counted over so many calls.
PULLS = 2000


@exercise(
    "Right: h rewards, from now on, and not one more.",
    "Write the rewards in a row and the time of each below: t = 0, 1, 2, ...",
    "The first reward counts, so the last one is at t = h - 1.",
    "A slice gives the first h rewards. Add them with sum.",
    points=1,
    cases=lambda rng: [
        *((rng.uniform(0.5, 9, 12).round(1), int(h)) for h in rng.integers(2, 10, 19)),
        (rng.uniform(0.5, 9, 6).round(1), 6),
    ],
    wrong={
        "rewards[:h + 1].sum()": "you add h + 1 rewards: the last of h is at t = h - 1",
        "rewards[1:h + 1].sum()": "you leave out the reward at t = 0, and add one that comes too "
        "late",
        "rewards[1:h].sum()": "you leave out the immediate reward: the sum begins at t = 0",
        "rewards[:h - 1].sum()": "you add h - 1 rewards: the last one counts too",
        "rewards.sum()": "you add all the rewards: only the first h of them count",
        "rewards[:h].mean()": "that is their mean: the finite-horizon model takes the sum",
        "rewards[h - 1]": "that is only the last reward: all h of them count",
        "rewards[:h].cumsum()": "those are the sums up to each step: return the last of them",
    },
)
def finite_sum(rewards, h):
    """Return the sum of the first h rewards.

    Thesis, equation 2.1.
    """
    return sum(rewards[:h])


@exercise(
    "Right: each reward counts gamma times as much as if it came a step sooner.",
    "The first reward counts in full. How much does the second count, and the third?",
    "The reward at t counts gamma to the power of t.",
    "From the last reward to the first: G = r + gamma * G, starting at G = 0.",
    cases=lambda rng: [
        (rng.uniform(0.5, 9, 8).round(1), float(rng.uniform(0.3, 0.95))) for _ in range(20)
    ],
    wrong={
        "rewards.sum()": "you never use gamma: a reward t steps away counts gamma to the t",
        "gamma * rewards.sum()": "all your rewards count alike: at t they count gamma to the t",
        "gamma * discounted_sum(rewards, gamma)": "you discount the first reward too: it is earned "
        "now, at t = 0, and counts in full",
        "discounted_sum(rewards[::-1], gamma)": "your order is reversed: the last counts least",
        "discounted_sum(rewards, 1 - gamma)": "you use powers of 1 - gamma: a gamma near 1 should "
        "make the future count",
        "rewards[0] + gamma * rewards[1:].sum()": "all the later rewards count alike: each step "
        "away costs another factor of gamma",
        "discounted_sum(rewards, 1 / gamma)": "later rewards count more: multiply, do not divide",
        "rewards @ (gamma * np.arange(len(rewards)))": "you use gamma times t: it is gamma to the "
        "t",
        "(1 - gamma) * discounted_sum(rewards, gamma)": "you multiply by 1 - gamma, as for a "
        "reward per step: leave that out",
        "rewards * gamma**np.arange(len(rewards))": "each reward is right: now add them up",
    },
)
def discounted_sum(rewards, gamma):
    """Return the sum of all rewards, the one at t multiplied by gamma to the power of t.

    Thesis, equation 2.2.
    """
    G = 0.0
    for r in reversed(rewards):
        G = r + gamma * G
    return G


def _four_machines(epsilon: float) -> Cases:
    def cases(rng: np.random.Generator) -> list[tuple[Any, ...]]:
        means = rng.uniform(0.1, 0.5, 4)
        means[rng.integers(4)] = 0.8
        return [(means, epsilon, int(rng.integers(2**32)))]

    return cases


_machine = index("machine", lambda means, epsilon, rng: len(means))


def _shares(
    function: Callable[..., Any], means: NDArray[np.float64], epsilon: float, seed: int
) -> NDArray[np.float64]:
    """Return how often each machine is pulled."""

    def pulls(n: int) -> list[int]:
        rng = np.random.default_rng(seed)
        return [_machine(function, means, epsilon, rng) for _ in range(n)]

    if pulls(20) != pulls(20):
        raise ExerciseError(
            "with equal generators yours chooses differently: draw from rng and nothing else"
        )
    return np.bincount(pulls(PULLS), minlength=len(means)) / PULLS


def _due(means: NDArray[np.float64], epsilon: float, seed: int) -> NDArray[np.float64]:
    best = means == means.max()
    return (1 - epsilon) * best / best.sum() + epsilon / len(means)


def _within_chance(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Compare shares at five standard errors."""
    return np.abs(found - wanted) <= 5 * np.sqrt(wanted * (1 - wanted) / PULLS)


def _tell_greedy(found, wanted, means, epsilon, seed):
    if found[means.argmax()] < 0.5:
        return (
            "with epsilon = 0 yours explores: it should explore only with probability epsilon, and "
            "otherwise pull the best"
        )
    return "with epsilon = 0 yours does not always pull the best machine"


def _tell_exploring(found, wanted, means, epsilon, seed):
    if found[means.argmax()] == 0:
        return (
            "when you explore you leave the best machine out: any machine may be pulled, that one "
            "too"
        )
    if (found == 0).any():
        return "when you explore, some machine is never pulled: all should be equally likely"
    return "when you explore, all machines should be equally likely"


def _tell_mixed(found, wanted, means, epsilon, seed):
    share, most = found[means.argmax()], wanted.max()
    return (
        f"with epsilon = {epsilon} and four machines the best is pulled in {share:.0%} of the "
        f"cases: that is too {'rare' if share < most else 'frequent'}"
    )


def _tell_tied(found, wanted, means, epsilon, seed):
    if (found[wanted > 0] == 0).any():
        return "of machines that are equally good, you always take the same: they should share"
    return "machines that are equally good should be equally likely"


_pulled: dict[str, Any] = {"answer": _shares, "right": _due, "close": _within_chance}


@exercise(
    "Right: mostly the best so far, now and then any of them.",
    "There are two cases. A random number decides between them.",
    "rng.random() < epsilon is true with probability epsilon: then rng.integers(len(means)).",
    "Otherwise rng.choice among np.flatnonzero(means == means.max()), all the best ones.",
    points=3,
    cases=_four_machines(0.0),
    **_pulled,
    wrong={
        "np.eye(4)[means.argmin()]": "with epsilon = 0 yours pulls the worst machine",
    },
    tell=_tell_greedy,
    then=(
        Part(
            cases=_four_machines(1.0),
            **_pulled,
            wrong={
                "np.eye(4)[means.argmax()]": "yours never explores: with probability epsilon any "
                "machine should be pulled",
            },
            tell=_tell_exploring,
        ),
        Part(cases=_four_machines(0.4), **_pulled, tell=_tell_mixed),
        Part(
            cases=lambda rng: [(np.array([0.5, 0.2, 0.5, 0.5]), 0.0, int(rng.integers(2**32)))],
            **_pulled,
            tell=_tell_tied,
        ),
    ),
)
def epsilon_greedy(means, epsilon, rng):
    """Return the index of the machine to pull.

    Thesis, section 2.1.3; ties as in equation 3.3.
    """
    if rng.random() < epsilon:
        return rng.integers(len(means))
    return rng.choice(np.flatnonzero(means == means.max()))


def _pulls(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    """Draw cases whose best machine is not pulled first, and in some never."""
    arms = rng.integers(0, 4, (20, 9))
    arms[:, 0] = 0
    arms[:5][arms[:5] == 2] = 3
    chances = rng.uniform(0.1, 0.6, (20, 4)).round(2)
    chances[:, 2] = 0.9
    return list(zip(chances, arms, strict=True))


@exercise(
    "Right: what the best machine would have paid so far, minus what yours pay.",
    "How much does a single pull lose, compared with the best machine?",
    "One pull loses p.max() - p[arm], on average.",
    "p[arms] has one number for each pull, and np.cumsum adds up all losses so far.",
    returns="one number for each pull",
    cases=_pulls,
    wrong={
        "p.max() - p[arms]": "that is the loss of each pull by itself: add up what was lost so far",
        "regret(p, arms)[-1]": "that is only the regret after the last pull: return all of them",
        "-regret(p, arms)": "your regret is negative: subtract what yours pay from the best",
        "np.cumsum(p.mean() - p[arms])": "you compare with the mean of the machines: regret "
        "compares with the best of them",
        "np.cumsum(p[arms].max() - p[arms])": "you compare with the best machine that was pulled: "
        "regret compares with the best there is",
        "np.cumsum(np.maximum.accumulate(p[arms]) - p[arms])": "you compare with the best machine "
        "so far: regret compares with the best there is",
        "np.cumsum(1 - p[arms])": "you compare with a coin at every pull: no machine pays that",
        "np.cumsum(p[arms])": "that is what was earned: regret is what the best would have paid "
        "beyond it",
        "regret(p, arms) / np.arange(1, len(arms) + 1)": "that is the average regret: do not "
        "divide",
    },
)
def regret(p, arms):
    """Return the regret after each pull, an array as long as arms.

    Thesis, section 2.1.2, the third measure.
    """
    return np.cumsum(p.max() - p[arms])
