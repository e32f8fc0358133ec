"""Smooth curves through dense samples of a path."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from harness.core.types import FloatArray
from harness.planning.timing.cubic_spline import CubicSpline

_NEAREST = 1e-7  # [rad] samples nearer than this to the previous one are left out


class JointSpline:
    """A twice differentiable curve through dense samples of a path without corners.

    Attributes:
        samples: The group positions on the curve, shape (K, dof).
        kept: Their indices among the given samples, shape (K,).
        knots: Their parameters, shape (K,), from 0 to `length` [rad].
        length: The length of the polyline through the samples [rad].
    """

    def __init__(self, samples: FloatArray) -> None:
        steps = np.linalg.norm(np.diff(samples, axis=0), axis=1)
        kept = np.concatenate([[True], steps > _NEAREST])
        self.kept = np.flatnonzero(kept)
        self.samples = samples[kept]
        steps = np.linalg.norm(np.diff(self.samples, axis=0), axis=1)
        self.knots: FloatArray = np.concatenate([[0.0], np.cumsum(steps)])
        self.length = float(self.knots[-1])

    @property
    def cubics(self) -> CubicSpline:
        """The curve, constant before its start and after its end."""
        return self._cubics

    @cached_property
    def _cubics(self) -> CubicSpline:
        if len(self.knots) < 2:
            raise ValueError("the curve has no length")
        return CubicSpline.through(self.knots, self.samples, ends=(0.0, self.length))

    def evaluate(self, parameter: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions and their first two derivatives, (M, dof) each, at parameters (M,)."""
        return self.cubics.evaluate(np.atleast_1d(np.asarray(parameter, dtype=float)))

    def grid(self, pieces: int = 2) -> FloatArray:
        """The knots, and evenly spaced points between them."""
        parts = np.linspace(0.0, 1.0, pieces, endpoint=False)
        inner = self.knots[:-1, None] + np.diff(self.knots)[:, None] * parts
        return np.append(inner.ravel(), self.length)
