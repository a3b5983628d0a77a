"""The belief explorer: an action, then an observation, and what is known after each of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import combinations
from typing import Any

import ipywidgets
import numpy as np
import traitlets
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import probability
from arkaq_edu.pomdp import POMDP, Trajectory, entropy, problem, successors
from arkaq_edu.pomdp.simplex import CORNERS, TETRAHEDRON
from arkaq_edu.pomdp.turns import WORLD, follow, possible
from arkaq_edu.widgets.explorer import START_AGAIN, WRAP, Explorer, button, close_whole, offer
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text, box

#: The problems of the menu.
PROBLEMS = ("corridor", "floors", "tiger", "ball_side", "three_places")

Floats = NDArray[np.float64]


class Turns(ipywidgets.VBox):
    """A menu of problems and two rows of buttons: what to do, then what is seen.

    Only what can follow is offered: an action, then an observation with a probability above zero.

    Parameters
    ----------
    problems : mapping of str to POMDP
        The problems of the menu.
    seed : int
        The seed of the observations that the world answers with.

    Attributes
    ----------
    value : tuple of str
        The problem, then the pressed buttons. It can be set, too. What cannot follow raises a
        ``ValueError``.

    Examples
    --------
    >>> turns = Turns({"floors": problem("floors")})
    >>> turns.press("down")
    >>> turns.press("dark")
    >>> turns.value
    ('floors', 'down', 'dark')
    >>> turns.press("dark")
    Traceback (most recent call last):
    ValueError: action must be one of down, up, got 'dark'
    """

    value = traitlets.Tuple()

    def __init__(self, problems: Mapping[str, POMDP], seed: int = 0) -> None:
        self.problems, self.seed = problems, seed
        self._shown = ""  # the problem whose buttons are shown
        label = {"description_width": "5em"}
        self.menu = ipywidgets.Dropdown(
            options=list(problems),
            description="problem",
            style=label,
            tooltip="Another problem: start again",
        )
        again = button(START_AGAIN, lambda: self.set_trait("value", self.value[:1]))
        self.actions, self.observations = (ipywidgets.HBox(layout=WRAP) for _ in range(2))
        first = ipywidgets.HBox([self.menu, again], layout=WRAP)
        super().__init__([first, self.actions, self.observations])
        self.value = (self.menu.value,)
        self.menu.observe(self._chosen, names="value")

    def press(self, name: str) -> None:
        """Press the button of that name."""
        self.value = (*self.value, name)

    def _chosen(self, change: Any) -> None:
        if change["new"] != self.value[0]:
            self.value = (change["new"],)

    @traitlets.validate("value")
    def _possible(self, proposal: Any) -> tuple[str, ...]:
        name, *presses = proposal["value"]
        if name not in self.problems:
            raise ValueError(f"problem must be one of {', '.join(self.problems)}, got {name!r}")
        follow(self.problems[name], presses, self.seed)
        return (name, *presses)

    @traitlets.observe("value")
    def _offer(self, change: Any) -> None:
        name, *presses = change["new"]
        pomdp = self.problems[name]
        if name != self._shown:
            self._shown = self.menu.value = name
            self._fill(self.actions, "do", pomdp.actions)
            self._fill(self.observations, "see", (*pomdp.observations, WORLD))
        track = follow(pomdp, presses, self.seed)
        waits = track.pending is not None
        offers = {
            self.actions: () if waits else pomdp.actions,
            self.observations: (*possible(pomdp, track), WORLD) if waits else (),
        }
        for row, offered in offers.items():
            for each in row.children[1:]:
                offer(each, each.description in offered)

    def _fill(self, row: ipywidgets.HBox, label: str, names: Iterable[str]) -> None:
        for old in row.children:
            close_whole(old)
        right = {"width": "5em", "justify_content": "flex-end"}
        word = ipywidgets.Label(label, layout=right, tooltip="")
        row.children = [word, *(button(name, partial(self.press, name)) for name in names)]


def belief_explorer(seed: int = 0) -> Explorer:
    """Return buttons for actions and observations above the belief they lead to.

    Parameters
    ----------
    seed : int
        The seed of the observations that the world answers with. The same seed and the same
        buttons give the same answers.

    Returns
    -------
    Explorer
        Its control is ``controls["turns"]``, a `Turns`.

    References
    ----------
    Thesis, sections 2.3.1 and 2.3.2, figures 2.6 to 2.8 and 2.13.

    Examples
    --------
    >>> explorer = belief_explorer()
    >>> explorer
    corridor, at first: first, second or fourth .33 each; 1.58 bits of doubt
    >>> explorer.controls["turns"].press("right")
    >>> explorer
    corridor, step 1, right: nothing .67 or goal .33?
    >>> explorer.controls["turns"].press("nothing")
    >>> explorer
    corridor, step 1, right then nothing: second or fourth .45 each; 1.37 bits of doubt
    """
    problems = {name: problem(name) for name in PROBLEMS}
    return Explorer(partial(draw, problems, seed), turns=Turns(problems, seed))


def draw(problems: Mapping[str, POMDP], seed: int, turns: tuple[str, ...]) -> Scene:
    """Return the picture of a trajectory: its trail, the belief, and the chances of observations.

    Parameters
    ----------
    problems : mapping of str to POMDP
        The models by name.
    seed : int
        The seed of the observations that the world answers with.
    turns : tuple of str
        The problem, then the pressed buttons.

    Returns
    -------
    Scene
    """
    name, *presses = turns
    pomdp = problems[name]
    track = follow(pomdp, presses, seed)
    panels = [_trail(pomdp, track), _known(pomdp, track), _chances(pomdp, track)]
    return Scene(f"{name}, {_fact(pomdp, track)}", panels)


def _fact(pomdp: POMDP, track: Trajectory) -> str:
    if track.pending is not None:
        seen = [f"{z} {probability(p)}" for z, p in possible(pomdp, track).items()]
        return f"step {len(track.steps) + 1}, {pomdp.actions[track.pending]}: {_or(seen)}?"
    b = track.beliefs[-1]
    likeliest = [s for s, p in zip(pomdp.states, b, strict=True) if np.isclose(p, b.max())]
    each = " each" if len(likeliest) > 1 else ""
    known = f"{_or(likeliest)} {probability(b.max())}{each}; {entropy(b):.2f} bits of doubt"
    if not track.steps:
        return f"at first: {known}"
    a, z = track.steps[-1]
    return f"step {len(track.steps)}, {pomdp.actions[a]} then {pomdp.observations[z]}: {known}"


def _or(words: list[str]) -> str:
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _trail(pomdp: POMDP, track: Trajectory) -> Panel:
    """Draw where the belief has been: a dot after each step, a bend for each prediction."""
    if pomdp.n_states == 2:
        return _line(pomdp, track)
    corners = CORNERS if pomdp.n_states == 3 else TETRAHEDRON
    layers: list[Layer] = []
    for i, j in combinations(range(len(corners)), 2):
        x, y = corners[[i, j]].T
        # The edge from the first to the third corner of a tetrahedron is at the back.
        layers.append(Line(x, y, style.QUIET, 1.0, dashed=len(corners) == 4 and (i, j) == (0, 2)))
    places = np.array(track.beliefs) @ corners
    layers += _path(places[:, 0], places[:, 1])
    for (x, y), state in zip(corners, pomdp.states, strict=True):
        beside = 0.2 < y < 0.8  # if not, the name is above or below the corner
        left = x + 0.04 if beside else x - 0.015 * len(state) - 0.07 * (x == 0)
        at = y if beside else y + (0.07 if y > 0.5 else -0.07)
        layers.append(Text(left, at, state, style.QUIET))
    return Panel("", "", (-0.2, 1.3), (-0.25, 1.1), layers, width=1.05, bare=True)


def _line(pomdp: POMDP, track: Trajectory) -> Panel:
    """Draw the line of figure 2.8 once for each step, the newest at the bottom."""
    first = np.array(track.beliefs)[:, 0]
    steps = np.arange(len(first)) / 2
    last = max(8, int(np.ceil(steps[-1])))
    layers: list[Layer] = [
        Line([0.5, 0.5], [0, last], style.QUIET, 0.8, dashed=True),
        *_path(first, steps),
    ]
    label = f"p({pomdp.states[0]})"
    return Panel(label, "step", (-0.03, 1.03), (last + 0.4, -0.4), layers, xticks=[0, 0.5, 1])


def _path(x: Floats, y: Floats) -> list[Layer]:
    return [
        Line(x, y, style.OURS, 1.2),
        Points(x[::2], y[::2], 3.5, style.OURS),
        Points(x[-1:], y[-1:], 7.0, style.OURS),
    ]


def _known(pomdp: POMDP, track: Trajectory) -> Panel:
    """Draw the belief as bars, and the belief half a step earlier as outlines."""
    S, now = pomdp.n_states, track.beliefs[-1]
    rows = np.arange(S)[::-1]
    caption, before, outlines = "the belief at first", np.zeros(S), []
    if len(track.beliefs) > 1:
        before = track.beliefs[-2]
        names = ("before", "predicted", "corrected")
        old, new = names[1:] if track.pending is None else names[:2]
        caption = f"filled: {new}; outlined: {old}"
        outlines = [
            Line.around(_bar(p, y), style.INK, 1.0) for p, y in zip(before, rows, strict=True)
        ]
    layers = [
        *_bars(pomdp.states, now, rows, style.OURS, -0.72, np.maximum(now, before), style.OURS),
        *outlines,
        Text(-0.72, S - 0.3, caption, style.QUIET),
    ]
    return Panel(
        "probability of the state", "", (-0.75, 1.3), (min(S, 4) - 4.6, S), layers,
        xticks=[0, 0.5, 1], yticks=[], width=1.1,
    )  # fmt: skip


def _chances(pomdp: POMDP, track: Trajectory) -> Panel:
    """Draw the probability of each observation, after each action that can be chosen now."""
    layers: list[Layer] = []
    y = 0.0
    pending = track.pending
    belief = track.beliefs[-1 if pending is None else -2]
    for a in range(pomdp.n_actions) if pending is None else [pending]:
        action, chances = pomdp.actions[a], successors(pomdp, belief, a).chances
        rows = y - 1 - np.arange(pomdp.n_observations)
        layers.append(Text(-0.92, y, f"after {action}", style.QUIET))
        layers += _bars(pomdp.observations, chances, rows, style.POMDP_ACTIONS[action], -0.86)
        y = rows[-1] - 1.3
    return Panel(
        "chance of the observation", "", (-0.95, 1.3), (min(y, -6.0), 0.8), layers,
        xticks=[0, 0.5, 1], yticks=[], width=1.2,
    )  # fmt: skip


def _bars(
    names: Sequence[str], p: Floats, rows: NDArray[Any], color: str, left: float,
    ends: Floats | None = None, ink: str = style.INK,
) -> list[Layer]:  # fmt: skip
    """Return a bar for each probability, with its name on the left and itself on the right."""
    within = (0.0, 1.0, float(rows.min()) - 0.5, float(rows.max()) + 0.5)
    layers: list[Layer] = [Cells.shape(list(map(_bar, p, rows)), color, within)]
    for name, value, end, y in zip(names, p, p if ends is None else ends, rows, strict=True):
        layers += [Text(left, y, name), Text(end + 0.03, y, probability(value), ink)]
    return layers


def _bar(p: float, y: float) -> Floats:
    return box(0, p, y - 0.3, y + 0.3)
