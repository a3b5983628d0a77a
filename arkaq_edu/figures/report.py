"""The report of a reproduction: one HTML page that opens offline, and a table as CSV."""

from __future__ import annotations

import base64
import html
import inspect
import io
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from string import Template

import pandas as pd

from arkaq_edu import __version__
from arkaq_edu._files import replacing


def write_report(
    folder: str | os.PathLike[str],
    results: pd.DataFrame,
    figures: Mapping[str, Callable[..., object]],
    **options: object,
) -> Path:
    """Write ``results.csv`` and ``index.html``, each completely or not at all.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    results : DataFrame
        Columns quantity, thesis, mean, low, high, seeds; see `arkaq_edu.experiments.results`.
    figures : mapping of str to function
        The function that draws each figure, by number. The first line of its docstring becomes
        the caption.
    **options
        Passed to every figure that has a parameter of that name, such as ``agent``.

    Returns
    -------
    Path
        The page.

    Examples
    --------
    >>> import tempfile
    >>> table = pd.DataFrame([["centers", 137, 150, 147, 153, 20]],
    ...                      columns=["quantity", "thesis", "mean", "low", "high", "seeds"])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = write_report(folder, table, {}).read_text()
    >>> "<td>137</td>" in page, "http" in page
    (True, False)
    """
    folder = Path(folder)
    with replacing(folder / "results.csv") as fresh:
        results.to_csv(fresh, index=False)
    seeds = int(results.seeds.max())
    columns = ("thesis", "mean", "low", "high")
    text = results.assign(**{name: [_number(x) for x in results[name]] for name in columns})
    page = Template(Path(__file__).with_name("report.html").read_text(encoding="utf-8"))
    content = page.substitute(
        seeds=f"{seeds} seed{'s' if seeds > 1 else ''}",
        table=text.to_html(index=False, border=0),
        figures="\n".join(_figure(number, draw, options) for number, draw in figures.items()),
        version=__version__,
    )
    with replacing(folder / "index.html") as fresh:
        fresh.write_text(content, encoding="utf-8")
    return folder / "index.html"


def _number(value: float) -> str:
    """Return a number with at least three digits."""
    if pd.isna(value):
        return "\N{EN DASH}"
    return f"{value:.0f}" if abs(value) >= 100 or value == round(value) else f"{value:#.3g}"


def _figure(number: str, draw: Callable[..., object], options: Mapping[str, object]) -> str:
    import matplotlib.pyplot as plt

    taken = inspect.signature(draw).parameters
    draw(**{name: value for name, value in options.items() if name in taken})
    buffer = io.BytesIO()
    plt.gcf().savefig(buffer, format="png", dpi=110, bbox_inches="tight")
    plt.close("all")
    caption, png = _caption(number, draw), base64.b64encode(buffer.getvalue()).decode()
    return (
        f'<figure id="figure-{number}">\n'
        f'<img alt="Figure {number}: {caption}" src="data:image/png;base64,{png}">\n'
        f"<figcaption>Figure {number}. {caption}</figcaption>\n</figure>"
    )


def _caption(number: str, draw: Callable[..., object]) -> str:
    """Make a caption of a docstring such as "Draw figure 5.6, the automaton; see `plot`."."""
    line = (draw.__doc__ or "").strip().splitlines()[0]
    said = line.removeprefix(f"Draw figure {number}").lstrip(",: ").split("; see ")[0].rstrip(".")
    return html.escape(f"{said[:1].upper()}{said[1:]}.")
