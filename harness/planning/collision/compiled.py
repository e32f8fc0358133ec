"""Loads the compiled check of motions, as machine code of an earlier process.

It is linked in a millisecond, or by LLVM in a tenth of a second where it has to be.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Literal

from harness.core.user_cache import cached, is_writable
from harness.planning.collision.compilation import (
    ARGUMENTS,
    code_file,
    compile_check,
    compile_in_background,
    target_machine,
)
from harness.planning.collision.object_file import CannotLinkError, LinkedObject

COMPILING_PAYS_LATER, COMPILING_PAYS_NOW = 10_000, 100_000
"""States that a process checks, where no earlier one compiled, before it has the check compiled in
the background for later ones, and before it waits for that or does it itself."""

When = Literal["always", "when it pays", "never"]
Certify = Callable[[int, int, int], int]
"""The type of `certify` in `harness.planning.collision.kernel`."""

_LOOK_EVERY = 1000  # states between two looks for machine code that another process makes

_when: When = "when it pays"
_states, _next_look = 0, 0
_check: Certify | None = None


def use_compiled(when: When) -> None:
    """Choose when this process uses the compiled check, for benchmarks and tests."""
    global _when
    _when = when


def compiled_check(states: int) -> Certify | None:
    """The compiled `certify` for a number of states; None while compiling it does not pay off.

    The results are the same, so only the computing time depends on when it is there.
    """
    global _check, _next_look, _states
    if _when == "never":
        return None
    if _check is None and (_when == "always" or _states >= _next_look):
        _check, _next_look = _loaded(), _states + _LOOK_EVERY
    if _check is None:
        if _states < COMPILING_PAYS_LATER <= _states + states:
            compile_in_background()
        _states += states
    return _check


def _loaded() -> Certify | None:
    """The check, if it is stored or it pays to compile it now, and it can be stored."""
    code = cached(code_file())
    pays = _when == "always" or _states >= COMPILING_PAYS_NOW
    if code is None and pays and is_writable():
        with suppress(OSError):  # the disk is full, or knows no locks
            code = compile_check()
    if code is None:
        return None
    name, _, instructions = code.partition(b"\0")
    return _linked(instructions, name.decode())


def _linked(code: bytes, name: str) -> Certify:
    """The function of an object file, callable from Python."""
    holder, address = _placed(code, name)
    result, numbers = ctypes.c_int64(), [ctypes.c_int64] * ARGUMENTS
    kind = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, *numbers)
    function = kind(address)

    def certify(table: int, low: int, high: int) -> int:
        status = function(ctypes.addressof(result), None, table, low, high)
        assert status == 0, holder  # whose memory holds the code
        return result.value

    return certify


def _placed(code: bytes, name: str) -> tuple[object, int]:
    """The memory with the code of an object file, and the address of its function."""
    try:
        linked = LinkedObject(code)
        return linked, linked.address(name)
    except (CannotLinkError, OSError):
        from llvmlite import binding as llvm

        engine: Any = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target_machine())
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return engine, engine.get_function_address(name)
