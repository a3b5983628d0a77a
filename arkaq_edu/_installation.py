"""Check that the course can run here, and say what to do where it cannot."""

from __future__ import annotations

import os
from importlib.metadata import PackageNotFoundError, requires, version

from packaging.requirements import Requirement

from arkaq_edu._paths import data_file

REMEDY = "run `make install` in the course's folder, or `pip install --upgrade arkaq-edu`"


def check_installation() -> None:
    """Print whether everything that the course needs is installed and works.

    Each problem is printed with what to do about it.

    Examples
    --------
    >>> check_installation()
    Everything is there. The course can run.
    """
    problems = [*_packages(), *_files()]
    for problem in problems:
        print(problem)
    if not problems:
        print("Everything is there. The course can run.")


def _packages() -> list[str]:
    """Return what is wrong with the packages that the course needs."""
    problems = []
    for line in requires("arkaq-edu") or []:
        needed = Requirement(line)
        if needed.marker is not None and not needed.marker.evaluate({"extra": ""}):
            continue
        try:
            found = version(needed.name)
        except PackageNotFoundError:
            problems.append(f"{needed.name} is missing: {REMEDY}.")
        else:
            if not needed.specifier.contains(found, prereleases=True):
                problems.append(
                    f"{needed.name} {found} is installed, but the course needs "
                    f"{needed.name}{needed.specifier}: {REMEDY}."
                )
    return problems


def _files() -> list[str]:
    """Return what is wrong with the course's data and with the folder of the notebook."""
    problems = []
    try:
        data_file("sightings.csv")
    except FileNotFoundError:
        problems.append(f"The recorded data of the course are missing: {REMEDY}.")
    if not os.access(".", os.W_OK):
        problems.append(
            f"Nothing can be saved in {os.getcwd()}: run `arkaq lab FOLDER` with a folder of "
            "your own, and work there."
        )
    return problems
