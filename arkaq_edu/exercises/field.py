"""Exercises of chapter 8: a footstep, a ball's distance from its size, the chance of a goal."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from arkaq_edu.exercises.exercise import ExerciseError, Part, ask, exercise
from arkaq_edu.field import pitch
from arkaq_edu.field.camera import FOCAL_LENGTH

_WIDTH = pitch.ROBOT_WIDTH


def _footsteps(rng: np.random.Generator) -> list[tuple[float, float]]:
    ahead, turn = rng.uniform(120, 170, 8), rng.uniform(0.15, 0.25, 8) * ((1, -1) * 4)
    walks = zip(ahead - turn * _WIDTH / 2, ahead + turn * _WIDTH / 2, strict=True)
    on_the_spot = [(-step, step) for step in rng.uniform(10, 90, 2).tolist()]
    return [(float(left), float(right)) for left, right in walks] + on_the_spot


def _arc(ahead: float, turn: float) -> tuple[float, float, float]:
    """Return where an arc ends: its chord lies in the mean heading."""
    chord = ahead * np.sinc(turn / 2 / math.pi)
    return chord * math.cos(turn / 2), chord * math.sin(turn / 2), turn


def _or_nowhere(function: Callable[..., Any], left: float, right: float) -> Any:
    """Ask for equal footsteps, where an arc's radius is a division by 0."""
    try:
        return np.nan_to_num(ask(function, left, right))
    except ExerciseError as error:
        if isinstance(error.__cause__, ZeroDivisionError):
            return np.zeros(3)
        raise


def _near(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Compare to 1 mm and 1 mrad: an arc and its chord are less than that apart."""
    return np.abs(found - wanted) <= (1.0, 1.0, 0.001)


@exercise(
    "Right: two numbers a cycle, and the body is somewhere else.",
    "How far does the middle go, and by what angle does one side get ahead of the other?",
    "It goes ahead = (left + right) / 2 and turns by (right - left) / 180.",
    "It walks in the mean heading, turn / 2: x is ahead * cos of that, y is ahead * sin.",
    points=3,
    returns=("x", "y", "heading"),
    cases=_footsteps,
    close=_near,
    wrong={
        "_arc((left + right) / 2, (left - right) / _WIDTH)": "it turns to the wrong side: a longer "
        "right footstep turns the robot to the left, which counts as positive",
        "_arc(left + right, (right - left) / _WIDTH)": "it goes twice as far: left and right step "
        "at the same time, so the body moves by their mean",
        "_arc((left + right) / 2, (right - left) / _WIDTH * 2)": "it turns twice as far: the legs "
        "are a whole body's width apart, not half of it",
        "_arc((left + right) / 2, (right - left) / _WIDTH / 2)": "it turns half as far: the lead "
        "of one side over the other is right - left, over one width",
        "pose(left, right) * [1, 1, 180 / math.pi]": "the heading is in degrees: use radians",
        "((left + right) / 2, 0.0, (right - left) / _WIDTH)": "the robot turns while it walks: "
        "heading and x are right or nearly so, but it cannot end on its old line",
        "_turned_first((left + right) / 2, (right - left) / _WIDTH)": "you turn first and walk "
        "then: on average the robot has turned by half while it walks",
        "pose(left, right) * [1, -1, 1]": "only y is on the wrong side: left is positive",
        "pose(left, right)[[1, 0, 2]]": "x and y are swapped: x is straight ahead",
    },
    then=(
        Part(
            cases=lambda rng: [(step, step) for step in rng.uniform(50, 190, 1).tolist()],
            answer=_or_nowhere,
            close=_near,
            tell=lambda *_: (
                "all is right but for equal footsteps: they turn by 0 and walk straight ahead, "
                "where an arc's radius would be a division by 0"
            ),
        ),
    ),
)
def pose(left, right):
    """Return x, y (mm) and heading (rad) after one cycle of footsteps (mm).

    Thesis, section 5.1.2.2 (the motion engine); the model is that of `arkaq_edu.field.World`.
    """
    ahead, turn = (left + right) / 2, (right - left) / 180
    return np.array([ahead * np.cos(turn / 2), ahead * np.sin(turn / 2), turn])


def _turned_first(ahead: float, turn: float) -> tuple[float, float, float]:
    return ahead * math.cos(turn), ahead * math.sin(turn), turn


def _blobs(rng: np.random.Generator) -> list[tuple[float, ...]]:
    draws = rng.uniform([2, 0.02], [20, 0.2], (12, 2)).tolist()
    return [(radius, off, FOCAL_LENGTH, pitch.BALL_RADIUS) for radius, off in draws]


@exercise(
    "Right: half the size, twice as far; and four times as far off.",
    "Draw the pinhole: the image is to the focal length as the ball is to its distance.",
    "So the distance is f * r / radius. Its error is how much that changes with the radius.",
    "The derivative of f * r / radius is -f * r / radius**2: its size times off is the error.",
    points=3,
    returns=("distance", "error"),
    cases=_blobs,
    of="distance",
    wrong={
        "f * radius / r": "your distance grows with the image: a ball that looks larger is nearer",
        "2 * f * r / radius": "twice as far: you mix a diameter with a radius. Use two radii",
        "f * r / radius / 2": "half as far: you mix a diameter with a radius. Use two radii",
        "r / radius": "the focal length is missing: without it mm and pixels cannot be compared",
        "f / radius": "the ball's size is missing: a small near ball looks like a large far one",
    },
    then=(
        Part(
            of="error",
            wrong={
                "f * r / off": "that is the distance of a ball of `off` pixels: how much does the "
                "distance change when the radius does?",
                "-off * f * r / radius**2": "its error is right up to the sign: return its size",
                "f * r / radius**2": "that is its error for one whole pixel, not for `off` pixels",
                "off * f * r / radius": "its error is not the share `off` of it: differentiate f r "
                "/ radius",
                "off": "its error is in mm, and `off` in pixels",
                "off / (f * r)": "its error depends on how far the ball is: differentiate f r / "
                "radius",
            },
        ),
    ),
)
def ball(radius, off, f, r):
    """Return the distance (mm), and its error where the image is off by so many pixels.

    Thesis, section 5.1.2.1 (the vision engine), which gives no formula.
    """
    distance = f * r / radius
    return distance, off * distance / radius


def _kicks(rng: np.random.Generator) -> list[tuple[float, ...]]:
    low, high = [900, math.radians(8), 0.03], [2500, math.radians(18), 0.25]
    draws = rng.uniform(low, high, (12, 3)).tolist()
    return [(distance, sigma, aim * (-1) ** k) for k, (distance, sigma, aim) in enumerate(draws)]


@exercise(
    "Right: a goal is an angle, and a kick has a spread.",
    "Which directions score? They lie between two angles, one for each post.",
    "Seen from the aim, the posts are at arctan(400 / distance) - aim and its mirror image.",
    "Divide both by sigma. The answer is the difference of norm.cdf at the two.",
    points=3,
    cases=_kicks,
    wrong={
        "scoring_chance(distance, sigma, 0.0)": "you leave out where it is aimed: seen from the "
        "aim, one post is nearer than the other",
        "scoring_chance(distance / 2, sigma, aim)": "your goal is twice as wide: from its middle "
        "it is 400 mm to either post",
        "scoring_chance(distance, sigma**2, aim)": "you divide by the variance: the normal "
        "distribution is scaled by sigma itself",
        "norm.cdf((math.atan(400 / distance) - aim) / sigma)": "that counts all kicks to one side "
        "of a post: those beyond the other post miss too",
        "np.diff(norm.cdf((np.array([-400, 400]) / distance - aim) / sigma))[0]": "400 / distance "
        "is the tangent of the angle to a post; the angle is its arctan",
        "1 - scoring_chance(distance, sigma, aim)": "that is the probability of a miss",
        "100 * scoring_chance(distance, sigma, aim)": "that is a percentage: return a share of 1",
    },
)
def scoring_chance(distance, sigma, aim):
    """Return how likely a kick is to go between the posts of an 800 mm goal.

    Thesis, section 5.3, which calls the kick inaccurate and gives no number.
    """
    post = np.arctan(400 / distance)
    return norm.cdf((post - aim) / sigma) - norm.cdf((-post - aim) / sigma)
