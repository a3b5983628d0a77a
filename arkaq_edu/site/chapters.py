"""The notebooks as pages: blank exercises, answers behind a click, pictures as files."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import nbformat

from arkaq_edu._paths import course_folder
from arkaq_edu._student import blank
from arkaq_edu.site.living import LIVING, name_of
from arkaq_edu.site.robots import recording_of

#: The folders of pictures and explorers, as the pages of the site see them.
PICTURES, EXPLORERS = "_static/pictures", "_static/living"


class Chapter(NamedTuple):
    """A page of the course: its file's name, title, and what the first page says about it."""

    name: str
    title: str
    about: str


def masters() -> list[Path]:
    """Return the notebooks of the course in their order.

    Examples
    --------
    >>> masters()[0].name
    '00_start_here.ipynb'
    """
    return sorted((course_folder() / "notebooks").glob("*.ipynb"))


def chapters() -> list[Chapter]:
    """Return every chapter with its title, and with its row of the table on the first page.

    Examples
    --------
    >>> chapters()[5].title
    '5. The Kalman filter'
    """
    first = nbformat.read(masters()[0], as_version=4)
    table = "\n".join(cell.source for cell in first.cells if cell.cell_type == "markdown")
    about = dict(re.findall(r"^\| \[[^]]*\]\((\w+)\.ipynb\) \| ([^|]*?) *\|", table, re.MULTILINE))
    found = []
    for master in masters():
        heading = nbformat.read(master, as_version=4).cells[0].source.splitlines()[0]
        title = heading.removeprefix("# ")
        found.append(Chapter(master.stem, title, about.get(master.stem, "")))
    return found


def write_chapter(master: Path, folder: Path, pictures: Path) -> None:
    """Write a notebook for Sphinx to a folder, and its pictures to another one."""
    notebook = nbformat.read(master, as_version=4)
    count, asked = 0, False
    for cell in notebook.cells:
        if cell.cell_type != "code":
            asked = asked or asks(cell.source)
            continue
        marks = cell.metadata.get("nbgrader", {})
        if marks.get("solution"):
            cell.source = blank(cell.source)
        alive = alive_in(cell.source)
        if asked and cell.outputs and not marks:
            asked = False
            if not alive:
                cell.metadata["tags"] = ["hide-output"]
        for output in cell.outputs:
            data = output.get("data", {})
            if "image/png" in data:
                count += 1
                name = f"{master.stem}-{count}.png"
                (pictures / name).write_bytes(png := base64.b64decode(data["image/png"]))
                words = output.metadata.get("image/png", {}).get("alt", "")
                shown = picture(name, words, png, bool(alive))
                output.data = {"text/html": places(alive, shown) if alive else shown}
    nbformat.write(notebook, folder / master.name)


def asks(text: str) -> bool:
    """Return whether a text asks for a prediction, which the next output answers.

    Examples
    --------
    >>> asks("The ball rolls.\\n\\n**Predict:** where to?"), asks("Predicting is hard.")
    (True, False)
    """
    return re.search(r"^\*\*(Predict|Before you go on)", text, re.MULTILINE) is not None


class Alive(NamedTuple):
    """What comes to life below a cell: the name of its data, and how many robots it shows."""

    name: str
    lanes: int


def alive_in(source: str) -> list[Alive]:
    """Return what comes to life below a cell, by the call that ends it.

    Examples
    --------
    >>> alive_in("from arkaq_edu.widgets import belief_explorer\\n\\nbelief_explorer()")
    [Alive(name='belief_explorer', lanes=1)]
    >>> [alive.name for alive in alive_in("vigilance_robot()")]
    ['vigilance_explorer', 'robot-vigilance']
    >>> alive_in("quick = scoring_explorer()")
    []
    """
    call = source.strip().rpartition("\n")[2]
    above = "vigilance_explorer()" if call == "vigilance_robot()" else call
    names = [name_of(above)] if above in LIVING else []
    names += [recording_of(call)] if recording_of(call) else []
    return [Alive(name, 1 + call.startswith("race(")) for name in names]


def picture(name: str, words: str, png: bytes, still: bool = False) -> str:
    """Return the HTML of a picture; a still of an explorer has two pixels for one of the page."""
    wide, high = (int.from_bytes(png[i : i + 4], "big") // (1 + still) for i in (16, 20))
    return (
        f'<img class="arkaq-picture" alt="{html.escape(words)}" src="../{PICTURES}/{name}" '
        f'width="{wide}" height="{high}" loading="lazy">'
    )


def places(alive: Sequence[Alive], still: str) -> str:
    """Return the HTML of what comes to life; until then the first place shows the still."""
    return "".join(
        f'<div class="arkaq-living" data-explorer="{name}" data-lanes="{lanes}" '
        f'data-src="../{EXPLORERS}/{name}.js">{still * (i == 0)}</div>'
        for i, (name, lanes) in enumerate(alive)
    )
