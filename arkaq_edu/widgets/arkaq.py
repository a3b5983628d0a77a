"""The sighting explorer: one look of a recorded walk, from the camera to the action."""

from __future__ import annotations

from functools import partial

import numpy as np

from arkaq_edu.arkaq import Arkaq
from arkaq_edu.experiments import approach
from arkaq_edu.experiments.approach import Stage
from arkaq_edu.experiments.segmentation import DISTANCE, ORIENTATION, map_of
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Explorer, slider
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text, box

_NAMES = tuple(style.ACTIONS)[:3]
_PALE = tuple(style.paler(style.ACTIONS[name], 0.7) for name in _NAMES)
_WINDOW = (*ORIENTATION, *DISTANCE)


def sighting_explorer(number: int = 11, agent: Arkaq | None = None) -> Explorer:
    """Return a slider over the looks of a walk, above what each stage makes of the look.

    Parameters
    ----------
    number : int
        The recorded walk, 1 to 11; see `arkaq_edu.experiments.approach.trajectory`.
    agent : Arkaq, optional
        A trained agent with `cluster_centers_`; by default the one that comes with the course.

    Returns
    -------
    Explorer
        Its slider is ``controls["look"]``.

    References
    ----------
    Thesis, chapter 3, figures 3.1 and 3.2.

    Examples
    --------
    >>> explorer = sighting_explorer(1)
    >>> explorer.controls["look"].value = 2
    >>> str(explorer).startswith("look 2: seen at")
    True
    """
    agent = approach.load_agent() if agent is None else agent
    followed = approach.stages(approach.trajectory(number, agent), agent)
    centers, Q = agent.art.cluster_centers_, agent.q.Q  # type: ignore[union-attr]
    cells = Cells(map_of(centers)[0], Q.argmax(axis=1).tolist(), _WINDOW, palette=_PALE)
    last = len(followed) - 1
    return Explorer(
        partial(draw, followed, cells),
        look=slider("look", last // 2, 0, last, tooltip="Which look of the walk"),
    )


def draw(followed: list[Stage], cells: Cells, look: int) -> Scene:
    """Return the scene of one look: the view on the left, the stages on the right.

    Parameters
    ----------
    followed : list of Stage
        The looks of the walk.
    cells : Cells
        The map of the states.
    look : int
        Which look.

    Returns
    -------
    Scene
    """
    stage = followed[look]
    seen = "not seen" if np.isnan(stage.seen).any() else f"seen at {_place(stage.seen)}"
    fact = f"look {look}: {seen}, believed at {_place(stage.estimate)}: {_NAMES[stage.action]}"
    return Scene(fact, [_view(followed, cells, look), _stages(stage)])


def _place(z: np.ndarray) -> str:
    return f"{z[0]:,.0f} mm, {z[1]:+.3f} rad"


def _view(followed: list[Stage], cells: Cells, look: int) -> Panel:
    stage = followed[look]
    path = np.array([each.estimate for each in followed[: look + 1]])
    angle = np.linspace(0, 2 * np.pi, 41)
    layers: list[Layer] = [
        cells,
        Line.around(cells.polygons[stage.state], style.INK, 2.0),
        Line(path[:, 1], path[:, 0], style.OURS, 1.5),
        Line(
            stage.estimate[1] + 2 * stage.sigma[1] * np.cos(angle),
            stage.estimate[0] + 2 * stage.sigma[0] * np.sin(angle),
            style.OURS, 1.5,
        ),
        Points([stage.estimate[1]], [stage.estimate[0]], 4.5, style.OURS),
    ]  # fmt: skip
    if not np.isnan(stage.seen).any():
        layers.append(Points([stage.seen[1]], [stage.seen[0]], 4.5, hollow=True))
    return Panel(
        "ball to the left  |  to the right (rad)", "distance (mm)",
        style.VIEW_ORIENTATION, style.VIEW_DISTANCE, layers, width=1.1,
    )  # fmt: skip


def _stages(stage: Stage) -> Panel:
    missing = np.isnan(stage.seen).any()
    rows = [
        ("expected", _place(stage.expected)),
        ("sighting", "none" if missing else _place(stage.seen)),
        ("gain", "nothing to correct" if missing else "{:.2f} and {:.2f}".format(*stage.gain)),
        ("estimate", _place(stage.estimate)),
        ("± 1 sigma", "{:.0f} mm, {:.3f} rad".format(*stage.sigma)),
        ("pattern", "{:+.3f}, {:+.3f}".format(*stage.pattern)),
        ("category", f"{stage.state}, center at {_place(stage.center)}"),
    ]
    layers: list[Layer] = []
    for i, (name, words) in enumerate(rows):
        color = style.OURS if name in ("estimate", "± 1 sigma") else style.INK
        layers += [
            Text(0.0, 9.6 - 0.85 * i, name, style.QUIET),
            Text(2.6, 9.6 - 0.85 * i, words, color),
        ]
    longest = max(float(np.abs(stage.values).max()), 1e-9)
    for i, (name, value) in enumerate(zip(_NAMES, stage.values.tolist(), strict=True)):
        y = 3.0 - 1.0 * i
        bar = box(2.6, 2.6 + 4.6 * max(value, 0.0) / longest, y - 0.33, y + 0.33)
        layers += [
            Text(0.0, y, f"Q, {name}", style.QUIET),
            Cells.shape([bar], style.ACTIONS[name], (0, 10, 0, 10)),
            Text(7.4, y, f"{value:.1f}" + ("  chosen" if i == stage.action else "")),
        ]
    return Panel("", "", (0.0, 10.0), (0.0, 10.2), layers, width=1.0, bare=True)
