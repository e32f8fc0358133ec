"""Arcs of a link in space, through a point or about a centre: the way of Pilz's CIRC."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray

LARGEST_RADIUS_DIFFERENCE = 1e-2
"""Of start and goal about a given centre [m]: Pilz's rule; the centre is moved by half of it."""

FLATTEST = 1e-5
"""Height of a triangle over its longest side below which its corners are on one line [m].

Pilz looks at twice the area instead, with 1e-5 m^2: the same for sides of a metre, but it refuses
small arcs, as a twelfth of a circle of 2 cm.
"""

_STRAIGHT_ANGLE = 1e-3  # [rad] nearer to half a circle about a centre, the plane is undefined


class Arc:
    """A link's way on a circle, the link turning at an even rate from its start to its end.

    Attributes:
        start: T_world_link at parameter 0.
        center: Of the circle, in the world [m].
        axis: Unit normal of its plane; the link goes round it to the left.
        sweep: Angle of the arc [rad], 0 to 2 pi.
        turn: Rotation vector of the link from 0 to 1, world axes [rad].
    """

    name = "arc"

    def __init__(
        self, link: str, start: SE3, end: SE3, center: FloatArray, axis: FloatArray, sweep: float
    ) -> None:
        self.link = link
        self.start = start
        self.center = np.asarray(center, dtype=float)
        self.axis = np.asarray(axis, dtype=float)
        self.sweep = sweep
        self.turn: FloatArray = pin.log3(end.rotation @ start.rotation.T)
        self._spoke = start.translation - self.center

    @classmethod
    def through(cls, link: str, start: SE3, interim: FloatArray, end: SE3) -> Arc:
        """The arc from one pose through a point to another pose.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, when the three points are on one line, or two of
                them are one.
        """
        first, last = start.translation, end.translation
        u, t = interim - first, last - first
        normal = np.cross(u, t)
        size = float(np.linalg.norm(normal))
        v = interim - last
        if size <= FLATTEST * _longest(u, v, t):
            raise _no_plane("start, interim point and goal are on one line")
        center = first + (u * (t @ t) * (u @ v) - t * (u @ u) * (t @ v)) * 0.5 / size**2
        axis = normal / size
        return cls(link, start, end, center, axis, _angle(first - center, last - center, axis))

    @classmethod
    def about(cls, link: str, start: SE3, center: FloatArray, end: SE3) -> Arc:
        """The shorter arc from one pose about a centre to another.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, when start and goal are not equally far from the
                centre, or opposite to each other, or one.
        """
        first, last = start.translation - center, end.translation - center
        radii = float(np.linalg.norm(first)), float(np.linalg.norm(last))
        if abs(radii[0] - radii[1]) > LARGEST_RADIUS_DIFFERENCE:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"no circle: the start is {1000 * radii[0]:.1f} mm from the centre, the goal "
                f"{1000 * radii[1]:.1f} mm",
                {"start_radius": radii[0], "goal_radius": radii[1]},
            )
        normal = np.cross(first, last)
        size = float(np.linalg.norm(normal))
        flattest = FLATTEST * _longest(first, last, last - first)
        if size <= max(flattest, _STRAIGHT_ANGLE * radii[0] * radii[1]):
            raise _no_plane(
                "start, centre and goal are on one line, so there is no shorter arc; "
                "give an `interim` point"
            )
        axis = normal / size
        center = _equidistant(center, start.translation, end.translation)
        first, last = start.translation - center, end.translation - center
        return cls(link, start, end, center, axis, _angle(first, last, axis))

    @property
    def radius(self) -> float:
        """Of the circle [m]."""
        return float(np.linalg.norm(self._spoke))

    @property
    def length(self) -> float:
        """Of the arc [m]."""
        return self.radius * self.sweep

    @property
    def angle(self) -> float:
        """Of the link's turn [rad]."""
        return float(np.linalg.norm(self.turn))

    def pose(self, parameter: float) -> SE3:
        """T_world_link at a parameter from 0 to 1."""
        place = self.center + pin.exp3(parameter * self.sweep * self.axis) @ self._spoke
        return SE3(pin.exp3(parameter * self.turn) @ self.start.rotation, place)

    def nearest(self, pose: SE3) -> tuple[float, float]:
        """The parameter at which the arc comes nearest to a pose's origin, and its distance [m]."""
        offset = pose.translation - self.center
        height = float(offset @ self.axis)
        level = offset - height * self.axis
        beyond = _angle(self._spoke, level, self.axis)
        if beyond > self.sweep + 0.5 * (2 * np.pi - self.sweep):
            beyond -= 2 * np.pi  # nearer to the start than to the end
        gap = float(np.hypot(height, np.linalg.norm(level) - self.radius))
        return beyond / self.sweep, gap


def _angle(first: FloatArray, second: FloatArray, axis: FloatArray) -> float:
    """How far to turn left about an axis from one spoke to another [rad], 0 to 2 pi."""
    angle = np.arctan2(float(np.cross(first, second) @ axis), float(first @ second))
    return float(angle % (2 * np.pi))


def _equidistant(center: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """The point nearest to a centre that is equally far from two points."""
    across = second - first
    return center - across * float((center - 0.5 * (first + second)) @ across) / float(
        across @ across
    )


def _longest(*sides: FloatArray) -> float:
    """Length of the longest of some ways [m]."""
    return max(float(np.linalg.norm(side)) for side in sides)


def _no_plane(why: str) -> PlanningFailed:
    return PlanningFailed("INVALID_MOTION_PLAN", f"no circle: {why}")
