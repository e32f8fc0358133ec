"""Selects the compiled edge checks of the extra `fast`; they are loaded when it pays off."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Literal

PAYS_AFTER = 20_000
"""States that are checked before the compiled stage is loaded: at most half a second of work.

Loading takes half a second when it is compiled already, and several seconds the first time. The
results are the same, so only the computing time depends on when it is loaded.
"""

When = Literal["always", "when it pays", "never"]

_when: When = "when it pays"
_states = 0


def use_compiled(when: When) -> None:
    """Choose when this process uses the compiled stage, for benchmarks and tests."""
    global _when
    _when = when


def count_states(number: int) -> None:
    """Count states that are checked without the compiled stage."""
    global _states
    _states += number


def compiled_stage() -> Callable[..., Any] | None:
    """`edge_kernel.certify`, or None when it is not installed or does not pay off yet."""
    if _when == "never" or (_when == "when it pays" and _states < PAYS_AFTER):
        return None
    return _load()


@cache
def _load() -> Callable[..., Any] | None:
    try:
        from harness.planning.collision.edge_kernel import certify
    except (ImportError, RuntimeError):  # not installed; no writable cache folder
        return None
    return certify
