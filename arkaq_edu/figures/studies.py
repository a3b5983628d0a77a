"""Pictures of a study: one call for a folder."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

from arkaq_edu import _checks
from arkaq_edu.experiments import read_study
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.plot import Plot

#: What the axis of a quantity says; any other quantity is called by its name.
LABELS = {
    "bonus": "+50 earned (%)",
    "cycles": "footstep cycles of an episode",
    "learning_time": "learning time (cycles)",
    "path": "path walked / straight line",
    "regret": "regret (reward of an episode)",
    "reward": "reward of an episode",
    "states": "states",
    "success": "success (%)",
    "turns": "turns of an episode",
}
_PANEL = (4.2, 3.0)  # inches


def plot_study(
    study: str | os.PathLike[str] | pd.DataFrame,
    ax: Axes | None = None,
    *,
    x: str | None = None,
    quantity: str | None = None,
) -> Plot:
    """Draw what a study found: means over the seeds, with a band of one standard deviation.

    Parameters
    ----------
    study : path or DataFrame
        The folder of a study, also while it runs, or a table of `arkaq_edu.experiments.study`.
    ax : matplotlib.axes.Axes, optional
        Where to draw one quantity; by default on new axes.
    x : str, optional
        The setting that runs across, by default the one with the most values. Each combination of
        the others has a line of its own, or marks if the values are not numbers.
    quantity : str, optional
        What runs upward. By default every quantity has a panel.

    Returns
    -------
    Plot
        ``lines`` and ``bands`` by the other settings; of several panels, by quantity first.

    Raises
    ------
    ValueError
        If there is no such setting or quantity.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> rows = [[rho, seed, "success", 90 + seed] for rho in (0.1, 0.2) for seed in (0, 2)]
    >>> table = pd.DataFrame(rows, columns=["vigilance", "seed", "quantity", "value"])
    >>> plot = plot_study(table, Figure().subplots(), quantity="success")
    >>> plot, plot.lines[""].get_ydata().tolist()
    (success by vigilance, 2 seeds, [91.0, 91.0])
    """
    table = study if isinstance(study, pd.DataFrame) else read_study(Path(study))
    if table.empty:
        raise ValueError("study must have finished cells, got none")
    settings = [*table.columns[: [*table.columns].index("seed")]]
    varying = [name for name in settings if table[name].nunique() > 1]
    usual = max(varying or ["seed"], key=lambda name: table[name].nunique())
    x = _checks.choice("x", usual if x is None else x, [*settings, "seed"])
    names = [*table.quantity.unique()]
    others = [name for name in varying if name != x]
    if quantity is not None:
        return _panel(table, ax, x, _checks.choice("quantity", quantity, names), others)
    if ax is not None:
        raise ValueError("quantity must be given with ax")
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    size = (_PANEL[0] * columns, _PANEL[1] * rows)
    _, axes = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
    panels = {n: _panel(table, a, x, n, others) for n, a in zip(names, axes.flat, strict=False)}
    for spare in axes.flat[len(names) :]:
        spare.remove()
    for legend in [a.get_legend() for a in axes.flat[1 : len(names)] if a.get_legend()]:
        legend.remove()  # all panels have the same lines
    return Plot(
        axes.flat[: len(names)],
        lines={name: panel.lines for name, panel in panels.items()},
        bands={name: panel.bands for name, panel in panels.items()},
    )


def _panel(table: pd.DataFrame, ax: Axes | None, x: str, quantity: str, others: list[str]) -> Plot:
    chosen = table[table.quantity == quantity]
    seeds = chosen.seed.nunique()
    label = LABELS.get(quantity, quantity)
    title = f"{quantity.replace('_', ' ')} by {x}, {seeds} seed{'s' * (seeds != 1)}"
    ax = style.axes(ax, xlabel=x, ylabel=label, title=title)
    numeric = pd.api.types.is_numeric_dtype(chosen[x])
    places = {value: value if numeric else i for i, value in enumerate(chosen[x].unique())}
    groups = chosen.groupby(others, sort=False) if others else [((), chosen)]
    curves: dict[str, tuple[Any, Any, Any]] = {}
    for names, group in groups:
        at = group.groupby(group[x].map(places)).value
        curves[", ".join(map(str, names))] = (at.mean().index, at.mean(), at.std(ddof=0))
    colors = _colors(len(curves))
    if numeric:
        lines, bands = style.bands(ax, curves, colors)
    else:
        lines, bands = _marks(ax, curves, colors)
        ax.set_xticks([*places.values()], [str(name) for name in places])
        ax.margins(x=0.15)
    if len(curves) > 1:
        ax.legend(title=", ".join(others), frameon=False, fontsize="small")
    return Plot(ax, lines=lines, bands=bands)


def _colors(n: int) -> Sequence[str]:
    """Return a color for each of `n` lines: of many, from dark to light."""
    if n == 1:
        return (style.OURS,)
    if n <= len(style.SERIES):
        return style.SERIES
    return [to_hex(plt.get_cmap("viridis")(at)) for at in np.linspace(0.0, 0.95, n)]


def _marks(ax: Axes, curves: dict[str, Any], colors: Sequence[str]) -> tuple[Any, Any]:
    """Draw a mark with a bar of one standard deviation for each value, the curves side by side."""
    lines, bands = {}, {}
    for i, (name, (at, mean, std)) in enumerate(curves.items()):
        aside = 0.12 * (i - (len(curves) - 1) / 2)
        bars = ax.errorbar(
            at + aside, mean, std, fmt="o", color=colors[i], capsize=3, label=name or None
        )
        lines[name], bands[name] = bars[0], bars
    return lines, bands
