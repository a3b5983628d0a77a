"""The reader of Cassandra's .POMDP format: the tokens of a file, and the grammar above them."""

from __future__ import annotations

import difflib
import math
import re
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from tqdm import tqdm

from arkaq_edu._checks import LARGEST
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.tables import MOST_DENSE, Reward, Rows, expected_rewards

Floats = NDArray[np.float64]

# What a file may ask for. Lines are short, but each may set a whole table: so what counts is how
# many numbers the entries of a table set in all, which takes some seconds and 256 MiB of memory.
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
# What other dialects write, and what it is here.
DIALECTS = {
    "E": "'O:' for observations, 'T:' for transitions or 'R:' for rewards",
    "costs": "'values: cost'",
    "cost": "'values: cost'",
    "rewards": "'values: reward' before the names, or an entry 'R: action : state : * : * number'",
    "reward": "'values: reward' before the names, or an entry 'R: action : state : * : * number'",
    "gamma": "'discount:'",
    "initial": "'start:'",
    "init": "'start:'",
    "b0": "'start:'",
    "P": "'T:'",
    "Z": "'O:'",
}
# The quantifiers are possessive (a second +), so that a long run of digits is read only once.
_TOKEN = re.compile(
    r"(?P<number>[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?+(?![\w.,]))"
    rf"|(?P<word>{WORD.pattern}+(?![^\s#:*+]))|(?P<mark>[:*+-])|(?P<other>[^\s#:]++)|\s++|#[^\n]*+",
    re.ASCII,
)


# What may stand between a word and the colon after it.
_COLON = re.compile(r"(?:\s|#[^\n]*)*+:")


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

    def before_colon(self) -> bool:
        """Return whether a colon follows the current token."""
        return _COLON.match(self.source, self.at + len(self.text)) is not None

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
            near = difflib.get_close_matches(word, words, 1)
            advice = f" (write {near[0]!r} for {word!r})" if near and self.kind == "word" else ""
            self.expected(" or ".join(map(repr, words)) + advice)
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
            if self.text not in (*PREAMBLE, "start", "T", "O", "R"):
                self.known_key()
            self.expected(" and ".join(f"'{word}:'" for word in missing))
        self.make_tables()
        if self.text == "start":
            self.start()
        with tqdm(
            total=len(self.source), desc=self.path, delay=2, disable=None, leave=False
        ) as bar:
            while self.kind != "end":
                at = self.at
                self.entry()
                bar.update(self.at - at)
        return self.finished()

    # The preamble: the discount, the sign of the rewards, and the names

    def declaration(self) -> None:
        at, word = self.at, self.take(*PREAMBLE)
        self.take(":")
        if word in self.declared:
            self.refuse(f"expected '{word}:' only once", at)
        self.declared.add(word)
        if word == "discount":
            self.gamma = self.number("a discount in [0, 1]", 0, 1)
        elif word == "values":
            self.costs = self.take("reward", "cost") == "cost"
        elif self.is_count():
            if not 1 <= self.count() <= MOST_NAMES:
                self.expected(f"a count of {word} from 1 to {MOST_NAMES}")
            self.index[word] = {str(i): i for i in range(int(self.count()))}
            self.advance()
            if self.kind == "number" or (self.is_name() and not self.before_colon()):
                self.expected(f"a count of {word} or their names, not both")
        else:
            self.index[word] = self.names(word)

    def known_key(self) -> None:
        """Refuse a key that the format does not know; say what to write for it."""
        if self.kind == "word" and self.before_colon():
            near = difflib.get_close_matches(self.text, [*PREAMBLE, "start"], 1)
            meant = f"'{near[0]}:'" if near else None
            write = DIALECTS.get(self.text, meant)
            self.expected(
                "a key of the format (discount, values, states, actions, observations, start, T, "
                f"O, R){f'; write {write} instead' if write else ''}"
            )

    def names(self, kind: str) -> dict[str, int]:
        names: dict[str, int] = {}
        while self.is_name() and not self.before_colon():
            if self.text in names:
                self.expected(f"different names for the {kind}")
            if len(names) == MOST_NAMES:
                self.expected(f"at most {MOST_NAMES} {kind}")
            names[self.text] = len(names)
            self.advance()
        a_key = self.text in RESERVED and (self.before_colon() or self.text == "start")
        if self.kind == "word" and not a_key and not self.before_colon():
            self.expected(
                f"a count of {kind} or their names, none of them a word of the format "
                f"(write another name, such as '{self.text}_')"
            )
        if self.kind in ("number", "other"):
            word = re.sub(r"[^\w-]", "_", self.text[:40], flags=re.ASCII)
            word = word if word[0].isalpha() else f"{kind[0]}{word}"
            self.expected(
                f"names of {kind} made of a letter, then letters, digits, '_' and '-' "
                f"(such as '{word}')"
            )
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
        self.rows = {}
        for letter in self.axes.keys() & {"T", "O"}:
            n_actions, n_states, n = (self.sizes[kind] for kind in self.axes[letter])
            shape = n_actions, n_states, n
            if shape[0] * shape[1] > MOST_ENTRIES:
                self.refuse(
                    f"expected at most {MOST_ENTRIES} rows of {letter}, "
                    f"not {shape[0]} x {shape[1]}",
                    self.at,
                )
            self.rows[letter] = Rows(shape)
        self.rewards: list[Reward] = []
        self.work = dict.fromkeys("TOR", 0)
        self.belief = np.full(self.sizes["states"], 1 / self.sizes["states"])

    def charge(self, letter: str, n: int, at: int) -> None:
        """Count what the entries of a table cost, and refuse what costs too much."""
        self.work[letter] += n
        if self.work[letter] > MOST_ENTRIES:
            self.refuse(
                f"expected entries of {letter} that set at most {MOST_ENTRIES} numbers in all; "
                f"with this one they set {self.work[letter]}",
                at,
            )

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
        elif self.kind == "word":
            self.belief = np.zeros(n)
            self.belief[self.pick("states")] = 1
        else:
            self.belief = self.start_numbers(n)
        if self.kind == "number" or (self.is_name() and not self.before_colon()):
            self.expected(
                "one state or a probability for each state (for several states that are equally "
                "likely write 'start include: a b')"
            )

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
        belief, total = np.array(values), sum(values)
        if abs(total - 1) > ROUNDING:
            self.wrong_sum("start", total, at)
        return belief / total if abs(total - 1) > EXACT else belief

    # The entries of T, O and R

    def entry(self) -> None:
        at = self.at
        if self.kind == "number":
            self.expected("'T', 'O' or 'R' (the entry before is complete)")
        if self.text == "O" and "O" not in self.axes:
            self.expected("no observation probabilities without 'observations:'")
        if self.text not in (*self.axes, *PREAMBLE, "start"):
            self.known_key()
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
            self.rewards.append(Reward(key, block, at))
        else:
            self.charge(letter, self.rows[letter].cost(key, block), at)
            self.rows[letter].set(key, block, at)

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
            return sparse.eye_array(shape[0])
        if (letter, len(key), word) == ("T", 2, "reset"):
            self.advance()
            return self.belief
        what, low, high = "a probability in [0, 1]", 0.0, 1.0 + ROUNDING
        if letter == "R":
            low, high = -LARGEST, LARGEST
            what = f"a reward in [{low:g}, {high:g}]"
        if math.prod(shape) > MOST_ENTRIES:
            sizes = " x ".join(map(str, shape))
            self.refuse(
                f"expected at most {MOST_ENTRIES} numbers in an entry, not {sizes}", self.at
            )
        return self.numbers(shape, what, low, high) if shape else self.number(what, low, high)

    # The model

    def finished(self) -> POMDP:
        T = self.normalized("T")
        n = len(self.belief)
        if "O" in self.axes:
            O = self.normalized("O")  # noqa: E741
        elif n * n * len(T) <= MOST_DENSE:
            O = np.eye(n)[np.newaxis].repeat(len(T), 0)  # noqa: E741
        else:
            O = [sparse.eye_array(n)] * len(T)  # noqa: E741
        R = expected_rewards(T, O, self.rewards, lambda cost, at: self.charge("R", cost, at))
        if self.costs:
            R = 0 - R
        try:
            names = {kind: tuple(self.index[kind]) for kind in KINDS}
            return POMDP(T, O, R, self.gamma, self.belief, **names)  # type: ignore[arg-type]
        except ValueError as error:
            self.refuse(f"expected a model: {error}", self.at)

    def normalized(self, letter: str) -> Any:
        """Return the rows of T or O, divided by their sums where rounding left them off 1."""
        table = self.rows[letter].table()
        for a, rows in enumerate(table):
            sums = rows.sum(axis=1)
            if (np.abs(sums - 1) > ROUNDING).any():
                s = int(np.argmax(np.abs(sums - 1) > ROUNDING))
                row = (
                    f"{letter}: {list(self.index['actions'])[a]} : {list(self.index['states'])[s]}"
                )
                at = self.rows[letter].place(a, s)
                if at is None:
                    self.refuse(
                        f"expected the probabilities of '{row}'; they are not given", self.at
                    )
                self.wrong_sum(row, sums[s], at)
            factor = np.where(np.abs(sums - 1) > EXACT, sums, 1)
            if isinstance(rows, np.ndarray):
                rows /= factor[:, np.newaxis]
            else:
                rows.data /= np.repeat(factor, np.diff(rows.indptr))
        return table

    def wrong_sum(self, row: str, total: float, at: int) -> NoReturn:
        self.refuse(
            f"expected probabilities that sum to 1; those of '{row}' sum to {total:.6g}", at
        )
