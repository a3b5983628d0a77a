"""The control panel of chapter 8: footsteps, head and paw by hand, under the robot's eye and above.

References
----------
Thesis, section 5.1.1 and figure 5.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import ipywidgets
import numpy as np
import traitlets
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from arkaq_edu.field import Camera, GoalSighting, GoalSupervisor, Sighting, World, bird_view, pitch
from arkaq_edu.field.camera import FOCAL_LENGTH, HEIGHT, WIDTH
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.explorer import Buttons, Explorer, wide
from arkaq_edu.widgets.scene import Layer, Line, Panel, Picture, Points, Scene, Text

#: The names on the buttons.
DEEDS = ("step", "5 steps", "wait 0.1 s", "ball to the paw", "kick")
ROBOT, BALL = (300.0, -800.0, 0.25), (1400.0, -300.0)  # where they are at first
LONGEST = 190  # mm: where the sliders of the strides end
EXPOSURE = 1 / 30  # s: how long a picture gathers light

_STEPS = {"step": 1, "5 steps": 5}
_WAIT = 0.1
_AHEAD = 5  # cycles that the dashed line shows
_BLUE = "#1b4f8f"
_WIDE = wide("11em")


class Deed(NamedTuple):
    """A press: the button's name, and where the sliders stood (mm, mm, rad)."""

    name: str
    left: float
    right: float
    head: float


class Deeds(Buttons):
    """Buttons that remember with every press where the sliders stood.

    Parameters
    ----------
    sliders : sequence of ipywidgets widget
        Of the left stride, the right stride and the head.

    Attributes
    ----------
    value : tuple of Deed
        What has been done so far. Setting it is as good as pressing.

    Examples
    --------
    >>> deeds = Deeds([ipywidgets.IntSlider(value, max=190) for value in (90, 110, 0)])
    >>> deeds.press("step")
    >>> deeds.value
    (Deed(name='step', left=90, right=110, head=0),)
    """

    def __init__(self, sliders: Sequence[ipywidgets.DOMWidget]) -> None:
        self._sliders = tuple(sliders)
        super().__init__(DEEDS)

    def press(self, name: str) -> None:
        """Do what a click on the button of that name does."""
        if name == self.start_again:
            self.value = ()
        else:
            self.value = (*self.value, Deed(name, *(slider.value for slider in self._sliders)))

    @traitlets.validate("value")
    def _known(self, proposal: Any) -> tuple[Deed, ...]:
        deeds = tuple(Deed(*deed) for deed in proposal["value"])
        for deed in deeds:
            if deed.name not in DEEDS:
                raise ValueError(f"name must be one of {', '.join(DEEDS)}, got {deed.name!r}")
        return deeds


class Drive:
    """A world driven by deeds; the same deeds lead to the same world, to the last bit.

    It goes on from where it is when deeds are added, and begins anew when they are others.

    Parameters
    ----------
    seed : int
        What all luck comes from: of the footsteps, of the ball before a kick, of its way.

    Attributes
    ----------
    world : World
        The field as the deeds have left it.
    told : str
        What became of the last deed, if there is something to tell.
    trail, ball_trail : list of (x, y)
        Where the robot has been, and where the last kick drove the ball (mm).

    Examples
    --------
    >>> drive = Drive(seed=0)
    >>> drive.do([Deed("kick", 0, 0, 0)])  # the ball is a meter away
    >>> drive.told
    'the paw met no ball'
    """

    def __init__(self, seed: int = 0) -> None:
        self.seed = seed
        self.camera = Camera()
        # It sets the ball and judges; how far off it would place the robot does not matter.
        self.supervisor = GoalSupervisor(distance=2000.0)
        self._begin()

    def _begin(self) -> None:
        self.world = World(rng=self.seed)
        self.world.reset(ROBOT, BALL)
        self.deeds: tuple[Deed, ...] = ()
        self.head, self.told = 0.0, ""
        self.trail: list[tuple[float, float]] = [ROBOT[:2]]
        self.ball_trail: list[tuple[float, float]] = []
        self._look()

    def do(self, deeds: Sequence[Deed]) -> None:
        """Bring the world to where these deeds lead."""
        if self.deeds == tuple(deeds):
            return
        if self.deeds != tuple(deeds[: len(self.deeds)]):
            self._begin()
        for deed in deeds[len(self.deeds) :]:
            self._do(deed)
        self.deeds = tuple(deeds)
        self._look()

    def _do(self, deed: Deed) -> None:
        world, self.told = self.world, ""
        if deed.head != self.head:
            self.head = deed.head
            world.look(deed.head)
        for _ in range(_STEPS.get(deed.name, 0)):
            world.cycle(deed.left, deed.right)
            self.trail.append(world.pose[:2])
        if deed.name == "wait 0.1 s":
            world.stand(_WAIT)
        elif deed.name == "ball to the paw":
            self.ball_trail = []
            try:
                self.supervisor.set_ball(world)
            except ValueError:  # the robot has its nose at the wall
                self.told = "no room for the ball before the paw"
        elif deed.name == "kick":
            self._kick()

    def _kick(self) -> None:
        self.ball_trail = self.world.swing_paw()
        rolled = math.dist(self.ball_trail[0], self.ball_trail[-1])
        scored = self.supervisor.judge(self.world).is_success
        self.told = f"kicked {rolled:,.0f} mm{', a goal' if scored else ', no goal'}"
        if rolled == 0.0:
            self.told = "the paw met no ball"

    def _look(self) -> None:
        self.picture = self.camera.picture(self.world)
        self.above = bird_view(self.world, 480, self.trail, ball_trail=self.ball_trail)

    def draw(self, left: float, right: float, head: float, deeds: Sequence[Deed]) -> Scene:
        """Return the picture: what the camera shows on the left, the field from above beside it.

        Parameters
        ----------
        left, right : float
            The strides that the next step would take (mm).
        head : float
            Where the head is to point (rad, to the left).
        deeds : sequence of Deed
            What has been done so far.

        Returns
        -------
        Scene
        """
        self.do(deeds)
        world = self.world
        moving = head != self.head or self.camera.blurred(world)
        ball = None if moving else self.camera.sighting(world)
        goal = None if moving else self.camera.goal(world)
        ahead, turn = (left + right) / 2, (right - left) / pitch.ROBOT_WIDTH
        sights, step = self._sights(moving, ball, goal), f"next {ahead:+.0f} mm, {turn:+.2f} rad"
        # After a kick there is no room for the next step; the dashed line shows it all the same.
        fact = f"{self.told}; {sights}" if self.told else f"{sights}; {step}"
        return Scene(_proper(fact), [self._eye(moving, ball, goal), self._above(left, right, ball)])

    def _sights(self, moving: bool, ball: Sighting | None, goal: GoalSighting | None) -> str:
        """Say what is seen beside what is true."""
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
        """Return the camera's picture, with a mark where the ball, and the goal, was measured."""
        picture, title = self.picture, "what the camera sees"
        if moving:
            # While a picture gathers light, the head turns on by so many pixels.
            smear = round(self.world.head.speed * FOCAL_LENGTH * EXPOSURE)
            picture, title = uniform_filter1d(picture, smear, axis=1), "the head moves"
        layers: list[Layer] = [
            Picture(picture, (0, WIDTH, 0, HEIGHT), smooth=False),
            Text(0, HEIGHT + 9, title),
        ]
        marks = []
        if ball:
            x, y = self._pixel(ball.orientation, ball.distance, pitch.BALL_RADIUS)
            layers.append(Points([x], [y], 9.0, hollow=True))
            marks.append("ring: the ball")
        if goal:
            x, y = self._pixel(goal.orientation, 3000.0, self.camera.height)
            if 0 <= x <= WIDTH:  # else the goal is so far cut that its middle is out of view
                layers.append(Line([x, x], [y - 9, y + 9], _BLUE, 2.5))
                marks.append("bar: the goal's middle")
        if marks:
            layers.append(Text(0, -9, ", ".join([*marks, "as measured"]), style.QUIET))
        ends = (0.0, WIDTH + 8.0), (-18.0, HEIGHT + 18.0)
        return Panel("", "", *ends, layers, bare=True)

    def _pixel(self, orientation: float, distance: float, height: float) -> tuple[float, float]:
        """Return where in the picture something shows, counted from the lower left corner."""
        camera, angle = self.camera, orientation - self.world.pan
        forth, up = distance * math.cos(angle), height - camera.height
        depth = forth * math.cos(camera.tilt) - up * math.sin(camera.tilt)
        rise = forth * math.sin(camera.tilt) + up * math.cos(camera.tilt)
        aside = distance * math.sin(angle)
        return WIDTH / 2 - FOCAL_LENGTH * aside / depth, HEIGHT / 2 + FOCAL_LENGTH * rise / depth

    def _above(self, left: float, right: float, ball: Sighting | None) -> Panel:
        """Return the field from above, with the steps to come and the ball where it was seen."""
        x, y, heading = self.world.pose
        way = _arc((x, y, heading), left, right)
        words = f"x {x:,.0f} mm, y {y:,.0f} mm, heading {heading:+.2f} rad, {self.world.time:.1f} s"
        layers: list[Layer] = [
            Picture(self.above, EXTENT),
            Line(way[:, 0], way[:, 1], "white", 2.0, dashed=True),
            Points(way[-1:, 0], way[-1:, 1], 3.5, "white"),
            Text(-3000, 2170, f"from above; dashed: {_AHEAD} such steps without a drift"),
            Text(-3000, -2170, _proper(words), style.QUIET),
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

    The dashed line is where five steps of these strides would lead legs without a drift. A hollow
    ring is where the camera's pixels put the ball, in its picture and on the field; a blue bar is
    the middle of the goal. While the head moves there is neither.

    Parameters
    ----------
    seed : int
        Other luck: of the footsteps, and of the kicks.

    Returns
    -------
    Explorer
        Its controls are ``controls["left"]`` and ``controls["right"]`` (mm), ``controls["head"]``
        (rad), and the buttons ``controls["deeds"]``.

    References
    ----------
    Thesis, section 5.1.1 and figure 5.2.

    Examples
    --------
    >>> panel = control_panel()
    >>> panel.controls["left"].value = 80
    >>> panel.controls["deeds"].press("step")
    >>> panel.drawn.fact.split("; ")[-1]
    'next +90 mm, +0.11 rad'
    """
    strides = [
        ipywidgets.IntSlider(
            100, min=-LONGEST, max=LONGEST, step=10, description=f"{side} stride (mm)", **_WIDE
        )
        for side in ("left", "right")
    ]
    head = ipywidgets.FloatSlider(
        0.0, min=-1.5, max=1.5, step=0.1, description="head to the left (rad)", **_WIDE
    )
    left, right = strides
    deeds = Deeds([left, right, head])
    return Explorer(Drive(seed).draw, left=left, right=right, head=head, deeds=deeds)


def _arc(pose: tuple[float, float, float], left: float, right: float) -> NDArray[np.float64]:
    """Return the way of steps without a drift (mm): an arc, or a straight line."""
    x, y, heading = pose
    share = np.linspace(0.0, _AHEAD, 41)
    ahead, turn = (left + right) / 2, (right - left) / pitch.ROBOT_WIDTH
    chord = share * ahead * np.sinc(share * turn / 2 / math.pi)
    angle = heading + share * turn / 2
    return np.column_stack([x + chord * np.cos(angle), y + chord * np.sin(angle)])


def _proper(words: str) -> str:
    return words.replace("-", "−")
