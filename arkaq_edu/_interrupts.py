"""Ctrl-C: it ends a command soon, whatever the command is doing."""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

#: After so many seconds (a file may be completed meanwhile) the process is ended the hard way.
SECONDS_TO_CLEAN_UP = 5.0
STATUS = 130
LINE = "arkaq: interrupted"


class Interrupts:
    """A context in which Ctrl-C raises ``KeyboardInterrupt`` where the exception gets through.

    It does not get through an import, which may turn it into another error: there the process ends
    at once. Nor does it out of a finalizer, where Python only prints it: there it is raised again
    a moment later. If somebody swallows it all the same, the process ends after
    `SECONDS_TO_CLEAN_UP`. The package's files are whole at every moment; see `arkaq_edu._files`.

    Attributes
    ----------
    came : bool
        Whether there was one.

    Examples
    --------
    >>> interrupts = Interrupts()
    >>> try:
    ...     with interrupts:
    ...         signal.raise_signal(signal.SIGINT)
    ... except KeyboardInterrupt:
    ...     print(interrupts.came)
    True
    """

    def __init__(self) -> None:
        self.came = False
        self._timers: list[threading.Timer] = []

    def __enter__(self) -> Interrupts:
        """Listen, if this is the main thread, which alone may."""
        self._listens = threading.current_thread() is threading.main_thread()
        if self._listens:
            self._handler = signal.signal(signal.SIGINT, self._hear)
            self._hook, sys.unraisablehook = sys.unraisablehook, self._unraisable
        return self

    def __exit__(self, *error: object) -> None:
        """Leave Ctrl-C to whom it belonged before."""
        for timer in self._timers:
            timer.cancel()
        if self._listens:
            signal.signal(signal.SIGINT, self._handler)
            sys.unraisablehook = self._hook

    def _hear(self, number: int, frame: FrameType | None) -> None:
        if _importing(frame):
            _end()
        if not self.came:
            self.came = True
            self._after(SECONDS_TO_CLEAN_UP, _end)
        raise KeyboardInterrupt

    def _unraisable(self, told: Any) -> None:
        if issubclass(told.exc_type, KeyboardInterrupt):
            self._after(0.05, _thread.interrupt_main)
        elif not self.came:  # what was half made when the interrupt came may complain as it goes
            self._hook(told)

    def _after(self, seconds: float, call: Callable[[], None]) -> None:
        timer = threading.Timer(seconds, call)
        timer.daemon = True
        self._timers.append(timer)
        timer.start()


def _importing(frame: FrameType | None) -> bool:
    while frame is not None and frame.f_code.co_filename != "<frozen importlib._bootstrap>":
        frame = frame.f_back
    return frame is not None


def _end() -> None:
    os.write(2, f"\n{LINE}\n".encode())
    os._exit(STATUS)
