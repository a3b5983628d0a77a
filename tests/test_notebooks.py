"""The stored notebooks, and the tool that stores them. Their outputs are compared by nbval."""

import importlib.util
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
LONGEST_CELL = 20
LARGEST_FILE = 1_500_000

_spec = importlib.util.spec_from_file_location("store", ROOT / "notebooks" / "store.py")
store = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(store)


@pytest.fixture(scope="module", params=NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def path(request):
    return request.param


@pytest.fixture
def notebook(path):
    return nbformat.read(path, as_version=4)


@pytest.fixture
def code(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def test_is_stored_by_the_tool(path, notebook):
    assert path.read_text(encoding="utf-8") == store.text(store.tidy(notebook))


def test_was_run_from_top_to_bottom_without_an_error(code):
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    outputs = [output for cell in code for output in cell.outputs]
    assert [o for o in outputs if o.output_type == "error" or o.get("name") == "stderr"] == []


def test_a_cell_tells_one_step(code):
    sources = [cell.source for cell in code]
    assert [s for s in sources if len(s.splitlines()) > LONGEST_CELL] == []
    assert [s for s in sources if s.rstrip().endswith(";")] == [], "nbval needs no semicolon"


def test_opens_quickly(path):
    assert path.stat().st_size < LARGEST_FILE


@pytest.fixture
def little(tmp_path):
    """A notebook with all that a careless hand leaves in one."""
    cells = [
        new_markdown_cell("# Little"),
        new_code_cell("import ipywidgets\nprint('a')\nprint('b')", metadata={"collapsed": True}),
        new_code_cell("ipywidgets.IntSlider(description='eta')", metadata={"tags": ["a-tag"]}),
        new_code_cell("import matplotlib.pyplot as plt\n_ = plt.plot([1, 2])"),
        new_code_cell("6 * 7"),
        new_code_cell("6 * 7"),
    ]
    metadata = {"language_info": {"name": "python", "version": "2.7"}, "widgets": {}, "toc": 1}
    path = tmp_path / "little.ipynb"
    nbformat.write(new_notebook(cells=cells, metadata=metadata), path)
    return path


def test_storing_twice_gives_the_same_bytes_and_the_check_tells_a_change(little, capsys):
    assert store.main([str(little)]) == 0
    once = little.read_bytes()
    stored = nbformat.read(little, as_version=4)

    assert set(stored.metadata) == {"kernelspec", "language_info"}
    assert [dict(c.metadata) for c in stored.cells[1:3]] == [{}, {"tags": ["a-tag"]}]
    assert len({cell.id for cell in stored.cells}) == len(stored.cells)
    assert stored.cells[1].outputs[0].text == "a\nb\n"
    assert list(stored.cells[2].outputs[0].data) == ["text/plain"]
    assert "image/png" in stored.cells[3].outputs[-1].data

    changed = little.read_text().replace('"42"', '"41"', 1)
    little.write_text(changed)
    assert store.main([str(little), "--check"]) == 1
    assert "cell 4 differs from a fresh run: 6 * 7" in capsys.readouterr().out
    assert store.main([str(little)]) == 0
    assert little.read_bytes() == once


def test_a_picture_is_compared_by_being_there():
    def shown(data):
        output = nbformat.v4.new_output("display_data", data=data)
        return store.tidy(new_notebook(cells=[new_code_cell("draw()", outputs=[output])]))

    one, other = ({"image/png": bits, "text/plain": "a figure"} for bits in ("AAAA", "BBBB"))
    assert store.difference(shown(one), shown(other)) is None
    assert store.difference(shown(one), shown({"text/plain": "a figure"})) is not None
