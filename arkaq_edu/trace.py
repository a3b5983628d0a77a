"""From a place in the thesis to the code, its tests and its notebook: `arkaq trace 2.47`.

The table is made of what is written anyway. The docstrings and comments of the package name the
places: "eq 2.47", "eq 2.45 to 2.47", "figure 5.16", "section 4.2.2", "errata row 12". A test
belongs to a function if it calls it, or if it names the same place, in its name, its docstring or
by ``@pytest.mark.thesis("eq 2.47")``. A notebook belongs to a place that its text names, or whose
function it calls.

Examples
--------
>>> found = trace("2.47")
>>> found.iloc[0].kind, found.iloc[0]["name"]
('eq', 'match_norm')
>>> places("eqs 2.32 to 2.35 and 2.37, figure 2.21")
[('eq', '2.32'), ('eq', '2.33'), ('eq', '2.34'), ('eq', '2.35'), ('eq', '2.37'), ('figure', '2.21')]
"""

from __future__ import annotations

import ast
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import pandas as pd

from arkaq_edu._paths import course_folder, data_file

PACKAGE = Path(__file__).parent
KINDS = ("eq", "figure", "section", "errata row")

#: What the thesis has: the last number of each of its chapters' equations and figures.
_EQUATIONS = {2: 59, 3: 3, 4: 6, 5: 1}
_FIGURES = {2: 23, 3: 2, 4: 4, 5: 41}
_SECTIONS = (
    "2.1", "2.1.1", "2.1.2", "2.1.3", "2.1.4", "2.2", "2.2.1", "2.2.2", "2.2.3", "2.3", "2.3.1",
    "2.3.2", "2.3.3", "2.3.4", "2.3.5", "2.3.6", "2.4", "2.4.1", "2.4.2", "2.4.3", "2.4.3.1",
    "2.4.3.2", "2.4.3.3", "2.4.3.4", "2.5", "2.5.1", "2.5.2", "4.1", "4.2", "4.2.1", "4.2.2", "4.3",
    "5.1", "5.1.1", "5.1.2", "5.1.2.1", "5.1.2.2", "5.1.3", "5.1.3.1", "5.1.3.2", "5.1.3.3", "5.2",
    "5.2.1", "5.2.2", "5.3", "5.3.1", "5.3.2",
)  # fmt: skip

_WORDS = {
    "eq": "eq", "eqs": "eq", "equation": "eq", "equations": "eq", "figure": "figure",
    "figures": "figure", "section": "section", "sections": "section", "thesis": "section",
    "errata row": "errata row", "errata rows": "errata row",
}  # fmt: skip
_NUMBER = r"\d+(?:\.\d+)*"
_REMARK = r"(?:\s*\([^)\d]*\))?"  # "5.1.2.1 (the vision engine), 5.2"
_MENTION = re.compile(
    rf"\b({'|'.join(sorted(_WORDS, key=len, reverse=True))})[.,:]?[\s_]+"
    rf"({_NUMBER}(?:{_REMARK}(?:\s*(?:,|and|to|-|–|or)\s*)+{_NUMBER})*)",
    re.IGNORECASE,
)


def every_place() -> list[tuple[str, str]]:
    """Return every place that must have a home: equations, figures, sections, rows of the errata.

    Examples
    --------
    >>> every_place()[0], len(every_place())
    (('eq', '2.1'), 227)
    """
    numbered = (("eq", _EQUATIONS), ("figure", _FIGURES))
    numbers = [
        (kind, f"{chapter}.{i}")
        for kind, chapters in numbered
        for chapter, last in chapters.items()
        for i in range(1, last + 1)
    ]
    rows = [("errata row", str(row)) for row in errata().index]
    return numbers + [("section", number) for number in _SECTIONS] + rows


@lru_cache
def errata() -> pd.DataFrame:
    """Return the thesis's misprints and mistakes, one a row, by number.

    Returns
    -------
    DataFrame
        Columns place (where), printed (what the thesis prints), right (what is right), checked
        (how: N by computation, L in the literature, T the thesis contradicts itself, M from what
        is generally known).

    Examples
    --------
    >>> errata().loc[8, "place"]
    'eq 2.11'
    """
    return pd.read_csv(data_file("errata.csv"), index_col="row", keep_default_na=False)


def places(text: str) -> list[tuple[str, str]]:
    """Return the places of the thesis that a text names, as (kind, number).

    Examples
    --------
    >>> places("Thesis 2.3.1, figures 2.6 and 2.7; errata row 11")
    [('section', '2.3.1'), ('figure', '2.6'), ('figure', '2.7'), ('errata row', '11')]
    """
    found: list[tuple[str, str]] = []
    for word, numbers in _MENTION.findall(text):
        kind = _WORDS[word.lower()]
        for part in re.finditer(rf"({_NUMBER})(?:\s*(?:to|-|–)\s*({_NUMBER}))?", numbers):
            found += [(kind, number) for number in _span(part[1], part[2] or part[1])]
    return list(dict.fromkeys(found))


def _span(first: str, last: str) -> list[str]:
    *chapter, low = first.split(".")
    *_, high = last.split(".")
    if first.count(".") != last.count(".") or int(high) - int(low) > 60:
        return [first, last]
    return [".".join([*chapter, str(i)]) for i in range(int(low), int(high) + 1)]


@dataclass
class Home:
    """A function, method, class or module, and the places that it names.

    Attributes
    ----------
    name : str
        As in its file, such as ``KalmanFilter.predict``; for a module, its own name.
    file : str
        Below the package's folder.
    line : int
    places : list of (kind, number)
    lead : list of (kind, number)
        Those in the first paragraph or the references of its docstring.
    beside : dict of (kind, number) to int
        Those in a comment beside its code, and the line.
    """

    name: str
    file: str
    line: int
    places: list[tuple[str, str]]
    lead: list[tuple[str, str]]
    beside: dict[tuple[str, str], int]

    @property
    def room(self) -> str:
        """The subpackage, in which its tests are."""
        return self.file.split("/")[0].removesuffix(".py")


@lru_cache
def homes() -> list[Home]:
    """Return everything in the package that names a place, modules after what they hold.

    Examples
    --------
    >>> sorted({home.name for home in homes() if ("eq", "4.1") in home.lead})
    ['ART2A', 'dot', 'figure_4_1']
    """
    found = [home for path in sorted(PACKAGE.rglob("*.py")) for home in _homes_in(path)]
    return [home for home in found if home.places]


def _homes_in(path: Path) -> Iterator[Home]:
    text, name = path.read_text(encoding="utf-8"), path.relative_to(PACKAGE).as_posix()
    if name in ("trace.py", "cli.py") or name.startswith("exercises/"):
        return
    tree, comments = ast.parse(text), _comments(path)
    for node, full in _definitions(tree, ""):
        lines = range(node.lineno, (node.end_lineno or 0) + 1)
        inside = {i: comments[i] for i in lines if i in comments}
        yield _home(full, name, node.lineno, ast.get_docstring(node) or "", inside)
    if name == "figures/approach.py":  # made from a table
        line = text[: text.index("\nTRAJECTORIES = ") + 1].count("\n") + 1
        yield _home("TRAJECTORIES", name, line, "figures 5.17 to 5.30", {})
    outside = {i: text for i, text in comments.items() if text.startswith("#:")}
    module = name.removesuffix(".py").replace("/", ".")
    yield _home(module, name, 1, ast.get_docstring(tree) or "", outside)


def _home(name: str, file: str, line: int, docstring: str, comments: dict[int, str]) -> Home:
    drawn = _drawn(name)
    own = [("figure", drawn[1].replace("_", "."))] if drawn else []
    head, _, references = docstring.partition("References\n")
    lead = places(head.split("\n\n")[0] + "\n" + references.split("\n\n")[0])
    beside = {place: i for i, text in reversed(comments.items()) for place in places(text)}
    every = [*own, *places(docstring), *beside]
    return Home(name, file, line, list(dict.fromkeys(every)), [*own, *lead], beside)


def _drawn(name: str) -> re.Match[str] | None:
    return re.fullmatch(r"figure_(\d+_\d+)", name)


def _definitions(node: ast.AST, above: str) -> Iterator[tuple[ast.FunctionDef | ast.ClassDef, str]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.ClassDef):
            yield child, above + child.name
            if isinstance(child, ast.ClassDef):
                yield from _definitions(child, f"{above}{child.name}.")


def _comments(path: Path) -> dict[int, str]:
    """Return what follows a # in the lines of a file, by line."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return {i: line[line.index("#") :] for i, line in enumerate(lines, 1) if "#" in line}


@dataclass
class Test:
    """A test: its name, what it calls, and the places that it names."""

    __test__ = False
    where: str
    room: str
    names: set[str]
    places: set[tuple[str, str]]


@lru_cache
def all_tests() -> list[Test]:
    """Return the tests of the repository; none where the package was installed from a wheel."""
    folder = PACKAGE.parent / "tests"
    return [test for path in sorted(folder.rglob("test_*.py")) for test in _tests_in(path, folder)]


def _tests_in(path: Path, folder: Path) -> Iterator[Test]:
    file = path.relative_to(folder)
    text, comments = path.read_text(encoding="utf-8"), _comments(path)
    lines = text.splitlines()
    for node, name in _definitions(ast.parse(text), ""):
        if not isinstance(node, ast.FunctionDef) or not name.startswith("test_"):
            continue
        inside = [comments[i] for i in range(node.lineno, node.end_lineno or 0) if i in comments]
        spoken = re.sub(r"(\d)_(?=\d)", r"\1.", name.removeprefix("test_"))
        spoken = re.sub(r"errata_(\d+)(?:_and_(\d+))?", r"errata rows \1, \2", name) + " " + spoken
        marks = [ast.unparse(mark) for mark in node.decorator_list if "thesis" in ast.unparse(mark)]
        said = [ast.get_docstring(node) or "", spoken.replace("_", " "), *marks, *inside]
        yield Test(
            f"tests/{file.as_posix()}::{name}",
            file.parts[0],
            set(re.findall(r"[A-Za-z_]\w+", "\n".join(lines[node.lineno - 1 : node.end_lineno]))),
            set(places("\n".join(said))),
        )


@lru_cache
def notebooks() -> dict[str, tuple[set[tuple[str, str]], set[str]]]:
    """Return, for each notebook, the places that its text names and the names that it calls."""
    found = {}
    for path in sorted((course_folder() / "notebooks").glob("*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        words = {kind: "" for kind in ("markdown", "code", "raw")}
        for cell in cells:
            words[cell["cell_type"]] += "".join(cell["source"]) + "\n"
        called = set(re.findall(r"[A-Za-z_]\w+", words["code"]))
        drawn = re.findall(r'(?:draw\(|figure_)"?(\d+)[._](\d+)', words["code"])
        named = places("\n".join(words.values())) + [("figure", f"{a}.{b}") for a, b in drawn]
        if "errata" in path.name:  # its rows begin with "**7. " or "**22 to 25. "
            heads = re.findall(r"\*\*(\d+(?: to \d+)?)\. ?", words["markdown"])
            named += places(f"errata rows {', '.join(heads)}")
        found[path.name] = set(named), called
    return found


@lru_cache
def table() -> pd.DataFrame:
    """Return the whole table: every place, and where it lives.

    Returns
    -------
    DataFrame
        One row for each place and home: kind, number, name, file, line (that of the equation, if
        it stands there, else of the definition), tests (a list), notebooks (a list). A place
        without a home in the package has an empty name.

    Examples
    --------
    >>> list(table().columns)
    ['kind', 'number', 'name', 'file', 'line', 'tests', 'notebooks']
    """
    rows = [row for place in every_place() for row in _rows(place)]
    return pd.DataFrame(
        rows, columns=["kind", "number", "name", "file", "line", "tests", "notebooks"]
    )


def _rows(place: tuple[str, str]) -> list[tuple]:
    kind, number = place
    named = [place] + (places(errata().place[int(number)]) if kind == "errata row" else [])
    tested = [test.where for one in named for test in all_tests() if one in test.places]
    read = [name for name, (said, _) in notebooks().items() if place in said]
    own = [home for home in homes() if set(named) & set(home.places)]
    rows = []
    for home in sorted(own, key=lambda home: _rank(home, named)):
        line = min((home.beside[one] for one in named if _stands(home, one)), default=home.line)
        last = home.name.split(".")[-1]
        calling, using = [], []  # where a name means one thing only
        if _named()[home.room, last] == 1:
            calling = _calling().get((home.room, last), [])
        if _named()["", last] == 1:
            using = [name for name, (_, called) in notebooks().items() if last in called]
        rows.append(
            (kind, number, home.name, home.file, line,
             list(dict.fromkeys(tested + calling)), list(dict.fromkeys(read + using)))
        )  # fmt: skip
    return rows or [(kind, number, "", "", 0, tested, read)]


@lru_cache
def _calling() -> dict[tuple[str, str], list[str]]:
    """Return, for each room and name, the room's tests in which the name stands."""
    found: dict[tuple[str, str], list[str]] = {}
    for test in all_tests():
        for name in test.names:
            found.setdefault((test.room, name), []).append(test.where)
    return found


@lru_cache
def _named() -> Counter[tuple[str, str]]:
    """Count the functions and methods of each name, by room and, as room "", in all."""
    full = [
        (path.relative_to(PACKAGE).parts[0], name.split(".")[-1])
        for path in PACKAGE.rglob("*.py")
        for _, name in _definitions(ast.parse(path.read_text(encoding="utf-8")), "")
    ]
    return Counter([*full, *(("", name) for _, name in full)])


#: Where a method lives before it is drawn or played with.
_ROOMS = ("kalman", "art", "mdp", "pomdp", "arkaq", "field", "envs", "experiments", "figures")


def _stands(home: Home, place: tuple[str, str]) -> bool:
    """Return whether an equation stands in the plain code of a method."""
    method = home.room in _ROOMS[:5] and "compiled" not in home.file
    return method and place[0] == "eq" and place in home.beside


def _rank(home: Home, named: list[tuple[str, str]]) -> tuple:
    """Order homes: what draws the figure; where the equation stands; what names it first."""
    drawn = _drawn(home.name)
    draws = named[0][0] == "figure" and (
        home.name == "TRAJECTORIES"
        or bool(drawn and ("figure", drawn[1].replace("_", ".")) == named[0])
    )
    module = home.name == home.file.removesuffix(".py").replace("/", ".")
    room = _ROOMS.index(home.room) if home.room in _ROOMS else len(_ROOMS)
    picture = named[0][0] != "figure" and room >= _ROOMS.index("figures")
    stands = any(_stands(home, place) for place in named)
    first = named[0] in home.places, bool(set(named) & set(home.lead))
    twin = "compiled" in home.file or "kernels" in home.file
    private = home.name.startswith("_") or room >= _ROOMS.index("experiments")
    return (
        not draws, picture, not stands, not first[0], not first[1], module, twin, private,
        len(home.lead), room, home.file, home.line,
    )  # fmt: skip


def trace(place: str) -> pd.DataFrame:
    """Return the rows of `table` for a place.

    Parameters
    ----------
    place : str
        A number, such as "2.47", "5.16" or "4.2.2", or with its kind: "eq 2.47", "figure 5.16",
        "section 4.2.2", "errata row 12".

    Returns
    -------
    DataFrame

    Raises
    ------
    ValueError
        If the thesis has no such place.

    Examples
    --------
    >>> trace("figure 5.16")["name"].iloc[0]
    'figure_5_16'
    >>> trace("9.9")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: place must be an equation, a figure or a section of the thesis ... got '9.9'
    """
    rows, named = table(), places(place)
    if named:
        fits = [pair in named for pair in zip(rows.kind, rows.number, strict=True)]
    else:
        fits = (rows.number == place.strip()) & (rows.kind != "errata row")
    if not any(fits):
        raise ValueError(
            "place must be an equation, a figure or a section of the thesis or an errata row, such "
            f"as 2.47, figure 5.16, 4.2.2 or 'errata row 12', got {place!r}"
        )
    return rows[fits].reset_index(drop=True)


def in_words(found: pd.DataFrame, most: int = 6) -> str:
    """Return rows of the table as text, at most so many tests and homes of each place.

    Examples
    --------
    >>> print(in_words(trace("eq 2.58")).splitlines()[0])
    eq 2.58
    """
    lines: list[str] = []
    for (kind, number), own in found.groupby(["kind", "number"], sort=False):
        lines.append(f"{kind} {number}")
        for row in own[own.name != ""].head(most).itertuples():
            lines.append(f"  arkaq_edu/{row.file}:{row.line}  {row.name}")
        for what in ("tests", "notebooks"):
            names = list(dict.fromkeys(name for names in own[what] for name in names))
            lines += [f"  {'' if what == 'tests' else 'notebooks/'}{name}" for name in names[:most]]
            if len(names) > most:
                lines.append(f"  and {len(names) - most} more {what}")
    return "\n".join(lines)
