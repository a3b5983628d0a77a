"""Explorers: controls above a canvas that follows them."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any
from weakref import WeakSet

import anywidget
import ipywidgets
import numpy as np
import traitlets
from IPython import get_ipython
from numpy.typing import NDArray

from arkaq_edu.widgets.scene import PNG_WIDTH, Scene

#: The layout of a row of widgets that goes on below where the page is narrow.
WRAP = {"flex_flow": "row wrap"}
#: What the picture of an explorer says where no kernel runs.
STILL = "a still: run this cell to get the sliders"
#: The name of the button that forgets all presses.
START_AGAIN = "start again"
_OFF = "arkaq-off"  # the class of a button that cannot be pressed now
#: The explorers that the last run of each notebook cell made: the run, and what it made.
_MADE: dict[str, tuple[str, WeakSet[Explorer]]] = {}


def sized(label: str = "9em", width: int = 36) -> dict[str, Any]:
    """Return the layout of a slider with a description of width `label`, at most `width` em wide.

    Examples
    --------
    >>> ipywidgets.IntSlider(description="sweeps", **sized("7em")).style.description_width
    '7em'
    """
    return {"layout": {"width": f"min(100%, {width}em)"}, "style": {"description_width": label}}


def slider(
    description: str, value: float, low: float, high: float, step: float = 1, **options: Any
) -> ipywidgets.DOMWidget:
    """Return a slider: of integers if its step is one, otherwise of floats.

    Examples
    --------
    >>> slider("sweeps", 3, 0, 40).max, slider("slip", 0.1, 0, 0.5, 0.05).max
    (40, 0.5)
    """
    kind = ipywidgets.IntSlider if isinstance(step, int) else ipywidgets.FloatSlider
    return kind(value, min=low, max=high, step=step, description=description, **sized() | options)


def stops(
    description: str, values: Sequence[Any], value: Any, text: str = "{:g}", **options: Any
) -> ipywidgets.SelectionSlider:
    """Return a slider that stops at the given values only, each shown in the format `text`.

    Examples
    --------
    >>> stops("steps", (0, 1000), 1000, "{:,}").label
    '1,000'
    """
    named = [(text.format(stop), stop) for stop in values]
    return ipywidgets.SelectionSlider(
        options=named, value=value, description=description, **sized() | options
    )


def button(name: str, act: Callable[[], None], tooltip: str = "") -> ipywidgets.Button:
    """Return a button, as wide as its name, that calls `act` when it is clicked.

    While it is not offered (see `offer`), a click does nothing.

    Examples
    --------
    >>> button("hello", lambda: print("hello yourself")).click()
    hello yourself
    """
    made = ipywidgets.Button(description=name, layout={"width": "auto"}, tooltip=tooltip)
    made.on_click(lambda _: act() if is_offered(made) else None)
    return made


def offer(button: ipywidgets.Button, offered: bool) -> None:
    """Let a button be pressed or not. Unlike a disabled one, it keeps the focus.

    Examples
    --------
    >>> hello = button("hello", lambda: print("hello yourself"))
    >>> offer(hello, False)
    >>> hello.click()
    """
    (button.remove_class if offered else button.add_class)(_OFF)


def is_offered(button: ipywidgets.Button) -> bool:
    """Return whether a button can be pressed.

    Examples
    --------
    >>> is_offered(button("hello", print))
    True
    """
    return _OFF not in button._dom_classes


def close_whole(widget: ipywidgets.Widget) -> None:
    """Close a widget and every widget that it is made of: its children, layout and style.

    ipywidgets keeps a widget in memory, and in the saved notebook, until it is closed.

    Examples
    --------
    >>> row = ipywidgets.HBox([ipywidgets.Button()])
    >>> close_whole(row)
    >>> row.children[0].layout.comm is None
    True
    """
    for name in widget.keys:
        value = getattr(widget, name)
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, ipywidgets.Widget):
                close_whole(part)
    ipywidgets.Widget.close(widget)


class CanvasView(anywidget.AnyWidget):
    """A canvas in the browser that draws a scene and reports drags and arrow keys.

    Attributes
    ----------
    scene, numbers : dict, bytes
        What it draws, as `Scene.pack` returns it.
    draggable : list of int
        The panels on which a drag may begin; if there are none, the canvas takes no input.
    drag : dict
        The newest drag, or an empty dict: its ``number``, the ``panel``, where it began (``from``)
        and where it is now (``to``), in the units of the panel's axes, and its ``phase``: "begin",
        "move" or "end". The browser reports at most once per frame. While the kernel is busy only
        the newest report waits, so only the last phase is certain to arrive.
    arrows : tuple of two int
        How often the arrow keys were pressed: right minus left, up minus down.

    Examples
    --------
    >>> from arkaq_edu.widgets.scene import Panel, Points, Scene
    >>> view = CanvasView()
    >>> view.show(Scene("one dot", [Panel("x", "y", (0, 1), (0, 1), [Points([0.5], [0.5])])]))
    >>> view.scene["fact"], len(view.numbers)
    ('one dot', 8)
    """

    # As text: anywidget watches a file for changes, and so keeps every canvas in memory.
    _esm = Path(__file__).with_name("canvas.js").read_text(encoding="utf-8")
    _css = Path(__file__).with_name("canvas.css").read_text(encoding="utf-8")
    scene = traitlets.Dict().tag(sync=True)
    numbers = traitlets.Bytes().tag(sync=True)
    draggable: traitlets.List[int] = traitlets.List().tag(sync=True)
    drag = traitlets.Dict().tag(sync=True)
    arrows = traitlets.Tuple((0, 0)).tag(sync=True)

    def show(self, scene: Scene) -> None:
        """Draw `scene`; it is sent to the browser in one message."""
        layout, numbers = scene.pack()
        with self.hold_sync():
            self.scene, self.numbers = layout, numbers


class Buttons(ipywidgets.HBox):
    """A row of buttons that remember the presses, for an explorer that goes step by step.

    Parameters
    ----------
    names : sequence of str
        One button each. A last button, "start again", forgets all presses.
    value : sequence of str
        The presses at the beginning.

    Attributes
    ----------
    value : tuple of str
        The names pressed so far, in order. Setting it does the same as pressing.

    Raises
    ------
    ValueError
        If a press is not one of the names.

    Examples
    --------
    >>> steps = Buttons(["left", "right"])
    >>> steps.press("left")
    >>> steps.press("right")
    >>> steps.value
    ('left', 'right')
    >>> steps.press("start again")
    >>> steps.value
    ()
    """

    value = traitlets.Tuple()

    def __init__(self, names: Sequence[str], value: Sequence[str] = ()) -> None:
        self.names = tuple(names)
        buttons = [button(name, partial(self.press, name)) for name in (*names, START_AGAIN)]
        super().__init__(buttons, layout=WRAP)
        self.value = tuple(value)

    def press(self, name: str) -> None:
        """Do what a click on the button of that name does."""
        self.value = () if name == START_AGAIN else (*self.value, self.record(name))

    def record(self, name: str) -> Any:
        """Return what to remember of a press: its name, or a tuple that begins with it."""
        return name

    @traitlets.validate("value")
    def _known(self, proposal: Any) -> tuple[Any, ...]:
        for press in proposal["value"]:
            name = press if isinstance(press, str) else press[0]
            if name not in self.names:
                raise ValueError(f"name must be one of {', '.join(self.names)}, got {name!r}")
        return tuple(proposal["value"])


class Drag(ipywidgets.VBox):
    """One or two sliders that also follow a drag on the first panel, and the arrow keys.

    Parameters
    ----------
    *sliders : ipywidgets.FloatSlider or IntSlider
        The slider that the pointer moves across, and perhaps one that it moves upward.
    gain : tuple of two float, optional
        How far the sliders move for each unit of the panel's axes. If it is None, they move to
        where the pointer is.

    Attributes
    ----------
    value : float, or tuple of two float
        The value of the slider, or of both. Setting it does the same as dragging.

    Examples
    --------
    >>> belief = Drag(slider("belief", 0.5, 0, 1, 0.05))
    >>> view = CanvasView()
    >>> belief.follow(view)
    >>> view.drag = {"number": 1, "panel": 0, "from": (0.5, 2), "to": (0.31, 7)}
    >>> belief.value
    0.3
    >>> view.arrows = (-2, 0)
    >>> belief.value
    0.2
    """

    value = traitlets.Any()

    def __init__(
        self, *sliders: ipywidgets.DOMWidget, gain: tuple[float, float] | None = None
    ) -> None:
        super().__init__(sliders)
        self.gain = None if gain is None else np.array(gain)
        self._number, self._start = 0, self._place()
        self._gather()
        for each in sliders:
            each.observe(self._gather, names="value")
        self.observe(self._spread, names="value")

    def follow(self, view: CanvasView) -> None:
        """Let drags and arrow keys on a canvas move the sliders."""
        view.draggable = [0]
        view.observe(self._dragged, names="drag")
        view.observe(self._stepped, names="arrows")

    def _dragged(self, change: Any) -> None:
        drag = change["new"]
        if drag["number"] != self._number:
            self._number, self._start = drag["number"], self._place()
        begin, now = np.array([drag["from"], drag["to"]])[:, : len(self.children)]
        self._go(now if self.gain is None else self._start + self.gain * (now - begin))

    def _stepped(self, change: Any) -> None:
        keys = np.subtract(change["new"], change["old"])
        if len(self.children) == 1:  # a single slider takes all four keys, as sliders do
            keys = keys.sum(keepdims=True)
        steps = np.array([each.step for each in self.children])
        self._go(self._place() + steps * keys * (1 if self.gain is None else np.sign(self.gain)))

    def _place(self) -> NDArray[np.float64]:
        return np.array([each.value for each in self.children], dtype=float)

    def _go(self, place: NDArray[np.float64]) -> None:
        """Move each slider to the stop nearest to its place, and report both at once."""
        with self.hold_trait_notifications():
            for each, target in zip(self.children, place.tolist(), strict=True):
                stop = each.min + round((target - each.min) / each.step) * each.step
                stop = min(max(round(stop, 10), each.min), each.max)
                each.value = type(each.value)(stop)

    def _gather(self, _: Any = None) -> None:
        values = tuple(each.value for each in self.children)
        self.value = values if len(values) > 1 else values[0]

    def _spread(self, change: Any) -> None:
        values = change["new"] if len(self.children) > 1 else [change["new"]]
        with self.hold_trait_notifications():
            for each, value in zip(self.children, values, strict=True):
                each.value = value


class Explorer(ipywidgets.VBox):
    """Controls above a canvas that is drawn again whenever one of them moves.

    In a stored notebook without a kernel it is a picture and the fact that the picture states.
    When a notebook cell runs again, the explorers that it made before are closed.

    Parameters
    ----------
    draw : callable
        Takes the values of the controls by name and returns a `Scene`. It is a plain function, so
        it can be tested without a browser.
    canvas : CanvasView, optional
        What draws it.
    **controls : ipywidgets widget
        Widgets with a ``value``: sliders, menus, `Buttons`, `Drag`.

    Attributes
    ----------
    view : CanvasView
        The canvas.
    controls : dict
        The controls by name.
    draw : callable
        From the values of the controls to a scene, as it was given.
    drawn : Scene
        The scene on the canvas.
    error : Exception or None
        The error of the last redrawing; it is also shown below the canvas.

    Examples
    --------
    >>> from arkaq_edu.widgets.scene import Panel, Points, Scene
    >>> def draw(x):
    ...     return Scene(f"a dot at {x}", [Panel("x", "y", (0, 9), (0, 1), [Points([x], [0.5])])])
    >>> explorer = Explorer(draw, x=ipywidgets.IntSlider(3, max=9))
    >>> explorer.controls["x"].value = 7
    >>> explorer
    a dot at 7
    """

    def __init__(
        self,
        draw: Callable[..., Scene],
        canvas: Any = None,
        /,
        **controls: ipywidgets.DOMWidget,
    ) -> None:
        self.view = CanvasView() if canvas is None else canvas
        self.controls = controls
        self.error: Exception | None = None
        self.draw = draw
        self._message = ipywidgets.HTML(tooltip="")
        super().__init__([*controls.values(), self.view, self._message])
        self.add_class("arkaq-explorer")
        self._redraw()
        for control in controls.values():
            control.observe(self._moved, names="value")
            if isinstance(control, Drag):
                control.follow(self.view)
        _close_predecessors(self)

    def close(self) -> None:
        """Close the explorer with its controls and its canvas; nothing of it stays in memory."""
        close_whole(self)

    def _redraw(self) -> None:
        self.drawn = self.draw(**{name: box.value for name, box in self.controls.items()})
        self.view.show(self.drawn)

    def _moved(self, _: Any) -> None:
        self._try(self._redraw)

    def _try(self, act: Callable[[], None]) -> None:
        try:
            act()
            self.error, self._message.value = None, ""
        except Exception as error:  # in a callback it would vanish in the kernel's log
            self.error = error
            words = html.escape(f"{type(error).__name__}: {error}")
            self._message.value = f'<div role="alert" style="color: #b00020">{words}</div>'

    def __repr__(self) -> str:
        return self.drawn.fact

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        bundle = super()._repr_mimebundle_(**kwargs)
        bundle |= {"text/plain": self.drawn.fact, "image/png": self.drawn.png(STILL)}
        return bundle, {"image/png": {"width": PNG_WIDTH}}


def _close_predecessors(explorer: Explorer) -> None:
    """Close the explorers that an earlier run of the same notebook cell made."""
    request: dict[str, Any] = getattr(get_ipython(), "get_parent", dict)()
    cell = request.get("metadata", {}).get("cellId")
    if cell is None:  # not in a notebook, or not in a cell of one
        return
    run = request["header"]["msg_id"]
    before, made = _MADE.get(cell, (run, WeakSet()))
    if before != run:
        for old in list(made):
            old.close()
        made = WeakSet()
    made.add(explorer)
    _MADE[cell] = run, made
