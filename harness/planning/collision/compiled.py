"""Loads the compiled check of motions, as machine code of an earlier process.

numba compiles the check once, which takes about ten seconds. Its machine code is kept in the user's
cache directory and linked in a millisecond, or by LLVM in a tenth of a second where it has to be.
"""

from __future__ import annotations

import ctypes
import hashlib
import platform
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from itertools import takewhile
from pathlib import Path
from typing import Any, Literal

from harness.core.user_cache import cached, is_writable, store
from harness.planning.collision.object_file import CannotLinkError, LinkedObject

COMPILING_PAYS_AFTER = 100_000
"""States that a process checks before it compiles the check, where no earlier process did."""

When = Literal["always", "when it pays", "never"]
Certify = Callable[[int, int, int], int]
"""The type of `certify` in `harness.planning.collision.kernel`."""

_SOURCES = Path(__file__).with_name("kernel")
_ARGUMENTS = 3

_when: When = "when it pays"
_states = 0


def use_compiled(when: When) -> None:
    """Choose when this process uses the compiled check, for benchmarks and tests."""
    global _when
    _when = when


def compiled_check(states: int) -> Certify | None:
    """The compiled `certify` for a number of states; None while compiling it does not pay off.

    The results are the same, so only the computing time depends on when it is loaded.
    """
    global _states
    if _when == "never":
        return None
    if _when == "when it pays" and _states < COMPILING_PAYS_AFTER:
        _states += states
        if _states < COMPILING_PAYS_AFTER and _stored() is None:
            return None
    return _loaded()


@cache
def _stored() -> bytes | None:
    """The code that an earlier process compiled; None where there is none."""
    return cached(code_file())


@cache
def _loaded() -> Certify | None:
    """The check; None where it would have to be compiled and cannot be stored."""
    stored = _stored()
    if stored is None:
        if not is_writable():
            return None
        stored = _compile()
        store(code_file(), stored)
    name, _, code = stored.partition(b"\0")
    return _linked(code, name.decode())


@cache
def code_file() -> str:
    """The name of the stored code: everything that it depends on."""
    key = hashlib.sha256()
    for path in sorted(_SOURCES.glob("*.py")):
        key.update(path.read_bytes())
    made_by = version("numba"), version("llvmlite"), platform.machine(), *_processor()
    key.update(repr(made_by).encode())
    return f"machine_code/{key.hexdigest()}.bin"


def _processor() -> tuple[str, ...]:
    """What the machine code may use of this processor."""
    try:
        with Path("/proc/cpuinfo").open() as lines:
            described = list(takewhile(str.strip, lines))  # the first core
    except OSError:
        from llvmlite import binding as llvm

        return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    names = ("model name", "flags", "CPU implementer", "CPU part", "Features")
    return tuple(line for line in described if line.partition(":")[0].strip() in names)


def _compile() -> bytes:
    """The name of the function and its object file, with a zero byte between them."""
    from llvmlite import binding as llvm

    from harness.planning.collision.kernel.certify import certify  # imports numba
    from harness.planning.collision.kernel.compiling import assembly

    name, text = assembly(certify, _ARGUMENTS)
    return name.encode() + b"\0" + _machine().emit_object(llvm.parse_assembly(text))


def _linked(code: bytes, name: str) -> Certify:
    """The function of an object file, callable from Python."""
    holder, address = _placed(code, name)
    result, numbers = ctypes.c_int64(), [ctypes.c_int64] * _ARGUMENTS
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

        engine: Any = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return engine, engine.get_function_address(name)


def _machine() -> Any:
    """The processor of this machine as LLVM's target."""
    from llvmlite import binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="default",
        codemodel="jitdefault",
        jit=True,
    )
