"""Where the notebooks and data of the course are, and how a student gets a copy."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

from arkaq_edu._files import replacing

FIRST_PAGE = "00_start_here.ipynb"
_SOLUTION = re.compile(r"^( *)### BEGIN SOLUTION\n.*?^ *### END SOLUTION", re.MULTILINE | re.DOTALL)


def in_repository() -> bool:
    """Return whether the package runs from the repository rather than from a wheel.

    Examples
    --------
    >>> in_repository() == (course_folder() / "pyproject.toml").exists()
    True
    """
    return not (Path(__file__).parent / "_course").is_dir()


def course_folder() -> Path:
    """Return the folder that holds ``notebooks`` and ``data``.

    In a wheel it is a folder inside the package; in the repository it is the root.

    Examples
    --------
    >>> (course_folder() / "notebooks").is_dir()
    True
    """
    package = Path(__file__).parent
    return package.parent if in_repository() else package / "_course"


def data_file(name: str) -> Path:
    """Return the path of the course's data file `name`.

    Parameters
    ----------
    name : str
        A path below the folder ``data``.

    Raises
    ------
    FileNotFoundError
        If there is no such file. The message lists the files that exist.

    Examples
    --------
    >>> data_file("moon.npz")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    FileNotFoundError: no data file 'moon.npz' in this course; there are: ...
    """
    folder = course_folder() / "data"
    path = folder / name
    if not path.is_file():
        there = ", ".join(file.relative_to(folder).as_posix() for file in _files(folder))
        raise FileNotFoundError(f"no data file {name!r} in this course; there are: {there}")
    return path


def copy_course(folder: Path | str) -> tuple[list[Path], list[Path]]:
    """Copy the course into `folder` without overwriting anything.

    The copy contains no solutions and no outputs of the checks.

    Parameters
    ----------
    folder : path
        It is created if it does not exist.

    Returns
    -------
    copied : list of Path
        The new files, relative to `folder`.
    kept : list of Path
        The existing files that differ from the course, relative to `folder`. They are the
        reader's own work and stay unchanged.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     copied, kept = copy_course(folder)
    ...     again = copy_course(folder)
    >>> Path("notebooks/00_start_here.ipynb") in copied, kept, again
    (True, [], ([], []))
    """
    source = course_folder()
    copied, kept = [], []
    for file in [*_files(source / "notebooks"), *_files(source / "data")]:
        name = file.relative_to(source)
        target = Path(folder) / name
        content = without_solutions(file) if file.suffix == ".ipynb" else file.read_bytes()
        if not os.path.lexists(target):
            with replacing(target) as fresh:
                fresh.write_bytes(content)
            copied.append(name)
        elif not target.is_file() or target.read_bytes() != content:
            kept.append(name)
    return copied, kept


def without_solutions(notebook: Path) -> bytes:
    """Return a notebook without the solutions of its exercises, as a student gets it.

    Examples
    --------
    >>> page = without_solutions(course_folder() / "notebooks" / "05_kalman_filter.ipynb")
    >>> b"SOLUTION" in page, b"raise NotImplementedError" in page
    (False, True)
    """
    pages = json.loads(notebook.read_text(encoding="utf-8"))
    for cell in pages["cells"]:
        marks = cell["metadata"].get("nbgrader", {})
        if marks.get("solution"):
            open_answer = _SOLUTION.sub(
                r"\1# your answer, in place of this line and the next\n"
                r"\1raise NotImplementedError",
                "".join(cell["source"]),
            )
            cell["source"] = open_answer.splitlines(keepends=True)
        if marks.get("grade"):
            cell["outputs"], cell["execution_count"] = [], None
    return (json.dumps(pages, indent=1, ensure_ascii=False) + "\n").encode()


def _files(folder: Path) -> list[Path]:
    """List the files of the course in `folder`: no tools, caches or checkpoints."""
    return [
        path
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and path.suffix not in {".py", ".pyc"}
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    ]
