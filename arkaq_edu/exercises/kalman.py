"""Exercises of chapter 5: two rulers, one turn of the filter, the NIS."""

from __future__ import annotations

from typing import Any

import numpy as np

from arkaq_edu.exercises.exercise import Part, exercise


def _rulers(rng: np.random.Generator) -> list[tuple[float, ...]]:
    low, high = [500, 5, 20, 25], [3000, 20, 90, 60]
    draws = rng.uniform(low, high, (20, 4)).tolist()
    return [(a, sigma_a**2, a + gap, sigma_b**2) for a, sigma_a, gap, sigma_b in draws]


@exercise(
    "Right: the better ruler counts for more, and two are better than either alone.",
    "Which ruler should count for more, the one with the large or with the small variance?",
    "The weights are 1 / var_a and 1 / var_b: the precisions. Their sum is the new precision.",
    "Mean: (a / var_a + b / var_b) / precision. Variance: 1 / precision.",
    returns=("mean", "variance"),
    cases=_rulers,
    of="mean",
    wrong={
        "(a + b) / 2": "you take the middle, as if both rulers were equally good",
        "(a * var_a + b * var_b) / (var_a + var_b)": "the worse ruler counts for more: a large "
        "variance should make a small weight",
        "combine(a, var_a**0.5, b, var_b**0.5)[0]": "you weigh by standard deviations: use "
        "variances",
        "a / var_a + b / var_b": "dividing by the variances is right; but make the weights sum to "
        "1",
        "a if var_a < var_b else b": "you throw the other away: the worse ruler knows something "
        "too",
    },
    then=(
        Part(
            of="variance",
            wrong={
                "var_a + var_b": "if variances added up, two rulers would be worse than one",
                "(var_a + var_b) / 2": "halfway between, two rulers would be worse than the better "
                "one",
                "(var_a + var_b) / 4": "that variance belongs to the plain average, and yours is "
                "better",
                "min(var_a, var_b)": "two rulers are better than the better one alone",
                "1 / var_a + 1 / var_b": "this is the sum of the two precisions: take 1 over it",
                "combine(a, var_a, b, var_b)[1]**0.5": "that is the standard deviation: square it",
            },
        ),
    ),
)
def combine(a, var_a, b, var_b):
    """Return the best mean of two measurements of one thing, and its variance.

    Thesis, section 2.5.1, equations 2.53 and 2.54, with A = H = 1.
    """
    precision = 1 / var_a + 1 / var_b
    return (a / var_a + b / var_b) / precision, 1 / precision


def _steps(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    low, high = [500, 400, -120, 20, 100, 900], [3000, 2500, -60, 90, 1600, 9000]
    draws = rng.uniform(low, high, (20, 6)).tolist()
    return [(x, P, u, x + u + gap, Q, R) for x, P, u, gap, Q, R in draws]


def _tell_blind(found, wanted, x, P, *_):
    if np.isclose(found[1], P):
        return (
            "without a sighting the variance stays as it was: but the robot stepped, and a step "
            "adds Q"
        )
    return "without a sighting (z is None) nothing can be corrected: return what was predicted"


@exercise(
    "Right: predict, correct. This is the whole filter, for one number.",
    "There are two steps: first predict, which adds u and Q; then correct, if z is not None.",
    "The gain is K = P / (P + R), with the predicted P: near 1 where the sighting is good.",
    "The estimate moves by K * (z - x), and the share 1 - K of the variance is left.",
    points=4,
    returns=("estimate", "variance"),
    cases=_steps,
    of="estimate",
    wrong={
        "x + u": "the estimate is the prediction alone: the sighting changes nothing",
        "z": "the estimate is the sighting alone: what was known before is thrown away",
        "turn(x, P, 0, z, Q, R)[0]": "you forget the step u: the robot has walked since then",
        "turn(x, P, -u, z, Q, R)[0]": "you subtract u: add it, it is negative when the ball comes "
        "nearer",
        "turn(x, P, u, z, 0, R)[0]": "your gain uses the old variance P: predicting has added Q",
        "x + u + R / (P + Q + R) * (z - x - u)": "your gain is the trust in the prediction: it "
        "should be near 1 when the sighting is good",
        "x + u - (P + Q) / (P + Q + R) * (z - x - u)": "it leads away from the sighting: check the "
        "sign",
        "x + u + (P + Q) / (P + Q + R) * (z - x)": "the innovation is the sighting minus the "
        "prediction, not minus the old estimate",
    },
    then=(
        Part(
            of="variance",
            wrong={
                "P + Q": "its variance is that of the prediction, as if nothing had been seen",
                "P": "its variance never changes",
                "(P + Q)**2 / (P + Q + R)": "K times the variance is what you gain: what is left "
                "is 1 - K of it",
                "P * R / (P + Q + R)": "take 1 - K of the predicted variance, not of the old one",
            },
        ),
        Part(
            cases=lambda rng: [(x, P, u, None, Q, R) for x, P, u, _, Q, R in _steps(rng)],
            tell=_tell_blind,
        ),
    ),
)
def turn(x, P, u, z, Q, R):
    """Return estimate and variance after a step u and a sighting z, or None.

    Thesis, equations 2.55 to 2.59, with A = B = H = 1.
    """
    x, P = x + u, P + Q
    if z is None:
        return x, P
    K = P / (P + R)
    return x + K * (z - x), (1 - K) * P


def _innovations(rng: np.random.Generator) -> list[tuple[Any, ...]]:
    roots = [rng.normal(size=(m, m)) + 2 * np.eye(m) for m in (2, 3) * 4]
    return [(rng.normal(size=len(root)) * 4, root @ root.T) for root in roots]


@exercise(
    "Right: a surprise, measured by how large the filter thought it might be.",
    "For one number it would be v * v / S. What takes the place of dividing by a matrix?",
    "np.linalg.inv(S) is the inverse of S, and @ multiplies vectors and matrices.",
    "The inverse stands between v and v: v @ np.linalg.inv(S) @ v.",
    cases=_innovations,
    wrong={
        "innovation @ innovation": "you never use S: 50 mm may be much for one filter and little "
        "for another",
        "innovation @ S @ innovation": "you multiply by S: where S is large it should count for "
        "less",
        "nis(innovation, S)**0.5": "that is the square root of it: the S in NIS stands for squared",
        "(innovation**2 / np.diag(S)).sum()": "you use only the diagonal of S: the rest counts too",
        "nis(innovation, S) / len(innovation)": "that is the NIS for each measurement: leave the "
        "division out, the test knows how many there are",
    },
)
def nis(innovation, S):
    """Return the normalized innovation squared.

    Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and
    Navigation", 2001, section 5.4. Not in the thesis.
    """
    return innovation @ np.linalg.inv(S) @ innovation
