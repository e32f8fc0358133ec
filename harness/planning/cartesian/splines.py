"""Cubic splines through joint positions, with their derivatives."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.planning.timing.profiles import Curve


def uniform_spline(values: FloatArray) -> Curve:
    """Cubic spline through rows (K, dof) at even parameters from 0 to 1, with two derivatives.

    Slopes at the ends are the cubic's through the four outermost rows.
    """
    count = len(values) - 1
    h = 1.0 / count
    ends = np.array([-11.0, 18.0, -9.0, 2.0]) / (6 * h)
    matrix = np.zeros((count + 1, count + 1))
    right = np.zeros_like(values)
    matrix[0, 0] = matrix[-1, -1] = 1.0
    right[0], right[-1] = ends @ values[:4], -ends @ values[:-5:-1]
    inner = np.arange(1, count)
    matrix[inner, inner - 1] = matrix[inner, inner + 1] = 1.0
    matrix[inner, inner] = 4.0
    right[1:-1] = 3 * (values[2:] - values[:-2]) / h
    slopes = np.linalg.solve(matrix, right)

    def spline(parameters: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        s = np.clip(parameters, 0.0, 1.0)
        piece = np.minimum((s / h).astype(int), count - 1)
        u = (s / h - piece)[:, None]
        p0, p1 = values[piece], values[piece + 1]
        m0, m1 = h * slopes[piece], h * slopes[piece + 1]
        a, b = 2 * p0 - 2 * p1 + m0 + m1, -3 * p0 + 3 * p1 - 2 * m0 - m1
        return (
            ((a * u + b) * u + m0) * u + p0,
            ((3 * a * u + 2 * b) * u + m0) / h,
            (6 * a * u + 2 * b) / h**2,
        )

    return spline
