"""The pages as a student gets them: without solutions, and without what a cell answers.

Nothing but the standard library is imported here: the build of the wheel runs this file too.
"""

from __future__ import annotations

import json
import re
from typing import Any

_SOLUTION = re.compile(r"^( *)### BEGIN SOLUTION\n.*?^ *### END SOLUTION", re.MULTILINE | re.DOTALL)
_BLANK = (
    r"\1# your answer, in place of this line and the next"
    "\n"
    r"\1raise NotImplementedError"
)
#: The cells that show a widget: their still picture stays, so that a page is not empty.
_WIDGET = re.compile(r"(_explorer|_robot|control_panel|\brace)\([^\n]*\)\s*\Z")


def students_page(master: str) -> str:
    """Return the text of a notebook as a student gets it.

    Solutions are blank. Outputs are gone, since many answer a question that stands above them;
    only the still picture of a widget stays.

    Examples
    --------
    >>> cell = {"cell_type": "code", "execution_count": 1, "outputs": ["42"], "source": ["6 * 7"]}
    >>> page = students_page(json.dumps({"cells": [cell | {"metadata": {}}]}))
    >>> json.loads(page)["cells"][0]["outputs"]
    []
    """
    page = json.loads(master)
    for cell in page["cells"]:
        if cell["cell_type"] == "code":
            _open(cell)
    return json.dumps(page, indent=1, ensure_ascii=False) + "\n"


def blank(source: str) -> str:
    """Return the source of an answer's cell without the answer."""
    return _SOLUTION.sub(_BLANK, source)


def _open(cell: dict[str, Any]) -> None:
    source = "".join(cell["source"])
    if cell["metadata"].get("nbgrader", {}).get("solution"):
        cell["source"] = blank(source).splitlines(keepends=True)
    cell["execution_count"] = None
    if _WIDGET.search(source):
        for output in cell["outputs"]:
            if "execution_count" in output:
                output["execution_count"] = None
    else:
        cell["outputs"] = []
