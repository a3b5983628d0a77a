"""Put a question to a student's function, and take what can go wrong on the way."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: A way of answering that is often taken, and what to say of it.
Rule = tuple[Callable[..., Any], str]


class ExerciseError(AssertionError):
    """An answer that is not right yet; the message says in what way."""

    def _render_traceback_(self) -> list[str]:
        """Show the message alone in a notebook: a student needs no tour of the checks."""
        return [f"Not yet: {self}"]


def ask(function: Callable[..., Any], *arguments: Any) -> Any:
    """Return what `function` answers to copies of the `arguments`.

    Raises
    ------
    ExerciseError
        If it is no function, is not written yet, stops with an error, returns nothing or changes
        an argument.

    Examples
    --------
    >>> ask(abs, -2)
    2
    >>> ask(print)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: print returned nothing: does it end with a `return`?
    """
    if not callable(function):
        raise ExerciseError(f"hand over the function by its name, without (...): got {function!r}")
    name = getattr(function, "__name__", "your function")
    given = copy.deepcopy(arguments)
    try:
        answer = function(*given)
    except NotImplementedError:
        raise ExerciseError(
            f"{name} is still empty: write its body, run its cell, come back"
        ) from None
    except Exception as error:
        asked = ", ".join(_short(argument) for argument in arguments)
        problem = f"{type(error).__name__}: {error}"
        raise ExerciseError(f"{name}({asked}) stopped with {problem}") from error
    if answer is None:
        raise ExerciseError(f"{name} returned nothing: does it end with a `return`?")
    for before, after in zip(arguments, given, strict=True):
        if not np.array_equal(before, after):
            raise ExerciseError(f"{name} changes what it was given: let it work on a copy")
    return answer


def numbers(name: str, answer: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an answer as an array of finite numbers, or say what it is instead.

    Examples
    --------
    >>> numbers("scale", 3.0, (2,))
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: scale should return an array of shape (2,), not ()
    """
    try:
        found = np.asarray(answer, dtype=float)
    except (TypeError, ValueError):
        raise ExerciseError(f"{name} should return numbers, not {_short(answer)}") from None
    if found.shape != shape:
        raise ExerciseError(f"{name} should return an array of shape {shape}, not {found.shape}")
    if not np.isfinite(found).all():
        raise ExerciseError(f"{name} returned {_short(found)}: not all of it is a number")
    return found


def judge(
    name: str,
    function: Callable[..., Any],
    cases: Sequence[tuple[Any, ...]],
    right: Callable[..., Any],
    wrong: Sequence[Rule],
) -> None:
    """Pass what `right` answers to all cases; of the rest say which `wrong` it is, or how far off.

    Examples
    --------
    >>> double = [(lambda x: x + 2, "you add two"), (lambda x: x**2, "you square")]
    >>> judge("twice", lambda x: x * x, [(3.0,), (5.0,)], lambda x: 2 * x, double)
    Traceback (most recent call last):
    arkaq_edu.exercises._ask.ExerciseError: you square
    """
    answers = [ask(function, *case) for case in cases]
    wanted = [right(*case) for case in cases]
    good = [_same(answer, value) for answer, value in zip(answers, wanted, strict=True)]
    if all(good):
        return
    # Some wrong answers have another shape, and are better told by what they are.
    for rule, words in wrong:
        if all(_same(answer, rule(*case)) for answer, case in zip(answers, cases, strict=True)):
            raise ExerciseError(words)
    found = [
        numbers(name, answer, np.shape(value))
        for answer, value in zip(answers, wanted, strict=True)
    ]
    i = good.index(False)
    place = np.abs(found[i] - wanted[i]).argmax()
    yours, ours = found[i].flat[place], np.ravel(wanted[i])[place]
    raise ExerciseError(
        f"{name} is right in {sum(good)} of {len(cases)} tries; one of yours, {yours:.5g}, is "
        f"too {'large' if yours > ours else 'small'}"
    )


def _same(answer: Any, other: Any) -> bool:
    try:
        found = np.asarray(answer, dtype=float)
    except (TypeError, ValueError):
        return False
    return found.shape == np.shape(other) and np.allclose(found, other)


def _short(value: Any) -> str:
    text = (
        np.array2string(value, precision=3, threshold=6)
        if isinstance(value, np.ndarray)
        else repr(value)
    )
    return text if len(text) <= 60 else text[:57] + "..."
