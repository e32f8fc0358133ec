"""Piecewise cubic curves in joint space; SciPy's splines take a second of imports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.native.library import call

_UNTIMED = np.zeros(2), np.zeros(2), np.ones(2), np.zeros(1)  # the time is the parameter


@dataclass(frozen=True, eq=False)
class PiecewiseCubic:
    """Cubics of a parameter, one after the other.

    Attributes:
        begins: The parameters at which the pieces begin and the last one ends, shape (K + 1,).
        origins: A piece is a cubic of the parameter minus the first plus the second, shape (K, 2).
        coefficients: Those of the powers 3, 2, 1, 0 on every piece, shape (K, dof) each.
        domain: The least and the largest parameter, and how near below a piece belongs to it.
    """

    begins: FloatArray
    origins: FloatArray
    coefficients: tuple[FloatArray, FloatArray, FloatArray, FloatArray]
    domain: tuple[float, float, float] = (-np.inf, np.inf, 0.0)

    def evaluate(self, parameter: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Values and their first two derivatives, (M, dof) each, at parameters (M,)."""
        return self.timed(parameter, _UNTIMED)

    def timed(
        self, times: FloatArray, steps: tuple[FloatArray, FloatArray, FloatArray, FloatArray]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, velocities and accelerations, (M, dof) each, at times (M,).

        Args:
            times: The times, not negative.
            steps: The time, the parameter and its rate at which each step begins, at which the last
                one may end, and the change of the rate during each step.
        """
        found = np.empty((3, len(times), self.coefficients[0].shape[1]))
        path = self.begins, self.origins, *self.coefficients, np.array(self.domain)
        positions, velocities, accelerations = call("timed_states", (times, *steps, *path), found)
        return positions, velocities, accelerations


class CubicSpline(PiecewiseCubic):
    """A twice differentiable piecewise cubic with not-a-knot ends, equal to SciPy's to the bit."""

    @classmethod
    def through(
        cls,
        knots: FloatArray,
        samples: FloatArray,
        *,
        ends: tuple[float, float] = (-np.inf, np.inf),
    ) -> CubicSpline:
        """The spline through samples (N, dof) at their parameters (N,), N > 1.

        References:
            C. de Boor, "A Practical Guide to Splines", Springer, 1978, chapter IV.
        """
        width = np.diff(knots)[:, None]
        secant = np.diff(samples, axis=0) / width
        slope = _slopes(width, secant)
        bend = (slope[:-1] + slope[1:] - 2 * secant) / width
        cubic, square = bend / width, (secant - slope[:-1]) / width - bend
        origins = np.column_stack([knots[:-1], np.zeros(len(width))])
        return cls(knots, origins, (cubic, square, slope[:-1], samples[:-1]), (*ends, 0.0))

    @classmethod
    def even(cls, samples: FloatArray) -> CubicSpline:
        """The spline through samples (N, dof) at even parameters from 0 to 1."""
        return cls.through(np.linspace(0.0, 1.0, len(samples)), samples)


def _slopes(width: FloatArray, secant: FloatArray) -> FloatArray:
    """First derivatives at the knots, (N, dof); `width` is (N - 1, 1)."""
    count = len(width) + 1
    if count == 2:
        return np.repeat(secant, 2, axis=0)
    if count == 3:  # a parabola: both ends state the same condition
        middle = (width[1] * secant[0] + width[0] * secant[1]) / (width[0] + width[1])
        return np.array([2 * secant[0] - middle, middle, 2 * secant[1] - middle])
    h = width[:, 0]
    first, last = h[0] + h[1], h[-2] + h[-1]
    lower, diagonal = np.append(h[1:], last), np.empty(count)
    upper = np.insert(h[:-1], 0, first)
    diagonal[1:-1] = 2 * (h[:-1] + h[1:])
    diagonal[0], diagonal[-1] = h[1], h[-2]
    right = np.empty((count, secant.shape[1]))
    right[0] = ((h[0] + 2 * first) * h[1] * secant[0] + h[0] ** 2 * secant[1]) / first
    right[1:-1] = 3 * (width[1:] * secant[:-1] + width[:-1] * secant[1:])
    right[-1] = (h[-1] ** 2 * secant[-2] + (2 * last + h[-1]) * h[-2] * secant[-1]) / last
    return _solved(lower.tolist(), diagonal.tolist(), upper.tolist(), list(right))


def _solved(
    lower: list[float], diagonal: list[float], upper: list[float], right: list[FloatArray]
) -> FloatArray:
    """Solve a tridiagonal system by elimination with partial pivoting, as LAPACK's `gtsv` does."""
    last = len(diagonal) - 1
    second = [0.0] * last  # the diagonal above `upper`, which exchanged rows fill
    for i in range(last):
        if abs(diagonal[i]) >= abs(lower[i]):
            factor = lower[i] / diagonal[i]
            diagonal[i + 1] -= factor * upper[i]
            right[i + 1] = right[i + 1] - factor * right[i]
            continue
        factor = diagonal[i] / lower[i]
        diagonal[i], upper[i], below = lower[i], diagonal[i + 1], upper[i]
        diagonal[i + 1] = below - factor * upper[i]
        right[i], right[i + 1] = right[i + 1], right[i] - factor * right[i + 1]
        if i + 1 < last:
            second[i], upper[i + 1] = upper[i + 1], -factor * upper[i + 1]
    right[last] = right[last] / diagonal[last]
    right[last - 1] = (right[last - 1] - upper[last - 1] * right[last]) / diagonal[last - 1]
    for i in range(last - 2, -1, -1):
        known = right[i] - upper[i] * right[i + 1] - second[i] * right[i + 2]
        right[i] = known / diagonal[i]
    return np.array(right)
