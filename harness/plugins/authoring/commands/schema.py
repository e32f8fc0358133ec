"""`harness schema`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import output_file
from harness.cli.command import SETUP, Command
from harness.cli.files import refusing_unwritable
from harness.cli.output import output, say
from harness.cli.shared_options import add_plugin
from harness.core.files import write_whole


class SchemaCommand(Command):
    """Print the JSON Schema of scenario files."""

    name: ClassVar[str] = "schema"
    group: ClassVar[str] = SETUP

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness schema`."""
        text = "write the schema to this file instead of standard output"
        command.add_argument("--write", metavar="FILE", type=output_file, help=text)
        add_plugin(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Print the JSON Schema of scenario files, or write it."""
        file = arguments.write
        if file is None:
            output().document(self.text())
            return 0
        with refusing_unwritable():
            write_whole(Path(file), self.text())
        say(f"wrote {file}; the first line of a scenario can name it:")
        say(f"# yaml-language-server: $schema={file}")
        return 0

    def text(self) -> str:
        """The schema, as JSON."""
        from harness.plugins.authoring.scenario_schema import schema_text

        return schema_text()
