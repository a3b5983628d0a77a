"""The scoring explorer: what scores, by distance, spread of the kick, and number of states."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing
from arkaq_edu.envs.score_goal import STARTS
from arkaq_edu.experiments import goal
from arkaq_edu.experiments.goal import aiming, kicks, planning
from arkaq_edu.field import pitch
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Explorer, sized, slider, stops
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

Floats = NDArray[np.float64]

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
    """Return sliders for distance, spread of the kick and vigilance, above what scores.

    The picture does not need the physics. It takes 500 kicks on an open field, draws them together
    or apart, places them before the goal, and finds by value iteration the policy that Q-learning
    would find; see `arkaq_edu.experiments.goal.aiming`. At the default, the physics gives the same
    within a few per cent.

    Parameters
    ----------
    patterns : array_like, shape (n, 1), optional
        Scaled orientations in the order in which they were recorded; by default the recorded
        stream.

    Returns
    -------
    Explorer
        Its ``controls``: distance (mm), spread (of the kick: 1 is that of the real robot, with 0
        every kick is the same) and vigilance.

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
    patterns = goal.patterns(goal.load_sightings()) if patterns is None else patterns
    stream = _checks.array("patterns", patterns, (None, 1))
    wide = sized("8em")
    near = int(STARTS["near"].distance)
    return Explorer(
        partial(draw, stream),
        distance=slider(
            "distance (mm)", near, 1000, 3000, 50,
            tooltip="From the robot to the goal line", **wide,
        ),
        spread=slider(
            "kick's spread", 1.0, 0.0, 2.0, 0.1, readout_format=".1f",
            tooltip="1: as the real robot kicks; 0: every kick is the same", **wide,
        ),
        vigilance=stops(
            "vigilance", VIGILANCES, 0.06,
            tooltip="Half the width of a state: the larger it is, the fewer states", **wide,
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
        Distance of the robot from the goal line (mm).
    spread : float
        Spread of the kick: 1 is that of the real robot.
    vigilance : float
        In (0, 2].

    Returns
    -------
    Scene
    """
    centers = goal.find_centers(vigilance, patterns)
    kicked = kicks.spread_out(kicks.ball_paths(), spread)
    chance = aiming.chance_on_grid(kicked, distance)
    actions = aiming.plan(chance, centers)
    goals = aiming.probabilities(chance, centers, actions)
    states = f"{len(centers)} state{'s' * (len(centers) != 1)} at vigilance {vigilance:g}"
    scores = aiming.score_fact(goals)
    fact = f"{distance:,.0f} mm, spread {spread:.2g}, {states}: {scores}"
    field = _field(kicked, distance, aiming.last_aims(centers, actions, _SHOWN))
    return Scene(fact, [field, _shares(goals | {"at once": chance}, centers, actions)])


def _field(kicked: Floats, distance: float, aims: Floats) -> Panel:
    """Draw the kicks of the policy from above, with the goal at the top."""
    placed = kicks.on_the_field(kicked[: len(aims)], distance, aims)
    scored = kicks.is_goal(placed)
    post, back = pitch.GOAL_WIDTH / 2, _GOAL_DEPTH
    inside = np.clip(placed[scored], (-np.inf, -post), (back, post))
    layers: list[Layer] = [
        Line(_ACROSS, (0.0, 0.0), style.QUIET, 1.0, dashed=True),
        Line.through(placed[~scored, :, ::-1], style.QUIET, 0.5),
        Line.through(inside[..., ::-1], style.OURS, 0.9),
        Line([post, post, -post, -post], [0.0, back, back, 0.0], style.INK, 3.0),
        Points([0.0], [-distance], 6.0),
        Text(-110.0, -distance - 25.0, f"{len(aims)} kicks, {scored.sum()} goals"),
    ]
    return Panel("", "", _ACROSS, _DEPTH, layers, width=0.62, bare=True)


def _shares(goals: dict[str, Floats], centers: Floats, actions: NDArray[np.intp]) -> Panel:
    """Draw the share of goals by the orientation at the start, and the action of each state."""
    low, high = Sensing.goal().low[0], Sensing.goal().high[0]
    ends, window = goal.cells(centers)[1][::-1], (low, high, _FOOT, _TOP)
    states = Cells.strip(ends, actions.tolist(), window, palette=_COLORS, border=1.0)
    layers: list[Layer] = [states]
    for polygon, action in zip(states.polygons, actions, strict=True):
        if np.ptp(polygon[:, 0]) > 0.03:  # enough room for the sign
            x, y = polygon.mean(axis=0)
            layers.append(Text(x, y, _SIGNS[action], _SIGN_COLORS[action], "center"))
    curves = (
        ("the best there is", goals["best"], style.INK, True),
        ("this map's policy", goals["learned"], style.OURS, False),
        ("kick at once", goals["at once"], style.INK, False),
        ("random actions", goals["random"], style.QUIET, True),
    )
    seen = (low <= planning.ORIENTATIONS) & (high >= planning.ORIENTATIONS)
    for i, (name, values, color, dashed) in enumerate(curves):
        left, up = (0.49 if i % 2 == 0 else 0.02), (124.0 if i < 2 else 113.0)
        layers += [
            Line(planning.ORIENTATIONS[seen], 100 * values[seen], color, 2.0, dashed),
            Line([left, left - 0.07], [up, up], color, 2.0, dashed),
            Text(left - 0.09, up, name, color),
        ]
    return Panel(
        "orientation (rad);  ← turn left   → turn right   ● kick",
        "goals (%)", (high, low), (_FOOT, 130.0), layers,
        xticks=[0.4, 0.2, 0.0, -0.2, -0.4], yticks=[0, 20, 40, 60, 80, 100],
    )  # fmt: skip
