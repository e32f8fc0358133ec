"""The commands of `harness`, each a plug-in."""

from __future__ import annotations

import argparse
from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

from harness.cli.files import run_folder
from harness.cli.output import complain, say
from harness.core.registry import Plugin
from harness.suite.discovery import UsageError

__all__ = ["Command", "UsageError", "complain", "run_folder", "say"]
"""What a package needs to add a command of its own."""


SCENARIOS, RESULTS, SEARCHES = "scenarios", "results", "comparisons and searches"
EXCHANGE, SETUP, OTHERS = "robots and other programs", "this program", "other commands"
GROUPS = (SCENARIOS, RESULTS, SEARCHES, EXCHANGE, SETUP, OTHERS)
"""Titles of the groups of commands in `harness --help`, in this order."""


class Command(Plugin, ABC):
    """A command; the first line of its docstring, a sentence, is its text in `harness --help`.

    A command of a package is registered as a step is: its module is named in the entry-point group
    `harness.plugins`. It is imported whenever `harness` lists its commands, so that what takes time
    is imported where it is used.

    Attributes:
        group: The one of `GROUPS` that lists the command.
        writes_json_in_parts: Whether `--format json` prints case by case, so that the command
            itself keeps everything else from standard output.
        reads_geometry: Whether the command itself reads meshes or models, and needs a process of
            its own: a native library may crash on damaged ones.
        collects_garbage: Whether the command lives long enough for Python's garbage collector.
    """

    plugin_kind: ClassVar[str] = "command"
    group: ClassVar[str] = OTHERS
    writes_json_in_parts: ClassVar[bool] = False
    reads_geometry: ClassVar[bool] = False
    collects_garbage: ClassVar[bool] = False

    @classmethod
    def summary(cls) -> str:
        """The first line of the docstring."""
        return (cls.__doc__ or cls.name).strip().partition("\n")[0]

    @abstractmethod
    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the arguments of the command."""

    @abstractmethod
    def run(self, arguments: argparse.Namespace) -> int:
        """Run the command.

        Returns:
            The exit code: 0 passed, 1 failed, 2 invalid input, 3 error.

        Raises:
            HarnessError: What the user gave cannot be used; its text is printed, exit code 2.
        """


class Starter(Plugin, ABC):
    """Writes a folder from which another system runs this program."""

    plugin_kind: ClassVar[str] = "starter"

    @abstractmethod
    def write(self, folder: Path) -> list[str]:
        """Write the folder.

        Returns:
            Lines to print: what was written, and what to do with it.

        Raises:
            UsageError: The folder exists, or cannot be written.
        """
