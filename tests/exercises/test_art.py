"""The checks of the exercises on adaptive resonance: right passes, wrong is told in what way."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises


def match(pattern, template):
    return np.minimum(pattern, template).sum() / np.sum(pattern)


def choose(pattern, templates, reset):
    signal = [2 * (pattern * z).sum() / (1 + z.sum()) for z in templates]
    return max((j for j in range(len(templates)) if j not in reset), key=lambda j: signal[j])


def norm_r(u, z, c, d):
    p = u + d * z
    return np.linalg.norm(u + c * p) / (np.linalg.norm(u) + np.linalg.norm(c * p))


def closed_form(u, z, c, d):
    """Equation 2.47, for which the angle of z = 0 does not exist."""
    cdz = c * d * np.linalg.norm(z)
    x = 2 * cdz * (u @ z) / np.linalg.norm(z) if z.any() else 0.0
    above = (1 + c) ** 2 + (1 + c) * x + cdz**2
    return np.sqrt(above) / (1 + np.sqrt(c**2 + c * x + cdz**2))


RIGHT = [
    (exercises.match, match),
    (exercises.choose, choose),
    (exercises.norm_r, norm_r),
    (exercises.norm_r, closed_form),
]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("exercise", "answer"), RIGHT)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def not_written(*_):
    raise NotImplementedError


def signals(x, Z):
    return 2 * (Z @ x) / (1 + Z.sum(axis=1))


def left(values, reset):
    values = np.array(values, dtype=float)
    values[reset] = -np.inf
    return values.argmax()


def pops_reset(x, Z, reset):
    answer = choose(x, Z, reset)
    reset.append(answer)
    return answer


def with_p(p):
    def answer(u, z, c, d):
        return np.linalg.norm(u + c * p(u, z, d)) / (1 + c * np.linalg.norm(p(u, z, d)))

    return answer


WRONG = [
    (exercises.match, not_written, "still empty"),
    (exercises.match, lambda x, z: None, "return"),
    (exercises.match, lambda x, z: x & z, "one number, not .. numbers"),
    (exercises.match, lambda x, z: (x & z).sum(), "count the shared points"),
    (exercises.match, lambda x, z: (x & z).mean(), "not even match itself"),
    (exercises.match, lambda x, z: (x & z).sum() / z.sum(), "size of the template"),
    (exercises.match, lambda x, z: (x == z).mean(), "white in both"),
    (exercises.match, lambda x, z: (x & z).sum() / (x | z).sum(), "active in either"),
    (exercises.match, lambda x, z: 0.5, r"so the match is 0\.\d+; yours is 0.500"),
    (exercises.match, lambda x, z: np.inf, "not all of it is a number"),
    (exercises.choose, not_written, "still empty"),
    (exercises.choose, lambda x, Z, reset: signals(x, Z).max(), "which one it is"),
    (exercises.choose, lambda x, Z, reset: 6, "from 0 to 5, not 6"),
    (exercises.choose, lambda x, Z, reset: signals(x, Z).argmax(), "strongest of all nodes"),
    (exercises.choose, lambda x, Z, reset: np.delete(signals(x, Z), reset).argmax(), "are left"),
    (exercises.choose, lambda x, Z, reset: left(Z @ x, reset), "shared points alone"),
    (exercises.choose, lambda x, Z, reset: left(Z @ x / Z.sum(axis=1), reset), r"\|z_j\| alone"),
    (exercises.choose, lambda x, Z, reset: left(-signals(x, Z), reset), "weakest"),
    (exercises.choose, lambda x, Z, reset: left(signals(x, Z), reset[:1]), "which had been reset"),
    (exercises.choose, lambda x, Z, reset: left(range(6), reset), "but there is one with"),
    (exercises.choose, pops_reset, "changes its arguments"),
    (exercises.norm_r, not_written, "still empty"),
    (exercises.norm_r, lambda u, z, c, d: u + c * (u + d * z), "one number"),
    (exercises.norm_r, lambda u, z, c, d: 1, "added, not the norm of their sum"),
    (exercises.norm_r, lambda u, z, c, d: norm_r(u, z, -c, d), "minus"),
    (exercises.norm_r, lambda u, z, c, d: np.linalg.norm(u - c * (u + d * z))
     / (1 - c * np.linalg.norm(u + d * z)), "minus"),
    (exercises.norm_r, with_p(lambda u, z, d: u + z), "forgot d"),
    (exercises.norm_r, with_p(lambda u, z, d: d * z), "only d z"),
    (exercises.norm_r, lambda u, z, c, d: np.linalg.norm(u + c * (u + d * z))
     / (1 + np.linalg.norm(u + d * z)), "of c p, not of p"),
    (exercises.norm_r, lambda u, z, c, d: norm_r(u, z, c, d) ** 2, "root"),
    (exercises.norm_r, lambda u, z, c, d: u @ z / np.linalg.norm(z), "cosine"),
    (exercises.norm_r, lambda u, z, c, d: norm_r(u, z, c, d) - 0.01, "should be"),
    (exercises.norm_r, lambda u, z, c, d: norm_r(u, z, c, d) if z.any() else 0.0, "never reset"),
]  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))
