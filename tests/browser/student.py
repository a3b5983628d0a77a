"""The student's way in: `arkaq lab` in a fresh clone, every exercise blank, then one solved.

`make student` tries every chapter, which takes a while; without EVERY_CHAPTER it is one.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import expect

from arkaq_edu import exercises
from tests.browser.conftest import RUN_ALL, opening, serving
from tests.browser.reading import OUTPUTS, assert_sound, errors

ROOT = Path(__file__).parents[2]
PAGES = dict(
    zip(
        sorted(p.name for p in (ROOT / "notebooks").glob("*.ipynb") if "nbgrader" in p.read_text()),
        exercises.CHAPTERS,
        strict=True,
    )
)
#: All chapters, by the clone's own package. That compiles everything anew, and takes minutes.
THOROUGH = "EVERY_CHAPTER" in os.environ
CHAPTER = "05_kalman_filter.ipynb"
RIGHT = "def nis(innovation, S):\n    return innovation @ np.linalg.solve(S, innovation)"
WRONG = "def nis(innovation, S):\n    return innovation @ innovation"


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """A fresh clone of this repository."""
    folder = tmp_path_factory.mktemp("clone") / "arkaq_edu"
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    return folder


@pytest.fixture(scope="module")
def student(clone, chromium, tmp_path_factory):
    """A function that opens a page of the student's copy, which `make lab` makes in the clone."""
    command = [sys.executable, "-m", "arkaq_edu.cli", "lab", "--no-browser"]
    home = tmp_path_factory.mktemp("home")
    with (
        serving(command, home, clone, PYTHONPATH=str(clone if THOROUGH else ROOT)) as address,
        opening(address, chromium) as open_,
    ):
        yield open_


def texts(page):
    """What the cells of the open page print and say, without their pictures."""
    outputs = page.evaluate(OUTPUTS)
    return [
        "".join(o.get("text") or o.get("data", {}).get("text/plain", ""))
        for o in outputs
        if "image/png" not in o.get("data", {})
    ]


def changed(clone):
    """What version control sees of a student's work."""
    status = ["git", "status", "--porcelain"]
    return subprocess.run(status, cwd=clone, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("name", PAGES if THOROUGH else [CHAPTER])
def test_a_blank_page_runs_to_its_end_and_gives_nothing_away(student, clone, name):
    page = student(name, run=False)
    assert texts(page) == [], "no answer stands under a question"
    page.evaluate(RUN_ALL)
    assert errors(page) == []
    assert_sound(page)
    said = "\n".join(texts(page))
    chapter = exercises.CHAPTERS[PAGES[name]]
    for exercise in chapter:
        assert f"{exercise.name} is still empty" in said
        assert f"goes on with the course's own {exercise.name}." in said
        for secret in (exercise.praise, *exercise.hints, exercise.solution().source):
            assert secret not in said
    assert f"{PAGES[name]}: 0 of {len(chapter)} exercises solved" in said
    page.evaluate("jupyterapp.commands.execute('docmanager:save')")
    assert changed(clone) == ""


def test_an_exercise_is_failed_hinted_and_solved(student, clone):
    page = student(CHAPTER)
    cells = page.locator(".jp-Notebook .jp-Cell")
    sources = page.evaluate(
        "Array.from(jupyterapp.shell.currentWidget.content.model.cells).map("
        "(cell) => cell.sharedModel.getSource())"
    )
    answer = next(i for i, source in enumerate(sources) if source.startswith("def nis("))
    checked = cells.nth(answer + 1).locator(".jp-OutputArea")

    def write(number, text):
        cells.nth(number).locator(".cm-content").click()
        page.keyboard.press("Control+A")
        page.keyboard.insert_text(text)
        page.keyboard.press("Shift+Enter")

    for attempt in (1, 2, 3):
        write(answer, WRONG)
        page.evaluate("jupyterapp.commands.execute('notebook:run-cell')")
        expect(checked).to_contain_text("you never use S")
        offered = "exercises.nis.hint()" in checked.inner_text()
        assert offered == (attempt == 3)
    write(answer + 1, "nis = exercises.nis.check(nis)\nexercises.nis.hint()")
    expect(checked).to_contain_text("Hint 1 of 3: For one number it would be v * v / S.")
    write(answer, RIGHT)
    page.evaluate("jupyterapp.commands.execute('notebook:run-cell')")
    expect(checked).to_contain_text("Right: a surprise")
    last = len(sources) - 1
    write(last, sources[last])
    expect(cells.nth(last).locator(".jp-OutputArea")).to_contain_text(
        "kalman: 1 of 4 exercises solved; still open: combine, turn, what_to_change"
    )
    page.evaluate("jupyterapp.commands.execute('docmanager:save')")
    assert (clone / "arkaq-course" / "progress.json").exists()
    assert changed(clone) == ""
