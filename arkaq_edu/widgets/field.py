"""The control panel of chapter 8: footsteps, head and paw by hand, with the robot's view and ours.

References
----------
Thesis, section 5.1.1 and figure 5.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import ipywidgets
from scipy.ndimage import uniform_filter1d

from arkaq_edu.field import Camera, GoalSighting, GoalSupervisor, Sighting, World, bird_view, motion
from arkaq_edu.field.camera import FOCAL_LENGTH, HEIGHT, WIDTH
from arkaq_edu.field.pitch import BALL_RADIUS
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Buttons, Explorer, wide
from arkaq_edu.widgets.scene import Layer, Line, Panel, Picture, Points, Scene, Text

#: The names of the buttons.
BUTTONS = ("step", "5 steps", "wait 0.1 s", "ball to the paw", "kick")
ROBOT, BALL = (300.0, -800.0, 0.25), (1400.0, -300.0)  # where they are at first
MAX_STRIDE = 190  # mm: the end of the sliders
EXPOSURE = 1 / 30  # s: how long a picture gathers light

_CYCLES = {"step": 1, "5 steps": 5}
_WAIT = 0.1  # s
_AHEAD = 5  # cycles that the dashed line shows
_BLUE = "#1b4f8f"
_FAR = 3000.0  # mm: any distance does, because the goal's middle is shown at the camera's height


class Press(NamedTuple):
    """A press of a button: its name, and the values of the sliders (mm, mm, rad)."""

    name: str
    left: float
    right: float
    head: float


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

    def record(self, name: str) -> Press:
        """Return the press of a button, with the sliders as they are now."""
        return Press(name, *(slider.value for slider in self._sliders))


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

    Examples
    --------
    >>> drive = Drive(seed=0)
    >>> drive.follow([Press("kick", 0, 0, 0)])  # the ball is a meter away
    >>> drive.message
    'the paw met no ball'
    """

    def __init__(self, seed: int = 0) -> None:
        self.seed, self.camera = seed, Camera()
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

    def draw(self, left: float, right: float, head: float, presses: Sequence[Press]) -> Scene:
        """Return the scene: the camera's picture, and the field from above beside it.

        Parameters
        ----------
        left, right : float
            The strides of the next step (mm).
        head : float
            Where the head will point (rad, to the left).
        presses : sequence of Press
            The presses so far.
        """
        self.follow(presses)
        moving = head != self.head or self.camera.blurred(self.world)
        ball = None if moving else self.camera.sighting(self.world)
        goal = None if moving else self.camera.goal(self.world)
        sights = self._describe(moving, ball, goal)
        ahead, turn = motion.gait(left, right)
        # After a kick there is no room for the next step; the dashed line shows it anyway.
        step = f"{sights}; next {ahead:+.0f} mm, {turn:+.2f} rad"
        fact = f"{self.message}; {sights}" if self.message else step
        return Scene(_minus(fact), [self._eye(moving, ball, goal), self._field(left, right, ball)])

    def _describe(self, moving: bool, ball: Sighting | None, goal: GoalSighting | None) -> str:
        """Say what is seen, and what is true."""
        distance, orientation = self.world.ball_from_robot()
        middle, _ = self.world.goal_from_robot()
        if moving:
            return (
                f"the head moves, no look counts (true: ball {distance:,.0f} mm, "
                f"{orientation:+.3f} rad; goal {middle:+.3f})"
            )
        near = f"ball {ball.distance:,.0f} mm, {ball.orientation:+.3f} rad" if ball else "no ball"
        far = f"goal {goal.orientation:+.3f}" if goal else "no goal"
        return f"{near} (true {distance:,.0f}, {orientation:+.3f}); {far} (true {middle:+.3f})"

    def _eye(self, moving: bool, ball: Sighting | None, goal: GoalSighting | None) -> Panel:
        """Return the camera's picture, with marks where ball and goal were measured."""
        picture, title = self.picture, "what the camera sees"
        if moving:
            # While a picture gathers light, the head turns by this many pixels.
            smear = round(self.world.head.speed * FOCAL_LENGTH * EXPOSURE)
            picture, title = uniform_filter1d(picture, smear, axis=1), "the head moves"
        marks: list[Layer] = []
        names = []
        if ball:
            col, row = self.camera.pixel(self.world, *ball, BALL_RADIUS)
            marks.append(Points([col], [HEIGHT - row], 9.0, hollow=True))
            names.append("ring: the ball")
        if goal:
            col, row = self.camera.pixel(self.world, _FAR, goal.orientation, self.camera.height)
            if 0 <= col <= WIDTH:  # the middle of a goal that is mostly cut off is out of view
                marks.append(Line([col, col], [HEIGHT - row - 9, HEIGHT - row + 9], _BLUE, 2.5))
                names.append("bar: the goal's middle")
        if names:
            marks.append(Text(0, -9, ", ".join([*names, "as measured"]), style.QUIET))
        pixels = Picture(picture, (0, WIDTH, 0, HEIGHT), smooth=False)
        layers: list[Layer] = [pixels, Text(0, HEIGHT + 9, title), *marks]
        return Panel("", "", (0.0, WIDTH + 8.0), (-18.0, HEIGHT + 18.0), layers, bare=True)

    def _field(self, left: float, right: float, ball: Sighting | None) -> Panel:
        """Return the field from above, with the next steps, and the ball where it was seen."""
        x, y, heading = self.world.pose
        path = motion.arc_path(self.world.pose, left, right, _AHEAD)
        words = f"x {x:,.0f} mm, y {y:,.0f} mm, heading {heading:+.2f} rad, {self.world.time:.1f} s"
        layers: list[Layer] = [
            Picture(self.above, EXTENT),
            Line(path[:, 0], path[:, 1], "white", 2.0, dashed=True),
            Points(path[-1:, 0], path[-1:, 1], 3.5, "white"),
            Text(-3000, 2170, f"from above; dashed: {_AHEAD} such steps without a drift"),
            Text(-3000, -2170, _minus(words), style.QUIET),
            Line([-2880, -2880, -2480], [-1480, -1880, -1880], "white"),
            Text(-2420, -1880, "x", "white"),
            Text(-2880, -1390, "y", "white", "center"),
        ]
        if ball:
            angle = heading + ball.orientation
            seen = x + ball.distance * math.cos(angle), y + ball.distance * math.sin(angle)
            layers.append(Points([seen[0]], [seen[1]], 9.0, hollow=True))
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
    look = wide("11em")
    left, right = (
        ipywidgets.IntSlider(
            100, min=-MAX_STRIDE, max=MAX_STRIDE, step=10, description=f"{side} stride (mm)", **look
        )
        for side in ("left", "right")
    )
    head = ipywidgets.FloatSlider(
        0.0, min=-1.5, max=1.5, step=0.1, description="head to the left (rad)", **look
    )
    presses = Presses([left, right, head])
    return Explorer(Drive(seed).draw, left=left, right=right, head=head, presses=presses)


def _minus(words: str) -> str:
    return words.replace("-", "−")
