"""The checks of the exercises: right answers pass, wrong ones are told in what way."""

import numpy as np
import pytest

from arkaq_edu.exercises import ExerciseError, check_nearest, check_present, check_scale


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
    ("check", "answer"), [(check_scale, scale), (check_nearest, nearest), (check_present, present)]
)
def test_a_right_answer_is_praised(check, answer, seed):
    assert check(answer, rng=seed).startswith("Right")


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
    (check_scale, lambda d, o: (2 * o, (d - 2150) / 1950), "wrong order"),
    (check_scale, lambda d, o: ((d - 2150) / 1950, -2 * o), "left is positive"),
    (check_scale, lambda d, o: ((d - 2150) / 1950, o), r"orientation 0.5 rad should become 1"),
    (check_scale, lambda d, o: ((d - 200) / 3900, 2 * o), r"distance 200 mm should become -1"),
    (check_scale, lambda d, o: (((d - 2150) / 1950) ** 3, 2 * o), "straight"),
    (check_scale, lambda d, o: (d - 2150) / 1950, r"shape \(2,\), not \(\)"),
    (check_scale, lambda d, o: "near", "numbers, not 'near'"),
    (check_scale, lambda d, o: (np.nan, 0), "not all of it is a number"),
    (check_scale, lambda d, o: d / zero, "stopped with NameError"),  # noqa: F821
    (check_scale, lambda d, o: None, "return"),
    (check_scale, not_written, "still empty"),
    (check_scale, (0, 0), "by its name"),
    (check_nearest, lambda x, m: gaps(x, m).argmax(), "farthest"),
    (check_nearest, lambda x, m: gaps(x, m).min(), "index"),
    (check_nearest, lambda x, m: m[nearest(x, m)], "index"),
    (check_nearest, lambda x, m: nearest(x, m) + 1, "indices 0 to"),
    (check_nearest, lambda x, m: np.abs(m - x)[:, 0].argmin(), "first coordinate alone"),
    (check_nearest, lambda x, m: np.abs(m - x)[:, 1].argmin(), "second coordinate alone"),
    (check_nearest, lambda x, m: np.abs(m - x).sum(axis=1).argmin(), "round the corner"),
    (check_nearest, lambda x, m: (m - x).sum(axis=1).argmin(), "cancel"),
    (check_nearest, lambda x, m: (m @ x).argmax(), "dot product"),
    (check_nearest, lambda x, m: 0, "always answer 0"),
    (check_nearest, lambda x, m: len(m) - 1, "but there is one at"),
    (check_present, in_place, "copy"),
    (check_present, lambda x, m, rho, eta: np.vstack([m, x]), "founded another"),
    (check_present, lambda x, m, rho, eta: m.copy(), "left every center in place"),
    (check_present, lambda x, m, rho, eta: present(x, m, 9, eta), "one of its own"),
    (check_present, lambda x, m, rho, eta: x, "shape"),
    (check_present, moving(lambda x, m, i, eta: m + eta * (x - m)), "centers moved at once"),
    (check_present, moving(lambda x, m, i, eta: set_row(m, i - 1, x)), "not the one nearest"),
    (check_present, moving(lambda x, m, i, eta: set_row(m, i, m[i] - eta * (x - m[i]))), "sign"),
    (check_present, moving(lambda x, m, i, eta: set_row(m, i, x)), "1.00 of the way"),
    (check_present, moving(lambda x, m, i, eta: set_row(m, i, eta * x)), "straight line"),
    (check_present, founding(lambda x, m: np.vstack([x, m])), "come last"),
    (check_present, founding(lambda x, m: np.vstack([m, 0 * x])), "where its pattern is"),
    (check_present, lenient, "exactly the vigilance"),
    (check_present, first_hundred, "after 150 in a row"),
]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("check", "answer", "hint"), WRONG)
def test_a_wrong_answer_is_told_what_is_wrong(check, answer, hint, seed):
    with pytest.raises(ExerciseError, match=hint):
        check(answer, rng=seed)


def test_fresh_inputs_come_from_the_given_generator():
    asked = []

    def spy(distance, orientation):
        asked.append((distance, orientation))
        return scale(distance, orientation)

    for seed in (1, 1, 2):
        check_scale(spy, rng=seed)
    once = len(asked) // 3
    assert asked[:once] == asked[once : 2 * once] != asked[2 * once :]


def test_a_notebook_shows_the_message_and_no_traceback():
    with pytest.raises(ExerciseError) as caught:
        check_nearest(lambda x, m: 0)
    lines = caught.value._render_traceback_()
    assert lines == [f"Not yet: {caught.value}"]
    assert issubclass(ExerciseError, AssertionError), "an autograder counts a failed assertion"
