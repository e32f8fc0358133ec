"""Loads the compiled check of motions when it pays off."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Literal

PAYS_AFTER = 20_000
"""States that are checked before the compiled check is loaded: at most half a second of work.

Loading takes half a second when it is compiled already, and several seconds the first time. The
results are the same, so only the computing time depends on when it is loaded.
"""

When = Literal["always", "when it pays", "never"]

_when: When = "when it pays"
_states = 0


def use_compiled(when: When) -> None:
    """Choose when this process uses the compiled check, for benchmarks and tests."""
    global _when
    _when = when


def compiled_check(states: int) -> Callable[..., Any] | None:
    """`edge_kernel.certify` for a number of states; None while loading it does not pay off."""
    global _states
    if _when == "never":
        return None
    if _when == "when it pays" and _states < PAYS_AFTER:
        _states += states
        return None
    return _load()


@cache
def _load() -> Callable[..., Any] | None:
    try:
        from harness.planning.collision.edge_kernel import certify
    except RuntimeError:  # no writable folder for the cache
        return None
    return certify
