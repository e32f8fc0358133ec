"""`harness merge`."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import ClassVar

from harness.cli.command import RESULTS, Command
from harness.cli.output import complain
from harness.cli.shared_options import add_format, add_history, add_report_dir
from harness.cli.suite_output import show_json, show_lines, show_results, write_suite_files
from harness.cli.work_bar import WorkBar
from harness.suite.hooks import SuiteHooks


class MergeCommand(Command):
    """Merge the parts of a suite that ran with --shard."""

    name: ClassVar[str] = "merge"
    group: ClassVar[str] = RESULTS
    writes_json_in_parts: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness merge`."""
        text = "a report folder of `harness run --shard`"
        command.add_argument("folders", metavar="DIR", nargs="+", help=text)
        add_report_dir(command, "write the results into this folder")
        add_history(command)
        add_format(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Merge the parts of a suite into one page, JUnit file and results."""
        from harness.plugins.campaigns.conditions import write_results
        from harness.plugins.campaigns.merge import merge_parts

        start = time.monotonic()
        suite, record = merge_parts(
            [Path(each) for each in arguments.folders], Path(arguments.report_dir), WorkBar()
        )
        selection = record.selection
        options = argparse.Namespace(
            **vars(arguments),
            repeat=1,
            no_report=False,
            bag=False,
            package_folders=(),
            plugins=(),
            **vars(selection)
            | {
                "nodes": [f"{name}={command}" for name, command in selection.nodes.items()],
                "overrides": list(selection.overrides.items()),
            },
        )
        hooks = SuiteHooks(write=write_results, writes_single_case=True)
        page, columns = write_suite_files(options, suite, hooks)
        if arguments.format == "json":
            show_json(suite)
        elif arguments.format == "full":
            show_results(options, suite, time.monotonic() - start, page, columns)
        else:
            show_lines(options, suite)
        for line in suite.missing_parts:
            complain(f"incomplete: {line}")
        return suite.exit_code
