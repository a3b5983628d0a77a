"""The pages that are tables and pictures: gallery, trace, benchmarks, home."""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import Any

import matplotlib
from joblib import delayed
from matplotlib import pyplot as plt

from arkaq_edu._paths import course_folder
from arkaq_edu.experiments.runs import run_all
from arkaq_edu.figures.gallery import FIGURES
from arkaq_edu.figures.report import CHAPTERS, caption
from arkaq_edu.site.chapters import PICTURES, chapters
from arkaq_edu.site.reference import documented
from arkaq_edu.trace import table

_DPI = 144  # one and a half pixels for each of the page
_MOST = 5  # names in a cell of the table; the command `arkaq trace` has all
_KINDS = {
    "eq": "Equations", "figure": "Figures", "section": "Sections", "errata row": "Errata",
}  # fmt: skip


def write_gallery(page: Path, pictures: Path) -> None:
    """Draw the figures of the thesis, and write the page that shows them."""
    tasks = [delayed(_draw)(number, pictures / f"figure-{number}.png") for number in FIGURES]
    facts = dict(zip(FIGURES, run_all(tasks, -1, True, "figures"), strict=True))
    parts = [
        "# Gallery\n\nEvery figure of the thesis, computed anew. "
        '`arkaq_edu.figures.draw("5.10")` draws one.\n'
    ]
    for chapter, title in CHAPTERS.items():
        own = [number for number in FIGURES if number.split(".")[0] == chapter]
        if own:
            parts.append(f"## {title}\n\n" + "\n".join(_card(n, facts[n]) for n in own))
    page.write_text("\n".join(parts), encoding="utf-8")


def _draw(number: str, file: Path) -> str:
    """Draw a figure into a file, and return the fact that it states."""
    matplotlib.use("agg")
    plot = FIGURES[number]()
    plt.gcf().savefig(file, dpi=_DPI, bbox_inches="tight")
    plt.close("all")
    return "" if plot is None else repr(plot)


def _card(number: str, fact: str) -> str:
    told, seen = caption(number, FIGURES[number]), html.escape(fact[:1].upper() + fact[1:])
    return (
        f"(figure-{number.replace('.', '-')})=\n### Figure {number}\n\n"
        f'<figure class="arkaq-figure"><img loading="lazy" alt="{told} {seen}" '
        f'src="{PICTURES}/figure-{number}.png"><figcaption>{told} {seen}.</figcaption></figure>\n'
    )


def write_trace(page: Path) -> None:
    """Write the table from each place of the thesis to its code, its tests and its chapters."""
    names, titles = documented(), {chapter.name: chapter.title for chapter in chapters()}
    rows = table()
    parts = [
        "# From the thesis to the code\n\nEach equation, figure and section of the thesis, and "
        "each of its misprints, with the code, the tests and the chapters in which it lives. "
        "`arkaq trace 2.47` says the same, and with `--all` it names them all.\n"
    ]
    for kind, title in _KINDS.items():
        parts.append(f"## {title}\n\n| place | code | tests | chapters |\n|---|---|---|---|")
        for number, own in rows[rows.kind == kind].groupby("number", sort=False):
            homes = [_home(row, names) for row in own[own.name != ""].itertuples()]
            tests = [f"`{test.removeprefix('tests/')}`" for test in _all(own.tests)]
            read = [_chapter(name, titles) for name in _all(own.notebooks)]
            place = (
                f"[{number}](#figure-{number.replace('.', '-')})" if kind == "figure" else number
            )
            parts.append(
                f"| {place} | {_some(homes)} | {_some(tests)} | {_some(read, len(read))} |"
            )
        parts.append("")
    page.write_text("\n".join(parts), encoding="utf-8")


def _all(lists: Any) -> list[str]:
    return list(dict.fromkeys(name for names in lists for name in names))


def _home(row: Any, names: dict[tuple[str, str], str]) -> str:
    full = names.get((row.file, row.name))
    if full:
        return f"{{py:obj}}`{row.name} <{full}>`"
    return f"`{row.name}` in `{row.file}`"


def _chapter(file: str, titles: dict[str, str]) -> str:
    stem = file.removesuffix(".ipynb")
    return f"[{titles[stem].split('. ')[0]}](notebooks/{file})"


def _some(words: list[str], most: int = _MOST) -> str:
    more = f", {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def write_benchmarks(page: Path, pictures: Path) -> bool:
    """Write the stored report of the benchmarks as a page; say whether there is one."""
    report = course_folder() / "benchmarks" / "report" / "index.html"
    if not report.exists():
        return False
    text = report.read_text(encoding="utf-8").split("</style>")[-1].replace("</html>", "")
    text = re.sub(r"<h1>.*?</h1>", "", text)
    for drawn in sorted(report.parent.glob("*.svg")):
        (pictures / drawn.name).write_bytes(drawn.read_bytes())
        text = text.replace(f'"{drawn.name}"', f'"{PICTURES}/{drawn.name}"')
    text = re.sub(r"\n\s*\n", "\n", text)  # an empty line would end the HTML in Markdown
    page.write_text(
        f'# Benchmarks\n\n<div class="arkaq-report">\n{text.strip()}\n</div>\n', "utf-8"
    )
    return True


def write_home(page: Path, benchmarks: bool) -> None:
    """Write the first page from site/index.md: the chapters in their order, and the menus."""
    text = (course_folder() / "site" / "index.md").read_text(encoding="utf-8")
    found = chapters()
    cards = "\n".join(
        f'<li><a href="notebooks/{each.name}.html"><b>{html.escape(each.title)}</b>'
        f"<span>{_plain(each.about)}</span></a></li>"
        for each in found
        if each.about
    )
    menu = "\n".join(f"notebooks/{each.name}" for each in found)
    text = text.replace("{{chapters}}", f'<ol class="arkaq-chapters">\n{cards}\n</ol>')
    text = text.replace("{{menu}}", menu)
    text = text.replace("{{benchmarks}}", "benchmarks" if benchmarks else "")
    page.write_text(text, encoding="utf-8")


def _plain(markdown: str) -> str:
    return html.escape(re.sub(r"[*`]", "", markdown))
