"""Exercises of chapter 3: predict, correct, and what will be observed and earned."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises.exercise import exercise


def any_belief(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Draw a belief over n states in which nothing is impossible."""
    return _normed(rng.uniform(0.1, 1, n))


def _normed(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    return weights / weights.sum()


def _sizes(rng: np.random.Generator) -> list[int]:
    return rng.integers(2, 6, 20).tolist()


@exercise(
    "Right: every start counts, by how likely the robot was there.",
    "Take one state t after the action. From which states may the robot have come?",
    "The new b[t] is the sum over s of b[s] * T_a[s, t].",
    "That sum, for all t at once, is a vector times a matrix: which of them comes first?",
    returns="one number for each state",
    cases=lambda rng: [(any_belief(rng, n), rng.dirichlet(np.ones(n), n)) for n in _sizes(rng)],
    wrong={
        "T_a @ b": "you go backwards: T[s, t] leads from s to t, and the sum runs over s, where "
        "the robot comes from",
        "b": "the belief has not moved: the action changes the state, and so what is known of it",
        "b * T_a.sum(axis=0)": "your b multiplies the columns of T, where the robot arrives: it "
        "belongs to the rows, where it starts",
        "T_a[b.argmax()]": "you use the likeliest state alone: the robot may have been in any",
        "T_a.mean(axis=0)": "you treat all starts alike: multiply each row of T by its belief",
        "T_a.sum(axis=0)": "you treat all starts alike: multiply each row of T by its belief",
        "b * T_a.diagonal()": "you count only the robots that stay where they are",
    },
)
def predict(b, T_a):
    """Return the belief after an action, before anything is observed.

    Thesis, section 2.3.2: the sum in equation 2.15.
    """
    return b @ T_a


@exercise(
    "Right: what was believed times what was seen, scaled to sum to 1 again.",
    "A state should gain if it was likely before and also likely to show this.",
    "Multiply the belief by the likelihood, state by state.",
    "What comes out does not sum to 1 yet: divide it by its sum.",
    returns="one number for each state",
    cases=lambda rng: [(any_belief(rng, n), rng.uniform(0.05, 0.95, n)) for n in _sizes(rng)],
    wrong={
        "b * likelihood": "the proportions are right, but a belief sums to 1: divide by the sum",
        "b * likelihood / (b * likelihood).max()": "the proportions are right, but you made the "
        "largest 1: a belief sums to 1",
        "b * likelihood / np.linalg.norm(b * likelihood)": "the proportions are right, but you "
        "gave it length 1: a belief sums to 1",
        "_normed(likelihood)": "you believe the observation alone: keep what was known before",
        "likelihood": "you believe the observation alone: keep what was known before",
        "b": "the observation changes nothing: states that seldom show it should lose",
        "_normed(b + likelihood)": "you add: likely before *and* likely to show this means "
        "multiply",
        "(b + likelihood) / 2": "you take the mean: likely before *and* likely to show this means "
        "multiply",
        "_normed(b * b * likelihood)": "the belief is counted twice",
        "_normed(b * likelihood * likelihood)": "the observation is counted twice",
        "_normed(b * (1 - likelihood))": "you take the probability that it was not seen, but it "
        "was",
        "_normed(b / likelihood)": "you divide by the likelihood: states that seldom show it would "
        "gain",
        "np.eye(len(b))[(b * likelihood).argmax()]": "you keep the likeliest state and forget the "
        "others: they may be right after all",
    },
)
def correct(b, likelihood):
    """Return the belief after an observation.

    Thesis, section 2.3.2, equations 2.14 and 2.15.
    """
    weights = b * likelihood
    return weights / weights.sum()


def _models(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    return [
        (any_belief(rng, n), rng.dirichlet(np.ones(n), n), rng.dirichlet(np.ones(n + 1), n))
        for n in _sizes(rng)
    ]


@exercise(
    "Right: first where the action may lead, then what may be seen from there.",
    "Two things happen one after the other: the robot acts, then it observes.",
    "You have written the first step already: it is predict.",
    "Multiply the predicted belief by O_a: b @ T_a @ O_a.",
    returns="one number for each observation",
    cases=_models,
    wrong={
        "b @ O_a": "you look from where the robot is now: first it acts, and O is for the state "
        "that the action has led to",
        "T_a @ b @ O_a": "you go backwards through T: T[s, t] leads from s to t, the belief is "
        "over s",
        "O_a[(b @ T_a).argmax()]": "you use the likeliest state alone: the robot may be in any",
        "O_a.mean(axis=0)": "you treat all states alike: multiply each row of O by how likely the "
        "action leads there",
        "O_a.sum(axis=0)": "you treat all states alike: multiply each row of O by how likely the "
        "action leads there",
    },
)
def observation_chances(b, T_a, O_a):
    """Return how likely each observation is after an action.

    Thesis, sections 2.3.2 and 2.3.3: the denominator of equation 2.15, and part of 2.16.
    """
    return b @ T_a @ O_a


@exercise(
    "Right: a mean over what the state may be. It is the true expected reward.",
    "Take one action. What does it earn on average over the states?",
    "Its reward in each state counts by the belief in that state.",
    "The sum over s of b[s] * R[s, a], for all a at once, is b @ R.",
    returns="one number for each action",
    cases=lambda rng: [(any_belief(rng, n), rng.uniform(-5, 10, (n, n + 1))) for n in _sizes(rng)],
    wrong={
        "R[b.argmax()]": "you treat the likeliest state as certain: the others earn something too, "
        "each with its probability",
        "R.mean(axis=0)": "you treat all states alike: multiply each by its belief",
        "R.sum(axis=0)": "you treat all states alike: multiply each by its belief",
        "R.max(axis=0)": "you hope for the best state: multiply each by its belief",
        "b @ R / len(b)": "the weights sum to 1 already: there is nothing to divide by",
    },
)
def expected_reward(b, R):
    """Return the reward that each action earns on average.

    Thesis, section 2.3.3, equation 2.17.
    """
    return b @ R
