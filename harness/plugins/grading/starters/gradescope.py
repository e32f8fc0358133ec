"""`harness new --assignment gradescope`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.cli.command import Starter
from harness.plugins.grading.classroom.starter_files import write_starter


class GradescopeStarter(Starter):
    """A programming assignment of Gradescope, with the archive that is uploaded."""

    name: ClassVar[str] = "gradescope"

    def write(self, folder: Path) -> list[str]:
        """Write the folder and `autograder.zip`."""
        names = write_starter(self.name, folder, "autograder.zip")
        said = [f"wrote {folder}: {', '.join(names)}"]
        return [*said, f"upload {folder / 'autograder.zip'}, or edit {folder / 'assignment'} first"]
