"""The exit code of a suite's results."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.recording.run import Outcome

EXIT_CODES: dict[Outcome, int] = {"passed": 0, "failed": 1, "invalid": 2, "error": 3}
USAGE_EXIT_CODE = 2  # as argparse's
INTERRUPTED_EXIT_CODE = 130  # 128 and SIGINT, as shells have it


def exit_code(outcomes: Iterable[Outcome]) -> int:
    """The gravest outcome's code; 0 when there is none."""
    return max((EXIT_CODES[outcome] for outcome in outcomes), default=0)
