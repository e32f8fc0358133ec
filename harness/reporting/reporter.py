"""What writes a file into the folder of a finished case, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from harness.core.activity import Activity, unobserved
from harness.core.errors import HarnessError
from harness.core.registry import Plugin, described, raised, registry
from harness.recording.stored_run import StoredRun


class Reporter(Plugin, ABC):
    """A reporter, selected by `harness run --reporter NAME`.

    A reporter reads the finished run, its verdicts and its outcome, and changes none of them.
    """

    plugin_kind: ClassVar[str] = "reporter"

    @abstractmethod
    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write files into a case's report folder, which has `run.json` already.

        Args:
            folder: The folder, under the temporary name that it has until it is complete.
        """


def write_with(
    names: Sequence[str], folder: Path, stored: StoredRun, activity: Activity = unobserved
) -> None:
    """Let reporters write into a folder.

    Raises:
        HarnessError: There is no such reporter, or one fails; names it and its package.
    """
    reporters = registry(Reporter.plugin_kind)
    for name in names:
        activity(f"writing the report `{name}`", 0, 0)
        reporter: type[Reporter] = reporters[name]
        try:
            reporter().write(folder, stored)
        except HarnessError:
            raise
        except Exception as error:
            who = described(Reporter.plugin_kind, name)
            raise HarnessError(f"{who} raised {raised(error)}") from error
