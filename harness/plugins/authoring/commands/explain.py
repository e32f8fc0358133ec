"""`harness explain`."""

from __future__ import annotations

import argparse
from typing import ClassVar

from harness.cli.command import SCENARIOS, Command
from harness.cli.output import say_text
from harness.cli.shared_options import add_paths, add_seed
from harness.suite.discovery import discover


class ExplainCommand(Command):
    """Print the program that a scenario becomes."""

    name: ClassVar[str] = "explain"
    group: ClassVar[str] = SCENARIOS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness explain`."""
        add_paths(command)
        add_seed(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Print the program of each file."""
        files = discover(arguments.paths)
        from harness.plugins.authoring.explain import explain_file

        for file in files:
            overrides = dict(arguments.overrides)
            say_text(explain_file(file, overrides=overrides, seed=arguments.seed).rstrip())
        return 0
