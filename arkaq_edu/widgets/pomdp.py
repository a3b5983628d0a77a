"""Two explorers of value functions over beliefs: the line of two states, the bowl of three."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import POMDP_ACTIONS
from arkaq_edu.pomdp import PolicyTree, bowl, problem, solved, upper_surface
from arkaq_edu.pomdp.backup import candidates, n_candidates
from arkaq_edu.pomdp.surface import CENTERED
from arkaq_edu.widgets.explorer import Drag, Explorer, wide
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

Floats = NDArray[np.float64]
Values = NDArray[np.floating]

#: Horizons that the explorers can show.
HORIZONS = range(1, 6)
_FADED = 128  # more lines could not be distinguished
_THIN = 0.01  # a face with a smaller area consists of its border only
_FAINT = "#dcdcdc"


def value_explorer() -> Explorer:
    """Return a horizon and a belief above the value function over two states and its best plan.

    The belief can be dragged along the picture.

    Returns
    -------
    Explorer
        Its controls are ``controls["horizon"]``, 1 to 5 steps to go, and ``controls["belief"]``,
        the probability of s1.

    References
    ----------
    Thesis, sections 2.3.4 to 2.3.6; the problem is that of 2.3.5, finished.

    Examples
    --------
    >>> explorer = value_explorer()
    >>> explorer
    3 steps to go, p(s1) = 0.25: worth 2.974, begin with a2; 7 of 128 plans are needed
    >>> explorer.controls["horizon"].value = 1
    >>> explorer
    1 step to go, p(s1) = 0.25: worth 1.125, begin with a2; 2 of 2 plans are needed
    """
    horizon = ipywidgets.IntSlider(
        3, min=HORIZONS[0], max=HORIZONS[-1], description="steps to go", **wide()
    )
    belief = ipywidgets.FloatSlider(
        0.25, min=0, max=1, step=0.01, description="belief p(s1)", **wide()
    )
    return Explorer(draw_value, horizon=horizon, belief=Drag(belief))


def draw_value(horizon: int, belief: float) -> Scene:
    """Return the value function with a belief on it, and the plan that is best there.

    Parameters
    ----------
    horizon : int
        The number of steps to go.
    belief : float in [0, 1]
        The probability of s1.

    Returns
    -------
    Scene
    """
    pomdp, V = problem("two_state"), solved("two_state", horizon)
    belief = round(belief, 10)
    b = np.array([belief, 1 - belief])
    value, tree = V.value(b), V.tree(V.best(b))
    fact = (
        f"{horizon} step{'' if horizon == 1 else 's'} to go, p(s1) = {belief:.2f}: "
        f"worth {value:.3f}, begin with {pomdp.actions[tree.action]}; "
        f"{len(V)} of {n_candidates(pomdp, V):,} plans are needed"
    )
    return Scene(fact, [_surface(horizon, belief, value), _plan(tree)])


@lru_cache(maxsize=len(HORIZONS))
def _still(horizon: int) -> tuple[list[Layer], tuple[float, float]]:
    """Return what does not depend on the belief: the lines, the surface, the ends of the axis."""
    pomdp, V = problem("two_state"), solved("two_state", horizon)
    layers: list[Layer] = [_lines(candidates(pomdp, V, _FADED), _FAINT, 0.8)]
    colors = [POMDP_ACTIONS[name] for name in pomdp.actions]
    plans, p, value = upper_surface(V.alphas)
    for a, color in enumerate(colors):
        layers.append(_lines(V.alphas[V.actions == a], style.paler(color, 0.4), 1.0))
    for a, color in enumerate(colors):
        own = np.flatnonzero(V.actions[plans] == a)
        layers.append(_pieces(p[own], p[own + 1], value[own], value[own + 1], color, 4.0))
    low, high = -0.12 * value.max(), 1.12 * value.max()
    foot = 0.55 * low
    strips = [
        np.array([[left, low], [right, low], [right, foot], [left, foot]])
        for left, right in pairwise(p)
    ]
    layers.append(Cells(strips, V.actions[plans].tolist(), (0, 1, low, high), colors, border=0))
    for a, (color, x) in enumerate(zip(colors, (0.72, 0.86), strict=True)):
        layers.append(Line([x, x + 0.03], [0.95 * high] * 2, color, 4.0))
        layers.append(Text(x + 0.045, 0.95 * high, pomdp.actions[a], color))
    return layers, (low, high)


def _lines(alphas: Values, color: str, width: float) -> Line:
    ends = np.ones(len(alphas))
    return _pieces(0 * ends, ends, alphas[:, 1], alphas[:, 0], color, width)


def _pieces(
    left: Values, right: Values, low: Values, high: Values, color: str, width: float
) -> Line:
    """Return many separate pieces as one line: where x and y are NaN it is interrupted."""
    gap = np.full(len(left), np.nan)
    x, y = np.column_stack([left, right, gap]), np.column_stack([low, high, gap])
    return Line(x.ravel(), y.ravel(), color, width)


def _surface(horizon: int, p: float, value: float) -> Panel:
    still, (low, high) = _still(horizon)
    layers = [
        *still,
        Line([p, p], [low, value], style.INK, 1.0, dashed=True),
        Points([p], [value], 6.0),
    ]
    return Panel("p(s1): drag the belief", "value", (0, 1), (low, high), layers, width=1.3)


def _plan(tree: PolicyTree) -> Panel:
    """Return a picture of the first three steps of a plan."""
    pomdp = problem("two_state")
    layers: list[Layer] = []
    nodes: dict[int, list[tuple[float, float]]] = {a: [] for a in range(pomdp.n_actions)}

    def grow(plan: PolicyTree, x: float, level: int) -> None:
        y, reach = (3.4, 0.2, -3.0)[level], (3.1, 1.0)
        nodes[plan.action].append((x, y))
        if level == 2 or not plan.branches:
            return
        for z, (branch, side) in enumerate(zip(plan.branches, (-1, 0, 1), strict=True)):
            below, foot = x + side * reach[level], (0.2, -3.0)[level]
            layers.append(Line([x, below], [y, foot], style.QUIET, 1.0))
            if level == 0:
                name = pomdp.observations[z]
                layers.append(Text(0.55 * below + 0.15, 0.45 * y + 0.55 * foot, name, style.QUIET))
            grow(branch, below, level + 1)

    grow(tree, 0.0, 0)
    for a, places in nodes.items():
        if places:
            x, y = np.transpose(places)
            layers.append(Points(x, y, 12.0, POMDP_ACTIONS[pomdp.actions[a]]))
            layers += [Text(*place, pomdp.actions[a], "#ffffff", "center") for place in places]
    if tree.depth > 3:
        more = tree.depth - 3
        text = f"and {more} step{'' if more == 1 else 's'} more"
        layers.append(Text(0.0, -4.3, text, style.QUIET, "center"))
    layers.append(Text(0.0, 4.6, "the best plan here", style.QUIET, "center"))
    return Panel("", "", (-4.8, 4.8), (-4.8, 5.0), layers, bare=True)


def bowl_explorer() -> Explorer:
    """Return the value function over three states: a bowl that can be turned, seen also from above.

    Returns
    -------
    Explorer
        Its controls are ``controls["horizon"]``, 1 to 5 steps to go, and ``controls["view"]``,
        azimuth and elevation in degrees.

    References
    ----------
    Thesis, section 2.3.4 and figure 2.11.

    Examples
    --------
    >>> explorer = bowl_explorer()
    >>> explorer
    2 steps to go: 7 planes, worth 1.80 in the middle, 5.00 at the corners; seen from 46°, 38° up
    """
    horizon = ipywidgets.IntSlider(
        2, min=HORIZONS[0], max=HORIZONS[-1], description="steps to go", **wide()
    )
    azimuth = ipywidgets.FloatSlider(
        46, min=-180, max=180, step=2, description="turn (degrees)", readout_format=".0f", **wide()
    )
    elevation = ipywidgets.FloatSlider(
        38, min=0, max=90, step=2, description="eye (degrees up)", readout_format=".0f", **wide()
    )
    return Explorer(draw_bowl, horizon=horizon, view=Drag(azimuth, elevation, gain=(60, -60)))


def draw_bowl(horizon: int, view: tuple[float, float]) -> Scene:
    """Return the bowl over the triangle of beliefs, and the triangle from above.

    Parameters
    ----------
    horizon : int
        The number of steps to go in the problem "three_places".
    view : tuple of two float
        Azimuth and elevation, in degrees.

    Returns
    -------
    Scene
    """
    pomdp, V = problem("three_places"), solved("three_places", horizon)
    azimuth, elevation = view
    known = V.alphas.max(axis=0).min()
    fact = (
        f"{horizon} step{'' if horizon == 1 else 's'} to go: {len(V)} planes, worth "
        f"{V.value([1 / 3] * 3):.2f} in the middle, {known:.2f} at the corners; "
        f"seen from {azimuth:.0f}°, {elevation:.0f}° up"
    )
    names = [pomdp.actions[a] for a in V.actions]
    seen = bowl(V, azimuth, elevation)
    colors = [POMDP_ACTIONS[names[k]] for k in seen.plans]
    bright = style.shaded(colors, seen.light)
    window = (-1.3, 1.3, -1.4, 1.4)
    layers: list[Layer] = [
        _cells(seen.shadows, [style.paler(color, 0.55) for color in colors], window),
        *(Line(post[:, 0], post[:, 1], style.QUIET, 1.0, dashed=True) for post in seen.corners),
        *_edges(seen.faces, bright),
        _cells(seen.faces, bright, window),
    ]
    for (_, (x, y)), name in zip(seen.corners, pomdp.states, strict=True):
        layers.append(Text(x, y + 0.09, name, style.INK, "center"))
    turned = Panel("", "", window[:2], window[2:], layers, width=1.2, bare=True)

    above = bowl(V, 0, 90)
    own = [POMDP_ACTIONS[names[k]] for k in above.plans]
    flat: list[Layer] = [_cells(above.shadows, own, window)]
    for (x, y), name in zip(1.12 * CENTERED, pomdp.states, strict=True):
        flat.append(Text(x, y, name, style.INK, "center"))
    for i, name in enumerate(pomdp.actions):
        x, y = -0.95 + 1.1 * (i % 2), -0.9 - 0.17 * (i // 2)
        flat += [Points([x], [y], 6.0, POMDP_ACTIONS[name]), Text(x + 0.1, y, name)]
    return Scene(fact, [turned, Panel("", "", window[:2], window[2:], flat, bare=True)])


def _edges(polygons: list[Floats], colors: list[str]) -> list[Layer]:
    """Return the outlines of polygons seen edge-on, whose areas alone would be invisible."""
    edges: list[Layer] = []
    for polygon, color in zip(polygons, colors, strict=True):
        x, y = np.vstack([polygon, polygon[:1]]).T
        if abs(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2 < _THIN:
            edges.append(Line(x, y, color, 3.0))
    return edges


def _cells(
    polygons: list[Floats], colors: list[str], window: tuple[float, float, float, float]
) -> Cells:
    """Return polygons, each in a color of its own, drawn in their order."""
    return Cells(polygons, range(len(polygons)), window, colors, border=0.7)
