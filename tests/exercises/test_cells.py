"""The exercises as they stand in the notebooks: marked for an autograder, solvable, and blank."""

import inspect
from pathlib import Path

import nbformat
import numpy as np
import pytest

from arkaq_edu import exercises
from arkaq_edu.exercises import ExerciseError

FOLDER = Path(__file__).parents[2] / "notebooks"
CELLS = {
    path.stem: [
        cell for cell in nbformat.read(path, as_version=4).cells if "nbgrader" in cell.metadata
    ]
    for path in sorted(FOLDER.glob("*.ipynb"))
}
CHAPTERS = [name for name in CELLS if not name.startswith("00")]


def blank(source):
    """Give what a student gets: the solution taken out, an empty body put in."""
    head, rest = source.split("    ### BEGIN SOLUTION\n")
    return head + "    raise NotImplementedError\n" + rest.split("### END SOLUTION")[1]


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
@pytest.mark.parametrize("solved", [True, False])
def test_the_masters_answers_pass_and_the_students_blanks_fail_at_the_checks(chapter, solved):
    room = {"np": np}
    for cell in CELLS[chapter]:
        if not cell.metadata.nbgrader.grade:
            exec(cell.source if solved else blank(cell.source), room)
        elif solved:
            exec(cell.source, room)
        else:
            with pytest.raises(ExerciseError, match="still empty"):
                exec(cell.source, room)


def test_each_check_cell_calls_its_exercise_and_gives_its_points():
    checked = []
    for cell in (cell for chapter in CHAPTERS for cell in CELLS[chapter]):
        if not cell.metadata.nbgrader.grade:
            names = {"np": np}
            exec(cell.source, names)
            continue
        name = cell.source.splitlines()[-1].partition(".check(")[0].removeprefix("exercises.")
        exercise = getattr(exercises, name)
        assert cell.source.splitlines()[-1] == f"exercises.{name}.check({name})"
        assert cell.metadata.nbgrader.points == exercise.points
        assert inspect.signature(names[name]) == inspect.signature(exercise)
        assert [output.text for output in cell.outputs] == [exercise.praise + "\n"]
        checked.append(exercise)
    assert checked == [exercise for chapter in exercises.CHAPTERS.values() for exercise in chapter]
