"""Figures 2.1 and 2.2, and the pictures of the chapter on reinforcement learning.

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
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import FillBetweenPolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.text import Text
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.diagram import Diagram, blank, box, frame, wire, words
from arkaq_edu.mdp import average_reward, delayed_rewards, discounted, finite_horizon

#: The chains of figure 2.2, from the top: how many steps earn nothing, and what each later one
#: earns.
CHAINS = {"upper": (2, 2.0), "middle": (5, 10.0), "lower": (6, 11.0)}
#: A color for each chain: to enter one is an action.
CHAIN_COLORS = dict(zip(CHAINS, list(style.ACTIONS.values())[:3], strict=True))
#: The colors of lines that are compared, in their order.
SERIES = (
    style.QUIET, style.ACTIONS["left"], style.ACTIONS["right"], style.ACTIONS["forward"],
    style.OURS,
)  # fmt: skip


class ChainsPlot(NamedTuple):
    """What `figure_2_2` drew: the arrows of each chain, and what it earns by each model."""

    ax: Axes
    chains: dict[str, list[FancyArrowPatch]]
    earnings: dict[str, list[Text]]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


class RegretPlot(NamedTuple):
    """What `plot_regret` drew: a line and a band for each way to play, by name."""

    ax: Axes
    lines: dict[str, Line2D]
    bands: dict[str, FillBetweenPolyCollection]

    def __repr__(self) -> str:
        """Return what the picture states."""
        return self.ax.get_title(loc="left")


def figure_2_1(ax: Axes | None = None) -> Diagram:
    """Draw figure 2.1, the loop of an agent and its world.

    The indication I and the reward R are sensors: they are part of the agent's body, and its policy
    takes what they give.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.

    Returns
    -------
    Diagram
        ``ax``, ``parts`` and ``wires``.

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
    for place, text in (
        ((3.9, 1.67), "indication: what of $s$ is seen"),
        ((3.9, -1.03), "is it good or bad?"),
        ((7.5, 1.1), "what learns"),
        ((8.2, 1.8), "agent"),
    ):
        words(ax, place, text, color=style.QUIET)
    wires = {
        ("world", "I"): wire(ax, (0.85, 0.3), (2.8, 0.3), (2.8, 1.1), (3.5, 1.1)),
        ("world", "R"): wire(ax, (0.85, 0.3), (2.8, 0.3), (2.8, -0.5), (3.5, -0.5)),
        ("I", "policy"): wire(ax, (4.3, 1.1), (6.7, 1.1), (6.7, 0.9)),
        ("R", "policy"): wire(ax, (4.3, -0.5), (6.7, -0.5), (6.7, -0.3)),
        ("policy", "world"): wire(ax, (7.6, -0.3), (7.6, -1.65), (0.0, -1.65), (0.0, -0.3)),
    }
    for name in "oras":
        parts[name].set_zorder(3)
    return Diagram(ax, parts, wires)


def figure_2_2(ax: Axes | None = None, *, horizon: int = 5, gamma: float = 0.9) -> ChainsPlot:
    """Draw figure 2.2: three chains to choose from, and what each earns by each model.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    horizon : int
        How many steps the finite-horizon model counts, at least 1.
    gamma : float
        The discount rate, in [0, 1).

    Returns
    -------
    ChainsPlot
        ``ax``; ``chains``, the arrows of each; ``earnings``, for each what it earns by the
        finite-horizon, the discounted and the average-reward model, bold where none earns more.

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
    return ChainsPlot(ax, chains, told)


def earnings(horizon: int, gamma: float) -> NDArray[np.float64]:
    """Return what the chains of figure 2.2 earn by each of the three models.

    Parameters
    ----------
    horizon : int
        How many steps the finite-horizon model counts, at least 1.
    gamma : float
        The discount rate, in [0, 1).

    Returns
    -------
    array, shape (3, 3)
        A row for each model, in the order of equations 2.1 to 2.3; a column for each chain.

    References
    ----------
    Thesis, equations 2.1 to 2.3.

    Examples
    --------
    >>> earnings(5, 0.9).round(1)
    array([[ 6. ,  0. ,  0. ],
           [16.2, 59. , 58.5],
           [ 2. , 10. , 11. ]])
    """
    delays, rewards = zip(*CHAINS.values(), strict=True)
    world = delayed_rewards(delays, rewards, gamma)
    return np.array(
        [finite_horizon(world, horizon)[-1, 0], discounted(world)[0], average_reward(world)[0]]
    )


def best_chains(earned: ArrayLike) -> list[str]:
    """Return the names of the chains that earn as much as any.

    Parameters
    ----------
    earned : array_like, shape (3,)
        What each chain earns, by one model.

    Returns
    -------
    list of str
        Names of `CHAINS`.

    Examples
    --------
    >>> best_chains([100.0, 110.0, 110.0])
    ['middle', 'lower']
    """
    best = np.isclose(earned, np.max(earned))
    return [name for name, is_best in zip(CHAINS, best, strict=True) if is_best]


def plot_regret(
    regrets: Mapping[str, ArrayLike], ax: Axes | None = None, *, title: str = ""
) -> RegretPlot:
    """Draw how regret grows: for each way to play the mean of its players, and one sigma.

    Parameters
    ----------
    regrets : mapping of str to array_like, shape (players, pulls)
        Regret so far by pull, at least 20 players each; at most five ways to play.
    ax : matplotlib.axes.Axes, optional
        Where to draw; fresh axes where it is None.
    title : str
        What the picture states.

    Returns
    -------
    RegretPlot
        ``ax``, ``lines`` and ``bands``.

    Raises
    ------
    ValueError
        If there are more than five, or too few players for a band.

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
    if len(regrets) > len(SERIES):
        raise ValueError(f"regrets must hold at most {len(SERIES)} ways to play, got {[*regrets]}")
    ax = style.axes(ax, xlabel="pulls so far", ylabel="regret so far (coins)", title=title)
    lines, bands = {}, {}
    for (name, values), color in zip(regrets.items(), SERIES, strict=False):
        players = _checks.array(name, values, (None, None))
        if len(players) < 20:
            raise ValueError(f"{name} must be played by at least 20, got {len(players)}")
        pulls = np.arange(1, players.shape[1] + 1)
        lines[name], bands[name] = style.band(
            pulls, players.mean(axis=0), players.std(axis=0), ax, color=color, label=name
        )
    ax.set_ylim(bottom=0)
    ax.legend(frameon=False)
    return RegretPlot(ax, lines, bands)


def _chain(ax: Axes, y: float, delay: int, reward: float, color: str) -> list[FancyArrowPatch]:
    """Draw the states of a chain, from the second on, and the arrows; the last one earns."""
    arrows = []
    for k in range(1, delay + 1):
        x = 1.1 * k
        start = (0.0, 2.4) if k == 1 else (x - 1.1, y)
        arrows.append(wire(ax, *_between((start[0], start[1]), (x, y))))
        ax.add_patch(Circle((x, y), 0.2, facecolor="white", edgecolor=style.INK))
    loop = FancyArrowPatch(
        (x + 0.12, y + 0.17), (x + 0.12, y - 0.17), connectionstyle="arc3,rad=-2.2",
        arrowstyle="-|>", mutation_scale=12, shrinkA=0, shrinkB=0, color=color,
    )  # fmt: skip
    ax.add_patch(loop)
    words(ax, (x + 0.6, y), f"+{reward:g}", "left")
    return [*arrows, loop]


def _between(start: tuple[float, float], end: tuple[float, float]) -> NDArray[np.float64]:
    """Return where an arrow between two states begins and ends, at the rims of their circles."""
    one, other = np.array(start), np.array(end)
    step = 0.2 * (other - one) / np.linalg.norm(other - one)
    return np.array([one + step, other - step])


def _with_article(names: list[str]) -> str:
    return "any" if len(names) == len(CHAINS) else " or ".join(f"the {name}" for name in names)
