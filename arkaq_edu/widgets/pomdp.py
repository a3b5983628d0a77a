"""Two explorers of value functions over beliefs: the line of two states, the bowl of three."""

from __future__ import annotations

from functools import lru_cache

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import POMDP_ACTIONS
from arkaq_edu.pomdp import PolicyTree, bowl, problem, solved, upper_surface
from arkaq_edu.pomdp.backup import candidates, n_candidates
from arkaq_edu.pomdp.surface import CENTERED
from arkaq_edu.widgets.explorer import Drag, Explorer, slider
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

Floats = NDArray[np.float64]
Values = NDArray[np.floating]

#: Horizons that the explorers can show.
HORIZONS = range(1, 6)
_FADED = 128  # more lines could not be distinguished
_THIN = 0.01  # a face with a smaller area consists of its border only
_FAINT = "#dcdcdc"
_WINDOW = (-1.4, 1.3, -1.65, 1.5)  # of the bowl


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
    belief = slider(
        "belief p(s1)",
        0.25,
        0,
        1,
        0.01,
        tooltip="The probability of s1; the picture can be dragged",
    )
    return Explorer(draw_value, horizon=_horizon(3), belief=Drag(belief))


def _horizon(value: int) -> ipywidgets.DOMWidget:
    told = "The horizon: how many actions are left"
    return slider("steps to go", value, HORIZONS[0], HORIZONS[-1], tooltip=told)


def _steps(n: int) -> str:
    return f"{n} step{'s' * (n != 1)}"


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
        f"{_steps(horizon)} to go, p(s1) = {belief:.2f}: "
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
    best = V.actions[plans]
    for a, color in enumerate(colors):
        layers.append(_lines(V.alphas[V.actions == a], style.paler(color, 0.4), 1.0))
    corners = np.column_stack([p, value])
    pieces = np.stack([corners[:-1], corners[1:]], axis=1)
    layers += [Line.through(pieces[best == a], color, 4.0) for a, color in enumerate(colors)]
    low, high = -0.12 * value.max(), 1.12 * value.max()
    window = (0, 1, low, 0.55 * low)
    layers.append(Cells.strip(p, best.tolist(), window, palette=colors, border=0))
    for name, color, x in zip(pomdp.actions, colors, (0.72, 0.86), strict=True):
        layers.append(Line([x, x + 0.03], [0.95 * high] * 2, color, 4.0))
        layers.append(Text(x + 0.045, 0.95 * high, name, color))
    return layers, (low, high)


def _lines(alphas: Values, color: str, width: float) -> Line:
    ends = np.broadcast_to([0.0, 1.0], alphas.shape)
    return Line.through(np.stack([ends, alphas[:, ::-1]], axis=-1), color, width)


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
    pomdp, nodes = problem("two_state"), tree.nodes(3)
    layers: list[Layer] = []
    for seen in nodes:
        if seen:
            (x, y), (below, foot) = _node(seen[:-1]), _node(seen)
            layers.append(Line([x, below], [y, foot], style.QUIET, 1.0))
        if len(seen) == 1:
            name = pomdp.observations[seen[0]]
            layers.append(Text(0.55 * below + 0.15, 0.45 * y + 0.55 * foot, name, style.QUIET))
    for a, name in enumerate(pomdp.actions):
        places = [_node(seen) for seen, action in nodes.items() if action == a]
        if places:
            x, y = np.transpose(places)
            layers.append(Points(x, y, 12.0, POMDP_ACTIONS[name]))
            layers += [Text(*place, name, "#ffffff", "center") for place in places]
    if tree.depth > 3:
        text = f"and {_steps(tree.depth - 3)} more"
        layers.append(Text(0.0, -4.3, text, style.QUIET, "center"))
    layers.append(Text(0.0, 4.6, "the best plan here", style.QUIET, "center"))
    return Panel("", "", (-4.8, 4.8), (-4.8, 5.0), layers, bare=True)


def _node(seen: tuple[int, ...]) -> tuple[float, float]:
    """Return where the node that follows these observations, at most two, is drawn."""
    sides = zip(seen, (3.1, 1.0), strict=False)
    return sum((z - 1) * reach for z, reach in sides), (3.4, 0.2, -3.0)[len(seen)]


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
    azimuth = slider(
        "turn (degrees)", 46, -180, 180, 2.0,
        readout_format=".0f", tooltip="Where you stand; the picture can be dragged",
    )  # fmt: skip
    elevation = slider(
        "eye (degrees up)", 38, 0, 90, 2.0,
        readout_format=".0f", tooltip="How high you stand; the picture can be dragged",
    )  # fmt: skip
    view = Drag(azimuth, elevation, gain=(60, -60))
    return Explorer(draw_bowl, horizon=_horizon(2), view=view)


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
        f"{_steps(horizon)} to go: {len(V)} planes, worth "
        f"{V.value([1 / 3] * 3):.2f} in the middle, {known:.2f} at the corners; "
        f"seen from {azimuth:.0f}°, {elevation:.0f}° up"
    )
    own = [POMDP_ACTIONS[pomdp.actions[a]] for a in V.actions]
    seen, above = bowl(V, azimuth, elevation), bowl(V, 0, 90)
    colors = [own[k] for k in seen.plans]
    bright = style.shaded(colors, seen.light)
    layers: list[Layer] = [
        _cells(seen.shadows, [style.paler(color, 0.7) for color in colors]),
        *(Line(post[:, 0], post[:, 1], style.QUIET, 1.0, dashed=True) for post in seen.corners),
        *_edges(seen.faces, bright),
        _cells(seen.faces, bright),
    ]
    for value, (x, y) in zip(*seen.scale, strict=True):
        layers.append(Line([x - 0.04, x], [y, y], style.QUIET, 1.0))
        layers.append(Text(x - 0.13, y, f"{value:,g}", style.QUIET, "center"))
    if len(seen.scale[0]):
        x, y = seen.scale[1].mean(axis=0)
        layers.append(Text(x - 0.36, y, "value", style.QUIET, "center"))
    for (_, (x, y)), name in zip(seen.corners, pomdp.states, strict=True):
        layers.append(Text(x, y + 0.16, name, style.INK, "center"))
    flat: list[Layer] = [_cells(above.shadows, [own[k] for k in above.plans])]
    for (x, y), name in zip(1.12 * CENTERED, pomdp.states, strict=True):
        flat.append(Text(x, y, name, style.INK, "center"))
    for i, name in enumerate(pomdp.actions):
        x, y = -0.95 + 1.1 * (i % 2), -0.9 - 0.17 * (i // 2)
        flat += [Points([x], [y], 6.0, POMDP_ACTIONS[name]), Text(x + 0.1, y, name)]
    ends = _WINDOW[:2], _WINDOW[2:]
    turned = Panel("", "", *ends, layers, width=1.2, bare=True)
    return Scene(fact, [turned, Panel("", "", *ends, flat, bare=True)])


def _edges(polygons: list[Floats], colors: list[str]) -> list[Layer]:
    """Return the outlines of polygons seen edge-on, whose areas alone would be invisible."""
    edges: list[Layer] = []
    for polygon, color in zip(polygons, colors, strict=True):
        (x, y), (x_next, y_next) = polygon.T, np.roll(polygon, -1, axis=0).T
        if abs(x @ y_next - x_next @ y) / 2 < _THIN:
            edges.append(Line.around(polygon, color, 3.0))
    return edges


def _cells(polygons: list[Floats], colors: list[str]) -> Cells:
    """Return polygons, each in a color of its own, drawn in their order."""
    return Cells(polygons, range(len(polygons)), _WINDOW, colors, border=0.7)
