"""The control panel of chapter 8: footsteps, head and paw by hand, with the robot's view and ours.

References
----------
Thesis, section 5.1.1 and figure 5.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import ipywidgets
import traitlets
from scipy.ndimage import uniform_filter1d

from arkaq_edu.field import motion
from arkaq_edu.field.camera import FOCAL_LENGTH, HEIGHT, WIDTH
from arkaq_edu.field.drive import BUTTONS, Drive, Look, Press
from arkaq_edu.field.pitch import BALL_RADIUS
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Buttons, Explorer, sized, slider
from arkaq_edu.widgets.scene import Layer, Line, Panel, Picture, Points, Scene, Text

MAX_STRIDE = 190  # mm: the end of the sliders
EXPOSURE = 1 / 30  # s: how long a picture gathers light

_AHEAD = 5  # cycles that the dashed line shows
_GAZE = 700.0  # mm; the length of the line that shows it
_BLUE = "#1b4f8f"
_FAR = 3000.0  # mm: any distance does, because the goal's middle is shown at the camera's height


class Presses(Buttons):
    """Buttons that also remember the values of the sliders at each press.

    Parameters
    ----------
    sliders : sequence of ipywidgets widget
        For the left stride, the right stride and the head.

    Attributes
    ----------
    value : tuple of Press
        The presses so far. Setting it does the same as pressing.

    Examples
    --------
    >>> presses = Presses([ipywidgets.IntSlider(value, max=190) for value in (90, 110, 0)])
    >>> presses.press("step")
    >>> presses.value
    (Press(name='step', left=90, right=110, head=0),)
    """

    def __init__(self, sliders: Sequence[ipywidgets.DOMWidget]) -> None:
        self._sliders = tuple(sliders)
        super().__init__(BUTTONS)

    @traitlets.validate("value")
    def _known(self, proposal: Any) -> tuple[Any, ...]:
        # The link to a setting holds each press as a plain list.
        return tuple(Press(*press) for press in super()._known(proposal))

    def record(self, name: str) -> Press:
        """Return the press of a button, with the sliders as they are now."""
        return Press(name, *(slider.value for slider in self._sliders))


def draw(drive: Drive, left: float, right: float, head: float, presses: Sequence[Press]) -> Scene:
    """Return the scene: the camera's picture, and the field from above beside it.

    Parameters
    ----------
    drive : Drive
        The world that the presses drive.
    left, right : float
        The strides of the next step (mm).
    head : float
        Where the head will point (rad, to the left).
    presses : sequence of Press
        The presses so far.
    """
    drive.follow(presses)
    look = drive.look(head)
    sights = drive.describe(look)
    ahead, turn = motion.gait(left, right)
    # After a kick there is no room for the next step; the dashed line shows it anyway.
    last = sights if drive.message else f"next {ahead:+.0f} mm, {turn:+.2f} rad"
    fact = _minus(f"{drive.message or sights}; {last}")
    return Scene(fact, [_eye(drive, look), _field(drive, look, left, right, head)])


def _eye(drive: Drive, look: Look) -> Panel:
    """Return the camera's picture, with marks where ball and goal were measured."""
    camera, world = drive.camera, drive.world
    picture, title = drive.picture, "what the camera sees"
    if look.moving:
        # While a picture gathers light, the head turns by this many pixels.
        smear = round(world.head.speed * FOCAL_LENGTH * EXPOSURE)
        picture, title = uniform_filter1d(picture, smear, axis=1), "the head moves"
    marks: list[Layer] = []
    names = []
    if look.ball:
        col, row = camera.pixel(world, *look.ball, BALL_RADIUS)
        marks.append(Points([col], [HEIGHT - row], 9.0, hollow=True))
        names.append("ring: the ball")
    if look.goal:
        col, row = camera.pixel(world, _FAR, look.goal.orientation, camera.height)
        if 0 <= col <= WIDTH:  # the middle of a goal that is mostly cut off is out of view
            marks.append(Line([col, col], [HEIGHT - row - 9, HEIGHT - row + 9], _BLUE, 2.5))
            names.append("bar: the goal's middle")
    if names:
        marks.append(Text(0, -9, ", ".join([*names, "as measured"]), style.QUIET))
    pixels = Picture(picture, (0, WIDTH, 0, HEIGHT), smooth=False)
    layers: list[Layer] = [pixels, Text(0, HEIGHT + 9, title), *marks]
    return Panel("", "", (0.0, WIDTH + 8.0), (-18.0, HEIGHT + 18.0), layers, bare=True)


def _field(drive: Drive, look: Look, left: float, right: float, head: float) -> Panel:
    """Return the field from above: the next steps, where to look next, and the ball as seen."""
    x, y, heading = drive.world.pose
    path = motion.arc_path(drive.world.pose, left, right, _AHEAD)
    gaze = _GAZE * math.cos(heading + head), _GAZE * math.sin(heading + head)
    words = f"x {x:,.0f} mm, y {y:,.0f} mm, heading {heading:+.2f} rad, {drive.world.time:.1f} s"
    legend = f"from above; dashed: {_AHEAD} such steps without a drift; thin: the next look"
    layers: list[Layer] = [
        Picture(drive.above, EXTENT),
        Line(path[:, 0], path[:, 1], "white", 2.0, dashed=True),
        Points(path[-1:, 0], path[-1:, 1], 3.5, "white"),
        Text(-3000, 2170, legend),
        Text(-3000, -2170, _minus(words), style.QUIET),
        Line([-2880, -2880, -2480], [-1480, -1880, -1880], "white"),
        Text(-2420, -1880, "x", "white"),
        Text(-2880, -1390, "y", "white", "center"),
    ]
    if look.ball:
        distance, angle = look.ball.distance, heading + look.ball.orientation
        seen = x + distance * math.cos(angle), y + distance * math.sin(angle)
        layers.append(Points([seen[0]], [seen[1]], 9.0, hollow=True))
    layers.append(Line([x, x + gaze[0]], [y, y + gaze[1]], "white", 1.0))
    return Panel("", "", EXTENT[:2], (-2340.0, 2340.0), layers, width=1.5, bare=True)


def control_panel(seed: int = 0) -> Explorer:
    """Return sliders for both strides and the head, and buttons, above what the robot sees.

    The dashed line is the path of five such steps on legs without a drift. A hollow ring marks
    where the camera measured the ball, in its picture and on the field; a blue bar marks the
    middle of the goal. While the head moves there is neither.

    Parameters
    ----------
    seed : int
        Seed of all randomness: footsteps and kicks.

    Returns
    -------
    Explorer
        Its controls are ``controls["left"]`` and ``controls["right"]`` (mm), ``controls["head"]``
        (rad), and the buttons ``controls["presses"]``.

    References
    ----------
    Thesis, section 5.1.1 and figure 5.2.

    Examples
    --------
    >>> panel = control_panel()
    >>> panel.controls["left"].value = 80
    >>> panel.controls["presses"].press("step")
    >>> panel.drawn.fact.split("; ")[-1]
    'next +90 mm, +0.11 rad'
    """
    left, right = (
        slider(
            f"{side} stride (mm)", 100, -MAX_STRIDE, MAX_STRIDE, 10,
            tooltip=f"How far the legs on the {side} go in the next step", **sized("11em"),
        )
        for side in ("left", "right")
    )  # fmt: skip
    where = "Where the head points; positive is to the left"
    head = slider("head to the left (rad)", 0.0, -1.5, 1.5, 0.1, tooltip=where, **sized("11em"))
    presses = Presses([left, right, head])
    return Explorer(partial(draw, Drive(seed)), left=left, right=right, head=head, presses=presses)


def _minus(words: str) -> str:
    return words.replace("-", "−")
