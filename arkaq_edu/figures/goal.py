"""Figures 5.35 to 5.37 and 5.39 to 5.41: the goal problem.

Its states lie on a line, the orientation of the goal: left of the robot is left in the picture.

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
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq, Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART
from arkaq_edu.envs.score_goal import ACTIONS
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.policy import MARKERS

#: The numbers of centers the thesis prints, by vigilance (figures 5.35 to 5.37).
THESIS_COUNTS = {0.075: 9, 0.06: 13, 0.05: 18}

#: The shares of kicks that score, per cent, as the thesis says them of figure 5.40.
THESIS_RATES = {"ARKAQ": 60, "random actions": 35}

#: The mark of each action: where it turns the robot, or the ball.
MARKS = {
    "turn left": ("left", MARKERS["left"]),
    "turn right": ("right", MARKERS["right"]),
    "kick": ("kick", "o"),
}
_SENSING = Sensing.goal()
_STRIP = 0.3


class LinePlot(NamedTuple):
    """What `plot_line` drew: how often each orientation was seen, the cells, and the centers."""

    ax: Axes
    seen: StepPatch
    cells: PolyCollection
    centers: Line2D

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left") or f"{len(self.cells.get_paths())} centers"


class LinePolicyPlot(NamedTuple):
    """What `figure_5_39` drew: the states' cells, and for each action its marks."""

    ax: Axes
    cells: PolyCollection
    marks: dict[str, Line2D]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class ScoresPlot(NamedTuple):
    """What `plot_scores` drew: mean and band of who kicks, the best there is, and the thesis."""

    ax: Axes
    means: dict[str, Line2D]
    bands: dict[str, FillBetweenPolyCollection]
    best: Line2D
    thesis: Line2D | None

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def line_cells(centers: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return centers from left to right (rad), and the ends of their cells.

    Parameters
    ----------
    centers : array_like, shape (S, 1)
        Centers as scaled orientations.

    Returns
    -------
    middles : array, shape (S,)
        Orientations of the centers (rad), the leftmost, so the greatest, first.
    ends : array, shape (S + 1,)
        Where the cells meet, and where the outer ones end: at .5 and -.5.

    Examples
    --------
    >>> line_cells([[-0.4], [0.8], [0.0]])
    (array([ 0.4,  0. , -0.2]), array([ 0.5,  0.2, -0.1, -0.5]))
    """
    centers = _checks.array("centers", centers, (None, 1))
    middles = np.sort(_SENSING.unscale(centers).ravel())[::-1]
    between = (middles[1:] + middles[:-1]) / 2
    return middles, np.concatenate([_SENSING.high, between, _SENSING.low])


def plot_line(
    centers: ArrayLike, patterns: ArrayLike, ax: Axes | None = None, *, title: str = ""
) -> LinePlot:
    """Draw centers and their cells on a line, under how often each orientation was seen.

    Parameters
    ----------
    centers : array_like, shape (S, 1)
        Centers as scaled orientations.
    patterns : array_like, shape (n, 1)
        The stream that founded them.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.

    Returns
    -------
    LinePlot
    """
    patterns = _checks.array("patterns", patterns, (None, 1))
    middles, ends = line_cells(centers)
    ax = _line_axes(ax, title)
    colors = [style.CELLS[2 * (i % 2)] for i in range(len(middles))]
    area = style.cells(_strips(ends), colors, ax)
    (dots,) = ax.plot(
        middles, np.full(len(middles), _STRIP / 2), "o", color=style.INK, ms=5, clip_on=False
    )
    inside = _SENSING.unscale(patterns[np.abs(patterns) < 1])  # what was clipped is anywhere
    counts, edges = np.histogram(inside, bins=100, range=(-0.5, 0.5))
    tops = _STRIP + 0.05 + (0.85 - _STRIP) * counts / max(1, counts.max())
    seen = ax.stairs(tops, edges, baseline=_STRIP + 0.05, fill=True, color=style.QUIET)
    ax.text(0.49, 0.98, "how often seen", va="top", color=style.QUIET, fontsize="small")
    return LinePlot(ax, seen, area, dots)


def plot_segmentation(
    vigilance: float, ax: Axes | None = None, *, patterns: ArrayLike | None = None
) -> LinePlot:
    """Segment a stream of orientations and draw the centers, with the thesis's count and ours.

    Parameters
    ----------
    vigilance : float
        Distance, between scaled orientations, from which on a pattern founds a center.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    patterns : array_like, shape (n, 1), optional
        Scaled orientations in their order; the recorded stream where it is None.

    Returns
    -------
    LinePlot

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_segmentation(0.3, Figure().subplots(), patterns=[[0.0], [0.25], [1.0]])
    2 centers at vigilance 0.3
    """
    if patterns is None:
        from arkaq_edu.experiments import goal  # brings the whole field with it

        patterns = goal.patterns(goal.load_orientations())
    rate = TrainingSettings.goal().learning_rate
    centers = EuclideanART(vigilance, rate).fit(patterns).cluster_centers_
    n, printed = len(centers), THESIS_COUNTS.get(vigilance)
    beside = "" if printed is None else f", the thesis printed {printed}"
    title = f"{n} center{'s' if n > 1 else ''} at vigilance {vigilance:g}{beside}"
    return plot_line(centers, patterns, ax, title=title)


def figure_5_35(ax: Axes | None = None, **options: Any) -> LinePlot:
    """Draw figure 5.35, the centers at vigilance 0.075; see `plot_segmentation`."""
    return plot_segmentation(0.075, ax, **options)


def figure_5_36(ax: Axes | None = None, **options: Any) -> LinePlot:
    """Draw figure 5.36, the centers at vigilance 0.06; see `plot_segmentation`."""
    return plot_segmentation(0.06, ax, **options)


def figure_5_37(ax: Axes | None = None, **options: Any) -> LinePlot:
    """Draw figure 5.37, the centers at vigilance 0.05; see `plot_segmentation`."""
    return plot_segmentation(0.05, ax, **options)


def figure_5_39(ax: Axes | None = None, *, goal_agent: Arkaq | None = None) -> LinePolicyPlot:
    """Draw figure 5.39, the greedy action of each orientation.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    goal_agent : Arkaq, optional
        An agent that has learned to score; the course's own where it is None.

    Returns
    -------
    LinePolicyPlot

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
    if goal_agent is None:
        from arkaq_edu.experiments import goal

        goal_agent = goal.load_agent()
    if goal_agent.q is None or goal_agent.task != "goal":
        raise ValueError("goal_agent must have learned to score")
    middles, ends = line_cells(goal_agent.art.cluster_centers_)
    order = np.argsort(-goal_agent.art.cluster_centers_.ravel())
    chosen = goal_agent.q.Q.argmax(axis=1)[order]
    parts = ", ".join(f"{(chosen == i).sum()} {action}" for i, action in enumerate(ACTIONS))
    printed = THESIS_COUNTS.get(goal_agent.vigilance)
    beside = "" if printed is None else f" (thesis {printed})"
    title = f"{len(chosen)} states{beside} at vigilance {goal_agent.vigilance:g}: {parts}"
    ax = _line_axes(ax, title)
    colors = [style.ACTIONS[MARKS[ACTIONS[i]][0]] for i in chosen]
    # The two last digits are the opacity: a quarter.
    area = style.cells(_strips(ends), [color + "40" for color in colors], ax)
    marks = {}
    for number, action in enumerate(ACTIONS):
        name, marker = MARKS[action]
        places = middles[chosen == number]
        (marks[action],) = ax.plot(
            places, np.full(len(places), _STRIP / 2), linestyle="none", marker=marker,
            markersize=10, color=style.ACTIONS[name], markeredgecolor=style.INK,
            markeredgewidth=0.4, clip_on=False, label=action,
        )  # fmt: skip
    ax.set_ylim(0, 1.4 * _STRIP)
    ax.legend(loc="upper center", ncols=3, frameon=False)
    return LinePolicyPlot(ax, area, marks)


def plot_scores(
    goal_distance: str, ax: Axes | None = None, *, study: pd.DataFrame | None = None
) -> ScoresPlot:
    """Draw goals in a hundred kicks against kicks: who learns, who does not, the best there is.

    Parameters
    ----------
    goal_distance : {"near", "far"}
        Where the robot stands.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    study : DataFrame, optional
        As `arkaq_edu.experiments.goal.study` returns it; the course's own where it is None.

    Returns
    -------
    ScoresPlot
        ``means`` and ``bands`` (one standard deviation over the seeds) of ARKAQ and of random
        actions, ``means`` of the oracle; ``best``, what no policy can exceed but by luck;
        ``thesis``, hollow, near only.
    """
    from arkaq_edu.experiments import goal

    table = goal.load_study() if study is None else study
    table = table[table.goal_distance == goal_distance]
    rate = table.assign(rate=100 * table.goals / goal.BLOCK).groupby(["who", "kicks"]).rate
    mean, std = rate.mean(), rate.std(ddof=0)
    ax = style.axes(ax, xlabel="kicks", ylabel="goals in 100 kicks")
    looks = {"ARKAQ": style.OURS, "random actions": style.ACTIONS["left"]}
    means, bands = {}, {}
    for who, color in looks.items():
        kicks = mean[who].index
        means[who], bands[who] = style.band(kicks, mean[who], std[who], ax, color=color, label=who)
    end = float(mean["ARKAQ"].index[-1])
    straight = mean["oracle"].mean()
    (means["oracle"],) = ax.plot(
        [0, end], [straight, straight], "--", color=style.QUIET, lw=1.2, label="oracle"
    )
    limit = 100 * goal.best_policy(goal_distance).goals  # type: ignore[arg-type]
    (best,) = ax.plot([0, end], [limit, limit], ":", color=style.INK, label="best there is")
    thesis = None
    if goal_distance == "near":
        thesis = style.measurements(
            [end] * 2, list(THESIS_RATES.values()), ax, markersize=8, clip_on=False, label="thesis"
        )
    first = {who: mean[who].iloc[:2].mean() for who in looks}
    last = {who: mean[who].iloc[-4:].mean() for who in looks}
    said = [f"{who} from {first[who]:.0f} to {last[who]:.0f} %" for who in looks]
    ax.set_title(f"{goal_distance}: {', '.join(said)}", loc="left", fontsize="medium")
    ax.set(xlim=(0, end), ylim=(0, 90 if goal_distance == "near" else 55))
    ax.legend(loc="upper left", ncols=3, frameon=False, fontsize="small")
    return ScoresPlot(ax, means, bands, best, thesis)


def figure_5_40(ax: Axes | None = None, **options: Any) -> ScoresPlot:
    """Draw figure 5.40, goals against kicks from near; see `plot_scores`."""
    return plot_scores("near", ax, **options)


def figure_5_41(ax: Axes | None = None, **options: Any) -> ScoresPlot:
    """Draw figure 5.41, goals against kicks from far, not straight; see `plot_scores`."""
    return plot_scores("far", ax, **options)


def _line_axes(ax: Axes | None, title: str) -> Axes:
    ax = style.axes(ax, xlabel="goal orientation (rad), left of the robot is left", title=title)
    ax.set(xlim=style.VIEW_ORIENTATION, ylim=(0, 1), yticks=[])
    ax.spines["left"].set_visible(False)
    return ax


def _strips(ends: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    return [np.array([(a, 0.0), (b, 0.0), (b, _STRIP), (a, _STRIP)]) for a, b in pairwise(ends)]
