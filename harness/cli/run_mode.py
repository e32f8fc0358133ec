"""Other ways in which `harness run` runs scenarios, each a plug-in."""

from __future__ import annotations

import argparse
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from harness.core.registry import Plugin
from harness.suite.hooks import NO_HOOKS, SuiteHooks


@dataclass(frozen=True)
class RunCall:
    """A call of `harness run`."""

    arguments: argparse.Namespace
    files: Sequence[Path]
    hooks: SuiteHooks = NO_HOOKS


RunFiles = Callable[[RunCall], int]  # the exit code


class RunMode(Plugin, ABC):
    """A way to run scenarios that options of `harness run` request."""

    plugin_kind: ClassVar[str] = "run_mode"

    @abstractmethod
    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of the mode to those of `harness run`."""

    @abstractmethod
    def run(self, run_files: RunFiles, call: RunCall) -> int:
        """Run scenarios in the way of this mode, or as without it where no option requests it.

        Args:
            run_files: Runs the files as `harness run` does without this mode.
            call: The call; a mode adds its own changes to the hooks of other modes.

        Returns:
            The exit code of the command.

        Raises:
            UsageError: Options of the mode contradict each other, or exclude other ones.
        """
