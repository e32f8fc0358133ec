"""The section `failing_changes`."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any, ClassVar

from harness.reporting.suite.columns import Columns
from harness.reporting.suite.failure_picture import deciding_picture
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.section import SuiteSection

WIDTH = 480  # [pixels], of the picture of a replay


class FailingChanges(SuiteSection):
    """What a search found, each with the replays of the file as it is and of the changed one."""

    name: ClassVar[str] = "failing_changes"

    def content(self, record: SuiteRecord, columns: Columns, folder: Path) -> Any:
        del columns
        return [
            (each, [_replay(name, case, folder) for name, case in each.replays])
            for each in record.failing_changes
        ]


def _replay(name: str, case: SuiteCase, folder: Path) -> dict[str, str]:
    """A run next to another one: its name, its page at the deciding moment, and a picture."""
    link, picture = case.address(folder), deciding_picture(case.result, WIDTH) or b""
    shown = {"link": link, "picture": base64.b64encode(picture).decode()}
    return {"name": name, "outcome": case.result.outcome, **shown}
