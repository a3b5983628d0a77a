"""The chapters as slides for a lecture, from the same notebooks: `arkaq slides`."""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import Any

from arkaq_edu._files import replacing
from arkaq_edu._paths import course_folder, in_repository
from arkaq_edu._student import blank

#: Where `make slides` puts what the pages load; without it they load the same from the web.
LIBRARIES = {
    "reveal_url_prefix": "node_modules/reveal.js",
    "mathjax_url": "node_modules/mathjax/MathJax.js?config=TeX-AMS_CHTML-full,Safe",
    "require_js_url": "node_modules/requirejs/require.js",
    "jquery_url": "node_modules/jquery/dist/jquery.min.js",
}

#: nbconvert's page without the library for diagrams, which comes from the web and no chapter needs.
TEMPLATE = """{% extends 'reveal/index.html.j2' %}
{% block html_head_js_mermaidjs %}{% endblock %}"""


def slides(out: Path | str) -> list[Path]:
    """Write each chapter as a page of slides, and return the pages.

    A heading begins a slide, a paragraph the next one below it, and what a cell shows comes at a
    key press of its own: so a class predicts first. Answers to exercises are blank.

    Parameters
    ----------
    out : path
        The folder for the pages.

    Raises
    ------
    ValueError
        If the package does not run from a clone: the pages of a wheel have no outputs to show.
    """
    if not in_repository():
        raise ValueError("slides are made in a clone of the repository: a wheel has no outputs")
    import nbformat
    from nbconvert import SlidesExporter

    out, pages = Path(out), []
    local = LIBRARIES if (out / "node_modules").is_dir() else {}
    exporter = SlidesExporter(
        raw_template=TEMPLATE, embed_images=True, reveal_scroll=True, reveal_theme="white",
        exclude_input_prompt=True, exclude_output_prompt=True, **local,
    )  # fmt: skip
    for master in sorted((course_folder() / "notebooks").glob("*.ipynb")):
        notebook = nbformat.read(master, as_version=4)
        notebook.cells = [part for cell in notebook.cells for part in _parts(cell)]
        for cell in notebook.cells:
            _place(cell)
            describe(cell)
        page = out / f"{master.stem}.slides.html"
        with replacing(page) as fresh:
            place = {"metadata": {"path": str(master.parent)}}
            fresh.write_text(exporter.from_notebook_node(notebook, place)[0], "utf-8")
        pages.append(page)
    return pages


def describe(cell: Any) -> None:
    """Show each picture of a cell with its alt text, which nbconvert leaves out.

    Examples
    --------
    >>> from nbformat.v4 import new_code_cell, new_output
    >>> shown = {"data": {"image/png": "iVBO"}, "metadata": {"image/png": {"alt": "a < b"}}}
    >>> cell = new_code_cell("draw()", outputs=[new_output("display_data", **shown)])
    >>> describe(cell)
    >>> cell.outputs[0].data["text/html"]
    '<img alt="a &lt; b" src="data:image/png;base64,iVBO">'
    """
    for output in cell.get("outputs", []):
        data = output.get("data", {})
        if "image/png" in data and "text/html" not in data:
            words = html.escape(output.metadata.get("image/png", {}).get("alt", ""))
            source = f"data:image/png;base64,{data['image/png'].strip()}"
            data["text/html"] = f'<img alt="{words}" src="{source}">'


def _parts(cell: Any) -> list[Any]:
    """Return a cell of text in pieces, each of which begins with its heading."""
    if cell.cell_type != "markdown":
        return [cell]
    texts = re.split(r"\n(?=##+ )", cell.source)
    return [
        type(cell)(cell, id=f"{cell.id}-{n}", source=text, metadata=type(cell)())
        for n, text in enumerate(texts)
    ]


def _place(cell: Any) -> None:
    """Say on which slide a cell is."""
    marks = cell.metadata.get("nbgrader", {})
    if cell.cell_type == "markdown":
        kind = "slide" if cell.source.startswith(("# ", "## ")) else "subslide"
    elif marks.get("grade") or cell.source.startswith("exercises.progress("):
        kind = "skip"
    else:
        kind = "fragment" if cell.outputs else "-"
    if marks.get("solution"):
        cell.source = blank(cell.source)
    cell.metadata["slideshow"] = {"slide_type": kind}
