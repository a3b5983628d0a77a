"""Two explorers of chapter 1: what "best" means, and a bandit to play by hand."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import groupby
from typing import Any, NamedTuple

import ipywidgets
import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import CHAIN_COLORS, SERIES
from arkaq_edu.mdp import (
    CHAINS,
    UCB,
    Bandit,
    Boltzmann,
    EpsilonGreedy,
    Random,
    best_chains,
    delayed_rewards,
    discounted,
    earnings,
    finite_horizon,
    play,
    regret,
)
from arkaq_edu.mdp.bandits import Strategy
from arkaq_edu.widgets.explorer import Buttons, Explorer, wide
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text, between

LONGEST = 30  # steps: the last stop of the slider of the horizon
GAMMAS = tuple(step / 100 for step in range(100))  # the stops of the slider of gamma

#: The names on the buttons; machine i of the bandit is the i-th.
MACHINES = ("machine 1", "machine 2", "machine 3", "machine 4")
#: The presses with which the explorer opens: every machine three times.
OPENING = MACHINES * 3
#: The strategies that play beside the student, with their default parameters.
STRATEGIES: dict[str, Strategy] = {
    "random": Random(),
    "epsilon-greedy": EpsilonGreedy(),
    "Boltzmann": Boltzmann(),
    "UCB": UCB(),
}
PLAYERS = 300  # players of each strategy

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
        h=ipywidgets.IntSlider(5, min=1, max=LONGEST, description="horizon h (steps)", **wide()),
        gamma=ipywidgets.FloatSlider(
            0.9, min=GAMMAS[0], max=GAMMAS[-1], step=0.01, description="discount gamma", **wide()
        ),
    )


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
    finite, geometric = _curves()
    told = []
    for row in earned:
        best = best_chains(row)
        chosen = "any" if len(best) == len(CHAINS) else " or ".join(best)
        told.append(f"{chosen} ({', '.join(map(_coins, row))})")
    fact = f"h = {h}: {told[0]}; gamma = {gamma:g}: {told[1]}; average: {told[2]}"
    summed = "one reward" if h == 1 else f"sum of {h} rewards"
    panels = [
        _model(
            ("horizon h (steps)", "sum of h rewards / h"),
            np.arange(1, LONGEST + 1), finite, h, summed, earned[0],
        ),
        _model(
            ("discount gamma", "(1 − gamma) × discounted sum"),
            np.array(GAMMAS), geometric, gamma, "discounted sum", earned[1],
        ),
        _averages(earned[2]),
    ]  # fmt: skip
    return Scene(fact, panels)


def _coins(x: float) -> str:
    return f"{x:.3g}" if x < 999.5 else f"{x:.0f}"


@cache
def _curves() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the reward per step of each chain, for all horizons and for all discounts."""
    steps = np.arange(1, LONGEST + 1)
    finite = finite_horizon(delayed_rewards(), LONGEST)[:, 0] / steps[:, None]
    geometric = [(1 - g) * discounted(delayed_rewards(gamma=g))[0] for g in GAMMAS]
    return finite, np.array(geometric)


def _model(
    labels: tuple[str, str],
    x: NDArray[Any],
    curves: NDArray[np.float64],
    now: float,
    head: str,
    earned: NDArray[np.float64],
) -> Panel:
    """Return a panel with a curve for each chain, marks at the slider, and the choice below."""
    at = int(np.abs(x - now).argmin())
    left, right = float(x[0]), float(x[-1])
    pad = 0.03 * (right - left)
    best = np.isclose(curves, curves.max(axis=1, keepdims=True))
    ends, heights = (left - pad, right + pad), (-1.0, 12.0)
    layers: list[Layer] = [
        _strip(x, best, (*ends, *heights)),
        Line([now, now], [-0.4, curves[at].max()], style.QUIET, 1.0, dashed=True),
        Text(left + 0.4 * pad, 11.3, head),
    ]
    for i, (name, color) in enumerate(CHAIN_COLORS.items()):
        y = 10.4 - 0.85 * i
        layers += [
            Line(x, curves[:, i], color, 2.0),
            Points([now], curves[at, i : i + 1], 6.5 if best[at, i] else 3.5, color),
            Points([left + pad], [y], 4.0, color),
            Text(left + 2.5 * pad, y, f"{name}: {_coins(earned[i])}"),
        ]
    return Panel(*labels, ends, heights, layers, width=1.25, yticks=[0, 2, 4, 6, 8, 10, 12])


def _strip(
    x: NDArray[Any], best: NDArray[np.bool_], within: tuple[float, float, float, float]
) -> Cells:
    """Return the strip below the curves: the color of the chosen chain, gray for a tie."""
    edges = np.concatenate([x[:1], (x[1:] + x[:-1]) / 2, x[-1:]]).astype(float)
    pieces, colors, start = [], [], 0
    for chosen, run in groupby(map(tuple, best)):
        end = start + len(list(run))
        left, right = edges[start], edges[end]
        pieces.append(np.array([[left, -0.7], [right, -0.7], [right, -0.4], [left, -0.4]]))
        colors.append(chosen.index(True) if sum(chosen) == 1 else len(chosen))
        start = end
    return Cells(pieces, colors, within, [*CHAIN_COLORS.values(), _TIE], border=0)


def _averages(earned: NDArray[np.float64]) -> Panel:
    layers: list[Layer] = []
    for x, color in zip(earned, CHAIN_COLORS.values(), strict=True):
        layers.append(Points([0.3], [x], 6.5 if x == earned.max() else 3.5, color))
        layers.append(Text(0.55, x, f"{x:g}"))
    return Panel(
        "any h, any gamma", "average reward", (0, 1), (-1.0, 12.0), layers, width=0.7,
        xticks=[], yticks=[0, 2, 4, 6, 8, 10, 12],
    )  # fmt: skip


class Game(NamedTuple):
    """The student's game: the machines, which were pulled, and what each pull paid."""

    bandit: Bandit
    arms: NDArray[np.int64]
    rewards: NDArray[np.float64]


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
    machines = ipywidgets.IntSlider(3, min=1, max=30, description="machines no.", **wide())
    pulls = Buttons(MACHINES, value=OPENING)
    reveal = ipywidgets.Checkbox(False, description="show their chances", indent=False)

    def new_game(_: Any) -> None:
        pulls.value, reveal.value = (), False

    machines.observe(new_game, names="value")
    return Explorer(draw_bandit, machines=machines, pulls=pulls, reveal=reveal)


def game(machines: int, pulls: Sequence[str]) -> Game:
    """Return what a series of presses pays.

    Parameters
    ----------
    machines : int
        The number of a set of machines, with its own probabilities and its own luck.
    pulls : sequence of str
        Names of `MACHINES` in the order of the presses.

    Returns
    -------
    Game

    Examples
    --------
    >>> long = game(1, MACHINES * 2).rewards
    >>> bool((game(1, MACHINES).rewards == long[:4]).all())
    True
    """
    chances, luck = np.random.default_rng(machines).spawn(2)
    bandit = Bandit(chances.uniform(0.1, 0.9, len(MACHINES)).round(2))
    arms = np.array([MACHINES.index(name) for name in pulls], dtype=np.int64)
    # Each pull takes one random number, in their order: later pulls change nothing.
    return Game(bandit, arms, bandit.pull(arms, luck))


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
    best, n = played.bandit.best, len(pulls)
    length = next((length for length in _LENGTHS if length >= n), 1000 * -(-n // 1000))
    earned = played.bandit.p[played.arms] if reveal else played.rewards
    yours = np.append(0.0, regret(earned, best)) if n else np.zeros(1)
    others = crowd(machines, length, luck=not reveal)
    if n:
        ends = ", ".join(f"{name} {mean[n]:.1f}" for name, (mean, _) in others.items())
        fact = (
            f"{_count(n, 'pull')}, {_count(int(played.rewards.sum()), 'coin')}: regret "
            f"{yours[-1]:.1f} with{'out' * reveal} luck; {ends}"
        )
    else:
        fact = "no pull yet: which of the four machines pays best?"
    return Scene(fact, [_machines(played, reveal), _regrets(yours, others, length, reveal)])


@cache
def crowd(
    machines: int, length: int, *, luck: bool
) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return the mean and standard deviation of the regret of the players of each strategy.

    Parameters
    ----------
    machines : int
        The number of a set of machines, as for `game`.
    length : int
        The number of pulls, at least 1. A short game is the beginning of a longer one.
    luck : bool
        Whether regret counts what the pulls paid, or what they pay on average.

    Returns
    -------
    dict of str to (mean, std), each of shape (length + 1,)
        After no pull, after one, ...

    Examples
    --------
    >>> {name: float(mean[40].round(1)) for name, (mean, std) in crowd(3, 40, luck=False).items()}
    {'random': 9.4, 'epsilon-greedy': 6.6, 'Boltzmann': 6.6, 'UCB': 7.3}
    """
    bandit = game(machines, ()).bandit
    # The first two generators belong to the student's game.
    rngs = np.random.default_rng(machines).spawn(2 + len(STRATEGIES))[2:]
    found = {}
    for (name, strategy), rng in zip(STRATEGIES.items(), rngs, strict=True):
        played = play(bandit, strategy, length, players=PLAYERS, rng=rng)
        so_far = regret(played.rewards if luck else played.expected, bandit.best)
        found[name] = np.append(0.0, so_far.mean(axis=0)), np.append(0.0, so_far.std(axis=0))
    return found


def _count(n: int, what: str) -> str:
    return f"{n} {what}{'s' * (n != 1)}"


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
    yours: NDArray[np.float64],
    others: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]],
    length: int,
    reveal: bool,
) -> Panel:
    n = len(yours) - 1
    k = np.arange(n + 1.0)
    top = max(1.7 * float(others["random"][0][-1]), 1.1 * float(yours.max()), 5.0)
    ends, heights = (0.0, 1.03 * length), (-0.15 * top, top)
    bands: list[Layer] = []
    lines: list[Layer] = []
    told = {"you": (yours[n], 0.0)} | {name: (m[n], s[n]) for name, (m, s) in others.items()}
    colors = dict(zip([*others, "you"], SERIES, strict=True))
    for name, (mean, std) in others.items():
        low, high = (mean - std)[: n + 1], (mean + std)[: n + 1]
        bands.append(between(k, low, high, (*ends, *heights), colors[name] + "2b"))
        lines.append(Line(k, mean[: n + 1], colors[name], 1.6))
    lines += [Line(k, yours, style.OURS, 2.6), Points([n], yours[-1:], 5.0, style.OURS)]
    for row, (name, (mean, std)) in enumerate(told.items()):
        y = top * (0.95 - 0.075 * row)
        spread = "" if name == "you" else f" ± {std:.1f}"
        lines.append(Line([0.02 * length, 0.07 * length], [y, y], colors[name], 2.6))
        lines.append(Text(0.09 * length, y, f"{name}: {mean:.1f}{spread}"))
    ylabel = f"regret so far (coins), with{'out' * reveal} luck"
    return Panel("pulls so far", ylabel, ends, heights, [*bands, *lines], width=1.45)
