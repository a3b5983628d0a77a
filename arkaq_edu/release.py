"""The course as a teacher hands it out: `arkaq release`."""

from __future__ import annotations

import json
import shutil
import zipfile
from pathlib import Path
from typing import Any

from arkaq_edu._copy import copy_course
from arkaq_edu._files import replacing
from arkaq_edu._paths import course_files, course_folder, in_repository
from arkaq_edu.exercises import CHAPTERS

BEGIN, END = "<!-- made by `make teaching` -->", "<!-- end -->"
NBGRADER_CONFIG = '''\
"""nbgrader's settings for this course. See TEACHING.md."""

c = get_config()  # noqa: F821
c.CourseDirectory.course_id = "arkaq"
c.ClearSolutions.code_stub = {
    "python": "# your answer, in place of this line and the next\\nraise NotImplementedError"
}
# A chapter that is run from top to bottom takes up to a minute or two on a slow machine.
c.ExecutePreprocessor.timeout = 600
'''


def release(out: Path | str) -> list[str]:
    """Write what a teacher hands out, and what a teacher keeps, into a new folder.

    Parameters
    ----------
    out : path
        A folder that does not exist yet, or is empty.

    Returns
    -------
    list of str
        What was written, a line each.

    Raises
    ------
    ValueError
        If the package does not run from a clone (a wheel holds no solutions), or the folder holds
        something.
    """
    if not in_repository():
        raise ValueError("a release is made in a clone of the repository: a wheel has no solutions")
    out, root = Path(out), course_folder()
    if out.exists() and any(out.iterdir()):
        raise ValueError(f"{out} holds files already: name a new folder")
    copy_course(out / "student")
    masters = sorted((root / "notebooks").glob("*.ipynb"))
    _archive(out / "teacher.zip", root, masters)
    for master in masters:
        if '"nbgrader"' in master.read_text("utf-8"):
            assignment = out / "nbgrader" / "source" / master.stem
            assignment.mkdir(parents=True)
            shutil.copy(master, assignment)
    (out / "nbgrader" / "nbgrader_config.py").write_text(NBGRADER_CONFIG, "utf-8")
    return [
        f"{out / 'student'}: the course without solutions, to hand out as it is",
        f"{out / 'teacher.zip'}: solutions, answers to the predictions, TEACHING.md: yours alone",
        f"{out / 'nbgrader'}: a course folder for nbgrader, with the solutions: yours alone",
    ]


def predictions(notebook: str) -> str:
    """Return each question of a page that asks for a prediction, with what the page shows next.

    Parameters
    ----------
    notebook : str
        The text of a master notebook.

    Examples
    --------
    >>> ask = {"cell_type": "markdown", "source": ["**Predict:** what is 6 times 7?"]}
    >>> out = {"output_type": "stream", "text": ["42"]}
    >>> show = {"cell_type": "code", "source": ["print(6 * 7)"], "outputs": [out]}
    >>> print(predictions(json.dumps({"cells": [ask, show]})))
    **Predict:** what is 6 times 7?
    <BLANKLINE>
    > 42
    <BLANKLINE>
    """
    cells = json.loads(notebook)["cells"]
    found = []
    for number, cell in enumerate(cells):
        if cell["cell_type"] != "markdown":
            continue
        paragraphs = "".join(cell["source"]).split("\n\n")
        for paragraph, after in zip(paragraphs, [*paragraphs[1:], ""], strict=True):
            if paragraph.startswith(("**Predict", "**Before you go on")):
                questions = [paragraph, after] if after.startswith("1. ") else [paragraph]
                shown = "\n".join(f"> {line}" for line in _shown_next(cells[number + 1 :]))
                found.append("\n\n".join([*questions, f"{shown}\n"]))
    return "\n".join(found)


def _shown_next(cells: list[dict[str, Any]]) -> list[str]:
    """Return what the next output says, and the first paragraph about it."""
    answers = [i for i, c in enumerate(cells) if c.get("outputs") and not _graded(c)]
    if not answers:
        return ["(The page shows no answer: try it.)"]
    outputs = cells[answers[0]]["outputs"]
    texts = [o.get("text") or o.get("data", {}).get("text/plain", "") for o in outputs]
    lines = [line for text in texts for line in "".join(text).splitlines()]
    after = cells[answers[0] + 1 :][:1]
    if after and after[0]["cell_type"] == "markdown":
        lines += ["", *"".join(after[0]["source"]).split("\n\n")[0].splitlines()]
    said = [line for line in lines if not line.startswith(("<Figure", "#"))]
    return said or ["(A picture: see the page.)"]


def _graded(cell: dict[str, Any]) -> bool:
    return "nbgrader" in cell.get("metadata", {})


def mistakes() -> str:
    """Return the exercises with the wrong answers that their checks know, chapter by chapter.

    Examples
    --------
    >>> mistakes().splitlines()[2]
    '**finite_sum** (1 point): Return the sum of the first h rewards.'
    """
    parts = []
    for chapter, exercises in CHAPTERS.items():
        parts.append(f"### {chapter}\n")
        for exercise in exercises:
            asks = (exercise.right.__doc__ or "").partition("\n")[0]
            points = f"{exercise.points} point{'s' * (exercise.points != 1)}"
            parts.append(f"**{exercise.name}** ({points}): {asks}\n")
            known = [pair for part in exercise.parts for pair in part.wrong.items()]
            parts += [f"- `{expression}`: {words}" for expression, words in known]
            parts += [""] * bool(known)
    return "\n".join(parts)


def write_mistakes(page: Path | str) -> None:
    """Bring the list of known mistakes in TEACHING.md up to date."""
    page = Path(page)
    before, rest = page.read_text("utf-8").split(f"{BEGIN}\n")
    after = rest.split(END)[1]
    with replacing(page) as fresh:
        fresh.write_text(f"{before}{BEGIN}\n\n{mistakes()}\n{END}{after}", "utf-8")


def _archive(path: Path, root: Path, masters: list[Path]) -> None:
    """Write the teacher's archive: masters, what they need, and the answers to the predictions."""
    answers = "\n".join(
        f"# {master.stem}\n\n{text}"
        for master in masters
        if (text := predictions(master.read_text("utf-8")))
    )
    with replacing(path) as fresh, zipfile.ZipFile(fresh, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in [*course_files(root / "notebooks"), root / "TEACHING.md", root / "LICENSE"]:
            archive.write(file, file.relative_to(root))
        archive.writestr("predictions.md", answers)
