"""From the number of a figure in the thesis to the function that draws it.

Examples
--------
>>> FIGURES["5.10"].__name__
'figure_5_10'
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from arkaq_edu import figures
from arkaq_edu._files import replacing
from arkaq_edu.figures.drawing.plot import Plot

_CHAPTERS = (
    figures.learning, figures.mdp, figures.belief, figures.pomdp, figures.kalman, figures.art,
    figures.segmentation, figures.field, figures.arkaq, figures.approach, figures.goal,
)  # fmt: skip
_DRAWN: dict[str, Callable[..., Any]] = figures.approach.TRAJECTORIES | {
    name.removeprefix("figure_").replace("_", "."): function
    for chapter in _CHAPTERS
    for name, function in vars(chapter).items()
    if name.startswith("figure_")
}

#: The function that draws each figure, in the thesis's order.
FIGURES = dict(sorted(_DRAWN.items(), key=lambda item: [int(n) for n in item[0].split(".")]))


def draw(number: str, path: str | os.PathLike[str] | None = None, **options: Any) -> Plot:
    """Draw a figure of the thesis by its number.

    Parameters
    ----------
    number : str
        The number in the thesis, for example "5.10".
    path : path, optional
        A file for the picture; its ending sets the format (.png, .svg, .pdf). By default, the
        figure is drawn for a notebook.
    **options
        Passed to the function of the figure.

    Returns
    -------
    Plot
        The axes (``ax``), and what was drawn, by name.

    Raises
    ------
    ValueError
        If there is no such figure, or no such format.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     draw("5.6", folder + "/segmentation.png")
    segmentation: 5 states and 9 transitions, from the table that the agent runs
    >>> draw("9.9")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: number must be one of ...
    """
    if number not in FIGURES:
        raise ValueError(f"number must be one of {', '.join(FIGURES)}, got {number!r}")
    if path is None:
        return FIGURES[number](**options)
    figure = Figure(layout="constrained")
    plot = FIGURES[number](figure.subplots(), **options)
    with replacing(path) as fresh:
        figure.savefig(fresh, dpi=150, bbox_inches="tight")
    return plot
