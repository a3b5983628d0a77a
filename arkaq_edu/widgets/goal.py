"""The scoring explorer: how far away, how steady a kick, how fine a map; and what then scores."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import ipywidgets
import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART
from arkaq_edu.envs.score_goal import STARTS
from arkaq_edu.experiments import aiming
from arkaq_edu.experiments.goal import load_orientations
from arkaq_edu.experiments.goal import patterns as recorded_patterns
from arkaq_edu.field import pitch
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Explorer, wide
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: Where the slider of vigilance stops: from many states to a single one.
VIGILANCES = (
    0.02, 0.03, 0.04, 0.05, 0.06, 0.075, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2,
)  # fmt: skip

_SHOWN = 120  # kicks of the fan
_COLORS = [style.ACTIONS[action] for action in ("left", "right", "kick")]
_SIGNS = ("←", "→", "●")
_SIGN_COLORS = ("white", style.INK, style.INK)
# The picture of the field (mm): across, to the left of the goal's middle, and depth behind its line
_ACROSS, _DEPTH = (1250.0, -1250.0), (-3150.0, 420.0)
_GOAL_DEPTH = 300.0
_FOOT, _TOP = -13.0, -3.0  # of the strip of states, in per cent of goals


def scoring_explorer(patterns: ArrayLike | None = None) -> Explorer:
    """Return distance, steadiness of the kick and vigilance on sliders, above what scores.

    The picture does not ask the physics at every stop. It takes 500 kicks up an open field, draws
    them together or apart, lays them before the goal, and lets value iteration find the policy to
    which Q-learning would come; see `arkaq_edu.experiments.aiming`. At the default the physics
    itself gives the same, within a few per cent.

    Parameters
    ----------
    patterns : array_like, shape (n, 1), optional
        Scaled orientations in the order in which they were recorded; the course's recorded stream
        where it is None.

    Returns
    -------
    Explorer
        Its ``controls``: distance (mm), spread (of the kick; 1 is the real robot's, with 0 every
        kick is the same) and vigilance.

    References
    ----------
    Thesis, section 5.3 and figures 5.35 to 5.41.

    Examples
    --------
    >>> explorer = scoring_explorer([[-0.8], [-0.3], [0.0], [0.3], [0.8]])
    >>> explorer.controls["spread"].value = 0.0
    >>> explorer
    1,850 mm, spread 0, 5 states at vigilance 0.06: 100 % score; the best 100 %, random 45 %
    """
    patterns = recorded_patterns(load_orientations()) if patterns is None else patterns
    stream = _checks.array("patterns", patterns, (None, 1))
    look = wide("8em")
    return Explorer(
        partial(draw, stream),
        distance=ipywidgets.IntSlider(
            int(STARTS["near"].distance), min=1000, max=3000, step=50,
            description="distance (mm)", **look,
        ),
        spread=ipywidgets.FloatSlider(
            1.0, min=0.0, max=2.0, step=0.1, readout_format=".1f",
            description="kick's spread", **look,
        ),
        vigilance=ipywidgets.SelectionSlider(
            options=[(f"{stop:g}", stop) for stop in VIGILANCES], value=0.06,
            description="vigilance", **look,
        ),
    )  # fmt: skip


def draw(
    patterns: ArrayLike, distance: float = 1850.0, spread: float = 1.0, vigilance: float = 0.06
) -> Scene:
    """Return the picture for one setting: the kicks on the left, their chances on the right.

    Parameters
    ----------
    patterns : array_like, shape (n, 1)
        Scaled orientations, as recorded.
    distance : float
        Of the robot from the goal line (mm).
    spread : float
        Of the kick; 1 is the real robot's.
    vigilance : float
        In (0, 2].

    Returns
    -------
    Scene
    """
    eta = TrainingSettings.goal().learning_rate
    found = EuclideanART(vigilance, eta).fit(patterns).cluster_centers_
    centers = np.sort(found, axis=0)
    ways = aiming.spread_out(aiming.ball_paths(), spread)
    scores = aiming.chances(ways, distance)
    actions = aiming.plan(scores, centers)
    prospects = aiming.prospects(scores, actions[aiming.category(centers, aiming.GRID)])
    mean, best, random = (f"{100 * share:.0f} %" for share in prospects.over_starts())
    states = f"{len(centers)} state{'s' if len(centers) > 1 else ''} at vigilance {vigilance:g}"
    fact = (
        f"{distance:,.0f} mm, spread {spread:.2g}, {states}: {mean} score; "
        f"the best {best}, random {random}"
    )
    field = _field(ways, distance, aiming.last_aims(centers, actions, _SHOWN))
    return Scene(fact, [field, _shares(scores, prospects, centers, actions)])


def _field(ways: NDArray[np.float64], distance: float, aims: NDArray[np.float64]) -> Panel:
    """Draw the kicks that the policy makes, from above; the goal is at the top."""
    laid = aiming.on_the_field(ways[: len(aims)], distance, aims)
    scored = aiming.is_goal(laid)
    post, back = pitch.GOAL_WIDTH / 2, _GOAL_DEPTH
    layers: list[Layer] = [
        Line(_ACROSS, (0.0, 0.0), style.QUIET, 1.0, dashed=True),
        _fan(laid[~scored], style.QUIET, 0.5),
        _fan(np.clip(laid[scored], (-np.inf, -post), (back, post)), style.OURS, 0.9),
        Line([post, post, -post, -post], [0.0, back, back, 0.0], style.INK, 3.0),
        Points([0.0], [-distance], 6.0),
        Text(-110.0, -distance - 25.0, f"{len(aims)} kicks, {scored.sum()} goals"),
    ]
    return Panel("", "", _ACROSS, _DEPTH, layers, width=0.62, bare=True)


def _fan(laid: NDArray[np.float64], color: str, width: float) -> Line:
    lifted = np.pad(laid, ((0, 0), (0, 1), (0, 0)), constant_values=np.nan).reshape(-1, 2)
    return Line(lifted[:, 1], lifted[:, 0], color, width)


def _shares(
    scores: NDArray[np.float64],
    prospects: aiming.Prospects,
    centers: NDArray[np.float64],
    actions: NDArray[np.intp],
) -> Panel:
    """Draw the share of goals by the orientation at the start, and what the states do."""
    middles = Sensing.goal().unscale(centers).ravel()
    low, high = Sensing.goal().low[0], Sensing.goal().high[0]
    edges = np.concatenate([[low], (middles[1:] + middles[:-1]) / 2, [high]])
    strip = [
        np.array([[left, _FOOT], [right, _FOOT], [right, _TOP], [left, _TOP]])
        for left, right in pairwise(edges)
    ]
    layers: list[Layer] = [
        Cells(strip, actions.tolist(), (low, high, _FOOT, _TOP), _COLORS, border=1.0)
    ]
    for polygon, action in zip(strip, actions, strict=True):
        if np.ptp(polygon[:, 0]) > 0.03:  # else there is no room
            x, y = polygon.mean(axis=0)
            layers.append(Text(x, y, _SIGNS[action], _SIGN_COLORS[action], "center"))
    curves = (
        ("the best there is", prospects.best, style.INK, True),
        ("this map's policy", prospects.learned, style.OURS, False),
        ("kick at once", scores, style.INK, False),
        ("random actions", prospects.random, style.QUIET, True),
    )
    seen = (low <= aiming.GRID) & (high >= aiming.GRID)
    for i, (name, values, color, dashed) in enumerate(curves):
        left, up = (0.49 if i % 2 == 0 else 0.02), (124.0 if i < 2 else 113.0)
        layers += [
            Line(aiming.GRID[seen], 100 * values[seen], color, 2.0, dashed),
            Line([left, left - 0.07], [up, up], color, 2.0, dashed),
            Text(left - 0.09, up, name, color),
        ]
    return Panel(
        "orientation (rad);  ← turn left   → turn right   ● kick",
        "goals (%)", (high, low), (_FOOT, 130.0), layers,
        xticks=[0.4, 0.2, 0.0, -0.2, -0.4], yticks=[0, 20, 40, 60, 80, 100],
    )  # fmt: skip
