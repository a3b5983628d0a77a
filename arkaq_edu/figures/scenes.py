"""Figures 5.1, 5.2, 5.4 and 5.31 to 5.33: the field and its robot; what makes the robot; a kick.

References
----------
Thesis, sections 5.1 and 5.3.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_5_1(Figure().subplots())
the robot's world, 6,000 x 4,000 mm, from above
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.text import Annotation
from matplotlib.ticker import LogLocator, NullLocator, StrMethodFormatter
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.field import Camera, GoalSupervisor, World, bird_view, motion, pitch
from arkaq_edu.field.camera import FOCAL_LENGTH
from arkaq_edu.field.view import EXTENT
from arkaq_edu.field.world import LONGEST_FOOTSTEP
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Diagram, Place, blank, box, frame, wire, words
from arkaq_edu.figures.field import Picture, plot_field

#: The modules of figure 5.4, where they stand, and whether the thesis's experiments use them.
MODULES: dict[str, tuple[Place, bool]] = {
    "vision": ((1.0, 2.6), True),
    "localization": ((3.4, 2.6), False),
    "planner": ((5.8, 2.6), False),
    "motion": ((8.2, 2.6), True),
    "communication": ((4.6, 3.9), False),
    "ARKAQ": ((4.6, 1.1), True),
}
#: What figure 5.2's robot has been told: left and right stride (mm), head (rad).
TOLD = (90.0, 110.0, -0.3)

_KICK_AT = 1400.0  # mm before the goal: figures 5.31 to 5.33
_NEAR_GOAL = (1000.0, 3000.0, -700.0, 700.0)


class Setup(NamedTuple):
    """What `figure_5_1` drew: the field from above, and the names of what is on it."""

    ax: Axes
    image: AxesImage
    names: dict[str, Annotation]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class ControlPanel(NamedTuple):
    """What `figure_5_2` drew: three rails with a handle each, the camera's picture, the field."""

    ax: Axes
    handles: dict[str, Line2D]
    eye: AxesImage
    above: AxesImage

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class Kicks(NamedTuple):
    """What `plot_kicks` drew: where the balls came to rest."""

    ax: Axes
    measured: Line2D
    simulated: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class ErrorPlot(NamedTuple):
    """What `plot_distance_error` drew: the error measured, the line fitted to it, the pinhole's."""

    ax: Axes
    measured: Line2D
    fit: Line2D
    pinhole: Line2D
    exponent: float

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def figure_5_1(ax: Axes | None = None) -> Setup:
    """Draw figure 5.1, the field with robot, ball and goal.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Setup
        ``image``, and ``names``: an annotation each for robot, ball and goal.

    References
    ----------
    Thesis, section 5.1.1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> list(figure_5_1(Figure().subplots()).names)
    ['robot', 'ball', 'goal']
    """
    world = World(rng=0)
    world.reset((-1500.0, -300.0, 0.3), (300.0, 700.0))
    picture = plot_field(world, ax, title="the robot's world, 6,000 x 4,000 mm, from above")
    goal = pitch.LENGTH / 2 - pitch.BOX_DEPTH / 2, 0.0  # beside it, where there is room for a name
    places = {"robot": world.pose[:2], "ball": world.ball, "goal": goal}
    names = {}
    for name, (x, y) in places.items():
        offset = (0, 0) if name == "goal" else (0, -22)
        names[name] = picture.ax.annotate(
            name, (x, y), xytext=offset, textcoords="offset points", ha="center", va="center",
            color="white", fontsize=9,
        )  # fmt: skip
    return Setup(picture.ax, picture.image, names)


def figure_5_2(ax: Axes | None = None) -> ControlPanel:
    """Draw figure 5.2, the control panel; `arkaq_edu.widgets.control_panel` is the live one.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        What is divided; fresh axes where it is None.

    Returns
    -------
    ControlPanel
        ``handles``: for each of the rails where it is set; ``eye`` and ``above``: the pictures
        after five steps and a look with that setting.

    References
    ----------
    Thesis, section 5.1.1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> float(figure_5_2(Figure().subplots()).handles["head (rad)"].get_xdata()[0])
    -0.3
    """
    left, right, head = TOLD
    world = World(rng=0)
    world.reset((-800.0, -500.0, 0.0), (1000.0, 300.0))
    trail = [world.pose[:2]]
    for _ in range(5):
        world.cycle(left, right)
        trail.append(world.pose[:2])
    motion.look(world, head)
    ax = style.axes(ax, title=f"five steps of {left:.0f} and {right:.0f} mm, then a look aside")
    ax.axis("off")
    rails = {
        "left stride (mm)": (left, LONGEST_FOOTSTEP),
        "right stride (mm)": (right, LONGEST_FOOTSTEP),
        "head (rad)": (head, world.head.reach),
    }
    handles = {}
    for row, (name, (value, end)) in enumerate(rails.items()):
        rail = ax.inset_axes((0.26, 0.92 - 0.13 * row, 0.66, 0.02))
        rail.spines[["left", "right", "top"]].set_visible(False)
        rail.set(xlim=(-end, end), ylim=(0, 1), yticks=[], xticks=(-end, 0, end))
        rail.tick_params(labelsize="x-small", length=2, pad=1)
        ax.text(0.0, 0.93 - 0.13 * row, name, va="center", fontsize=9, transform=ax.transAxes)
        (handles[name],) = rail.plot([value], [0], "o", color=style.OURS, clip_on=False)
    pictures = []
    for place, pixels, limits in (
        ((0.0, 0.0, 0.4, 0.54), Camera().picture(world), None),
        ((0.42, 0.0, 0.58, 0.54), bird_view(world, trail=trail), EXTENT),
    ):
        inset = ax.inset_axes(place)
        inset.axis("off")
        pictures.append(inset.imshow(pixels, extent=limits))
    return ControlPanel(ax, handles, *pictures)


def figure_5_4(ax: Axes | None = None) -> Diagram:
    """Draw figure 5.4, the modules of the Cerberus code, and which of them the thesis bypasses.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Diagram

    References
    ----------
    Thesis, section 5.1.2. Which wires there are between the modules is ours.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_4(Figure().subplots())
    of five modules two are used, vision and motion; ARKAQ takes the place of the planner
    """
    title = "of five modules two are used, vision and motion; ARKAQ takes the place of the planner"
    ax = blank(ax, title, (0.0, 9.2), (0.5, 4.5))
    parts = {}
    for name, (place, used) in MODULES.items():
        if used:
            parts[name] = box(ax, place, name, width=1.5)
        else:
            frame(ax, (place[0] - 0.8, place[1] - 0.35), 1.6, 0.7)
            parts[name] = words(ax, place, name, color=style.QUIET)
    (vision, planner, arkaq), motion_in = ((1.0, 2.25), (5.8, 3.0), (4.6, 1.1)), (8.2, 2.25)
    routes: dict[tuple[str, str], tuple[Place, ...]] = {
        ("vision", "localization"): ((1.75, 2.6), (2.6, 2.6)),
        ("localization", "planner"): ((4.2, 2.6), (5.0, 2.6)),
        ("planner", "motion"): ((6.6, 2.6), (7.45, 2.6)),
        ("communication", "planner"): ((5.4, 3.9), (planner[0], 3.9), (planner[0], 2.95)),
        ("vision", "ARKAQ"): (vision, (vision[0], arkaq[1]), (3.85, arkaq[1])),
        ("ARKAQ", "motion"): ((5.35, arkaq[1]), (motion_in[0], arkaq[1]), motion_in),
    }
    wires = {}
    for ends, corners in routes.items():
        wires[ends] = wire(ax, *corners)
        if "ARKAQ" not in ends:
            wires[ends].set(color=style.QUIET, linestyle="--", linewidth=0.8)
    words(ax, (2.4, 0.75), "distance, orientation")
    words(ax, (6.9, 0.75), "footsteps, kick")
    words(ax, (0.2, 3.9), "dashed: bypassed", "left", style.QUIET)
    return Diagram(ax, parts, wires)


def figure_5_31(ax: Axes | None = None) -> Picture:
    """Draw figure 5.31: the supervisor has put the ball before the paw.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Picture
        ``ax`` and ``image``.

    References
    ----------
    Thesis, sections 5.1.3.3 and 5.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_31(Figure().subplots()).ax.get_title(loc="left").split(":")[0]
    'ready'
    """
    world = _ready(seed=0)
    distance, _ = world.ball_from_robot()
    title = f"ready: {distance:.0f} mm to the ball, {_KICK_AT:,.0f} mm to the goal"
    return _shot(ax, bird_view(world, sight=False, region=_NEAR_GOAL), title)


def figure_5_32(ax: Axes | None = None, *, after: float = 0.25) -> Picture:
    """Draw figure 5.32: the paw has swung, and the ball is on its way.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    after : float
        How long after the beginning of the swing (s), in [0, 3]; with .06 the paw is still on its
        way.

    Returns
    -------
    Picture
        ``ax`` and ``image``.

    References
    ----------
    Thesis, section 5.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_32(Figure().subplots(), after=0.05).ax.get_title(loc="left")
    'kicking, after 0.05 s: the paw is on its way'
    """
    _checks.number("after", after, 0, 3)  # the ball rolls longer
    world, shots = _ready(seed=0), list[tuple[NDArray[np.uint8], float]]()
    begin, trail = world.time, [world.ball]

    def watch() -> None:
        trail.append(world.ball)
        if world.time - begin >= after and not shots:
            picture = bird_view(world, sight=False, ball_trail=trail, region=_NEAR_GOAL)
            shots.append((picture, math.dist(trail[0], trail[-1])))

    world.watch = watch
    motion.kick(world)
    picture, rolled = shots[0]
    done = f"the ball has rolled {rolled:,.0f} mm" if rolled > 0.0 else "the paw is on its way"
    return _shot(ax, picture, f"kicking, after {after:g} s: {done}")


def figure_5_33(ax: Axes | None = None) -> Picture:
    """Draw figure 5.33, a missed goal: the first miss of a robot that aims at the middle.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Picture
        ``ax`` and ``image``.

    References
    ----------
    Thesis, section 5.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_33(Figure().subplots()).ax.get_title(loc="left").split(":")[0]
    'missed'
    """
    judge, scored, seed = GoalSupervisor(_KICK_AT), True, -1
    while scored:
        seed += 1
        world = _ready(seed)
        trail = motion.kick(world)
        scored = judge.judge(world).is_success
    distance, _ = world.ball_from_robot()
    title = f"missed: the ball lies {distance:,.0f} mm from the robot, not in the goal"
    picture = bird_view(world, sight=False, ball_trail=trail, region=_NEAR_GOAL)
    return _shot(ax, picture, title)


def _ready(seed: int) -> World:
    world, supervisor = World(rng=seed), GoalSupervisor(_KICK_AT)
    supervisor.place(world, 0.0)
    supervisor.set_ball(world)
    return world


def _shot(ax: Axes | None, pixels: NDArray[np.uint8], title: str) -> Picture:
    ax = style.axes(ax, xlabel="x (mm)", ylabel="y (mm)", title=title)
    return Picture(ax, ax.imshow(pixels, extent=_NEAR_GOAL))


def plot_kicks(measured: pd.DataFrame, simulated: pd.DataFrame, ax: Axes | None = None) -> Kicks:
    """Draw where kicked balls came to rest: hollow those of a real robot, filled our own.

    Parameters
    ----------
    measured, simulated : DataFrame
        A row a kick; x ahead and y aside (mm).
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Kicks

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> one = pd.DataFrame({"x": [2000.0], "y": [100.0]})
    >>> plot_kicks(one, one, Figure().subplots())
    1 kick of a real robot, 1 simulated
    """
    count = f"{len(measured)} kick{'s' * (len(measured) != 1)}"
    ax = style.axes(
        ax, xlabel="ahead (mm)", ylabel="to the left (mm)",
        title=f"{count} of a real robot, {len(simulated)} simulated",
    )  # fmt: skip
    (ours,) = ax.plot(
        simulated.x, simulated.y, "o", color=style.OURS, markersize=4, markeredgewidth=0,
        label="simulated",
    )  # fmt: skip
    theirs = style.measurements(measured.x, measured.y, ax, markersize=6, label="real")
    ax.plot(0, 0, "+", color=style.INK, markersize=10)
    ax.set(aspect="equal", xlim=(-200, 4500), ylim=(-1900, 1900))
    ax.legend(loc="lower left", frameon=False)
    return Kicks(ax, theirs, ours)


def plot_distance_error(
    distance: ArrayLike, error: ArrayLike, ax: Axes | None = None, *, pixels: float = 0.05
) -> ErrorPlot:
    """Draw how the error of a distance seen grows, and fit a power of the distance to it.

    Parameters
    ----------
    distance : array_like, shape (n,)
        Distances (mm), > 0.
    error : array_like, shape (n,)
        Standard deviation of the distance seen at each (mm), > 0.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    pixels : float
        Error of the blob's radius that the pinhole's line is drawn for (pixels).

    Returns
    -------
    ErrorPlot
        With the ``exponent`` of the power.

    References
    ----------
    Not in the thesis. A pinhole sees a ball of radius r at distance d with a radius of f r / d
    pixels; an error of s pixels there is an error of s d^2 / (f r) in d.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_distance_error([1000, 2000], [10, 40], Figure().subplots())
    the error goes as distance to the power 2.00
    """
    x = _checks.array("distance", distance, (None,))
    y = _checks.array("error", error, (len(x),))
    exponent, height = np.polyfit(np.log(x), np.log(y), 1)
    ax = style.axes(
        ax, xlabel="distance (mm)", ylabel="error of the distance seen (mm)",
        title=f"the error goes as distance to the power {exponent:.2f}",
    )  # fmt: skip
    along = np.geomspace(x.min(), x.max(), 30)
    (fit,) = ax.plot(along, np.exp(height) * along**exponent, color=style.OURS, label="fit")
    of_pinhole = pixels * along**2 / (FOCAL_LENGTH * pitch.BALL_RADIUS)
    (pinhole,) = ax.plot(
        along, of_pinhole, "--", color=style.QUIET, label=f"pinhole, {pixels:g} pixels off"
    )
    marks = style.measurements(x, y, ax, label="measured")
    ax.set(xscale="log", yscale="log")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(StrMethodFormatter("{x:,g}"))
        axis.set_minor_locator(NullLocator())
    ax.legend(frameon=False)
    return ErrorPlot(ax, marks, fit, pinhole, float(exponent))
