"""The belief explorer: an action, then an observation, and what is known after each of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

import ipywidgets
import numpy as np
import traitlets
from numpy.typing import NDArray

from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.pomdp import COLORS, short
from arkaq_edu.pomdp import POMDP, belief_update, predict, problem, successors
from arkaq_edu.pomdp.simplex import CORNERS
from arkaq_edu.widgets.explorer import Explorer
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Points, Scene, Text

#: The problems of the menu, and the press that leaves the observation to chance.
PROBLEMS = ("corridor", "floors", "tiger", "ball_side", "three_places")
WORLD = "let the world answer"

Floats = NDArray[np.float64]

# Corners of the simplex of four states, in their order: a tetrahedron seen from outside, the edge
# from its first corner to its third at the back.
_TETRAHEDRON = np.array([[0.0, 0.12], [0.42, 0.95], [1.0, 0.4], [0.6, -0.05]])
_HIDDEN = (0, 2)


class Walk(NamedTuple):
    """What presses lead to.

    Attributes
    ----------
    beliefs : list of ndarray, shape (S,)
        The belief at the start, then after each half turn: predicted, corrected, predicted, ...
    turns : list of tuple of int
        The action and the observation of each whole turn.
    pending : int or None
        The action that still waits for its observation.
    """

    beliefs: list[Floats]
    turns: list[tuple[int, int]]
    pending: int | None


def walk(pomdp: POMDP, presses: Iterable[str], seed: int = 0) -> Walk:
    """Return the beliefs that presses lead to, an action and an observation in turn.

    Parameters
    ----------
    pomdp : POMDP
        The model; its start is the belief before the first action.
    presses : iterable of str
        Names of an action, an observation, an action, ...; `WORLD` in the place of an observation
        draws one with the chances that the belief gives them.
    seed : int
        Where these draws come from, together with the number of the turn.

    Returns
    -------
    Walk

    Raises
    ------
    ValueError
        If a name is none of the model's, or an observation cannot follow.

    References
    ----------
    Thesis, section 2.3.2, equation 2.15.

    Examples
    --------
    >>> walk(problem("floors"), ["down", "dark", "down"]).beliefs[-1]
    array([0.  , 0.  , 0.25, 0.75])
    """
    beliefs: list[Floats] = [pomdp.start]
    turns: list[tuple[int, int]] = []
    pending: int | None = None
    for press in presses:
        b = beliefs[-1]
        if pending is None:
            pending = _index("action", press, pomdp.actions)
            beliefs.append(predict(pomdp, b, pending))
            continue
        if press == WORLD:
            chances = beliefs[-1] @ pomdp.O[pending]
            rng = np.random.default_rng([seed, len(turns)])
            z = int(rng.choice(pomdp.n_observations, p=chances / chances.sum()))
        else:
            z = _index("observation", press, pomdp.observations)
        beliefs.append(belief_update(pomdp, beliefs[-2], pending, z))
        turns.append((pending, z))
        pending = None
    return Walk(beliefs, turns, pending)


def possible(pomdp: POMDP, way: Walk) -> list[str]:
    """Return what may be pressed next: every action, or each observation that can follow.

    Examples
    --------
    >>> corridor = problem("corridor")
    >>> possible(corridor, walk(corridor, ["right", "goal", "left"]))
    ['nothing']
    """
    if way.pending is None:
        return list(pomdp.actions)
    chances = way.beliefs[-1] @ pomdp.O[way.pending]
    return [z for z, p in zip(pomdp.observations, chances, strict=True) if p > 0]


def _index(kind: str, name: str, names: tuple[str, ...]) -> int:
    if name not in names:
        raise ValueError(f"{kind} must be one of {', '.join(names)}, got {name!r}")
    return names.index(name)


class Turns(ipywidgets.VBox):
    """A menu of problems and two rows of buttons: what to do, then what is seen.

    Only what can follow is offered: an action, then an observation of a chance above zero.

    Parameters
    ----------
    problems : mapping of str to POMDP
        What the menu offers.
    seed : int
        For the answers of the world; see `walk`.

    Attributes
    ----------
    value : tuple of str
        The problem, then what was pressed. Setting it is as good as pressing; what cannot be is
        refused with a ``ValueError``.

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
        self._shown = ""  # the problem whose buttons stand there
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
        """Do what a click on the button of that name does."""
        self._set((*self.value, name))

    def _chosen(self, change: Any) -> None:
        if change["new"] != self.value[0]:
            self._set((change["new"],))

    def _set(self, value: tuple[str, ...]) -> None:
        self.value = value

    @traitlets.validate("value")
    def _possible(self, proposal: Any) -> tuple[str, ...]:
        name, *presses = proposal["value"]
        _index("problem", name, tuple(self.problems))
        walk(self.problems[name], presses, self.seed)
        return (name, *presses)

    @traitlets.observe("value")
    def _offer(self, change: Any) -> None:
        name, *presses = change["new"]
        pomdp = self.problems[name]
        if name != self._shown:
            self._shown = self.menu.value = name
            self.actions.children = self._row("do", pomdp.actions)
            self.observations.children = self._row("see", (*pomdp.observations, WORLD))
        offered = {WORLD, *possible(pomdp, walk(pomdp, presses, self.seed))}
        for row in (self.actions, self.observations):
            waits = (row is self.observations) == bool(len(presses) % 2)
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
        For the answers of the world: the same seed and the same presses, the same answers.

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
    """Return the picture of a walk: its trail through the beliefs, the belief, what may be seen.

    Parameters
    ----------
    problems : mapping of str to POMDP
        The models by name.
    seed : int
        For the answers of the world; see `walk`.
    turns : tuple of str
        The problem, then what was pressed.

    Returns
    -------
    Scene
    """
    name, *presses = turns
    pomdp = problems[name]
    way = walk(pomdp, presses, seed)
    panels = [_trail(pomdp, way), _bars(pomdp, way), _chances(pomdp, way)]
    return Scene(f"{name}, {_fact(pomdp, way)}", panels)


def entropy(b: Floats) -> float:
    """Return how much is not known, in bits: 0 for a sure belief, 1 for an even two.

    Examples
    --------
    >>> entropy(np.array([0.5, 0.5])), entropy(np.array([1.0, 0.0]))
    (1.0, 0.0)
    """
    p = b[b > 0]
    return abs(float(p @ np.log2(p)))


def _fact(pomdp: POMDP, way: Walk) -> str:
    if way.pending is not None:
        chances = way.beliefs[-1] @ pomdp.O[way.pending]
        seen = [f"{z} {short(p)}" for z, p in zip(pomdp.observations, chances, strict=True) if p]
        return f"step {len(way.turns) + 1}, {pomdp.actions[way.pending]}: {_or(seen)}?"
    b = way.beliefs[-1]
    likeliest = [s for s, p in zip(pomdp.states, b, strict=True) if np.isclose(p, b.max())]
    each = " each" if len(likeliest) > 1 else ""
    known = f"{_or(likeliest)} {short(b.max())}{each}; {entropy(b):.2f} bits of doubt"
    if not way.turns:
        return f"at first: {known}"
    a, z = way.turns[-1]
    return f"step {len(way.turns)}, {pomdp.actions[a]} then {pomdp.observations[z]}: {known}"


def _or(words: list[str]) -> str:
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _trail(pomdp: POMDP, way: Walk) -> Panel:
    """Draw where the belief has been; whole turns are dots, predictions bends of the line."""
    if pomdp.n_states == 2:
        return _line(pomdp, way)
    corners = CORNERS if pomdp.n_states == 3 else _TETRAHEDRON
    layers: list[Layer] = []
    for i, j in zip(*np.triu_indices(len(corners), 1), strict=True):
        hidden = len(corners) == 4 and (i, j) == _HIDDEN
        x, y = corners[[i, j]].T
        layers.append(Line(x, y, style.QUIET, 1.0, dashed=hidden))
    places = np.array(way.beliefs) @ corners
    layers += _way(places[:, 0], places[:, 1])
    for (x, y), state in zip(corners, pomdp.states, strict=True):
        beside = 0.2 < y < 0.8  # else above or below the corner
        left = x + 0.04 if beside else x - 0.015 * len(state) - 0.07 * (x == 0)
        at = y if beside else y + (0.07 if y > 0.5 else -0.07)
        layers.append(Text(left, at, state, style.QUIET))
    return Panel("", "", (-0.2, 1.3), (-0.25, 1.1), layers, width=1.05, bare=True)


def _line(pomdp: POMDP, way: Walk) -> Panel:
    """Draw figure 2.8's line once for each step, the newest at the bottom."""
    first = np.array(way.beliefs)[:, 0]
    steps = np.arange(len(first)) / 2
    last = max(8, int(np.ceil(steps[-1])))
    layers: list[Layer] = [
        Line([0.5, 0.5], [0, last], style.QUIET, 0.8, dashed=True),
        *_way(first, steps),
    ]
    label = f"p({pomdp.states[0]})"
    return Panel(label, "step", (-0.03, 1.03), (last + 0.4, -0.4), layers, xticks=[0, 0.5, 1])


def _way(x: Floats, y: Floats) -> list[Layer]:
    return [
        Line(x, y, style.OURS, 1.2),
        Points(x[::2], y[::2], 3.5, style.OURS),
        Points(x[-1:], y[-1:], 7.0, style.OURS),
    ]


def _bars(pomdp: POMDP, way: Walk) -> Panel:
    """Draw the belief as bars, and the one half a turn earlier as outlines."""
    S = pomdp.n_states
    rows = np.arange(S)[::-1]
    layers: list[Layer] = [_blocks(way.beliefs[-1], rows, style.OURS)]
    told, before = "the belief at first", np.zeros(S)
    if len(way.beliefs) > 1:
        before = way.beliefs[-2]
        now, then = ("corrected", "predicted") if way.pending is None else ("predicted", "before")
        told = f"filled: {now}; outlined: {then}"
        for p, y in zip(before, rows, strict=True):
            x, edge = _block(p, y).T
            layers.append(Line(x, edge, style.INK, 1.0))
    for state, p, old, y in zip(pomdp.states, way.beliefs[-1], before, rows, strict=True):
        layers.append(Text(-0.72, y, state))
        layers.append(Text(max(p, old) + 0.03, y, short(p), style.OURS))
    layers.append(Text(-0.72, S - 0.3, told, style.QUIET))
    return Panel(
        "probability of the state", "", (-0.75, 1.3), (min(S, 4) - 4.6, S), layers,
        xticks=[0, 0.5, 1], yticks=[], width=1.1,
    )  # fmt: skip


def _chances(pomdp: POMDP, way: Walk) -> Panel:
    """Draw how likely each observation is, after each action that may be chosen now."""
    layers: list[Layer] = []
    y = 0.0
    for a, action in enumerate(pomdp.actions):
        if way.pending is None:
            chances = successors(pomdp, way.beliefs[-1], a).chances
        elif way.pending == a:
            chances = way.beliefs[-1] @ pomdp.O[a]
        else:
            continue
        layers.append(Text(-0.92, y, f"after {action}", style.QUIET))
        rows = y - 1 - np.arange(pomdp.n_observations)
        layers.append(_blocks(chances, rows, COLORS[action]))
        for name, p, row in zip(pomdp.observations, chances, rows, strict=True):
            layers.append(Text(-0.86, row, name))
            layers.append(Text(p + 0.03, row, short(p)))
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
