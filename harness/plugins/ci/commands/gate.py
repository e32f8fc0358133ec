"""`harness gate`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.command import RESULTS, Command, UsageError


class GateCommand(Command):
    """Compare margins of results with a baseline, and write what pipelines show."""

    name: ClassVar[str] = "gate"
    group: ClassVar[str] = RESULTS

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness gate`."""
        from harness.plugins.ci.gate import add_gate_options

        text = "the report folder of `harness run` or `harness merge`"
        command.add_argument("folder", metavar="DIR", help=text)
        add_gate_options(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Compare and write; 1 when a margin shrank."""
        from harness.plugins.ci.gate import gate, is_requested

        if not is_requested(arguments):
            raise UsageError("nothing to do: name --baseline, --ctrf or --comment")
        return gate(arguments, Path(arguments.folder))
