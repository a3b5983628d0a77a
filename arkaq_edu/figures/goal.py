"""Figures 5.35 to 5.37 and 5.39 to 5.41: the goal problem.

Its states lie on a line, the orientation of the goal. Left of the robot is left in the picture.

References
----------
Thesis, section 5.3.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_5_36(Figure().subplots(), patterns=[[0.0], [0.03], [0.5]])
2 centers at vigilance 0.06, the thesis printed 13
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq, Sensing
from arkaq_edu.envs.score_goal import ACTIONS
from arkaq_edu.experiments import goal, thesis_numbers
from arkaq_edu.experiments.goal.task import Distance
from arkaq_edu.experiments.runs import policy_fact
from arkaq_edu.figures.approach import plot_actions
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.plot import Plot

#: Each action's color and mark: those of the way in which it turns the robot, or of the kick.
MARKS = {"turn left": "left", "turn right": "right", "kick": "kick"}
_STRIP = 0.3  # height of the cells in the picture
_TOP = {"near": 90, "far": 55}  # of the picture, in goals in 100 kicks


def plot_line(
    centers: ArrayLike, patterns: ArrayLike, ax: Axes | None = None, *, title: str = ""
) -> Plot:
    """Draw centers and their cells on a line, below how often each orientation was seen.

    Parameters
    ----------
    centers : array_like, shape (S, 1)
        Centers as scaled orientations.
    patterns : array_like, shape (n, 1)
        The stream that the centers come from.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        What the picture shows.

    Returns
    -------
    Plot
        ``seen`` (a histogram), ``cells`` and ``centers``.
    """
    patterns = _checks.array("patterns", patterns, (None, 1))
    middles, ends = goal.cells(centers)
    ax = _line_axes(ax, title)
    area = _draw_cells(ends, [style.CELLS[2 * (i % 2)] for i in range(len(middles))], ax)
    heights = np.full(len(middles), _STRIP / 2)
    (dots,) = ax.plot(middles, heights, "o", color=style.INK, ms=5, clip_on=False)
    # A pattern at the end of the interval was clipped: the goal is somewhere beyond.
    inside = Sensing.goal().unscale(patterns[np.abs(patterns[:, 0]) < 1])
    counts, edges = np.histogram(inside, bins=100, range=(-0.5, 0.5))
    tops = _STRIP + 0.05 + (0.85 - _STRIP) * counts / max(1, counts.max())
    seen = ax.stairs(tops, edges, baseline=_STRIP + 0.05, fill=True, color=style.QUIET)
    words = "how often seen (ends left out)"
    ax.text(0.49, 0.98, words, va="top", color=style.QUIET, fontsize="small")
    return Plot(ax, f"{len(middles)} centers", seen=seen, cells=area, centers=dots)


def plot_segmentation(
    vigilance: float, ax: Axes | None = None, *, patterns: ArrayLike | None = None
) -> Plot:
    """Draw the centers of a stream, with their number in the thesis and here.

    Parameters
    ----------
    vigilance : float
        A pattern farther than this from all centers becomes a new center.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    patterns : array_like, shape (n, 1), optional
        Scaled orientations in their order; by default the recorded stream.

    Returns
    -------
    Plot
        See `plot_line`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_segmentation(0.3, Figure().subplots(), patterns=[[0.0], [0.25], [1.0]])
    2 centers at vigilance 0.3
    """
    patterns = goal.patterns(goal.load_sightings()) if patterns is None else patterns
    centers = goal.find_centers(vigilance, patterns)
    return plot_line(centers, patterns, ax, title=goal.count_fact(len(centers), vigilance))


def figure_5_35(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.35, the centers at vigilance 0.075; see `plot_segmentation`."""
    return plot_segmentation(0.075, ax, **options)


def figure_5_36(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.36, the centers at vigilance 0.06; see `plot_segmentation`."""
    return plot_segmentation(0.06, ax, **options)


def figure_5_37(ax: Axes | None = None, **options: Any) -> Plot:
    """Draw figure 5.37, the centers at vigilance 0.05; see `plot_segmentation`."""
    return plot_segmentation(0.05, ax, **options)


def figure_5_39(ax: Axes | None = None, *, goal_agent: Arkaq | None = None) -> Plot:
    """Draw figure 5.39, the greedy action of each orientation.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    goal_agent : Arkaq, optional
        A trained agent; by default the one that comes with the course.

    Returns
    -------
    Plot
        ``cells``, and ``marks`` by action.

    Raises
    ------
    ValueError
        If the agent has not learned, or has learned another task.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> sorted(figure_5_39(Figure().subplots()).marks)
    ['kick', 'turn left', 'turn right']
    """
    agent = goal.load_agent() if goal_agent is None else goal_agent
    if agent.q is None or agent.task != "goal":
        raise ValueError("goal_agent must have learned to score")
    middles, ends = goal.cells(agent.art.cluster_centers_)
    order = np.argsort(-agent.art.cluster_centers_.ravel())
    chosen = agent.q.Q.argmax(axis=1)[order]
    ax = _line_axes(ax, policy_fact(agent, chosen, ACTIONS, "goal centers, vigilance"))
    # The last two digits are the opacity: a quarter.
    area = _draw_cells(ends, [style.ACTIONS[MARKS[ACTIONS[i]]] + "40" for i in chosen], ax)
    look = {"markersize": 10, "markeredgewidth": 0.4, "clip_on": False}
    marks = {}
    for number, action in enumerate(ACTIONS):
        x = middles[chosen == number]
        y = np.full(len(x), _STRIP / 2)
        marks[action] = plot_actions(x, y, MARKS[action], ax, label=action, **look)
    ax.set_ylim(0, 1.4 * _STRIP)
    ax.legend(loc="upper center", ncols=3, frameon=False)
    return Plot(ax, cells=area, marks=marks)


def plot_scores(
    goal_distance: Distance, ax: Axes | None = None, *, study: pd.DataFrame | None = None
) -> Plot:
    """Draw goals in a hundred kicks against kicks: learning, at random, and the best policy.

    Parameters
    ----------
    goal_distance : {"near", "far"}
        Where the robot stands.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    study : DataFrame, optional
        See `arkaq_edu.experiments.goal.study`; by default the one that comes with the course.

    Returns
    -------
    Plot
        ``means`` of ARKAQ, random actions and the oracle; ``bands`` of the first two (one
        standard deviation over the seeds); ``best``, which no policy exceeds but by luck;
        ``thesis`` (hollow, only near, else None).
    """
    mean, std = goal.mean_curves(goal.load_study() if study is None else study, goal_distance)
    learners = ("ARKAQ", "random actions")
    said = [
        f"{who} from {mean[who].iloc[:2].mean():.0f} to {mean[who].iloc[-4:].mean():.0f} %"
        for who in learners
    ]
    title = f"{goal_distance}: {', '.join(said)}"
    ax = style.axes(ax, xlabel="kicks", ylabel="goals in 100 kicks", title=title)
    curves = {who: (mean[who].index, mean[who], std[who]) for who in learners}
    means, bands = style.bands(ax, curves, (style.OURS, style.ACTIONS["left"]))
    end = float(mean["ARKAQ"].index[-1])
    oracle, limit = mean["oracle"].mean(), 100 * goal.best_policy(goal_distance).goals
    (means["oracle"],) = ax.plot([0, end], [oracle] * 2, "--", color=style.QUIET, lw=1.2)
    means["oracle"].set_label("oracle")
    (best,) = ax.plot([0, end], [limit] * 2, ":", color=style.INK, label="best there is")
    thesis = None
    if goal_distance == "near":
        printed = [thesis_numbers()[f"goals (%), near, {who}"] for who in learners]
        thesis = style.measurements([end] * 2, printed, ax, markersize=8, clip_on=False)
        thesis.set_label("thesis")
    ax.set(xlim=(0, end), ylim=(0, _TOP[goal_distance]))
    ax.legend(loc="upper left", ncols=3, frameon=False, fontsize="small")
    return Plot(ax, means=means, bands=bands, best=best, thesis=thesis)


def figure_5_40(ax: Axes | None = None, *, study: pd.DataFrame | None = None) -> Plot:
    """Draw figure 5.40, goals against kicks from near; see `plot_scores`."""
    return plot_scores("near", ax, study=study)


def figure_5_41(ax: Axes | None = None, *, study: pd.DataFrame | None = None) -> Plot:
    """Draw figure 5.41, goals against kicks from far, not straight; see `plot_scores`."""
    return plot_scores("far", ax, study=study)


def _line_axes(ax: Axes | None, title: str) -> Axes:
    ax = style.axes(ax, xlabel="goal to the left  |  to the right (rad)", title=title)
    ax.set(xlim=style.VIEW_ORIENTATION, ylim=(0, 1), yticks=[])
    ax.spines["left"].set_visible(False)
    return ax


def _draw_cells(ends: NDArray[np.float64], colors: list[str], ax: Axes) -> PolyCollection:
    strips = [np.array([(a, 0.0), (b, 0.0), (b, _STRIP), (a, _STRIP)]) for a, b in pairwise(ends)]
    return style.cells(strips, colors, ax)
