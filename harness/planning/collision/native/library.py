"""Loads the compiled check of motions."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

from harness.planning.collision.native.sources import library_path

Certify = Callable[[int, int, int], int]
"""`certify` of certify.c: the address of `MotionArrays.table`, the first and the last state."""

BUILD = "harness/planning/collision/native/build.py"
"""The script that compiles it in a source tree."""

FULL = -(2**62)  # The result of `certify` when the memory for intervals is full


def _loaded() -> Certify | None:
    """The compiled check; None in a source tree in which it was not compiled."""
    try:
        function = ctypes.CDLL(str(library_path())).certify
    except OSError:
        return None
    function.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    function.restype = ctypes.c_int64
    return function


certify = _loaded()
