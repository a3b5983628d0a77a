"""Sphinx's settings for the site: `arkaq site`, `make site`."""

import re
from importlib.resources import files
from pathlib import Path
from shutil import copy

from arkaq_edu import __version__
from arkaq_edu.site.reference import plain_docstring

project = "arkaq_edu"
author = "The arkaq_edu authors"
copyright = author
version = release = __version__

extensions = [
    "myst_nb", "numpydoc", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.viewcode",
]  # fmt: skip
root_doc = "index"
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb"}

# The pages are shown as they ran.
nb_execution_mode = "off"
nb_code_prompt_show = "Predict first, then look"
nb_code_prompt_hide = "What it shows"
nb_ipywidgets_js = {}
myst_enable_extensions = ["amsmath", "attrs_inline", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_dmath_double_inline = True

default_role = "py:obj"
autosummary_generate = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
add_module_names = False
toc_object_entries_show_parents = "hide"
python_display_short_literal_types = True

# Estimators have attributes of the same name.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_title = "A robot that learns"
html_static_path = ["static"]
html_css_files = ["canvas.css", "site.css"]
html_js_files = ["canvas.js", "living.js"]
html_copy_source = False
html_show_sphinx = False
html_permalinks_icon = "#"
# A page that was opened from a disk may not read other pages.
html_show_search_summary = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5c94", "color-brand-content": "#0b5c94"},
    "dark_css_variables": {"color-brand-primary": "#7cc0ee", "color-brand-content": "#7cc0ee"},
    "top_of_page_buttons": [],
}
pygments_style = "friendly"
pygments_dark_style = "github-dark"

# One file with its letters in it: a page makes no request.
mathjax_path = "mathjax.js"
mathjax3_config = {"options": {"enableMenu": False}, "svg": {"fontCache": "global"}}


def setup(app):
    """Prepare docstrings, and bring along what the pages load."""
    app.connect("autodoc-process-docstring", plain_docstring, priority=1)
    app.connect("config-inited", _add_made)
    app.connect("html-page-context", _lead_back)
    app.connect("build-finished", _copy_mathjax)


def _add_made(app, config):
    config.html_static_path.append(str(Path(app.srcdir) / "_static"))  # what `arkaq site` made


def _lead_back(app, page, template, context, tree):
    """Lead from a source to what documents it: viewcode takes a module's name for its room's."""
    if not page.startswith("_modules/"):
        return
    objects = app.env.domains.python_domain.objects
    known = {name for name, entry in objects.items() if entry.objtype != "module"}
    module = page.removeprefix("_modules/").replace("/", ".")

    def mended(link):
        names = [link["name"], *(f"{module}.{part}" for part in _tails(link["name"]))]
        name = next((name for name in names if name in known), None)
        return link["start"] + name + link["end"] if name else ""

    pattern = r'(?P<start><a class="viewcode-back" href="[^"#]*#)(?P<name>[^"]*)(?P<end>".*?</a>)'
    context["body"] = re.sub(pattern, mended, context["body"])


def _tails(name):
    """Return what stands after each dot of a name, the longest first."""
    parts = name.split(".")
    return [".".join(parts[i:]) for i in range(1, len(parts))]


def _copy_mathjax(app, error):
    if error is None:
        source = files("sphinx-mathjax-offline") / "static" / "mathjax" / "tex-svg.js"
        copy(Path(str(source)), Path(app.outdir) / "_static" / "mathjax.js")
