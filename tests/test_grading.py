"""Marks by nbgrader itself, for blank, wrong, half-right and right answers in every chapter.

nbgrader is not part of a student's environment: `make grading` runs this in one of its own.
"""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pandas as pd
import pytest

from arkaq_edu import exercises
from arkaq_edu.release import release

pytest.importorskip("nbgrader", reason="make grading has an environment with nbgrader")

ROOT = Path(__file__).parents[1]
CHAPTERS = [
    path.stem
    for path in sorted((ROOT / "notebooks").glob("*.ipynb"))
    if '"nbgrader"' in path.read_text("utf-8")
]
WRONG = "def {name}({arguments}):\n    return -1.2345\n"
HALF = (
    "from arkaq_edu import exercises\n\n\n"
    "def {name}({arguments}, _calls=[0]):\n"
    "    _calls[0] += 1\n"
    "    right = exercises.{name}({arguments})\n"
    "    return right if _calls[0] % 3 else np.zeros_like(right)\n"
)
# An answer that depends on the number of the call is refused where chance is judged, and earns
# nothing where each of several results is judged whole: these are right in part, as a student's.
HALF_RIGHT = {
    "epsilon_greedy": "def epsilon_greedy(means, epsilon, rng):\n    return means.argmax()\n",
    "state_bounds": (
        "def state_bounds(vigilance, width):\n    return int(width / (2 * vigilance)) + 1, 99\n"
    ),
    "rate": "def rate(n):\n    return 0.1\n",
    "present": (
        "def present(pattern, centers, vigilance, eta):\n    return np.vstack([centers, pattern])\n"
    ),
}


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """The course folder that `arkaq release` writes."""
    folder = tmp_path_factory.mktemp("release")
    release(folder / "out")
    return folder / "out" / "nbgrader"


def nbgrader(course, *words):
    programs = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    answer = subprocess.run(
        [sys.executable, "-m", "nbgrader", *words],
        cwd=course, env=os.environ | {"PATH": programs}, capture_output=True, text=True,
    )  # fmt: skip
    assert answer.returncode == 0, answer.stderr[-3000:]
    return answer.stderr


def answered(kind, master):
    """The cell of an answer as a student of that kind hands it in."""
    function = next(n for n in ast.parse(master).body if isinstance(n, ast.FunctionDef))
    names = {"name": function.name, "arguments": ", ".join(a.arg for a in function.args.args)}
    before = "".join(f"{line}\n" for line in master.splitlines() if line.startswith("from "))
    if kind == "right":
        return master
    if kind == "wrong":
        return before + WRONG.format(**names)
    if not function.args.args:  # a judgment is right or wrong
        return master
    return before + HALF_RIGHT.get(function.name, HALF.format(**names))


def submission(course, chapter, kind):
    """What a student hands in: the released page, with answers."""
    page = nbformat.read(course / "release" / chapter / f"{chapter}.ipynb", as_version=4)
    master = nbformat.read(course / "source" / chapter / f"{chapter}.ipynb", as_version=4)
    for cell, own in zip(page.cells, master.cells, strict=True):
        if kind != "blank" and own.metadata.get("nbgrader", {}).get("solution"):
            cell.source = answered(kind, own.source)
    if kind != "blank":  # of the other pages only what is marked, to save time
        imports = nbformat.v4.new_code_cell("import numpy as np")
        page.cells = [imports, *(c for c in page.cells if "nbgrader" in c.metadata)]
    file = course / "submitted" / kind / chapter / f"{chapter}.ipynb"
    file.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(page, file)


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_blank_and_wrong_earn_nothing_right_all_and_half_right_something(course, chapter):
    nbgrader(course, "generate_assignment", chapter)
    released = (course / "release" / chapter / f"{chapter}.ipynb").read_text("utf-8")
    assert "SOLUTION" not in released and released.count("raise NotImplementedError") >= 3
    for kind in ("blank", "wrong", "half", "right"):
        submission(course, chapter, kind)
    warned = nbgrader(course, "autograde", chapter)
    assert "cannot be converted" not in warned and "partial credit" not in warned
    blank = nbformat.read(
        course / "autograded" / "blank" / chapter / f"{chapter}.ipynb", as_version=4
    )
    errors = [o for cell in blank.cells for o in cell.get("outputs", []) if "ename" in o]
    assert errors == [], "a blank page runs to its end"
    nbgrader(course, "generate_feedback", chapter)
    nbgrader(course, "export", "--to", "marks.csv")
    marks = pd.read_csv(course / "marks.csv").set_index(["assignment", "student_id"]).loc[chapter]
    name = list(exercises.CHAPTERS)[CHAPTERS.index(chapter)]
    points = sum(exercise.points for exercise in exercises.CHAPTERS[name])
    assert marks.max_score.unique().tolist() == [points]
    assert marks.score[["blank", "wrong", "right"]].tolist() == [0, 0, points]
    each = by_exercise(course, chapter)
    for kind, share in (("blank", 0.0), ("wrong", 0.0), ("right", 1.0)):
        assert [earned for earned, _ in each[kind].values()] == [
            share * most for _, most in each[kind].values()
        ]
    whole = judgments(course, chapter)
    for name, (earned, most) in each["half"].items():
        assert earned == most if name in whole else 0 < earned < most, (name, earned, most)
    feedback = course / "feedback" / "half" / chapter / f"{chapter}.html"
    assert "Not yet: " in feedback.read_text("utf-8")


def judgments(course, chapter):
    """The graded cells of the exercises that are right or wrong, and nothing between."""
    page = nbformat.read(course / "source" / chapter / f"{chapter}.ipynb", as_version=4)
    cells = [cell for cell in page.cells if "nbgrader" in cell.metadata]
    return [
        check.metadata.nbgrader.grade_id
        for answer, check in zip(cells[::2], cells[1::2], strict=True)
        if re.search(r"^def \w+\(\):", answer.source, re.M)
    ]


def by_exercise(course, chapter):
    """The marks of each student: what each graded cell earned, and what it could."""
    from nbgrader.api import Gradebook

    with Gradebook(f"sqlite:///{course / 'gradebook.db'}") as book:
        return {
            submitted.student.id: {
                grade.name: (grade.auto_score, grade.max_score)
                for notebook in submitted.notebooks
                for grade in notebook.grades
            }
            for submitted in book.assignment_submissions(chapter)
        }
