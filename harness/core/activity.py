"""How far a long piece of work is, for whoever wants to show it."""

from __future__ import annotations

from collections.abc import Callable

Activity = Callable[[str, int, int], None]
"""Called with what is being done, how many parts of it are done, and how many there are.

The number of parts is 0 where it is not known.
"""


def unobserved(_what: str, _done: int, _total: int) -> None:
    """Take no notice."""
