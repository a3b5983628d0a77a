"""What a student has solved, kept beside the student's own pages."""

from __future__ import annotations

import contextlib
import json

from arkaq_edu._files import replacing
from arkaq_edu._paths import own_copy

_FILE = "progress.json"
_session: set[str] = set()


def names() -> set[str]:
    """Return the names of the exercises solved so far.

    In a student's copy of the course they are those of all sessions, elsewhere of this one.
    """
    return _session | _kept()


def add(name: str) -> None:
    """Remember that an exercise is solved."""
    _session.add(name)
    folder = own_copy()
    if folder and name not in _kept():
        # A folder that cannot be written to must not stop a student who has just solved something.
        with contextlib.suppress(OSError), replacing(folder / _FILE) as fresh:
            fresh.write_text(json.dumps({"solved": sorted(names())}, indent=1) + "\n", "utf-8")


def _kept() -> set[str]:
    folder = own_copy()
    try:
        return set(json.loads((folder / _FILE).read_text("utf-8"))["solved"]) if folder else set()
    except (OSError, ValueError, LookupError, TypeError):  # not there yet, or no longer readable
        return set()
