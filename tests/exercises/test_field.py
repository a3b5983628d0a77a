"""The checks of the exercises on the field: right answers pass, wrong ones are told how."""

import math
import re

import numpy as np
import pytest
from scipy import integrate

from arkaq_edu import exercises


def arc(left, right):
    ahead, turn = (left + right) / 2, (right - left) / 180
    if turn == 0:
        return ahead, 0.0, 0.0
    return ahead / turn * math.sin(turn), ahead / turn * (1 - math.cos(turn)), turn


def midway(left, right):
    ahead, turn = (left + right) / 2, (right - left) / 180
    return np.array([ahead * np.cos(turn / 2), ahead * np.sin(turn / 2), turn])


def ball(radius, off, f, r):
    # The error by a difference instead of a derivative.
    step = 1e-6
    return f * r / radius, off * (f * r / (radius - step) - f * r / (radius + step)) / (2 * step)


def chance(distance, sigma, aim):
    post = math.atan2(400.0, distance)

    def density(angle):
        return math.exp(-(((angle - aim) / sigma) ** 2) / 2) / (sigma * math.sqrt(2 * math.pi))

    return integrate.quad(density, -post, post)[0]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [
        (exercises.pose, arc), (exercises.pose, midway),
        (exercises.ball, ball), (exercises.scoring_chance, chance),
    ],
)  # fmt: skip
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def bent(change):
    """An arc with something else done to it."""
    return lambda left, right: change(left, right, *arc(left, right))


def divided(left, right):
    ahead, turn = (left + right) / 2, (right - left) / 180
    radius = ahead / turn
    return radius * math.sin(turn), radius * (1 - math.cos(turn)), turn


def divided_by_numpy(left, right):
    with np.errstate(invalid="ignore", divide="ignore"):
        return divided(np.float64(left), np.float64(right))


def error_of(error):
    return lambda radius, off, f, r: (f * r / radius, error(radius, off, f, r))


def cdf(x):
    return (1 + math.erf(x / math.sqrt(2))) / 2


def not_written(*_):
    raise NotImplementedError


WRONG = [
    (exercises.pose, lambda left, right: arc(right, left), "wrong side: a longer right"),
    (exercises.pose, bent(lambda a, b, x, y, h: (2 * x, 2 * y, h)), "twice as far: left and right"),
    (exercises.pose, lambda a, b: arc(*midturn(a, b, 2)), "turns twice as far"),
    (exercises.pose, lambda a, b: arc(*midturn(a, b, 0.5)), "turns half as far"),
    (exercises.pose, bent(lambda a, b, x, y, h: (x, y, math.degrees(h))), "degrees"),
    (exercises.pose, bent(lambda a, b, x, y, h: ((a + b) / 2, 0.0, h)), "old line"),
    (
        exercises.pose,
        bent(lambda a, b, x, y, h: ((a + b) / 2 * math.cos(h), (a + b) / 2 * math.sin(h), h)),
        "turn first",
    ),
    (exercises.pose, bent(lambda a, b, x, y, h: (x, -y, h)), "y is on the wrong side"),
    (exercises.pose, bent(lambda a, b, x, y, h: (y, x, h)), "first the x, then the y"),
    (exercises.pose, bent(lambda a, b, x, y, h: (x + 30, y, h)), "x is right in 0 of 10"),
    (exercises.pose, bent(lambda a, b, x, y, h: (x, y, h + 0.1)), "heading is right in 0 of 10"),
    (exercises.pose, divided, "but for equal footsteps"),
    (exercises.pose, divided_by_numpy, "but for equal footsteps"),
    (exercises.pose, bent(lambda a, b, x, y, h: (x, y)), r"three numbers: .*not 2 numbers"),
    (exercises.pose, not_written, "still empty"),
    (exercises.pose, lambda left: 0, "stopped with TypeError"),
    (exercises.pose, print, "return"),
    (exercises.ball, lambda p, off, f, r: (p * f / r, 0), "larger is nearer"),
    (exercises.ball, lambda p, off, f, r: (f * 2 * r / p, 0), "twice as far: you mix a diameter"),
    (exercises.ball, lambda p, off, f, r: (f * r / (2 * p), 0), "half as far: you mix a diameter"),
    (exercises.ball, lambda p, off, f, r: (r / p, 0), "focal length is missing"),
    (exercises.ball, lambda p, off, f, r: (f / p, 0), "size is missing"),
    (exercises.ball, lambda p, off, f, r: (f * r / p + 1, 0), "distance is right in 0 of 12 tries"),
    (exercises.ball, error_of(lambda p, off, f, r: f * r / off), "a ball of `off` pixels"),
    (exercises.ball, error_of(lambda p, off, f, r: -f * r / p**2 * off), "up to the sign"),
    (exercises.ball, error_of(lambda p, off, f, r: f * r / p**2), "one whole pixel"),
    (exercises.ball, error_of(lambda p, off, f, r: off * f * r / p), "not the share"),
    (exercises.ball, error_of(lambda p, off, f, r: off), "error is in mm"),
    (exercises.ball, error_of(lambda p, off, f, r: off / f / r), "how far the ball is"),
    (exercises.ball, error_of(lambda p, off, f, r: 2 * off * f * r / p**2), "error is right in 0"),
    (exercises.ball, lambda p, off, f, r: f * r / p, "two numbers: distance and error, not one"),
    (exercises.ball, not_written, "still empty"),
    (exercises.scoring_chance, lambda d, s, a: chance(d, s, 0.0), "leave out where it is aimed"),
    (exercises.scoring_chance, lambda d, s, a: chance(d / 2, s, a), "twice as wide"),
    (exercises.scoring_chance, lambda d, s, a: chance(d, s**2, a), "variance"),
    (
        exercises.scoring_chance,
        lambda d, s, a: cdf((math.atan(400 / d) - a) / s),
        "one side of a post",
    ),
    (
        exercises.scoring_chance,
        lambda d, s, a: cdf((400 / d - a) / s) - cdf((-400 / d - a) / s),
        "arctan",
    ),
    (exercises.scoring_chance, lambda d, s, a: 1 - chance(d, s, a), "miss"),
    (exercises.scoring_chance, lambda d, s, a: 100 * chance(d, s, a), "percentage"),
    (exercises.scoring_chance, lambda d, s, a: 0.5 * chance(d, s, a), "too small"),
    (exercises.scoring_chance, lambda d, s, a: "likely", "numbers"),
    (exercises.scoring_chance, not_written, "still empty"),
]


def midturn(left, right, factor):
    """Footsteps with the same mean that turn `factor` times as far."""
    ahead, half = (left + right) / 2, factor * (right - left) / 2
    return ahead - half, ahead + half


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))
