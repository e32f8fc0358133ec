"""`harness compare`: what changed from one saved run to another."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from harness.cli.output import guarded, only_json_on_stdout, say
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES


def run(arguments: argparse.Namespace) -> int:
    """Compare two runs' folders; exit code 1 when they are not the same."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    folders = [Path(arguments.first), Path(arguments.second)]
    for folder in folders:
        if not (folder / "run.json").is_file():
            raise UsageError(f"'{folder}' is no run's folder: it has no run.json")
    from harness.recording.compare import compare
    from harness.recording.store import blames_changes, read_run
    from harness.reporting.comparison import comparison_lines
    from harness.reporting.terminal import Style

    first, second = (read_run(folder) for folder in folders)
    with blames_changes(folders[0], first), blames_changes(folders[1], second):
        comparison = compare(first, second)
        lines = list(comparison_lines(comparison, Style.of(sys.stdout)))
    is_good = comparison.is_same and not comparison.warnings
    code = 0 if is_good else EXIT_CODES["failed"]
    if arguments.json:
        with only_json_on_stdout() as write_json:
            write_json(
                {"format": "armharness-comparison/1", "exit_code": code, "comparison": comparison}
            )
        return code
    for line in lines:
        say(line)
    return code
