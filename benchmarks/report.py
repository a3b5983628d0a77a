"""The report: a table of all rows, curves of growth, and on what it was measured."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pyperf
from matplotlib.ticker import LogLocator

from arkaq_edu._files import replacing
from benchmarks.case import Curve, Row

PACKAGES = (
    "numpy", "scipy", "numba", "scikit-learn", "pymunk", "pyperf", "quantecon", "pymdptoolbox",
    "filterpy", "pykalman", "simdkalman", "fast-kalman", "statsmodels", "artlib", "mushroom-rl",
    "pomdp-py",
)  # fmt: skip

PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Speed</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto;
       padding: 0 1rem; color: #222 }}
table {{ border-collapse: collapse; font-size: 14px; width: 100% }}
th, td {{ padding: .25rem .6rem; border-bottom: 1px solid #ddd; text-align: left }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap }}
tr.ours td {{ border-top: 2px solid #888; font-weight: 600 }}
.met {{ color: #0a6b3d }} .missed {{ color: #b00020; font-weight: 600 }}
img {{ max-width: 100% }}
</style>
<h1>Speed</h1>
<p>Time of ours beside other libraries, in turns in one process; medians, with the quartiles in
brackets. The ratio is the median, over the rounds, of the other's time over ours: above 1 we are
faster. "limit" is the same arithmetic in one plain compiled loop, without checks.</p>
<p>{met} of {wanted} wanted figures are met.</p>
<h2>Wanted figures</h2>
{targets}
<h2>All rows</h2>
{rows}
<h2>Growth</h2>
<p>The exponent is the slope of log time over log size.</p>
<img src="growth.svg" alt="Time against size, one panel for each method, with its exponent">
<h2>Measured on</h2>
{machine}
</html>
"""


def machine() -> dict[str, str]:
    """Return what the times depend on."""
    found = pyperf.Run([1.0], collect_metadata=True).get_metadata()
    about = {
        "date": str(found["date"])[:10],
        "processor": f"{found.get('cpu_model_name', platform.processor())}, {os.cpu_count()} cores",
        "load in the last minute": f"{os.getloadavg()[0]:.1f}",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
    }
    for package in PACKAGES:
        try:
            about[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            about[package] = "not installed: left out"
    for program in ("pomdp-solve", "pomdpsol"):
        about[program] = "on the PATH" if shutil.which(program) else "not on the PATH: left out"
    return about


def write(rows: Sequence[Row], curves: Sequence[Curve], folder: Path) -> None:
    """Write report.csv, growth.csv, growth.svg and index.html."""
    folder.mkdir(parents=True, exist_ok=True)
    about = machine()
    table = pd.DataFrame(rows)
    grown = pd.DataFrame([vars(curve) for curve in curves])
    if curves:
        grown = grown.explode(["sizes", "seconds"])
    for name, frame in (
        ("report.csv", table),
        ("growth.csv", grown),
        ("machine.csv", pd.DataFrame(about.items(), columns=["what", "version"])),
    ):
        with replacing(folder / name) as path:
            frame.to_csv(path, index=False, float_format="%.4g")
    draw(curves, folder / "growth.svg")
    targets = [row for row in rows if row.wanted]
    page = PAGE.format(
        met=sum(row.met == "met" for row in targets), wanted=len(targets),
        targets=html(targets), rows=html(rows),
        machine=pd.Series(about).to_frame().to_html(header=False, border=0),
    )  # fmt: skip
    with replacing(folder / "index.html") as path:
        Path(path).write_text(page, encoding="utf-8")


def html(rows: Sequence[Row]) -> str:
    """Return rows as a table."""
    head = "<tr><th>room<th>work<th>who<th>measured<th>ratio<th>wanted<th></tr>"
    lines = [
        f'<tr class="{row.who if row.who == "ours" else ""}"><td>{row.room}<td>{row.work}'
        f'<td>{row.who}<td class="number">{shown(row)}'
        f'<td class="number">{"" if np.isnan(row.ratio) else f"{row.ratio:.3g}"}'
        f'<td>{row.wanted}<td class="{row.met}">{row.met}</tr>'
        for row in rows
    ]
    return f"<table>{head}{''.join(lines)}</table>"


def shown(row: Row) -> str:
    """Return the measured value with its spread, in a fitting unit."""
    if np.isnan(row.value):
        return ""
    scale, unit = 1.0, row.unit
    if unit.startswith("s a "):
        scale, unit = next(
            (scale, prefix + unit)
            for scale, prefix in ((1, ""), (1e3, "m"), (1e6, "µ"), (1e9, "n"))
            if row.value * scale >= 1 or scale == 1e9
        )
    value, low, high = (f"{x * scale:.3g}" for x in (row.value, row.low, row.high))
    return f"{value} {unit}" if row.rounds < 2 else f"{value} [{low}, {high}] {unit}"


def draw(curves: Sequence[Curve], path: Path) -> None:
    """Draw a panel for each curve."""
    if not curves:
        return
    n_columns = 3
    n_rows = -(-len(curves) // n_columns)
    with plt.rc_context({"svg.hashsalt": "benchmarks", "font.size": 9}):
        figure, axes = plt.subplots(
            n_rows, n_columns, figsize=(10, 2.8 * n_rows), layout="constrained", squeeze=False
        )
        for ax in axes.flat[len(curves) :]:
            ax.remove()
        for ax, curve in zip(axes.flat, curves, strict=False):
            ms = [1000 * seconds for seconds in curve.seconds]
            ax.loglog(curve.sizes, ms, "o-", color="#0072b2", markerfacecolor="white")
            ax.set(xlabel=curve.axis, ylabel="ms", ylim=(min(ms) / 3, max(ms) * 3))
            ax.set_xticks(curve.sizes, [f"{size:,}" for size in curve.sizes])
            ax.minorticks_off()
            ax.yaxis.set_major_locator(LogLocator(subs=(1, 3)))
            ax.yaxis.set_major_formatter(lambda ms, _: f"{ms:,.10g}")
            ax.set_title(f"{curve.title}\nexponent {curve.exponent:.2f}", fontsize=9)
            ax.grid(alpha=0.3)
        with replacing(path) as part:
            figure.savefig(part, format="svg", metadata={"Date": None})
        plt.close(figure)
