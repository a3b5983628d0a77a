"""What an exercise is: a question, fresh cases, the right answer, the known wrong ones, hints.

The words of the exercises are in a TOML file beside each module: see `exercise`.
"""

from __future__ import annotations

import copy
import functools
import inspect
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import shown

#: A way to compute an answer from the arguments of a case.
Rule = Callable[..., Any]
#: Draws the argument tuples on which an answer is tried.
Cases = Callable[[np.random.Generator], Sequence[tuple[Any, ...]]]
#: The argument tuples that one draw gives.
Draws = list[tuple[Any, ...]]


class ExerciseError(AssertionError):
    """An answer that is not right yet. The message says what is wrong with it."""

    def _render_traceback_(self) -> list[str]:
        """Show only the message in a notebook: the code of the checks does not help a student."""
        return [f"Not yet: {self}"]


def ask(function: Callable[..., Any], *arguments: Any) -> Any:
    """Return what a student's function answers to copies of the arguments.

    A random generator is passed as it is, so that each call draws new numbers.

    Raises
    ------
    ExerciseError
        If the function is not callable, not written yet, stops with an error, returns nothing or
        changes an argument.

    Examples
    --------
    >>> ask(abs, -2)
    2
    >>> ask(print)
    Traceback (most recent call last):
    arkaq_edu.exercises.exercise.ExerciseError: print returned nothing: does it end with a `return`?
    """
    if not callable(function):
        raise ExerciseError(f"pass the function by its name, without (...): got {function!r}")
    name = getattr(function, "__name__", "your function")
    given: list[Any] = [
        a if isinstance(a, np.random.Generator) else copy.deepcopy(a) for a in arguments
    ]
    try:
        with np.errstate(all="ignore"):
            answer = function(*given)
    except NotImplementedError:
        raise ExerciseError(
            f"{name} is still empty: write its body, run its cell, then run this check again"
        ) from None
    except SystemExit:
        raise ExerciseError(f"{name} leaves Python: return the answer instead of exit()") from None
    except Exception as error:
        asked = ", ".join(map(_short, arguments))
        problem = f"{type(error).__name__}: {error}"
        raise ExerciseError(f"{name}({asked}) stopped with {problem}") from error
    if answer is None:
        raise ExerciseError(f"{name} returned nothing: does it end with a `return`?")
    if not all(np.array_equal(a, b) for a, b in zip(arguments, given, strict=True)):
        raise ExerciseError(f"{name} changes its arguments: let it work on a copy")
    return answer


@dataclass
class Part:
    """One step of a check: cases, and the known wrong answers to them.

    Parameters
    ----------
    cases : callable, optional
        Draws the cases. By default those of the step before are used again.
    wrong : dict of str to str
        The known wrong answers, as a student would write them with the arguments' names, and what
        to say to each. The first one that explains all answers counts.
    of : str, optional
        Which of several results is judged. By default all of them at once.
    right : Rule, optional
        The right answer. By default the exercise's own.
    answer : callable
        ``answer(function, *case)`` turns the student's function into numbers to compare, and
        raises `ExerciseError` for what cannot be an answer. By default it just calls the function.
    close : callable
        ``close(found, wanted)`` says which numbers are near enough.
    tell : dict of str to str
        What to say to a wrong answer that no rule explains. Each key is a condition on the
        answer `found`, the answer `wanted` and the arguments of the case; ``otherwise`` always
        holds. The words are those of an f-string. If no condition holds, the usual words are said.
    """

    cases: Cases | None = None
    wrong: dict[str, str] = field(default_factory=dict)
    of: str = ""
    right: Rule | None = None
    answer: Callable[..., Any] = ask
    close: Callable[..., Any] = np.isclose
    tell: dict[str, str] = field(default_factory=dict)

    def agree(self, answers: Sequence[Any], others: Sequence[Any]) -> list[bool]:
        """Return which of the answers have the shape of the others, and nearly their numbers."""
        return [self._same(*pair) for pair in zip(answers, others, strict=True)]

    def _same(self, answer: Any, other: Any) -> bool:
        found, wanted = _floats(answer), _floats(other)
        if found is None or wanted is None:
            return False
        return found.shape == wanted.shape and bool(np.all(self.close(found, wanted)))


@dataclass(repr=False)
class Exercise:
    """A question with its answer. Call it to get the right answer.

    Parameters
    ----------
    right : callable
        The right answer. Its docstring says what is asked, and its source is the solution.
    praise : str
        What a passing check prints.
    hints : sequence of str
        Three hints: a nudge, a part of the answer, and how to write all of it.
    parts : tuple of Part
        What the check goes through. It stops at the first part that is wrong.
    returns : str or list of str
        What the answer is, in words, or the names of several results.
    points : int
        What a right answer earns.

    Examples
    --------
    >>> def twice(x):
    ...     "Return two times x."
    ...     return 2 * x
    >>> part = Part(
    ...     cases=lambda rng: [(x,) for x in rng.uniform(3, 9, 5)],
    ...     wrong={"x + 2": "you add two", "x**2": "you square"},
    ...     tell={"found < wanted": "two times {x:.0f} is more than {found:.0f}"},
    ... )
    >>> exercise = Exercise(twice, "Right: twice.", ("Add.", "x + ...", "x + x"), (part,))
    >>> exercise.check(lambda x: x + x)
    Right: twice.
    >>> exercise.check(lambda x: x * x)
    Traceback (most recent call last):
    arkaq_edu.exercises.exercise.ExerciseError: you square
    >>> exercise.check(lambda x: x, rng=1)
    Traceback (most recent call last):
    arkaq_edu.exercises.exercise.ExerciseError: two times 6 is more than 6
    >>> exercise.check(lambda x: [x, x])
    Traceback (most recent call last):
    arkaq_edu.exercises.exercise.ExerciseError: twice should return one number, not 2 numbers
    >>> exercise.hint()
    Hint 1 of 3: Add.
    >>> exercise
    twice(x): Return two times x. There are .check(twice), .hint() and .solution().
    >>> exercise(4)
    8
    """

    right: Rule
    praise: str
    hints: Sequence[str]
    parts: tuple[Part, ...]
    _: KW_ONLY
    returns: str | Sequence[str] = "one number"
    points: int = 2
    _hinted: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        functools.update_wrapper(self, self.right)
        self.name = self.right.__name__

    def __call__(self, *arguments: Any) -> Any:
        """Return the right answer."""
        return self.right(*arguments)

    def __repr__(self) -> str:
        """Say what is asked, and what an exercise can do."""
        asks = inspect.getdoc(self.right).partition("\n")[0]  # type: ignore[union-attr]
        rest = f"There are .check({self.name}), .hint() and .solution()."
        return f"{self.name}{inspect.signature(self.right)}: {asks} {rest}"

    def check(
        self, function: Callable[..., Any], rng: np.random.Generator | int | None = None
    ) -> None:
        """Try a student's function on fresh cases, and print praise if it is right.

        Parameters
        ----------
        function : callable
            The student's answer.
        rng : numpy.random.Generator or int, optional
            Where the random cases come from.

        Raises
        ------
        ExerciseError
            With what is wrong with the answer.
        """
        rng = np.random.default_rng(rng)
        cases: Sequence[tuple[Any, ...]] = []
        known = ""
        for part in self.parts:
            cases = part.cases(rng) if part.cases else cases
            words = self._judge(part, function, cases)
            if words:
                raise ExerciseError(known + words if part.of else words)
            known = f"the {part.of} is right; "
        print(self.praise)

    def hint(self) -> None:
        """Print the next hint. After the last one, say how to see the solution."""
        if self._hinted == len(self.hints):
            print(f"There are no more hints. {self.name}.solution() shows an answer.")
            return
        self._hinted += 1
        print(f"Hint {self._hinted} of {len(self.hints)}: {self.hints[self._hinted - 1]}")

    def solution(self) -> None:
        """Print a right answer."""
        source = inspect.getsource(self.right)
        print(source[source.index("def ") :].rstrip())

    def function(self, expression: str) -> Rule:
        """Return the function of this exercise's arguments that an expression of ours computes."""
        arguments = ", ".join(inspect.signature(self.right).parameters)
        return self._evaluate(f"lambda {arguments}: {expression}", {})

    def numbers(self, answer: Any, *shapes: tuple[int, ...]) -> NDArray[np.float64]:
        """Return an answer as an array of one of these shapes, or say what it is instead."""
        found = _floats(answer)
        if found is None:
            raise ExerciseError(f"{self.name} should return numbers, not {_short(answer)}")
        if found.shape not in shapes:
            expected = self._expected(shapes[0])
            got = _in_words(found.shape)
            raise ExerciseError(f"{self.name} should return {expected}, not {got}")
        if not np.isfinite(found).all():
            raise ExerciseError(f"{self.name} returned {_short(found)}: not all of it is a number")
        return found

    def _expected(self, shape: tuple[int, ...]) -> str:
        if not isinstance(self.returns, str):
            *first, last = self.returns
            count = {2: "two", 3: "three"}[len(self.returns)]
            return f"{count} numbers: {', '.join(first)} and {last}"
        return self.returns + (f", here {_in_words(shape)}" if shape else "")

    def _evaluate(self, expression: str, names: dict[str, Any]) -> Any:
        # Expressions are data of this package, never input.
        return eval(expression, self.right.__globals__ | names)  # type: ignore[attr-defined]

    def _judge(
        self, part: Part, function: Callable[..., Any], cases: Sequence[tuple[Any, ...]]
    ) -> str | None:
        """Return what is wrong with the answers to the cases, or None."""
        answers = [part.answer(function, *case) for case in cases]
        wanted = [np.asarray((part.right or self.right)(*case), dtype=float) for case in cases]
        if part.of:
            k = self.returns.index(part.of)
            answers = [self.numbers(answer, (len(self.returns),))[k] for answer in answers]
            wanted = [value[k] for value in wanted]
        good = part.agree(answers, wanted)
        if all(good):
            return None
        # Rules come before the shape: some wrong answers have another shape, and better words.
        for expression, words in part.wrong.items():
            rule = self.function(expression)
            if all(part.agree(answers, [rule(*case) for case in cases])):
                return words
        found = [
            self.numbers(answer, value.shape) for answer, value in zip(answers, wanted, strict=True)
        ]
        first = good.index(False)
        one, other = found[first], wanted[first]
        case = dict(zip(inspect.signature(self.right).parameters, cases[first], strict=False))
        names = {"found": one, "wanted": other, "otherwise": True, **case}
        for condition, words in part.tell.items():
            if self._evaluate(condition, names):
                return self._evaluate(f"f{words!r}", names)
        place = int(np.argmin(part.close(one, other)))
        name = f"the {part.of}" if part.of else self.name
        if not part.of and not isinstance(self.returns, str):
            name = self.returns[place]
        yours, ours = one.flat[place], other.flat[place]
        return (
            f"{name} is right in {sum(good)} of {len(cases)} tries; one of yours, {yours:.5g}, is "
            f"too {'large' if yours > ours else 'small'}"
        )


@functools.cache
def _tables(file: Path) -> dict[str, Any]:
    return tomllib.loads(file.read_text("utf-8"))


def exercise(only: Part | None = None, /, **steps: Part) -> Callable[[Rule], Exercise]:
    """Make an exercise of the function below, which is its right answer.

    The rest is in the table with the function's name in the TOML file beside its module: praise,
    hints, returns and points (see `Exercise`), and what each step says to a wrong answer (`wrong`
    and `tell`, see `Part`).

    Parameters
    ----------
    only : Part
        The only step. Its tables in the file are ``[NAME.wrong]`` and ``[NAME.tell]``.
    **steps : Part
        Several steps, in their order. Their tables are ``[NAME.wrong.STEP]`` and
        ``[NAME.tell.STEP]``. A step with the name of one of several results judges only that.

    Raises
    ------
    ValueError
        If the file has no such table, or the table does not fit the steps.
    """
    parts = {"": only} if only else steps

    def make(right: Rule) -> Exercise:
        file, name = Path(inspect.getfile(right)).with_suffix(".toml"), right.__name__
        table = dict(_tables(file).get(name, {}))
        for key in ("wrong", "tell"):
            tables = table.pop(key, {})
            for step, words in ({"": tables} if only else tables).items():
                place = f"{file.name}: [{'.'.join(filter(None, (name, key, step)))}]"
                if step not in parts or not all(isinstance(text, str) for text in words.values()):
                    known = f"the steps {', '.join(steps)}" if steps else "a single step"
                    raise ValueError(f"{place} should be texts; {file.stem}.py has {known}")
                strings = [f"f{text!r}" for text in words.values()] if key == "tell" else []
                for code in (*words, *strings):
                    compile(code, place, "eval")
                setattr(parts[step], key, words)
        if table.keys() != {"praise", "hints", "returns", "points"}:
            found = ", ".join(table) or "nothing"
            raise ValueError(
                f"{file.name}: [{name}] should have praise, hints, returns and points, not {found}"
            )
        for step, part in parts.items():
            part.of = step if step in list(table["returns"]) else ""
        return Exercise(right, parts=tuple(parts.values()), **table)

    return make


def index(
    thing: str, count: Callable[..., int], hint: str = "which one it is"
) -> Callable[..., int]:
    """Return an `answer` for `Part` that takes only the index of one of ``count(*case)`` things."""

    def answer(function: Callable[..., Any], *case: Any) -> int:
        found, n = ask(function, *case), count(*case)
        value = np.asarray(found)
        if value.shape != () or value.dtype.kind not in "iu" or not 0 <= value < n:
            raise ExerciseError(
                f"the answer should be the index of a {thing}, a whole number from 0 to {n - 1}, "
                f"not {_short(found)}: {hint}"
            )
        return int(value)

    return answer


def _floats(answer: Any) -> NDArray[np.float64] | None:
    """Return an answer as floats, or None for text, complex numbers and what has no one shape."""
    try:
        found = np.asarray(answer)
        return found.astype(float) if found.dtype.kind in "biufO" else None
    except (TypeError, ValueError, OverflowError):
        return None


def _in_words(shape: tuple[int, ...]) -> str:
    if shape == ():
        return "one number"
    if shape == (1,):
        return "an array with one number"
    return f"{shape[0]} numbers" if len(shape) == 1 else f"an array of shape {shape}"


def _short(value: Any) -> str:
    if isinstance(value, np.random.Generator):
        return "rng"
    if not isinstance(value, np.ndarray):
        return shown(value)
    text = np.array2string(value, precision=3, threshold=6)
    return text if len(text) <= 60 else text[:57] + "..."
