"""Memory that is not used any more."""

from __future__ import annotations

import ctypes
import gc


def free_memory() -> None:
    """Give the memory of objects that nothing refers to back to the system.

    The collector is needed where objects refer to each other, and the C library keeps what was
    freed in pieces; where it has no function that returns them, they stay.
    """
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
