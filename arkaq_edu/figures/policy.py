"""Figure 5.16: what the agent does, state by state; and how it came to know it.

References
----------
Thesis, section 5.2.2 and figure 5.16.

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

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.envs.ball_approach import ACTIONS
from arkaq_edu.experiments.segmentation import (
    DISTANCE,
    ORIENTATION,
    THESIS_COUNTS,
    in_view,
    map_of,
)
from arkaq_edu.figures.drawing import style

_UP = Path([(-0.2, -1), (-0.2, 0), (-0.7, 0), (0, 1), (0.7, 0), (0.2, 0), (0.2, -1), (-0.2, -1)])
#: An arrow for each action, which points where the action leads.
MARKERS = {
    "forward": _UP,
    "left": _UP.transformed(Affine2D().rotate_deg(90)),
    "right": _UP.transformed(Affine2D().rotate_deg(-90)),
}


class PolicyPlot(NamedTuple):
    """What `plot_policy` drew: the states' cells, and for each action its arrows."""

    ax: Axes
    cells: PolyCollection
    marks: dict[str, Line2D]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or f"{len(self.cells.get_paths())} states"


class LearningPlot(NamedTuple):
    """What `plot_learning` drew: the mean reward, and where exploitation begins."""

    ax: Axes
    curve: Line2D
    switch: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def plot_policy(
    centers: ArrayLike, actions: ArrayLike, ax: Axes | None = None, *, title: str = ""
) -> PolicyPlot:
    """Draw which action is taken in each state, in the robot's view.

    Parameters
    ----------
    centers : array_like, shape (S, 2)
        Centers of the states as scaled patterns (distance, orientation).
    actions : array_like of int, shape (S,)
        0 forward, 1 left, 2 right.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.

    Returns
    -------
    PolicyPlot
        ``ax``, ``cells`` and ``marks``: an arrow a state, by action.

    Raises
    ------
    ValueError
        If there is not one action a state, or one that is not 0, 1 or 2.
    """
    polygons, _ = map_of(centers)
    chosen = _checks.array("actions", actions, (len(polygons),))
    if not np.isin(chosen, range(len(ACTIONS))).all():
        raise ValueError(f"actions must be 0, 1 or 2, got {np.unique(chosen).tolist()}")
    ax = style.view_axes(ax, title=title)
    # The two last digits are the opacity: a quarter.
    shades = [style.ACTIONS[ACTIONS[int(action)]] + "40" for action in chosen]
    area = style.cells(polygons, shades, ax)
    (left, right), (near, far) = ORIENTATION, DISTANCE
    area.set_clip_path(Rectangle((left, near), right - left, far - near, transform=ax.transData))
    places = in_view(centers)
    marks = {}
    for number, action in enumerate(ACTIONS):
        (marks[action],) = ax.plot(
            *places[chosen == number].T, linestyle="none", marker=MARKERS[action], markersize=8,
            color=style.ACTIONS[action], markeredgecolor=style.INK, markeredgewidth=0.3,
            label=action,
        )  # fmt: skip
    ax.legend(loc="upper center", ncols=3, frameon=False, borderaxespad=0.1)
    return PolicyPlot(ax, area, marks)


def figure_5_16(ax: Axes | None = None, *, agent: Arkaq | None = None) -> PolicyPlot:
    """Draw figure 5.16, the greedy action of each state.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    agent : Arkaq, optional
        A trained agent; the course's own where it is None.

    Returns
    -------
    PolicyPlot

    Raises
    ------
    ValueError
        If the agent has not learned yet.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> sorted(figure_5_16(Figure().subplots()).marks)
    ['forward', 'left', 'right']
    """
    from arkaq_edu.experiments import load_agent  # brings the whole field with it

    agent = load_agent() if agent is None else agent
    if agent.q is None:
        raise ValueError("agent must have learned, got one without values")
    actions = agent.q.Q.argmax(axis=1)
    parts = ", ".join(f"{(actions == i).sum()} {action}" for i, action in enumerate(ACTIONS))
    printed = THESIS_COUNTS.get(agent.vigilance)
    beside = "" if printed is None else f" (thesis {printed})"
    title = f"{len(actions)} states{beside} at vigilance {agent.vigilance:g}: {parts}"
    return plot_policy(agent.art.cluster_centers_, actions, ax, title=title)


def plot_learning(agent: Arkaq, ax: Axes | None = None, *, window: int = 50) -> LearningPlot:
    """Draw how the reward of an episode grew while the agent learned.

    Parameters
    ----------
    agent : Arkaq
        An agent that has learned.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    window : int
        Episodes over which the reward is averaged.

    Returns
    -------
    LearningPlot
        ``curve``: the mean reward of the last `window` episodes, by cycles of Q-learning;
        ``switch``: the cycle at which exploitation takes the place of exploration.

    Raises
    ------
    ValueError
        If the agent has been through fewer episodes than `window`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from arkaq_edu.experiments import load_agent
    >>> x, y = plot_learning(load_agent(), Figure().subplots()).curve.get_data()
    >>> bool(y[-1] > y[0])
    True
    """
    episodes = [episode for episode in agent.history if episode[0] == "Q-learning"]
    window = _checks.integer("window", window, 1, len(episodes))
    cycles = np.cumsum([cycles for _, cycles, _, _ in episodes])
    rewards = np.array([reward for _, _, reward, _ in episodes])
    mean = np.convolve(rewards, np.full(window, 1 / window), "valid")
    ax = style.axes(
        ax,
        xlabel="cycle of Q-learning",
        ylabel=f"reward of an episode, mean of {window}",
        title=f"reward of {window} episodes: {mean[0]:.0f} at first, {mean[-1]:.0f} at the end",
    )
    (curve,) = ax.plot(cycles[window - 1 :], mean, color=style.OURS)
    start = agent.learning.exploration
    switch = ax.axvline(start, color=style.QUIET, ls="--", lw=1)
    low, high = min(0.0, mean.min() - 5), 155 if rewards.max() > 100 else 105  # of either task
    ax.text(start, low + 2, " exploits from here", color=style.QUIET)
    ax.set(ylim=(low, high), xlim=(0, None))
    return LearningPlot(ax, curve, switch)
