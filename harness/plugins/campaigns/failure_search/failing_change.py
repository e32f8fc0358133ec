"""A change of a scenario with which it fails, as the page of a search shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from harness.reporting.suite.record import SuiteCase


@dataclass(frozen=True)
class FailingChange:
    """A change of a scenario with which it fails.

    Attributes:
        changes: Path, value in the file and value with which it fails, of each parameter, and where
            both stand in its range, from 0 to 1; None of words.
        cause: Why it fails, in a line.
        again: The command that shows it.
        replays: What each run is, and its case: the file as it is, and the changed one.
    """

    changes: Sequence[tuple[str, Any, Any, tuple[float, float] | None]]
    cause: str
    again: str
    runs: int
    replays: Sequence[tuple[str, SuiteCase]]
