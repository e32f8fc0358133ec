"""`harness mcp`: scenarios for assistants that speak the Model Context Protocol."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.command import SETUP, Command, UsageError
from harness.core.extras import install_command


class McpCommand(Command):
    """Serve this folder's scenarios to an assistant, by the Model Context Protocol.

    The assistant's program starts the command and speaks through standard input and output.
    """

    name: ClassVar[str] = "mcp"
    group: ClassVar[str] = SETUP

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness mcp`."""
        text = "the folder whose files may be read, written and run (default: the current one)"
        command.add_argument("--root", metavar="DIR", default=".", help=text)

    def run(self, arguments: argparse.Namespace) -> int:
        """Serve until the client closes standard input."""
        root = Path(arguments.root)
        if not root.is_dir():
            raise UsageError(f"--root: '{root}' is not a folder")
        try:
            from harness.plugins.mcp.server import server_of
        except ImportError as error:
            command = install_command("mcp")
            raise UsageError(
                f"the server needs packages that are not installed: {command} ({error})"
            ) from error
        from harness.plugins.mcp.workspace import Workspace

        server_of(Workspace(root.resolve())).run("stdio")
        return 0
