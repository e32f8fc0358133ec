"""`harness compare`: what changed from one saved run to another."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import output_file
from harness.cli.command import RESULTS, Command
from harness.cli.files import run_folder, write_text
from harness.cli.output import say, say_json
from harness.cli.shared_options import add_json
from harness.suite.outcome import EXIT_CODES

PAGE = "reports/compare.html"


class CompareCommand(Command):
    """Report what changed from one saved run to another, and write a page of both."""

    name: ClassVar[str] = "compare"
    group: ClassVar[str] = RESULTS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness compare`."""
        command.add_argument("first", metavar="RUN", help="the report folder of a run")
        command.add_argument("second", metavar="RUN", help="the report folder of another run")
        text = f"write the page of both runs into this file (default: {PAGE}, if they differ)"
        command.add_argument("--page", metavar="FILE", type=output_file, default="", help=text)
        command.add_argument("--no-page", action="store_true", help="write no page")
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Compare two runs' folders; exit code 1 when they are not the same."""
        folders = run_folder(arguments.first), run_folder(arguments.second)
        from harness.plugins.comparison.compare import compare
        from harness.plugins.comparison.html import comparison_page, distinct_parts
        from harness.plugins.comparison.lines import comparison_lines
        from harness.recording.read_run import read_run
        from harness.recording.stored_run import blames_changes
        from harness.reporting.terminal import Style

        first, second = (read_run(folder) for folder in folders)
        file = Path(arguments.page or PAGE)
        with blames_changes(folders[0], first), blames_changes(folders[1], second):
            comparison = compare(first, second)
            lines = list(comparison_lines(comparison, Style.of(sys.stdout)))
            is_good = comparison.is_same and not comparison.warnings
            has_page = not arguments.no_page and bool(
                arguments.page or not (is_good or arguments.json)
            )
            if has_page:
                names = distinct_parts(*folders)
                write_text(file, comparison_page(first, second, comparison, names))
        code = 0 if is_good else EXIT_CODES["failed"]
        if arguments.json:
            facts = {"exit_code": code, "comparison": comparison}
            say_json({"format": "armharness-comparison/1", **facts})
            return code
        for line in [*lines, *([f"page: {file}"] if has_page else [])]:
            say(line)
        return code
