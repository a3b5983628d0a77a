"""Where the notebooks and data of the course are."""

from __future__ import annotations

from pathlib import Path

FIRST_PAGE = "00_start_here.ipynb"
#: The file in a student's copy that says what was handed out.
HANDED_OUT = ".arkaq-course.json"


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
        there = ", ".join(file.relative_to(folder).as_posix() for file in course_files(folder))
        raise FileNotFoundError(f"no data file {name!r} in this course; there are: {there}")
    return path


def own_copy() -> Path | None:
    """Return the student's copy of the course in which Python works, if it is one."""
    here = Path.cwd()
    return next((f for f in (here, *here.parents) if (f / HANDED_OUT).is_file()), None)


def course_files(folder: Path) -> list[Path]:
    """List the files of the course in `folder`: no tools, caches or checkpoints."""
    return [
        path
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and path.suffix not in {".py", ".pyc"}
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    ]
