"""Array types shared by every layer."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]
Floats = tuple[float, ...]
Pair = tuple[str, str]  # the names of two bodies
