"""Progress reports of long operations."""

from __future__ import annotations

from collections.abc import Callable

Activity = Callable[[str, int, int], None]
"""A progress callback: the name of the operation, the number of finished parts, their total.

The total is 0 when it is unknown.
"""


def unobserved(_what: str, _done: int, _total: int) -> None:
    """Ignore the progress report."""
