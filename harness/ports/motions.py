"""The kinds of motions that a planner plans."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.ports.goals import AnyGoal, Goal, JointGoal, PathConstraints, PoseGoal, PositionGoal


@dataclass(frozen=True)
class CartesianLimits:
    """What a link may do on a line or an arc; None is Pilz's default times the scaling factors.

    Attributes:
        translation_velocity: The largest speed of the link [m/s].
        translation_acceleration: The largest acceleration [m/s^2], along the path and towards an
            arc's centre together.
        rotation_velocity: The largest turning speed [rad/s]; its acceleration is in proportion, as
            in Pilz.
    """

    translation_velocity: float | None = None
    translation_acceleration: float | None = None
    rotation_velocity: float | None = None


PILZ_LIMITS = CartesianLimits()  # Pilz's defaults times the scaling factors


@dataclass(frozen=True)
class JumpThreshold:
    """Farthest that a joint may move from one pose of a path to the next.

    Attributes:
        revolute: The largest step of a revolute joint [rad].
        prismatic: The largest step of a prismatic joint [m].
    """

    revolute: float
    prismatic: float


@dataclass(frozen=True, eq=False)
class ArcPoint:
    """What makes an arc of a start and a goal.

    Attributes:
        kind: A point that the arc passes, or the centre of the shorter one.
        position: The position in the world [m], shape (3,).
    """

    kind: Literal["interim", "center"]
    position: FloatArray


@dataclass(frozen=True, eq=False)
class SequenceItem:
    """One motion of a sequence.

    Attributes:
        point: What makes the arc of a circ; None for others.
        blend_radius: Around its end, inside which it goes over into the next one [m].
        cartesian_limits: The cartesian limits of lines and arcs.
    """

    kind: Literal["ptp", "lin", "circ"]
    goal: Goal
    point: ArcPoint | None = None
    blend_radius: float = 0.0
    cartesian_limits: CartesianLimits = PILZ_LIMITS


@dataclass(frozen=True)
class CartesianPathOptions:
    """The requirements on a Cartesian path.

    Attributes:
        max_step: Between the poses that are solved [m].
        precision: Largest distance from the straight lines, corners included [m].
        min_fraction: Least share of the path.
        jump: What no joint may exceed from one pose to the next.
    """

    max_step: float
    precision: float
    min_fraction: float
    jump: JumpThreshold


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A collision-free motion on any path; with constraints, every sample of it holds them."""

    goal: Goal | AnyGoal
    constraints: PathConstraints | None = None


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Pilz's PTP: all joints together, straight in joint space.

    Attributes:
        positions: The joint positions at the end, shape (dof,).
        duration: The exact duration [s]; the shortest possible one without it.
    """

    positions: FloatArray
    duration: float | None = None

    @property
    def goal(self) -> JointGoal:
        """The end of the motion."""
        return JointGoal(np.asarray(self.positions, dtype=float))


@dataclass(frozen=True, eq=False)
class TimedMotion:
    """A motion with its times, which is verified and not planned."""

    trajectory: JointTrajectory


@dataclass(frozen=True, eq=False)
class LinearMotion:
    """Pilz's LIN: the link on a straight line, turning at an even rate.

    The line of a joint goal ends where it puts the TCP; with a position goal the link keeps its
    orientation.
    """

    goal: Goal


@dataclass(frozen=True, eq=False)
class CircularMotion:
    """Pilz's CIRC: the link on an arc through a point or about a centre."""

    kind: ClassVar[str] = "arc"
    goal: Goal
    point: ArcPoint


@dataclass(frozen=True, eq=False)
class RelativeMotion:
    """A link moves along a direction as far as possible between two distances.

    Attributes:
        link: A link that is rigidly attached after the group's last joint.
        twist: Unit translation or rotation in world axes, shape (6,): linear, then angular.
        distances: Least and most [m or rad]; equal for a fixed distance.
    """

    link: str
    twist: FloatArray
    distances: tuple[float, float]


@dataclass(frozen=True, eq=False)
class MotionSequence:
    """Pilz's sequence: motions blended into each other, all of them or none."""

    kind: ClassVar[str] = "sequence"
    items: Sequence[SequenceItem]


@dataclass(frozen=True, eq=False)
class WaypointMotion:
    """Straight lines through waypoints, as far as they can be followed.

    The plan's result has `fraction`, `largest_joint_step` [rad or m] and `deviation` [m].
    """

    kind: ClassVar[str] = "waypoints"
    goals: Sequence[PoseGoal | PositionGoal]
    path_options: CartesianPathOptions


@dataclass(frozen=True, eq=False)
class TimedLinkMotion:
    """A link that must be at a pose at each moment.

    Attributes:
        link: A link that is rigidly attached after the group's last joint.
        pose_at: T_world_link at a time from 0 to `duration` [s]; at rest at both ends.
        duration: The time that the motion takes [s].
    """

    kind: ClassVar[str] = "timed_link"
    link: str
    pose_at: Callable[[float], SE3]
    duration: float


PlannedMotion = (
    FreeMotion
    | JointMotion
    | LinearMotion
    | CircularMotion
    | RelativeMotion
    | MotionSequence
    | WaypointMotion
    | TimedLinkMotion
    | TimedMotion
)
