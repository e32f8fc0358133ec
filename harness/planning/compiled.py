"""Whether edges are certified by compiled code: the extra `fast`, loaded when it pays."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Literal

PAYS_AFTER = 20_000
"""States checked without it before the compiled stage is loaded; half a second's worth at most.

Loading it takes half a second once it has been compiled, and several seconds the first time. Its
answers are the same, so that nothing but time depends on when it is loaded.
"""

When = Literal["always", "when it pays", "never"]

_when: When = "when it pays"
_states = 0


def use_compiled(when: When) -> None:
    """Choose for this process when the compiled stage is used; benchmarks and tests do."""
    global _when
    _when = when


def count_states(number: int) -> None:
    """Note states that were checked one by one."""
    global _states
    _states += number


def compiled_stage() -> Callable[..., Any] | None:
    """`edge_kernel.certify`, or None when it is not there or does not pay yet."""
    if _when == "never" or (_when == "when it pays" and _states < PAYS_AFTER):
        return None
    return _load()


@cache
def _load() -> Callable[..., Any] | None:
    try:
        from harness.planning.edge_kernel import certify
    except (ImportError, RuntimeError):  # not installed; nowhere to keep what is compiled
        return None
    return certify
