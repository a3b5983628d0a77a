"""The pages of the site, and what must not be in them."""

import base64
import io

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from PIL import Image

from arkaq_edu.site.build import site
from arkaq_edu.site.chapters import chapters, write_chapter
from arkaq_edu.site.links import problems
from arkaq_edu.site.reference import documented, plain_docstring
from arkaq_edu.site.tables import write_benchmarks
from arkaq_edu.trace import table

SOLVED = "def f(x):\n    ### BEGIN SOLUTION\n    return 42\n    ### END SOLUTION"


def png(width, height):
    file = io.BytesIO()
    Image.new("RGB", (width, height)).save(file, "PNG")
    return base64.b64encode(file.getvalue()).decode()


@pytest.fixture
def page(tmp_path):
    """A small chapter as Sphinx gets it, and the folder of its pictures."""

    def shown(width, height, alt):
        return new_output(
            "display_data",
            data={"image/png": png(width, height), "text/plain": alt},
            metadata={"image/png": {"alt": alt}},
        )

    cells = [
        new_markdown_cell("# 3. Belief\n\n**Predict:** what comes?"),
        new_code_cell(SOLVED, metadata={"nbgrader": {"solution": True}}),
        new_code_cell("print(6)", outputs=[new_output("stream", text="6")]),
        new_code_cell("plot()", outputs=[shown(30, 20, "a < b")]),
        new_code_cell("belief_explorer()", outputs=[shown(40, 20, "sure")]),
    ]
    master = tmp_path / "03_belief.ipynb"
    nbformat.write(new_notebook(cells=cells), master)
    (tmp_path / "out").mkdir()
    write_chapter(master, tmp_path / "out", tmp_path)
    return nbformat.read(tmp_path / "out" / master.name, as_version=4), tmp_path


def test_a_page_shows_no_solution_and_hides_the_answer_to_a_prediction(page):
    cells = page[0].cells
    assert "return 42" not in cells[1].source and "your answer" in cells[1].source
    assert cells[2].metadata["tags"] == ["hide-output"]
    assert "tags" not in cells[3].metadata


def test_a_picture_is_a_file_with_its_size_and_its_words(page):
    notebook, folder = page
    html = notebook.cells[3].outputs[0].data["text/html"]
    assert 'alt="a &lt; b"' in html and 'width="30" height="20"' in html
    assert (folder / "03_belief-1.png").read_bytes() == base64.b64decode(png(30, 20))


def test_an_explorer_is_a_place_that_comes_to_life_over_its_still_picture(page):
    html = page[0].cells[4].outputs[0].data["text/html"]
    assert html.startswith('<div class="arkaq-living" data-explorer="belief_explorer" ')
    assert 'width="20"' in html


def test_the_home_page_says_of_each_chapter_what_the_first_page_says():
    found = {chapter.name: chapter for chapter in chapters()}
    assert found["03_belief_states"].title == "3. Belief states"
    assert "probability for each place" in found["03_belief_states"].about


def test_every_documented_name_is_importable_and_most_of_the_trace_leads_to_one():
    names = documented()
    assert names["art/euclidean.py", "EuclideanART"] == "arkaq_edu.art.EuclideanART"
    rows = table()
    rows = rows[(rows.kind == "eq") & (rows.name != "")]
    first = rows.groupby("number").first()
    linked = [(file, name) in names for file, name in zip(first.file, first.name, strict=True)]
    assert sum(linked) > 0.9 * len(linked)


def test_plain_text_stays_plain_for_sphinx():
    lines = ["Return |a - b| (of n_features_in_,)", ">>> a | b", "``|x|``"]
    plain_docstring(None, "function", "", None, None, lines)
    assert lines == [r"Return \|a - b\| (of n_features_in\_,)", ">>> a | b", "``|x|``"]


@pytest.mark.parametrize(
    ("page", "style", "fault"),
    [
        ('<a href="sub/b.html#here">b</a>', "", ""),
        ('<a href="https://example.org">out</a>', "", ""),
        ('<a href="#top">up</a>', "", "no place for #top"),
        ('<a href="sub/b.html#gone">b</a>', "", "no place for sub/b.html#gone"),
        ('<img src="gone.png">', "", "no file for gone.png"),
        ('<script src="//cdn.example.org/x.js"></script>', "", "asks elsewhere"),
        ('<link rel="stylesheet" href="http://example.org/x.css">', "", "asks elsewhere"),
        ('<div style="background: url(http://example.org/x)"></div>', "", "asks elsewhere"),
        ("", "@import 'https://example.org/x.css';", "asks elsewhere"),
        ("", "a { src: url(https://example.org/x.woff) }", "asks elsewhere"),
    ],
)
def test_links_to_nowhere_and_requests_to_elsewhere_are_found(tmp_path, page, style, fault):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "b.html").write_text('<p id="here">b</p>')
    (tmp_path / "a.html").write_text(page)
    (tmp_path / "a.css").write_text(style)
    found = problems(tmp_path)
    assert (fault in found[0]) if fault else found == []


def test_a_heavy_page_is_found(tmp_path):
    (tmp_path / "a.html").write_text('<script src="a.js"></script>')
    (tmp_path / "a.js").write_bytes(b" " * 8_000_001)
    assert problems(tmp_path) == ["a.html: weighs 8.0 MB with what it loads"]


def test_the_report_of_the_benchmarks_is_a_page_if_there_is_one(tmp_path, monkeypatch):
    monkeypatch.setattr("arkaq_edu.site.tables.course_folder", lambda: tmp_path)
    assert not write_benchmarks(tmp_path / "page.md", tmp_path)
    report = tmp_path / "benchmarks" / "report"
    report.mkdir(parents=True)
    (report / "growth.svg").write_text("<svg/>")
    (report / "index.html").write_text(
        "<html><style>b { }\n\n</style>\n<h1>Speed</h1>\n<table>\n\n</table>\n"
        '<p>1 of 2 wanted figures are met.</p><img src="growth.svg"></html>'
    )
    (tmp_path / "pictures").mkdir()
    assert write_benchmarks(tmp_path / "page.md", tmp_path / "pictures")
    page = (tmp_path / "page.md").read_text()
    assert page.startswith("# Benchmarks") and "1 of 2 wanted figures are met" in page
    assert "style" not in page and "html" not in page and "\n\n" not in page.split("report")[1]
    assert '"_static/pictures/growth.svg"' in page and (tmp_path / "pictures/growth.svg").exists()


def test_a_folder_with_other_files_is_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ValueError, match="holds files already"):
        site(tmp_path)
