"""The reader of Cassandra's .POMDP format: the tokens of a file, and the grammar above them."""

from __future__ import annotations

import math
import re
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import LARGEST
from arkaq_edu.pomdp.model import POMDP

Floats = NDArray[np.float64]

# What a file may ask for. A table of 2^24 numbers takes 128 MiB of memory.
MOST_BYTES, MOST_NAMES, MOST_ENTRIES = 2**27, 2**16, 2**24

# How far from 1 the sum of a row may be, so that 0.3333 three times is read as thirds.
ROUNDING = 1.01e-4
# Rows nearer to 1 than this are kept to the last bit: a POMDP accepts them as they are.
EXACT = 1e-9

KINDS = ("states", "actions", "observations")
PREAMBLE = ("discount", "values", *KINDS)
RESERVED = {
    *PREAMBLE, "start", "include", "exclude", "T", "O", "R",
    "uniform", "identity", "reset", "reward", "cost",
}  # fmt: skip
WORD = re.compile(r"[A-Za-z][\w-]*", re.ASCII)
# The quantifiers are possessive (a second +), so that a long run of digits is read only once.
_TOKEN = re.compile(
    r"(?P<number>[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?+(?![\w.]))"
    rf"|(?P<word>{WORD.pattern})|(?P<mark>[:*+-])|(?P<other>[^\s#:]++)|\s++|#[^\n]*+",
    re.ASCII,
)


class PomdpFormatError(ValueError):
    """A .POMDP file that cannot be read: what was expected, and where.

    Attributes
    ----------
    problem : str
        What was expected, and what was found instead.
    path : str
        The file.
    line, column : int
        The place in it, both counted from 1.

    Examples
    --------
    >>> print(PomdpFormatError("expected ':', got '0.9'", "my.pomdp", 3, 10))
    my.pomdp, line 3, column 10: expected ':', got '0.9'
    """

    def __init__(self, problem: str, path: str, line: int, column: int) -> None:
        super().__init__(problem, path, line, column)
        self.problem, self.path, self.line, self.column = problem, path, line, column

    def __str__(self) -> str:
        return f"{self.path}, line {self.line}, column {self.column}: {self.problem}"


def parse(path: str, source: str) -> POMDP:
    """Return the model that the text of a .POMDP file describes.

    Parameters
    ----------
    path : str
        The name of the file, for error messages.
    source : str
        Its text.

    Returns
    -------
    POMDP

    Raises
    ------
    PomdpFormatError
        If the text does not follow the format.

    Examples
    --------
    >>> parse("mdp", "discount: 0.9 values: reward states: 2 actions: 1 T: 0 identity")
    POMDP(2 states, 1 action, 2 observations, gamma=0.9)
    """
    return _Reader(path, source).model()


class _Tokens:
    """The tokens of a file, one after the other.

    The current token has a `kind` ("number", "word", "mark", "other" or "end"), a `text`, and a
    place `at` in the source.
    """

    def __init__(self, path: str, source: str) -> None:
        self.path, self.source = path, source
        self.tokens = _TOKEN.finditer(source)
        self.advance()

    def advance(self) -> None:
        """Go on to the next token; blanks and comments are skipped."""
        for match in self.tokens:
            if match.lastgroup:
                self.kind, self.text, self.at = match.lastgroup, match.group(), match.start()
                return
        self.kind, self.text, self.at = "end", "", len(self.source)

    def refuse(self, problem: str, at: int) -> NoReturn:
        line = self.source.count("\n", 0, at) + 1
        raise PomdpFormatError(problem, self.path, line, at - self.source.rfind("\n", 0, at))

    def expected(self, what: str) -> NoReturn:
        """Refuse the current token."""
        got = repr(self.text if len(self.text) <= 40 else self.text[:40] + "...")
        self.refuse(f"expected {what}, got {got if self.text else 'the end of the file'}", self.at)

    def take(self, *words: str) -> str:
        """Take one of some words or marks."""
        word = self.text
        if word not in words:
            self.expected(" or ".join(map(repr, words)))
        self.advance()
        return word

    def number(self, what: str, low: float, high: float) -> float:
        at, text = self.at, self.text
        if text in ("+", "-"):  # a sign may stand apart from its number
            self.advance()
            text += self.text
        if self.kind != "number" or text[1:2] in ("+", "-"):
            self.expected(what)
        value = float(text)
        if not low <= value <= high:
            self.refuse(f"expected {what}, got {text[:40]}", at)
        self.advance()
        return value

    def numbers(self, shape: list[int], what: str, low: float, high: float) -> Floats:
        values = np.empty(math.prod(shape))
        for i in range(len(values)):
            if self.kind in ("word", "end"):
                self.expected(f"{what} ({i} of {len(values)} are given)")
            values[i] = self.number(what, low, high)
        return values.reshape(shape)

    def is_count(self) -> bool:
        return self.kind == "number" and self.text.isdigit()

    def count(self) -> float:
        """Return the current token as a count; what is far too large is infinite."""
        return int(self.text) if len(self.text) < 10 else math.inf

    def is_name(self) -> bool:
        return self.kind == "word" and self.text not in RESERVED


class _Reader(_Tokens):
    """The grammar: one method for each rule, from the whole file down to a row of numbers."""

    def __init__(self, path: str, source: str) -> None:
        super().__init__(path, source)
        self.declared: set[str] = set()
        self.index: dict[str, dict[str, int]] = {}  # of each kind: the number of each name

    def model(self) -> POMDP:
        while self.text in PREAMBLE:
            self.declaration()
        if missing := [word for word in PREAMBLE[:4] if word not in self.declared]:
            self.expected(" and ".join(f"'{word}:'" for word in missing))
        self.make_tables()
        if self.text == "start":
            self.start()
        while self.kind != "end":
            self.entry()
        return self.finished()

    # The preamble: the discount, the sign of the rewards, and the names

    def declaration(self) -> None:
        at, word = self.at, self.take(*PREAMBLE)
        self.take(":")
        if word in self.declared:
            self.refuse(f"expected '{word}:' only once", at)
        self.declared.add(word)
        if word == "discount":
            self.gamma = self.discount()
        elif word == "values":
            self.costs = self.take("reward", "cost") == "cost"
        elif self.is_count():
            if not 1 <= self.count() <= MOST_NAMES:
                self.expected(f"a count of {word} from 1 to {MOST_NAMES}")
            self.index[word] = {str(i): i for i in range(int(self.count()))}
            self.advance()
        else:
            self.index[word] = self.names(word)

    def discount(self) -> float:
        at, gamma = self.at, self.number("a discount in [0, 1)", 0, 1)
        if gamma == 1:
            self.refuse(
                "expected a discount below 1, got 1: without an end the values would not be "
                "finite; use a value such as 0.999 instead",
                at,
            )
        return gamma

    def names(self, kind: str) -> dict[str, int]:
        names: dict[str, int] = {}
        while self.is_name():
            if self.text in names:
                self.expected(f"different names for the {kind}")
            if len(names) == MOST_NAMES:
                self.expected(f"at most {MOST_NAMES} {kind}")
            names[self.text] = len(names)
            self.advance()
        if not names:
            self.expected(f"a count of {kind} or their names, none of them a word of the format")
        return names

    # The tables that the entries fill

    def make_tables(self) -> None:
        self.index.setdefault("observations", self.index["states"])
        self.sizes = {kind: len(self.index[kind]) for kind in KINDS}
        self.axes: dict[str, tuple[str, ...]] = {
            "T": ("actions", "states", "states"),
            "O": ("actions", "states", "observations"),
            "R": ("actions", "states", "states", "observations"),
        }
        if "observations" not in self.declared:  # an MDP: its state is seen
            self.axes = {"T": self.axes["T"], "R": self.axes["R"][:3]}
        self.table = {}
        for letter, axes in self.axes.items():
            shape = [self.sizes[kind] for kind in axes]
            if letter == "R":  # it grows along the last axes where an entry needs it
                shape[2:] = [1] * len(shape[2:])
            self.table[letter] = np.zeros(self.affordable(letter, shape))
        # Where in the source each row was given, for error messages.
        self.given = {letter: np.full(table.shape[:2], -1) for letter, table in self.table.items()}
        self.belief = np.full(self.sizes["states"], 1 / self.sizes["states"])

    def affordable(self, letter: str, shape: list[int]) -> list[int]:
        if math.prod(shape) > MOST_ENTRIES:
            sizes = " x ".join(map(str, shape))
            self.refuse(
                f"expected a table {letter} of at most {MOST_ENTRIES} entries, not {sizes}", self.at
            )
        return shape

    # The belief at the start

    def start(self) -> None:
        at, n = self.at, self.sizes["states"]
        self.take("start")
        form = self.take(":", "include", "exclude")
        if form != ":":
            self.take(":")
            chosen = np.zeros(n, dtype=bool)
            while True:
                chosen[self.pick("states")] = True
                if not (self.text == "*" or self.is_count() or self.is_name()):
                    break
            chosen ^= form == "exclude"
            if not chosen.any():
                self.refuse("expected at least one state that is not excluded", at)
            self.belief = chosen / chosen.sum()
        elif self.text == "uniform":
            self.advance()
        elif self.is_name():
            self.belief = np.zeros(n)
            self.belief[self.pick("states")] = 1
        else:
            self.belief = self.start_numbers(n)

    def start_numbers(self, n: int) -> Floats:
        """Read the probabilities of all states, or the number of one state."""
        at, first, is_count = self.at, self.text, self.is_count()
        values: list[float] = []
        while self.kind == "number" and len(values) < n:
            values.append(self.number("a probability in [0, 1]", 0, math.inf))
        if len(values) == 1 and n > 1 and is_count:
            if not values[0] < n:
                self.refuse(f"expected a state from 0 to {n - 1}, got {first[:40]}", at)
            return np.eye(1, n, int(values[0]))[0]
        if len(values) < n:
            self.expected(f"a probability for each state ({len(values)} of {n} are given)")
        return self.normalized("start", np.array([values]), np.array([at]))[0]

    # The entries of T, O and R

    def entry(self) -> None:
        at = self.at
        if self.kind == "number":
            self.expected("'T', 'O' or 'R' (the entry before is complete)")
        if self.text == "O" and "O" not in self.axes:
            self.expected("no observation probabilities without 'observations:'")
        letter = self.take(*self.axes)
        self.take(":")
        axes = self.axes[letter]
        key = [self.pick(axes[0])]
        # What is left open is a row or a matrix, so at most two axes.
        while len(key) < len(axes) and (self.text == ":" or len(key) < len(axes) - 2):
            self.take(":")
            key.append(self.pick(axes[len(key)]))
        block = self.block(letter, key)
        if letter == "R":
            self.grow(key)
        self.table[letter][tuple(key)] = block
        self.given[letter][tuple(key[:2])] = at

    def pick(self, kind: str) -> int | slice:
        """Take one state, action or observation, or ``*`` for all of them."""
        index = self.index[kind]
        found: int | slice | None = index.get(self.text)
        if self.text == "*":
            found = slice(None)
        elif self.is_count() and self.count() < len(index):
            found = int(self.text)
        if found is None:
            some = ", ".join(list(index)[:6]) + (", ..." if len(index) > 6 else "")
            self.expected(f"one of the {kind} ({some}) or '*'")
        self.advance()
        return found

    def block(self, letter: str, key: list[Any]) -> Any:
        """Take the value of the entries at `key`: numbers, or a word that stands for them."""
        shape = [self.sizes[kind] for kind in self.axes[letter][len(key) :]]
        word = self.text
        if word == "uniform" and shape and letter != "R":
            self.advance()
            return 1 / shape[-1]
        if (letter, len(key), word) == ("T", 1, "identity"):
            self.advance()
            return np.eye(shape[0])
        if (letter, len(key), word) == ("T", 2, "reset"):
            self.advance()
            return self.belief
        what, low, high = "a probability in [0, 1]", 0.0, 1.0
        if letter == "R":
            low, high = -LARGEST, LARGEST
            what = f"a reward in [{low:g}, {high:g}]"
        return self.numbers(self.affordable(letter, shape), what, low, high)

    def grow(self, key: list[Any]) -> None:
        """Give R the axes of next state and observation, if the entry at `key` needs them."""
        for axis, kind in enumerate(self.axes["R"][2:], 2):
            R = self.table["R"]
            needed = axis >= len(key) or key[axis] != slice(None)
            if needed and R.shape[axis] < self.sizes[kind]:
                wanted = [*R.shape[:axis], self.sizes[kind], *R.shape[axis + 1 :]]
                self.affordable("R", wanted)
                self.table["R"] = np.repeat(R, self.sizes[kind], axis=axis)

    # The model

    def finished(self) -> POMDP:
        T = self.normalized("T", self.table["T"], self.given["T"])
        O = np.eye(len(self.belief))[np.newaxis].repeat(len(T), 0)  # noqa: E741
        if "O" in self.axes:
            O = self.normalized("O", self.table["O"], self.given["O"])  # noqa: E741
        R = self.table["R"]
        if R.ndim == 4:
            R = np.einsum("atz,astz->ast", O, R) if R.shape[3] > 1 else R[..., 0]
        R = np.einsum("ast,ast->as", T, R) if R.shape[2] > 1 else R[..., 0]
        if self.costs:
            R = 0 - R
        try:
            names = {kind: tuple(self.index[kind]) for kind in KINDS}
            return POMDP(T, O, R.T, self.gamma, self.belief, **names)  # type: ignore[arg-type]
        except ValueError as error:
            self.refuse(f"expected a model: {error}", self.at)

    def normalized(self, letter: str, rows: Floats, given: NDArray[np.intp]) -> Floats:
        """Divide rows by their sums; refuse sums too far from 1, at the place of the row."""
        sums = rows.sum(axis=-1)
        if (wrong := np.abs(sums - 1) > ROUNDING).any():
            where = tuple(int(i) for i in np.argwhere(wrong)[0])
            row, at = letter, int(given[where])
            if letter != "start":
                a, s = (
                    list(self.index[kind])[i]
                    for kind, i in zip(("actions", "states"), where, strict=True)
                )
                row = f"{letter}: {a} : {s}"
            if at < 0:
                self.refuse(f"expected the probabilities of '{row}'; they are not given", self.at)
            self.refuse(
                f"expected probabilities that sum to 1; those of '{row}' sum to {sums[where]:.6g}",
                at,
            )
        rough = np.abs(sums - 1) > EXACT
        rows[rough] /= sums[rough, np.newaxis]
        return rows
