"""What a teacher gets: a release, slides, and a list of known mistakes that is current."""

import re
import zipfile
from pathlib import Path

import nbformat
import pytest
from click.testing import CliRunner

from arkaq_edu import cli, exercises
from arkaq_edu._copy import course_pages
from arkaq_edu.release import mistakes, write_mistakes
from arkaq_edu.slides import slides

ROOT = Path(__file__).parents[1]
MASTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    """The folder that `arkaq release` writes."""
    out = tmp_path_factory.mktemp("out") / "release"
    answer = CliRunner().invoke(cli.main, ["release", str(out)])
    assert answer.exit_code == 0, answer.output
    assert answer.output.count("yours alone") == 2
    return out


def test_the_student_gets_what_arkaq_lab_gives(released):
    student = released / "student"
    files = {p.relative_to(student).as_posix(): p.read_bytes() for p in student.rglob("*.*")}
    assert files.pop(".arkaq-course.json") and files == course_pages()
    assert not any(b"BEGIN SOLUTION" in content for content in files.values())


def test_the_teacher_gets_solutions_and_the_answers_to_the_predictions(released):
    with zipfile.ZipFile(released / "teacher.zip") as archive:
        names = archive.namelist()
        answers = archive.read("predictions.md").decode()
        pages = [archive.read(f"notebooks/{m.name}") for m in MASTERS]
    assert {"TEACHING.md", "LICENSE", "notebooks/img/robot.png"} <= set(names)
    assert pages == [m.read_bytes() for m in MASTERS]
    for master in MASTERS:
        cells = nbformat.read(master, as_version=4).cells
        asked = [
            paragraph
            for cell in cells
            if cell.cell_type == "markdown"
            for paragraph in cell.source.split("\n\n")
            if paragraph.startswith("**Predict")
        ]
        assert [question for question in asked if question not in answers] == []
    unanswered = [block for block in answers.split("\n**Predict")[1:] if "\n> " not in block]
    assert unanswered == []


def test_nbgrader_gets_a_folder_for_each_chapter_with_exercises(released):
    source = released / "nbgrader" / "source"
    chapters = sorted(source.glob("*/*.ipynb"))
    assert [c.stem for c in chapters] == [c.parent.name for c in chapters]
    assert len(chapters) == len(exercises.CHAPTERS)
    assert "NotImplementedError" in (released / "nbgrader" / "nbgrader_config.py").read_text()


def test_a_release_writes_over_nothing(released):
    answer = CliRunner().invoke(cli.main, ["release", str(released)])
    assert answer.exit_code == 2 and "holds files already" in answer.output


def test_the_list_of_known_mistakes_is_current(tmp_path):
    page = tmp_path / "TEACHING.md"
    page.write_bytes((ROOT / "TEACHING.md").read_bytes())
    write_mistakes(page)
    assert page.read_text("utf-8") == (ROOT / "TEACHING.md").read_text("utf-8"), "make teaching"
    listed = mistakes()
    for exercise in (e for chapter in exercises.CHAPTERS.values() for e in chapter):
        assert f"**{exercise.name}**" in listed
        for part in exercise.parts:
            assert all(words in listed for words in part.wrong.values())


def test_slides_show_each_output_at_a_key_press_and_no_solution(tmp_path, monkeypatch):
    one = [m for m in MASTERS if m.stem.startswith("05")]
    monkeypatch.setattr("arkaq_edu.slides.course_folder", lambda: tmp_path)
    (tmp_path / "notebooks").mkdir()
    for master in one:
        (tmp_path / "notebooks" / master.name).write_bytes(master.read_bytes())
    (tmp_path / "out" / "node_modules").mkdir(parents=True)
    (page,) = slides(tmp_path / "out")
    text = page.read_text("utf-8")
    assert text.count("<section") > 30 and text.count('class="fragment') > 10
    assert "BEGIN SOLUTION" not in text and "NotImplementedError" in text
    assert "exercises.turn.check" not in text.replace("<span", "") and "data:image/png" in text
    loads = r"""(?:src|import|from|url\(|link [^>]*href)[=( ]*["']?(http[^"' )]+)"""
    assert re.findall(loads, text.replace("node_modules", "http://here")), "it finds what is loaded"
    loaded = re.findall(loads, text)
    assert loaded == [], "with the libraries beside them the slides need no network"
