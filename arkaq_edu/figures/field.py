"""Figures 5.1 to 5.5, 5.7, 5.8 and 5.31 to 5.33: the field, the robot's eye, its walk, its kick.

References
----------
Thesis, sections 5.1, 5.2.1 and 5.3.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_5_7(Figure().subplots())
the camera sees 0.497 rad (28.4°) to each side, the thesis takes 0.5 rad
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator, StrMethodFormatter
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.experiments.kicks import first_miss, photograph_kick, ready_to_kick
from arkaq_edu.field import Camera, Legs, World, bird_view, motion, pitch, random_place
from arkaq_edu.field.camera import FIELD_OF_VIEW, fit_power
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE, ROBOT_START
from arkaq_edu.field.view import EXTENT, body_outline
from arkaq_edu.field.world import LONGEST_FOOTSTEP
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Place, blank, box, frame, wire, words
from arkaq_edu.figures.drawing.plot import Plot

#: The modules of figure 5.4: their places, and whether the thesis's experiments use them.
MODULES: dict[str, tuple[Place, bool]] = {
    "vision": ((1.0, 2.6), True), "localization": ((3.4, 2.6), False),
    "planner": ((5.8, 2.6), False), "motion": ((8.2, 2.6), True),
    "communication": ((4.6, 3.9), False), "ARKAQ": ((4.6, 1.1), True),
}  # fmt: skip
#: The settings of figure 5.2: left and right footstep (mm), head (rad).
SETTINGS = (90.0, 110.0, -0.3)

_NEAR_GOAL = (1000.0, 3000.0, -700.0, 700.0)  # what figures 5.31 to 5.33 show (mm)


def plot_bodies(poses: ArrayLike, ax: Axes | None = None, **look: Any) -> PolyCollection:
    """Draw the outline of the robot's body at each pose.

    Parameters
    ----------
    poses : array_like, shape (n, 3)
        x, y (mm) and heading (rad).
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    **look
        Passed to `matplotlib.collections.PolyCollection`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> len(plot_bodies([[0, 0, 0], [500, 0, 0.1]], Figure().subplots()).get_paths())
    2
    """
    ax = ax or style.axes()
    outlines = [body_outline(*pose) for pose in _checks.array("poses", poses, (None, 3)).tolist()]
    bodies = PolyCollection(outlines, facecolors="none", **({"edgecolors": style.INK} | look))
    ax.add_collection(bodies)
    return bodies


def plot_field(
    world: World, ax: Axes | None = None, *, title: str = "", sight: bool = False
) -> Plot:
    """Draw the field from above, with axes in millimeters.

    Parameters
    ----------
    world : World
        The field as it is now.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        The fact that the picture states.
    sight : bool
        Whether to show the camera's field of view.

    Returns
    -------
    Plot
        With the ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_field(World(rng=0), Figure().subplots(), title="kick-off")
    kick-off
    """
    xlabel, ylabel = "x, toward the blue goal (mm)", "y, to the left (mm)"
    ax = style.axes(ax, xlabel=xlabel, ylabel=ylabel, title=title)
    image = ax.imshow(bird_view(world, sight=sight), extent=EXTENT)
    ax.set(xticks=range(-3000, 3001, 1000), yticks=range(-2000, 2001, 1000))
    return Plot(ax, "the field from above", image=image)


def figure_5_1(ax: Axes | None = None) -> Plot:
    """Draw figure 5.1, the field with robot, ball and goal.

    Returns
    -------
    Plot
        With the ``image``, and ``names``: an annotation for each of robot, ball and goal.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> list(figure_5_1(Figure().subplots()).names)
    ['robot', 'ball', 'goal']
    """
    world = World(rng=0)
    world.reset((-1500.0, -300.0, 0.3), (300.0, 700.0))
    plot = plot_field(world, ax, title="the robot's world, 6,000 x 4,000 mm, from above")
    goal = pitch.LENGTH / 2 - pitch.BOX_DEPTH / 2, 0.0  # beside it, where a name has room
    places = {"robot": world.pose[:2], "ball": world.ball, "goal": goal}
    names = {}
    for name, place in places.items():
        below = 0, 0 if name == "goal" else -22
        look = {"va": "center", "color": "white", "fontsize": 9}
        names[name] = style.tag(plot.ax, place, name, below, **look)
    return Plot(plot.ax, image=plot.image, names=names)


def figure_5_2(ax: Axes | None = None) -> Plot:
    """Draw figure 5.2, the control panel; `arkaq_edu.widgets.control_panel` is the live one.

    Returns
    -------
    Plot
        With ``handles``, one for each setting, and the pictures ``eye`` and ``above``: what the
        robot sees after five steps and a look with these settings, and the field from above.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> float(figure_5_2(Figure().subplots()).handles["head (rad)"].get_xdata()[0])
    -0.3
    """
    left, right, head = SETTINGS
    world = World(rng=0)
    world.reset((-800.0, -500.0, 0.0), (1000.0, 300.0))
    trail = motion.footstep_path(world, left, right, cycles=5)[:, :2].tolist()
    motion.look(world, head)
    ax = style.axes(ax, title=f"five steps of {left:.0f} and {right:.0f} mm, then a look aside")
    ax.axis("off")
    sliders = (
        ("left stride (mm)", left, LONGEST_FOOTSTEP),
        ("right stride (mm)", right, LONGEST_FOOTSTEP),
        ("head (rad)", head, world.head.reach),
    )
    handles = {}
    for row, (name, value, end) in enumerate(sliders):
        handles[name] = _plot_slider(ax, 0.93 - 0.13 * row, name, value, end)
    eye, above = ax.inset_axes((0.0, 0.0, 0.4, 0.54)), ax.inset_axes((0.42, 0.0, 0.58, 0.54))
    eye.axis("off")
    above.axis("off")
    picture = eye.imshow(Camera().picture(world))
    map_ = above.imshow(bird_view(world, trail=trail), extent=EXTENT)
    return Plot(ax, handles=handles, eye=picture, above=map_)


def _plot_slider(ax: Axes, y: float, name: str, value: float, end: float) -> Line2D:
    rail = ax.inset_axes((0.26, y - 0.01, 0.66, 0.02))
    rail.spines[["left", "right", "top"]].set_visible(False)
    rail.set(xlim=(-end, end), ylim=(0, 1), yticks=[], xticks=(-end, 0, end))
    rail.tick_params(labelsize="x-small", length=2, pad=1)
    ax.text(0.0, y, name, va="center", fontsize=9, transform=ax.transAxes)
    (handle,) = rail.plot([value], [0], "o", color=style.OURS, clip_on=False)
    return handle


def figure_5_3(ax: Axes | None = None, *, world: World | None = None) -> Plot:
    """Draw figure 5.3, what the camera sees.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    world : World, optional
        The field as it is now; by default the ball lies a little over a meter away, to the left.

    Returns
    -------
    Plot
        With the ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_3(Figure().subplots()).image.get_size()
    (160, 208)
    """
    if world is None:
        world = World(rng=0)
        world.reset(ROBOT_START, (-1300.0, 250.0))
    camera = Camera()
    seen, (distance, orientation) = camera.sighting(world), world.ball_from_robot()
    says = "no ball" if seen is None else f"{seen.distance:,.0f} mm, {seen.orientation:+.3f} rad"
    title = f"seen: {says}; true: {distance:,.0f} mm, {orientation:+.3f} rad"
    ax = style.axes(ax, xlabel="column (pixel)", ylabel="row (pixel)", title=title)
    return Plot(ax, image=ax.imshow(camera.picture(world)))


def figure_5_4(ax: Axes | None = None) -> Plot:
    """Draw figure 5.4, the modules of the Cerberus code, and which of them the thesis bypasses.

    Returns
    -------
    Plot
        With ``parts`` by name and ``wires`` by (from, to).

    References
    ----------
    Thesis, section 5.1.2. The wires between the modules are ours.

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
    routes: dict[tuple[str, str], tuple[Place, ...]] = {
        ("vision", "localization"): ((1.75, 2.6), (2.6, 2.6)),
        ("localization", "planner"): ((4.2, 2.6), (5.0, 2.6)),
        ("planner", "motion"): ((6.6, 2.6), (7.45, 2.6)),
        ("communication", "planner"): ((5.4, 3.9), (5.8, 3.9), (5.8, 2.95)),
        ("vision", "ARKAQ"): ((1.0, 2.25), (1.0, 1.1), (3.85, 1.1)),
        ("ARKAQ", "motion"): ((5.35, 1.1), (8.2, 1.1), (8.2, 2.25)),
    }
    wires = {ends: wire(ax, *corners) for ends, corners in routes.items()}
    for ends, arrow in wires.items():
        if "ARKAQ" not in ends:
            arrow.set(color=style.QUIET, linestyle="--", linewidth=0.8)
    words(ax, (2.4, 0.75), "distance, orientation")
    words(ax, (6.9, 0.75), "footsteps, kick")
    words(ax, (0.2, 3.9), "dashed: bypassed", "left", style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


def figure_5_5(
    ax: Axes | None = None, *, cycles: int = 20, n: int = 12, rng: int | np.random.Generator = 0
) -> Plot:
    """Draw figure 5.5: told to walk straight, the robot drifts left and turns right.

    The drift belongs to the gait and is the same in every walk. The footsteps vary around it.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    cycles : int
        Number of footstep cycles, of 100 mm each.
    n : int
        Number of walks whose footsteps vary.
    rng : int or numpy.random.Generator
        Source of that variation.

    Returns
    -------
    Plot
        ``walked`` and ``bodies`` show the drift alone, ``straight`` and ``reference`` a walk
        without it, and ``walks`` the walks that vary.

    References
    ----------
    Thesis, section 5.1.3.1. It prints a picture and no number.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_5_5(Figure().subplots(), cycles=10, n=2)
    >>> x, y = plot.walked.get_data()
    >>> len(x), bool(y[-1] > 0)
    (11, True)
    """
    rng, legs = _checks.generator("rng", rng), Legs()
    n = _checks.integer("n", n, 1, 1000)
    perfect, drifting = Legs(slide=0.0, pull=0.0, variation=0.0), replace(legs, variation=0.0)
    meant = motion.straight_walk(World(rng=rng, legs=perfect), cycles)
    drift = motion.straight_walk(World(rng=rng, legs=drifting), cycles)
    varied = [motion.straight_walk(World(rng=rng, legs=legs), cycles)[:, :2] for _ in range(n)]
    x, y, heading = drift[-1]
    aside = f"{abs(y):.0f} mm to the {'left' if y > 0 else 'right'}"
    turned = f"turned {abs(heading):.3f} rad to the {'left' if heading > 0 else 'right'}"
    title = f'after {x / 1000:.1f} m "straight": drift {aside}, {turned}'
    ax = style.axes(ax, xlabel="way ahead (mm)", ylabel="to the left (mm)", title=title)
    (straight,) = ax.plot(*meant[:, :2].T, "--", color=style.QUIET, label="meant")
    reference = plot_bodies(meant[::5], ax, edgecolors=style.QUIET, linestyles="--")
    walks = LineCollection(varied, colors=style.OURS, lw=0.7, alpha=0.4, label=f"{n} walks")
    ax.add_collection(walks)
    (walked,) = ax.plot(*drift[:, :2].T, color=style.OURS, lw=2, label="drift alone")
    bodies = plot_bodies(drift[::5], ax, edgecolors=style.OURS)
    ax.set(aspect="equal", xlim=(-250, meant[-1, 0] + 250), ylim=(-350, 550))
    ax.legend(loc="upper left", ncols=3, frameon=False)
    drawn: dict[str, Any] = {"walked": walked, "bodies": bodies, "straight": straight}
    return Plot(ax, reference=reference, walks=walks, **drawn)


def figure_5_7(ax: Axes | None = None) -> Plot:
    """Draw figure 5.7, the robot's field of view on the field.

    Returns
    -------
    Plot
        With the ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> "0.497 rad" in repr(figure_5_7(Figure().subplots()))
    True
    """
    world = World(rng=0)
    world.reset(ROBOT_START, (-200.0, 500.0))
    half = FIELD_OF_VIEW / 2
    title = (
        f"the camera sees {half:.3f} rad ({math.degrees(half):.1f}°) to each side, "
        "the thesis takes 0.5 rad"
    )
    return plot_field(world, ax, title=title, sight=True)


def figure_5_8(
    ax: Axes | None = None, *, n: int = 1000, rng: int | np.random.Generator = 0
) -> Plot:
    """Draw figure 5.8: places of the ball drawn by eq 5.1, beside places uniform on the field.

    Equation 5.1 draws the depth uniformly, and then the place across. So each depth gets equally
    many balls, although the view is narrow where it is near: the density of balls falls as one
    over the depth.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Axes to divide in two; by default new ones.
    n : int
        Number of balls in each half.
    rng : int or numpy.random.Generator
        Source of the places.

    Returns
    -------
    Plot
        ``thesis`` and ``area`` are the marks, each on its own axes in ``panels``.

    References
    ----------
    Thesis, section 5.2.1, equation 5.1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> len(figure_5_8(Figure().subplots(), n=50).area.get_xdata())
    50
    """
    rng, n = _checks.generator("rng", rng), _checks.integer("n", n, 1)
    ax = style.axes(ax)
    ax.axis("off")
    left, right = ax.inset_axes((0.0, 0.0, 0.46, 1.0)), ax.inset_axes((0.54, 0.0, 0.46, 1.0))
    thesis = _plot_places(left, "eq 5.1", [random_place(rng, placement="thesis") for _ in range(n)])
    area = _plot_places(right, "even", [random_place(rng) for _ in range(n)])
    fact = "; ".join(panel.get_title(loc="left") for panel in (left, right))
    return Plot(ax, fact, panels=(left, right), thesis=thesis, area=area)


def _plot_places(ax: Axes, name: str, drawn: list[tuple[float, float]]) -> Line2D:
    distance, orientation = np.array(drawn).T
    title = f"{name}: {(distance < 1000).mean():.0%} within 1 m"
    ax = style.axes(ax, xlabel="to the left | to the right (mm)", ylabel="ahead (mm)", title=title)
    rim = np.linspace(-FIELD_OF_VIEW / 2, FIELD_OF_VIEW / 2, 30)
    border = MAX_BALL_DISTANCE * np.array([np.sin(rim), np.cos(rim)])
    ax.plot(*np.pad(border, ((0, 0), (1, 1))), color=style.QUIET, lw=1)
    places = distance * np.array([np.sin(orientation), np.cos(orientation)])
    (marks,) = ax.plot(*places, "o", color=style.INK, markersize=1.6, markeredgewidth=0)
    ax.set(aspect="equal", xlim=(2200, -2200), ylim=(0, 4300), xticks=(2000, 0, -2000))
    ax.xaxis.set_major_formatter(lambda x, _: f"{abs(x):,.0f}")
    return marks


def figure_5_31(ax: Axes | None = None) -> Plot:
    """Draw figure 5.31: the supervisor has put the ball before the paw.

    Returns
    -------
    Plot
        With the ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_31(Figure().subplots())
    ready: 246 mm to the ball, 1,400 mm to the goal
    """
    world = ready_to_kick(seed=0)
    to_ball, _ = world.ball_from_robot()
    to_goal = pitch.LENGTH / 2 - world.pose[0]
    title = f"ready: {to_ball:.0f} mm to the ball, {to_goal:,.0f} mm to the goal"
    return _plot_near_goal(ax, bird_view(world, sight=False, region=_NEAR_GOAL), title)


def figure_5_32(ax: Axes | None = None, *, after: float = 0.25) -> Plot:
    """Draw figure 5.32: the paw has swung, and the ball is rolling.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    after : float
        Time since the swing began (s), in [0, 3]. At .06 the paw is still swinging.

    Returns
    -------
    Plot
        With the ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_32(Figure().subplots(), after=0.05)
    kicking, after 0.05 s: the paw is on its way
    """
    picture, rolled = photograph_kick(after, region=_NEAR_GOAL)
    done = f"the ball has rolled {rolled:,.0f} mm" if rolled > 0.0 else "the paw is on its way"
    return _plot_near_goal(ax, picture, f"kicking, after {after:g} s: {done}")


def figure_5_33(ax: Axes | None = None) -> Plot:
    """Draw figure 5.33, a missed goal: the first miss of a robot that aims at the middle.

    Returns
    -------
    Plot
        With the ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_5_33(Figure().subplots())
    missed: the ball lies 1,243 mm from the robot, not in the goal
    """
    world, path = first_miss()
    distance, _ = world.ball_from_robot()
    title = f"missed: the ball lies {distance:,.0f} mm from the robot, not in the goal"
    picture = bird_view(world, sight=False, ball_trail=path, region=_NEAR_GOAL)
    return _plot_near_goal(ax, picture, title)


def _plot_near_goal(ax: Axes | None, pixels: NDArray[np.uint8], title: str) -> Plot:
    ax = style.axes(ax, xlabel="x (mm)", ylabel="y (mm)", title=title)
    return Plot(ax, image=ax.imshow(pixels, extent=_NEAR_GOAL))


def plot_kicks(measured: pd.DataFrame, simulated: pd.DataFrame, ax: Axes | None = None) -> Plot:
    """Draw where kicked balls came to rest: hollow for a real robot, filled for ours.

    Parameters
    ----------
    measured, simulated : DataFrame
        One row per kick: x ahead and y to the left (mm).
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        With the marks ``measured`` and ``simulated``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> one = pd.DataFrame({"x": [2000.0], "y": [100.0]})
    >>> plot_kicks(one, one, Figure().subplots())
    1 kick of a real robot, 1 simulated
    """
    count = f"{len(measured)} kick{'s' * (len(measured) != 1)}"
    title = f"{count} of a real robot, {len(simulated)} simulated"
    ax = style.axes(ax, xlabel="ahead (mm)", ylabel="to the left (mm)", title=title)
    (ours,) = ax.plot(simulated.x, simulated.y, "o", color=style.OURS, label="simulated")
    ours.set(markersize=4, markeredgewidth=0)
    theirs = style.measurements(measured.x, measured.y, ax, markersize=6, label="real")
    ax.plot(0, 0, "+", color=style.INK, markersize=10)
    ax.set(aspect="equal", xlim=(-200, 4500), ylim=(-1900, 1900))
    ax.legend(loc="lower left", frameon=False)
    return Plot(ax, measured=theirs, simulated=ours)


def plot_distance_error(
    distance: ArrayLike, error: ArrayLike, ax: Axes | None = None, *, pixels: float = 0.05
) -> Plot:
    """Draw how the error of the distance grows, with a power of the distance fitted to it.

    Parameters
    ----------
    distance, error : array_like, shape (n,)
        Distances (mm), and the standard deviation of the distance seen at each (mm), > 0.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    pixels : float
        Error of the blob's radius (pixels), for the line of an ideal camera.

    Returns
    -------
    Plot
        The marks ``measured``, the lines ``fit`` and ``pinhole``, and the ``exponent``.

    References
    ----------
    Not in the thesis; see `arkaq_edu.field.Camera.distance_error`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_distance_error([1000, 2000], [10, 40], Figure().subplots())
    the error goes as distance to the power 2.00
    """
    x = _checks.array("distance", distance, (None,))
    y = _checks.array("error", error, (len(x),))
    exponent, factor = fit_power(x, y)
    title = f"the error goes as distance to the power {exponent:.2f}"
    ylabel = "error of the distance seen (mm)"
    ax = style.axes(ax, xlabel="distance (mm)", ylabel=ylabel, title=title)
    along = np.geomspace(x.min(), x.max(), 30)
    (fit,) = ax.plot(along, factor * along**exponent, color=style.OURS, label="fit")
    (pinhole,) = ax.plot(along, Camera().distance_error(along, pixels), "--", color=style.QUIET)
    pinhole.set_label(f"pinhole, {pixels:g} pixels off")
    marks = style.measurements(x, y, ax, label="measured")
    ax.set(xscale="log", yscale="log")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(StrMethodFormatter("{x:,g}"))
        axis.set_minor_locator(NullLocator())
    ax.legend(frameon=False)
    return Plot(ax, measured=marks, fit=fit, pinhole=pinhole, exponent=exponent)
