"""Memory of this process: what is not used any more, and a limit on what is added."""

from __future__ import annotations

import ctypes
import gc
import resource
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path


def free_memory() -> None:
    """Give the memory of objects that nothing refers to back to the system.

    The collector is needed where objects refer to each other; it looks at all that there are.
    """
    gc.collect()
    return_memory()


def return_memory() -> None:
    """Give what was freed back to the system.

    The C library keeps it in pieces; where it has no function that returns them, they stay.
    """
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)


@contextmanager
def limited_memory(added: int) -> Generator[None]:
    """Let what runs inside add at most some address space to this process, where that is possible.

    Only Linux says how much is used and keeps such a limit; elsewhere there is none.

    Args:
        added: The most that may be added [bytes].

    Raises:
        MemoryError: More was required.
    """
    if sys.platform != "linux":
        yield
        return
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    before = resource.getrlimit(resource.RLIMIT_AS)
    most = pages * resource.getpagesize() + added
    if before[0] != resource.RLIM_INFINITY:
        most = min(most, before[0])
    resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
