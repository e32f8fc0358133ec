"""Loads the compiled check of motions."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache

from harness.core.errors import HarnessError
from harness.planning.collision.native.sources import library_path

Certify = Callable[[int, int, int], int]
"""`certify` of certify.c: the address of `MotionArrays.table`, the first and the last state."""

BUILD = "harness/planning/collision/native/build.py"
"""The script that compiles it in a source tree."""

FULL = -(2**62)  # The result of `certify` when the memory for intervals is full


@cache
def certify() -> Certify:
    """Load the compiled check.

    Raises:
        HarnessError: This source tree was never compiled.
    """
    path = library_path()
    if not path.exists():
        raise HarnessError(
            "the check of motions is not compiled in this source tree: install the package "
            f"with pip, or run `python {BUILD}` there"
        )
    function = ctypes.CDLL(str(path)).certify
    function.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    function.restype = ctypes.c_int64
    return function
