"""Checks for the notebook on the Kalman filter: two rulers, one turn of the filter, the NIS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, numbers

Rng = np.random.Generator | int | None

FUSED = "Right: the surer ruler counts for more, and two are surer than either alone."
TURNED = "Right: predict, correct. This is the whole filter, for one number."
SCORED = "Right: a surprise, measured by how large the filter thought it might be."


def check_combine(combine: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``combine(a, var_a, b, var_b)``: the best mean of two, and its variance.

    Parameters
    ----------
    combine : callable
        Takes two measurements of one length with their variances; returns mean and variance.
    rng : numpy.random.Generator or int, optional
        Where the random measurements come from.

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
    Thesis, section 2.5.1, equations 2.53 and 2.54, with A = H = 1.

    Examples
    --------
    >>> check_combine(lambda a, va, b, vb: ((a + b) / 2, (va + vb) / 4))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you take the middle, as if both rulers were equally good
    """
    rng = np.random.default_rng(rng)
    cases = [
        (a, var_a, a + gap, var_b)
        for a, gap, var_a, var_b in zip(
            rng.uniform(500, 3000, 20),
            rng.uniform(20, 90, 20),
            rng.uniform(5, 20, 20) ** 2,
            rng.uniform(25, 60, 20) ** 2,
            strict=True,
        )
    ]
    found = np.array([numbers("combine", ask(combine, *case), (2,)) for case in cases])
    _judge("mean", found[:, 0], cases, _fused_mean, WRONG_MEAN)
    _judge("variance", found[:, 1], cases, _fused_variance, WRONG_VARIANCE)
    return FUSED


def check_turn(turn: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``turn(x, P, u, z, Q, R)``: one predict and one correct, A = B = H = 1.

    Parameters
    ----------
    turn : callable
        Takes an estimate and its variance, the step ``u`` that the robot takes, a sighting ``z``
        or None, and the variances of step and sighting; returns the next estimate and variance.
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
    Thesis, equations 2.55 to 2.59.

    Examples
    --------
    >>> check_turn(lambda x, P, u, z, Q, R: (x + u, P + Q))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: the estimate is the prediction alone: the sighting \
changes nothing
    """
    rng = np.random.default_rng(rng)
    cases = []
    for _ in range(20):
        x, P, Q, R = rng.uniform([500, 400, 100, 900], [3000, 2500, 1600, 9000])
        u = float(rng.uniform(-120, -60))
        cases.append((x, P, u, x + u + rng.uniform(20, 90), Q, R))
    found = np.array([numbers("turn", ask(turn, *case), (2,)) for case in cases])
    _judge("estimate", found[:, 0], cases, _turned_estimate, WRONG_ESTIMATE)
    _judge("variance", found[:, 1], cases, _turned_variance, WRONG_TURNED_VARIANCE)
    for x, P, u, _, Q, R in cases:
        blind = numbers("turn", ask(turn, x, P, u, None, Q, R), (2,))
        if np.isclose(blind[1], P):
            raise ExerciseError(
                "without a sighting the variance stays as it was: but the robot stepped, and a "
                "step adds Q"
            )
        if not np.allclose(blind, [x + u, P + Q]):
            raise ExerciseError(
                "without a sighting (z is None) there is nothing to correct by: what was predicted "
                "should come back"
            )
    return TURNED


def check_nis(nis: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``nis(innovation, S)``: the normalized innovation squared.

    Parameters
    ----------
    nis : callable
        Takes an innovation, shape (m,), and the covariance that the filter gave it, shape (m, m);
        returns a number.
    rng : numpy.random.Generator or int, optional
        Where the random innovations and covariances come from.

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
    Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001,
    section 5.4. Not in the thesis.

    Examples
    --------
    >>> check_nis(lambda v, S: v @ v)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you never use S: a surprise of 50 mm is much for one \
filter and little for another
    """
    rng = np.random.default_rng(rng)
    cases = []
    for m in (2, 3, 2, 3, 2, 3, 2, 3):
        root = rng.normal(size=(m, m)) + 2 * np.eye(m)
        cases.append((rng.normal(size=m) * 4, root @ root.T))
    found = np.array([numbers("nis", ask(nis, *case), ()) for case in cases])
    _judge("NIS", found, cases, _nis, WRONG_NIS)
    return SCORED


def _judge(
    name: str,
    found: NDArray[np.float64],
    cases: list[tuple[Any, ...]],
    right: Callable[..., float],
    wrong: list[Rule],
) -> None:
    """Pass what `right` gives; of the rest say which of the `wrong` ways it is, or how far off."""
    wanted = np.array([right(*case) for case in cases])
    if np.allclose(found, wanted):
        return
    for rule, words in wrong:
        if np.allclose(found, [rule(*case) for case in cases]):
            raise ExerciseError(words)
    i = int(np.argmax(~np.isclose(found, wanted)))
    way = "too large" if found[i] > wanted[i] else "too small"
    right_ones = int(np.isclose(found, wanted).sum())
    raise ExerciseError(
        f"the {name} is right in {right_ones} of {len(cases)} tries; one of yours, "
        f"{found[i]:.5g}, is {way}"
    )


def _fused_mean(a: float, var_a: float, b: float, var_b: float) -> float:
    return (a * var_b + b * var_a) / (var_a + var_b)


def _fused_variance(a: float, var_a: float, b: float, var_b: float) -> float:
    return var_a * var_b / (var_a + var_b)


# What is often done instead, and what to say of it.
WRONG_MEAN: list[Rule] = [
    (
        lambda a, va, b, vb: (a + b) / 2,
        "you take the middle, as if both rulers were equally good",
    ),
    (
        lambda a, va, b, vb: (a * va + b * vb) / (va + vb),
        "the worse ruler counts for more: a large variance should make a small weight",
    ),
    (
        lambda a, va, b, vb: (a * vb**0.5 + b * va**0.5) / (va**0.5 + vb**0.5),
        "you weigh by standard deviations: the weights go with the variances",
    ),
    (
        lambda a, va, b, vb: a / va + b / vb,
        "each is divided by its variance, but the weights do not sum to 1 yet",
    ),
    (
        lambda a, va, b, vb: a if va < vb else b,
        "you keep the better ruler and throw the other away: it knows something too",
    ),
]
WRONG_VARIANCE: list[Rule] = [
    (
        lambda a, va, b, vb: va + vb,
        "the mean is right; but variances that add up would make two rulers worse than one",
    ),
    (
        lambda a, va, b, vb: (va + vb) / 2,
        "the mean is right; but a variance half way between would make two rulers worse than the "
        "better one",
    ),
    (
        lambda a, va, b, vb: (va + vb) / 4,
        "the mean is right; that variance belongs to the plain average, and you have a better one",
    ),
    (
        lambda a, va, b, vb: min(va, vb),
        "the mean is right; but two rulers are surer than the better one alone",
    ),
    (
        lambda a, va, b, vb: 1 / va + 1 / vb,
        "the mean is right; these are the two precisions added: turn the sum over",
    ),
    (
        lambda a, va, b, vb: _fused_variance(a, va, b, vb) ** 0.5,
        "the mean is right; that is the standard deviation, its square is asked for",
    ),
]


def _corrected(x: float, P: float, z: float, R: float) -> float:
    return x + P / (P + R) * (z - x)


def _turned_estimate(x: float, P: float, u: float, z: float, Q: float, R: float) -> float:
    return _corrected(x + u, P + Q, z, R)


def _turned_variance(x: float, P: float, u: float, z: float, Q: float, R: float) -> float:
    return (P + Q) * R / (P + Q + R)


WRONG_ESTIMATE: list[Rule] = [
    (
        lambda x, P, u, z, Q, R: x + u,
        "the estimate is the prediction alone: the sighting changes nothing",
    ),
    (
        lambda x, P, u, z, Q, R: z,
        "the estimate is the sighting alone: what was known before is thrown away",
    ),
    (
        lambda x, P, u, z, Q, R: _corrected(x, P + Q, z, R),
        "you forget the step u: the robot has walked since the last look",
    ),
    (
        lambda x, P, u, z, Q, R: _corrected(x - u, P + Q, z, R),
        "the step is taken off where it should be added: u is negative when the ball comes nearer",
    ),
    (
        lambda x, P, u, z, Q, R: _corrected(x + u, P, z, R),
        "the gain is made of the old variance P: predicting has added Q to it",
    ),
    (
        lambda x, P, u, z, Q, R: x + u + R / (P + Q + R) * (z - x - u),
        "your gain is the trust in the prediction: it should be near 1 when the sighting is good",
    ),
    (
        lambda x, P, u, z, Q, R: x + u - (P + Q) / (P + Q + R) * (z - x - u),
        "the correction leads away from the sighting: look at its sign",
    ),
    (
        lambda x, P, u, z, Q, R: x + u + (P + Q) / (P + Q + R) * (z - x),
        "the innovation is the sighting less the prediction, not less the old estimate",
    ),
]
WRONG_TURNED_VARIANCE: list[Rule] = [
    (
        lambda x, P, u, z, Q, R: P + Q,
        "the estimate is right; but its variance is that of the prediction, as if nothing had been "
        "seen",
    ),
    (
        lambda x, P, u, z, Q, R: P,
        "the estimate is right; but its variance never changes",
    ),
    (
        lambda x, P, u, z, Q, R: (P + Q) ** 2 / (P + Q + R),
        "the estimate is right; but K times the variance is what is gained, what is left is "
        "1 - K of it",
    ),
    (
        lambda x, P, u, z, Q, R: P * R / (P + Q + R),
        "the estimate is right; but the share 1 - K is taken of the old variance, not of the "
        "predicted one",
    ),
]


def _nis(v: NDArray[np.float64], S: NDArray[np.float64]) -> float:
    return float(v @ np.linalg.solve(S, v))


WRONG_NIS: list[Rule] = [
    (
        lambda v, S: v @ v,
        "you never use S: a surprise of 50 mm is much for one filter and little for another",
    ),
    (
        lambda v, S: v @ S @ v,
        "you multiply by S: an innovation should count for less where S is large, so divide",
    ),
    (
        lambda v, S: np.sqrt(_nis(v, S)),
        "that is the root of it: the S in NIS stands for squared",
    ),
    (
        lambda v, S: (v**2 / np.diag(S)).sum(),
        "you use the diagonal of S alone: it also says which surprises come together",
    ),
    (
        lambda v, S: _nis(v, S) / len(v),
        "that is the NIS for each measurement; leave the division out, the test knows how many "
        "there are",
    ),
]
