"""Figures 5.16 to 5.30: what the agent learned, and its eleven trajectories to the ball.

References
----------
Thesis, section 5.2.2. It has pictures of trajectories and no numbers: where the ball is was chosen
here, see `arkaq_edu.experiments.approach.TRAJECTORY_STARTS`.

Examples
--------
>>> import numpy as np
>>> from matplotlib.figure import Figure
>>> centers = np.array([[0.0, -0.5], [0.0, 0.5]])
>>> plot = plot_policy(centers, [2, 1], Figure().subplots())
>>> plot.marks["left"].get_xdata()
array([0.25])
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.envs.ball_approach import ACTIONS
from arkaq_edu.experiments import approach, learning_curve
from arkaq_edu.experiments.approach.evaluation import Trajectory
from arkaq_edu.experiments.runs import policy_fact
from arkaq_edu.experiments.segmentation import in_view
from arkaq_edu.field import World
from arkaq_edu.field.supervisor import CLOSE_ENOUGH, STRAIGHT_ENOUGH
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import write
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.figures.field import plot_bodies, plot_field
from arkaq_edu.figures.segmentation import plot_cells

_UP = Path([(-0.2, -1), (-0.2, 0), (-0.7, 0), (0, 1), (0.7, 0), (0.2, 0), (0.2, -1), (-0.2, -1)])
#: A mark for each action: an arrow points where the action leads.
MARKERS: dict[str, Path | str] = {
    "forward": _UP,
    "left": _UP.transformed(Affine2D().rotate_deg(90)),
    "right": _UP.transformed(Affine2D().rotate_deg(-90)),
    "kick": "o",
}


def plot_policy(
    centers: ArrayLike, actions: ArrayLike, ax: Axes | None = None, *, title: str = ""
) -> Plot:
    """Draw the action of each state, in the robot's view.

    Parameters
    ----------
    centers : array_like, shape (S, 2)
        Centers of the states as scaled patterns (distance, orientation).
    actions : array_like of int, shape (S,)
        0 forward, 1 left, 2 right.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        What the picture shows.

    Returns
    -------
    Plot
        ``cells``, and ``marks``: by action, an arrow for each of its states.

    Raises
    ------
    ValueError
        If there is not one action for each state, or one that is not 0, 1 or 2.
    """
    places = in_view(centers)
    chosen = _checks.array("actions", actions, (len(places),))
    if not np.isin(chosen, range(len(ACTIONS))).all():
        raise ValueError(f"actions must be 0, 1 or 2, got {np.unique(chosen).tolist()}")
    ax = style.view_axes(ax, title=title)
    # The last two digits are the opacity: a quarter.
    area = plot_cells(centers, ax, [style.ACTIONS[ACTIONS[int(i)]] + "40" for i in chosen])
    marks = {
        action: plot_actions(places[chosen == number, 0], places[chosen == number, 1], action, ax)
        for number, action in enumerate(ACTIONS)
    }
    ax.legend(loc="upper center", ncols=3, frameon=False, borderaxespad=0.1)
    return Plot(ax, f"{len(places)} states", cells=area, marks=marks)


def plot_actions(x: ArrayLike, y: ArrayLike, action: str, ax: Axes, **look: Any) -> Line2D:
    """Draw an action's mark at places; `look` is passed to `matplotlib.axes.Axes.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_actions([0, 1], [2, 2], "left", Figure().subplots()).get_label()
    'left'
    """
    usual: dict[str, Any] = {"markersize": 8, "markeredgewidth": 0.3, "label": action}
    (marks,) = ax.plot(x, y, linestyle="none", color=style.ACTIONS[action], **(usual | look))
    marks.set(marker=MARKERS[action], markeredgecolor=style.INK)
    return marks


def figure_5_16(ax: Axes | None = None, *, agent: Arkaq | None = None) -> Plot:
    """Draw figure 5.16, the greedy action of each state.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    agent : Arkaq, optional
        A trained agent; by default the one that comes with the course.

    Returns
    -------
    Plot
        See `plot_policy`.

    Raises
    ------
    ValueError
        If the agent has not learned.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> sorted(figure_5_16(Figure().subplots()).marks)
    ['forward', 'left', 'right']
    """
    agent = approach.load_agent() if agent is None else agent
    if agent.q is None:
        raise ValueError("agent must have learned, got one without values")
    actions = agent.q.Q.argmax(axis=1)
    title = policy_fact(agent, actions, ACTIONS, "centers, vigilance")
    return plot_policy(agent.art.cluster_centers_, actions, ax, title=title)


def plot_learning(agent: Arkaq, ax: Axes | None = None, *, window: int = 50) -> Plot:
    """Draw how the reward of an episode grew while an agent of either task learned.

    Parameters
    ----------
    agent : Arkaq
        An agent that has learned.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    window : int
        Episodes over which the reward is averaged; see `arkaq_edu.experiments.learning_curve`.

    Returns
    -------
    Plot
        ``curve``, the mean reward; ``switch``, the cycle at which exploitation starts.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> x, y = plot_learning(approach.load_agent(), Figure().subplots()).curve.get_data()
    >>> bool(y[-1] > y[0])
    True
    """
    cycles, reward = learning_curve(agent, window)
    title = f"reward of {window} episodes: {reward[0]:.0f} at first, {reward[-1]:.0f} at the end"
    ylabel = f"reward of an episode, mean of {window}"
    ax = style.axes(ax, xlabel="cycle of Q-learning", ylabel=ylabel, title=title)
    (curve,) = ax.plot(cycles, reward, color=style.OURS)
    switch = ax.axvline(agent.learning.exploration, color=style.QUIET, ls="--", lw=1)
    low, high = min(0.0, reward.min() - 5), 155 if agent.task == "approach" else 105
    ax.text(agent.learning.exploration, low + 2, " exploits from here", color=style.QUIET)
    ax.set(ylim=(low, high), xlim=(0, None))
    return Plot(ax, curve=curve, switch=switch)


def plot_view(walked: Trajectory, ax: Axes | None = None, *, title: str = "") -> Plot:
    """Draw a trajectory in the robot's view: the ball comes down the picture.

    Parameters
    ----------
    walked : Trajectory
        See `arkaq_edu.experiments.approach.record_episode`.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        What the picture shows; by default the trajectory's summary.

    Returns
    -------
    Plot
        ``truth`` (line), ``sightings`` (hollow) and ``estimates``: by action, an arrow at each
        look, where the robot believed the ball to be when it took that action.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_view(approach.trajectory(1), Figure().subplots())
    >>> sorted(plot.estimates)
    ['forward', 'left', 'right']
    """
    looks = walked.table
    ax = style.view_axes(ax, title=title or walked.summary)
    _draw_end(ax)
    (truth,) = ax.plot(looks.orientation, looks.distance, color=style.QUIET, lw=1, label="true")
    estimates = {}
    for number, action in enumerate(ACTIONS):
        then = looks[looks.action == number]
        place = then.estimated_orientation, then.estimated_distance
        estimates[action] = plot_actions(*place, action, ax, label=f"estimate, then {action}")
    look = {"markersize": 5, "markeredgewidth": 0.8, "label": "seen"}
    sightings = style.measurements(looks.seen_orientation, looks.seen_distance, ax, **look)
    ax.legend(loc="best", fontsize="small", frameon=False)
    return Plot(ax, truth=truth, sightings=sightings, estimates=estimates)


def _draw_end(ax: Axes) -> None:
    """Mark where the walk ends: within 500 mm, and there the strip that earns the +50."""
    _, right = ax.get_xlim()
    ax.axhline(CLOSE_ENOUGH, color=style.QUIET, lw=0.8, ls=":")
    look = {"fontsize": "small", "va": "top", "color": style.QUIET}
    write(ax, (right, CLOSE_ENOUGH), "reached ", ha="right", **look)
    corner, width = (-STRAIGHT_ENOUGH, 0), 2 * STRAIGHT_ENOUGH
    ax.add_patch(Rectangle(corner, width, CLOSE_ENOUGH, color=style.CELLS[4], lw=0))
    write(ax, (0, CLOSE_ENOUGH / 2), "+50", fontsize="small", color="black")


def plot_above(walked: Trajectory, ax: Axes | None = None, *, title: str = "") -> Plot:
    """Draw a trajectory on the field from above, with the straight line to the ball.

    Parameters
    ----------
    walked : Trajectory
        See `arkaq_edu.experiments.approach.record_episode`.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        What the picture shows; by default the trajectory's summary.

    Returns
    -------
    Plot
        ``path``, ``bodies`` (one at every fifth look) and ``straight``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_above(approach.trajectory(1), Figure().subplots())
    >>> len(plot.path.get_xdata()) == len(approach.trajectory(1).table)
    True
    """
    looks = walked.table
    last = looks.iloc[-1]
    world = World(rng=0)
    world.reset((last.x, last.y, last.heading), (last.ball_x, last.ball_y))
    ax = plot_field(world, ax, title=title or walked.summary).ax
    line = [looks.x.iloc[0], last.ball_x], [looks.y.iloc[0], last.ball_y]
    (straight,) = ax.plot(*line, "--", color="white", lw=1, label="straight line")
    (path,) = ax.plot(looks.x, looks.y, color="white", lw=2, label="path")
    bodies = plot_bodies(looks[["x", "y", "heading"]].iloc[:-1:5], ax, edgecolors="white")
    ax.legend(loc="lower right", fontsize="small", labelcolor="white", facecolor="#2c5f3a")
    return Plot(ax, path=path, bodies=bodies, straight=straight)


#: The trajectory of each figure, in the robot's view or from above.
_IN_VIEW = {
    "5.17": 1, "5.18": 2, "5.19": 3, "5.20": 4, "5.21": 5, "5.22": 6, "5.24": 7, "5.25": 8,
    "5.26": 9, "5.28": 10, "5.30": 11,
}  # fmt: skip
_FROM_ABOVE = {"5.23": 6, "5.27": 9, "5.29": 10}


def _trajectory_figure(figure: str, number: int, plot: Callable[..., Plot]) -> Callable[..., Plot]:
    def draw(ax: Axes | None = None, *, agent: Arkaq | None = None) -> Plot:
        walked = approach.trajectory(number, agent)
        return plot(walked, ax, title=f"trajectory {number}, {walked.summary}")

    above = " from above" if plot is plot_above else ""
    draw.__name__ = "figure_" + figure.replace(".", "_")
    draw.__doc__ = f"Draw figure {figure}, trajectory {number}{above}; see `{plot.__name__}`."
    return draw


#: The functions that draw figures 5.17 to 5.30, by number.
TRAJECTORIES = {
    figure: _trajectory_figure(figure, number, plot)
    for table, plot in ((_IN_VIEW, plot_view), (_FROM_ABOVE, plot_above))
    for figure, number in table.items()
}
