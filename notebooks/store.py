"""Run the notebooks and store what they show, so that the same notebook gives the same bytes.

    python notebooks/store.py                    run and store every notebook of the course
    python notebooks/store.py 07_*.ipynb         only these
    python notebooks/store.py --check            store nothing; fail where a fresh run differs

A notebook is run from top to bottom in a new kernel, in its own folder. What is stored holds no
timings, no machine's or editor's metadata, no cell ids drawn at random, and no widget's model:
reopened without a kernel a model shows "not found", where the picture beside it shows the widget.
The text beside a picture is its alt text; a cell's own `alt` metadata goes before it.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections import Counter
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

from arkaq_edu._files import replacing

FOLDER = Path(__file__).parent
KEPT_CELL_METADATA = ("alt", "nbgrader", "tags")
WIDGET = "application/vnd.jupyter.widget-view+json"


def run(notebook: NotebookNode, folder: Path) -> NotebookNode:
    """Return a copy of `notebook` with the outputs of a fresh kernel working in `folder`."""
    fresh = nbformat.from_dict(notebook)
    NotebookClient(
        fresh,
        kernel_name="python3",
        timeout=600,
        record_timing=False,
        store_widget_state=False,
        coalesce_streams=True,
        resources={"metadata": {"path": str(folder)}},
    ).execute()
    return fresh


def tidy(notebook: NotebookNode) -> NotebookNode:
    """Return a copy of `notebook` with nothing in it that a second run would change.

    Examples
    --------
    >>> from nbformat.v4 import new_code_cell, new_notebook
    >>> cell = new_code_cell("1 + 1", metadata={"collapsed": True, "tags": ["nbval-skip"]})
    >>> tidy(new_notebook(cells=[cell])).cells[0].metadata
    {'tags': ['nbval-skip']}
    """
    tidied = nbformat.from_dict(notebook)
    tidied.metadata = NotebookNode(
        kernelspec={"display_name": "Python 3", "language": "python", "name": "python3"},
        language_info={"name": "python"},
    )
    tidied.nbformat, tidied.nbformat_minor = 4, 5
    seen: Counter[str] = Counter()
    for cell in tidied.cells:
        name = hashlib.sha256(cell.source.encode()).hexdigest()[:8]
        seen[name] += 1
        cell.id = name if seen[name] == 1 else f"{name}-{seen[name]}"
        cell.metadata = NotebookNode(
            {key: cell.metadata[key] for key in KEPT_CELL_METADATA if key in cell.metadata}
        )
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            data.pop(WIDGET, None)
            if "image/png" in data:
                data.pop("image/jpeg", None)  # the same picture once more, from Pillow
            if "metadata" in output:
                output.metadata = NotebookNode()
            if "image/png" in data:
                words = cell.metadata.get("alt", data.get("text/plain", ""))
                output.metadata["image/png"] = {"alt": words}
    nbformat.validate(tidied)
    return tidied


def text(notebook: NotebookNode, *, pictures: bool = True) -> str:
    """Return `notebook` as the text of its file, with or without the bytes of its pictures."""
    notebook = nbformat.from_dict(notebook)
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            for kind in output.get("data", {}):
                if kind.startswith("image/") and not pictures:
                    output.data[kind] = "a picture"
    return nbformat.writes(notebook).rstrip("\n") + "\n"


def difference(stored: NotebookNode, fresh: NotebookNode) -> str | None:
    """Say where a fresh run differs from what is stored, or ``None``.

    Pictures are compared by being there: their bytes depend on the version of the plotting
    library, and so say nothing.
    """
    if text(stored, pictures=False) == text(fresh, pictures=False):
        return None
    for number, (old, new) in enumerate(zip(stored.cells, fresh.cells, strict=True)):
        one = [text(nbformat.v4.new_notebook(cells=[c]), pictures=False) for c in (old, new)]
        if one[0] != one[1]:
            source = old.source.strip().splitlines() or ["(empty)"]
            return f"cell {number} differs from a fresh run: {source[0]}"
    return "its metadata are not those of a stored notebook"


def store(path: Path, *, check: bool = False) -> str | None:
    """Run one notebook and store it, or with `check` only say how it differs from a fresh run."""
    stored = nbformat.read(path, as_version=4)
    fresh = tidy(run(stored, path.parent))
    if check:
        return difference(stored, fresh)
    with replacing(path) as new:
        new.write_text(text(fresh), encoding="utf-8")
    return None


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    parser = argparse.ArgumentParser(description="Run the notebooks and store what they show.")
    parser.add_argument("notebooks", nargs="*", type=Path, help="default: all of the course")
    parser.add_argument("--check", action="store_true", help="only fail where a fresh run differs")
    options = parser.parse_args(arguments)
    status = 0
    for path in options.notebooks or sorted(FOLDER.glob("*.ipynb")):
        problem = store(path, check=options.check)
        print(f"{path.name}: {problem or ('as stored' if options.check else 'stored')}")
        status = max(status, int(problem is not None))
    return status


if __name__ == "__main__":
    sys.exit(main())
