"""Exercises of chapter 2: a backup, greedy actions, TD(0), a learning rate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import Cases, ExerciseError, Part, ask, exercise

#: A rate is tried on so many visits. Then at most so much may be left of the first value, and of
#: the standard deviation of a single target: 1/n passes, and n^-p with p from 0.55 to 1.
VISITS, START_LEFT, SCATTER_LEFT = 100_000, 0.01, 0.035


def _q(T, R, gamma, V):
    return R + gamma * (T @ V).T


def _models(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    """Draw T, R, gamma and V of small models in which no two actions are nearly equal."""
    models: list[tuple[Any, ...]] = []
    while len(models) < 20:
        n_states, n_actions = int(rng.integers(3, 6)), int(rng.integers(2, 5))
        T = rng.dirichlet(np.ones(n_states), size=(n_actions, n_states))
        R, V = rng.uniform(-5, 20, (n_states, n_actions)), rng.uniform(0, 60, n_states)
        gamma = float(rng.uniform(0.6, 0.95))
        gaps = np.diff(np.sort(_q(T, R, gamma, V), axis=1), axis=1)
        if gaps.min() > 0.1 and n_states != n_actions:
            models.append((T, R, gamma, V))
    return models


@exercise(
    "Right: what the best action earns now, and what the states after it are worth.",
    "Begin with one action: what does it earn now, and where may it lead?",
    "What follows action a is worth T[a, s] @ V, one step later.",
    "Compute R[s, a] + gamma * T[a, s] @ V for each action a, and return the largest.",
    points=3,
    cases=lambda rng: [(*model, int(rng.integers(3))) for model in _models(rng)],
    wrong={
        "R[s].max()": "that is only the best immediate reward: what follows counts too",
        "gamma * R[s].max()": "that is equation 2.7 as printed: the immediate reward is not "
        "discounted, and what follows counts too",
        "gamma * (R[s] + T[:, s] @ V).max()": "the immediate reward is discounted too: multiply by "
        "gamma only what comes a step later",
        "gamma * (T[:, s] @ V).max()": "the immediate reward is missing",
        "bellman(T, R, 1.0, V, s)": "what follows is not discounted: a step later it is worth "
        "gamma times as much",
        "R[s].max() + gamma * (T[:, s] @ V).max()": "you take two maxima: but one and the same "
        "action earns the reward and leads on",
        "_q(T, R, gamma, V)[s].mean()": "you take the mean over the actions: take the best",
        "_q(T, R, gamma, V)[s].sum()": "you add the actions up: the robot takes only one",
        "_q(T, R, gamma, V)[s].min()": "that is the worst action: take the best",
        "_q(T, R, gamma, V)[s].argmax()": "that is the best action: return how much it is worth",
        "_q(T, R, gamma, V)[s]": "those are the values of all actions: take the best of them",
        "(R[s] + gamma * V.max()).max()": "you hope for the best next state: T says how likely "
        "each is",
        "(R[s] + gamma * V.sum()).max()": "the values that may follow are added up: each counts by "
        "its probability in T",
        "bellman(T.transpose(0, 2, 1), R, gamma, V, s)": "you sum over the states before: T[a, s] "
        "says where the robot goes from s",
    },
)
def bellman(T, R, gamma, V, s):
    """Return the value of state s, if V are the values one step later.

    Thesis, section 2.2.1, equation 2.8.
    """
    return max(R[s, a] + gamma * T[a, s] @ V for a in range(len(T)))


@exercise(
    "Right: from good values the best actions follow in one step.",
    "Compute the value of every action in every state first. Then choose.",
    "T @ V has a row for each action and a column for each state: turn it round with .T.",
    "The values are R + gamma * (T @ V).T, and argmax(axis=1) finds the best of each row.",
    returns="the number of an action for each state",
    cases=_models,
    wrong={
        "R.argmax(axis=1)": "those are best for the immediate reward, equation 2.6: V is never "
        "used",
        "(T @ V).T.argmax(axis=1)": "those lead to the best states: the reward is missing",
        "_q(T, R, gamma, V).max(axis=1)": "those are the values of the best: return their indices",
        "_q(T, R, gamma, V)": "those are the values of all actions: which of a row is the largest?",
        "_q(T, R, gamma, V).argmin(axis=1)": "those are the worst actions",
        "_q(T, R, gamma, V).argmax(axis=0)": "that is the best state of each action: return the "
        "best action of each state",
        "greedy(T, R, gamma, V) + 1": "your actions count from 1: Python's count from 0",
        "greedy(T, R, 1.0, V)": "what follows is not discounted: a step later it is worth gamma "
        "times as much",
        "greedy(T.transpose(0, 2, 1), R, gamma, V)": "you sum over the states before: T[a, s] says "
        "where the robot goes from s",
    },
)
def greedy(T, R, gamma, V):
    """Return the best action of each state, if V are the values one step later.

    Thesis, section 2.2.1, equations 2.6 and 2.9.
    """
    return (R + gamma * (T @ V).T).argmax(axis=1)


def _steps(ended: bool) -> Cases:
    low, high = [10, 1, 10, 0.1, 0.7], [90, 40, 90, 0.4, 0.95]
    return lambda rng: [
        (v, r, v_next, ended, alpha, gamma)
        for v, r, v_next, alpha, gamma in rng.uniform(low, high, (20, 5)).tolist()
    ]


@exercise(
    "Right: a guess, moved toward a better guess. No model was needed.",
    "What does the robot know after the step that it did not know before?",
    "The target is r + gamma * v_next, or only r if the episode has ended.",
    "Go a step of size alpha toward it: v + alpha * (target - v).",
    cases=_steps(False),
    wrong={
        "r + gamma * v_next": "you put the target in place of the old value: go only a step of "
        "size alpha toward it",
        "alpha * (r + gamma * v_next - v)": "that is the change: add it to the old value",
        "v + alpha * (r + gamma * v_next)": "the target is added on top of the old value: what "
        "counts is the difference between them",
        "td(v, r, v_next, ended, alpha, 1.0)": "what follows is not discounted: a step later it is "
        "worth gamma times as much",
        "td(v, r, 0.0, ended, alpha, gamma)": "only the reward counts: the next value is missing",
        "td(v, 0.0, v_next, ended, alpha, gamma)": "the reward is missing from the target",
        "td(v, gamma * r, v_next, ended, alpha, gamma)": "the reward is discounted too: multiply "
        "by gamma only what comes a step later",
        "td(v, r, v_next, ended, 1 - alpha, gamma)": "alpha and 1 - alpha have changed places: "
        "alpha is the weight of what is new",
        "td(v, r, v_next, ended, -alpha, gamma)": "it moves away from the target: check the sign",
    },
    then=(
        Part(
            cases=_steps(True),
            wrong={
                "td(v, r, v_next, False, alpha, gamma)": "where the episode has ended nothing "
                "follows: leave the next value out of the target there",
                "v": "where the episode has ended you learn nothing: but the reward was real",
                "r": "where the episode has ended, too, go only a step of size alpha",
            },
        ),
    ),
)
def td(v, r, v_next, ended, alpha, gamma):
    """Return the new value of a state, from its old one and what a single step brought.

    Thesis, section 2.2.2, equation 2.11.
    """
    target = r if ended else r + gamma * v_next
    return v + alpha * (target - v)


def _after_many_visits(function: Callable[..., Any]) -> NDArray[np.float64]:
    """Return what is left of the first value and of a target's scatter, and the last rate."""
    for n in (1, 2, 3):
        rate.numbers(ask(function, n), ())
    start, variance, alpha = 1.0, 0.0, 0.0
    for n in range(1, VISITS + 1):
        alpha = float(function(n))
        if not 0 <= alpha <= 1:
            raise ExerciseError(f"rate({n}) is {alpha:.4g}: a learning rate lies between 0 and 1")
        start *= 1 - alpha
        variance = (1 - alpha) ** 2 * variance + alpha**2
    return np.array([start, variance**0.5, alpha])


def _tell_rate(found, wanted):
    start, scatter, alpha = found
    if start > START_LEFT:
        return (
            f"after {VISITS:,} visits {start:.0%} of the value is still what it began with: the "
            "rates become too small too soon"
        )
    if alpha > 1 / VISITS**0.5 / 2:
        return (
            f"it never settles: after {VISITS:,} visits {scatter:.0%} of a target's scatter is "
            "still in the value, and the rate falls too slowly or not at all"
        )
    return (
        "it stops too soon: the first few targets make nearly all of the value, and the later ones "
        "cannot correct them"
    )


@exercise(
    "Right: it forgets where it began, and it comes to rest.",
    "The sum of all rates should grow without end, and the rates should go to 0.",
    "A constant rate never settles, and 1 / n**2 stops too soon: try a power between.",
    "n**-p with a p between 0.5 and 1 does both, for example p = 0.7.",
    cases=lambda rng: [()],
    answer=_after_many_visits,
    right=lambda: [START_LEFT, SCATTER_LEFT, 1.0],
    close=np.less_equal,
    tell=_tell_rate,
)
def rate(n):
    """Return the learning rate for the n-th visit.

    Thesis, sections 2.2.3 and 4.3; H. Robbins, S. Monro, "A stochastic approximation method", 1951.
    """
    return n**-0.7
