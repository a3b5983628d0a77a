"""The wheel carries the pages as a student gets them: the solutions stay in the repository."""

import runpy
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class StudentsPages(BuildHookInterface):
    """Make the students' pages from the masters, and put them into the wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the pages; an editable install reads the masters in place."""
        if version == "editable":
            return
        root = Path(self.root)
        students_page = runpy.run_path(str(root / "arkaq_edu" / "_student.py"))["students_page"]
        for master in sorted((root / "notebooks").glob("*.ipynb")):
            page = root / "build" / "pages" / master.name
            page.parent.mkdir(parents=True, exist_ok=True)
            page.write_text(students_page(master.read_text("utf-8")), "utf-8")
            build_data["force_include"][str(page)] = f"arkaq_edu/_course/notebooks/{master.name}"
