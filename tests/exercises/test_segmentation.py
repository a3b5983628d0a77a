"""The checks of the exercises: right answers pass, wrong ones are told in what way."""

import re

import numpy as np
import pytest

from arkaq_edu import exercises


def scale(distance, orientation):
    return (distance - 2150) / 1950, 2 * orientation


def gaps(x, m):
    return np.sqrt(((m - x) ** 2).sum(axis=1))


def nearest(x, m):
    return min(range(len(m)), key=lambda i: gaps(x, m)[i])


def present(x, m, rho, eta):
    i = nearest(x, m)
    if gaps(x, m)[i] < rho:
        return [row + eta * (x - row) if j == i else row for j, row in enumerate(m)]
    return [*m, x]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("exercise", "answer"),
    [(exercises.scale, scale), (exercises.nearest, nearest), (exercises.present, present)],
)
def test_a_right_answer_is_praised(exercise, answer, seed, capsys):
    exercise.check(answer, rng=seed)
    assert capsys.readouterr().out == exercise.praise + "\n"


def in_place(x, m, rho, eta):
    i = nearest(x, m)
    if gaps(x, m)[i] >= rho:
        return np.vstack([m, x])
    m[i] += eta * (x - m[i])
    return m


def moving(step):
    """An answer that founds rightly and puts `step(x, m, i, eta)` where it should move."""

    def answer(x, m, rho, eta):
        i = nearest(x, m)
        return step(x, m.copy(), i, eta) if gaps(x, m)[i] < rho else np.vstack([m, x])

    return answer


def set_row(m, i, row):
    m[i] = row
    return m


def founding(found):
    """An answer that moves rightly and gives ``found(x, m)`` where it should found."""
    return lambda x, m, rho, eta: present(x, m, rho, eta) if gaps(x, m).min() < rho else found(x, m)


def not_written(*_):
    raise NotImplementedError


def lenient(x, m, rho, eta):
    return present(x, m, np.nextafter(rho, 1), eta)


def first_hundred(x, m, rho, eta):
    return present(x, m, rho, eta) if len(m) < 12 else m


WRONG = [
    (exercises.scale, lambda d, o: (2 * o, (d - 2150) / 1950), "first the distance"),
    (exercises.scale, lambda d, o: ((d - 2150) / 1950, -2 * o), "left stays positive"),
    (exercises.scale, lambda d, o: ((d - 2150) / 1950, o), "from -0.5 to 0.5"),
    (exercises.scale, lambda d, o: ((d - 200) / 3900, 2 * o), "from 0 to 1"),
    (exercises.scale, lambda d, o: (((d - 2150) / 1950) ** 3, 2 * o), "straight"),
    (exercises.scale, lambda d, o: (d - 2150) / 1950, "two numbers: .*not one"),
    (exercises.scale, lambda d, o: "near", "numbers, not 'near'"),
    (exercises.scale, lambda d, o: (np.nan, 0), "not all of it is a number"),
    (exercises.scale, lambda d, o: d / zero, "stopped with NameError"),  # noqa: F821
    (exercises.scale, lambda d, o: None, "return"),
    (exercises.scale, not_written, "still empty"),
    (exercises.scale, (0, 0), "by its name"),
    (exercises.nearest, lambda x, m: gaps(x, m).argmax(), "farthest"),
    (exercises.nearest, lambda x, m: gaps(x, m).min(), "index"),
    (exercises.nearest, lambda x, m: m[nearest(x, m)], "index"),
    (exercises.nearest, lambda x, m: nearest(x, m) + 1, "from 0 to"),
    (exercises.nearest, lambda x, m: np.abs(m - x)[:, 0].argmin(), "first coordinate alone"),
    (exercises.nearest, lambda x, m: np.abs(m - x)[:, 1].argmin(), "second coordinate alone"),
    (exercises.nearest, lambda x, m: np.abs(m - x).sum(axis=1).argmin(), "round the corner"),
    (exercises.nearest, lambda x, m: (m - x).sum(axis=1).argmin(), "cancel"),
    (exercises.nearest, lambda x, m: (m @ x).argmax(), "dot product"),
    (exercises.nearest, lambda x, m: 0, "always answer 0"),
    (exercises.nearest, lambda x, m: len(m) - 1, "but there is one at"),
    (exercises.present, in_place, "copy"),
    (exercises.present, lambda x, m, rho, eta: np.vstack([m, x]), "founded another"),
    (exercises.present, lambda x, m, rho, eta: m.copy(), "left every center in place"),
    (exercises.present, lambda x, m, rho, eta: present(x, m, 9, eta), "one of its own"),
    (exercises.present, lambda x, m, rho, eta: x, "6 rows of 2 numbers, not 2"),
    (exercises.present, moving(lambda x, m, i, eta: m + eta * (x - m)), "centers moved at once"),
    (exercises.present, moving(lambda x, m, i, eta: set_row(m, i - 1, x)), "not the one nearest"),
    (
        exercises.present,
        moving(lambda x, m, i, eta: set_row(m, i, m[i] - eta * (x - m[i]))),
        "sign",
    ),
    (exercises.present, moving(lambda x, m, i, eta: set_row(m, i, x)), "jumped to the pattern"),
    (exercises.present, moving(lambda x, m, i, eta: set_row(m, i, eta * x)), "straight line"),
    (exercises.present, founding(lambda x, m: np.vstack([x, m])), "come last"),
    (exercises.present, founding(lambda x, m: np.vstack([m, 0 * x])), "where its pattern is"),
    (exercises.present, lenient, "exactly the vigilance"),
    (exercises.present, first_hundred, "after 150 in a row"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("exercise", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(exercise, answer, hint, seed):
    assert re.search(hint, exercise.problem(answer, rng=seed))
