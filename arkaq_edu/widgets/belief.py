"""The belief explorer: an action, then an observation, and what is known after each of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import ipywidgets
import numpy as np
import traitlets
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.drawing.style import probability
from arkaq_edu.pomdp import POMDP, Trajectory, entropy, problem, successors, to_triangle, trajectory
from arkaq_edu.widgets.explorer import Explorer
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: The problems of the menu, and the button that leaves the observation to chance.
PROBLEMS = ("corridor", "floors", "tiger", "ball_side", "three_places")
WORLD = "let the world answer"

Floats = NDArray[np.float64]

# The corners of a tetrahedron, the simplex of four states, as seen from outside. The edge from the
# first to the third corner is at the back.
_TETRAHEDRON = np.array([[0.0, 0.12], [0.42, 0.95], [1.0, 0.4], [0.6, -0.05]])
_HIDDEN = (0, 2)


def follow(pomdp: POMDP, presses: Iterable[str], seed: int) -> Trajectory:
    """Return the beliefs that the pressed buttons lead to.

    Examples
    --------
    >>> follow(problem("floors"), ["down", WORLD], 0).steps
    [(0, 0)]
    """
    return trajectory(pomdp, [None if name == WORLD else name for name in presses], seed)


def chances(pomdp: POMDP, track: Trajectory) -> dict[str, float]:
    """Return the probability of each observation after the action that waits for one.

    Examples
    --------
    >>> corridor = problem("corridor")
    >>> chances(corridor, follow(corridor, ["right", "goal", "left"], 0))
    {'nothing': 1.0, 'goal': 0.0}
    """
    assert track.pending is not None
    p = successors(pomdp, track.beliefs[-2], track.pending).chances
    return dict(zip(pomdp.observations, p.tolist(), strict=True))


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
        self.menu = ipywidgets.Dropdown(options=list(problems), description="problem")
        self.menu.style.description_width = "5em"
        again = _button("start again", lambda: self._set(self.value[:1]))
        self.actions, self.observations = ipywidgets.HBox(), ipywidgets.HBox()
        rows = [ipywidgets.HBox([self.menu, again]), self.actions, self.observations]
        for row in rows:
            row.layout.flex_flow = "row wrap"
        super().__init__(rows)
        self._set((self.menu.value,))
        self.menu.observe(self._chosen, names="value")

    def press(self, name: str) -> None:
        """Press the button of that name."""
        self._set((*self.value, name))

    def _chosen(self, change: Any) -> None:
        if change["new"] != self.value[0]:
            self._set((change["new"],))

    def _set(self, value: tuple[str, ...]) -> None:
        self.value = value

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
            self.actions.children = self._row("do", pomdp.actions)
            self.observations.children = self._row("see", (*pomdp.observations, WORLD))
        track = follow(pomdp, presses, self.seed)
        offered = {WORLD, *pomdp.actions}
        if track.pending is not None:
            offered = {WORLD, *(z for z, p in chances(pomdp, track).items() if p)}
        for row in (self.actions, self.observations):
            waits = (row is self.observations) == (track.pending is not None)
            for button in row.children[1:]:
                button.disabled = not waits or button.description not in offered

    def _row(self, label: str, names: Iterable[str]) -> list[ipywidgets.Widget]:
        word = ipywidgets.Label(label, layout={"width": "5em", "justify_content": "flex-end"})
        return [word, *(_button(name, partial(self.press, name)) for name in names)]


def _button(name: str, act: Callable[[], None]) -> ipywidgets.Button:
    button = ipywidgets.Button(description=name, layout={"width": "auto"})
    button.on_click(lambda _: act())
    return button


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
    panels = [_trail(pomdp, track), _bars(pomdp, track), _chances(pomdp, track)]
    return Scene(f"{name}, {_fact(pomdp, track)}", panels)


def _fact(pomdp: POMDP, track: Trajectory) -> str:
    if track.pending is not None:
        seen = [f"{z} {probability(p)}" for z, p in chances(pomdp, track).items() if p]
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
    corners = to_triangle(np.eye(3)) if pomdp.n_states == 3 else _TETRAHEDRON
    layers: list[Layer] = []
    for i, j in zip(*np.triu_indices(len(corners), 1), strict=True):
        hidden = len(corners) == 4 and (i, j) == _HIDDEN
        x, y = corners[[i, j]].T
        layers.append(Line(x, y, style.QUIET, 1.0, dashed=hidden))
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


def _bars(pomdp: POMDP, track: Trajectory) -> Panel:
    """Draw the belief as bars, and the belief half a step earlier as outlines."""
    S = pomdp.n_states
    rows = np.arange(S)[::-1]
    layers: list[Layer] = [_blocks(track.beliefs[-1], rows, style.OURS)]
    caption, before = "the belief at first", np.zeros(S)
    if len(track.beliefs) > 1:
        before = track.beliefs[-2]
        now, then = ("corrected", "predicted") if track.pending is None else ("predicted", "before")
        caption = f"filled: {now}; outlined: {then}"
        for p, y in zip(before, rows, strict=True):
            x, edge = _block(p, y).T
            layers.append(Line(x, edge, style.INK, 1.0))
    for state, p, old, y in zip(pomdp.states, track.beliefs[-1], before, rows, strict=True):
        layers.append(Text(-0.72, y, state))
        layers.append(Text(max(p, old) + 0.03, y, probability(p), style.OURS))
    layers.append(Text(-0.72, S - 0.3, caption, style.QUIET))
    return Panel(
        "probability of the state", "", (-0.75, 1.3), (min(S, 4) - 4.6, S), layers,
        xticks=[0, 0.5, 1], yticks=[], width=1.1,
    )  # fmt: skip


def _chances(pomdp: POMDP, track: Trajectory) -> Panel:
    """Draw the probability of each observation, after each action that can be chosen now."""
    layers: list[Layer] = []
    y = 0.0
    waiting = track.pending is not None
    belief = track.beliefs[-2 if waiting else -1]
    for a, action in enumerate(pomdp.actions):
        if waiting and a != track.pending:
            continue
        chances = successors(pomdp, belief, a).chances
        layers.append(Text(-0.92, y, f"after {action}", style.QUIET))
        rows = y - 1 - np.arange(pomdp.n_observations)
        layers.append(_blocks(chances, rows, style.POMDP_ACTIONS[action]))
        for name, p, row in zip(pomdp.observations, chances, rows, strict=True):
            layers.append(Text(-0.86, row, name))
            layers.append(Text(p + 0.03, row, probability(p)))
        y = rows[-1] - 1.3
    return Panel(
        "chance of the observation", "", (-0.95, 1.3), (min(y, -6.0), 0.8), layers,
        xticks=[0, 0.5, 1], yticks=[], width=1.2,
    )  # fmt: skip


def _block(p: float, y: float) -> Floats:
    return np.array([[0, y - 0.3], [p, y - 0.3], [p, y + 0.3], [0, y + 0.3], [0, y - 0.3]])


def _blocks(lengths: Floats, rows: NDArray[Any], color: str) -> Cells:
    blocks = [_block(p, y) for p, y in zip(lengths, rows, strict=True)]
    within = (0.0, 1.0, float(rows.min()) - 0.5, float(rows.max()) + 0.5)
    return Cells(blocks, [0] * len(blocks), within, [color], border=0)
