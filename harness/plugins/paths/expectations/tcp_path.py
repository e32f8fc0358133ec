"""tcp_path: how far the TCP strays from a line, an arc or its command, and how far it goes."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from harness.cell.scope import At
from harness.core.amounts import amounts, percentages
from harness.core.pose_arrays import compose
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.judging.expectation import ArmPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.observations import Observations
from harness.judging.poses import frame_poses, link_poses
from harness.judging.window import NotObservable, NotReached, Window
from harness.language.base import (
    AngleBetween,
    Deviation,
    Fraction,
    LinearVelocity,
    SpecModel,
)
from harness.language.expectation import Quantity
from harness.language.poses import Pose
from harness.language.step import step_class
from harness.plugins.paths.commanded_path import SHORTEST, followed_path
from harness.recording.link_poses import planned_tcp_poses
from harness.recording.step_record import StepRecord
from harness.recording.verdict import Measure

DEVIATION = Quantity("deviation", "m", "at most `max_deviation`")
TURN = Quantity("turn from the commanded orientation", "rad", "at most `max_rotation`, if given")
SPEED = Quantity(
    "difference from the commanded speed", "m/s", "at most `max_speed_error`, if given"
)
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
    """The TCP follows a line, an arc or a path: it stays near it and travels it from start to end.

    Without `line` and `arc` it is the line from where the step starts to its goal; of a `circ` step
    the arc; of a `cartesian_path` or `sequence` the path that was commanded, corners and blends
    included, which the TCP may follow up to 0.1 s late. Orientation and speed are compared with
    those that were commanded at the same place of the path.
    """

    judged = "always"
    sentence = "TCP path is followed[ along the line {line}][ along the arc {arc}]"
    quantities = (DEVIATION, SHARE, TURN, SPEED)

    line: Line | None = Field(
        default=None, description="The line that the TCP follows, instead of the step's own path."
    )
    arc: Arc | None = Field(
        default=None, description="The arc that the TCP follows, instead of the step's own path."
    )
    max_deviation: Deviation = Field(
        default=0.001, description="The largest distance to the line, arc or path [m]."
    )
    min_fraction: Fraction = Field(
        default=0.95,
        description="The share of the line, arc or path that must be travelled forwards in the "
        "window.",
    )

    max_rotation: Annotated[AngleBetween, Field(gt=0)] | None = Field(
        default=None,
        description="The largest angle from the commanded orientation; by default it is free "
        "[rad].",
    )
    max_speed_error: Annotated[LinearVelocity, Field(gt=0)] | None = Field(
        default=None,
        description="The largest difference of the TCP's speed from the commanded one, each over "
        "10 ms; by default it is free [m/s].",
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
        curve, deviation, places = self._compared(window)
        share = forward_share(places)
        strayed = bool((deviation > self.max_deviation).any())
        if window.cut_short and share < self.min_fraction and not strayed:
            raise NotReached(window.cut_short)
        off, shares = f"deviation from the {curve}", np.full(len(places), share)
        parts = [
            Part(DEVIATION, deviation, self.max_deviation, "<=", measured_name=off),
            Part(SHARE, shares, self.min_fraction, ">=", ceiling=1.0),
            *self._against_commands(window),
        ]

        def text(_: int, measure: Measure) -> str:
            away, allowed = amounts(measure.value, measure.limit, measure.unit)
            match measure.unit:
                case "1":
                    travelled, required = percentages(share, self.min_fraction)
                    way = f"{travelled} of the {curve} forwards"
                    return f"the TCP travelled {way}, {required} required"
                case "m":
                    return f"the TCP is {away} from the {curve}, {allowed} allowed"
                case "rad":
                    return f"the TCP is turned by {away} from its command, {allowed} allowed"
                case _:
                    return f"the TCP's speed is {away} from the commanded one, {allowed} allowed"

        return all_of(window, parts, text)

    def _compared(self, window: Window) -> tuple[str, FloatArray, FloatArray]:
        """What the TCP follows, its distance from it [m], and the place on it, shape (n,) each."""
        own = not self.corners()
        if own and window.step is not None and step_class(window.step.verb).has_corners:
            _motion_of(window, window.step)
            path = followed_path(window)
            return "commanded path", path.deviation, path.places
        tcp = window.cut(link_poses(window.run, window.run.robot.tcp_link))[:, :3]
        points = _planned(window) if own else [_point(window, pose) for _, pose in self.corners()]
        if len(points) == 2:
            return "line", *along_line(tcp, *points)
        return "arc", *along_arc(tcp, *points)

    def _against_commands(self, window: Window) -> list[Part]:
        """Orientation and speed against those commanded, where the file limits them."""
        limits = (self.max_rotation, self.max_speed_error)
        if limits == (None, None):
            return []
        path = followed_path(window)
        compared = ((TURN, path.turn), (SPEED, path.speed_error))
        return [
            Part(quantity, values, limit, "<=")
            for (quantity, values), limit in zip(compared, limits, strict=True)
            if limit is not None
        ]


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
    trajectory = _motion_of(window, step)
    planned = trajectory.positions
    rows = [0, len(planned) // 2, -1] if step_class(step.verb).is_arc else [0, -1]
    tcp = planned_tcp_poses(run, step, trajectory.joint_names, planned[rows])
    if tcp is None:
        raise NotObservable(f"how '{run.robot.tcp_link}' moves with the joints was not recorded")
    return [np.broadcast_to(point, (len(window.times), 3)) for point in tcp[:, :3]]


def _motion_of(window: Window, step: StepRecord) -> JointTrajectory:
    """The motion of the window's step."""
    if step.trajectory is None:
        if window.cut_short:
            raise NotReached(window.cut_short)
        raise NotObservable(f"step '{step.title}' has no path of its own: give a line or an arc")
    return step.trajectory


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
