"""`harness run` with `--baseline`, `--ctrf` and `--comment`."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from harness.cli.run_mode import RunCall, RunFiles, RunMode
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES


class PipelineMode(RunMode):
    """Compare the margins of a run with a baseline, and write what pipelines show."""

    name: ClassVar[str] = "pipeline"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add `--baseline`, `--ctrf`, `--comment` and what belongs to them."""
        from harness.plugins.ci.gate import add_gate_options

        add_gate_options(command)

    def run(self, run_files: RunFiles, call: RunCall) -> int:
        """Run scenarios; a margin that shrank fails a suite whose cases pass."""
        from harness.plugins.ci.gate import gate, is_requested

        arguments, hooks = call.arguments, call.hooks
        if not is_requested(arguments):
            return run_files(call)
        for option in ("no_report", "shard"):
            if getattr(arguments, option, False):
                name = f"--{option.replace('_', '-')}"
                raise UsageError(
                    f"--baseline, --ctrf and --comment need the report of the whole suite, without"
                    f" {name}; `harness gate DIR` has the same options for a merged suite"
                )
        if arguments.repeat > 1:
            raise UsageError("--repeat compares runs of a case; leave it out with --baseline")
        code = run_files(replace(call, hooks=replace(hooks, writes_single_case=True)))
        if code > max(EXIT_CODES.values()):
            return code  # interrupted
        return max(code, gate(arguments, Path(arguments.report_dir)))
