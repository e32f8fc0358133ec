"""Loads the compiled check of motions when it pays off."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Literal

PAYS_AFTER = 20_000
"""States that are checked before the compiled check is loaded: at most half a second of work, which
is what loading takes."""

COMPILING_PAYS_AFTER = 100_000
"""The same where nothing is compiled yet, which takes about ten seconds, once."""

When = Literal["always", "when it pays", "never"]

_when: When = "when it pays"
_states = 0
_enough = PAYS_AFTER


def use_compiled(when: When) -> None:
    """Choose when this process uses the compiled check, for benchmarks and tests."""
    global _when
    _when = when


def compiled_check(states: int) -> Callable[..., Any] | None:
    """`edge_kernel.certify` for a number of states; None while loading it does not pay off.

    The results are the same, so only the computing time depends on when it is loaded.
    """
    global _states, _enough
    if _when == "never":
        return None
    if _when == "when it pays" and _states < COMPILING_PAYS_AFTER:
        _states += states
        if _states >= _enough == PAYS_AFTER and not _is_compiled():
            _enough = COMPILING_PAYS_AFTER
        if _states < _enough:
            return None
    return _load()


@cache
def _load() -> Callable[..., Any] | None:
    try:
        from harness.planning.collision.edge_kernel import certify
    except RuntimeError:  # no writable folder for the cache
        return None
    return certify


def _is_compiled() -> bool:
    """Whether a process has compiled the check before."""
    certify: Any = _load()
    if certify is None:
        return False
    folder = Path(certify._cache.cache_path)  # noqa: SLF001 (numba offers no public way)
    return any(folder.glob("edge_kernel.certify-*.nbi"))
