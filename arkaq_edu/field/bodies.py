"""The solid things of the field, as pymunk bodies and shapes: walls, goals, robot and ball."""

from __future__ import annotations

import math

import pymunk

from arkaq_edu.field import arcs, pitch
from arkaq_edu.field.arcs import Motion

_WALL_THICKNESS = 100.0


class Physics:
    """A space with all that is solid in it. It is built once for a world, as that takes long.

    Attributes
    ----------
    space : pymunk.Space
        It steps the bodies.
    robot, ball : pymunk.Body
        What moves.
    control : pymunk.Body
        What the robot's body follows: it has the velocity that the legs want.
    """

    def __init__(self) -> None:
        self.space = pymunk.Space()
        add_walls(self.space)
        self.robot, self.control = add_robot(self.space)
        self.ball = add_ball(self.space)
        self._last: tuple[Motion, Motion] | None = None
        self._robot_put: Motion | None = None
        self._robot_is_new = True

    def renew(self) -> None:
        """Build anew what moves: it remembers what it touched, and what pulled it how much."""
        remove(self.space, self.ball)
        if not self._robot_is_new:
            remove(self.space, self.robot)
            self.space.remove(self.control)
            self.robot, self.control = add_robot(self.space)
            self._robot_is_new = True
        self.ball = add_ball(self.space)
        self._last = None

    def put(self, robot: Motion, ball: Motion) -> None:
        """Let robot and ball move like this, unless they do already."""
        known, self._last = self._last, None
        if (robot, ball) == known:
            return
        self._robot_put = robot
        for body, (place, angle, velocity, spin) in ((self.robot, robot), (self.ball, ball)):
            body.position, body.angle = (place.real, place.imag), angle
            body.velocity, body.angular_velocity = (velocity.real, velocity.imag), spin

    def motions(self) -> tuple[Motion, Motion]:
        """Return how robot and ball move."""
        robot, ball = (
            Motion(complex(*b.position), b.angle, complex(*b.velocity), b.angular_velocity)
            for b in (self.robot, self.ball)
        )
        self._robot_is_new &= robot == self._robot_put  # else legs or a ball have pushed it
        self._last = robot, ball
        return robot, ball

    def want(self, velocity: complex, spin: float) -> None:
        """Let the legs want a velocity (mm/s) and a turn (rad/s)."""
        self.control.velocity = velocity.real, velocity.imag
        self.control.angular_velocity = spin


def remove(space: pymunk.Space, body: pymunk.Body) -> None:
    """Remove a body, its shapes and its joints."""
    space.remove(body, *body.shapes, *body.constraints)


def add_walls(space: pymunk.Space) -> None:
    """Add the wall around the carpet, and the posts and side panels of both goals."""
    x, y = pitch.CARPET_LENGTH / 2, pitch.CARPET_WIDTH / 2
    static, r = space.static_body, _WALL_THICKNESS / 2
    left, right, bottom, top = -x - r, x + r, -y - r, y + r
    sides = [
        ((left, bottom), (right, bottom)),
        ((left, top), (right, top)),
        ((left, bottom), (left, top)),
        ((right, bottom), (right, top)),
    ]
    shapes: list[pymunk.Shape] = [pymunk.Segment(static, a, b, r) for a, b in sides]
    for post_x, post_y, radius, _, _ in pitch.posts().tolist():
        # The side panel runs from the post to the wall behind it. It is as thick as the post, so
        # that a fast ball cannot pass through it between two steps. Its round end is the post.
        back = math.copysign(x, post_x), post_y
        shapes.append(pymunk.Segment(static, (post_x, post_y), back, radius))
    for shape in shapes:
        shape.elasticity, shape.friction = 0.5, 0.3
    space.add(*shapes)


def add_robot(space: pymunk.Space) -> tuple[pymunk.Body, pymunk.Body]:
    """Add the robot; return its body, and the control body whose velocity the body follows."""
    mass, size = pitch.ROBOT_MASS, (pitch.ROBOT_LENGTH, pitch.ROBOT_WIDTH)
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, size))
    control = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shape = pymunk.Poly.create_box(body, size)
    shape.elasticity, shape.friction = 0.1, 0.4
    shape.filter = pymunk.ShapeFilter(group=pitch.ROBOT_GROUP)
    # The legs push only as hard as the friction of the paws allows, so a wall is stronger.
    # max_bias = 0 keeps the joints from pulling the body back to the control body's place.
    legs = pymunk.PivotJoint(control, body, (0, 0), (0, 0))
    legs.max_bias, legs.max_force = 0, body.mass * arcs.GRIP
    turn = pymunk.GearJoint(control, body, 0.0, 1.0)
    turn.max_bias, turn.max_force = 0, body.moment * arcs.TWIST
    space.add(body, shape, control, legs, turn)
    return body, control


def add_ball(space: pymunk.Space) -> pymunk.Body:
    """Add the ball. Its rolling resistance is a weak joint to the ground."""
    mass, radius = pitch.BALL_MASS, pitch.BALL_RADIUS
    body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0, radius))
    shape = pymunk.Circle(body, radius)
    shape.elasticity, shape.friction = 0.6, 0.3
    rolling = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    rolling.max_bias, rolling.max_force = 0, body.mass * arcs.ROLL
    spinning = pymunk.GearJoint(space.static_body, body, 0.0, 1.0)
    spinning.max_bias, spinning.max_force = 0, body.moment * arcs.SPIN
    space.add(body, shape, rolling, spinning)
    return body
