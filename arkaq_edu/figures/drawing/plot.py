"""What every figure returns: its axes, its artists by name, and the fact that it states."""

from __future__ import annotations

from typing import Any

import numpy as np


class Plot:
    """What a figure drew.

    Parameters
    ----------
    ax : matplotlib.axes.Axes or sequence of Axes
        The axes that were drawn on.
    fact : str, default ""
        What the picture states, for axes without a title of their own.
    **artists
        The artists, or the data behind them, by name. Each becomes an attribute.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = Figure().subplots()
    >>> plot = Plot(ax, "one line", line=ax.plot([0, 1])[0])
    >>> plot, plot.line.get_xdata().tolist()
    (one line, [0.0, 1.0])
    >>> _ = ax.set_title("The line rises", loc="left")
    >>> plot
    The line rises
    """

    def __init__(self, ax: Any, fact: str = "", **artists: Any) -> None:
        self.ax = ax
        self.fact = fact
        vars(self).update(artists)

    def __getattr__(self, name: str) -> Any:
        # Only for the type checker and the message: artists are attributes of the instance.
        raise AttributeError(f"this plot has {', '.join(vars(self))}, and no {name!r}")

    def __repr__(self) -> str:
        """Return the titles of the axes, or the fact where they have none."""
        titles = [ax.get_title(loc="left") for ax in np.ravel(self.ax)]
        return "; ".join(filter(None, titles)) or self.fact
