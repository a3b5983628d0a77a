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

from arkaq_edu.figures import (
    arkaq,
    art,
    belief,
    field,
    goal,
    kalman,
    learning,
    mdp,
    policy,
    pomdp,
    segmentation,
    trajectories,
)

_ROOMS = (
    arkaq,
    learning,
    mdp,
    art,
    kalman,
    field,
    segmentation,
    policy,
    trajectories,
    goal,
    belief,
    pomdp,
)


def _number(name: str) -> tuple[int, ...]:
    return tuple(int(part) for part in name.split("_")[1:])


_DRAWN = {
    _number(name): function
    for room in _ROOMS
    for name, function in vars(room).items()
    if name.startswith("figure_")
}

#: The function of every figure there is, in the thesis's order.
FIGURES: dict[str, Callable[..., Any]] = {
    ".".join(map(str, number)): _DRAWN[number] for number in sorted(_DRAWN)
}


def draw(number: str, path: str | os.PathLike[str] | None = None, **options: Any) -> Any:
    """Draw a figure of the thesis by its number.

    Parameters
    ----------
    number : str
        As the thesis counts, for example "5.10".
    path : path, optional
        Where to keep the picture; its ending says in what form (.png, .svg, .pdf). Where it is
        None, the figure is drawn for a notebook.
    **options
        Passed to the figure's function.

    Returns
    -------
    tuple
        What the figure's function returns: the axes it drew on (``ax``), and its artists by name.

    Raises
    ------
    ValueError
        If there is no such figure, or its ending is unknown.

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
    figure.savefig(path, dpi=150, bbox_inches="tight")
    return plot
