"""Arcs of a link in space, through a point or about a centre: the path of Pilz's CIRC."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar, Literal

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.cartesian.linear_path import LinkPath
from harness.ports.goals import PoseGoal
from harness.ports.motions import ArcPoint
from harness.recording.motion_failures import AdvisedFailure


@dataclass(frozen=True)
class CircleFailure(AdvisedFailure):
    """Three points that define no arc.

    Attributes:
        reason: Start and goal are one point; two others of the points are one, or all three are on
            one line; the distances of start and goal from the centre differ.
        start_radius: The start's distance from the centre [m].
        goal_radius: The goal's distance from the centre [m].
    """

    reason: Literal["whole turn", "one line", "radii"]
    start_radius: float | None = None
    goal_radius: float | None = None

    @property
    def advice(self) -> str:
        """Points that define an arc."""
        match self.reason:
            case "whole turn":
                return (
                    "leave the step out where the arm is to stay; for a whole turn write two "
                    "`circ`, the first of them to the opposite point of the circle"
                )
            case "one line":
                return "give an `interim` point off the line, or use `lin` for a straight motion"
            case "radii":
                return (
                    "choose a `center` that is as far from the start as from the goal, or give an "
                    "`interim` point instead"
                )


LARGEST_RADIUS_DIFFERENCE = 1e-2
"""Largest difference of the radii of start and goal [m], as in Pilz; the centre is corrected."""

FLATTEST = 1e-5
"""Height of a triangle over its longest side below which its corners are collinear [m].

Pilz compares twice the area with 1e-5 m^2: the same for sides of a metre, but it rejects small
arcs, such as a twelfth of a circle of 2 cm.
"""

_STRAIGHT_ANGLE = 1e-3  # [rad] nearer to half a circle about a centre, the plane is undefined


class CircularPath(LinkPath):
    """A link's path on a circle.

    Attributes:
        center: The circle's centre in the world [m].
        axis: The unit normal of its plane; the link moves counterclockwise about it.
        sweep: The angle of the arc [rad], 0 to 2 pi.
    """

    name: ClassVar[str] = "arc"

    def __init__(
        self, link: str, start: SE3, end: SE3, center: FloatArray, axis: FloatArray, sweep: float
    ) -> None:
        self.center = np.asarray(center, dtype=float)
        self.axis = np.asarray(axis, dtype=float)
        self.sweep = sweep
        self._spoke = start.translation - self.center
        radius = float(np.linalg.norm(self._spoke))
        turn: FloatArray = pin.log3(end.rotation @ start.rotation.T)
        super().__init__(link, start, turn, radius * sweep, radius)

    @classmethod
    def through(cls, link: str, start: SE3, interim: FloatArray, end: SE3) -> CircularPath:
        """Create the arc from one pose through a point to another pose.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, when the points are collinear or two coincide.
        """
        first, last = start.translation, end.translation
        _check_distinct({"start": first, "goal": last, "interim point": interim})
        u, t = interim - first, last - first
        normal = np.cross(u, t)
        size = float(np.linalg.norm(normal))
        v = interim - last
        if size <= FLATTEST * _longest(u, v, t):
            raise _no_circle("start, interim point and goal are on one line")
        center = first + (u * (t @ t) * (u @ v) - t * (u @ u) * (t @ v)) * 0.5 / size**2
        axis = normal / size
        return cls(link, start, end, center, axis, _angle(first - center, last - center, axis))

    @classmethod
    def about(cls, link: str, start: SE3, center: FloatArray, end: SE3) -> CircularPath:
        """Create the shorter arc from one pose about a centre to another.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, when start and goal have different radii, are
                opposite to each other, or coincide.
        """
        _check_distinct({"start": start.translation, "goal": end.translation, "centre": center})
        first, last = start.translation - center, end.translation - center
        radii = float(np.linalg.norm(first)), float(np.linalg.norm(last))
        if abs(radii[0] - radii[1]) > LARGEST_RADIUS_DIFFERENCE:
            raise _no_circle(
                f"the start is {1000 * radii[0]:.1f} mm from the centre, the goal "
                f"{1000 * radii[1]:.1f} mm",
                CircleFailure("radii", *radii),
            )
        normal = np.cross(first, last)
        size = float(np.linalg.norm(normal))
        flattest = FLATTEST * _longest(first, last, last - first)
        if size <= max(flattest, _STRAIGHT_ANGLE * radii[0] * radii[1]):
            raise _no_circle("start, centre and goal are on one line: there is no shorter arc")
        axis = normal / size
        center = _equidistant(center, start.translation, end.translation)
        first, last = start.translation - center, end.translation - center
        return cls(link, start, end, center, axis, _angle(first, last, axis))

    def place(self, parameter: float) -> FloatArray:
        return self.center + pin.exp3(parameter * self.sweep * self.axis) @ self._spoke

    def nearest(self, pose: SE3) -> tuple[float, float]:
        offset = pose.translation - self.center
        height = float(offset @ self.axis)
        level = offset - height * self.axis
        beyond = _angle(self._spoke, level, self.axis)
        if beyond > self.sweep + 0.5 * (2 * np.pi - self.sweep):
            beyond -= 2 * np.pi  # nearer to the start than to the end
        gap = float(np.hypot(height, np.linalg.norm(level) - self.radius))
        return beyond / self.sweep, gap


def arc_to(target: PoseGoal, start: SE3, point: ArcPoint) -> CircularPath:
    """The arc from a pose to a target.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN, when there is no such circle.
    """
    make = CircularPath.through if point.kind == "interim" else CircularPath.about
    return make(target.link, start, point.position, target.pose)


def _angle(first: FloatArray, second: FloatArray, axis: FloatArray) -> float:
    """Counterclockwise angle about an axis from one radius vector to another [rad], 0 to 2 pi."""
    angle = np.arctan2(float(np.cross(first, second) @ axis), float(first @ second))
    return float(angle % (2 * np.pi))


def _equidistant(center: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """The point nearest to a centre that is equidistant from two points."""
    across = second - first
    return center - across * float((center - 0.5 * (first + second)) @ across) / float(
        across @ across
    )


def _longest(*sides: FloatArray) -> float:
    """Length of the longest vector [m]."""
    return max(float(np.linalg.norm(side)) for side in sides)


def _check_distinct(points: Mapping[str, FloatArray]) -> None:
    """Check that no two of an arc's points coincide; the first two are its start and its goal."""
    for (first, place), (second, other) in combinations(points.items(), 2):
        if np.linalg.norm(other - place) > FLATTEST:
            continue
        if (first, second) == ("start", "goal"):
            raise _no_circle(
                "start and goal are the same point: an arc of a whole turn needs two `circ` steps",
                CircleFailure("whole turn"),
            )
        raise _no_circle(f"{first} and {second} are the same point")


def _no_circle(why: str, failure: CircleFailure | None = None) -> PlanningFailed:
    failure = failure or CircleFailure("one line")
    return PlanningFailed("INVALID_MOTION_PLAN", f"no circle: {why}", failure)
