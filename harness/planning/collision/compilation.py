"""Compiles the check of motions into machine code, which processes load from the user's cache.

numba takes about ten seconds for it, in another process or, where that pays at once, in this one.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import platform
import sys
import time
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from itertools import takewhile
from pathlib import Path
from typing import Any

from harness.core.user_cache import cache_folder, cached, is_writable, store

ARGUMENTS = 3
"""Number of arguments of the check, `certify` in `harness.planning.collision.kernel`."""

DELAY = 5.0
"""Time between the start of a compiler in the background and its work [s]."""

LOWEST_PRIORITY = 19

_SOURCES = Path(__file__).with_name("kernel")
_FOLDER = "machine_code"


@cache
def code_file() -> str:
    """The name of the stored code in the cache: everything that it depends on."""
    key = hashlib.sha256()
    for path in sorted(_SOURCES.glob("*.py")):
        key.update(path.read_bytes())
    made_by = version("numba"), version("llvmlite"), platform.machine(), *_processor()
    key.update(repr(made_by).encode())
    return f"{_FOLDER}/{key.hexdigest()}.bin"


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


def compile_check(*, waits: bool = True) -> bytes | None:
    """Compile and store the check, which one process does at a time.

    Args:
        waits: Whether to wait while another process compiles.

    Returns:
        The name of the function and its object file, with a zero byte between them; None where
        another process compiles.

    Raises:
        OSError: The cache is not writable.
    """
    path = cache_folder() / _FOLDER / "lock"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX if waits else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return None
        return cached(code_file()) or _compile()


def _compile() -> bytes:
    from llvmlite import binding as llvm

    from harness.planning.collision.kernel.certify import certify  # imports numba
    from harness.planning.collision.kernel.compiling import assembly

    name, text = assembly(certify, ARGUMENTS)
    code = name.encode() + b"\0" + target_machine().emit_object(llvm.parse_assembly(text))
    store(code_file(), code)
    return code


def compile_in_background() -> None:
    """Start a process that compiles and stores the check, unless another one does already.

    It begins a little later, when most commands have ended, has the lowest priority, and outlives
    this process. It is not waited for, not even by the reader of this process's output, and
    nothing but computing time depends on whether it succeeds.
    """
    if not is_writable():
        return
    command = [sys.executable, "-P", "-m", __name__, f"{DELAY:g}"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    streams = [(os.POSIX_SPAWN_OPEN, stream, os.devnull, os.O_RDWR, 0) for stream in range(3)]
    with suppress(OSError, NotImplementedError):
        os.posix_spawn(command[0], command, environment, file_actions=streams, setsid=True)


def target_machine() -> Any:
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


def _lower_priority() -> None:
    """Leave the processor to everybody else, also where Linux shares it between sessions."""
    os.nice(LOWEST_PRIORITY)
    with suppress(OSError):
        Path("/proc/self/autogroup").write_text(f"{LOWEST_PRIORITY}", encoding="ascii")


if __name__ == "__main__":
    _lower_priority()
    time.sleep(float(sys.argv[1]))
    compile_check(waits=False)
