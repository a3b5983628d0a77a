"""The live robot: one canvas on which it walks, sees, believes, chooses and learns, as you watch.

The page asks for every frame shortly before it needs it. So nothing runs while the page is hidden
or gone.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Literal

import anywidget
import ipywidgets
import traitlets

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.experiments.policies import Policy
from arkaq_edu.widgets.explorer import WRAP, Explorer, button, sized, slider
from arkaq_edu.widgets.robot import CHANCE, TRAINED, Robot
from arkaq_edu.widgets.scene import Scene
from arkaq_edu.widgets.segmentation import vigilance_explorer

Name = Literal["approach", "goal"]

#: Where the slider of speed stops: times real time; 0 is as fast as it can.
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 0.0)

_PUSH, _TURN = 100.0, 0.15  # mm and rad that a key pushes


class LiveView(anywidget.AnyWidget):
    """A canvas that plays the frames of one robot or two; live.js draws it.

    Attributes
    ----------
    stage : dict
        What stays the same; see `Robot.stage`.
    playing : bool
        Whether the page asks for frames.
    speed : float
        How many times faster than in reality it plays; 0 is as fast as it can.
    help : str
        What can be done by hand.
    """

    # One module of two files, as text: anywidget watches files, and so keeps every canvas.
    _esm = "\n".join(
        Path(__file__).with_name(name).read_text(encoding="utf-8").split("\nexport default")[0]
        for name in ("canvas.js", "live.js")
    ) + "\nexport default { render: renderLive };\n"  # fmt: skip
    _css = Path(__file__).with_name("canvas.css").read_text(encoding="utf-8")
    stage = traitlets.Dict().tag(sync=True)
    playing = traitlets.Bool(False).tag(sync=True)
    speed = traitlets.Float(1.0).tag(sync=True)
    help = traitlets.Unicode().tag(sync=True)


class LiveRobot(Explorer):
    """Controls above one robot, or above two that race.

    Parameters
    ----------
    robots : sequence of Robot
        One, or two.

    Attributes
    ----------
    robots : sequence of Robot
        The models; what they do can be tried without a page.
    controls : dict
        The controls by name: play, speed, seed, driver (for a race left and right), vigilance,
        noise, dropout and drift.

    Examples
    --------
    >>> robot = live_robot()
    >>> robot.step()
    >>> robot.controls["noise"].value = 200
    >>> str(robot).startswith("cycle 1: seen at 2,")
    True
    """

    view: LiveView

    def __init__(self, robots: Sequence[Robot], *drivers: str) -> None:
        self.robots = robots
        self.number = 0
        first = robots[0]
        view = LiveView(stage=first.stage(), help=_HELP[first.name])
        names = ("driver",) if len(robots) == 1 else ("left", "right")
        wheel = dict(zip(names, drivers or [first.drivers[0]] * len(names), strict=True))
        controls = _controls(first, wheel)
        super().__init__(self._scene, view, **controls)
        traitlets.link((controls["play"], "value"), (view, "playing"))
        view.on_msg(self._asked)
        rows = [
            [
                controls["play"],
                button("step", partial(self._try, self.step), "One cycle (.)"),
                button("start again", partial(self._try, self.restart), "With the first episode"),
                controls["speed"], controls["seed"],
            ],
            [controls[name] for name in (*names, "vigilance")],
            [controls[name] for name in ("noise", "dropout", "drift")],
        ]  # fmt: skip
        self.children = [
            *(ipywidgets.HBox(row, layout=WRAP) for row in rows),
            view,
            self._message,
        ]

    @property
    def drawn(self) -> Scene:  # type: ignore[override]
        """The present, as a picture."""
        return self._scene()

    def step(self) -> None:
        """Go on by one cycle."""
        self._tell("frames", self._go())

    def restart(self) -> None:
        """Begin again with the first episode."""
        for robot in self.robots:
            robot.restart()
        self._tell_whole()

    def _scene(self, **values: Any) -> Scene:
        stills = [robot.still() for robot in self.robots]
        if len(stills) == 1:
            return stills[0]
        fact = " | ".join(f"{robot.title}; {robot.brief}" for robot in self.robots)
        return Scene(fact, [still.panels[0] for still in stills])

    def _redraw(self) -> None:
        values = {name: box.value for name, box in self.controls.items()}
        self.view.speed = values.pop("speed")
        values.pop("play")
        drivers = [values.pop(name) for name in ("driver", "left", "right") if name in values]
        changed = [
            robot.set(driver=driver, **values)
            for robot, driver in zip(self.robots, drivers, strict=True)
        ]
        if any(changed) or not self.view.playing:
            self._tell_whole()

    def _go(self, seconds: float = 0.0) -> list[dict[str, Any] | None]:
        """Go on by a cycle, or for so many seconds; who has arrived waits for the other one."""
        end = time.monotonic() + seconds
        moved: set[int] = set()
        while not moved or time.monotonic() < end:
            there = [i for i, robot in enumerate(self.robots) if not robot.over]
            for i in there or range(len(self.robots)):
                self.robots[i].advance(filming=not seconds)
                moved.add(i)
        return [robot.frame() if i in moved else None for i, robot in enumerate(self.robots)]

    def _tell(self, kind: str, frames: list[dict[str, Any] | None]) -> None:
        self.number += 1
        self.view.send({"kind": kind, "number": self.number, "frames": frames})

    def _tell_whole(self) -> None:
        self._tell("whole", [robot.frame(whole=True) for robot in self.robots])

    def _asked(self, _: Any, message: Mapping[str, Any], buffers: Any) -> None:
        self._try(lambda: self._answer(**message))
        if self.error is not None:
            error, words = self.error, self._message.value
            self.controls["play"].value = False  # as a control that works it would clear these
            self.error, self._message.value = error, words

    def _answer(self, kind: str, **said: Any) -> None:
        if kind == "hello":
            self._tell_whole()
        elif kind == "step":
            self.step()
        elif kind == "next":
            if said["after"] == self.number:  # otherwise they are on their way: to another view
                self._tell("frames", self._go(said["seconds"]))
        else:
            for i, robot in enumerate(self.robots):
                if said["what"] == "ball" or i == said["lane"]:
                    _push(robot, **said)
            glances = [robot.glance() for robot in self.robots]
            self.view.send({"kind": "glance", "glances": glances})


def _controls(robot: Robot, wheel: Mapping[str, str]) -> dict[str, Any]:
    """Return the controls by name; `wheel` says who is at it, for a race left and right."""
    goal = robot.name == "goal"
    narrow = sized("7em", 21)
    return {
        "play": ipywidgets.ToggleButton(
            description="play", tooltip="Let it go, or stop (Space)", layout={"width": "auto"}
        ),
        "speed": ipywidgets.SelectionSlider(
            options=[(f"{x:g} ×" if x else "as fast as it can", x) for x in SPEEDS],
            value=1.0, description="speed", tooltip="Times real time", **sized("4em", 20),
        ),
        "seed": ipywidgets.BoundedIntText(
            0, min=0, max=9999, description="seed",
            tooltip="Of the starts and of all chance", **sized("4em", 10),
        ),
        **{
            name: ipywidgets.Dropdown(
                options=robot.drivers, value=driver, tooltip="Who chooses the actions",
                description="at the wheel" if name == "driver" else name, **narrow,
            )
            for name, driver in wheel.items()
        },
        "vigilance": slider(
            "vigilance", robot.vigilance, 0.02 if goal else 0.05, 0.6, 0.01,
            tooltip="Of the map: the trained agent's values, averaged over each new cell",
            **narrow,
        ),
        "noise": slider(
            "noise (mm)", 0, 0, 400, 20,
            tooltip="How far off a sighting is; the filter is told", **narrow,
        ),
        "dropout": slider(
            "dropout", 0.0, 0.0, 1.0, 0.05,
            tooltip="How likely a sighting is lost", **narrow,
        ),
        "drift": slider(
            "kick's spread" if goal else "drift", 1.0, 0.0, 1.3 if goal else 10.0,
            0.1 if goal else 0.5,
            tooltip="Times the robot's own; it is not told", **narrow,
        ),
    }  # fmt: skip


_HELP = {
    "approach": (
        "Drag the ball or the robot. On the picture, arrow keys move the ball, with Shift they "
        "push and turn the robot; Space plays, the period goes one step."
    ),
    "goal": (
        "Drag the robot. On the picture, arrow keys push and turn it; Space plays, the period "
        "goes one step."
    ),
}


def _push(
    robot: Robot,
    what: str,
    lane: int,
    to: tuple[float, float] | None = None,
    way: tuple[int, int] = (0, 0),
) -> None:
    """Move the ball or the robot to a place, or a little way, as an arrow key says."""
    heading = robot.pose[2]
    across, up = way
    if what == "ball":
        ball_x, ball_y = robot.ball
        robot.move_ball(*(to or (ball_x + _PUSH * across, ball_y + _PUSH * up)))
    elif to:
        robot.move_robot(*to, heading)
    else:
        robot.push(_PUSH * up, -_TURN * across)


def live_robot(
    task: Name = "approach",
    agents: Mapping[str, Arkaq | Policy] | None = None,
    driver: str | None = None,
) -> LiveRobot:
    """Return a robot that goes as you watch, with all that it sees, believes and decides.

    Parameters
    ----------
    task : {"approach", "goal"}
        What it does: walk to the ball, or turn to the goal and kick.
    agents : mapping of str to Arkaq or Policy, optional
        One's own, by the name under which they stand in the menu, before the others.
    driver : str, optional
        Who is at the wheel at first: one of one's own, or of `arkaq_edu.widgets.robot.DRIVERS`. By
        default the first in the menu.

    Returns
    -------
    LiveRobot

    Raises
    ------
    ValueError
        If the task or the driver is unknown.

    References
    ----------
    Thesis, chapter 3, sections 5.2 and 5.3.

    Examples
    --------
    >>> live_robot("goal")
    cycle 0: seen at −0.12 rad, believed at −0.12 rad; state 10: turn right
    """
    robot = Robot(task, agents)
    first = robot.drivers[0] if driver is None else driver
    return LiveRobot([robot], _checks.choice("driver", first, robot.drivers))


def race(task: Name = "approach", agents: Mapping[str, Arkaq | Policy] | None = None) -> LiveRobot:
    """Return two robots side by side, which begin every episode at the same place.

    Who has arrived waits for the other one. What a hand does to the ball, it does to both.

    Parameters
    ----------
    task, agents
        As for `live_robot`. The first two at the wheel are the first agent, or the trained one,
        and the second agent, or chance.

    Examples
    --------
    >>> duel = race()
    >>> duel.controls["left"].value, duel.controls["right"].value
    ('the trained agent', 'chance')
    """
    first, second = [*(agents or {}), TRAINED, CHANCE][:2]
    return LiveRobot([Robot(task, agents) for _ in range(2)], first, second)


class VigilanceRobot(LiveRobot):
    """The vigilance explorer above a robot that walks by its map; see `vigilance_robot`."""

    def __init__(self) -> None:
        super().__init__([Robot()])
        self.explorer = vigilance_explorer()
        theirs, ours = self.explorer.controls["vigilance"], self.controls["vigilance"]
        ours.min, ours.max, ours.step = theirs.min, theirs.max, theirs.step
        theirs.value = ours.value
        traitlets.link((theirs, "value"), (ours, "value"))
        # The robot's map is that of the recorded stream: what else the explorer offers would not
        # change it.
        for name in ("method", "cosine", "order", "eta", "n"):
            self.explorer.controls[name].layout.display = "none"
        ours.layout.display = "none"
        self.children = [self.explorer, *self.children]

    def _scene(self, **values: Any) -> Scene:
        robot, partition = self.robots[0], self.explorer.drawn
        counted = partition.fact.split(";")[0].split(",")[0]
        fact = f"{counted}; {robot.title}; {robot.brief}"
        return Scene(fact, [partition.panels[0], robot.still().panels[0]])


def vigilance_robot() -> LiveRobot:
    """Return the vigilance explorer above a robot that walks by its map: one vigilance for both.

    Returns
    -------
    LiveRobot
        Its ``controls["vigilance"]`` follows that of its ``explorer``, and leads it.

    References
    ----------
    Thesis, section 5.2.1, figures 5.9 to 5.16.

    Examples
    --------
    >>> both = vigilance_robot()
    >>> both.controls["vigilance"].value = 0.2
    >>> both
    104 categories at vigilance 0.2; the trained agent; cycle 0: left
    """
    return VigilanceRobot()
