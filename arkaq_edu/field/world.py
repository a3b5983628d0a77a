"""The physics: a robot that is moved by its footsteps, and a ball that rolls to a stop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import pymunk

from arkaq_edu import _checks
from arkaq_edu.field import arcs, pitch
from arkaq_edu.field.arcs import CHORDS, CYCLE, STEP, SUBSTEPS, Motion
from arkaq_edu.field.bodies import Physics
from arkaq_edu.field.head import Head
from arkaq_edu.field.kick import Kick, build_paw, roll_out, swing_paw

LONGEST_FOOTSTEP = 194.0  # mm
FASTEST_BALL = 10_000.0  # mm/s; a faster one could pass through a post between two steps
LONGEST_STAND = 3600.0  # s


@dataclass(frozen=True)
class Legs:
    """How the gait differs from what the footsteps should do.

    Parameters
    ----------
    slide : float
        Sideways slip to the left per millimeter walked, in [-1, 1]. The battery is in the left
        flank, so the robot leans to the left (thesis 5.1.3.1, figure 5.5).
    pull : float
        Turn to the left per millimeter walked (rad/mm), in [-.01, .01]. It is negative: the robot
        turns to the right when it walks "straight".
    variation : float
        Standard deviation of a footstep's length as a fraction of that length, in [0, .5]. Each
        footstep varies on its own. Measured gaits vary by .014 to .03.

    Notes
    -----
    The thesis shows the drift in a picture and gives no number. With the defaults the robot ends
    about 60 mm to the left, turned .08 rad to the right, after two meters. That is visible, but
    small beside one turning footstep.
    """

    slide: float = 0.07
    pull: float = -4e-5
    variation: float = 0.02

    def __post_init__(self) -> None:
        object.__setattr__(self, "slide", _checks.number("slide", self.slide, -1, 1))
        object.__setattr__(self, "pull", _checks.number("pull", self.pull, -0.01, 0.01))
        object.__setattr__(self, "variation", _checks.number("variation", self.variation, 0, 0.5))


def _check_on_carpet(name: str, x: float, y: float) -> None:
    # "not <=" also refuses NaN, which ">" would let through.
    if not (abs(x) <= pitch.CARPET_LENGTH / 2 and abs(y) <= pitch.CARPET_WIDTH / 2):
        raise ValueError(
            f"{name} must be on the carpet (|x| <= {pitch.CARPET_LENGTH / 2:g}, "
            f"|y| <= {pitch.CARPET_WIDTH / 2:g} mm), got ({x:g}, {y:g})"
        )


class World:
    """The field with one robot and one ball, seen from above.

    In each cycle of 640 ms the legs of the left and of the right side take a footstep of their own
    length. Equal footsteps walk straight, a longer right one turns to the left, opposite ones turn
    on the spot. Diagonal legs move together, so the body travels along a smooth arc:

        forward = (left + right) / 2,      turn = (right - left) / body width.

    The body follows the velocity of a control body through joints of limited force. So a wall or a
    post stops it. The ball rolls with a constant deceleration. While nothing can be touched, both
    move in closed form (`arkaq_edu.field.arcs`), which leads to the same place.

    Parameters
    ----------
    rng : int or numpy.random.Generator, optional
        Source of the variation of footsteps and kicks.
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
        Where the head points (rad, to the left of straight ahead).
    time : float
        Seconds since the reset.
    watch : callable or None
        Called after each step while the robot kicks or stands.

    References
    ----------
    Thesis 5.1. The control body is pymunk's usual way to steer in a world seen from above.

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
        self.rng = _checks.generator("rng", rng)
        self.legs = _checks.instance("legs", Legs() if legs is None else legs, Legs)
        self.head = _checks.instance("head", Head() if head is None else head, Head)
        self.kick = _checks.instance("kick", Kick() if kick is None else kick, Kick)
        self.watch: Callable[[], None] | None = None
        self._physics: Physics | None = None
        self.reset((-2500.0, 0.0, 0.0), (0.0, 0.0))

    def reset(self, robot: tuple[float, float, float], ball: tuple[float, float]) -> None:
        """Begin anew; nothing of an earlier episode remains in the physics.

        Parameters
        ----------
        robot : tuple of float
            x, y (mm) and heading (rad).
        ball : tuple of float
            x, y (mm).

        Raises
        ------
        ValueError
            If either is not on the carpet.
        """
        rx, ry, heading = _checks.array("robot", robot, (3,)).tolist()
        bx, by = _checks.array("ball", ball, (2,)).tolist()
        _check_on_carpet("robot", rx, ry)
        _check_on_carpet("ball", bx, by)
        self._robot = Motion(complex(rx, ry), heading, 0j, 0.0)
        self._ball = Motion(complex(bx, by), 0.0, 0j, 0.0)
        self._physics_is_new = False
        self._paw: pymunk.Body | None = None
        self.time = 0.0
        self._pan_from = self._pan_to = self._pan_since = 0.0

    def _enter_physics(self) -> Physics:
        """Hand robot and ball over to the physics, built when something first comes near."""
        if self._physics is None:
            self._physics = Physics()
        elif not self._physics_is_new:
            self._physics.renew()
        self._physics_is_new = True
        self._physics.put(self._robot, self._ball)
        return self._physics

    @property
    def space(self) -> pymunk.Space:
        """The pymunk space, with robot and ball where they are now."""
        return self._enter_physics().space

    def cycle(self, left: float, right: float) -> None:
        """Take one footstep cycle (640 ms).

        Parameters
        ----------
        left, right : float
            Length of the left and of the right footstep (mm), in [-194, 194].

        Raises
        ------
        ValueError
            If a footstep is longer than the legs allow.
        """
        left = _checks.number("left", left, -LONGEST_FOOTSTEP, LONGEST_FOOTSTEP)
        right = _checks.number("right", right, -LONGEST_FOOTSTEP, LONGEST_FOOTSTEP)
        variation = self.legs.variation
        left *= 1 + variation * self.rng.standard_normal()
        right *= 1 + variation * self.rng.standard_normal()
        forward = (left + right) / 2
        turn = (right - left) / pitch.ROBOT_WIDTH + self.legs.pull * forward
        self._move(complex(forward, self.legs.slide * forward) / CYCLE, turn / CYCLE)
        self.time += CYCLE

    def _move(self, velocity: complex, spin: float) -> None:
        """Move the body for one cycle at a velocity in its own frame (mm/s, rad/s)."""
        bodies = tuple(self._robot), tuple(self._ball)
        robot, ball, free = arcs.free_cycle(*bodies, velocity, spin)
        if free:
            self._robot, self._ball = Motion(*robot), Motion(*ball)
            return
        physics = self._enter_physics()
        body, step = physics.robot, physics.space.step
        for _ in range(CHORDS):
            physics.want(arcs.chord(velocity, body.angle, spin), spin)
            for _ in range(SUBSTEPS // CHORDS):
                step(STEP)
        physics.want(0j, 0.0)
        self._robot, self._ball = physics.motions()

    def stand(self, seconds: float) -> None:
        """Stand still for a time (s) of at most an hour, rounded up to whole physics steps."""
        seconds = _checks.number("seconds", seconds, 0, LONGEST_STAND)
        self._halt()
        steps = math.ceil(seconds / STEP)
        if not self._ball.velocity and arcs.out_of_reach(self._robot, self._ball, 0.0, seconds):
            for _ in range(steps):
                self._tick(STEP)
            return
        physics = self._enter_physics()
        for _ in range(steps):
            self._advance(physics, STEP)
        self._robot, self._ball = physics.motions()

    def _halt(self) -> None:
        self._robot = self._robot._replace(velocity=0j, spin=0.0)

    def look(self, pan: float) -> None:
        """Begin to pan the head to an angle (rad, to the left) within its reach."""
        reach = self.head.reach
        target = max(-reach, min(reach, _checks.number("pan", pan)))
        self._pan_from, self._pan_to, self._pan_since = self.pan, target, self.time

    @property
    def pan(self) -> float:
        """Where the head points (rad, to the left of straight ahead)."""
        turned = self.head.speed * (self.time - self._pan_since)
        to_go = self._pan_to - self._pan_from
        if turned >= abs(to_go):
            return self._pan_to
        return self._pan_from + math.copysign(turned, to_go)

    @property
    def unsettled(self) -> float:
        """How long the head will still move and sway (s); 0 if it is still."""
        if self._pan_to == self._pan_from:
            return 0.0
        needed = abs(self._pan_to - self._pan_from) / self.head.speed + self.head.settling
        remaining = self._pan_since + needed - self.time
        return remaining if remaining > 1e-9 else 0.0  # no time but rounding

    def put_ball(self, x: float, y: float) -> None:
        """Put the ball at rest somewhere else (mm).

        Raises
        ------
        ValueError
            If that is not on the carpet.
        """
        x, y = _checks.array("ball", (x, y), (2,), allow_nan=True).tolist()
        _check_on_carpet("ball", x, y)
        self._ball = Motion(complex(x, y), 0.0, 0j, 0.0)
        self._physics_is_new = False  # it still knows what the ball touched elsewhere

    def put_robot(self, x: float, y: float, heading: float) -> None:
        """Put the robot somewhere else, at rest (mm, mm, rad): somebody has pushed it.

        Raises
        ------
        ValueError
            If that is not on the carpet.
        """
        x, y, heading = _checks.array("robot", (x, y, heading), (3,)).tolist()
        _check_on_carpet("robot", x, y)
        self._robot = Motion(complex(x, y), heading, 0j, 0.0)
        self._physics_is_new = False

    def swing_paw(self) -> list[tuple[float, float]]:
        """Kick, and let the ball roll until it rests.

        Returns
        -------
        list of (x, y)
            The ball's path (mm). It has one point if the paw does not reach the ball.
        """
        self._halt()
        physics, self._paw = self._enter_physics(), build_paw(self.pose)
        shapes = tuple(self._paw.shapes)
        physics.space.add(self._paw, *shapes)
        try:
            swing_paw(self._paw, physics.ball, partial(self._advance, physics), self._move_paw)
        finally:  # an interrupt leaves no paw behind
            physics.space.remove(self._paw, *shapes)
            self._paw = None
        self._robot, self._ball = physics.motions()
        swerve = self.kick.swerve * self.rng.uniform(-1.0, 1.0)
        self._ball, path = roll_out(self._ball, swerve, self._roll)
        return path

    @property
    def paw(self) -> tuple[float, float] | None:
        """x, y (mm) of the kicking paw while it swings."""
        if self._paw is None:
            return None
        x, y = self._paw.position
        return x, y

    def _move_paw(self, x: float, y: float, dt: float) -> None:
        if self.watch is not None and self._paw is not None:
            self._paw.position = x, y
        self._tick(dt)

    def _advance(self, physics: Physics, dt: float) -> None:
        physics.space.step(dt)
        if self.watch is not None:
            self._robot, self._ball = physics.motions()
        self._tick(dt)

    def _tick(self, dt: float) -> None:
        self.time += dt
        if self.watch is not None:
            self.watch()

    def _roll(self, ball: Motion, push: complex, dt: float) -> tuple[Motion, list[complex]]:
        """Let the ball roll until something may be in its way, else for one look by physics."""
        end, way = arcs.coast(tuple(ball), push, dt, tuple(self._robot))
        places = way.tolist()
        for place in places:
            self.time += dt
            if self.watch is not None:
                self._ball = Motion(place, 0.0, 0j, 0.0)
                self.watch()
        self._ball = Motion(*end)
        if places:
            return self._ball, places[arcs.LOOK - 1 :: arcs.LOOK]
        physics = self._enter_physics()
        for _ in range(arcs.LOOK):
            physics.ball.force = push.real * pitch.BALL_MASS, push.imag * pitch.BALL_MASS
            self._advance(physics, dt)
        self._robot, self._ball = physics.motions()
        return self._ball, [self._ball.place]

    def roll_ball(self, velocity: tuple[float, float]) -> None:
        """Set the ball rolling at `velocity` (mm/s), at most 10,000 mm/s.

        Raises
        ------
        ValueError
            If it is faster.
        """
        vx, vy = _checks.array("velocity", velocity, (2,)).tolist()
        _checks.number("velocity (its length)", math.hypot(vx, vy), 0, FASTEST_BALL)
        self._ball = self._ball._replace(velocity=complex(vx, vy))

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y (mm) and heading (rad) of the robot."""
        place = self._robot.place
        return place.real, place.imag, self._robot.angle

    @property
    def ball(self) -> tuple[float, float]:
        """x, y (mm) of the ball's center."""
        return self._ball.place.real, self._ball.place.imag

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
