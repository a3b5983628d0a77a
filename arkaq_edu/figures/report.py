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

_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>ARKAQ learning: thesis and reproduction</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 72rem; margin: 2rem auto;
       padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .8rem; border-bottom: 1px solid #ddd; text-align: right; }
th:first-child, td:first-child { text-align: left; }
thead th { border-bottom: 2px solid #888; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr)); gap: 2rem; }
figure { margin: 0; } figure img { width: 100%; height: auto; }
figcaption { color: #555; font-size: .9rem; }
</style>
</head>
<body>
<h1>ARKAQ learning: thesis and reproduction</h1>
<p>$summary</p>
<h2>Numbers</h2>
$table
<p>Mean, lowest and highest over the seeds. "Way walked" counts only walks
that reached the ball. A dash means that the thesis prints no such number.</p>
<h2>Figures</h2>
<div class="figures">
$figures
</div>
<p>arkaq_edu $version</p>
</body>
</html>
""")
_FIGURE = Template("""<figure id="figure-$number">
<img alt="Figure $number: $caption" src="data:image/png;base64,$png">
<figcaption>Figure $number. $caption</figcaption>
</figure>""")


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
    folder.mkdir(parents=True, exist_ok=True)
    _replace(folder / "results.csv", results.to_csv(index=False))
    seeds = int(results.seeds.max())
    text = results.copy()
    for name in ("thesis", "mean", "low", "high"):
        text[name] = [_number(value) for value in results[name]]
    page = _PAGE.substitute(
        summary=f"Every quantity was measured with {seeds} seed{'s' if seeds > 1 else ''}; "
        "the figures show the first seed, except 5.40 and 5.41, which show the course's own study.",
        table=text.to_html(index=False, border=0),
        figures="\n".join(_figure(number, draw, options) for number, draw in figures.items()),
        version=__version__,
    )
    _replace(folder / "index.html", page)
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
    caption = _caption(number, draw)
    png = base64.b64encode(buffer.getvalue()).decode()
    return _FIGURE.substitute(number=number, caption=caption, png=png)


def _caption(number: str, draw: Callable[..., object]) -> str:
    """Make a caption of a docstring such as "Draw figure 5.6, the automaton; see `plot`."."""
    line = (draw.__doc__ or "").strip().splitlines()[0]
    said = line.removeprefix(f"Draw figure {number}").lstrip(",: ").split("; see ")[0].rstrip(".")
    return html.escape(f"{said[:1].upper()}{said[1:]}.")


def _replace(path: Path, text: str) -> None:
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)
