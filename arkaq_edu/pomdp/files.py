"""Cassandra's .POMDP file format: read a model from a file, write one, and the course's own."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._paths import course_folder, write_whole
from arkaq_edu.pomdp.model import POMDP

# What a file may ask for. A table of 2^24 numbers takes 128 MiB of memory.
MOST_BYTES, MOST_NAMES, MOST_ENTRIES = 2**27, 2**16, 2**24

# How far from 1 the sum of a row may be: 0.3333 three times is read as thirds.
ROUNDING = 1.01e-4

_PREAMBLE = ("discount", "values", "states", "actions", "observations")
_RESERVED = {
    *_PREAMBLE, "start", "include", "exclude", "T", "O", "R",
    "uniform", "identity", "reset", "reward", "cost",
}  # fmt: skip
_WORD = re.compile(r"[A-Za-z][\w-]*", re.ASCII)
# Quantifiers are possessive (a second +): however long a run of digits, it is walked once.
_TOKEN = re.compile(
    r"(?P<number>[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?+(?![\w.]))"
    rf"|(?P<word>{_WORD.pattern})|(?P<mark>[:*+-])|(?P<other>[^\s#:]++)|\s++|#[^\n]*+",
    re.ASCII,
)


class PomdpFormatError(ValueError):
    """A .POMDP file that cannot be read: what was expected, and where.

    Attributes
    ----------
    problem : str
        What was expected, and what is there instead.
    path : str
        The file.
    line, column : int
        Where in it, both counted from 1.

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


def read_pomdp(path: Path | str) -> POMDP:
    """Read a POMDP from a file in Cassandra's format.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    POMDP
        Costs (``values: cost``) become rewards below zero. A reward that depends on the next state
        and on the observation becomes the one expected: R(s, a) = sum_t T(a, s, t) sum_z O(a, t, z)
        R(a, s, t, z). A file without observations, an MDP, becomes a POMDP that sees its state.

    Raises
    ------
    PomdpFormatError
        If the file is not as the format has it, a row of probabilities does not sum to 1, or the
        discount is outside [0, 1); with the line and the column, and what was expected there.
    OSError
        If there is no such file, or it may not be read.

    Notes
    -----
    The format: a file begins, in any order, with ``discount: 0.95``, ``values: reward`` (or
    ``cost``), and ``states:``, ``actions:`` and ``observations:``, each followed by names or by a
    count. Then, if not uniform, comes the belief at the start: ``start:`` with one probability per
    state, with ``uniform`` or with one state; ``start include:`` or ``start exclude:`` with states.
    The rest are entries of T(a, s, t), O(a, t, z) and R(a, s, t, z), such as

    =============================  ===========================================================
    ``T: listen : left : left 1``  one entry
    ``T: listen : left``           a row: as many numbers, ``uniform`` or ``reset`` (the start)
    ``T: listen``                  a matrix: its numbers row by row, ``uniform`` or ``identity``
    =============================  ===========================================================

    Likewise ``O`` (with ``uniform`` only) and ``R`` (numbers only; from one entry to a matrix over
    the next state and the observation). States, actions and observations go by name or by number,
    from 0; ``*`` is all of them. What is not given is 0; what is given twice, the later counts. A
    ``#`` begins a comment. Blanks and the ends of lines only separate.

    Rows whose sum is within 1e-4 of 1, as printed decimals leave them, are divided by it. Refused
    because no table for them would fit: a file above 128 MiB, more than 65,536 states, actions or
    observations, and a table of more than 2^24 entries (R grows to four dimensions only where it
    depends on all four).

    A discount of 1 is in the format, but has no finite value over a future without end: it is
    refused. Put one below 1, such as 0.999, in its place.

    References
    ----------
    A. Cassandra, "POMDP file format", pomdp.org; its grammar is that of pomdp-solve.

    Examples
    --------
    >>> from arkaq_edu._paths import data_file
    >>> pomdp = read_pomdp(data_file("pomdp/tiger.pomdp"))
    >>> pomdp
    POMDP(2 states, 3 actions, 2 observations, gamma=0.95)
    >>> pomdp.R
    array([[  -1., -100.,   10.],
           [  -1.,   10., -100.]])
    """
    with open(path, "rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise PomdpFormatError(f"expected at most {MOST_BYTES} bytes", str(path), 1, 1)
    # What is no UTF-8 can stand in comments alone, and nobody reads those here.
    text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    return _Reader(str(path), text).model()


def problem(name: str) -> POMDP:
    """Return one of the course's own POMDPs, read from its file in ``data/pomdp``.

    Parameters
    ----------
    name : str
        The name of the file, without its ending.

    Returns
    -------
    POMDP

    Raises
    ------
    ValueError
        If there is none of that name; the message names those there are.

    Examples
    --------
    >>> problem("corridor").states
    ('first', 'second', 'goal', 'fourth')
    >>> problem("chess")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: name must be one of ball_side, corridor, ..., got 'chess'
    """
    files = {path.stem: path for path in sorted(course_folder().glob("data/pomdp/*.pomdp"))}
    if name not in files:
        raise ValueError(f"name must be one of {', '.join(files)}, got {name!r}")
    return read_pomdp(files[name])


def write_pomdp(pomdp: POMDP, path: Path | str) -> None:
    """Write a POMDP to a file in Cassandra's format; `read_pomdp` gives the same model, to the bit.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    path : path
        The file. It is written whole or not at all.

    Raises
    ------
    ValueError
        If a name is none in this format: letters, digits, ``_`` and ``-``, a letter first, and no
        word of the format's own. Names that are the numbers from 0 are written as a count.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> tiger = problem("tiger")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "again.pomdp"
    ...     write_pomdp(tiger, path)
    ...     again = read_pomdp(path)
    ...     path.read_text().splitlines()[:4]
    ['discount: 0.95', 'values: reward', 'states: tiger-left tiger-right',
     'actions: listen open-left open-right']
    >>> bool((again.T == tiger.T).all())
    True
    """
    lines = [f"discount: {pomdp.gamma!r}", "values: reward"]
    lines += [f"{kind}: {_declared(kind, getattr(pomdp, kind))}" for kind in _PREAMBLE[2:]]
    lines += ["start:", _row(pomdp.start), ""]
    for a in range(pomdp.n_actions):
        lines += [f"T: {a}", *map(_row, pomdp.T[a]), "", f"O: {a}", *map(_row, pomdp.O[a]), ""]
        lines += [f"R: {a} : {s} : * : * {float(r)!r}" for s, r in enumerate(pomdp.R[:, a])]
        lines += [""]
    write_whole("\n".join(lines).encode(), Path(path))


def _declared(kind: str, names: tuple[str, ...]) -> str:
    if names == tuple(map(str, range(len(names)))):
        return str(len(names))
    for name in names:
        if name in _RESERVED or not _WORD.fullmatch(name):
            raise ValueError(f"{kind} must be words that the file format can hold, got {name!r}")
    return " ".join(names)


def _row(values: NDArray[np.float64]) -> str:
    return " ".join(map(repr, values.tolist()))


class _Reader:
    """A recursive reader: one method for one rule of the grammar, one token of look-ahead."""

    def __init__(self, path: str, source: str) -> None:
        self.path, self.source = path, source
        self.tokens = _TOKEN.finditer(source)
        self.gamma, self.sign = math.nan, 0.0
        self.names: dict[str, dict[str, int]] = {}  # of a kind: which name has which number
        self.advance()

    # Tokens

    def advance(self) -> None:
        for match in self.tokens:
            if match.lastgroup:
                self.kind, self.text, self.at = match.lastgroup, match.group(), match.start()
                return
        self.kind, self.text, self.at = "end", "", len(self.source)

    def refuse(self, problem: str, at: int) -> NoReturn:
        line = self.source.count("\n", 0, at) + 1
        raise PomdpFormatError(problem, self.path, line, at - self.source.rfind("\n", 0, at))

    def expected(self, what: str) -> NoReturn:
        got = repr(self.text if len(self.text) <= 40 else self.text[:40] + "...")
        self.refuse(f"expected {what}, got {got if self.text else 'the end of the file'}", self.at)

    def take(self, *words: str) -> str:
        word = self.text
        if word not in words:
            self.expected(" or ".join(map(repr, words)))
        self.advance()
        return word

    def number(self, what: str, low: float, high: float) -> float:
        at, text = self.at, self.text
        if text in ("+", "-"):  # a sign may stand apart
            self.advance()
            text += self.text
        if self.kind != "number" or text[1:2] in ("+", "-"):
            self.expected(what)
        value = float(text)
        if not low <= value <= high:
            self.refuse(f"expected {what}, got {text[:40]}", at)
        self.advance()
        return value

    def numbers(self, shape: list[int], what: str, low: float, high: float) -> NDArray[np.float64]:
        values = np.empty(shape)
        for i in range(values.size):
            values.flat[i] = self.number(what, low, high)
        return values

    # The grammar

    def model(self) -> POMDP:
        while self.kind == "word" and self.text in _PREAMBLE:
            self.declaration()
        sees_state = "observations" not in self.names
        if missing := sorted({*_PREAMBLE[:4]} - self.names.keys(), key=_PREAMBLE.index):
            self.expected(" and ".join(f"'{word}:'" for word in missing))
        self.names.setdefault("observations", self.names["states"])
        self.tables(sees_state)
        if self.text == "start":
            self.start()
        while self.kind != "end":
            self.entry()
        return self.finished()

    def declaration(self) -> None:
        at, word = self.at, self.take(*_PREAMBLE)
        self.take(":")
        if word in self.names:
            self.refuse(f"expected '{word}:' once", at)
        self.names[word] = {}
        if word == "discount":
            self.gamma = self.discount()
        elif word == "values":
            self.sign = -1.0 if self.take("reward", "cost") == "cost" else 1.0
        elif self.is_count():
            n = int(self.text) if len(self.text) < 10 else math.inf
            if not 1 <= n <= MOST_NAMES:
                self.expected(f"a count of {word} from 1 to {MOST_NAMES}")
            self.names[word] = {str(i): i for i in range(int(n))}
            self.advance()
        else:
            self.listed(word, self.names[word])

    def discount(self) -> float:
        at, gamma = self.at, self.number("a discount in [0, 1)", 0, 1)
        if gamma == 1:
            self.refuse(
                "expected a discount below 1, got 1: a future without end has no finite value "
                "then; put one such as 0.999 in its place",
                at,
            )
        return gamma

    def listed(self, word: str, names: dict[str, int]) -> None:
        while self.is_name():
            if self.text in names:
                self.expected(f"different names for the {word}")
            if len(names) == MOST_NAMES:
                self.expected(f"at most {MOST_NAMES} {word}")
            names[self.text] = len(names)
            self.advance()
        if not names:
            self.expected(f"a count of {word} or their names, none of them a word of the format")

    def tables(self, sees_state: bool) -> None:
        self.sizes = {kind: len(self.names[kind]) for kind in _PREAMBLE[2:]}
        self.axes = {
            "T": ("actions", "states", "states"),
            "O": ("actions", "states", "observations"),
            "R": ("actions", "states", "states", "observations"),
        }
        if sees_state:  # an MDP: its rewards know of no observation
            self.axes = {"T": self.axes["T"], "R": self.axes["R"][:3]}
        self.table = {
            letter: np.zeros(self.affordable(letter, [self.sizes[kind] for kind in axes]))
            for letter, axes in self.axes.items()
            if letter != "R"
        }
        # R grows along the next state and the observation where an entry tells these apart.
        shape = [self.sizes["actions"], self.sizes["states"], 1, 1][: len(self.axes["R"])]
        self.table["R"] = np.zeros(self.affordable("R", shape))
        self.given = {letter: np.full(self.table[letter].shape[:2], -1) for letter in self.axes}
        self.belief = np.full(self.sizes["states"], 1 / self.sizes["states"])

    def affordable(self, letter: str, shape: list[int]) -> list[int]:
        if math.prod(shape) > MOST_ENTRIES:
            sizes = " x ".join(map(str, shape))
            self.refuse(
                f"expected a table {letter} of at most {MOST_ENTRIES}, not {sizes}", self.at
            )
        return shape

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
                self.refuse("expected a state that is not excluded", at)
            self.belief = chosen / chosen.sum()
        elif self.text == "uniform":
            self.advance()
        elif self.is_name():
            self.belief = np.zeros(n)
            self.belief[self.pick("states")] = 1
        else:
            self.belief = self.start_numbers(n)

    def start_numbers(self, n: int) -> NDArray[np.float64]:
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
            self.expected(f"a probability of each state ({len(values)} of {n} are there)")
        return self.normalised("start", np.array([values]), np.array([at]))[0]

    def is_count(self) -> bool:
        return self.kind == "number" and self.text.isdigit()

    def is_name(self) -> bool:
        return self.kind == "word" and self.text not in _RESERVED

    def pick(self, kind: str) -> int | slice:
        """Take one state, action or observation, or ``*`` for all of them."""
        names = self.names[kind]
        found: int | slice | None = names.get(self.text)
        if self.text == "*":
            found = slice(None)
        elif self.is_count() and len(self.text) < 10 and int(self.text) < len(names):
            found = int(self.text)
        if found is None:
            some = ", ".join(list(names)[:6]) + (", ..." if len(names) > 6 else "")
            self.expected(f"one of the {kind} ({some}) or '*'")
        self.advance()
        return found

    def entry(self) -> None:
        at = self.at
        if self.kind == "number":
            self.expected("T, O or R: all numbers before this one have their place;")
        letter = self.take(*self.axes)
        self.take(":")
        axes = self.axes[letter]
        key = [self.pick(axes[0])]
        while len(key) < len(axes) and (self.text == ":" or len(key) < len(axes) - 2):
            self.take(":")
            key.append(self.pick(axes[len(key)]))
        block = self.block(letter, key)
        if letter == "R":
            self.grow(key)
        self.table[letter][tuple(key)] = block
        self.given[letter][tuple(key[:2])] = at

    def block(self, letter: str, key: list[Any]) -> Any:
        """Take what the entries at `key` shall be: numbers, or a word for them."""
        shape = [self.sizes[kind] for kind in self.axes[letter][len(key) :]]
        if shape and letter != "R" and self.text == "uniform":
            self.advance()
            return 1 / shape[-1]
        if letter == "T" and self.text == "identity" and len(key) == 1:
            self.advance()
            return np.eye(shape[0])
        if letter == "T" and self.text == "reset" and len(key) == 2:
            self.advance()
            return self.belief
        what, low, high = "a probability in [0, 1]", 0.0, 1.0
        if letter == "R":
            what, low, high = "a finite reward", -np.finfo(float).max, np.finfo(float).max
        return self.numbers(self.affordable(letter, shape), what, low, high)

    def grow(self, key: list[Any]) -> None:
        for axis, kind in enumerate(self.axes["R"][2:], 2):
            R = self.table["R"]
            told_apart = axis >= len(key) or key[axis] != slice(None)
            if told_apart and R.shape[axis] < self.sizes[kind]:
                wanted = [*R.shape[:axis], self.sizes[kind], *R.shape[axis + 1 :]]
                self.affordable("R", wanted)
                self.table["R"] = np.repeat(R, self.sizes[kind], axis=axis)

    # What it says together

    def finished(self) -> POMDP:
        T = self.normalised("T", self.table["T"], self.given["T"])
        O = np.eye(len(self.belief))[np.newaxis].repeat(len(T), 0)  # noqa: E741
        if "O" in self.axes:
            O = self.normalised("O", self.table["O"], self.given["O"])  # noqa: E741
        R = self.table["R"]
        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            if R.ndim == 4:
                R = np.einsum("atz,astz->ast", O, R) if R.shape[3] > 1 else R[..., 0]
            R = np.einsum("ast,ast->as", T, R) if R.shape[2] > 1 else R[..., 0]
        if self.sign < 0:
            R = 0 - R
        try:
            names = {kind: tuple(self.names[kind]) for kind in _PREAMBLE[2:]}
            return POMDP(T, O, R.T, self.gamma, self.belief, **names)  # type: ignore[arg-type]
        except ValueError as error:
            self.refuse(f"expected a model: {error}", self.at)

    def normalised(
        self, letter: str, rows: NDArray[np.float64], given: NDArray[np.intp]
    ) -> NDArray[np.float64]:
        """Refuse rows that do not sum to 1, where they were given; divide those that nearly do."""
        sums = rows.sum(axis=-1)
        if (wrong := np.abs(sums - 1) > ROUNDING).any():
            where = tuple(int(i) for i in np.argwhere(wrong)[0])
            row = letter
            if letter != "start":
                a, s = (
                    list(self.names[kind])[i]
                    for kind, i in zip(self.axes[letter], where, strict=False)
                )
                row = f"{letter}: {a} : {s}"
            at = given[where]
            if at < 0:
                self.refuse(f"expected '{row}' with its probabilities; it is never given", self.at)
            self.refuse(
                f"expected probabilities that sum to 1; those of '{row}' sum to {sums[where]:.6g}",
                at,
            )
        rough = np.abs(sums - 1) > 1e-9  # what a POMDP accepts stays as it is, to the last bit
        rows[rough] /= sums[rough, np.newaxis]
        return rows
