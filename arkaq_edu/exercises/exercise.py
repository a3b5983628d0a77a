"""What an exercise is: a question, fresh cases, the right answer, the known wrong ones, hints.

The words of the exercises are in a TOML file beside each module: see `exercise`.
"""

from __future__ import annotations

import copy
import functools
import html
import inspect
import itertools
import os
import sys
import tomllib
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.exercises import solved
from arkaq_edu.exercises.words import as_floats, given, in_shapes, in_words, misfit, short

#: A way to compute an answer from the arguments of a case.
Rule = Callable[..., Any]
#: Draws the argument tuples on which an answer is tried.
Cases = Callable[[np.random.Generator], Sequence[tuple[Any, ...]]]
#: The argument tuples that one draw gives.
Draws = list[tuple[Any, ...]]

#: After so many wrong answers to an exercise, a hint is offered.
FAILURES_BEFORE_A_HINT = 3


class ExerciseError(Exception):
    """An answer that is not right yet. The message says what is wrong with it."""


class Empty(ExerciseError):
    """An answer that nobody has written yet."""


class Verdict(NamedTuple):
    """What one step of a check finds: the share of it that is right, and what is wrong, if any."""

    share: float
    problem: str
    empty: bool = False


class Solution(NamedTuple):
    """A right answer. A notebook shows it folded, so that it is read only on purpose."""

    name: str
    source: str

    def __repr__(self) -> str:
        return self.source

    def _repr_html_(self) -> str:
        summary = f"A solution of <code>{self.name}</code>: click to unfold"
        return (
            f"<details><summary>{summary}</summary><pre>{html.escape(self.source)}</pre></details>"
        )


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
    copies: list[Any] = [
        a if isinstance(a, np.random.Generator) else copy.deepcopy(a) for a in arguments
    ]
    try:
        with np.errstate(all="ignore"):
            answer = function(*copies)
    except NotImplementedError:
        raise Empty(f"{name} is still empty: write its body and run its cell") from None
    except SystemExit:
        raise ExerciseError(f"{name} leaves Python: return the answer instead of exit()") from None
    except Exception as error:
        asked = ", ".join(map(short, arguments))
        asked = "..." if "\n" in asked or len(asked) > 90 else asked
        problem = f"{name}({asked}) stopped with {type(error).__name__}: {error}"
        advice = misfit(error)
        if advice:
            problem = f"{name} puts together arrays that do not fit"
            advice = f"\n{in_shapes(inspect.signature(function), arguments)}\n{advice}"
        raise ExerciseError(problem + _where(error, function) + advice) from error
    if answer is None:
        raise ExerciseError(f"{name} returned nothing: does it end with a `return`?")
    if not all(np.array_equal(a, b) for a, b in zip(arguments, copies, strict=True)):
        raise ExerciseError(f"{name} changes its arguments: let it work on a copy")
    return answer


def _where(error: Exception, function: Callable[..., Any]) -> str:
    """Name the line of the student's own code at which it stopped."""
    file = getattr(getattr(function, "__code__", None), "co_filename", None)
    lines = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == file]
    return f"\n    in line {lines[-1].lineno} of your cell: {lines[-1].line}" if lines else ""


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
        found, wanted = as_floats(answer), as_floats(other)
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
    >>> twice = exercise.check(lambda x: x + x)
    Right: twice.
    >>> twice = exercise.check(lambda x: x * x)
    Not yet: you square.
    This page goes on with the course's own twice. Change yours, then run both cells again.
    >>> twice(8)
    16
    >>> exercise.problem(lambda x: x, rng=1)
    'two times 6 is more than 6'
    >>> exercise.problem(lambda x: [x, x])
    'twice should return one number, not 2 numbers'
    >>> exercise.hint()
    Hint 1 of 3: Add.
    >>> exercise
    twice(x): Return two times x. There are .check(twice), .hint() and .solution().
    """

    right: Rule
    praise: str
    hints: Sequence[str]
    parts: tuple[Part, ...]
    _: KW_ONLY
    returns: str | Sequence[str] = "one number"
    points: int = 2
    _hinted: int = field(default=0, init=False)
    _failed: int = field(default=0, init=False)
    _boxed: bool = field(default=False, init=False)

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

    def check(self, function: Rule, rng: np.random.Generator | int | None = None) -> Rule:
        """Try a student's function, say what is wrong with it, and return one that is right.

        When nbgrader runs the page, the points are shown too, as nbgrader wants them: as the
        output of the cell. Then the cases are always the same.

        Parameters
        ----------
        function : callable
            The student's answer.
        rng : numpy.random.Generator or int, optional
            Where the random cases come from.

        Returns
        -------
        callable
            The student's function if it is right, else the course's own. So a page can be read,
            and run, to its end. A right number in an array of its own is right, but a page cannot
            print it.
        """
        graded = "NBGRADER_EXECUTION" in os.environ
        steps: Iterable[Verdict] = self._steps(function, 0 if graded and rng is None else rng)
        steps = list(steps) if graded else steps
        wrong = next((step for step in steps if step.problem), None)
        if wrong:
            self._failed += not wrong.empty
            ended = "\n" in wrong.problem or wrong.problem[-1] in ".?"
            print(f"Not yet: {wrong.problem}{'' if ended else '.'}")
            print(
                f"This page goes on with the course's own {self.name}. "
                "Change yours, then run both cells again."
            )
            if self._failed >= FAILURES_BEFORE_A_HINT:
                print(f"Stuck? Write exercises.{self.name}.hint() in a new cell and run it.")
        else:
            self._failed = 0
            solved.add(self.name)
            print(self.praise)
            if self._boxed:
                print(
                    "(Yours returns each number in an array; the page goes on with plain numbers.)"
                )
        if graded:
            sys.displayhook(self._points(steps))
        return self.right if wrong or self._boxed else function

    def problem(self, function: Rule, rng: np.random.Generator | int | None = None) -> str:
        """Return what is wrong with a function first, on fresh cases; nothing if it is right."""
        return next((step.problem for step in self._steps(function, rng) if step.problem), "")

    def earned(self, function: Rule, rng: np.random.Generator | int | None = None) -> float:
        """Return the points that a function earns on fresh cases.

        Each step of the check counts alike. A wrong one earns the share of its results that are
        right, if there are several. If there is one it earns half, if at least half of the tries
        are right and no known mistake explains them.
        """
        return self._points(self._steps(function, rng))

    def _points(self, steps: Iterable[Verdict]) -> float:
        return round(self.points * float(np.mean([step.share for step in steps])), 2)

    def _steps(self, function: Rule, rng: np.random.Generator | int | None) -> Iterator[Verdict]:
        """Try a function, one step of the check after the other."""
        if function is self.right:
            problem = f"this is the course's own {self.name}: run the cell with your answer first"
            yield Verdict(0.0, problem, empty=True)
            return
        rng = np.random.default_rng(rng)
        cases: Sequence[tuple[Any, ...]] = []
        known, self._boxed = "", False
        for part in self.parts:
            cases = part.cases(rng) if part.cases else cases
            try:
                with warnings.catch_warnings(action="ignore"):
                    share, words = self._try(part, function, cases)
                yield Verdict(share, known + words if words and part.of else words)
            except ExerciseError as error:
                yield Verdict(0.0, str(error), isinstance(error, Empty))
            known = f"the {part.of} is right; "

    def hint(self) -> Solution | None:
        """Print the next hint. After the last one, return the solution, which a notebook folds."""
        if self._hinted == len(self.hints):
            print("There are no more hints. Here is a solution:")
            return self.solution()
        self._hinted += 1
        print(f"Hint {self._hinted} of {len(self.hints)}: {self.hints[self._hinted - 1]}")
        return None

    def solution(self) -> Solution:
        """Return a right answer, which a notebook shows folded."""
        source = inspect.getsource(self.right)
        return Solution(self.name, source[source.index("def ") :].rstrip())

    def function(self, expression: str) -> Rule:
        """Return the function of this exercise's arguments that an expression of ours computes."""
        arguments = ", ".join(inspect.signature(self.right).parameters)
        return self._evaluate(f"lambda {arguments}: {expression}", {})

    def numbers(self, answer: Any, *shapes: tuple[int, ...]) -> NDArray[np.float64]:
        """Return an answer as an array of one of these shapes, or say what it is instead."""
        found = as_floats(answer)
        if found is None:
            raise ExerciseError(f"{self.name} should return numbers, not {short(answer)}")
        if found.size == 1 and shapes == ((),):
            found = found.reshape(())
        if found.shape not in shapes:
            expected = self._expected(shapes[0])
            got = in_words(found.shape)
            raise ExerciseError(f"{self.name} should return {expected}, not {got}")
        if not np.isfinite(found).all():
            raise ExerciseError(f"{self.name} returned {short(found)}: not all of it is a number")
        return found

    def _expected(self, shape: tuple[int, ...]) -> str:
        if not isinstance(self.returns, str):
            *first, last = self.returns
            count = {2: "two", 3: "three"}[len(self.returns)]
            return f"{count} numbers: {', '.join(first)} and {last}"
        return self.returns + (f", here {in_words(shape)}" if shape else "")

    def _evaluate(self, expression: str, names: dict[str, Any]) -> Any:
        # Expressions are data of this package, never input.
        return eval(expression, self.right.__globals__ | names)  # type: ignore[attr-defined]

    def _try(
        self, part: Part, function: Rule, cases: Sequence[tuple[Any, ...]]
    ) -> tuple[float, str]:
        """Return what share of a step is right, and what is wrong with it, or nothing."""
        wanted = [np.asarray((part.right or self.right)(*case)) for case in cases]
        answers = [
            self._unboxed(part.answer(function, *case), value)
            for case, value in zip(cases, wanted, strict=True)
        ]
        several = not (part.right or isinstance(self.returns, str))
        swapped = several and self._swapped(part, answers, wanted)
        if part.of:
            k = self.returns.index(part.of)
            answers = [self.numbers(answer, (len(self.returns),))[k] for answer in answers]
            wanted = [value[k] for value in wanted]
        good = part.agree(answers, wanted)
        if all(good):
            return 1.0, ""
        if swapped:
            order = ", then the ".join(self.returns)
            return 0.0, f"the numbers are right, but not their order: return first the {order}"
        # Rules come before the shape: some wrong answers have another shape, and better words.
        for expression, words in part.wrong.items():
            rule = self.function(expression)
            if all(part.agree(answers, [rule(*case) for case in cases])):
                return self._share(part, answers, wanted, [0.0]), words
        found = [
            self.numbers(answer, value.shape) for answer, value in zip(answers, wanted, strict=True)
        ]
        # What a single try gives is judged number by number: it may stand for thousands of calls.
        right = good if len(good) > 1 else part.close(found[0], wanted[0])
        share = self._share(part, found, wanted, right)
        if (
            not part.right
            and wanted[0].dtype.kind == "f"
            and any(
                all(map(np.allclose, found, [value.round(digits) for value in wanted]))
                for digits in range(4)
            )
        ):
            return share, "you round the answer: return it with all its digits"
        tries = zip(found, wanted, cases, good, strict=True)
        wrong = [(one, other, case) for one, other, case, right in tries if not right]
        one, other, case = wrong[0]
        names = dict(zip(inspect.signature(self.right).parameters, case, strict=False))
        names = {"found": one, "wanted": other, "otherwise": True, **names}
        for condition, words in part.tell.items():
            if self._evaluate(condition, names):
                return share, self._evaluate(f"f{words!r}", names)
        smallest = min(wrong, key=lambda trio: sum(map(np.size, trio[-1])))
        return share, self._example(part, sum(good), len(cases), *smallest)

    def _unboxed(self, answer: Any, wanted: NDArray[Any]) -> Any:
        """Return an answer without the array that each of its numbers may be in."""
        found = as_floats(answer)
        if found is None or found.shape == wanted.shape or found.size != wanted.size:
            return answer
        if found.size > 1 and (isinstance(self.returns, str) or len(found) != len(self.returns)):
            return answer
        self._boxed = True
        return found.reshape(wanted.shape)

    def _swapped(self, part: Part, answers: Sequence[Any], wanted: Sequence[Any]) -> bool:
        """Say whether all numbers are right, in another order."""
        rows, count = [as_floats(answer) for answer in answers], len(self.returns)
        if any(row is None or row.shape != (count,) for row in rows):
            return False
        orders = itertools.permutations(range(count))
        return any(np.all(part.close(np.array(rows)[:, order], wanted)) for order in orders)

    def _share(
        self, part: Part, answers: Sequence[Any], wanted: Sequence[Any], right: Any
    ) -> float:
        """Return what a wrong step earns: see `Exercise.earned`."""
        rows = [as_floats(answer) for answer in answers]
        several = not (part.of or part.right or isinstance(self.returns, str))
        if several and all(row is not None and row.shape == (len(self.returns),) for row in rows):
            return float(np.mean(np.all(part.close(np.array(rows), np.array(wanted)), axis=0)))
        return 0.5 if np.mean(right) >= 0.5 else 0.0

    def _example(
        self, part: Part, good: int, tries: int, one: Any, other: Any, case: tuple[Any, ...]
    ) -> str:
        """Show one small try that is wrong, and what to look at in it."""
        name = f"the {part.of}" if part.of else self.name
        place = int(np.argmin(part.close(one, other)))
        if not part.of and not isinstance(self.returns, str):
            name = self.returns[place]
        says = f"{name} is right in {good} of {tries} tries"
        if part.right:  # what was judged is not what the function returned
            return says
        which = f"its number {place + 1} is" if one.size > 1 else "which is"
        side = "too large" if one.flat[place] > other.flat[place] else "too small"
        return (
            f"{says}. In this one it is wrong:\n{given(inspect.signature(self.right), case)}\n"
            f"    yours: {short(one)}, {which} {'wrong' if other.dtype.kind in 'iu' else side}\n"
            "Work this one out by hand, a line at a time, and compare."
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


def judgement(options: int) -> Part:
    """Return the step of an exercise that asks for the number of one of so many options."""

    def answer(function: Callable[..., Any]) -> int:
        found = ask(function)
        if isinstance(found, bool) or found not in range(1, options + 1):
            raise ExerciseError(
                f"the answer should be the number of an option, from 1 to {options}, "
                f"not {short(found)}"
            )
        return int(found)

    return Part(lambda rng: [()], answer=answer)


def index(
    thing: str, count: Callable[..., int], hint: str = "which one it is"
) -> Callable[..., int]:
    """Return an `answer` for `Part` that takes only the index of one of ``count(*case)`` things."""

    def answer(function: Callable[..., Any], *case: Any) -> int:
        found, n = ask(function, *case), count(*case)
        value = np.asarray(found)
        value = value.reshape(()) if value.size == 1 else value
        if value.shape != () or value.dtype.kind not in "iu" or not 0 <= value < n:
            raise ExerciseError(
                f"the answer should be the index of {thing}, a whole number from 0 to {n - 1}, "
                f"not {short(found)}: {hint}"
            )
        return int(value)

    return answer
