"""Figures 2.5 to 2.8 and 2.13, and the other pictures of the chapter on belief states.

References
----------
Thesis, sections 2.3 to 2.3.3.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_7(Figure().subplots())
two steps right, no goal seen: [.333 .333 .000 .333], [.100 .450 .000 .450], [.100 .164 .000 .736]
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Place, blank, link, moment, wire, words, write
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.figures.drawing.style import probability
from arkaq_edu.pomdp import Calibration, problem, successors, trajectory

#: What the thesis prints for the floors after a move down.
PRINTED_FLOORS = (0.0, 0.33, 0.33, 0.33)

#: Where the variables of figure 2.5 stand.
PLACES: dict[str, Place] = {
    "S_t": (0.0, 0.0), "O_t": (0.0, 1.6), "B_t": (0.0, 3.2), "A_t": (2.4, 3.2), "R_t": (2.4, 1.1),
    "S_t+1": (4.8, 0.0), "O_t+1": (4.8, 1.6), "B_t+1": (4.8, 3.2), "A_t+1": (7.2, 3.2),
}  # fmt: skip
#: Its wires, from a cause to its effect. The one from B_t to B_t+1 is drawn above the others.
CAUSES = [
    ("S_t", "O_t"), ("O_t", "B_t"), ("B_t", "A_t"), ("S_t", "R_t"), ("A_t", "R_t"),
    ("S_t", "S_t+1"), ("A_t", "S_t+1"), ("S_t+1", "O_t+1"), ("A_t", "O_t+1"),
    ("O_t+1", "B_t+1"), ("A_t", "B_t+1"), ("B_t+1", "A_t+1"),
]  # fmt: skip
_ROW = 1.2  # the distance from one belief to the next
_LARGEST = 30.0  # the dot of figure 2.13 for a probability of 1, in points


class BeliefsPlot(Plot):
    """What `plot_beliefs` drew. It states the numbers, too."""

    def __repr__(self) -> str:
        """Return the title with the numbers."""
        return self.fact


def belief_words(b: ArrayLike) -> str:
    """Return a belief as the thesis prints it, to three digits.

    Examples
    --------
    >>> belief_words([0.1, 0.45, 0.0, 0.45]), belief_words([0.0, 1.0])
    ('[.100 .450 .000 .450]', '[.000 1.000]')
    """
    return "[" + " ".join(probability(p, 3) for p in np.asarray(b)) + "]"


def figure_2_5(ax: Axes | None = None) -> Plot:
    """Draw figure 2.5, a POMDP from one moment to the next.

    Circles are states, observations and beliefs, squares actions, diamonds rewards. An arrow leads
    from a cause to its effect. T, O, R and SE (the state estimator) stand at the arrows that they
    describe.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        ``ax``, ``parts`` and ``wires``, by names like "S_t" and "S_t+1".

    References
    ----------
    Thesis, figure 2.5. By section 2.3 the reward R_t is that of A_t in S_t.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_5(Figure().subplots())
    >>> sorted(cause for cause, effect in plot.wires if effect == "B_t+1")
    ['A_t', 'B_t', 'O_t+1']
    """
    title = "POMDP: the state is hidden; the belief is made of what was done and observed"
    ax = blank(ax, title, (-1.7, 8.0), (-0.9, 4.7))
    ax.axhspan(-0.6, 0.6, color=style.CELLS[1], zorder=-2)
    write(ax, (7.9, 0.0), "hidden", ha="right", fontsize=10, color=style.QUIET)
    parts = {name: moment(ax, name, place) for name, place in PLACES.items()}
    wires = {(start, end): link(ax, PLACES, start, end) for start, end in CAUSES}
    (x, y), (to_x, _), over = PLACES["B_t"], PLACES["B_t+1"], PLACES["B_t"][1] + 0.95
    wires["B_t", "B_t+1"] = wire(ax, (x, y + 0.34), (x, over), (to_x, over), (to_x, y + 0.34))
    for start, end in (("B_t", "A_t"), ("B_t+1", "A_t+1")):
        wires[start, end].set(linestyle="--", color=style.QUIET)
    for text, place in (
        ("T", (2.4, 0.0)), ("O", (4.8, 0.8)), ("R", (1.2, 0.55)), ("SE", (2.4, over)),
        ("policy", (1.2, y)),
    ):  # fmt: skip
        words(ax, place, text, color=style.QUIET)
    return Plot(ax, parts=parts, wires=wires)


def plot_beliefs(
    beliefs: ArrayLike, states: Sequence[str], names: Sequence[str], ax: Axes | None = None, *,
    printed: Sequence[ArrayLike | None] | None = None, title: str = "",
) -> Plot:  # fmt: skip
    """Draw beliefs as bars over the states, one below the other.

    Parameters
    ----------
    beliefs : array_like, shape (n, S)
        The beliefs, the first at the top.
    states : sequence of str
        Names of the states.
    names : sequence of str
        The text beside each belief: how it came about.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    printed : sequence of (array_like or None), optional
        Printed numbers to compare with each belief, shape (S,), or None; they become hollow marks.
    title : str
        What the picture states, without the numbers.

    Returns
    -------
    Plot
        ``beliefs``, shape (n, S); ``bars``, a row for each belief; and the marks ``printed``, or
        None.

    Raises
    ------
    ValueError
        If a belief is not a distribution, or the number of names is wrong.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot_beliefs([[0.5, 0.5], [0.9, 0.1]], ["left", "right"], ["before", "after"],
    ...              Figure().subplots())
    [.500 .500], [.900 .100]
    """
    n, S = len(names), len(states)
    b = _checks.distribution("beliefs", _checks.array("beliefs", beliefs, (n, S)))
    ax = style.axes(ax, title=title, size=(6.4, 0.8 + 1.1 * n))
    x = np.arange(S, dtype=float)
    bars, marks = [], []
    for row, (belief, name) in enumerate(zip(b, names, strict=True)):
        foot = -_ROW * row
        bars.append(ax.bar(x, belief, 0.62, foot, color=style.OURS))
        ax.plot([-0.45, S - 0.55], [foot, foot], color=style.QUIET, linewidth=0.8)
        write(ax, (-0.6, foot + 0.3), name, ha="right", fontsize=10)
        for place, p in zip(x, belief, strict=True):
            write(ax, (place, foot + p + 0.04), probability(p), va="bottom", color="black")
        if printed is not None and printed[row] is not None:
            marks.append(np.column_stack([x + 0.4, foot + np.asarray(printed[row])]))
    ax.spines[["left", "bottom"]].set_visible(False)
    ax.tick_params(length=0)
    ax.set(xticks=x, xticklabels=states, yticks=[])
    ax.set(xlim=(-0.65, S - 0.35), ylim=(-_ROW * (n - 1) - 0.03, 1.1))
    hollow = None
    if marks:
        at, height = np.concatenate(marks).T
        hollow = style.measurements(at, height, ax, clip_on=False, label="the thesis prints")
        ax.legend(frameon=False, loc="upper right")
    rows = ", ".join(map(belief_words, b))
    fact = f"{title}: {rows}" if title else rows
    return BeliefsPlot(ax, fact, beliefs=b, bars=bars, printed=hollow)


def figure_2_6(ax: Axes | None = None) -> Plot:
    """Draw figure 2.6: which of four floors, before and after a move down.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot
        As of `plot_beliefs`. The hollow marks are the thesis's numbers. They treat all floors that
        are still possible alike, while Bayes' rule also counts the robots that were on the lowest
        floor already.

    References
    ----------
    Thesis, section 2.3.1 and figure 2.6.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_6(Figure().subplots())
    one step down; all floors look alike: [.250 .250 .250 .250], [.000 .250 .250 .500]
    """
    floors = problem("floors")
    start, _, after = trajectory(floors, ["down", "dark"]).beliefs
    return plot_beliefs(
        [start, after], floors.states, ["at first", "after down"], ax,
        printed=[None, PRINTED_FLOORS], title="one step down; all floors look alike",
    )  # fmt: skip


def figure_2_7(ax: Axes | None = None) -> Plot:
    """Draw figure 2.7: which cell of a corridor, after two steps right without a goal.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.

    Returns
    -------
    Plot

    References
    ----------
    Thesis, section 2.3.1 and figure 2.7. The first step, too, needs the observation that the cell
    is not the goal.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_7(Figure().subplots()).beliefs.round(3)
    array([[0.333, 0.333, 0.   , 0.333],
           [0.1  , 0.45 , 0.   , 0.45 ],
           [0.1  , 0.164, 0.   , 0.736]])
    """
    corridor = problem("corridor")
    beliefs = trajectory(corridor, ["right", "nothing"] * 2).beliefs[::2]
    names = ["at first", "right: no goal", "right: no goal"]
    return plot_beliefs(beliefs, corridor.states, names, ax, title="two steps right, no goal seen")


def figure_2_8(ax: Axes | None = None, *, p: float = 0.25) -> Plot:
    """Draw figure 2.8: all beliefs over two states are a line, p(s1) = 0 at its left end.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    p : float in [0, 1]
        The marked belief: the probability of s1.

    Returns
    -------
    Plot
        The ``line`` and the mark ``belief``.

    Raises
    ------
    ValueError
        If `p` is not a probability.

    References
    ----------
    Thesis, section 2.3.1 and figure 2.8.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> figure_2_8(Figure().subplots())
    b = [.25 .75]: a point at .25 of the way from surely s2 to surely s1
    """
    p = _checks.number("p", p, 0, 1)
    title = f"b = [{probability(p)} {probability(1 - p)}]: a point at {probability(p)} of the way "
    ax = _belief_line(ax, title + "from surely s2 to surely s1", (-0.5, 0.6), (6.4, 1.9))
    (line,) = ax.plot([0, 1], [0, 0], color=style.INK, linewidth=2)
    (mark,) = ax.plot(p, 0, "o", color=style.OURS, markersize=11)
    for x, text in ((0, "surely $s_2$"), (1, "surely $s_1$")):
        ax.plot(x, 0, "|", color=style.INK, markersize=14, markeredgewidth=2)
        style.tag(ax, (x, 0), text, (0, -22), va="baseline")
    style.tag(ax, (p, 0), probability(p), (0, 10), va="baseline", color=style.OURS)
    return Plot(ax, line=line, belief=mark)


def figure_2_13(ax: Axes | None = None, *, p: float = 0.4) -> Plot:
    """Draw figure 2.13: where two actions and three observations can lead one belief.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    p : float in [0, 1]
        The belief at the start: the probability of s1.

    Returns
    -------
    Plot
        ``start``, and by (action, observation) the ``successors``. The area of each dot is the
        probability of its observation.

    Raises
    ------
    ValueError
        If `p` is not a probability.

    References
    ----------
    Thesis, sections 2.3.3 (equation 2.16) and 2.3.4 (figure 2.13). The thesis gives neither T nor
    O for this problem; both are the course's own.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> len(figure_2_13(Figure().subplots()).successors)
    6
    """
    pomdp = problem("two_state")
    p = _checks.number("p", p, 0, 1)
    title = "one belief, two actions, three observations: six beliefs, larger where likelier"
    ax = _belief_line(ax, title, (-1.75, 1.75), (6.4, 3.4))
    drawn = {}
    for a, row in enumerate((1, -1)):
        action = pomdp.actions[a]
        color = style.POMDP_ACTIONS[action]
        ax.plot([0, 1], [row, row], color=style.QUIET, linewidth=1)
        write(ax, (-0.04, row), action, ha="right", fontsize=10, color=color)
        chances, beliefs = successors(pomdp, [p, 1 - p], a)
        for name, chance, x in zip(pomdp.observations, chances, beliefs[:, 0], strict=True):
            ax.plot([p, x], [0, row], color=color, linewidth=1, zorder=1)
            size = _LARGEST * chance**0.5
            (drawn[action, name],) = ax.plot(x, row, "o", color=color, markersize=size)
            style.tag(ax, (x, row), f"{name}\n{probability(chance)}", (0, 14 * row), fontsize=9)
    ax.plot([0, 1], [0, 0], color=style.QUIET, linewidth=1)
    write(ax, (-0.04, 0), "now", ha="right", fontsize=10)
    (start,) = ax.plot(p, 0, "o", color=style.QUIET, markersize=_LARGEST)
    return Plot(ax, start=start, successors=drawn)


def plot_run(
    beliefs: ArrayLike, truth: ArrayLike, misled: ArrayLike, ax: Axes | None = None, *,
    title: str = "",
) -> Plot:  # fmt: skip
    """Draw, step by step, how much of the belief lies on the hidden state.

    Parameters
    ----------
    beliefs : array_like, shape (n, S)
        The belief after each step.
    truth : array_like of int, shape (n,)
        The hidden state after each step.
    misled : array_like of bool, shape (n,)
        Whether the observation was misleading. These steps get hollow marks at the top.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        What the picture states.

    Returns
    -------
    Plot
        The line ``on_truth``, the ``changes`` of the state, and the marks ``misled``.

    Raises
    ------
    ValueError
        If a belief is not a distribution, or the lengths differ.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_run([[0.9, 0.1], [0.5, 0.5]], [1, 1], [True, False], Figure().subplots())
    >>> plot.on_truth.get_ydata(), plot.misled.get_xdata()
    (array([0.1, 0.5]), array([1]))
    """
    b = _checks.distribution("beliefs", _checks.array("beliefs", beliefs, (None, None)))
    n = len(b)
    truth = _checks.array("truth", truth, (n,)).astype(int)
    wrong = _checks.array("misled", misled, (n,)) > 0
    ylabel = "belief in the hidden state"
    ax = style.axes(ax, xlabel="step", ylabel=ylabel, title=title, size=(7.4, 3.4))
    k = np.arange(1, n + 1)
    moved = k[1:][np.diff(truth) != 0]
    changes = ax.vlines(moved, 0, 1, color=style.INK, linestyle=":", label="the state changes")
    (on_truth,) = ax.plot(k, b[k - 1, truth], color=style.OURS, lw=2, marker="o", markersize=3)
    marks = style.measurements(k[wrong], np.full(wrong.sum(), 1.07), ax, label="a look misleads")
    ax.set(xlim=(0, n + 1), ylim=(0, 1.13), yticks=np.linspace(0, 1, 6).round(1))
    ax.legend(loc="best", framealpha=0.8, edgecolor="none")
    return Plot(ax, on_truth=on_truth, changes=changes, misled=marks)


def plot_calibration(
    curves: Mapping[str, Calibration], ax: Axes | None = None, *, title: str = ""
) -> Plot:
    """Draw how often the claims of a belief are true, by the claimed probability.

    Parameters
    ----------
    curves : mapping of str to Calibration
        Up to two, by name. Their bands are one standard deviation over the seeds.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on new axes.
    title : str
        What the picture states.

    Returns
    -------
    Plot
        ``lines`` and ``bands``, by name.

    Raises
    ------
    ValueError
        If there are more than two.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> honest = Calibration(np.array([0.5, 0.9]), np.array([[0.4, 0.9], [0.6, 0.9]]))
    >>> plot = plot_calibration({"honest": honest}, Figure().subplots())
    >>> plot.lines["honest"].get_ydata()
    array([0.5, 0.9])
    """
    ax = style.axes(ax, xlabel="what the belief claims", ylabel="how often it is so", title=title)
    ax.plot([0, 1], [0, 1], "--", color=style.QUIET, linewidth=1)
    drawn = {name: (curve.claimed, curve.mean, curve.std) for name, curve in curves.items()}
    colors = (style.OURS, style.INK)
    lines, bands = style.bands(ax, drawn, colors, marker="o", markersize=4)
    lowest = [min(curve.claimed.min(), (curve.mean - curve.std).min()) for curve in curves.values()]
    least = min(lowest, default=1.0)
    ends = (max(least - 0.03, 0.0), 1.01)
    ax.set(xlim=ends, ylim=ends, aspect="equal")
    ax.legend(frameon=False, loc="upper left")
    return Plot(ax, lines=lines, bands=bands)


def _belief_line(
    ax: Axes | None, title: str, ylim: tuple[float, float], size: tuple[float, float]
) -> Axes:
    """Return axes on which a belief over two states is a point: p(s1) runs to the right."""
    ax = style.axes(ax, xlabel="$p(s_1)$", title=title, size=size)
    ax.spines["left"].set_visible(False)
    ax.set(xlim=(-0.12, 1.06), ylim=ylim, yticks=[], xticks=np.linspace(0, 1, 5))
    return ax
