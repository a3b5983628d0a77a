"""The camera: it renders pixels, and measures from them where the ball and the goal are.

A pixel shows what the ray through its center meets first. The ray leaves the lens along the
optical axis, which looks down by the tilt; one unit along the ray is the focal length. The whole
picture takes 33,280 rays. While the robot learns, only the rays that can meet the ball or decide
where the goal is are cast; both ways give the same measurement.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu._compiled import kernel
from arkaq_edu.field import pitch

if TYPE_CHECKING:
    from arkaq_edu.field.world import World

WIDTH, HEIGHT = 208, 160
FIELD_OF_VIEW = math.radians(56.9)
FOCAL_LENGTH = WIDTH / 2 / math.tan(FIELD_OF_VIEW / 2)

_PANELS, _POSTS = pitch.panels(), pitch.posts()
_LINES = np.sort(np.reshape(pitch.lines(), (-1, 2, 2)), axis=1).reshape(-1, 4)
_ROWS, _COLS = np.indices((HEIGHT, WIDTH)).reshape(2, -1)
_GOAL_ACROSS = pitch.GOAL_WIDTH + 4 * pitch.POST_RADIUS

_EACH_COL, _EACH_ROW = np.arange(WIDTH), np.arange(HEIGHT)

# Of the pixels at columns and rows, the first and the last that is sky-blue; (-1, -1) if none is.
Look = Callable[[NDArray[np.int64], NDArray[np.int64]], tuple[int, int]]


class Sighting(NamedTuple):
    """What one picture says about the ball: distance in mm, orientation in rad (left positive)."""

    distance: float
    orientation: float


class GoalSighting(NamedTuple):
    """What one picture says about the sky-blue goal: orientation of its middle and width (rad).

    `whole` is True if both posts are in the picture.
    """

    orientation: float
    width: float
    whole: bool


class View(NamedTuple):
    """The geometry of one picture: where the lens is, where it points, and where the ball lies.

    `x`, `y` and `height` of the lens and `ball_x`, `ball_y` are in mm; `heading` (to the left) and
    `tilt` (downward) of the optical axis are in rad.
    """

    x: float
    y: float
    height: float
    heading: float
    tilt: float
    ball_x: float
    ball_y: float


@kernel
def _ray(view, col, row):
    """Return the direction of the ray through the center of a pixel, in the field's frame."""
    right, down = col + 0.5 - WIDTH / 2, row + 0.5 - HEIGHT / 2
    # The tilt mixes the optical axis and the picture's vertical into ahead and up ...
    ahead = FOCAL_LENGTH * math.cos(view.tilt) - down * math.sin(view.tilt)
    up = -FOCAL_LENGTH * math.sin(view.tilt) - down * math.cos(view.tilt)
    # ... and the heading mixes ahead and right into x and y.
    c, s = math.cos(view.heading), math.sin(view.heading)
    return ahead * c + right * s, ahead * s - right * c, up


@kernel
def _hit_ball(view, dx, dy, dz):
    """Return how far along the ray, in lengths of (dx, dy, dz), the ball is; infinity if missed."""
    cx, cy = view.ball_x - view.x, view.ball_y - view.y
    cz = pitch.BALL_RADIUS - view.height
    # |t d - c| = R is a quadratic equation for t.
    along = dx * cx + dy * cy + dz * cz
    length_2 = dx * dx + dy * dy + dz * dz
    root = along * along - length_2 * (cx * cx + cy * cy + cz * cz - pitch.BALL_RADIUS**2)
    if root < 0.0 or along <= 0.0:
        return np.inf
    return (along - math.sqrt(root)) / length_2


@kernel
def _hit_panel(view, dx, dy, dz, nearest):
    """Return the distance and color of the first wall or goal panel nearer than `nearest`."""
    color = -1.0
    for i in range(len(_PANELS)):
        x1, y1, x2, y2 = _PANELS[i, 0], _PANELS[i, 1], _PANELS[i, 2], _PANELS[i, 3]
        px, py = x1 - view.x, y1 - view.y
        wx, wy = x2 - x1, y2 - y1
        cross = dx * wy - dy * wx
        if cross == 0.0:
            continue
        t = (px * wy - py * wx) / cross
        share = (px * dy - py * dx) / cross
        z = view.height + t * dz
        if 0.0 < t < nearest and 0.0 <= share <= 1.0 and 0.0 <= z <= _PANELS[i, 4]:
            nearest, color = t, _PANELS[i, 5]
    return nearest, color


@kernel
def _hit_post(view, dx, dy, dz, nearest, color):
    """Return the distance and color of the first post nearer than `nearest`, else as given."""
    length_2 = dx * dx + dy * dy
    for i in range(len(_POSTS)):
        px, py, radius = _POSTS[i, 0] - view.x, _POSTS[i, 1] - view.y, _POSTS[i, 2]
        along = px * dx + py * dy
        root = along * along - length_2 * (px * px + py * py - radius * radius)
        if root < 0.0:
            continue
        t = (along - math.sqrt(root)) / length_2
        if 0.0 < t < nearest and 0.0 <= view.height + t * dz <= _POSTS[i, 3]:
            nearest, color = t, _POSTS[i, 4]
    return nearest, color


@kernel
def _hit_upright(view, dx, dy, dz, nearest):
    """Return how far the first wall, panel or post before `nearest` is, and its color or -1."""
    nearest, color = _hit_panel(view, dx, dy, dz, nearest)
    return _hit_post(view, dx, dy, dz, nearest, color)


@kernel
def _ground_color(x, y):
    """Return the color of the carpet and its lines, or of what lies beyond it."""
    half = pitch.LINE_WIDTH / 2
    if abs(x) > pitch.CARPET_LENGTH / 2 or abs(y) > pitch.CARPET_WIDTH / 2:
        return pitch.NOTHING
    if abs(math.hypot(x, y) - pitch.CIRCLE_RADIUS) <= half:
        return pitch.WHITE
    for i in range(len(_LINES)):  # each from its lower left to its upper right end
        x1, y1, x2, y2 = _LINES[i, 0], _LINES[i, 1], _LINES[i, 2], _LINES[i, 3]
        if x1 - half <= x <= x2 + half and y1 - half <= y <= y2 + half:
            return pitch.WHITE
    return pitch.GREEN


@kernel
def _color(view, col, row):
    """Return the color that the ray through one pixel meets first."""
    dx, dy, dz = _ray(view, col, row)
    ball = _hit_ball(view, dx, dy, dz)
    _, color = _hit_upright(view, dx, dy, dz, ball)
    if color >= 0.0:
        return int(color)
    if ball < np.inf:
        return pitch.ORANGE
    if dz >= 0.0:
        return pitch.NOTHING
    return _ground_color(view.x - view.height / dz * dx, view.y - view.height / dz * dy)


@kernel
def _colors(view, cols, rows):
    """Return the colors of the pixels at `cols` and `rows`."""
    colors = np.empty(len(cols), np.uint8)
    for i in range(len(cols)):
        colors[i] = _color(view, cols[i], rows[i])
    return colors


@kernel
def _blue_ends(view, cols, rows):
    """Return which of the pixels at `cols` and `rows` are the first and the last sky-blue one.

    `view` is a View as a plain tuple, as for `_measure_ball`.
    """
    view = View(*view)
    first, last = 0, len(cols) - 1
    while first <= last and _color(view, cols[first], rows[first]) != pitch.BLUE:
        first += 1
    while first < last and _color(view, cols[last], rows[last]) != pitch.BLUE:
        last -= 1
    return (first, last) if first <= last else (-1, -1)


@kernel
def _span(aside, depth, size):
    """Return the first and last pixel (exclusive) that the ball can cover along one axis.

    In the plane of that axis the two tangents to the ball lie asin(R / distance) to either side of
    its center.
    """
    middle = math.atan2(aside, depth)
    half = math.asin(min(1.0, pitch.BALL_RADIUS / math.hypot(aside, depth)))
    low, high = max(middle - half, -1.5), min(middle + half, 1.5)  # short of a right angle
    first = math.floor(FOCAL_LENGTH * math.tan(low) + size / 2 - 0.5)
    last = math.ceil(FOCAL_LENGTH * math.tan(high) + size / 2 + 0.5)
    return int(max(0, min(size, first))), int(max(0, min(size, last)))


@kernel
def _ball_pixels(view):
    """Return columns and rows of the pixels that show the ball; only rays near it are cast."""
    ex, ey, up = view.ball_x - view.x, view.ball_y - view.y, pitch.BALL_RADIUS - view.height
    ahead = ex * math.cos(view.heading) + ey * math.sin(view.heading)
    left = ey * math.cos(view.heading) - ex * math.sin(view.heading)
    depth = ahead * math.cos(view.tilt) - up * math.sin(view.tilt)
    below = -ahead * math.sin(view.tilt) - up * math.cos(view.tilt)
    col_0, col_1, row_0, row_1 = 0, 0, 0, 0
    if depth > pitch.BALL_RADIUS:
        col_0, col_1 = _span(-left, depth, WIDTH)
        row_0, row_1 = _span(below, depth, HEIGHT)
    size = (col_1 - col_0) * (row_1 - row_0)
    cols, rows, n = np.empty(size, np.int64), np.empty(size, np.int64), 0
    for row in range(row_0, row_1):
        for col in range(col_0, col_1):
            dx, dy, dz = _ray(view, col, row)
            ball = _hit_ball(view, dx, dy, dz)
            if ball < np.inf and _hit_upright(view, dx, dy, dz, ball)[1] < 0.0:
                cols[n], rows[n] = col, row
                n += 1
    return cols[:n], rows[:n]


@kernel
def _whole_ball(seen, chord, size):
    """Return the area of a ball's image that the frame cuts, and how far in its center lies.

    The frame cuts a circle along a chord c and leaves a segment of height h, so the radius is
    h / 2 + c^2 / (8 h). Off the middle of the picture the circle is stretched outward by
    1 / cos(angle), which the height `seen` (pixels) must lose first. The frame lies `size` / 2
    pixels off the middle.
    """
    stretch = math.hypot(1.0, size / 2 / FOCAL_LENGTH)
    height = seen / stretch
    radius = height / 2 + chord * chord / (8 * height)
    return math.pi * radius * radius * stretch, (height - radius) * stretch


@kernel
def _measure(cols, rows, height, tilt, min_pixels):
    """Return distance and orientation of the ball from its pixels; (0, 0) if they do not tell."""
    area = float(len(cols))
    left, right = (cols == 0).sum(), (cols == WIDTH - 1).sum()
    top, bottom = (rows == 0).sum(), (rows == HEIGHT - 1).sum()
    cuts = int(left > 0) + int(right > 0) + int(top > 0) + int(bottom > 0)
    if area < min_pixels or cuts > 1:
        return 0.0, 0.0
    aside = cols.sum() / area + 0.5 - WIDTH / 2
    down = rows.sum() / area + 0.5 - HEIGHT / 2
    inward = 0.0
    if left + right > 0:
        area, inward = _whole_ball(cols.max() - cols.min() + 1, left + right, WIDTH)
        aside = (WIDTH / 2 - inward) * (1 if right > 0 else -1)
    elif top + bottom > 0:
        area, inward = _whole_ball(rows.max() - rows.min() + 1, top + bottom, HEIGHT)
        down = (HEIGHT / 2 - inward) * (1 if bottom > 0 else -1)
    if inward < 0.0:  # the center is out of the picture
        return 0.0, 0.0
    # A pixel at an angle a off the axis covers a solid angle of cos^3(a) / f^2. A ball of radius R
    # at range D covers 2 pi (1 - sqrt(1 - (R / D)^2)) = 2 pi cap.
    cosine = FOCAL_LENGTH / math.sqrt(FOCAL_LENGTH**2 + aside * aside + down * down)
    cap = area * cosine**3 / FOCAL_LENGTH**2 / (2 * math.pi)
    reach = pitch.BALL_RADIUS / math.sqrt(cap * (2 - cap))
    ahead = FOCAL_LENGTH * math.cos(tilt) - down * math.sin(tilt)
    drop = height - pitch.BALL_RADIUS
    return math.sqrt(max(reach * reach - drop * drop, 1.0)), math.atan2(-aside, ahead)


@kernel
def _measure_ball(view, min_pixels):
    """Return distance and orientation of the ball as it is seen now; (0, 0) if it is not.

    `view` is a View as a plain tuple: it takes a kernel microseconds to read a named one.
    """
    view = View(*view)
    cols, rows = _ball_pixels(view)
    return _measure(cols, rows, view.height, view.tilt, min_pixels)


class Camera:
    """The ERS-7's camera: 208 x 160 pixels over 56.9 x 45.2 degrees.

    It sits above the point that the robot turns about. So one distance and one orientation hold
    for the picture and for the body. A ball that touches the nose lies at 317 / 2 + 42 = 200 mm,
    the lower end of the thesis's interval.

    Parameters
    ----------
    height : float
        Height of the lens above the carpet (mm), in [42, 1000].
    tilt : float
        How far the optical axis looks down (rad), in [0, 1]. At .2 the ball stays in the
        picture from 300 mm to the far wall.
    min_pixels : int
        The smallest blob that counts as a ball. A color table mistakes smaller ones for a ball.
        This limits how far the robot sees: a ball at 4,100 mm covers about 12 pixels, and
        sightings begin to drop out at 4,300 mm.

    Notes
    -----
    Nothing is random here. The error remains because a ball is cut into whole pixels, so it
    grows with the square of the distance: see `distance_error`.

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

    def view(self, world: World) -> View:
        """Return the geometry of a picture taken now."""
        x, y, heading = world.pose
        return View(x, y, self.height, heading + world.pan, self.tilt, *world.ball)

    def sighting(self, world: World) -> Sighting | None:
        """Return what the camera sees of the ball, counted from the body.

        Parameters
        ----------
        world : World
            The field as it is now.

        Returns
        -------
        Sighting or None
            None if too few pixels show the ball, if its center is outside the picture, or while
            the head moves.
        """
        if self.blurred(world):
            return None
        distance, orientation = _measure_ball(tuple(self.view(world)), self.min_pixels)
        if distance == 0.0:
            return None
        return Sighting(distance, orientation + world.pan if world.pan else orientation)

    def sighting_in(self, colors: np.ndarray) -> Sighting | None:
        """Return what a rendered picture shows of the ball.

        Parameters
        ----------
        colors : ndarray of uint8, shape (160, 208)
            A picture as `colors` returns it.

        Returns
        -------
        Sighting or None
            The same as `sighting` from the same place with the head straight.
        """
        rows, cols = np.nonzero(_checked(colors) == pitch.ORANGE)
        distance, orientation = _measure(cols, rows, self.height, self.tilt, self.min_pixels)
        return Sighting(distance, orientation) if distance > 0.0 else None

    def goal(self, world: World) -> GoalSighting | None:
        """Return what the camera sees of the sky-blue goal, counted from the body.

        The row of the horizon shows what is as high as the lens: above the ball and the walls,
        below the bar of the goal. Its sky-blue pixels are the goal from post to post. If the
        frame cuts off one side, the height of the other post in the picture gives the distance.
        The distance gives the width that the whole goal would have, seen from straight in front.

        Parameters
        ----------
        world : World
            The field as it is now.

        Returns
        -------
        GoalSighting or None
            None if the horizon shows no sky-blue, or while the head moves.

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
        view = tuple(self.view(world))
        seen = self._goal(lambda cols, rows: _blue_ends(view, cols, rows))
        return seen and seen._replace(orientation=seen.orientation + world.pan)

    def goal_in(self, colors: np.ndarray) -> GoalSighting | None:
        """Return what a rendered picture shows of the sky-blue goal.

        Parameters
        ----------
        colors : ndarray of uint8, shape (160, 208)
            A picture as `colors` returns it.

        Returns
        -------
        GoalSighting or None
            The same as `goal` from the same place with the head straight.
        """
        is_blue = _checked(colors) == pitch.BLUE

        def look(cols: NDArray[np.int64], rows: NDArray[np.int64]) -> tuple[int, int]:
            blue = np.flatnonzero(is_blue[rows, cols])
            return (int(blue[0]), int(blue[-1])) if len(blue) else (-1, -1)

        return self._goal(look)

    def _goal(self, look: Look) -> GoalSighting | None:
        """Measure the goal on the row of the horizon."""
        horizon = max(0, math.floor(HEIGHT / 2 - FOCAL_LENGTH * math.tan(self.tilt)))
        first, last = look(_EACH_COL, np.full(WIDTH, horizon))
        if first < 0:
            return None
        ahead = self._ahead(horizon + 0.5 - HEIGHT / 2)
        left, right = math.atan2(WIDTH / 2 - first, ahead), math.atan2(WIDTH / 2 - last - 1, ahead)
        cut_left, cut_right = first == 0, last == WIDTH - 1
        if cut_left != cut_right:
            post = last - 1 if cut_left else first + 1
            width = self._width_by_height((post + 0.5 - WIDTH / 2) / ahead, look)
            left, right = (right + width, right) if cut_left else (left, left - width)
        return GoalSighting((left + right) / 2, left - right, not (cut_left or cut_right))

    def _width_by_height(self, aside: float, look: Look) -> float:
        """Return the width (rad) of the whole goal from the height of a post's image.

        `aside` is how far to the right the post lies for each unit ahead. A tilted camera shows an
        upright post leaning: in each row it lies `aside` times as far to the right as the ray of
        that row goes ahead.
        """
        cols = np.floor(aside * self._ahead(_EACH_ROW + 0.5 - HEIGHT / 2) + WIDTH / 2)
        first, last = look(cols.clip(0, WIDTH - 1).astype(int), _EACH_ROW)
        edges = np.array([first, last + 1]) - HEIGHT / 2
        fall = FOCAL_LENGTH * math.sin(self.tilt) + edges * math.cos(self.tilt)
        top, foot = fall / (self._ahead(edges) * math.hypot(1.0, aside))
        return 2 * math.asin(min(1.0, _GOAL_ACROSS / 2 * (foot - top) / pitch.GOAL_HEIGHT))

    def _ahead(self, down: Any) -> Any:
        """Return how far ahead (pixels) a ray goes that runs `down` pixels below the axis."""
        return FOCAL_LENGTH * math.cos(self.tilt) - down * math.sin(self.tilt)

    def blurred(self, world: World) -> bool:
        """Return whether a picture taken now would be useless because the head moves."""
        return world.head.blurs and world.unsettled > 0.0

    def colors(self, world: World) -> np.ndarray:
        """Return the color-segmented picture: for each pixel an index into `pitch.PALETTE`.

        Returns
        -------
        ndarray of uint8, shape (160, 208)
        """
        return _colors(self.view(world), _COLS, _ROWS).reshape(HEIGHT, WIDTH)

    def picture(self, world: World) -> np.ndarray:
        """Return the picture in color (figure 5.3).

        Returns
        -------
        ndarray of uint8, shape (160, 208, 3)
        """
        return pitch.PALETTE[self.colors(world)]

    def pixel(
        self, world: World, distance: float, orientation: float, height: float
    ) -> tuple[float, float]:
        """Return column and row at which something shows in a picture taken now.

        Parameters
        ----------
        world : World
            The field as it is now.
        distance, orientation : float
            Place of the thing, from the robot's body (mm, rad).
        height : float
            Its height above the carpet (mm).

        Examples
        --------
        >>> from arkaq_edu.field import World
        >>> camera = Camera(tilt=0.0)
        >>> camera.pixel(World(rng=0), 1000.0, 0.0, camera.height)  # straight ahead of the lens
        (104.0, 80.0)
        """
        distance = _checks.number("distance", distance)
        angle = _checks.number("orientation", orientation) - world.pan
        up = _checks.number("height", height) - self.height
        ahead, left = distance * math.cos(angle), distance * math.sin(angle)
        depth = ahead * math.cos(self.tilt) - up * math.sin(self.tilt)
        if depth == 0.0:
            raise ValueError(f"distance must not be that of the lens itself, got {distance:g}")
        rise = ahead * math.sin(self.tilt) + up * math.cos(self.tilt)
        return WIDTH / 2 - FOCAL_LENGTH * left / depth, HEIGHT / 2 - FOCAL_LENGTH * rise / depth

    def distance_error(self, distance: Any, pixels: float = 0.05) -> Any:
        """Return the error of the distance (mm) that an error in the blob's radius causes.

        A ball at distance d has an image of radius f R / d pixels. If the radius is off by s
        pixels, the distance is off by s d^2 / (f R).

        Parameters
        ----------
        distance : float or ndarray
            Distance of the ball (mm), >= 0.
        pixels : float
            Error of the radius (pixels).

        Examples
        --------
        >>> round(Camera().distance_error(4100.0, pixels=0.1))
        209
        """
        distance = _checks.array("distance", distance, None)[()]
        pixels = _checks.number("pixels", pixels)
        return pixels * distance**2 / (FOCAL_LENGTH * pitch.BALL_RADIUS)


def fit_power(distance: NDArray[np.float64], error: NDArray[np.float64]) -> tuple[float, float]:
    """Return the exponent and factor of the power of the distance that fits the errors best.

    Examples
    --------
    >>> exponent, factor = fit_power(np.array([1000.0, 2000.0]), np.array([10.0, 40.0]))
    >>> round(exponent, 6), round(factor * 3000**exponent, 3)
    (2.0, 90.0)
    """
    distance = _checks.array("distance", distance, (None,))
    error = _checks.array("error", error, distance.shape)
    for name, x in {"distance": distance, "error": error}.items():
        if len(x) < 2 or not (x > 0).all():
            raise ValueError(f"{name} must hold at least two numbers > 0, got {_checks.shown(x)}")
    exponent, logarithm = np.polyfit(np.log(distance), np.log(error), 1)
    return float(exponent), float(np.exp(logarithm))


def _checked(colors: np.ndarray) -> np.ndarray:
    pixels = _checks.integers("colors", colors, 0, len(pitch.PALETTE) - 1)
    if pixels.shape != (HEIGHT, WIDTH):
        raise ValueError(f"colors must have shape ({HEIGHT}, {WIDTH}), got {pixels.shape}")
    return pixels
