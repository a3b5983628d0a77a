"""The camera: pixels first, and from them where the ball and the goal are.

The ball's blob of pixels gives its distance and orientation, the goal's pixels on the horizon
its orientation and width. One ray is cast through the center of a pixel and returns the color it
meets. The whole picture is all 33,280 rays; while learning, only those that matter are cast. Both
show the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu._compiled import kernel
from arkaq_edu.field import pitch

if TYPE_CHECKING:
    from arkaq_edu.field.world import World

WIDTH, HEIGHT = 208, 160
FIELD_OF_VIEW = math.radians(56.9)
FOCAL_LENGTH = WIDTH / 2 / math.tan(FIELD_OF_VIEW / 2)
_N, _SUM_COL, _SUM_ROW, _COL_0, _COL_1, _ROW_0, _ROW_1, _LEFT, _RIGHT, _TOP, _BOTTOM = range(11)

_PANELS, _POSTS = pitch.panels(), pitch.posts()
_LINES = np.array(pitch.lines())
_GOAL_ACROSS = pitch.GOAL_WIDTH + 4 * pitch.POST_RADIUS
_RADIUS, _RADIUS_2 = pitch.BALL_RADIUS, pitch.BALL_RADIUS**2


class Sighting(NamedTuple):
    """What one picture says of the ball: distance in mm, orientation in rad (left positive)."""

    distance: float
    orientation: float


class GoalSighting(NamedTuple):
    """What one picture says of the sky-blue goal: its middle's orientation, its width (rad).

    `whole` tells that the picture holds both its posts.
    """

    orientation: float
    width: float
    whole: bool


@kernel
def _ball_hit(ox, oy, oz, dx, dy, dz, bx, by):
    """Return how far along the ray (in lengths of its direction) the ball is met, or infinity."""
    cx, cy, cz = bx - ox, by - oy, _RADIUS - oz
    along = dx * cx + dy * cy + dz * cz
    length_2 = dx * dx + dy * dy + dz * dz
    inside = along * along - length_2 * (cx * cx + cy * cy + cz * cz - _RADIUS_2)
    if inside < 0.0 or along <= 0.0:
        return np.inf
    return (along - math.sqrt(inside)) / length_2


@kernel
def _upright_hit(ox, oy, oz, dx, dy, dz, panels, posts, nearest):
    """Return how far the nearest wall, panel or post is met before `nearest`, and its color."""
    color = -1.0
    for i in range(panels.shape[0]):
        px, py = panels[i, 0] - ox, panels[i, 1] - oy
        wx, wy = panels[i, 2] - panels[i, 0], panels[i, 3] - panels[i, 1]
        cross = dx * wy - dy * wx
        if cross == 0.0:
            continue
        t = (px * wy - py * wx) / cross
        along = (px * dy - py * dx) / cross
        z = oz + t * dz
        if 0.0 < t < nearest and 0.0 <= along <= 1.0 and 0.0 <= z <= panels[i, 4]:
            nearest, color = t, panels[i, 5]
    a = dx * dx + dy * dy
    for i in range(posts.shape[0]):
        px, py = posts[i, 0] - ox, posts[i, 1] - oy
        b = px * dx + py * dy
        inside = b * b - a * (px * px + py * py - posts[i, 2] * posts[i, 2])
        if inside < 0.0:
            continue
        t = (b - math.sqrt(inside)) / a
        if 0.0 < t < nearest and 0.0 <= oz + t * dz <= posts[i, 3]:
            nearest, color = t, posts[i, 4]
    return nearest, color


@kernel
def _ground_color(x, y, lines):
    """Return the color of the carpet, its lines and what lies beyond it."""
    half = pitch.LINE_WIDTH / 2
    if abs(x) > pitch.CARPET_LENGTH / 2 or abs(y) > pitch.CARPET_WIDTH / 2:
        return pitch.NOTHING
    if abs(math.hypot(x, y) - pitch.CIRCLE_RADIUS) <= half:
        return pitch.WHITE
    for i in range(lines.shape[0]):
        low_x, high_x = min(lines[i, 0], lines[i, 2]) - half, max(lines[i, 0], lines[i, 2]) + half
        low_y, high_y = min(lines[i, 1], lines[i, 3]) - half, max(lines[i, 1], lines[i, 3]) + half
        if low_x <= x <= high_x and low_y <= y <= high_y:
            return pitch.WHITE
    return pitch.GREEN


@kernel
def _direction(col, row, heading, tilt):
    """Return the direction of the ray through the center of a pixel, in the field's frame."""
    right, down = col + 0.5 - WIDTH / 2, row + 0.5 - HEIGHT / 2
    ahead = FOCAL_LENGTH * math.cos(tilt) - down * math.sin(tilt)
    up = -FOCAL_LENGTH * math.sin(tilt) - down * math.cos(tilt)
    c, s = math.cos(heading), math.sin(heading)
    return ahead * c + right * s, ahead * s - right * c, up


@kernel
def _color(col, row, x, y, z, heading, tilt, bx, by, panels, posts, lines):
    """Return the color that the ray through one pixel meets first."""
    dx, dy, dz = _direction(col, row, heading, tilt)
    t = _ball_hit(x, y, z, dx, dy, dz, bx, by)
    nearest, color = _upright_hit(x, y, z, dx, dy, dz, panels, posts, t)
    if color >= 0.0:
        return int(color)
    if nearest < np.inf:
        return pitch.ORANGE
    if dz >= 0.0:
        return pitch.NOTHING
    return _ground_color(x - z / dz * dx, y - z / dz * dy, lines)


@kernel
def _row(row, x, y, z, heading, tilt, bx, by, panels, posts, lines, image):
    """Cast the rays of one row."""
    for col in range(WIDTH):
        image[col] = _color(col, row, x, y, z, heading, tilt, bx, by, panels, posts, lines)


@kernel
def _plumb(cols, x, y, z, heading, tilt, bx, by, panels, posts, lines, image):
    """Cast one ray a row, each in a column of its own."""
    for row in range(HEIGHT):
        image[row] = _color(cols[row], row, x, y, z, heading, tilt, bx, by, panels, posts, lines)


@kernel
def _picture(x, y, z, heading, tilt, bx, by, panels, posts, lines, image):
    """Cast every ray."""
    for row in range(HEIGHT):
        _row(row, x, y, z, heading, tilt, bx, by, panels, posts, lines, image[row])


@kernel
def _clear(blob):
    blob[:] = 0.0
    blob[_COL_0], blob[_ROW_0] = WIDTH, HEIGHT
    blob[_COL_1], blob[_ROW_1] = -1, -1


@kernel
def _count(blob, col, row):
    """Add one pixel of the ball to the blob."""
    blob[_N] += 1
    blob[_SUM_COL] += col
    blob[_SUM_ROW] += row
    blob[_COL_0], blob[_COL_1] = min(blob[_COL_0], col), max(blob[_COL_1], col)
    blob[_ROW_0], blob[_ROW_1] = min(blob[_ROW_0], row), max(blob[_ROW_1], row)
    blob[_LEFT] += col == 0
    blob[_RIGHT] += col == WIDTH - 1
    blob[_TOP] += row == 0
    blob[_BOTTOM] += row == HEIGHT - 1


@kernel
def _blob_of_picture(image, blob):
    """Gather the pixels of the ball's color."""
    _clear(blob)
    for row in range(HEIGHT):
        for col in range(WIDTH):
            if image[row, col] == pitch.ORANGE:
                _count(blob, col, row)


@kernel
def _blob_of_world(x, y, z, heading, tilt, bx, by, panels, posts, blob):
    """Gather the same pixels, casting only the rays of a window round the ball's image."""
    _clear(blob)
    ex, ey = bx - x, by - y
    ahead = ex * math.cos(heading) + ey * math.sin(heading)
    left = ey * math.cos(heading) - ex * math.sin(heading)
    up = _RADIUS - z
    depth = ahead * math.cos(tilt) - up * math.sin(tilt)
    below = -ahead * math.sin(tilt) - up * math.cos(tilt)
    # Each of the window's sides is the tangent to the ball in the plane of that axis.
    if depth <= _RADIUS:
        return
    col_0, col_1 = _shadow(-left, depth, WIDTH)
    row_0, row_1 = _shadow(below, depth, HEIGHT)
    for row in range(row_0, row_1):
        for col in range(col_0, col_1):
            dx, dy, dz = _direction(col, row, heading, tilt)
            t = _ball_hit(x, y, z, dx, dy, dz, bx, by)
            if t < np.inf:
                _, color = _upright_hit(x, y, z, dx, dy, dz, panels, posts, t)
                if color < 0.0:
                    _count(blob, col, row)


@kernel
def _shadow(aside, depth, size):
    """Return the range of pixels the ball can cover along one axis of the picture."""
    middle = math.atan2(aside, depth)
    half = math.asin(min(1.0, _RADIUS / math.hypot(aside, depth)))
    low, high = max(middle - half, -1.5), min(middle + half, 1.5)
    first = math.floor(FOCAL_LENGTH * math.tan(low) + size / 2 - 0.5)
    last = math.ceil(FOCAL_LENGTH * math.tan(high) + size / 2 + 0.5)
    return int(max(0, min(size, first))), int(max(0, min(size, last)))


@kernel
def _measure(blob, z, tilt, min_pixels):
    """Return distance and orientation from a blob, or a distance of zero where it shows none."""
    n = blob[_N]
    cut = 0
    for edge in (_LEFT, _RIGHT, _TOP, _BOTTOM):  # a sum of NumPy's booleans would be a boolean
        cut += 1 if blob[edge] > 0 else 0
    if n < min_pixels or cut > 1:
        return 0.0, 0.0
    right = blob[_SUM_COL] / n + 0.5 - WIDTH / 2
    down = blob[_SUM_ROW] / n + 0.5 - HEIGHT / 2
    if cut == 1:
        # The frame has cut a circle along a chord. From the chord's length c and the height w of
        # the part still seen: radius = w / 2 + c^2 / (8 w). A ball off the middle of the picture
        # is stretched outwards by 1 / cos(angle), which w must lose first.
        if blob[_LEFT] + blob[_RIGHT] > 0:
            seen, chord = blob[_COL_1] - blob[_COL_0] + 1, blob[_LEFT] + blob[_RIGHT]
            stretch = math.hypot(1.0, WIDTH / 2 / FOCAL_LENGTH)
        else:
            seen, chord = blob[_ROW_1] - blob[_ROW_0] + 1, blob[_TOP] + blob[_BOTTOM]
            stretch = math.hypot(1.0, HEIGHT / 2 / FOCAL_LENGTH)
        height = seen / stretch
        radius = height / 2 + chord * chord / (8 * height)
        inwards = (height - radius) * stretch
        if inwards < 0.0:
            return 0.0, 0.0
        if blob[_LEFT] + blob[_RIGHT] > 0:
            right = (WIDTH / 2 - inwards) * (1 if blob[_RIGHT] > 0 else -1)
        else:
            down = (HEIGHT / 2 - inwards) * (1 if blob[_BOTTOM] > 0 else -1)
        n = math.pi * radius * radius * stretch
    # A pixel at an angle a off the axis covers a solid angle of cos^3(a) / f^2, and a ball of
    # radius R at range D one of 2 pi (1 - sqrt(1 - (R / D)^2)).
    cosine = FOCAL_LENGTH / math.sqrt(FOCAL_LENGTH**2 + right * right + down * down)
    cap = n * cosine**3 / FOCAL_LENGTH**2 / (2 * math.pi)
    span = pitch.BALL_RADIUS / math.sqrt(cap * (2 - cap))
    ahead = FOCAL_LENGTH * math.cos(tilt) - down * math.sin(tilt)
    drop = z - pitch.BALL_RADIUS
    return math.sqrt(max(span * span - drop * drop, 1.0)), math.atan2(-right, ahead)


class Camera:
    """The ERS-7's camera: 208 x 160 pixels over 56.9 x 45.2 degrees.

    It sits over the point the robot turns about, so that one distance and one orientation serve
    the picture and the body alike. The nearest ball, touching the nose, then lies at
    317 / 2 + 42 = 200 mm: the lower end of the thesis's interval.

    Parameters
    ----------
    height : float
        Height of the lens above the carpet (mm).
    tilt : float
        How far the optical axis looks down (rad), in [0, 1]. At .2 the ball stays in the
        picture from 300 mm to the far wall.
    min_pixels : int
        The smallest blob that counts as a ball. Smaller ones are what a color table takes for
        a ball by mistake. It limits how far the robot sees: a ball at 4,100 mm covers about
        12 pixels, and sightings begin to drop out from 4,300 mm on.

    Notes
    -----
    Nothing is random here. The error is what remains when a ball is cut into whole pixels, so it
    grows with the square of the distance: a blob whose radius is off by s pixels gives a
    distance off by s d^2 / (f R), 209 mm at 4,100 mm for a tenth of a pixel.

    References
    ----------
    Thesis 5.1.2.1 (the vision engine), 5.2 (ranges), figures 5.3 and 5.7.

    Examples
    --------
    >>> from arkaq_edu.field import World
    >>> world = World(rng=0)
    >>> world.reset(robot=(-2500.0, 0.0, 0.0), ball=(-1500.0, 300.0))
    >>> seen = Camera().sighting(world)
    >>> true = world.ball_from_robot()
    >>> bool(abs(seen.distance - true[0]) < 30), bool(abs(seen.orientation - true[1]) < 0.005)
    (True, True)
    """

    def __init__(self, height: float = 190.0, tilt: float = 0.2, min_pixels: int = 10) -> None:
        self.height = _checks.number("height", height, pitch.BALL_RADIUS, 1000)
        self.tilt = _checks.number("tilt", tilt, 0, 1)
        self.min_pixels = _checks.integer("min_pixels", min_pixels, 1)
        self._blob = np.zeros(11)

    def sighting(self, world: World) -> Sighting | None:
        """Return what the camera sees of the ball from where the robot stands and looks.

        Parameters
        ----------
        world : World
            The field as it is now.

        Returns
        -------
        Sighting or None
            None where too few pixels show the ball, or its center lies outside the picture; and
            while the head moves.
        """
        if self.blurred(world):
            return None
        _blob_of_world(*self._view(world), _PANELS, _POSTS, self._blob)
        seen = self._sighting()
        if seen is None or world.pan == 0.0:
            return seen
        return Sighting(seen.distance, seen.orientation + world.pan)

    def sighting_in(self, colors: np.ndarray) -> Sighting | None:
        """Return what a rendered picture shows of the ball.

        Parameters
        ----------
        colors : ndarray of uint8, shape (160, 208)
            A picture as `colors` gives it.

        Returns
        -------
        Sighting or None
            The same as `sighting` from the same place with the head straight.
        """
        _blob_of_picture(self._checked(colors), self._blob)
        return self._sighting()

    def goal(self, world: World) -> GoalSighting | None:
        """Return what the camera sees of the sky-blue goal.

        The row of the horizon is what lies as high as the lens: above the ball and the walls,
        below the goal's bar. Its sky-blue pixels are the goal from post to post. Where the frame
        cuts one side off, the height of the other post's image gives the distance and so the
        width that the whole goal has, as if it were seen from straight in front.

        Parameters
        ----------
        world : World
            The field as it is now.

        Returns
        -------
        GoalSighting or None
            None where the horizon shows no sky-blue, and while the head moves.

        Examples
        --------
        >>> from arkaq_edu.field import World
        >>> world, camera = World(rng=0), Camera()
        >>> world.reset(robot=(700.0, 0.0, -0.2), ball=(0.0, 0.0))
        >>> seen = camera.goal(world)
        >>> round(seen.orientation, 2), round(seen.width, 2)
        (0.2, 0.49)
        """
        if self.blurred(world):
            return None
        view = (*self._view(world), _PANELS, _POSTS, _LINES)
        horizon = np.empty(WIDTH, dtype=np.uint8)
        _row(self._horizon, *view, horizon)

        def plumb(cols: np.ndarray) -> np.ndarray:
            pixels = np.empty(HEIGHT, dtype=np.uint8)
            _plumb(cols, *view, pixels)
            return pixels

        seen = self._goal(horizon, plumb)
        return seen and seen._replace(orientation=seen.orientation + world.pan)

    def goal_in(self, colors: np.ndarray) -> GoalSighting | None:
        """Return what a rendered picture shows of the sky-blue goal.

        Parameters
        ----------
        colors : ndarray of uint8, shape (160, 208)
            A picture as `colors` gives it.

        Returns
        -------
        GoalSighting or None
            The same as `goal` from the same place with the head straight.
        """
        colors = self._checked(colors)
        return self._goal(colors[self._horizon], lambda cols: colors[np.arange(HEIGHT), cols])

    def blurred(self, world: World) -> bool:
        """Return whether a picture taken now would be useless, for the head moves."""
        return world.head.blurs and world.unsettled > 0.0

    def colors(self, world: World) -> np.ndarray:
        """Return the color-segmented picture: an index into `pitch.PALETTE` a pixel.

        Returns
        -------
        ndarray of uint8, shape (160, 208)
        """
        image = np.empty((HEIGHT, WIDTH), dtype=np.uint8)
        _picture(*self._view(world), _PANELS, _POSTS, _LINES, image)
        return image

    def picture(self, world: World) -> np.ndarray:
        """Return the picture in color (figure 5.3).

        Returns
        -------
        ndarray of uint8, shape (160, 208, 3)
        """
        return pitch.PALETTE[self.colors(world)]

    def distance_error(self, distance: float, pixels: float = 0.05) -> float:
        """Return the error of the distance (mm) that an error of the blob's radius makes.

        Parameters
        ----------
        distance : float
            Distance of the ball (mm), >= 0.
        pixels : float
            Error of the radius (pixels).

        Examples
        --------
        >>> round(Camera().distance_error(4100.0, pixels=0.1))
        209
        """
        return pixels * distance**2 / (FOCAL_LENGTH * pitch.BALL_RADIUS)

    def _view(self, world: World) -> tuple[float, float, float, float, float, float, float]:
        x, y, heading = world.pose
        return x, y, self.height, heading + world.pan, self.tilt, *world.ball

    @staticmethod
    def _checked(colors: np.ndarray) -> np.ndarray:
        if colors.shape != (HEIGHT, WIDTH):
            raise ValueError(f"colors must have shape ({HEIGHT}, {WIDTH}), got {colors.shape}")
        return colors

    @property
    def _horizon(self) -> int:
        """The row whose rays stay as high as the lens; the top row where that is out of view."""
        return max(0, math.floor(HEIGHT / 2 - FOCAL_LENGTH * math.tan(self.tilt)))

    def _ahead(self, down: ArrayLike) -> NDArray[np.float64]:
        """Return how far ahead (pixels) rays go that run so far (pixels) below the axis."""
        return FOCAL_LENGTH * math.cos(self.tilt) - np.asarray(down) * math.sin(self.tilt)

    def _goal(
        self, horizon: np.ndarray, plumb: Callable[[np.ndarray], np.ndarray]
    ) -> GoalSighting | None:
        """Measure the goal from the pixels of the horizon's row, and of a line down a post."""
        columns = np.flatnonzero(horizon == pitch.BLUE)
        if not len(columns):
            return None
        first, last = int(columns[0]), int(columns[-1])
        ahead = self._ahead(self._horizon + 0.5 - HEIGHT / 2)
        left = math.atan2(WIDTH / 2 - first, ahead)
        right = math.atan2(WIDTH / 2 - last - 1, ahead)
        cut_left, cut_right = first == 0, last == WIDTH - 1
        if cut_left != cut_right:
            width = self._width_by_height((last - 1 if cut_left else first + 1), plumb)
            left, right = (right + width, right) if cut_left else (left, left - width)
        return GoalSighting((left + right) / 2, left - right, not (cut_left or cut_right))

    def _width_by_height(self, col: int, plumb: Callable[[np.ndarray], np.ndarray]) -> float:
        """Return the width (rad) of a whole goal, one post of which is seen in a column."""
        # What stands upright leans in the picture of a tilted camera: all of it lies as far to
        # the right of the axis, for its distance ahead.
        aside = (col + 0.5 - WIDTH / 2) / self._ahead(self._horizon + 0.5 - HEIGHT / 2)
        down = np.arange(HEIGHT) + 0.5 - HEIGHT / 2
        cols = np.floor(aside * self._ahead(down) + WIDTH / 2)
        rows = np.flatnonzero(plumb(cols.clip(0, WIDTH - 1).astype(np.int64)) == pitch.BLUE)
        edges = np.array([rows[0], rows[-1] + 1]) - HEIGHT / 2
        fall = FOCAL_LENGTH * math.sin(self.tilt) + edges * math.cos(self.tilt)
        top, foot = fall / (self._ahead(edges) * math.hypot(1.0, aside))
        return 2 * math.asin(min(1.0, _GOAL_ACROSS / 2 * (foot - top) / pitch.GOAL_HEIGHT))

    def _sighting(self) -> Sighting | None:
        distance, orientation = _measure(self._blob, self.height, self.tilt, self.min_pixels)
        return Sighting(distance, orientation) if distance > 0.0 else None
