"""Two explorers of adaptive resonance: the surface of reset, and vigilance over eight letters."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from arkaq_edu import art
from arkaq_edu.art import LETTERS, learned_norm, match_norm, reset_cosine
from arkaq_edu.art.reset import COSINES
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Explorer, sized, slider
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text, area, box

#: Norms of r between which the surface changes its shade.
LEVELS = (0.75, 0.8, 0.85, 0.9, 0.95)
#: Where the slider of the letters stops.
VIGILANCES = tuple(round(0.05 * step, 2) for step in range(21))
_TIPS = {
    "c": "How much the learned pattern adds to the match r",
    "d": "The output of the category that is tried",
    "rho": "A match with a smaller norm than this is a reset",
    "letters": "How much of a letter a template must share to hold it",
}
_FAR, _WIDE = 1.5, 1.85  # where the curves end, and the axis, which leaves room for words


def resonance_explorer() -> Explorer:
    """Return sliders of c, d and vigilance above the surface of equation 2.47.

    Returns
    -------
    Explorer
        Its sliders are ``controls["c"]``, ``controls["d"]`` and ``controls["vigilance"]``.

    References
    ----------
    Thesis, section 2.4.3.4, equation 2.47 and figure 2.21.

    Examples
    --------
    >>> explorer = resonance_explorer()
    >>> explorer
    once learned, vigilance 0.95 resets a cosine below 0.76 (c = 0.1, d = 0.9)
    >>> explorer.controls["c"].value = 0.3
    >>> explorer
    c d / (1 - d) is 2.7 and must not exceed 1 (c = 0.3, d = 0.9)
    """
    return Explorer(
        draw_surface,
        c=slider("c", 0.1, 0.05, 0.5, 0.05, tooltip=_TIPS["c"], **sized("")),
        d=slider("d", 0.9, 0.5, 0.95, 0.05, tooltip=_TIPS["d"], **sized("")),
        vigilance=slider("vigilance", 0.95, 0.75, 0.99, 0.01, tooltip=_TIPS["rho"], **sized("")),
    )


def draw_surface(c: float, d: float, vigilance: float) -> Scene:
    """Return the norm of r twice: from above with its line of resets, and as in figure 2.21.

    Parameters
    ----------
    c, d : float in (0, 1)
        As in `arkaq_edu.art.ART2`.
    vigilance : float in (0, 1)
        A smaller norm of r is a reset.

    Returns
    -------
    Scene
    """
    c, d, vigilance = (round(value, 3) for value in (c, d, vigilance))
    end = learned_norm(c, d)
    panels = [_from_above(c, end, vigilance), _curves(c, end, vigilance)]
    return Scene(art.reset_fact(c, d, vigilance), panels)


def _from_above(c: float, end: float, vigilance: float) -> Panel:
    cdz = np.linspace(0.002, _FAR, 150)
    borders = [0 * cdz, *(reset_cosine(level, cdz, c) for level in LEVELS), 0 * cdz + 1]
    bands = [area(cdz, low, high) for low, high in pairwise(borders)]
    limit = reset_cosine(vigilance, cdz, c)
    seen = limit > 0
    seen[:-1] |= seen[1:]  # the line begins on the axis
    layers: list[Layer] = [
        Cells(bands, range(len(bands))[::-1], (0, _FAR, 0, 1)),
        *_end_of_learning(end, (0, 1)),
        Line(cdz[seen], limit[seen], style.OURS, 2.5),
    ]
    for level, border in zip(LEVELS, borders[1:-1], strict=True):
        if border[-1] > 0:
            layers.append(_beside(border[-1], f"norm {level:g}"))
    cosine = float(reset_cosine(vigilance, end, c))
    if end <= 1 and cosine > 0:
        layers.append(Points([end], [cosine], 5.0, style.OURS))
    return _panel("reset below the thick line", "cos(u, z) of node J", (0, 1), layers)


def _curves(c: float, end: float, vigilance: float) -> Panel:
    heights = (0.7, 1.02)
    layers = _end_of_learning(end, heights)
    end = min(end, _FAR)
    for cosine in COSINES:
        for cdz, dashed in ((np.linspace(0, end, 60), False), (np.linspace(end, _FAR, 60), True)):
            layers.append(Line(cdz, match_norm(cosine, cdz, c), dashed=dashed))
        layers.append(_beside(match_norm(cosine, _FAR, c), f"cos {cosine:g}"))
    layers.append(Line([0, _FAR], [vigilance, vigilance], style.OURS, 2.5))
    return _panel("thick: vigilance", "norm of r", heights, layers)


def _panel(words: str, ylabel: str, heights: tuple[float, float], layers: list[Layer]) -> Panel:
    xlabel, ticks = f"norm of c d z of node J; {words}", [0, 0.5, 1, 1.5]
    return Panel(xlabel, ylabel, (0, _WIDE), heights, layers, xticks=ticks)


def _beside(height: Any, words: str) -> Text:
    return Text(1.03 * _FAR, float(height), words)


def _end_of_learning(end: float, ends: tuple[float, float]) -> list[Layer]:
    return [Line([end, end], ends, style.QUIET, 1.0, dashed=True)] if end <= _FAR else []


def letters_explorer() -> Explorer:
    """Return a slider of vigilance above the templates that ART1 makes of eight letters.

    Returns
    -------
    Explorer
        Its slider is ``controls["vigilance"]``, from 0 to 1.

    References
    ----------
    Thesis, sections 2.4 and 2.4.1.

    Examples
    --------
    >>> explorer = letters_explorer()
    >>> explorer.controls["vigilance"].value = 1.0
    >>> explorer
    8 categories of 8 letters at vigilance 1
    """
    counts = {vigilance: art.learn_letters(vigilance).n_clusters_ for vigilance in VIGILANCES}
    vigilance = slider("vigilance", 0.5, 0, 1, 0.05, tooltip=_TIPS["letters"], **sized(""))
    return Explorer(partial(draw_letters, counts), vigilance=vigilance)


def draw_letters(counts: Mapping[float, int], vigilance: float) -> Scene:
    """Return the templates at one vigilance with their letters, and the counts at every vigilance.

    Parameters
    ----------
    counts : mapping of float to int
        Categories by vigilance.
    vigilance : float in [0, 1]
        The value of the slider.

    Returns
    -------
    Scene
    """
    vigilance = round(vigilance, 2)
    network = art.learn_letters(vigilance)
    n = network.n_clusters_
    found = f"{n} categor{'y' if n == 1 else 'ies'}"
    fact = f"{found} of {len(LETTERS)} letters at vigilance {vigilance:g}"
    ours = Line(list(counts), list(counts.values()), style.OURS)
    dot = Points([vigilance], [n], 5.0, style.OURS)
    top = len(LETTERS) + 0.5
    curve = Panel("vigilance (a similarity)", "categories", (0, 1.02), (0, top), [ours, dot])
    return Scene(fact, [_templates(network), curve])


def _templates(network: art.ART1) -> Panel:
    points = np.array([(i % 5, 4 - i // 5) for i in range(25)])
    templates = network.cluster_centers_.astype(int)
    feet = [np.array([7 * (j % 3) + 1, 7.5 * (2 - j // 3) + 2]) for j in range(len(templates))]
    names: list[Layer] = []
    for j, (left, bottom) in enumerate(feet):
        members = [name for name, k in zip(LETTERS, network.labels_, strict=True) if k == j]
        names.append(Text(left, bottom - 0.9, " ".join(members) or "none now"))
    squares = [box(0, 1, 0, 1) + foot + point for foot in feet for point in points]
    view, palette = (0.0, 21.5, 0.0, 22.5), ["#eeeeee", style.INK]
    grids = Cells(squares, templates.ravel().tolist(), view, palette, border=0.8)
    words = "templates, each above its letters"
    return Panel(words, "", view[:2], view[2:], [grids, *names], xticks=[], yticks=[])
