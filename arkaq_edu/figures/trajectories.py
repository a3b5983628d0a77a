"""Figures 5.17 to 5.30: the eleven walks to the ball, in the robot's view and from above.

References
----------
Thesis, section 5.2.2. It prints pictures and no number: where the ball lies is chosen here, see
`arkaq_edu.experiments.STARTS`.

Examples
--------
>>> from matplotlib.figure import Figure
>>> plot = figure_5_17(Figure().subplots())
>>> len(plot.truth.get_xdata()) == len(plot.sightings.get_xdata())
True
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.envs.ball_approach import ACTIONS
from arkaq_edu.experiments import STARTS, Walk, load_agent, walk
from arkaq_edu.field import World
from arkaq_edu.field.supervisor import CLOSE_ENOUGH, STRAIGHT_ENOUGH
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.field import plot_bodies, plot_field
from arkaq_edu.figures.policy import MARKERS


class ViewPlot(NamedTuple):
    """What `plot_view` drew: where the ball was, was seen, and was believed to be."""

    ax: Axes
    truth: Line2D
    sightings: Line2D
    estimates: dict[str, Line2D]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or "the ball in the robot's view"


class AbovePlot(NamedTuple):
    """What `plot_above` drew: the way walked, the bodies on it, and the straight way."""

    ax: Axes
    way: Line2D
    bodies: PolyCollection
    straight: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or "the walk from above"


def trajectory(number: int, agent: Arkaq | None = None) -> Walk:
    """Walk one of the eleven trajectories.

    Parameters
    ----------
    number : int
        From 1 to 11.
    agent : Arkaq, optional
        Who walks; the course's trained agent where it is None.

    Returns
    -------
    Walk

    Examples
    --------
    >>> trajectory(1).is_success
    True
    """
    number = _checks.integer("number", number, 1, len(STARTS))
    return walk(load_agent() if agent is None else agent, *STARTS[number - 1])


def plot_view(way: Walk, ax: Axes | None = None, *, title: str = "") -> ViewPlot:
    """Draw a walk as the robot lives it: the ball comes down the view.

    Parameters
    ----------
    way : Walk
        The walk.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states; by default how the walk went.

    Returns
    -------
    ViewPlot
        ``truth`` (line), ``sightings`` (hollow) and ``estimates``: by action, an arrow at each
        look, where the robot believed the ball to be and with what it did then.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_view(trajectory(1), Figure().subplots())
    >>> sorted(plot.estimates)
    ['forward', 'left', 'right']
    """
    looks = way.table
    ax = style.view_axes(ax, title=title or how_it_went(way))
    _draw_goal(ax)
    (truth,) = ax.plot(looks.orientation, looks.distance, color=style.QUIET, lw=1, label="true")
    estimates = {}
    for number, action in enumerate(ACTIONS):
        then = looks[looks.action == number]
        (estimates[action],) = ax.plot(
            then.estimated_orientation, then.estimated_distance, linestyle="none",
            marker=MARKERS[action], markersize=8, color=style.ACTIONS[action],
            markeredgecolor=style.INK, markeredgewidth=0.3, label=f"estimate, then {action}",
        )  # fmt: skip
    sightings = style.measurements(
        looks.seen_orientation, looks.seen_distance, ax, markersize=5, markeredgewidth=0.8,
        label="seen",
    )  # fmt: skip
    ax.legend(loc="best", fontsize="small", frameon=False)
    return ViewPlot(ax, truth, sightings, estimates)


def plot_above(way: Walk, ax: Axes | None = None, *, title: str = "") -> AbovePlot:
    """Draw a walk on the field from above, beside the straight way.

    Parameters
    ----------
    way : Walk
        The walk.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states; by default how the walk went.

    Returns
    -------
    AbovePlot
        ``way``, ``bodies`` (one at every fifth look) and ``straight``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_above(trajectory(1), Figure().subplots())
    >>> len(plot.way.get_xdata()) == len(trajectory(1).table)
    True
    """
    looks = way.table
    last = looks.iloc[-1]
    world = World(rng=0)
    world.reset((last.x, last.y, last.heading), (last.ball_x, last.ball_y))
    ax = plot_field(world, ax, title=title or how_it_went(way)).ax
    white = "#ffffff"
    (straight,) = ax.plot(
        [looks.x.iloc[0], last.ball_x], [looks.y.iloc[0], last.ball_y], "--", color=white, lw=1,
        label="straight way",
    )  # fmt: skip
    (line,) = ax.plot(looks.x, looks.y, color=white, lw=2, label="way walked")
    bodies = plot_bodies(looks[["x", "y", "heading"]].iloc[:-1:5], ax, edgecolors=white)
    ax.legend(loc="lower right", fontsize="small", labelcolor="white", facecolor="#2c5f3a")
    return AbovePlot(ax, line, bodies, straight)


def how_it_went(way: Walk) -> str:
    """Say from where a walk began, how long the way was, and what it earned.

    Examples
    --------
    >>> how_it_went(trajectory(1)).split(":")[0]
    'from 1,200 mm, straight ahead'
    """
    first, last = way.table.iloc[0], way.table.iloc[-1]
    aside = f"{abs(first.orientation):.2f} rad {'left' if first.orientation > 0 else 'right'}"
    where = "straight ahead" if round(first.orientation, 2) == 0 else aside
    end = "the ball is not reached"
    if way.is_success:
        walked = np.hypot(way.table.x.diff(), way.table.y.diff()).sum()
        detour = walked / (first.distance - last.distance)
        end = f"{detour:.2f} × the straight way, +{way.reward:g}"
    return f"from {first.distance:,.0f} mm, {where}: {end}"


def figure_5_17(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.17, trajectory 1; see `plot_view`."""
    return _view(1, ax, agent)


def figure_5_18(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.18, trajectory 2; see `plot_view`."""
    return _view(2, ax, agent)


def figure_5_19(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.19, trajectory 3; see `plot_view`."""
    return _view(3, ax, agent)


def figure_5_20(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.20, trajectory 4; see `plot_view`."""
    return _view(4, ax, agent)


def figure_5_21(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.21, trajectory 5; see `plot_view`."""
    return _view(5, ax, agent)


def figure_5_22(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.22, trajectory 6; see `plot_view`."""
    return _view(6, ax, agent)


def figure_5_23(ax: Axes | None = None, *, agent: Arkaq | None = None) -> AbovePlot:
    """Draw figure 5.23, trajectory 6 from above; see `plot_above`."""
    return _above(6, ax, agent)


def figure_5_24(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.24, trajectory 7; see `plot_view`."""
    return _view(7, ax, agent)


def figure_5_25(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.25, trajectory 8; see `plot_view`."""
    return _view(8, ax, agent)


def figure_5_26(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.26, trajectory 9; see `plot_view`."""
    return _view(9, ax, agent)


def figure_5_27(ax: Axes | None = None, *, agent: Arkaq | None = None) -> AbovePlot:
    """Draw figure 5.27, trajectory 9 from above; see `plot_above`."""
    return _above(9, ax, agent)


def figure_5_28(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.28, trajectory 10; see `plot_view`."""
    return _view(10, ax, agent)


def figure_5_29(ax: Axes | None = None, *, agent: Arkaq | None = None) -> AbovePlot:
    """Draw figure 5.29, trajectory 10 from above; see `plot_above`."""
    return _above(10, ax, agent)


def figure_5_30(ax: Axes | None = None, *, agent: Arkaq | None = None) -> ViewPlot:
    """Draw figure 5.30, trajectory 11; see `plot_view`."""
    return _view(11, ax, agent)


def _view(number: int, ax: Axes | None, agent: Arkaq | None) -> ViewPlot:
    way = trajectory(number, agent)
    return plot_view(way, ax, title=f"trajectory {number}, {how_it_went(way)}")


def _above(number: int, ax: Axes | None, agent: Arkaq | None) -> AbovePlot:
    way = trajectory(number, agent)
    return plot_above(way, ax, title=f"trajectory {number}, {how_it_went(way)}")


def _draw_goal(ax: Axes) -> None:
    """Mark where the walk ends: nearer than 500 mm, and there the strip that earns the +50."""
    _, right = ax.get_xlim()
    ax.axhline(CLOSE_ENOUGH, color=style.QUIET, lw=0.8, ls=":")
    ax.text(
        right, CLOSE_ENOUGH, "reached ", ha="right", va="top", fontsize="small", color=style.QUIET
    )
    strip = Rectangle(
        (-STRAIGHT_ENOUGH, 0), 2 * STRAIGHT_ENOUGH, CLOSE_ENOUGH, color=style.CELLS[4], lw=0
    )
    ax.add_patch(strip)
    ax.text(0, CLOSE_ENOUGH / 2, "+50", ha="center", va="center", fontsize="small")
