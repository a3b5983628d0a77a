"""Figures 5.3, 5.5, 5.7 and 5.8: the field, what the robot sees of it, and how it walks on it.

References
----------
Thesis, sections 5.1 and 5.2.1.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_5_7(Figure().subplots())
the camera sees 0.497 rad (28.4°) to each side, the thesis takes 0.5 rad
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.field import Camera, Legs, World, bird_view, pitch, random_place
from arkaq_edu.field.camera import FIELD_OF_VIEW
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE, ROBOT_START, Placement
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style


class Picture(NamedTuple):
    """What `figure_5_3` and `plot_field` drew: a picture, with axes that measure it."""

    ax: Axes
    image: AxesImage

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or "the field from above"


class WalkPlot(NamedTuple):
    """What `figure_5_5` drew: the drift, the same without it, and walks that vary about it."""

    ax: Axes
    way: Line2D
    bodies: PolyCollection
    straight: Line2D
    reference: PolyCollection
    walks: LineCollection

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class PlacesPlot(NamedTuple):
    """What `figure_5_8` drew: the balls placed by eq 5.1, and those placed evenly."""

    ax: Axes
    panels: tuple[Axes, Axes]
    thesis: Line2D
    area: Line2D

    def __repr__(self) -> str:
        """Return what the two pictures state."""
        return "; ".join(panel.get_title(loc="left") for panel in self.panels)


def body_outline(x: float, y: float, heading: float) -> NDArray[np.float64]:
    """Return the corners of the robot's body from above, its nose last.

    Parameters
    ----------
    x, y : float
        Where it stands (mm).
    heading : float
        Where it looks (rad).

    Returns
    -------
    array, shape (5, 2)
        Corners (mm): a rectangle of 317 x 180 mm, pointed a little ahead.

    Examples
    --------
    >>> body_outline(0.0, 0.0, 0.0)[-1]
    array([158.5,   0. ])
    """
    length, width = pitch.ROBOT_LENGTH / 2, pitch.ROBOT_WIDTH / 2
    neck = length - width / 2
    corners = np.array([[neck, width], [-length, width], [-length, -width], [neck, -width]])
    c, s = math.cos(heading), math.sin(heading)
    return np.vstack([corners, [length, 0.0]]) @ np.array([[c, s], [-s, c]]) + [x, y]


def plot_bodies(poses: ArrayLike, ax: Axes | None = None, **look: Any) -> PolyCollection:
    """Draw the outline of the robot's body at one or more poses.

    Parameters
    ----------
    poses : array_like, shape (n, 3)
        x, y (mm) and heading (rad).
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    **look
        Passed to `matplotlib.collections.PolyCollection`.

    Returns
    -------
    matplotlib.collections.PolyCollection

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> len(plot_bodies([[0, 0, 0], [500, 0, 0.1]], Figure().subplots()).get_paths())
    2
    """
    ax = style.axes(ax) if ax is None else ax
    outlines = [body_outline(*pose) for pose in _checks.array("poses", poses, (None, 3)).tolist()]
    bodies = PolyCollection(outlines, **({"facecolors": "none", "edgecolors": style.INK} | look))
    ax.add_collection(bodies)
    return bodies


def plot_field(
    world: World,
    ax: Axes | None = None,
    *,
    title: str = "",
    trail: Sequence[tuple[float, float]] = (),
    sight: bool = False,
) -> Picture:
    """Draw the field from above, with millimeters along its sides.

    Parameters
    ----------
    world : World
        The field as it is now.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.
    trail : sequence of (x, y)
        Where the robot has been (mm).
    sight : bool
        Whether to show the camera's field of view.

    Returns
    -------
    Picture
        ``ax`` and ``image``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_field(World(rng=0), Figure().subplots(), title="kick-off")
    kick-off
    """
    ax = style.axes(
        ax, xlabel="x, toward the blue goal (mm)", ylabel="y, to the left (mm)", title=title
    )
    image = ax.imshow(bird_view(world, trail=trail, sight=sight), extent=EXTENT)
    ax.set(xticks=range(-3000, 3001, 1000), yticks=range(-2000, 2001, 1000))
    return Picture(ax, image)


def figure_5_3(ax: Axes | None = None, *, world: World | None = None) -> Picture:
    """Draw figure 5.3, what the camera sees.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    world : World, optional
        The field as it is now; by default the ball lies a good meter away, a little to the left.

    Returns
    -------
    Picture
        ``ax`` and ``image``.

    References
    ----------
    Thesis, section 5.1.2.1.

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
    ax = style.axes(
        ax,
        xlabel="column (pixel)",
        ylabel="row (pixel)",
        title=f"seen: {says}; true: {distance:,.0f} mm, {orientation:+.3f} rad",
    )
    return Picture(ax, ax.imshow(camera.picture(world)))


def figure_5_5(
    ax: Axes | None = None,
    *,
    cycles: int = 20,
    n: int = 12,
    rng: int | np.random.Generator = 0,
) -> WalkPlot:
    """Draw figure 5.5: the robot is told to walk straight, and drifts left and turns right.

    The drift is the gait's, the same in every walk; the footsteps vary about it.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    cycles : int
        Footstep cycles of 100 mm each.
    n : int
        Walks whose footsteps vary.
    rng : int or numpy.random.Generator
        Where the variation comes from.

    Returns
    -------
    WalkPlot
        ``way`` and ``bodies`` of the drift alone, ``straight`` and ``reference`` without it, and
        ``walks``, as the robot really walks.

    References
    ----------
    Thesis, section 5.1.3.1. It prints a picture and no number.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_5_5(Figure().subplots(), cycles=10, n=2)
    >>> x, y = plot.way.get_data()
    >>> len(x), bool(y[-1] > 0)
    (11, True)
    """
    rng = np.random.default_rng(rng)
    gait = Legs()
    meant = _straight_walk(cycles, World(rng=rng, legs=Legs(slide=0.0, pull=0.0, variation=0.0)))
    drift = _straight_walk(cycles, World(rng=rng, legs=replace(gait, variation=0.0)))
    walked = [_straight_walk(cycles, World(rng=rng, legs=gait))[:, :2] for _ in range(n)]
    x, y, heading = drift[-1]
    ax = style.axes(
        ax,
        xlabel="way ahead (mm)",
        ylabel="to the left (mm)",
        title=f'after {x / 1000:.1f} m "straight": drift {_side(y)}, {_turn(heading)}',
    )
    shown = slice(None, None, 5)
    (straight,) = ax.plot(*meant[:, :2].T, "--", color=style.QUIET, label="meant")
    reference = plot_bodies(meant[shown], ax, edgecolors=style.QUIET, linestyles="--")
    walks = LineCollection(walked, colors=style.OURS, lw=0.7, alpha=0.4, label=f"{n} walks")
    ax.add_collection(walks)
    (way,) = ax.plot(*drift[:, :2].T, color=style.OURS, lw=2, label="drift alone")
    bodies = plot_bodies(drift[shown], ax, edgecolors=style.OURS)
    ax.set(aspect="equal", xlim=(-250, meant[-1, 0] + 250), ylim=(-350, 550))
    ax.legend(loc="upper left", ncols=3, frameon=False)
    return WalkPlot(ax, way, bodies, straight, reference, walks)


def figure_5_7(ax: Axes | None = None) -> Picture:
    """Draw figure 5.7, the robot's field of view on the field.

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
    Thesis, section 5.2.1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> "0.497 rad" in figure_5_7(Figure().subplots()).ax.get_title(loc="left")
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
) -> PlacesPlot:
    """Draw figure 5.8: random places of the ball by eq 5.1, beside places even on the field.

    Equation 5.1 draws the depth evenly, and then the place across, so that every depth gets as
    many balls as any other; but the view is narrow where it is near. The density of balls falls
    as one over the depth.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        What is divided in two; fresh axes where it is None.
    n : int
        Balls in either half.
    rng : int or numpy.random.Generator
        Where the places come from.

    Returns
    -------
    PlacesPlot
        ``thesis`` and ``area``: the marks, each on axes of its own.

    References
    ----------
    Thesis, section 5.2.1, equation 5.1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> len(figure_5_8(Figure().subplots(), n=50).area.get_xdata())
    50
    """
    rng = np.random.default_rng(rng)
    n = _checks.integer("n", n, 1)
    ax = style.axes(ax)
    ax.axis("off")
    left, right = ax.inset_axes((0.0, 0.0, 0.46, 1.0)), ax.inset_axes((0.54, 0.0, 0.46, 1.0))
    thesis = _plot_places(left, "eq 5.1", "thesis", n, rng)
    area = _plot_places(right, "even", "area", n, rng)
    return PlacesPlot(ax, (left, right), thesis, area)


def _plot_places(
    ax: Axes, name: str, placement: Placement, n: int, rng: np.random.Generator
) -> Line2D:
    places = np.array([random_place(rng, placement=placement) for _ in range(n)])
    distance, orientation = places.T
    ax = style.axes(
        ax,
        xlabel="aside (mm), left is left",
        ylabel="ahead (mm)",
        title=f"{name}: {(distance < 1000).mean():.0%} within 1 m",
    )
    rim = np.linspace(-FIELD_OF_VIEW / 2, FIELD_OF_VIEW / 2, 30)
    border = MAX_BALL_DISTANCE * np.array([np.sin(rim), np.cos(rim)])
    ax.plot(*np.pad(border, ((0, 0), (1, 1))), color=style.QUIET, lw=1)
    (marks,) = ax.plot(
        distance * np.sin(orientation), distance * np.cos(orientation),
        "o", color=style.INK, markersize=1.6, markeredgewidth=0,
    )  # fmt: skip
    ax.set(aspect="equal", xlim=(2200, -2200), ylim=(0, 4300), xticks=(2000, 0, -2000))
    return marks


def _straight_walk(cycles: int, world: World) -> NDArray[np.float64]:
    """Return the poses of a walk of equal footsteps, counted from where it begins."""
    world.reset(ROBOT_START, (0.0, 1500.0))
    poses = [world.pose]
    for _ in range(_checks.integer("cycles", cycles, 1)):
        world.cycle(100.0, 100.0)
        poses.append(world.pose)
    return np.array(poses) - ROBOT_START


def _side(y: float) -> str:
    return f"{abs(y):.0f} mm to the {'left' if y > 0 else 'right'}"


def _turn(heading: float) -> str:
    return f"turned {abs(heading):.3f} rad to the {'left' if heading > 0 else 'right'}"
