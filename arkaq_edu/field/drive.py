"""A robot driven by hand: buttons for steps, for the ball's place, and for the kick."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from arkaq_edu import _checks
from arkaq_edu.field.camera import Camera, GoalSighting, Sighting
from arkaq_edu.field.goal import GoalSupervisor
from arkaq_edu.field.view import bird_view
from arkaq_edu.field.world import World

#: The names of the buttons.
BUTTONS = ("step", "5 steps", "wait 0.1 s", "ball to the paw", "kick")
ROBOT, BALL = (300.0, -800.0, 0.25), (1400.0, -300.0)  # where they are at first

_CYCLES = {"step": 1, "5 steps": 5}
_WAIT = 0.1  # s


class Press(NamedTuple):
    """A press of a button: its name, and the values of the sliders (mm, mm, rad)."""

    name: str
    left: float
    right: float
    head: float


class Look(NamedTuple):
    """What the camera makes of a picture; while the head moves it is nothing."""

    moving: bool
    ball: Sighting | None
    goal: GoalSighting | None


class Drive:
    """A world driven by presses; the same presses lead to exactly the same world.

    If presses are added, it continues from where it is. If they differ, it begins again.

    Parameters
    ----------
    seed : int
        Seed of all randomness: footsteps, the ball's place before a kick, the ball's path.

    Attributes
    ----------
    world : World
        The field after the presses.
    message : str
        The outcome of the last press, if there is something to say.
    trail, ball_trail : list of (x, y)
        The path of the robot, and the path of the ball after the last kick (mm).
    picture, above : ndarray
        What the camera sees after the last press, and the field from above.

    Examples
    --------
    >>> drive = Drive(seed=0)
    >>> drive.follow([Press("kick", 0, 0, 0)])  # the ball is a meter away
    >>> drive.message
    'the paw met no ball'
    """

    def __init__(self, seed: int = 0) -> None:
        self.seed, self.camera = _checks.integer("seed", seed), Camera()
        # It only places the ball and judges, so its distance does not matter.
        self.supervisor = GoalSupervisor(distance=2000.0)
        self._begin()

    def _begin(self) -> None:
        self.world = World(rng=self.seed)
        self.world.reset(ROBOT, BALL)
        self.presses: tuple[Press, ...] = ()
        self.head, self.message = 0.0, ""
        self.trail: list[tuple[float, float]] = [ROBOT[:2]]
        self.ball_trail: list[tuple[float, float]] = []
        self._take_pictures()

    def follow(self, presses: Sequence[Press]) -> None:
        """Bring the world to where these presses lead."""
        presses = tuple(Press(*press) for press in presses)
        if presses == self.presses:
            return
        if self.presses != presses[: len(self.presses)]:
            self._begin()
        for press in presses[len(self.presses) :]:
            self._act(press)
        self.presses = presses
        self._take_pictures()

    def _act(self, press: Press) -> None:
        world, self.message = self.world, ""
        if press.head != self.head:
            self.head = press.head
            world.look(press.head)
        for _ in range(_CYCLES.get(press.name, 0)):
            world.cycle(press.left, press.right)
            self.trail.append(world.pose[:2])
        if press.name == "wait 0.1 s":
            world.stand(_WAIT)
        elif press.name == "ball to the paw":
            self.ball_trail = []
            try:
                self.supervisor.set_ball(world)
            except ValueError:  # the robot faces the wall
                self.message = "no room for the ball before the paw"
        elif press.name == "kick":
            self.ball_trail = world.swing_paw()
            rolled = math.dist(self.ball_trail[0], self.ball_trail[-1])
            goal = "a goal" if self.supervisor.judge(world).is_success else "no goal"
            self.message = f"kicked {rolled:,.0f} mm, {goal}" if rolled else "the paw met no ball"

    def _take_pictures(self) -> None:
        self.picture = self.camera.picture(self.world)
        self.above = bird_view(self.world, 480, self.trail, ball_trail=self.ball_trail)

    def look(self, head: float) -> Look:
        """Return what the camera sees with the head at `head` (rad, to the left).

        Examples
        --------
        >>> Drive(seed=0).look(head=0.5)  # it is still turning there
        Look(moving=True, ball=None, goal=None)
        """
        if head != self.head or self.camera.blurred(self.world):
            return Look(True, None, None)
        return Look(False, self.camera.sighting(self.world), self.camera.goal(self.world))

    def describe(self, look: Look) -> str:
        """Say what is seen, and what is true.

        Examples
        --------
        >>> drive = Drive(seed=0)
        >>> drive.describe(drive.look(head=0.5))
        'the head moves, no look counts (true: ball 1,208 mm, +0.177 rad; goal +0.060)'
        """
        distance, orientation = self.world.ball_from_robot()
        middle, _ = self.world.goal_from_robot()
        if look.moving:
            return (
                f"the head moves, no look counts (true: ball {distance:,.0f} mm, "
                f"{orientation:+.3f} rad; goal {middle:+.3f})"
            )
        ball, goal = look.ball, look.goal
        near = f"ball {ball.distance:,.0f} mm, {ball.orientation:+.3f} rad" if ball else "no ball"
        far = f"goal {goal.orientation:+.3f}" if goal else "no goal"
        return f"{near} (true {distance:,.0f}, {orientation:+.3f}); {far} (true {middle:+.3f})"
