"""The field from above, as a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.camera import FIELD_OF_VIEW
from arkaq_edu.field.kick import PAW_RADIUS
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE
from arkaq_edu.field.world import World

# The picture is drawn larger and then shrunk, which smooths every edge.
_OVERSAMPLING = 3
MOST_PIXELS = 4000  # along each side of a picture
EXTENT = (
    -pitch.CARPET_LENGTH / 2,
    pitch.CARPET_LENGTH / 2,
    -pitch.CARPET_WIDTH / 2,
    pitch.CARPET_WIDTH / 2,
)

_CARPET, _LINE, _BORDER = (58, 125, 75), (240, 240, 235), (120, 124, 128)
_SHELL, _DARK, _LEG = (246, 246, 248), (44, 46, 52), (190, 194, 200)


class _Canvas:
    """A drawing in millimeters: x to the right, y upwards."""

    def __init__(self, width: int, region: tuple[float, float, float, float]) -> None:
        left, right, bottom, top = region
        self.scale = width * _OVERSAMPLING / (right - left)
        self.middle = (left + right) / 2, (bottom + top) / 2
        height = round(width * (top - bottom) / (right - left))
        self.image = Image.new("RGB", (width * _OVERSAMPLING, height * _OVERSAMPLING), _CARPET)
        self.draw = ImageDraw.Draw(self.image, "RGBA")

    def at(self, x: float, y: float) -> tuple[float, float]:
        middle_x, middle_y = self.image.width / 2, self.image.height / 2
        x, y = x - self.middle[0], y - self.middle[1]
        return middle_x + x * self.scale, middle_y - y * self.scale

    def line(self, points: Sequence[tuple[float, float]], color, width: float) -> None:
        pixels = max(1, round(width * self.scale))
        self.draw.line([self.at(*p) for p in points], fill=color, width=pixels, joint="curve")

    def polygon(self, points: Sequence[tuple[float, float]], color) -> None:
        self.draw.polygon([self.at(*p) for p in points], fill=color)

    def disc(self, x: float, y: float, radius: float, color, outline=None, width=0.0) -> None:
        (left, top), (right, bottom) = (
            self.at(x - radius, y + radius),
            self.at(x + radius, y - radius),
        )
        self.draw.ellipse(
            (left, top, right, bottom),
            fill=color,
            outline=outline,
            width=max(1, round(width * self.scale)),
        )

    def finish(self) -> np.ndarray:
        return np.asarray(self.image.reduce(_OVERSAMPLING))


def body_outline(x: float, y: float, heading: float) -> np.ndarray:
    """Return the corners of the robot's body from above, its nose last.

    Parameters
    ----------
    x, y, heading : float
        Its pose (mm, mm, rad).

    Returns
    -------
    ndarray, shape (5, 2)
        Corners (mm) of a rectangle of 317 x 180 mm whose front is pointed.

    Examples
    --------
    >>> body_outline(0.0, 0.0, 0.0)[-1]
    array([158.5,   0. ])
    """
    x, y, heading = _checks.array("x, y and heading", (x, y, heading), (3,)).tolist()
    length, width = pitch.ROBOT_LENGTH / 2, pitch.ROBOT_WIDTH / 2
    neck = length - width / 2
    corners = [[neck, width], [-length, width], [-length, -width], [neck, -width], [length, 0.0]]
    c, s = math.cos(heading), math.sin(heading)
    return np.array(corners) @ np.array([[c, s], [-s, c]]) + [x, y]


def bird_view(
    world: World,
    width: int = 900,
    trail: Sequence[tuple[float, float]] = (),
    sight: bool = True,
    ball_trail: Sequence[tuple[float, float]] = (),
    region: tuple[float, float, float, float] = EXTENT,
) -> np.ndarray:
    """Draw the field from above: carpet, lines, goals, ball and robot.

    Parameters
    ----------
    world : World
        The field as it is now.
    width : int
        Width of the picture (pixels), in [1, 4000]; its height follows from `region` and has the
        same bounds.
    trail : sequence of (x, y)
        The path of the robot so far (mm).
    sight : bool
        Whether to show the camera's field of view (figure 5.7).
    ball_trail : sequence of (x, y)
        The path of the ball so far (mm).
    region : tuple of float
        The part of the field to show: lowest and highest x, then y (mm).

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        The first row is at the highest y; pass `region` to ``imshow`` as the extent.

    Raises
    ------
    ValueError
        If an argument is out of range.

    Examples
    --------
    >>> bird_view(World(rng=0), width=300).shape
    (200, 300, 3)
    """
    walked, rolled = _path("trail", trail), _path("ball_trail", ball_trail)
    canvas = _Canvas(*_frame(width, region))
    _draw_pitch(canvas)
    x, y, heading = world.pose
    if sight:
        rim = np.linspace(-FIELD_OF_VIEW / 2, FIELD_OF_VIEW / 2, 25) + (heading + world.pan)
        wedge = [
            (x + MAX_BALL_DISTANCE * math.cos(a), y + MAX_BALL_DISTANCE * math.sin(a)) for a in rim
        ]
        canvas.polygon([(x, y), *wedge], (255, 255, 255, 38))
    if len(walked) > 1:
        canvas.line(walked, (250, 225, 90), 28)
    if len(rolled) > 1:
        canvas.line(rolled, (240, 105, 40, 150), 22)
    _draw_ball(canvas, *world.ball)
    if world.paw is not None:
        canvas.disc(*world.paw, PAW_RADIUS, _LEG, _DARK, 8)
    _draw_robot(canvas, x, y, heading, world.pan)
    return canvas.finish()


def _frame(width: Any, region: Any) -> tuple[int, tuple[float, float, float, float]]:
    """Return the width and region of a picture, or refuse them by name."""
    width = _checks.integer("width", width, 1, MOST_PIXELS)
    left, right, bottom, top = _checks.array("region", region, (4,)).tolist()
    if not (left < right and bottom < top):
        raise ValueError(f"region must be left < right, bottom < top, got {_checks.shown(region)}")
    height = width * (top - bottom) / (right - left)
    _checks.number("region (its height in pixels)", height, 1, MOST_PIXELS)
    return width, (left, right, bottom, top)


def _path(name: str, points: Any) -> list[Any]:
    """Return the points of a path, or refuse them by name."""
    return _checks.array(name, points, (None, 2)).tolist() if len(points) else []


def _draw_pitch(canvas: _Canvas) -> None:
    x, y = pitch.CARPET_LENGTH / 2, pitch.CARPET_WIDTH / 2
    for x1, y1, x2, y2 in pitch.lines():
        canvas.line([(x1, y1), (x2, y2)], _LINE, pitch.LINE_WIDTH)
    canvas.disc(0, 0, pitch.CIRCLE_RADIUS, None, _LINE, pitch.LINE_WIDTH)
    for x1, y1, x2, y2, height, color in pitch.panels().tolist():
        if height == pitch.GOAL_HEIGHT:
            paint = tuple(int(c) for c in pitch.PALETTE[int(color)])
            out = math.copysign(20, y1) if y1 == y2 else 0.0
            canvas.line([(x1, y1 + out), (x2, y2 + out)], paint, 40)
    for px, py, radius, _, color in pitch.posts().tolist():
        canvas.disc(px, py, radius, tuple(int(c) for c in pitch.PALETTE[int(color)]))
    border = [(-x, -y), (x, -y), (x, y), (-x, y), (-x, -y)]
    canvas.line(border, _BORDER, 40)


def _draw_ball(canvas: _Canvas, x: float, y: float) -> None:
    orange = tuple(int(c) for c in pitch.PALETTE[pitch.ORANGE])
    canvas.disc(x + 10, y - 12, pitch.BALL_RADIUS + 4, (0, 0, 0, 70))
    # A ball of 84 mm is only a dot on this scale. The rim makes it easy to find.
    canvas.disc(x, y, pitch.BALL_RADIUS + 8, orange, (120, 45, 10), 10)


def _draw_robot(canvas: _Canvas, x: float, y: float, heading: float, pan: float) -> None:
    """Draw the body, four legs, the head with its ears, and the tail."""
    c, s = math.cos(heading), math.sin(heading)

    def place(ahead: float, left: float) -> tuple[float, float]:
        return x + ahead * c - left * s, y + ahead * s + left * c

    def block(front: float, back: float, left: float, right: float, color) -> None:
        corners = [(front, left), (front, right), (back, right), (back, left)]
        canvas.polygon([place(*corner) for corner in corners], color)

    half_length, half_width = pitch.ROBOT_LENGTH / 2, pitch.ROBOT_WIDTH / 2
    block(half_length - 20, -half_length - 12, half_width + 14, -half_width - 14, (0, 0, 0, 50))
    for ahead in (55.0, -125.0):
        for left in (half_width - 28, -half_width - 2):
            block(ahead + 62, ahead, left + 30, left, _LEG)
    canvas.line([place(-110, 0), place(-185, 0)], _DARK, 16)
    block(70, -125, 58, -58, _SHELL)
    canvas.disc(*place(70, 0), 58, _SHELL)
    block(-10, -100, 40, -40, _DARK)
    neck, turned, aside = 70.0, math.cos(pan), math.sin(pan)

    def on_head(ahead: float, left: float) -> tuple[float, float]:
        ahead -= neck
        return place(neck + ahead * turned - left * aside, ahead * aside + left * turned)

    canvas.disc(*on_head(122, 0), 50, _SHELL, _LEG, 6)
    for left in (52.0, -52.0):
        canvas.line([on_head(118, left), on_head(78, left * 1.15)], _DARK, 22)
    canvas.disc(*on_head(148, 0), 24, _DARK)
