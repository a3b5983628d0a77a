"""The exercises as they stand in the notebooks: marked for an autograder, solvable, and blank."""

import inspect
from pathlib import Path

import nbformat
import numpy as np
import pytest

from arkaq_edu import exercises
from arkaq_edu._student import students_page

FOLDER = Path(__file__).parents[2] / "notebooks"


def marked(text):
    return [c for c in nbformat.reads(text, as_version=4).cells if "nbgrader" in c.metadata]


MASTERS = {path.stem: path.read_text("utf-8") for path in sorted(FOLDER.glob("*.ipynb"))}
CELLS = {name: marked(text) for name, text in MASTERS.items()}
CHAPTERS = [name for name, cells in CELLS.items() if cells]


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_every_exercise_is_marked_for_the_autograder(chapter):
    cells = CELLS[chapter]
    marks = [cell.metadata.nbgrader for cell in cells]
    assert len({mark.grade_id for mark in marks}) == len(marks) >= 6, "three exercises at least"
    for answer, check in zip(marks[::2], marks[1::2], strict=True):
        assert answer.solution and not answer.grade and not answer.locked
        assert check.grade and check.locked and not check.solution and check.points > 0
        assert {answer.schema_version, check.schema_version} == {3}
    for cell in cells[::2]:
        assert cell.source.count("### BEGIN SOLUTION") == cell.source.count("### END SOLUTION") == 1


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_the_masters_answers_pass_and_the_page_goes_on_with_them(chapter, capsys):
    room = {"np": np}
    for answer, check in zip(CELLS[chapter][::2], CELLS[chapter][1::2], strict=True):
        exec(answer.source, room)
        name = check.source.splitlines()[-1].split()[0]
        own = room[name]
        exec(check.source, room)
        assert room[name] is own
    assert "Not yet" not in capsys.readouterr().out


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_a_page_of_blanks_goes_on_with_the_courses_own_answers(chapter, capsys):
    room = {"np": np}
    for cell in marked(students_page(MASTERS[chapter])):
        exec(cell.source, room)
        if cell.metadata.nbgrader.grade:
            name = cell.source.splitlines()[-1].split()[0]
            assert room[name] is getattr(exercises, name).right
            assert f"{name} is still empty" in capsys.readouterr().out


def test_each_check_cell_calls_its_exercise_and_gives_its_points():
    checked = []
    for cell in (cell for chapter in CHAPTERS for cell in CELLS[chapter]):
        if not cell.metadata.nbgrader.grade:
            names = {"np": np}
            exec(cell.source, names)
            continue
        name = cell.source.splitlines()[-1].split()[0]
        exercise = getattr(exercises, name)
        assert cell.source.splitlines()[-1] == f"{name} = exercises.{name}.check({name})"
        assert cell.metadata.nbgrader.points == exercise.points
        assert inspect.signature(names[name]) == inspect.signature(exercise)
        assert [output.text for output in cell.outputs] == [exercise.praise + "\n"]
        checked.append(exercise)
    assert checked == [exercise for chapter in exercises.CHAPTERS.values() for exercise in chapter]


def test_each_chapter_ends_with_what_is_solved():
    ends = [nbformat.reads(MASTERS[c], as_version=4).cells[-1] for c in CHAPTERS]
    assert [c.source for c in ends] == [f'exercises.progress("{n}")' for n in exercises.CHAPTERS]
    assert all("that is all of them" in cell.outputs[0].text for cell in ends)
