"""Explorers that live without a kernel: what they show at every stop, packed into a file each.

A scene is data already. So the scenes of all stops are computed when the site is made, and the
page draws them by the same canvas.js as a notebook. What scenes share is stored once: a panel, a
layer, its numbers.

A setting is a tuple of numbers of stops, one for each handle: a slider, a menu, a box, or the
presses of buttons. Where an explorer has too many settings, `LIVING` says which stops are kept.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

import ipywidgets
import numpy as np
from joblib import delayed
from numpy.typing import NDArray

from arkaq_edu import widgets
from arkaq_edu.experiments import approach, goal
from arkaq_edu.experiments.runs import run_all
from arkaq_edu.site.packing import rounded, to_bytes, write_script
from arkaq_edu.site.robots import RECORDINGS, recorded
from arkaq_edu.widgets import Buttons, Drag, Explorer
from arkaq_edu.widgets.belief import Turns
from arkaq_edu.widgets.explorer import START_AGAIN, is_offered
from arkaq_edu.widgets.field import Presses
from arkaq_edu.widgets.scene import Scene

START = "start"  #: A control that stays where it starts.
ALL = "all"  #: A control with all of its stops.

Kept = Mapping[str, Any]
Path_ = tuple[Any, ...]


@dataclass(frozen=True)
class Living:
    """How an explorer lives on a page.

    Attributes
    ----------
    make : callable
        Returns the explorer.
    products : sequence of mapping
        Which settings are kept: for each mapping all combinations of the stops that it names by
        control; a control that it does not name keeps all of its stops.
    presses : callable, optional
        Returns what may be pressed, from the control with the buttons.
    told : str
        What buttons do only in the notebook.
    """

    make: Callable[[], Explorer]
    products: Sequence[Kept] = ({},)
    presses: Callable[[Any], list[Path_]] | None = None
    told: str = ""


def _pulls(buttons: Buttons, depth: int = 4) -> list[Path_]:
    """Return games of up to `depth` pulls, from nothing and from where the explorer opens."""
    turns = [turn for n in range(depth + 1) for turn in product(buttons.names, repeat=n)]
    return [(*opening, *turn) for opening in ((), buttons.value) for turn in turns]


def _turns(turns: Turns, most: int = 700) -> list[Path_]:
    """Return the histories of each problem, the short ones first, until there are `most`."""
    found: list[Path_] = []
    for name in turns.problems:
        queue: list[Path_] = [(name,)]
        for path in queue:
            turns.value = path
            rows = (turns.actions, turns.observations)
            offered = [b.description for row in rows for b in row.children[1:] if is_offered(b)]
            if len(queue) + len(offered) <= most:
                queue += [(*path, each) for each in offered]
        found += queue
    return found


def _drives(presses: Presses, depth: int = 2) -> list[Path_]:
    """Return up to `depth` presses, with the sliders as they are."""
    every = [presses.record(name) for name in presses.names]
    return [path for n in range(depth + 1) for path in product(every, repeat=n)]


#: How each explorer of the chapters lives, by the call that ends its cell.
LIVING: dict[str, Living] = {
    "horizon_explorer()": Living(widgets.horizon_explorer),
    "bandit_explorer()": Living(
        widgets.bandit_explorer,
        ({"machines": START}, {"pulls": ((),)}),
        _pulls,
        "a game on these machines goes on for four pulls, in the notebook for as long as you like",
    ),
    "planning_explorer()": Living(
        widgets.planning_explorer,
        ({"gamma": (0.5, 0.7, 0.8, 0.9, 0.95), "slip": (0, 0.1, 0.2, 0.3, 0.5)},),
    ),
    "q_learning_explorer()": Living(widgets.q_learning_explorer),
    "belief_explorer()": Living(
        widgets.belief_explorer,
        presses=_turns,
        told="a history ends after a few steps, in the notebook it goes on",
    ),
    "value_explorer()": Living(widgets.value_explorer),
    "bowl_explorer()": Living(
        widgets.bowl_explorer,
        ({"view.0": range(-170, 181, 12), "view.1": (0, 10, 24, 38, 52, 66, 80, 90)},),
    ),
    "kalman_explorer()": Living(
        widgets.kalman_explorer,
        ({"r": slice(0, None, 4), "q": slice(0, None, 4), "dropout": (0, 0.2, 0.4, 0.6, 0.8)},),
    ),
    "letters_explorer()": Living(widgets.letters_explorer),
    "resonance_explorer()": Living(widgets.resonance_explorer),
    "vigilance_explorer()": Living(
        widgets.vigilance_explorer,
        (
            {"method": ("Euclidean",), "cosine": START, "order": START, "eta": START, "n": START},
            {"method": ("Euclidean",), "cosine": START, "eta": START, "n": START,
             "vigilance": (0.05, 0.075, 0.1, 0.15, 0.2)},
            {"method": ("Euclidean",), "cosine": START, "order": START, "n": START,
             "vigilance": (0.05, 0.075, 0.1, 0.15, 0.2), "eta": (0.05, 0.2, 0.5, 1.0)},
            {"method": ("Euclidean",), "cosine": START, "order": START, "eta": START,
             "vigilance": (0.05, 0.075, 0.1, 0.15, 0.2)},
            {"method": ("angular",), "vigilance": START, "eta": START, "n": START},
        ),
    ),
    "control_panel()": Living(
        widgets.control_panel,
        ({"presses": ((),), "head": START}, {"left": START, "right": START, "head": START}),
        _drives,
        "the buttons walk with the strides as they are at first, for two presses; in the "
        "notebook they take the strides and the head from the sliders",
    ),
    "sighting_explorer()": Living(widgets.sighting_explorer),
    "film_explorer(approach.trajectory(6))": Living(
        lambda: widgets.film_explorer(approach.trajectory(6))
    ),
    "film_explorer(goal.record_episode(agent, orientation=0.3, seed=4))": Living(
        lambda: widgets.film_explorer(
            goal.record_episode(goal.load_agent(), orientation=0.3, seed=4)
        )
    ),
    "scoring_explorer()": Living(
        widgets.scoring_explorer,
        ({"distance": range(1000, 3001, 250), "spread": (0, 0.5, 1.0, 1.5, 2.0)},
         {"vigilance": (0.06, 0.2, 0.5, 1.2), "spread": START}),
    ),
}  # fmt: skip


@dataclass
class Handle:
    """What a reader moves: its look, and its stops.

    Attributes
    ----------
    look : dict
        What the page needs to make it.
    values : list
        The value at each stop.
    start : int
        The stop at the beginning.
    """

    look: dict[str, Any]
    values: list[Any]
    start: int


def handles(explorer: Explorer, living: Living) -> dict[str, Handle]:
    """Return the handles of an explorer by name; a control of two sliders has two.

    Examples
    --------
    >>> made = handles(widgets.value_explorer(), LIVING["value_explorer()"])
    >>> list(made), made["belief.0"].start, made["belief.0"].look["texts"][25]
    (['horizon', 'belief.0'], 25, '0.25')
    """
    found = {}
    for name, control in explorer.controls.items():
        if isinstance(control, Drag):
            for i, part in enumerate(control.children):
                found[f"{name}.{i}"] = _handle(part)
        elif living.presses and isinstance(control, Buttons | Turns):
            found[name] = _buttons(control, living.presses)
        else:
            found[name] = _handle(control)
    return found


def _handle(control: Any) -> Handle:
    values, texts = _stops(control)
    kind = {"Dropdown": "menu", "Checkbox": "box"}.get(type(control).__name__, "slider")
    look = {"kind": kind, "label": control.description, "tip": control.tooltip, "texts": texts}
    start = next(i for i, value in enumerate(values) if _same(value, control.value))
    return Handle(look, values, start)


def _stops(control: Any) -> tuple[list[Any], list[str]]:
    if isinstance(control, ipywidgets.Checkbox):
        return [False, True], ["no", "yes"]
    if isinstance(control, ipywidgets.Dropdown | ipywidgets.SelectionSlider):
        pairs = [each if isinstance(each, tuple) else (str(each), each) for each in control.options]
        return [value for _, value in pairs], [text for text, _ in pairs]
    n = round((control.max - control.min) / control.step) + 1
    values = [round(control.min + i * control.step, 10) for i in range(n)]
    if isinstance(control, ipywidgets.FloatLogSlider):
        values = [control.base**value for value in values]
    return values, [format(value, control.readout_format) for value in values]


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, float) or isinstance(b, float):
        return bool(not isinstance(a, str) and not isinstance(b, str) and np.isclose(a, b))
    return bool(a == b)


def _buttons(control: Any, presses: Callable[[Any], list[Path_]]) -> Handle:
    """Return the handle of buttons: its stops are what was pressed so far."""
    start = control.value
    paths = list(dict.fromkeys(presses(control)))
    place = {path: i for i, path in enumerate(paths)}
    after: list[dict[str, int]] = [{} for _ in paths]
    for path in paths:
        if path and path[:-1] in place:
            after[place[path[:-1]]][_name(path[-1])] = place[path]
    menu, rows = None, {"": [["", list(getattr(control, "names", ()))]]}
    if isinstance(control, Turns):
        menu = list(control.problems)
        rows = {}
        for name in menu:
            control.value = (name,)
            rows[name] = [
                [row.children[0].value, [b.description for b in row.children[1:]]]
                for row in (control.actions, control.observations)
            ]
    control.value = start
    roots = {name: place[(name,) if menu else ()] for name in rows}
    own = [str(path[0]) if menu else "" for path in paths]
    look = {"kind": "presses", "menu": menu, "rows": rows, "roots": roots, "root": own,
            "after": after, "again": START_AGAIN}  # fmt: skip
    return Handle(look, paths, place[start])


def _name(press: Any) -> str:
    return press if isinstance(press, str) else press[0]


def settings(made: Mapping[str, Handle], products: Sequence[Kept]) -> list[tuple[int, ...]]:
    """Return the settings that are kept, each as its numbers of stops; a start is always kept.

    Examples
    --------
    >>> made = {name: Handle({}, [0, 5, 9], 1) for name in "ab"}
    >>> settings(made, [{"a": START, "b": (0, 9)}])
    [(1, 0), (1, 1), (1, 2)]
    """
    found = [
        setting
        for kept in products
        for setting in product(*(_kept(handle, kept.get(name, ALL)) for name, handle in
                                 made.items()))
    ]  # fmt: skip
    return list(dict.fromkeys(found))


def _kept(handle: Handle, kept: Any) -> list[int]:
    n = range(len(handle.values))
    if isinstance(kept, slice):
        return sorted({*n[kept], handle.start})
    if isinstance(kept, str):
        return list(n) if kept == ALL else [handle.start]
    return [i for i in n if i == handle.start or any(_same(handle.values[i], x) for x in kept)]


def scenes(
    explorer: Explorer, made: Mapping[str, Handle], kept: Iterable[tuple[int, ...]]
) -> Iterator[Scene]:
    """Yield the scene of each setting."""
    for setting in kept:
        values: dict[str, Any] = {}
        for (name, handle), stop in zip(made.items(), setting, strict=True):
            control, _, part = name.partition(".")
            value = handle.values[stop]
            values[control] = (*values.get(control, ()), value) if part else value
        for name, control in explorer.controls.items():
            if isinstance(control, Drag) and len(control.children) == 1:
                (values[name],) = values[name]
        yield explorer.draw(**values)


@dataclass
class Pack:
    """Scenes with what they share stored once.

    Attributes
    ----------
    layers, panels, scenes : list
        Each layer with where its numbers are, each panel with its layers, each scene with its fact
        and its panels. The last two name what they hold by its number.
    numbers : list of ndarray
        The numbers of the layers, one array each.

    Examples
    --------
    >>> from arkaq_edu.widgets.scene import Panel, Points
    >>> def scene(x):
    ...     panels = [Panel("", "", (0, 9), (0, 9), [Points([at], [1.0])]) for at in (x, 2.0)]
    ...     return Scene(f"at {x}", panels)
    >>> pack = Pack()
    >>> [pack.add(scene(x)) for x in (3.0, 4.0, 3.0)]
    [0, 1, 0]
    >>> len(pack.panels), len(pack.numbers)
    (3, 3)
    """

    layers: list[dict[str, Any]] = field(default_factory=list)
    panels: list[dict[str, Any]] = field(default_factory=list)
    scenes: list[list[Any]] = field(default_factory=list)
    numbers: list[NDArray[np.float32]] = field(default_factory=list)
    _known: dict[Any, int] = field(default_factory=dict)
    _end: int = 0

    def add(self, scene: Scene) -> int:
        """Add a scene, and return its number."""
        layout, raw = scene.pack()
        numbers = np.frombuffer(raw, np.float32)
        panels = []
        for panel in layout["panels"]:
            layers = [self._layer(layer, numbers) for layer in panel["layers"]]
            panels.append(self._once(self.panels, panel | {"layers": layers}))
        return self._once(self.scenes, [layout["fact"], panels])

    def _layer(self, layer: dict[str, Any], numbers: NDArray[np.float32]) -> int:
        own = numbers[layer["start"] : layer["start"] + layer["length"]]
        if layer["kind"] != "picture":
            own = rounded(own)
        key = own.tobytes()
        if key not in self._known:
            self._known[key] = self._end
            self.numbers.append(own)
            self._end += len(own)
        return self._once(self.layers, layer | {"start": self._known[key]})

    def _once(self, known: list[Any], value: Any) -> int:
        key = id(known), json.dumps(value)
        if key not in self._known:
            self._known[key] = len(known)
            known.append(value)
        return self._known[key]

    def to_bytes(self, **more: Any) -> bytes:
        """Return it all, and what else the page must know, as `packing.to_bytes` does."""
        told = {"layers": self.layers, "panels": self.panels, "scenes": self.scenes, **more}
        return to_bytes(told, np.concatenate([np.empty(0, np.float32), *self.numbers]))


def packed(living: Living) -> bytes:
    """Return an explorer as a page takes it, with what it shows at all stops that are kept."""
    explorer = living.make()
    made = handles(explorer, living)
    kept = settings(made, living.products)
    pack = Pack()
    table = [
        [*setting, pack.add(scene)]
        for setting, scene in zip(kept, scenes(explorer, made, kept), strict=True)
    ]
    drags = [(name, each) for name, each in explorer.controls.items() if isinstance(each, Drag)]
    return pack.to_bytes(
        handles=[handle.look | {"name": name, "start": handle.start}
                 for name, handle in made.items()],
        settings=table,
        hidden=_hidden(explorer, made),
        drag=[{"handles": [f"{name}.{i}" for i in range(len(each.children))],
               "values": [made[f"{name}.{i}"].values for i in range(len(each.children))],
               "gain": None if each.gain is None else each.gain.tolist()}
              for name, each in drags],
        note=_note(made, kept, living.told),
    )  # fmt: skip


def _hidden(explorer: Explorer, made: Mapping[str, Handle]) -> dict[str, list[list[str]]]:
    """Return, for each menu that hides controls and each of its stops, which ones it hides."""
    found: dict[str, list[list[str]]] = {}
    for name, handle in made.items():
        if handle.look["kind"] != "menu":
            continue
        menu = explorer.controls[name]
        hidden = []
        for value in handle.values:
            menu.value = value
            hidden.append({n for n, each in explorer.controls.items() if each.layout.display})
        menu.value = handle.values[handle.start]
        if any(own != hidden[0] for own in hidden):
            found[name] = [sorted(own) for own in hidden]
    return found


def _note(made: Mapping[str, Handle], kept: Sequence[tuple[int, ...]], told: str) -> str:
    """Say what needs the notebook.

    Examples
    --------
    >>> a, b = (Handle({"kind": "slider", "label": name}, [0, 1, 2], 0) for name in "ab")
    >>> _note({"a": a, "b": b}, [(0, 0), (2, 0), (0, 1)], "")
    'In the notebook: a at all 3 stops, b at all 3 stops, both together.'
    """
    used = [sorted(set(stops)) for stops in zip(*kept, strict=True)]
    few = [
        f"{handle.look['label']} at all {len(handle.values)} stops"
        for handle, stops in zip(made.values(), used, strict=True)
        if len(stops) < len(handle.values) and handle.look["kind"] != "presses"
    ]
    if len(kept) < np.prod([len(stops) for stops in used]):
        few.append("both together" if len(made) == 2 else "all of them together")
    parts = [f"In the notebook: {', '.join(few)}."] if few else []
    return " ".join([*parts, *([f"Here {told}."] if told else [])])


def name_of(call: str) -> str:
    """Return the name of an explorer's file, from the call that makes it.

    Examples
    --------
    >>> name_of("film_explorer(approach.trajectory(6))")
    'film_explorer-approach-trajectory-6'
    """
    return re.sub(r"\W+", "-", call).strip("-")


def write_explorers(folder: Path) -> None:
    """Write a file for each explorer and each recording, and the canvas that draws them."""
    made = folder / "living"
    made.mkdir(parents=True)
    tasks = {name_of(call): delayed(packed)(living) for call, living in LIVING.items()}
    tasks |= {name: delayed(recorded)(recording) for name, recording in RECORDINGS.items()}
    done = run_all(list(tasks.values()), -1, True, "explorers")
    for name, data in zip(tasks, done, strict=True):
        write_script(made / f"{name}.js", data)
    write_canvas(folder)


def write_canvas(folder: Path) -> None:
    """Write the canvas of the notebooks as a plain script: a page from a disk has no modules."""
    source = Path(widgets.__file__).parent
    parts = [
        (source / name).read_text(encoding="utf-8").split("\nexport default")[0]
        for name in ("canvas.js", "live.js")
    ]
    made = ["{", *parts, "window.arkaqCanvas = { render, renderLive };", "}", ""]
    (folder / "canvas.js").write_text("\n".join(made), encoding="utf-8")
    (folder / "canvas.css").write_text((source / "canvas.css").read_text("utf-8"), "utf-8")
