"""What runs a case that needs more than physics, each a plug-in."""

from __future__ import annotations

import argparse
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

from harness.core.registry import Plugin, registry
from harness.suite.discovery import UsageError

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.session.progress import Notify
    from harness.session.run_request import RunRequest


class CaseRunner(Plugin, ABC):
    """Runs a case in the process that is made for it."""

    plugin_kind: ClassVar[str] = "case_runner"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of a command that lets this plug-in run its case."""

    def run_command(self, arguments: argparse.Namespace, timeout: float) -> CaseResult:
        """Run the case of a command that has the options of this plug-in.

        Args:
            arguments: The options, `scenario`, `overrides` and those of `add_report_options`.
            timeout: Simulated time of a scenario in which no step ends by itself [s].

        Raises:
            UsageError: The plug-in runs no case of a command.
        """
        del arguments, timeout
        raise UsageError(f"the case runner `{self.name}` runs no case of a command")

    @abstractmethod
    def run(self, request: RunRequest, notify: Notify) -> CaseResult:
        """Run the case and report its progress."""


def case_runner(name: str) -> CaseRunner:
    """Find a runner.

    Raises:
        UsageError: No plug-in of this installation provides it.
    """
    try:
        return registry("case_runner").find(name)()
    except LookupError as error:
        raise UsageError(str(error.args[0])) from None
