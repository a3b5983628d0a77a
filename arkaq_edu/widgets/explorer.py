"""Sliders above a canvas: what every explorer of the course is made of."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import anywidget
import ipywidgets
import traitlets

from .scene import PNG_WIDTH, Scene


class CanvasView(anywidget.AnyWidget):
    """A canvas in the browser that draws the scene it was last shown.

    Examples
    --------
    >>> from arkaq_edu.widgets.scene import Panel, Points, Scene
    >>> view = CanvasView()
    >>> view.show(Scene("one dot", [Panel("x", "y", (0, 1), (0, 1), [Points([0.5], [0.5])])]))
    >>> view.scene["fact"], len(view.numbers)
    ('one dot', 8)
    """

    _esm = Path(__file__).with_name("canvas.js")
    _css = Path(__file__).with_name("canvas.css")
    scene = traitlets.Dict().tag(sync=True)
    numbers = traitlets.Bytes().tag(sync=True)

    def show(self, scene: Scene) -> None:
        """Draw `scene`; it travels to the browser in one message."""
        layout, numbers = scene.pack()
        with self.hold_sync():
            self.scene, self.numbers = layout, numbers


class Buttons(ipywidgets.HBox):
    """A row of buttons that remember what was pressed, for an explorer that goes step by step.

    Parameters
    ----------
    names : sequence of str
        A button each.
    start_again : str
        The last button, which forgets all presses.
    value : sequence of str
        What has been pressed at first.

    Attributes
    ----------
    value : tuple of str
        The names pressed so far, in their order. Setting it is as good as pressing.

    Raises
    ------
    ValueError
        If a press is none of the names.

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

    def __init__(
        self, names: Sequence[str], *, start_again: str = "start again", value: Sequence[str] = ()
    ) -> None:
        self.names, self.start_again = tuple(names), start_again
        buttons = [ipywidgets.Button(description=name) for name in (*names, start_again)]
        for button in buttons:
            button.layout.width = "auto"
            button.on_click(lambda pressed: self.press(pressed.description))
        super().__init__(buttons, layout={"flex_flow": "row wrap"})
        self.value = tuple(value)

    def press(self, name: str) -> None:
        """Do what a click on the button of that name does."""
        self.value = () if name == self.start_again else (*self.value, name)

    @traitlets.validate("value")
    def _known(self, proposal: Any) -> tuple[str, ...]:
        for name in proposal["value"]:
            if name not in self.names:
                raise ValueError(f"name must be one of {', '.join(self.names)}, got {name!r}")
        return tuple(proposal["value"])


class Explorer(ipywidgets.VBox):
    """Controls above a canvas that is drawn anew whenever one of them moves.

    In a notebook without a kernel it is a picture and the fact which the picture states.

    Parameters
    ----------
    draw : callable
        Takes the values of the controls by name, returns a `Scene`. A plain function, so that it
        can be tested without a browser.
    **controls : ipywidgets widget
        Widgets with a ``value``: sliders, menus, `Buttons`.

    Attributes
    ----------
    view : CanvasView
        The canvas.
    controls : dict
        The controls by name.
    drawn : Scene
        What the canvas shows.
    error : Exception or None
        What went wrong when a control last moved; it is shown under the canvas too.

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

    def __init__(self, draw: Callable[..., Scene], **controls: ipywidgets.DOMWidget) -> None:
        self.view = CanvasView()
        self.controls = controls
        self.error: Exception | None = None
        self._draw = draw
        self._message = ipywidgets.HTML()
        super().__init__([*controls.values(), self.view, self._message])
        self._redraw()
        for control in controls.values():
            control.observe(self._moved, names="value")

    def _redraw(self) -> None:
        self.drawn = self._draw(**{name: box.value for name, box in self.controls.items()})
        self.view.show(self.drawn)

    def _moved(self, _: Any) -> None:
        try:
            self._redraw()
            self.error, self._message.value = None, ""
        except Exception as error:  # a callback's exception would vanish in the kernel's log
            self.error = error
            words = html.escape(f"{type(error).__name__}: {error}")
            self._message.value = f'<div role="alert" style="color: #b00020">{words}</div>'

    def __repr__(self) -> str:
        return self.drawn.fact

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        bundle = super()._repr_mimebundle_(**kwargs)
        bundle |= {"text/plain": self.drawn.fact, "image/png": self.drawn.png()}
        return bundle, {"image/png": {"width": PNG_WIDTH}}
