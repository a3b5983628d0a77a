"""The plots of the chapter on what the thesis prints wrongly.

Examples
--------
>>> from matplotlib.figure import Figure
>>> plot_count_search(Figure().subplots())
nearest: eta 0.6 and 6,500 patterns, which miss one of the five counts by 14 %
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from arkaq_edu.experiments import counts
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.plot import Plot


def plot_count_search(ax: Axes | None = None, *, found: pd.DataFrame | None = None) -> Plot:
    """Draw by how much each recipe misses the five counts of figures 5.10 to 5.14, at worst.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    found : DataFrame, optional
        See `arkaq_edu.experiments.counts.search`; by default the one that comes with the course.

    Returns
    -------
    Plot
        ``cells`` (one a recipe, darker where it misses more) and ``best``, the mark of the nearest.
    """
    found = counts.load_search() if found is None else found
    table = counts.misses(found)
    eta, patterns, least = counts.nearest(found)
    title = (
        f"nearest: eta {eta:g} and {patterns:,} patterns, which miss one of the five counts by "
        f"{least:.0f} %"
    )
    ax = style.axes(ax, xlabel="patterns of the stream", ylabel="update factor eta", title=title)
    off = table.to_numpy()
    cells = ax.pcolormesh(off, cmap="Purples", vmin=0, vmax=80, edgecolors="white", linewidth=1)
    for (row, column), value in np.ndenumerate(off):
        color = "white" if value > 50 else style.INK
        ax.text(column + 0.5, row + 0.5, f"{value:.0f}", ha="center", va="center", color=color)
    at = table.columns.get_loc(patterns) + 0.5, table.index.get_loc(eta) + 0.5
    (best,) = ax.plot(*at, "o", ms=22, mfc="none", mec=style.ACTIONS["left"], mew=2)
    ax.set_xticks(np.arange(off.shape[1]) + 0.5, [f"{n / 1000:g}k" for n in table.columns])
    ax.set_yticks(np.arange(off.shape[0]) + 0.5, [f"{rate:g}" for rate in table.index])
    return Plot(ax, cells=cells, best=best)
