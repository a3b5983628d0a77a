"""Checks for the notebook on robot and field: a footstep, a blob's size, the chance of a goal."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from arkaq_edu.exercises._ask import ExerciseError, Rule, ask, judge, numbers
from arkaq_edu.field import pitch
from arkaq_edu.field.camera import FOCAL_LENGTH

Rng = np.random.Generator | int | None

STEPPED = "Right: two numbers a cycle, and the body is somewhere else."
MEASURED = "Right: half the size, twice as far; and four times as far off."
AIMED = "Right: a goal is an angle, and a kick has a spread."

_WIDTH = pitch.ROBOT_WIDTH
_NEAR_ENOUGH = (1.0, 1.0, 0.001)  # mm, mm, rad


def check_pose(pose: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``pose(left, right)``: where one cycle of footsteps takes the body.

    Parameters
    ----------
    pose : callable
        Takes the left and the right footstep (mm) of a robot at the origin that looks along x;
        returns x, y (mm) and heading (rad) after the cycle. An arc is right, and so is a straight
        way in the mean heading, which is less than a millimeter off.
    rng : numpy.random.Generator or int, optional
        Where the random footsteps come from.

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
    Thesis, section 5.1.2.2 (the motion engine); the model is that of `arkaq_edu.field.World`.

    Examples
    --------
    >>> check_pose(lambda left, right: ((left + right) / 2, 0.0, (right - left) / 180))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: the robot turns while it walks: heading and x are \
right or nearly so, but it cannot end on its old line
    """
    rng = np.random.default_rng(rng)
    cases = []
    for sign in (1, -1) * 4:
        ahead, turn = float(rng.uniform(120, 170)), sign * float(rng.uniform(0.15, 0.25))
        cases.append((ahead - turn * _WIDTH / 2, ahead + turn * _WIDTH / 2))
    cases += [(-step, step) for step in rng.uniform(10, 90, 2).tolist()]  # on the spot
    found = np.array([numbers("pose", ask(pose, *case), (3,)) for case in cases])
    _judge_poses(found, cases)
    straight = float(rng.uniform(50, 190))
    try:
        even = ask(pose, straight, straight)
    except ExerciseError as error:
        if not isinstance(error.__cause__, ZeroDivisionError):
            raise
        even = (math.nan, math.nan, 0.0)
    if not np.allclose(np.asarray(even, dtype=float), (straight, 0.0, 0.0)):
        raise ExerciseError(
            "all is right but for equal footsteps: they turn by 0, and walk straight ahead, where "
            "an arc's radius would be a division by 0"
        )
    return STEPPED


def _judge_poses(found: NDArray[np.float64], cases: list[tuple[float, float]]) -> None:
    def same(rule: Callable[[float, float], tuple[float, float, float]]) -> bool:
        wanted = np.array([rule(*case) for case in cases])
        return bool((np.abs(found - wanted) <= _NEAR_ENOUGH).all())

    if same(_pose):
        return
    for rule, words in WRONG_POSE:
        if same(rule):
            raise ExerciseError(words)
    good = np.abs(found - [_pose(*case) for case in cases]) <= _NEAR_ENOUGH
    name = ("x", "y", "heading")[int(np.argmin(good.sum(axis=0)))]
    raise ExerciseError(f"{name} is right in {good.sum(axis=0).min()} of {len(cases)} tries")


def check_ball(ball: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``ball(radius, off, f, r)``: distance from a blob's size, and its error.

    Parameters
    ----------
    ball : callable
        Takes the radius of the ball's image (pixels), how far that may be off (pixels), the focal
        length (pixels) and the ball's radius (mm); returns the distance and how far it is off
        then (mm), to first order.
    rng : numpy.random.Generator or int, optional
        Where the random balls come from.

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
    Thesis, section 5.1.2.1 (the vision engine), which gives no formula.

    Examples
    --------
    >>> check_ball(lambda radius, off, f, r: (f * radius / r, 0.0))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: your distance grows with the image: a ball that looks \
larger is nearer
    """
    rng = np.random.default_rng(rng)
    cases = [
        (float(radius), float(off), FOCAL_LENGTH, pitch.BALL_RADIUS)
        for radius, off in zip(rng.uniform(2, 20, 12), rng.uniform(0.02, 0.2, 12), strict=True)
    ]
    answers = [numbers("ball", ask(ball, *case), (2,)) for case in cases]
    for part, right, wrong in (
        (0, _distance, WRONG_DISTANCE),
        (1, _distance_error, WRONG_DISTANCE_ERROR),
    ):
        found = {case: answer[part] for case, answer in zip(cases, answers, strict=True)}
        name = ("the distance", "the error")[part]
        judge(name, lambda *case, found=found: found[case], cases, right, wrong)
    return MEASURED


def check_chance(chance: Callable[..., Any], rng: Rng = None) -> str:
    """Check a student's ``chance(distance, sigma, aim)``: how likely a kick is to score.

    Parameters
    ----------
    chance : callable
        Takes the distance (mm) of a ball straight before the middle of an 800 mm goal, the
        standard deviation of a kick's direction (rad) and where it is aimed, from the middle
        (rad); returns a probability.
    rng : numpy.random.Generator or int, optional
        Where the random kicks come from.

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
    Thesis, section 5.3, which calls the kick inaccurate and gives no number.

    Examples
    --------
    >>> check_chance(lambda distance, sigma, aim: 1.0)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: chance is right in 0 of 12 tries; one of yours, 1, is \
too large
    """
    rng = np.random.default_rng(rng)
    cases = [
        tuple(float(x) for x in case)
        for case in zip(
            rng.uniform(900, 2500, 12),
            np.radians(rng.uniform(8, 18, 12)),
            rng.choice((-1, 1), 12) * rng.uniform(0.03, 0.25, 12),
            strict=True,
        )
    ]
    judge("chance", chance, cases, _chance, WRONG_CHANCE)
    return AIMED


def _pose(left: float, right: float) -> tuple[float, float, float]:
    return _walked((left + right) / 2, (right - left) / _WIDTH)


def _walked(ahead: float, turn: float) -> tuple[float, float, float]:
    """Return where an arc ends: its chord lies in the mean heading."""
    chord = ahead * np.sinc(turn / 2 / math.pi)
    return chord * math.cos(turn / 2), chord * math.sin(turn / 2), turn


def _distance(radius: float, off: float, f: float, r: float) -> float:
    return f * r / radius


def _distance_error(radius: float, off: float, f: float, r: float) -> float:
    return off * f * r / radius**2


def _chance(distance: float, sigma: float, aim: float, half: float = 400.0) -> float:
    post = math.atan(half / distance)
    return float(norm.cdf((post - aim) / sigma) - norm.cdf((-post - aim) / sigma))


# What is often done instead, and what to say of it.
WRONG_POSE: list[Rule] = [
    (
        lambda left, right: _walked((left + right) / 2, (left - right) / _WIDTH),
        "it turns to the wrong side: a longer right footstep turns the robot to the left, which "
        "counts as positive",
    ),
    (
        lambda left, right: _walked(left + right, (right - left) / _WIDTH),
        "it goes twice as far: left and right step at the same time, so the body moves by their "
        "mean",
    ),
    (
        lambda left, right: _walked((left + right) / 2, (right - left) / _WIDTH * 2),
        "it turns twice as far: the legs are a whole body's width apart, not half of it",
    ),
    (
        lambda left, right: _walked((left + right) / 2, (right - left) / _WIDTH / 2),
        "it turns half as far: one side's lead over the other is right - left, over one width",
    ),
    (
        lambda left, right: (*_pose(left, right)[:2], math.degrees(_pose(left, right)[2])),
        "the heading is in degrees: this course counts in radians",
    ),
    (
        lambda left, right: ((left + right) / 2, 0.0, (right - left) / _WIDTH),
        "the robot turns while it walks: heading and x are right or nearly so, but it cannot end "
        "on its old line",
    ),
    (
        lambda left, right: (*_turned_first(left, right), (right - left) / _WIDTH),
        "you turn first and walk then: on its way the robot has, on average, half of the turn",
    ),
    (
        lambda left, right: _mirrored(*_pose(left, right)),
        "heading and x are right, but y is on the wrong side: left is positive",
    ),
    (
        lambda left, right: _swapped(*_pose(left, right)),
        "x and y are swapped: x is straight ahead",
    ),
]


def _turned_first(left: float, right: float) -> tuple[float, float]:
    ahead, turn = (left + right) / 2, (right - left) / _WIDTH
    return ahead * math.cos(turn), ahead * math.sin(turn)


def _mirrored(x: float, y: float, heading: float) -> tuple[float, float, float]:
    return x, -y, heading


def _swapped(x: float, y: float, heading: float) -> tuple[float, float, float]:
    return y, x, heading


WRONG_DISTANCE: list[Rule] = [
    (
        lambda radius, off, f, r: f * radius / r,
        "your distance grows with the image: a ball that looks larger is nearer",
    ),
    (
        lambda radius, off, f, r: 2 * f * r / radius,
        "twice as far: a diameter has met a radius. Both have to be of one kind",
    ),
    (
        lambda radius, off, f, r: f * r / radius / 2,
        "half as far: a diameter has met a radius. Both have to be of one kind",
    ),
    (
        lambda radius, off, f, r: r / radius,
        "the focal length is missing: without it mm and pixels cannot be compared",
    ),
    (
        lambda radius, off, f, r: f / radius,
        "the ball's size is missing: a small ball near by looks like a large one far off",
    ),
]
WRONG_DISTANCE_ERROR: list[Rule] = [
    (
        lambda radius, off, f, r: f * r / off,
        "the distance is right; but its error is not that of a ball of `off` pixels: how much "
        "does the distance change when the radius does?",
    ),
    (
        lambda radius, off, f, r: -off * f * r / radius**2,
        "the distance is right, and its error up to the sign: give its size",
    ),
    (
        lambda radius, off, f, r: f * r / radius**2,
        "the distance is right; that is its error for one whole pixel, and it is `off` pixels",
    ),
    (
        lambda radius, off, f, r: off * f * r / radius,
        "the distance is right; but its error is not the share `off` of it: differentiate f r / "
        "radius",
    ),
    (
        lambda radius, off, f, r: off,
        "the distance is right; but its error is in mm, and `off` in pixels",
    ),
    (
        lambda radius, off, f, r: off / (f * r),
        "the distance is right; but its error has to depend on how far the ball is: "
        "differentiate f r / radius",
    ),
]
WRONG_CHANCE: list[Rule] = [
    (
        lambda distance, sigma, aim: _chance(distance, sigma, 0.0),
        "you leave out where it is aimed: seen from the aim, one post is nearer than the other",
    ),
    (
        lambda distance, sigma, aim: _chance(distance, sigma, aim, half=800.0),
        "your goal is twice as wide: from its middle it is 400 mm to either post",
    ),
    (
        lambda distance, sigma, aim: _chance(distance, sigma**2, aim),
        "you divide by the variance: the normal distribution is scaled by sigma itself",
    ),
    (
        lambda distance, sigma, aim: norm.cdf((math.atan(400 / distance) - aim) / sigma),
        "that counts all kicks to one side of a post: those beyond the other post miss too",
    ),
    (
        lambda distance, sigma, aim: (
            norm.cdf((400 / distance - aim) / sigma) - norm.cdf((-400 / distance - aim) / sigma)
        ),
        "400 / distance is the tangent of the angle to a post; the angle is its arctan",
    ),
    (
        lambda distance, sigma, aim: 1 - _chance(distance, sigma, aim),
        "that is the chance of a miss",
    ),
    (
        lambda distance, sigma, aim: 100 * _chance(distance, sigma, aim),
        "that is a percentage: a probability lies between 0 and 1",
    ),
]
