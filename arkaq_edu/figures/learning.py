"""Figures 2.1 and 2.2, and the plots of the chapter on reinforcement learning.

References
----------
Thesis, section 2.1.

Examples
--------
>>> from matplotlib.figure import Figure
>>> figure_2_2(Figure().subplots())
best is the upper with 5 steps left, the middle discounted by 0.9, the lower on average
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch
from numpy.typing import ArrayLike

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import arrow, blank, box, frame, wire, words
from arkaq_edu.figures.drawing.plot import Plot
from arkaq_edu.figures.drawing.style import CHAIN_COLORS, SERIES
from arkaq_edu.mdp.optimality import CHAINS, best_chains, earnings


def figure_2_1(ax: Axes | None = None) -> Plot:
    """Draw figure 2.1, the loop of an agent and its world.

    The indication I and the reward R are sensors. They belong to the agent's body, and its policy
    uses what they measure.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.

    Returns
    -------
    Plot
        With ``parts`` and ``wires``.

    References
    ----------
    Thesis, figure 2.1. L. Kaelbling, M. Littman, A. Moore, "Reinforcement learning: a survey",
    Journal of Artificial Intelligence Research 4, 1996, figure 1.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_1(Figure().subplots())
    >>> [end for start, end in plot.wires if start == "policy"]
    ['world']
    """
    title = "reinforcement learning: from the world's answers alone, learn what to do"
    ax = blank(ax, title, (-1.2, 9.0), (-1.9, 2.3))
    frame(ax, (2.3, -1.25), 6.4, 3.3)
    parts = {
        "world": box(ax, (0.0, 0.3), "world\nin state $s$", width=1.7, height=1.2),
        "I": box(ax, (3.9, 1.1), "$I$", width=0.8),
        "R": box(ax, (3.9, -0.5), "$R$", width=0.8),
        "policy": box(ax, (7.2, 0.3), "policy $\\pi$", width=1.5, height=1.2),
        "s": words(ax, (1.6, 0.3), "state $s$"),
        "o": words(ax, (5.4, 1.1), "observation $o$"),
        "r": words(ax, (5.4, -0.5), "reward $r$"),
        "a": words(ax, (3.7, -1.65), "action $a$"),
    }
    for text, x, y in (
        ("indication: what of $s$ is seen", 3.9, 1.67), ("is it good or bad?", 3.9, -1.03),
        ("what learns", 7.5, 1.1), ("agent", 8.2, 1.8),
    ):  # fmt: skip
        words(ax, (x, y), text, color=style.QUIET)
    wires = {
        ("world", "I"): wire(ax, (0.85, 0.3), (2.8, 0.3), (2.8, 1.1), (3.5, 1.1)),
        ("world", "R"): wire(ax, (0.85, 0.3), (2.8, 0.3), (2.8, -0.5), (3.5, -0.5)),
        ("I", "policy"): wire(ax, (4.3, 1.1), (6.7, 1.1), (6.7, 0.9)),
        ("R", "policy"): wire(ax, (4.3, -0.5), (6.7, -0.5), (6.7, -0.3)),
        ("policy", "world"): wire(ax, (7.6, -0.3), (7.6, -1.65), (0.0, -1.65), (0.0, -0.3)),
    }
    for name in "oras":
        parts[name].set_zorder(3)
    return Plot(ax, parts=parts, wires=wires)


def figure_2_2(ax: Axes | None = None, *, horizon: int = 5, gamma: float = 0.9) -> Plot:
    """Draw figure 2.2: three chains to choose from, and what each earns by each model.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.
    horizon : int
        The number of steps that the finite-horizon model counts, at least 1.
    gamma : float
        The discount rate, in [0, 1).

    Returns
    -------
    Plot
        With ``chains``, the arrows of each chain, and ``earnings``, what each chain earns by the
        finite-horizon, the discounted and the average-reward model. The most is in bold.

    References
    ----------
    Thesis, figure 2.2 and equations 2.1 to 2.3.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = figure_2_2(Figure().subplots())
    >>> [text.get_text() for text in plot.earnings["upper"]]
    ['6', '16.2', '2']
    """
    earned = earnings(horizon, gamma)
    best = [_with_article(best_chains(model)) for model in earned]
    title = (
        f"best is {best[0]} with {horizon} step{'s' * (horizon > 1)} left, "
        f"{best[1]} discounted by {gamma:g}, {best[2]} on average"
    )
    ax = blank(ax, title, (-0.5, 11.9), (-0.6, 3.5), inch=0.7)
    columns = (8.6, 10.0, 11.4)
    heads = (f"horizon\n$h$ = {horizon}", f"discounted\n$\\gamma$ = {gamma:g}", "average\nreward")
    for x, head in zip(columns, heads, strict=True):
        words(ax, (x, 3.2), head, color=style.QUIET)
    chains, told = {}, {}
    for i, (name, (delay, reward)) in enumerate(CHAINS.items()):
        y = 2.4 - 1.2 * i
        chains[name] = _chain(ax, y, delay, reward, CHAIN_COLORS[name])
        told[name] = [
            words(ax, (x, y), f"{model[i]:.3g}") for x, model in zip(columns, earned, strict=True)
        ]
        for text, model in zip(told[name], earned, strict=True):
            text.set(fontsize=11, weight="bold" if name in best_chains(model) else "normal")
    ax.add_patch(Circle((0.0, 2.4), 0.2, facecolor=style.INK, edgecolor=style.INK, zorder=3))
    return Plot(ax, chains=chains, earnings=told)


def plot_regret(
    regrets: Mapping[str, ArrayLike], ax: Axes | None = None, *, title: str = ""
) -> Plot:
    """Draw how regret grows: for each strategy the mean of its players, with one sigma.

    Parameters
    ----------
    regrets : mapping of str to array_like, shape (players, pulls)
        The regret so far of each player after each pull, for at most five strategies with at
        least 20 players each.
    ax : matplotlib.axes.Axes, optional
        The axes; new ones if None.
    title : str
        What the plot states.

    Returns
    -------
    Plot
        With ``lines`` and ``bands`` by name.

    Raises
    ------
    ValueError
        If there are more than five strategies, or too few players for a band.

    References
    ----------
    Thesis, section 2.1.2, third measure.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> plot = plot_regret({"always wrong": [[1.0, 2.0]] * 20}, Figure().subplots())
    >>> plot.lines["always wrong"].get_ydata()
    array([1., 2.])
    """
    curves = {}
    for name, values in regrets.items():
        players = _checks.array(name, values, (None, None))
        if len(players) < 20:
            raise ValueError(f"{name} must be played by at least 20, got {len(players)}")
        pulls = np.arange(1, players.shape[1] + 1)
        curves[name] = pulls, players.mean(axis=0), players.std(axis=0)
    ax = style.axes(ax, xlabel="pulls so far", ylabel="regret so far (coins)", title=title)
    lines, bands = style.bands(ax, curves, SERIES)
    ax.set_ylim(bottom=0)
    ax.legend(frameon=False)
    return Plot(ax, lines=lines, bands=bands)


def _chain(ax: Axes, y: float, delay: int, reward: float, color: str) -> list[FancyArrowPatch]:
    """Draw the states of a chain, from the second one, and its arrows; the last one earns."""
    arrows, place = [], np.array([0.0, 2.4])
    for k in range(1, delay + 1):
        previous, place = place, np.array([1.1 * k, y])
        rim = 0.2 * (place - previous) / np.linalg.norm(place - previous)
        arrows.append(wire(ax, *np.array([previous + rim, place - rim])))
        ax.add_patch(Circle((1.1 * k, y), 0.2, facecolor="white", edgecolor=style.INK))
    x = 1.1 * delay
    loop = arrow(ax, (x + 0.12, y + 0.17), (x + 0.12, y - 0.17), -2.2, color=color)
    words(ax, (x + 0.6, y), f"+{reward:g}", "left")
    return [*arrows, loop]


def _with_article(names: list[str]) -> str:
    return "any" if len(names) == len(CHAINS) else " or ".join(f"the {name}" for name in names)
