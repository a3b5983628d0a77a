"""The pitch: all lengths and masses of the field, the ball and the robot.

The origin is the center spot. The x axis points at the sky-blue goal, y to the left of it, z up.
"""

from __future__ import annotations

import math

import numpy as np

# The four-legged league's field of 2005: white lines on a green carpet surrounded by a wall.
LENGTH, WIDTH = 5400.0, 3600.0
CARPET_LENGTH, CARPET_WIDTH = 6000.0, 4000.0
WALL_HEIGHT = 100.0
LINE_WIDTH = 25.0
CIRCLE_RADIUS = 180.0
BOX_WIDTH, BOX_DEPTH = 1300.0, 650.0
GOAL_WIDTH, GOAL_DEPTH, GOAL_HEIGHT = 800.0, 300.0, 300.0
POST_RADIUS = 50.0

# The rolling deceleration is taken from the ball filter of a team in that league.
BALL_RADIUS, BALL_MASS = 42.0, 100.0
BALL_DECELERATION = 250.0

# The ERS-7 as in Sony's drawing; the mass includes the battery.
ROBOT_LENGTH, ROBOT_WIDTH = 317.0, 180.0
ROBOT_MASS = 1650.0
# Shapes of one group do not collide: the body and its own paw.
ROBOT_GROUP = 1

NOTHING, GREEN, WHITE, YELLOW, BLUE, ORANGE, GRAY = range(7)
PALETTE = np.array(
    [
        (214, 224, 232),  # what lies beyond the wall
        (46, 125, 64),
        (245, 245, 240),
        (240, 200, 30),
        (70, 165, 225),
        (240, 105, 40),
        (170, 174, 178),
    ],
    dtype=np.uint8,
)


def panels() -> np.ndarray:
    """Return the upright faces of the walls and goals.

    Returns
    -------
    ndarray, shape (n, 6)
        One row per face: x1, y1, x2, y2 of its foot, its height (mm), its color (an index into
        `PALETTE`).
    """
    x, y = CARPET_LENGTH / 2, CARPET_WIDTH / 2
    rows = [
        (-x, -y, x, -y, WALL_HEIGHT, GRAY),
        (-x, y, x, y, WALL_HEIGHT, GRAY),
        (-x, -y, -x, y, WALL_HEIGHT, GRAY),
        (x, -y, x, y, WALL_HEIGHT, GRAY),
    ]
    for side, color in ((-1, YELLOW), (1, BLUE)):
        mouth, back, half = side * LENGTH / 2, side * (LENGTH / 2 + GOAL_DEPTH), GOAL_WIDTH / 2
        # The side panels stand outside the mouth, flush with the inner faces of the posts.
        rows += [
            (mouth, -half, back, -half, GOAL_HEIGHT, color),
            (mouth, half, back, half, GOAL_HEIGHT, color),
            # A millimeter in front of the wall, which would hide it otherwise.
            (back - side, -half, back - side, half, GOAL_HEIGHT, color),
        ]
    return np.array(rows, dtype=np.float64)


def posts() -> np.ndarray:
    """Return the goal posts.

    Returns
    -------
    ndarray, shape (4, 5)
        One row per post: x, y of its axis, its radius, its height (mm), its color (an index into
        `PALETTE`). The inner faces of the two posts of a goal are `GOAL_WIDTH` apart.
    """
    y = GOAL_WIDTH / 2 + POST_RADIUS
    return np.array(
        [
            (side * LENGTH / 2, sign * y, POST_RADIUS, GOAL_HEIGHT, color)
            for side, color in ((-1, YELLOW), (1, BLUE))
            for sign in (-1, 1)
        ],
        dtype=np.float64,
    )


def lines() -> list[tuple[float, float, float, float]]:
    """Return the straight lines on the carpet as segments x1, y1, x2, y2 (mm)."""
    x, y = LENGTH / 2, WIDTH / 2
    box_x, box_y = x - BOX_DEPTH, BOX_WIDTH / 2
    segments = [(-x, -y, x, -y), (-x, y, x, y), (-x, -y, -x, y), (x, -y, x, y), (0.0, -y, 0.0, y)]
    for side in (-1, 1):
        segments += [
            (side * box_x, -box_y, side * box_x, box_y),
            (side * box_x, -box_y, side * x, -box_y),
            (side * box_x, box_y, side * x, box_y),
        ]
    return segments


def bearing(x: float, y: float, heading: float, to_x: float, to_y: float) -> tuple[float, float]:
    """Return distance (mm) and direction (rad, to the left) of a point from a pose.

    Examples
    --------
    >>> bearing(0.0, 0.0, 0.0, 0.0, 1000.0)  # straight to the left
    (1000.0, 1.5707963267948966)
    """
    dx, dy = to_x - x, to_y - y
    angle = math.atan2(dy, dx) - heading
    return math.hypot(dx, dy), math.atan2(math.sin(angle), math.cos(angle))
