"""Array types shared by every layer."""

from __future__ import annotations

from typing import Any

import numpy as np

# Not NumPy's NDArray, which is no class from NumPy 2.5 on: saved runs are read by these types.
FloatArray = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
IntArray = np.ndarray[tuple[Any, ...], np.dtype[np.int64]]
BoolArray = np.ndarray[tuple[Any, ...], np.dtype[np.bool_]]
Floats = tuple[float, ...]
Pair = tuple[str, str]  # the names of two bodies
