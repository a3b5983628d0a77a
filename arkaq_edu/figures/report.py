"""The page of a reproduction: every number and figure, one HTML file that opens offline."""

from __future__ import annotations

import base64
import inspect
import io
import os
import re
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from string import Template
from typing import Any

import pandas as pd
from joblib import delayed

from arkaq_edu import __version__
from arkaq_edu._files import replacing
from arkaq_edu.experiments.claims import VERDICTS
from arkaq_edu.experiments.runs import run_all

Draw = Callable[..., Any]

#: CSS pixels of an inch of every figure: all texts have one size.
WIDTH, LEAST_WIDTH = 80, 60
_DPI = 144

#: Where the parts of the table begin and end, by chapter or section of the place.
PARTS = (
    ("background", "Background", ("2.",)),
    ("ball", "Walking to the ball", ("4.", "5.1", "5.2", "5.5", "5.9")),
    ("goal", "Scoring a goal", ("5.3", "5.4")),
    ("conclusion", "Conclusion", ("6",)),
)
#: The key of the one figure that the thesis does not have.
SEARCH = "search"
#: The chapters of the figures.
CHAPTERS = {
    "2": "Background", "3": "ARKAQ learning", "4": "Implementation", "5": "Experiments",
    SEARCH: "The search for one recipe",
}  # fmt: skip

#: Figures of the stream of sightings that comes with the course.
_STREAM = {"5.9", "5.10", "5.11", "5.12", "5.13", "5.14", "5.35", "5.36", "5.37"}


def write_report(
    folder: str | os.PathLike[str],
    results: pd.DataFrame,
    figures: Mapping[str, Draw],
    *,
    note: str = "",
    jobs: int = 1,
    progress: bool = False,
    **options: Any,
) -> Path:
    """Write ``index.html``, completely or not at all.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    results : DataFrame
        See `arkaq_edu.experiments.judge`.
    figures : mapping of str to function
        The function that draws each figure, by number. The first line of its docstring and the
        fact that the figure states become the caption.
    note : str
        A warning that stands above everything.
    jobs : int
        Number of processes that draw.
    progress : bool
        Whether to show a progress bar.
    **options
        Passed to every figure that has a parameter of that name, such as ``agent``.

    Returns
    -------
    Path
        The page.

    Examples
    --------
    >>> import tempfile
    >>> from arkaq_edu.experiments import judge
    >>> runs = pd.DataFrame({"quantity": ["centers, vigilance 0.15"], "seed": 0, "value": 150.0})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = write_report(folder, judge(runs), {}).read_text()
    >>> "outside" in page, "://" in page
    (True, False)
    """
    tasks = [delayed(_drawn)(number, draw, options) for number, draw in figures.items()]
    drawn = dict(zip(figures, run_all(tasks, jobs, progress, "figures"), strict=True))
    cards = {
        number: _card(number, draw, drawn[number], results, options)
        for number, draw in figures.items()
    }
    parts = {slug: _part(results, slug) for slug, _, _ in PARTS}
    page = Template(Path(__file__).with_name("report.html").read_text(encoding="utf-8"))
    content = page.substitute(
        note=f'<p class="note">{escape(note)}</p>' if note else "",
        seeds=_seeds(int(results.seeds.max())),
        contents=_contents(parts, figures),
        filters=_filters(results),
        tables="\n".join(_table(slug, title, parts[slug]) for slug, title, _ in PARTS),
        figures="\n".join(_chapter(chapter, cards) for chapter in CHAPTERS),
        version=escape(__version__),
    )
    path = Path(folder) / "index.html"
    with replacing(path) as fresh:
        fresh.write_text(content, encoding="utf-8")
    return path


# The table


def _part(results: pd.DataFrame, slug: str) -> pd.DataFrame:
    number = results.place.str.extract(r"(\d[\d.]*)")[0]
    return results[[_slug_of_part(n) == slug for n in number]]


def _slug_of_part(number: str) -> str:
    """Return the part of a place, by its longest beginning: 5.35 is of 5.3, and 5.5 is not."""
    if re.fullmatch(r"5\.([5-9]|[12]\d|30)", number):
        return "ball"
    fitting = [(len(start), slug) for slug, _, starts in PARTS for start in starts
               if number.startswith(start)]  # fmt: skip
    return max(fitting)[1]


def _table(slug: str, title: str, rows: pd.DataFrame) -> str:
    if rows.empty:
        return ""
    body = "\n".join(_row(row) for row in rows.itertuples())
    heads = ("quantity", "thesis", "here", "95 % of the seeds", "off by", "verdict")
    head = "".join(f'<th scope="col">{text}</th>' for text in heads)
    return (
        f'<h3 id="{slug}">{escape(title)}</h3>\n<table>\n<thead><tr>{head}</tr></thead>\n'
        f"<tbody>\n{body}\n</tbody>\n</table>"
    )


def _row(row: Any) -> str:
    key = anchor(row.quantity)
    measured = row.seeds > 0
    spread = f"{number(row.low)} to {number(row.high)}" if measured else "computed"
    off = "" if pd.isna(row.off_by) else _signed(row.off_by, row.thesis)
    place = escape(row.place)
    figure = re.search(r"figures? ([\d.]+)", row.place)
    if figure:
        place = f'<a href="#figure-{figure[1]}">{place}</a>'
    seeds = f", {_seeds(row.seeds)}" if measured else ""
    cells = (
        ("thesis", escape(row.thesis).replace("-", "\N{MINUS SIGN}") or "\N{EN DASH}"),
        ("here", number(row.mean) if measured else _exact(row.mean)),
        ("95 % of the seeds", f"{spread}<br>{_strip(row)}" if measured else spread),
        ("off by", off or "\N{EN DASH}"),
        ("verdict", _chip(row.verdict)),
    )
    values = "".join(f'<td data-label="{name}">{text}</td>' for name, text in cells)
    return (
        f'<tr id="{key}" data-verdict="{row.verdict}"><th scope="row">'
        f'<a class="self" href="#{key}">{escape(row.quantity)}</a>'
        f'<span class="why">{escape(row.why)} <span class="place">{place}{seeds}</span></span></th>'
        f"{values}</tr>"
    )


def anchor(quantity: str) -> str:
    """Return the name of a row in the page's address.

    Examples
    --------
    >>> anchor("goals (%), near, ARKAQ")
    'goals-near-arkaq'
    """
    return re.sub(r"[^a-z0-9.]+", "-", quantity.lower()).strip("-")


def number(value: float) -> str:
    """Return a number as it is read: whole from a hundred on, else with three digits.

    Examples
    --------
    >>> number(152.4), number(73.92), number(0.000341), number(6.0)
    ('152', '73.9', '0.000341', '6')
    """
    if pd.isna(value):
        return "\N{EN DASH}"
    if abs(value) >= 100 or value == round(value):
        return f"{value:.0f}".replace("-", "\N{MINUS SIGN}")
    return f"{value:#.3g}".replace("-", "\N{MINUS SIGN}")


def _exact(value: float) -> str:
    return f"{value:.4g}".replace("-", "\N{MINUS SIGN}")


def _signed(off: float, printed: str) -> str:
    digits = len(printed.partition(".")[2])
    if round(off, digits) == 0:
        return "0"
    share = "" if float(printed) == 0 else f" ({100 * off / abs(float(printed)):+.0f} %)"
    return (("+" if off > 0 else "") + number(off) + share).replace("-", "\N{MINUS SIGN}")


def _strip(row: Any) -> str:
    """Draw a band, its mean, and hollow what the thesis prints."""
    try:
        printed = float(row.thesis)
    except ValueError:
        printed = 0.0 if "0" in row.thesis else row.mean
    low, high = min(row.low, printed), max(row.high, printed)
    room = (high - low) or 1.0

    def x(value: float) -> float:
        return round(6 + 108 * (value - low) / room, 1)

    thesis = f'<circle class="thesis" cx="{x(printed)}" cy="9" r="4"/>' if row.thesis else ""
    return (
        '<svg class="strip" viewBox="0 0 120 18" aria-hidden="true">'
        f'<line class="band" x1="{x(row.low)}" x2="{x(row.high)}" y1="9" y2="9"/>'
        f'<line class="mean" x1="{x(row.mean)}" x2="{x(row.mean)}" y1="3" y2="15"/>{thesis}</svg>'
    )


def _chip(verdict: str) -> str:
    return f'<span class="chip v{VERDICTS.index(verdict)}">{verdict}</span>'


def _filters(results: pd.DataFrame) -> str:
    counts = results.verdict.value_counts()
    return "\n".join(
        f'<button class="chip v{i}" data-show="{verdict}" aria-pressed="false">'
        f"<b>{counts.get(verdict, 0)}</b> {verdict}</button>"
        for i, verdict in enumerate(VERDICTS)
    )


def _seeds(n: int) -> str:
    return f"{n} seed{'s' * (n != 1)}"


# The figures


def _chapter(chapter: str, cards: Mapping[str, str]) -> str:
    own = [card for number, card in cards.items() if number.split(".")[0] == chapter]
    if not own:
        return ""
    said = ("" if chapter == SEARCH else f"Chapter {chapter}: ") + CHAPTERS[chapter]
    title = f'<h3 id="figures-{chapter}">{said}</h3>'
    return f'{title}\n<div class="figures">\n' + "\n".join(own) + "\n</div>"


def _drawn(number: str, draw: Draw, options: Mapping[str, Any]) -> tuple[bytes, float, str]:
    """Return the picture of a figure, its width in inches, and the fact that it states."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    plot = draw(**_taken(draw, options))
    figure = plt.gcf()
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI, bbox_inches="tight", metadata={"Software": None})
    plt.close("all")
    png = buffer.getvalue()
    return png, int.from_bytes(png[16:20], "big") / _DPI, "" if plot is None else repr(plot)


def _taken(draw: Draw, options: Mapping[str, Any]) -> dict[str, Any]:
    taken = inspect.signature(draw).parameters
    return {name: value for name, value in options.items() if name in taken}


def _card(
    number: str,
    draw: Draw,
    drawn: tuple[bytes, float, str],
    results: pd.DataFrame,
    options: Mapping[str, Any],
) -> str:
    png, inches, fact = drawn
    told = caption(number, draw)
    image = base64.b64encode(png).decode()
    size = f"width:{inches * WIDTH:.0f}px;min-width:{inches * LEAST_WIDTH:.0f}px"
    seen = f"<span>{escape(fact[:1].upper() + fact[1:])}.</span>" if fact else ""
    whose = _whose(number, _taken(draw, options), int(results.seeds.max()))
    return (
        f'<figure id="figure-{number}">\n'
        f'<div class="picture"><img loading="lazy" alt="Figure {number}: {told} {escape(fact)}" '
        f'style="{size}" src="data:image/png;base64,{image}"></div>\n'
        f'<figcaption><a class="self" href="#figure-{number}">Figure {number}</a> {told} {seen} '
        f'<span class="place">{whose}</span>{_differences(number, results)}</figcaption>\n</figure>'
    )


def caption(number: str, draw: Draw) -> str:
    """Return the caption of a figure as HTML, from the first line of its function's docstring.

    Examples
    --------
    >>> from arkaq_edu.figures.gallery import FIGURES
    >>> caption("5.6", FIGURES["5.6"])
    'The automaton of the segmentation.'
    """
    # Such a line is: Draw figure 5.6, the automaton; see `plot`.
    line = (draw.__doc__ or "").strip().splitlines()[0]
    said = line.removeprefix(f"Draw figure {number}").lstrip(",: ").split("; see ")[0].rstrip(".")
    return escape(f"{said[:1].upper()}{said[1:]}.")


def _whose(number: str, taken: Mapping[str, Any], seeds: int) -> str:
    """Say of which seeds a figure is."""
    if "study" in taken:
        return f"Mean of {_seeds(seeds)} and one standard deviation."
    if "agent" in taken or "goal_agent" in taken:
        return "One agent, seed 0."
    if number in _STREAM:
        return "One stream of sightings, seed 0."
    return ""


def _differences(number: str, results: pd.DataFrame) -> str:
    """List what the thesis prints in a figure, with the verdicts."""
    own = results[[number != SEARCH and _shows(place, number) for place in results.place]]
    items = "".join(
        f'<li><a href="#{anchor(row.quantity)}">{escape(row.quantity)}</a>: thesis '
        f"{escape(row.thesis)}, here {_number(row)} {_chip(row.verdict)}</li>"
        for row in own.itertuples()
        if row.thesis
    )
    return f"<ul>{items}</ul>" if items else ""


def _number(row: Any) -> str:
    if row.seeds:
        return f"{number(row.mean)} ({number(row.low)} to {number(row.high)})"
    return _exact(row.mean)


def _shows(place: str, figure: str) -> bool:
    ends = re.fullmatch(r"figures? ([\d.]+)(?:-([\d.]+))?", place)
    if not ends:
        return False
    first, last = (tuple(map(int, end.split("."))) for end in (ends[1], ends[2] or ends[1]))
    return first <= tuple(map(int, figure.split("."))) <= last


def _contents(parts: Mapping[str, pd.DataFrame], figures: Mapping[str, Draw]) -> str:
    links = [
        f'<li><a href="#{slug}">{escape(title)}</a> <small>{len(parts[slug])}</small></li>'
        for slug, title, _ in PARTS
        if len(parts[slug])
    ]
    shown = []
    for chapter, title in CHAPTERS.items():
        own = [number for number in figures if number.split(".")[0] == chapter]
        if own:
            numbered = [number for number in own if number != SEARCH]
            jumps = " ".join(f'<a href="#figure-{number}">{number}</a>' for number in numbered)
            named = escape(title if chapter == SEARCH else f"{chapter} {title}")
            shown.append(
                f'<li><a href="#figures-{chapter}">{named}</a><div class="jumps">{jumps}</div></li>'
            )
    figures_part = f'<p><a href="#figures">Figures</a></p><ul>{"".join(shown)}</ul>'
    return f'<p><a href="#numbers">Numbers</a></p><ul>{"".join(links)}</ul>' + (
        figures_part if shown else ""
    )
