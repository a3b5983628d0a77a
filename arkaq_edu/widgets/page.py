"""An explorer on a page of its own, for a lecture: large type, own patterns, links to settings."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlencode

import anywidget
import ipywidgets
import traitlets

from arkaq_edu.experiments.patterns import Patterns, read_patterns
from arkaq_edu.experiments.segmentation import SENSING, recorded_patterns
from arkaq_edu.widgets import EXPLORERS
from arkaq_edu.widgets.explorer import Explorer
from arkaq_edu.widgets.segmentation import centers, vigilance_explorer


class Desk(anywidget.AnyWidget):
    """The links and the buttons above an explorer.

    Attributes
    ----------
    names, name : tuple of str, str
        All explorers, and the one that is shown.
    query : str
        The setting that is shown, as the end of the page's address.
    takes_patterns : bool
        Whether a csv can be opened, and the centers downloaded.

    Examples
    --------
    >>> Desk(names=("belief", "bowl"), name="bowl").query
    ''
    """

    _esm = Path(__file__).with_name("page.js").read_text(encoding="utf-8")
    _css = Path(__file__).with_name("page.css").read_text(encoding="utf-8")
    names = traitlets.Tuple().tag(sync=True)
    name = traitlets.Unicode().tag(sync=True)
    query = traitlets.Unicode().tag(sync=True)
    takes_patterns = traitlets.Bool(False).tag(sync=True)


class Page(ipywidgets.VBox):
    """An explorer below the links to all others.

    Parameters
    ----------
    query : str
        The end of the page's address: ``explorer=belief`` and, if it is a link that was kept, the
        value of each control. What it does not say stays as it is at first.
    patterns : Patterns, optional
        One's own, for the vigilance explorer.

    Attributes
    ----------
    explorer : Explorer
        The one that is shown.
    desk : Desk
        The links and buttons; its ``query`` is that of the setting shown now.

    Raises
    ------
    ValueError
        If there is no explorer of that name.

    Examples
    --------
    >>> page = Page("explorer=kalman&r=100.0")
    >>> page.explorer
    mean NIS 1.10 where 0.67 to 1.39 is right; estimate 60 mm off, sightings 102 mm
    >>> page.explorer.controls["dropout"].value = 0.5
    >>> page.desk.query
    'explorer=kalman&r=100.0&q=25.0&dropout=0.5'
    """

    def __init__(self, query: str = "", patterns: Patterns | None = None) -> None:
        asked = dict(parse_qsl(query))
        name = asked.pop("explorer", "vigilance")
        if name not in EXPLORERS:
            raise ValueError(f"explorer must be one of {', '.join(EXPLORERS)}, got {name!r}")
        takes = EXPLORERS[name] is vigilance_explorer
        self.patterns = patterns
        self._message = ipywidgets.HTML(tooltip="")
        self.desk = Desk(names=tuple(EXPLORERS), name=name, takes_patterns=takes)
        self.desk.on_msg(self._asked)
        explorer = vigilance_explorer(patterns) if takes and patterns else EXPLORERS[name]()
        super().__init__([])
        self.add_class("arkaq-page")
        self._show(explorer, asked)

    def read(self, text: str) -> None:
        """Show the text of a csv of patterns in the vigilance explorer."""
        self.patterns = read_patterns(text)
        old, asked = self.explorer, setting(self.explorer)
        asked.pop("n", None)  # other patterns, another number of them
        self._show(vigilance_explorer(self.patterns), asked)
        old.close()

    def centers(self) -> str:
        """Return the centers of the vigilance explorer as the text of a csv."""
        own = self.patterns or Patterns(
            recorded_patterns(), ("distance", "orientation"), SENSING.low, SENSING.high
        )
        values = {name: control.value for name, control in self.explorer.controls.items()}
        return own.to_csv(centers(own.scaled, **values))

    def _show(self, explorer: Explorer, asked: Mapping[str, str]) -> None:
        self.explorer = explorer
        refused = set_to(explorer, asked)
        self._say(refused)
        self.children = [self.desk, self._message, explorer]
        self._tell()
        for control in explorer.controls.values():
            control.observe(self._tell, names="value")

    def _tell(self, _: Any = None) -> None:
        named = {"explorer": self.desk.name}
        self.desk.query = urlencode(named | setting(self.explorer), safe='[]",')

    def _say(self, words: str) -> None:
        told = f'<div role="alert" style="color: #b00020">{html.escape(words)}</div>'
        self._message.value = told if words else ""

    def _asked(self, _: Any, message: Mapping[str, Any], buffers: Any) -> None:
        if message["kind"] == "centers":
            self.desk.send({"name": "centers.csv", "text": self.centers()})
            return
        try:
            self.read(message["text"])
        except ValueError as error:
            self._say(f"{message['name']}: {error}")


def setting(explorer: Explorer) -> dict[str, str]:
    """Return the values of an explorer's controls as text, by name.

    Examples
    --------
    >>> from arkaq_edu.widgets import value_explorer
    >>> setting(value_explorer())
    {'horizon': '3', 'belief': '0.25'}
    """
    return {name: json.dumps(control.value) for name, control in explorer.controls.items()}


def set_to(explorer: Explorer, asked: Mapping[str, str]) -> str:
    """Set an explorer's controls to what `setting` returned; say what could not be set.

    Examples
    --------
    >>> from arkaq_edu.widgets import value_explorer
    >>> explorer = value_explorer()
    >>> set_to(explorer, {"belief": "0.5", "horizon": "a few"})
    'the link has no sense here: horizon=a few'
    >>> explorer.controls["belief"].value
    0.5
    """
    refused = []
    for name, text in asked.items():
        try:
            value = json.loads(text)
            explorer.controls[name].value = tuple(value) if isinstance(value, list) else value
        except (KeyError, ValueError, traitlets.TraitError):
            refused.append(f"{name}={text}")
    return f"the link has no sense here: {', '.join(refused)}" if refused else ""


def visit(name: str, patterns: str | None = None) -> Page:
    """Return the page for one visit: what the address asks for, else the explorer `name`.

    Parameters
    ----------
    name : str
        A key of `arkaq_edu.widgets.EXPLORERS`.
    patterns : str, optional
        The path of a csv of one's own patterns, for the vigilance explorer.

    Examples
    --------
    >>> visit("kalman").desk.name
    'kalman'
    """
    own = read_patterns(Path(patterns).read_text(encoding="utf-8-sig")) if patterns else None
    query = os.environ.get("QUERY_STRING", "")  # Voila's, of the address that was opened
    return Page(query if "explorer=" in query else f"explorer={name}&{query}", own)
