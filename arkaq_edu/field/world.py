"""The physics: walls, goals, a ball that rolls out, and a robot carried by its footsteps."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pymunk

from arkaq_edu import _checks
from arkaq_edu.field import pitch
from arkaq_edu.field.head import Head
from arkaq_edu.field.kick import Kick, build_paw, roll, swing

CYCLE = 0.64
SUBSTEPS = 80
# The legs follow a curve in chords: the heading is looked up this often in a cycle.
_CHORDS = 8
_WALL_THICKNESS = 100.0
LONGEST_FOOTSTEP = 194.0


@dataclass(frozen=True)
class Legs:
    """How the legs carry the body: what the gait means to do, and how it falls short.

    Parameters
    ----------
    slide : float
        Sideways slip to the left per millimeter walked. The battery lies in the left flank, and
        the robot leans that way (thesis 5.1.3.1, figure 5.5).
    pull : float
        Turn per millimeter walked (rad/mm): negative, for the robot turns to the right as it
        walks "straight".
    variation : float
        Standard deviation of a footstep's length, as a fraction of it: every footstep, and the
        left and the right one apart. Measured gaits vary by .014 to .03.

    Notes
    -----
    The thesis shows the drift in a picture and gives no number. The defaults bring the robot
    about 60 mm to the left and .08 rad to the right over two meters: visible, and small beside
    one turning footstep.
    """

    slide: float = 0.07
    pull: float = -4e-5
    variation: float = 0.02

    def __post_init__(self) -> None:
        _checks.number("slide", self.slide, -1, 1)
        _checks.number("pull", self.pull, -0.01, 0.01)
        _checks.number("variation", self.variation, 0, 0.5)


def _check_on_carpet(name: str, x: float, y: float) -> None:
    # So put that not-a-number is refused as well.
    if not (abs(x) <= pitch.CARPET_LENGTH / 2 and abs(y) <= pitch.CARPET_WIDTH / 2):
        raise ValueError(
            f"{name} must stand on the carpet (|x| <= {pitch.CARPET_LENGTH / 2:g}, "
            f"|y| <= {pitch.CARPET_WIDTH / 2:g} mm), got ({x:g}, {y:g})"
        )


class World:
    """The field with one robot and one ball, seen from above.

    The legs of either side take footsteps of their own length, all within one cycle of 640 ms:
    equal footsteps walk straight, a longer right one turns to the left, opposite ones turn on the
    spot. Diagonal legs move together in the gait, so the body travels a smooth arc:

        forward = (left + right) / 2,      turn = (right - left) / body width.

    The body is dynamic and steered through joints by a control body, which is how it comes to be
    stopped by a wall or a post instead of passing through it. The ball rolls out at a constant
    deceleration.

    Parameters
    ----------
    rng : int or numpy.random.Generator, optional
        Where the variation of the footsteps and of the kicks comes from.
    legs : Legs, optional
        The imperfections of the gait.
    head : Head, optional
        How the head moves.
    kick : Kick, optional
        The imperfections of the kick.

    Attributes
    ----------
    pose : tuple of float
        x, y (mm) and heading (rad) of the robot; the heading is zero toward the sky-blue goal.
    ball : tuple of float
        x, y (mm) of the ball's center.
    pan : float
        Where the head points (rad), from straight ahead to the left.
    time : float
        Seconds since the reset.
    watch : callable or None
        Called after each of the physics' steps while the robot kicks or stands.

    References
    ----------
    Thesis 5.1 (Webots and the AIBO there); the steering idiom is pymunk's own for top-down
    worlds.

    Examples
    --------
    >>> world = World(rng=0)
    >>> world.reset(robot=(-2500.0, 0.0, 0.0), ball=(0.0, 0.0))
    >>> for _ in range(10):
    ...     world.cycle(100.0, 100.0)
    >>> x, y, heading = world.pose
    >>> 950 < x + 2500 < 1050, y > 0, heading < 0
    (True, True, True)
    """

    def __init__(
        self,
        rng: int | np.random.Generator | None = None,
        legs: Legs | None = None,
        head: Head | None = None,
        kick: Kick | None = None,
    ) -> None:
        self.rng = np.random.default_rng(rng)
        self.legs, self.head, self.kick = legs or Legs(), head or Head(), kick or Kick()
        self.watch: Callable[[], None] | None = None
        self.reset((-2500.0, 0.0, 0.0), (0.0, 0.0))

    def reset(self, robot: tuple[float, float, float], ball: tuple[float, float]) -> None:
        """Build the world anew, so that nothing of an earlier episode survives in the solver.

        Parameters
        ----------
        robot : tuple of float
            x, y (mm) and heading (rad).
        ball : tuple of float
            x, y (mm).

        Raises
        ------
        ValueError
            If either would stand outside the carpet.
        """
        rx, ry, heading = _checks.array("robot", robot, (3,)).tolist()
        bx, by = _checks.array("ball", ball, (2,)).tolist()
        _check_on_carpet("robot", rx, ry)
        _check_on_carpet("ball", bx, by)
        self.space = pymunk.Space()
        self._build_walls()
        self._robot, self._control = self._build_robot(rx, ry, heading)
        self._ball = self._build_ball(bx, by)
        self._paw: pymunk.Body | None = None
        self.time = 0.0
        self._pan_from = self._pan_to = self._pan_since = 0.0

    def cycle(self, left: float, right: float) -> None:
        """Take one footstep cycle (640 ms).

        Parameters
        ----------
        left, right : float
            Length of the left and of the right footstep (mm), in [-194, 194].

        Raises
        ------
        ValueError
            If a footstep is longer than the legs.
        """
        limit = LONGEST_FOOTSTEP
        if not (abs(left) <= limit and abs(right) <= limit):
            raise ValueError(
                f"footsteps must be in [-{limit:g}, {limit:g}] mm, got {left!r} and {right!r}"
            )
        spread = self.legs.variation
        left *= 1 + spread * self.rng.standard_normal()
        right *= 1 + spread * self.rng.standard_normal()
        forward = (left + right) / 2
        turn = (right - left) / pitch.ROBOT_WIDTH + self.legs.pull * forward
        self._carry(forward / CYCLE, self.legs.slide * forward / CYCLE, turn / CYCLE)

    def _carry(self, ahead: float, sideways: float, spin: float) -> None:
        """Move the body for one cycle at a velocity given in its own frame (mm/s, mm/s, rad/s)."""
        body, control, step = self._robot, self._control, self.space.step
        dt = CYCLE / SUBSTEPS
        control.angular_velocity = spin
        for _ in range(_CHORDS):
            # The mean heading of the coming chord, so that the chords follow the arc.
            heading = body.angle + spin * CYCLE / _CHORDS / 2
            c, s = math.cos(heading), math.sin(heading)
            control.velocity = ahead * c - sideways * s, ahead * s + sideways * c
            for _ in range(SUBSTEPS // _CHORDS):
                step(dt)
        self.time += CYCLE

    def stand(self, seconds: float) -> None:
        """Stand still for a time (s), counted in whole steps of the physics."""
        dt = CYCLE / SUBSTEPS
        self._halt()
        for _ in range(math.ceil(_checks.number("seconds", seconds, 0) / dt)):
            self._advance(dt)

    def _halt(self) -> None:
        for body in (self._control, self._robot):
            body.velocity, body.angular_velocity = (0.0, 0.0), 0.0

    def look(self, pan: float) -> None:
        """Have the head pan (rad, to the left), as far as it goes; it moves as time passes."""
        reach = self.head.reach
        target = max(-reach, min(reach, _checks.number("pan", pan)))
        self._pan_from, self._pan_to, self._pan_since = self.pan, target, self.time

    @property
    def pan(self) -> float:
        """Where the head points (rad), from straight ahead to the left."""
        turned = self.head.speed * (self.time - self._pan_since)
        to_go = self._pan_to - self._pan_from
        return (
            self._pan_to if turned >= abs(to_go) else self._pan_from + math.copysign(turned, to_go)
        )

    @property
    def unsettled(self) -> float:
        """How long (s) the head will go on moving and swaying; 0 once it is still."""
        if self._pan_to == self._pan_from:
            return 0.0
        needed = abs(self._pan_to - self._pan_from) / self.head.speed + self.head.settling
        left = self._pan_since + needed - self.time
        return left if left > 1e-9 else 0.0

    def put_ball(self, x: float, y: float) -> None:
        """Put the ball elsewhere (mm), at rest.

        Raises
        ------
        ValueError
            If it would lie outside the carpet.
        """
        _check_on_carpet("ball", x, y)
        self.space.remove(self._ball, *self._ball.shapes, *self._ball.constraints)
        self._ball = self._build_ball(x, y)

    def swing_paw(self) -> list[tuple[float, float]]:
        """Kick, and let the ball roll until it rests.

        Returns
        -------
        list of (x, y)
            The ball's way (mm). A ball that the paw does not reach stays where it is.
        """
        self._halt()
        self._paw = build_paw(self.pose)
        shapes = tuple(self._paw.shapes)
        self.space.add(self._paw, *shapes)
        swing(self._paw, self._ball, self._advance)
        self.space.remove(self._paw, *shapes)
        self._paw = None
        pull = self.kick.swerve * self.rng.uniform(-1.0, 1.0)
        return roll(self._ball, pull, self._advance)

    @property
    def paw(self) -> tuple[float, float] | None:
        """x, y (mm) of the kicking paw while it swings."""
        if self._paw is None:
            return None
        x, y = self._paw.position
        return x, y

    def _advance(self, dt: float) -> None:
        self.space.step(dt)
        self.time += dt
        if self.watch is not None:
            self.watch()

    def kick_off(self, velocity: tuple[float, float]) -> None:
        """Set the ball rolling at `velocity` (mm/s)."""
        vx, vy = _checks.array("velocity", velocity, (2,)).tolist()
        self._ball.velocity = vx, vy

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y (mm) and heading (rad) of the robot."""
        x, y = self._robot.position
        return x, y, self._robot.angle

    @property
    def ball(self) -> tuple[float, float]:
        """x, y (mm) of the ball's center."""
        x, y = self._ball.position
        return x, y

    def ball_from_robot(self) -> tuple[float, float]:
        """Return the true distance (mm) and orientation (rad) of the ball from the robot."""
        return pitch.bearing(*self.pose, *self.ball)

    def goal_from_robot(self) -> tuple[float, float]:
        """Return the orientation of the middle of the sky-blue goal and its width (rad)."""
        x, side = pitch.LENGTH / 2, pitch.GOAL_WIDTH / 2 + 2 * pitch.POST_RADIUS
        _, left = pitch.bearing(*self.pose, x, side)
        _, right = pitch.bearing(*self.pose, x, -side)
        width = (left - right) % (2 * math.pi)
        middle = right + width / 2
        return math.atan2(math.sin(middle), math.cos(middle)), width

    def _build_walls(self) -> None:
        x, y = pitch.CARPET_LENGTH / 2, pitch.CARPET_WIDTH / 2
        static, r = self.space.static_body, _WALL_THICKNESS / 2
        out_x, out_y = x + r, y + r
        shapes: list[pymunk.Shape] = [
            pymunk.Segment(static, a, b, r)
            for a, b in [
                ((-out_x, -out_y), (out_x, -out_y)),
                ((-out_x, out_y), (out_x, out_y)),
                ((-out_x, -out_y), (-out_x, out_y)),
                ((out_x, -out_y), (out_x, out_y)),
            ]
        ]
        for post_x, post_y, radius, _, _ in pitch.posts().tolist():
            shapes.append(pymunk.Circle(static, radius, (post_x, post_y)))
            # The side panel runs from the post to the wall behind it, as thick as a post, so
            # that a fast ball cannot pass through between two steps.
            shapes.append(
                pymunk.Segment(static, (post_x, post_y), (math.copysign(x, post_x), post_y), radius)
            )
        for shape in shapes:
            shape.elasticity, shape.friction = 0.5, 0.3
        self.space.add(*shapes)

    def _build_robot(self, x: float, y: float, heading: float) -> tuple[pymunk.Body, pymunk.Body]:
        size = (pitch.ROBOT_LENGTH, pitch.ROBOT_WIDTH)
        body = pymunk.Body(pitch.ROBOT_MASS, pymunk.moment_for_box(pitch.ROBOT_MASS, size))
        body.position, body.angle = (x, y), heading
        shape = pymunk.Poly.create_box(body, size)
        shape.elasticity, shape.friction = 0.1, 0.4
        shape.filter = pymunk.ShapeFilter(group=pitch.ROBOT_GROUP)
        control = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        control.position, control.angle = body.position, heading
        # Legs push with the friction of the paws and no more: a wall is stronger. max_bias = 0
        # keeps the joint from dragging the body back to where the control body has got to.
        legs = pymunk.PivotJoint(control, body, (0, 0), (0, 0))
        legs.max_bias, legs.max_force = 0, pitch.ROBOT_MASS * 9810.0
        turn = pymunk.GearJoint(control, body, 0.0, 1.0)
        turn.max_bias, turn.max_force = 0, pitch.ROBOT_MASS * 9810.0 * pitch.ROBOT_WIDTH
        self.space.add(body, shape, control, legs, turn)
        return body, control

    def _build_ball(self, x: float, y: float) -> pymunk.Body:
        mass, radius = pitch.BALL_MASS, pitch.BALL_RADIUS
        body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0, radius))
        body.position = x, y
        shape = pymunk.Circle(body, radius)
        shape.elasticity, shape.friction = 0.6, 0.3
        rolling = pymunk.PivotJoint(self.space.static_body, body, (0, 0), (0, 0))
        rolling.max_bias, rolling.max_force = 0, mass * pitch.BALL_DECELERATION
        spinning = pymunk.GearJoint(self.space.static_body, body, 0.0, 1.0)
        spinning.max_bias = 0
        spinning.max_force = mass * pitch.BALL_DECELERATION * radius
        self.space.add(body, shape, rolling, spinning)
        return body
