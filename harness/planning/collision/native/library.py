"""Loads the compiled check and timing of motions."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from harness.core.errors import HarnessError
from harness.core.types import FloatArray
from harness.planning.collision.native.sources import library_path

Certify = Callable[[int, int, int], int]
"""`certify` of certify.c: the address of `MotionArrays.table`, the first and the last state."""

BUILD = "harness/planning/collision/native/build.py"
"""The script that compiles it in a source tree."""

FULL = -(2**62)  # The result of `certify` when the memory for intervals is full


@cache
def library() -> ctypes.CDLL:
    """Load what was compiled.

    Raises:
        HarnessError: This source tree was never compiled.
    """
    path = library_path()
    if not path.exists():
        raise HarnessError(
            "the check of motions is not compiled in this source tree: install the package "
            f"with pip, or run `python {BUILD}` there"
        )
    return ctypes.CDLL(str(path))


def call(name: str, arrays: Sequence[FloatArray], found: FloatArray) -> FloatArray:
    """Call a function of timing.c or efforts.c, and return the last array, into which it writes."""
    every = [*map(np.ascontiguousarray, arrays), found]
    rows = ((address_of(each), *each.shape, 1, 1)[:4] for each in every)
    table = np.fromiter(chain.from_iterable(rows), np.int64)
    library()[name](ctypes.c_void_p(address_of(table)))
    return found


def address_of(array: np.ndarray[Any, Any]) -> int:
    """The address of an array's first item; the first way takes a third of the time."""
    if array.flags.writeable and array.size:
        return ctypes.addressof(ctypes.c_char.from_buffer(array.data))
    return array.__array_interface__["data"][0]


@cache
def certify() -> Certify:
    """The compiled check."""
    function = library().certify
    function.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    function.restype = ctypes.c_int64
    return function
