"""`harness run` with `--film`."""

from __future__ import annotations

import argparse
from typing import ClassVar

from harness.cli.run_mode import RunCall, RunFiles, RunMode


class FilmMode(RunMode):
    """Write a film of each case into its report."""

    name: ClassVar[str] = "film"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add `--film`."""
        text = "write a film of the replay and a picture of the deciding moment into the report too"
        command.add_argument("--film", action="store_true", help=f"{text}; needs the extra `video`")

    def run(self, run_files: RunFiles, call: RunCall) -> int:
        """Run scenarios, with the reporter `film` if it is requested."""
        if call.arguments.film:
            call.arguments.reporters = (*call.arguments.reporters, "film")
        return run_files(call)
