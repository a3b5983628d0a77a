"""What every figure returns: its axes, its artists by name, and the fact that it states."""

from __future__ import annotations

import re
import sys
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure


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
        self._figure().set_label(fact)
        describe_pictures()
        vars(self).update(artists)

    def __getattr__(self, name: str) -> Any:
        # Only for the type checker and the message: artists are attributes of the instance.
        raise AttributeError(f"this plot has {', '.join(vars(self))}, and no {name!r}")

    def __repr__(self) -> str:
        """Return the titles of the axes, or the fact where they have none."""
        return _titles(np.ravel(self.ax)) or self.fact

    def _ipython_display_(self) -> None:
        """Leave it to the picture to state the fact, where a notebook shows the picture."""
        shown = "inline" in matplotlib.get_backend() and plt.fignum_exists(
            getattr(self._figure(), "number", -1)
        )
        if not shown:
            print(self)

    def _figure(self) -> Any:
        return np.ravel(self.ax)[0].get_figure(root=True)


def fact_of(figure: Figure) -> str:
    """Return what a figure states: its titles, or the fact that a `Plot` gave it.

    Examples
    --------
    >>> figure = Figure()
    >>> _ = figure.subplots().set_title("The line rises", loc="left")
    >>> fact_of(figure)
    'The line rises'
    """
    label = str(figure.get_label())
    return _titles(figure.axes) or figure.get_suptitle() or label or repr(figure)


def _titles(axes: Any) -> str:
    return plain("; ".join(filter(None, (ax.get_title(loc="left") for ax in axes))))


def plain(text: str) -> str:
    """Return a text without the signs that set its mathematics.

    Examples
    --------
    >>> plain("$x_1$ founds $m_{12}$")
    'x1 founds m12'
    """
    parts = text.split("$")
    parts[1::2] = [re.sub(r"[_{}]", "", part) for part in parts[1::2]]
    return "".join(parts)


def describe_pictures() -> None:
    """In a notebook, let a figure's fact be the text of its picture, and so its alt text.

    The inline backend forgets it when it begins, so this is called for each new figure.
    """
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is not None:
        text = shell.display_formatter.formatters["text/plain"]
        text.for_type(Figure, lambda figure, printer, cycle: printer.text(fact_of(figure)))
