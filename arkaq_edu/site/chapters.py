"""The notebooks as pages: blank exercises, answers behind a click, pictures as files."""

from __future__ import annotations

import base64
import html
import re
from pathlib import Path
from typing import NamedTuple

import nbformat

from arkaq_edu._paths import course_folder
from arkaq_edu._student import blank
from arkaq_edu.site.living import name_of

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
        alive = explorer_of(cell.source)
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
                output.data = {"text/html": picture(name, words, png, alive)}
    nbformat.write(notebook, folder / master.name)


def asks(text: str) -> bool:
    """Return whether a text asks for a prediction, which the next output answers.

    Examples
    --------
    >>> asks("The ball rolls.\\n\\n**Predict:** where to?"), asks("Predicting is hard.")
    (True, False)
    """
    return re.search(r"^\*\*(Predict|Before you go on)", text, re.MULTILINE) is not None


def explorer_of(source: str) -> str:
    """Return the call that ends a cell, if it makes an explorer; else an empty text.

    Examples
    --------
    >>> explorer_of("from arkaq_edu.widgets import belief_explorer\\n\\nbelief_explorer()")
    'belief_explorer()'
    >>> explorer_of("quick = scoring_explorer()")
    ''
    """
    last = source.strip().splitlines()[-1:]
    return last[0] if last and re.match(r"(\w+_explorer|control_panel)\(", last[0]) else ""


def picture(name: str, words: str, png: bytes, alive: str = "") -> str:
    """Return the HTML of a picture; an explorer's is the place that comes to life."""
    wide, high = (int.from_bytes(png[i : i + 4], "big") for i in (16, 20))
    if alive:  # drawn with two pixels for each of the page
        wide, high = wide // 2, high // 2
    image = (
        f'<img class="arkaq-picture" alt="{html.escape(words)}" src="../{PICTURES}/{name}" '
        f'width="{wide}" height="{high}" loading="lazy">'
    )
    if not alive:
        return image
    name = name_of(alive)
    return (
        f'<div class="arkaq-living" data-explorer="{name}" data-src="../{EXPLORERS}/{name}.js">'
        f"{image}</div>"
    )
