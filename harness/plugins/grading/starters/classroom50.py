"""`harness new --assignment classroom50`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.cli.command import Starter
from harness.plugins.grading.classroom.starter_files import write_starter


class Classroom50Starter(Starter):
    """The autograder of an assignment of Classroom 50."""

    name: ClassVar[str] = "classroom50"

    def write(self, folder: Path) -> list[str]:
        """Write the folder."""
        names = write_starter(self.name, folder)
        said = [f"wrote {folder}: {', '.join(names)}"]
        return [*said, f"copy it to CLASSROOM/autograders/ASSIGNMENT, or edit {folder} first"]
