"""tcp_path: how far the TCP strays from a line or an arc, and how much of it it travels."""

from __future__ import annotations

import numpy as np
from pydantic import Field, model_validator

from harness.cell.scope import At
from harness.core.amounts import amounts, percentages
from harness.core.pose_arrays import compose
from harness.core.types import FloatArray
from harness.judging.expectation import ArmPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.observations import Observations
from harness.judging.poses import frame_poses, link_poses
from harness.judging.window import NotObservable, NotReached, Window
from harness.language.base import Fraction, PositiveLength, SpecModel
from harness.language.expectation import Quantity
from harness.language.poses import Pose
from harness.language.step import step_class
from harness.recording.link_poses import planned_tcp_poses
from harness.recording.verdict import Measure

SHORTEST = 1e-6  # points nearer than this are one [m]

DEVIATION = Quantity("deviation", "m", "at most `max_deviation`")
SHARE = Quantity("share travelled forwards", "1", "at least `min_fraction`, in the whole window")


class Line(SpecModel):
    """A straight line between two points."""

    start: Pose = Field(description="The start of the line, of which only the position counts.")
    end: Pose = Field(description="The end of the line, of which only the position counts.")


class Arc(SpecModel):
    """An arc from start to end through a point."""

    start: Pose = Field(description="The start of the arc, of which only the position counts.")
    interim: Pose = Field(description="A point of the arc between its start and its end.")
    end: Pose = Field(description="The end of the arc, of which only the position counts.")


class TcpPath(ArmPredicate):
    """The TCP follows a line or an arc: it stays near it and travels it from start to end.

    Without `line` and `arc` it is the line from where the step starts to its goal; of a `circ` step
    the arc.
    """

    judged = "always"
    sentence = "TCP path is followed[ along the line {line}][ along the arc {arc}]"
    quantities = (DEVIATION, SHARE)

    line: Line | None = Field(
        default=None, description="The line that the TCP follows, instead of the step's own path."
    )
    arc: Arc | None = Field(
        default=None, description="The arc that the TCP follows, instead of the step's own path."
    )
    max_deviation: PositiveLength = Field(
        default=0.001, description="The largest distance to the line or arc [m]."
    )
    min_fraction: Fraction = Field(
        default=0.95,
        description="The share of the line or arc that must be travelled forwards in the window.",
    )

    @model_validator(mode="after")
    def _one(self) -> TcpPath:
        if self.line is not None and self.arc is not None:
            raise ValueError(
                "`tcp_path` takes `line` or `arc`, not both; without them it is the step's own path"
            )
        return self

    def corners(self) -> list[tuple[tuple[str, str], Pose]]:
        """Each point of the curve, with the keys that lead to it."""
        curves = (("line", self.line), ("arc", self.arc))
        return [
            ((name, key), getattr(curve, key))
            for name, curve in curves
            if curve is not None
            for key in type(curve).model_fields
        ]

    def check(self, at: At) -> None:
        at.scope.check_arm(at.loc)
        for keys, pose in self.corners():
            at.scope.check_frame(pose.frame, at.key(*keys, "frame"))

    def needs_step(self) -> str:
        if self.corners():
            return ""
        return (
            "`tcp_path` without `line` or `arc` is the way of one step from its start to its goal"
        )

    def observations(self) -> Observations:
        return Observations(frozenset(pose.frame for _, pose in self.corners()))

    def signal(self, window: Window) -> MarginSignal:
        """Distance to the nearest point of the curve, and the share that is travelled forwards.

        The share is of the whole window, so a TCP that stands on the line has not followed it, and
        neither has one that goes from its end to its start.
        """
        limit = self.max_deviation
        tcp = window.cut(link_poses(window.run, window.run.robot.tcp_link))[:, :3]
        points = [_point(window, pose) for _, pose in self.corners()] or _planned(window)
        curve = "line" if len(points) == 2 else "arc"
        deviation, places = along_line(tcp, *points) if curve == "line" else along_arc(tcp, *points)
        share = forward_share(places)
        if window.cut_short and share < self.min_fraction and not (deviation > limit).any():
            raise NotReached(window.cut_short)
        off, shares = f"deviation from the {curve}", np.full(len(tcp), share)
        parts = [
            Part(DEVIATION, deviation, limit, "<=", measured_name=off),
            Part(SHARE, shares, self.min_fraction, ">=", ceiling=1.0),
        ]

        def text(_: int, measure: Measure) -> str:
            if measure.unit == "1":
                travelled, required = percentages(share, self.min_fraction)
                return f"the TCP travelled {travelled} of the {curve} forwards, {required} required"
            away, allowed = amounts(measure.value, limit, "m")
            return f"the TCP is {away} from the {curve}, {allowed} allowed"

        return all_of(window, parts, text)


def forward_share(places: FloatArray) -> float:
    """The largest advance from some sample to a later one; NaN where a sample is not known."""
    return float(np.max(places - np.minimum.accumulate(places)))


def _point(window: Window, pose: Pose) -> FloatArray:
    """A point in the world at each sample, shape (n, 3)."""
    frame = window.cut(frame_poses(window.run, pose.frame))
    return compose(frame, pose.se3().as_vector())[:, :3]


def _planned(window: Window) -> list[FloatArray]:
    """Start and goal of the window's step as it was planned, and of an arc a point between them.

    Only they are taken from the plan: what lies between is a line or a circle, however the arm was
    commanded.

    Returns:
        Points in the world, one after the other, shape (n, 3) each.

    Raises:
        NotReached: The step failed before its path was planned.
        NotObservable: The step, or the whole run, has no path of its own.
    """
    run, step = window.run, window.step
    if step is None:
        raise NotObservable("the whole run has no start and goal: name a step, a line or an arc")
    if step.trajectory is None:
        if window.cut_short:
            raise NotReached(window.cut_short)
        raise NotObservable(f"step '{step.id}' has no path of its own: give a line or an arc")
    planned = step.trajectory.positions
    rows = [0, len(planned) // 2, -1] if step_class(step.verb).is_arc else [0, -1]
    tcp = planned_tcp_poses(run, step, step.trajectory.joint_names, planned[rows])
    if tcp is None:
        raise NotObservable(f"how '{run.robot.tcp_link}' moves with the joints was not recorded")
    return [np.broadcast_to(point, (len(window.times), 3)) for point in tcp[:, :3]]


def along_line(
    points: FloatArray, start: FloatArray, end: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Distances to a segment [m], and where its nearest point lies from start (0) to end (1).

    Raises:
        NotObservable: Start and end are one point.
    """
    along = end - start
    squared = np.sum(along**2, axis=1)
    if np.nanmin(squared, initial=np.inf) < SHORTEST**2:
        raise NotObservable("start and end of the line are one point")
    places = np.clip(np.sum((points - start) * along, axis=1) / squared, 0.0, 1.0)
    nearest = start + places[:, None] * along
    return np.linalg.norm(points - nearest, axis=1), places


def along_arc(
    points: FloatArray, start: FloatArray, interim: FloatArray, end: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Distances to the arc through three points [m], and where on it the nearest point lies.

    The circle's centre from the triangle's sides: c = a + ((|u|^2 v - |v|^2 u) x (u x v)) /
    (2 |u x v|^2) with u, v the sides from a.

    Raises:
        NotObservable: The points lie on a line.
    """
    u, v = interim - start, end - start
    normal = np.cross(u, v)
    area = np.sum(normal**2, axis=1)
    if np.nanmin(area, initial=np.inf) <= SHORTEST**2 * np.nanmax(np.sum(v**2, axis=1)):
        raise NotObservable("the three points of the arc lie on a line")
    weighted = np.sum(u**2, axis=1)[:, None] * v - np.sum(v**2, axis=1)[:, None] * u
    centre = start + np.cross(weighted, normal) / (2 * area[:, None])
    radius = np.linalg.norm(start - centre, axis=1)
    axis = normal / np.sqrt(area)[:, None]
    first = (start - centre) / radius[:, None]
    second = np.cross(axis, first)
    total = _angle(end - centre, first, second)  # start -> interim -> end turns about +axis
    angle = _angle(points - centre, first, second)
    beyond = angle > total
    nearer_end = angle - total < 2 * np.pi - angle
    angle = np.where(beyond, np.where(nearer_end, total, 0.0), angle)
    nearest = centre + radius[:, None] * (
        np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
    )
    return np.linalg.norm(points - nearest, axis=1), angle / total


def _angle(offset: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Angle from `first` towards `second` [rad], in [0, 2 pi)."""
    turned: FloatArray = np.arctan2(np.sum(offset * second, axis=1), np.sum(offset * first, axis=1))
    return np.where(turned < 0, turned + 2 * np.pi, turned)
