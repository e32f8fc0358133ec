"""Other ways in which `harness run` runs scenarios, each a plug-in."""

from __future__ import annotations

import argparse
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import ClassVar

from harness.core.registry import Plugin

RunFiles = Callable[[argparse.Namespace, Sequence[Path], str], int]
"""Runs scenario files as `harness run` does without a mode; the last argument is the Unix socket
to which cases send their poses, or empty."""


class RunMode(Plugin, ABC):
    """A way to run scenarios that options of `harness run` request."""

    plugin_kind: ClassVar[str] = "run_mode"

    @abstractmethod
    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of the mode to those of `harness run`."""

    @abstractmethod
    def is_requested(self, arguments: argparse.Namespace) -> bool:
        """Return whether the options request the mode.

        Raises:
            UsageError: Options of the mode contradict each other.
        """

    @abstractmethod
    def run(self, arguments: argparse.Namespace, files: Sequence[Path], run_files: RunFiles) -> int:
        """Run the scenarios and return the exit code."""
