"""Checks for the notebook on ball approaching: reward a walk, draw an action, back up a value."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, numbers
from arkaq_edu.mdp import QLearner

Rng = np.random.Generator | int | None


def check_reward(reward: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``reward(distance, orientation)``: 0, 100 or 150.

    Parameters
    ----------
    reward : callable
        Takes the ball's distance in mm and its orientation in rad, returns the reward.
    rng : numpy.random.Generator or int, optional
        Where the random places of the ball come from.

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
    Thesis, section 5.2.2.

    Examples
    --------
    >>> check_reward(lambda distance, orientation: 100.0 * (distance < 500))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you never give the extra 50 for a ball straight ahead
    """
    rng = np.random.default_rng(rng)
    near = [(rng.uniform(200, 499), rng.uniform(-0.049, 0.049)) for _ in range(20)]
    aside = [(rng.uniform(200, 499), s * rng.uniform(0.051, 0.5)) for s in (-1, 1) * 10]
    far = [(rng.uniform(501, 4100), rng.uniform(-0.049, 0.049)) for _ in range(20)]
    edges = [(500.0, 0.0), (300.0, 0.05), (300.0, -0.05)]
    cases = [*near, *aside, *far, *edges]
    answers = [float(numbers("reward", ask(reward, *case), ())) for case in cases]
    _compare(
        cases, answers, lambda d, o: 100.0 * (d < 500) + 50.0 * (d < 500 and abs(o) <= 0.05),
        WRONG_REWARD, lambda d, o: f"a ball {d:.4g} mm away at {o:+.3g} rad is worth",
    )  # fmt: skip
    return "Right: that is all the robot will ever be told about its task."


# What is often done instead, and what to say of it.
WRONG_REWARD: list[Rule] = [
    (
        lambda d, o: 100.0 * (d < 500),
        "you never give the extra 50 for a ball straight ahead",
    ),
    (
        lambda d, o: 100.0 * (d < 500) + 50.0 * (abs(o) <= 0.05),
        "you give the extra 50 to a ball straight ahead at any distance: it is extra, for a ball "
        "that is reached",
    ),
    (
        lambda d, o: (50.0 if abs(o) <= 0.05 else 100.0) * (d < 500),
        "the 50 comes in place of the 100: it is given in addition, 150 in all",
    ),
    (
        lambda d, o: 100.0 * (d < 500) + 50.0 * (d < 500 and o <= 0.05),
        "any ball to the right earns your extra 50: an orientation to the right is negative",
    ),
    (
        lambda d, o: 100.0 * (d < 500) + 50.0 * (d < 500 and 0 <= o <= 0.05),
        "only balls to the left earn your extra 50: the interval goes to both sides",
    ),
    (
        lambda d, o: 100.0 * (d <= 500) + 50.0 * (d <= 500 and abs(o) <= 0.05),
        "at exactly 500 mm you give a reward: it takes a distance smaller than 500",
    ),
    (
        lambda d, o: 100.0 * (d < 500) + 50.0 * (d < 500 and abs(o) < 0.05),
        "at exactly .05 rad you give no extra 50: the ends belong to the interval [-.05, .05]",
    ),
]


def check_boltzmann(boltzmann: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``boltzmann(q, temperature)``: the probability of each action.

    Parameters
    ----------
    boltzmann : callable
        Takes the values of the actions, shape (A,), and the temperature; returns probabilities.
    rng : numpy.random.Generator or int, optional
        Where the random values and temperatures come from.

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
    Thesis, chapter 3, equation 3.2.

    Examples
    --------
    >>> import numpy as np
    >>> check_boltzmann(lambda q, temperature: np.exp(q / temperature))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: your probabilities do not sum to 1: divide each by the \
sum of all
    """
    rng = np.random.default_rng(rng)
    cases = [(rng.uniform(-2, 2, n), rng.uniform(1.5, 3)) for n in (2, 3, 3, 3, 4, 5)]
    answers = [numbers("boltzmann", ask(boltzmann, *case), case[0].shape) for case in cases]
    right = [_softmax(*case) for case in cases]
    if not all(np.allclose(one, other) for one, other in zip(answers, right, strict=True)):
        for rule, words in WRONG_BOLTZMANN:
            wrong = [rule(*case) for case in cases]
            if all(np.allclose(one, other) for one, other in zip(answers, wrong, strict=True)):
                raise ExerciseError(words)
        (q, temperature), answer, wanted = cases[1], answers[1], right[1]
        raise ExerciseError(
            f"for values {np.round(q, 2)} at temperature {temperature:.2f} you give the first "
            f"action {answer[0]:.4f}, and it should have {wanted[0]:.4f}"
        )
    # exp(709) is the largest that a float can hold; exp(-746) is nought.
    for q in (np.array([1490.0, 1500.0, 1480.0]), -np.array([1490.0, 1500.0, 1480.0])):
        with np.errstate(all="ignore"):
            answer = np.asarray(ask(boltzmann, q, 1.0), dtype=float)
        if answer.shape != q.shape or not np.allclose(answer, _softmax(q, 1.0)):
            raise ExerciseError(
                f"values of {q[0]:g} at temperature 1 are too much for exp: take the largest value "
                "away from all of them first, which changes no probability"
            )
    return "Right: and however large the values or low the temperature, nothing overflows."


def _softmax(q: NDArray[np.float64], temperature: float) -> NDArray[np.float64]:
    learner = QLearner(1, len(q), alpha=0.0, gamma=0.0)
    learner.Q[0] = q
    return learner.probabilities(0, temperature)


def _shares(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    return weights / weights.sum()


WRONG_BOLTZMANN: list[tuple[Callable[[NDArray[Any], float], NDArray[Any]], str]] = [
    (
        lambda q, t: np.exp(q / t),
        "your probabilities do not sum to 1: divide each by the sum of all",
    ),
    (
        lambda q, t: np.exp((q - q.max()) / t),
        "your probabilities do not sum to 1: divide each by the sum of all",
    ),
    (
        lambda q, t: _shares(np.exp(-q / t)),
        "the worst action is the likeliest: look at the sign in the exponent",
    ),
    (
        lambda q, t: _shares(np.exp((q - q.max()) * t)),
        "you multiply by the temperature: a hot agent should choose more evenly, yours is surer",
    ),
    (
        lambda q, t: _shares(np.exp(q - q.max())),
        "the temperature changes nothing: divide the values by it, in the exponent",
    ),
    (
        lambda q, t: _shares(np.exp(q - q.max()) / t),
        "the temperature cancels: it belongs into the exponent, under the value",
    ),
    (
        lambda q, t: np.eye(len(q))[np.argmax(q)],
        "you give all to the best action: that is the limit of temperature 0",
    ),
    (
        lambda q, t: np.full(len(q), 1 / len(q)),
        "you give all actions the same: that is the limit of an infinite temperature",
    ),
    (
        lambda q, t: _shares(q),
        "you share by the values themselves, which may be negative: take exp(value / temperature)",
    ),
]


def check_backup(backup: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``backup(q, rewards, next_values, ended, alpha, gamma)``: the new Q(s, a).

    Parameters
    ----------
    backup : callable
        Takes the old Q(s, a), the rewards of the cycles for which the action was held, the values
        of the actions in the next state, whether the episode ended there, the learning rate and
        the discount; returns the new Q(s, a).
    rng : numpy.random.Generator or int, optional
        Where the random experiences come from.

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
    Thesis, equation 2.12 and figure 4.3, with the semi-Markov discount that holding an action
    asks for.

    Examples
    --------
    >>> import numpy as np
    >>> def backup(q, rewards, next_values, ended, alpha, gamma):
    ...     return q + alpha * (np.sum(rewards) + gamma * np.max(next_values) - q)
    >>> check_backup(backup)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: where the episode has ended nothing can follow: no \
next value belongs into the target there
    """
    rng = np.random.default_rng(rng)
    cases = [
        (
            rng.uniform(0, 100),
            rng.uniform(1, 50, int(rng.integers(2, 6)) if several else 1),
            rng.uniform(0, 100, 3),
            ended,
            rng.uniform(0.1, 0.4),
            rng.uniform(0.8, 0.95),
        )
        for several in (False, True)
        for ended in (False, True)
        for _ in range(10)
    ]
    answers = [float(numbers("backup", ask(backup, *case), ())) for case in cases]
    # One cycle, not over: the plain rule. Then what an end changes, and what holding changes.
    for part, rules, tell in (
        (slice(0, 10), WRONG_BACKUP, "one cycle"),
        (slice(10, 20), WRONG_END, "one cycle that ended the episode"),
        (slice(20, 40), WRONG_HOLD, "an action held for several cycles"),
    ):
        _compare(
            cases[part], answers[part], _backup, rules,
            lambda q, *_, tell=tell: f"{tell}: from Q = {q:.2f} the new value is",
        )  # fmt: skip
    return "Right: one number moves a little way toward what was really found. That is learning."


def _discounted(rewards: NDArray[np.float64], gamma: float) -> float:
    return float(rewards @ gamma ** np.arange(len(rewards)))


def _backup(q, rewards, next_values, ended, alpha, gamma) -> float:
    learner = QLearner(2, len(next_values), alpha=alpha, gamma=gamma)
    learner.Q[0, 0], learner.Q[1] = q, next_values
    learner.update(0, 0, _discounted(rewards, gamma), 1, bool(ended), len(rewards))
    return float(learner.Q[0, 0])


WRONG_BACKUP: list[Rule] = [
    (
        lambda q, r, v, end, alpha, gamma: r[0] + gamma * v.max(),
        "you put the target in place of the old value: only a step of size alpha leads to it",
    ),
    (
        lambda q, r, v, end, alpha, gamma: alpha * (r[0] + gamma * v.max() - q),
        "that is the change of Q: add it to the old value",
    ),
    (
        lambda q, r, v, end, alpha, gamma: alpha * q + (1 - alpha) * (r[0] + gamma * v.max()),
        "alpha and 1 - alpha have changed places: alpha is the weight of what is new",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (r[0] + gamma * v.max()),
        "the target is added on top of the old value: what counts is the difference between them",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (r[0] + v.max() - q),
        "what follows is not discounted: one cycle later it is worth gamma times as much",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (gamma * (r[0] + v.max()) - q),
        "the reward of the first cycle is discounted, though it is earned at once",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (r[0] - q),
        "nothing that follows counts in your target: gamma times the best next value is missing",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (r[0] + gamma * v.mean() - q),
        "you take the mean of the next values: the robot will choose the best",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (r[0] + gamma * v[0] - q),
        "you take the first of the next values: the robot will choose the best",
    ),
]

WRONG_END: list[Rule] = [
    (
        lambda q, r, v, end, alpha, gamma: q + alpha * (r[0] + gamma * v.max() - q),
        "where the episode has ended nothing can follow: no next value belongs into the target "
        "there",
    ),
    (
        lambda q, r, v, end, alpha, gamma: r[0],
        "the end is learned from like all else: a step of size alpha toward the target",
    ),
    (
        lambda q, r, v, end, alpha, gamma: q,
        "from an episode's last experience nothing is learned, though it holds the reward",
    ),
]

WRONG_HOLD: list[Rule] = [
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (r.sum() + gamma ** len(r) * v.max() * (not end) - q)
        ),
        "held for several cycles, later rewards are worth less: the k-th after the first is worth "
        "gamma to the k",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (r.sum() + gamma * v.max() * (not end) - q)
        ),
        "held for several cycles, later rewards are worth less, and the next state comes later: "
        "one factor of gamma for each cycle",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (_discounted(r, gamma) + gamma * v.max() * (not end) - q)
        ),
        "the rewards are right; but the next state is only reached after all the cycles held, and "
        "you discount it by one",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (_discounted(r, gamma) + gamma ** (len(r) - 1) * v.max() * (not end) - q)
        ),
        "the next state is reached after as many cycles as there are rewards: you discount it by "
        "one too few",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (gamma * _discounted(r, gamma) + gamma ** len(r) * v.max() * (not end) - q)
        ),
        "the first reward is discounted, though it is earned at once",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (r[0] + gamma ** len(r) * v.max() * (not end) - q)
        ),
        "only the first of the rewards counts in your target",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (r[0] + gamma * v.max() * (not end) - q)
        ),
        "an action held for several cycles is treated like one: all its rewards count, and the "
        "next state comes later",
    ),
    (
        lambda q, r, v, end, alpha, gamma: (
            q + alpha * (r[-1] + gamma ** len(r) * v.max() * (not end) - q)
        ),
        "only the last of the rewards counts in your target",
    ),
]  # fmt: skip


def _compare(
    cases: list[Any],
    answers: list[float],
    right: Callable[..., float],
    wrong: list[Rule],
    about: Callable[..., str],
) -> None:
    """Say in what way the answers are wrong, if they are: by a rule that explains all of them."""

    def agree(rule: Callable[..., float]) -> bool:
        return np.allclose(answers, [rule(*case) for case in cases], rtol=0, atol=1e-9)

    if agree(right):
        return
    for rule, words in wrong:
        if agree(rule):
            raise ExerciseError(words)
    for case, answer in zip(cases, answers, strict=True):
        wanted = right(*case)
        if not np.isclose(answer, wanted, rtol=0, atol=1e-9):
            raise ExerciseError(f"{about(*case)} {wanted:.4g}, yours is {answer:.4g}")
