"""Two explorers of chapter 1: what "best" means, and a bandit to play by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import CHAIN_COLORS, SERIES
from arkaq_edu.mdp import earnings
from arkaq_edu.mdp.machines import MACHINES, Game, crowd, game
from arkaq_edu.mdp.optimality import chain_curves, chosen_chains, coins, models_fact
from arkaq_edu.widgets.explorer import Buttons, Explorer, slider
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

Floats = NDArray[np.float64]

LONGEST = 30  # steps: the last stop of the slider of the horizon
HORIZONS = np.arange(1.0, LONGEST + 1)
GAMMAS = np.arange(100) / 100  # the stops of the slider of gamma
#: The presses with which the explorer opens: every machine three times.
OPENING = MACHINES * 3

_REWARDS, _TICKS = (-1.0, 12.0), [0, 2, 4, 6, 8, 10, 12]  # of the axis of rewards per step
_LENGTHS = (40, 70, 100, 150, 200, 300, 500, 1000)  # pulls: the ends of the axis of a game
_TIE = "#c9c9c9"


def horizon_explorer() -> Explorer:
    """Return sliders for horizon and discount above the three models of optimality.

    The choice is that of figure 2.2: three chains that pay 2, 10 and 11 a step. The better ones
    start to pay later.

    Returns
    -------
    Explorer
        Its sliders are ``controls["h"]``, in steps, and ``controls["gamma"]``.

    References
    ----------
    Thesis, equations 2.1 to 2.3 and figure 2.2. The sliders start at its numbers.

    Examples
    --------
    >>> explorer = horizon_explorer()
    >>> explorer
    h = 5: upper (6, 0, 0); gamma = 0.9: middle (16.2, 59, 58.5); average: lower (2, 10, 11)
    >>> explorer.controls["h"].value = 6
    >>> explorer.drawn.fact.split(";")[0]
    'h = 6: middle (8, 10, 0)'
    """
    return Explorer(
        draw_models,
        h=slider("horizon h (steps)", 5, 1, LONGEST, tooltip="How many rewards are added"),
        gamma=slider(
            "discount gamma", 0.9, GAMMAS[0], GAMMAS[-1], 0.01,
            tooltip="What a reward is worth one step later",
        ),
    )  # fmt: skip


def draw_models(h: int, gamma: float) -> Scene:
    """Return the picture for a horizon and a discount, with a panel for each model.

    All panels show rewards per step, so that they share an axis: the sum of h rewards divided by h,
    and the discounted sum times 1 - gamma. This changes no choice.

    Parameters
    ----------
    h : int
        The horizon in steps, 1 to `LONGEST`.
    gamma : float
        The discount rate, one of `GAMMAS`.

    Returns
    -------
    Scene
    """
    gamma = round(gamma, 2)  # a slider's steps add up to 0.9000000000000001
    earned = earnings(_checks.integer("h", h, 1, LONGEST), gamma)
    finite, geometric = chain_curves(LONGEST, tuple(GAMMAS))
    summed = "one reward" if h == 1 else f"sum of {h} rewards"
    panels = [
        _model("horizon h (steps)", "sum of h rewards / h", HORIZONS, finite, h, summed, earned[0]),
        _model(
            "discount gamma", "(1 − gamma) × discounted sum",
            GAMMAS, geometric, gamma, "discounted sum", earned[1],
        ),
        _averages(earned[2]),
    ]  # fmt: skip
    return Scene(models_fact(h, gamma, earned), panels)


def _model(
    xlabel: str, ylabel: str, x: Floats, curves: Floats, now: float, head: str, earned: Floats
) -> Panel:
    """Return a panel with a curve for each chain, marks at the slider, and the choice below."""
    at = int(np.abs(x - now).argmin())
    left, right = x[[0, -1]].tolist()
    pad = 0.03 * (right - left)
    best = np.isclose(curves, curves.max(axis=1, keepdims=True))
    flips, chosen = chosen_chains(x, curves)
    ends = (left - pad, right + pad)
    window = (*ends, -0.7, -0.4)  # of the strip below the curves
    layers: list[Layer] = [
        Cells.strip(flips, chosen, window, palette=[*CHAIN_COLORS.values(), _TIE], border=0),
        Line([now, now], [-0.4, curves[at].max()], style.QUIET, 1.0, dashed=True),
        Text(left + 0.4 * pad, 11.3, head),
    ]
    for i, (name, color) in enumerate(CHAIN_COLORS.items()):
        y = 10.4 - 0.85 * i
        layers += [
            Line(x, curves[:, i], color, 2.0),
            Points([now], curves[at, i : i + 1], 6.5 if best[at, i] else 3.5, color),
            Points([left + pad], [y], 4.0, color),
            Text(left + 2.5 * pad, y, f"{name}: {coins(earned[i])}"),
        ]
    return Panel(xlabel, ylabel, ends, _REWARDS, layers, width=1.25, yticks=_TICKS)


def _averages(earned: NDArray[np.float64]) -> Panel:
    layers: list[Layer] = []
    for x, color in zip(earned, CHAIN_COLORS.values(), strict=True):
        layers.append(Points([0.3], [x], 6.5 if x == earned.max() else 3.5, color))
        layers.append(Text(0.55, x, f"{x:g}"))
    return Panel(
        "any h, any gamma", "average reward", (0, 1), _REWARDS, layers, width=0.7,
        xticks=[], yticks=_TICKS,
    )  # fmt: skip


def bandit_explorer() -> Explorer:
    """Return buttons for four gambling machines, above the regret of the student and of others.

    `PLAYERS` players of each of the `STRATEGIES` play beside the student, on the same machines and
    with as many pulls. What a press pays depends only on the number of the machines and on the
    earlier presses. Other machines start a new game.

    Returns
    -------
    Explorer
        Its controls are ``controls["machines"]``, the number of a set of machines; the buttons
        ``controls["pulls"]``; and the box ``controls["reveal"]``, which shows the probabilities and
        removes the luck from the regret.

    References
    ----------
    Thesis, section 2.1.3.

    Examples
    --------
    >>> explorer = bandit_explorer()
    >>> explorer
    12 pulls, 7 coins: regret 2.8 with luck; random 3.0, epsilon-greedy 2.4, Boltzmann 2.0, UCB 2.3
    >>> explorer.controls["pulls"].press("machine 1")
    >>> explorer.drawn.fact.split(",")[0]
    '13 pulls'
    """
    machines = slider("machines no.", 3, 1, 30, tooltip="Another number: other machines")
    pulls = Buttons(MACHINES, value=OPENING)
    reveal = ipywidgets.Checkbox(
        False, description="show their chances", indent=False,
        tooltip="Show how often each machine pays, and count regret without luck",
    )  # fmt: skip

    def new_game(_: Any) -> None:
        pulls.value, reveal.value = (), False

    machines.observe(new_game, names="value")
    return Explorer(draw_bandit, machines=machines, pulls=pulls, reveal=reveal)


def draw_bandit(machines: int, pulls: Sequence[str], reveal: bool) -> Scene:
    """Return the picture of a game: the machines on the left, all regrets on the right.

    Parameters
    ----------
    machines, pulls
        As for `game`.
    reveal : bool
        Whether the probabilities of the machines are shown and regret is counted without luck.

    Returns
    -------
    Scene
    """
    played = game(machines, pulls)
    n = len(pulls)
    length = next((length for length in _LENGTHS if length >= n), 1000 * -(-n // 1000))
    others = crowd(machines, length, luck=not reveal)
    panels = [_machines(played, reveal), _regrets(played, others, length, reveal)]
    return Scene(played.fact(others, luck=not reveal), panels)


def _machines(played: Game, reveal: bool) -> Panel:
    layers: list[Layer] = []
    for i, p in enumerate(played.bandit.p.tolist()):
        paid = played.rewards[played.arms == i]
        if paid.size:
            layers.append(Points([i + 1], [paid.mean()], 6.0, hollow=True))
        tally = f"{paid.sum():.0f} of {paid.size}"
        layers.append(Text(i + 1 - 0.045 * len(tally), 1.1, tally))
        if reveal:
            layers.append(Line([i + 0.78, i + 1.22], [p, p], style.OURS, 3.0))
            layers.append(Text(i + 1.26, p, f"{p:.2f}", style.OURS))
    return Panel(
        "machine", "paid on average (coins a pull)", (0.5, 4.8), (-0.05, 1.18), layers,
        xticks=[1, 2, 3, 4], yticks=[0, 0.2, 0.4, 0.6, 0.8, 1],
    )  # fmt: skip


def _regrets(
    played: Game, others: dict[str, tuple[Floats, Floats]], length: int, reveal: bool
) -> Panel:
    yours = played.regret(luck=not reveal)
    n = len(yours) - 1
    k = np.arange(n + 1.0)
    top = max(1.7 * float(others["random"][0][-1]), 1.1 * float(yours.max()), 5.0)
    ends, heights = (0.0, 1.03 * length), (-0.15 * top, top)
    bands: list[Layer] = []
    lines: list[Layer] = []
    told = {"you": f"{yours[n]:.1f}"}
    colors = dict(zip([*others, "you"], SERIES, strict=True))
    for name, curves in others.items():
        mean, std = (curve[: n + 1] for curve in curves)
        bands.append(Cells.band(k, mean, std, (*ends, *heights), colors[name] + "2b"))
        lines.append(Line(k, mean, colors[name], 1.6))
        told[name] = f"{mean[n]:.1f} ± {std[n]:.1f}"
    lines += [Line(k, yours, style.OURS, 2.6), Points([n], yours[-1:], 5.0, style.OURS)]
    for row, (name, words) in enumerate(told.items()):
        y = top * (0.95 - 0.075 * row)
        lines.append(Line([0.02 * length, 0.07 * length], [y, y], colors[name], 2.6))
        lines.append(Text(0.09 * length, y, f"{name}: {words}"))
    ylabel = f"regret so far (coins), with{'out' * reveal} luck"
    return Panel("pulls so far", ylabel, ends, heights, [*bands, *lines], width=1.45)
