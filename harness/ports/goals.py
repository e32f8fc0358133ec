"""Where a motion ends, and what must hold along it."""

from __future__ import annotations

from dataclasses import dataclass

from harness.core.spatial import SE3
from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class JointGoal:
    """Joint positions of the planning group, shape (dof,)."""

    positions: FloatArray


@dataclass(frozen=True, eq=False)
class PoseGoal:
    """A link at a pose.

    Attributes:
        link: A link that is rigidly attached after the group's last joint.
        pose: The pose T_world_link of the link.
        position_tolerance: Radius around the target [m].
        orientation_tolerance: Largest rotation about each axis [rad].
        axis_tolerances: The tolerances about the goal's own x, y, z instead [rad]; pi and more
            allow any turn.
    """

    link: str
    pose: SE3
    position_tolerance: float = 1e-4
    orientation_tolerance: float = 1e-3
    axis_tolerances: tuple[float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class PositionGoal:
    """A link's origin at a point, its orientation free but for an optional pitch.

    Attributes:
        position: The position in the world [m], shape (3,).
        pitch: Angle of the link's x axis below the horizontal [rad] (pi/2 points down), or None.
    """

    link: str
    position: FloatArray
    pitch: float | None = None
    position_tolerance: float = 1e-4
    pitch_tolerance: float = 1e-3


Goal = JointGoal | PoseGoal | PositionGoal


@dataclass(frozen=True, eq=False)
class AnyGoal:
    """One of several goals, whichever is nearest."""

    goals: tuple[Goal, ...]


@dataclass(frozen=True, eq=False)
class OrientationBand:
    """A link or an attached object stays turned as given.

    Attributes:
        rotation: R_world_link in the middle of the band, shape (3, 3).
        tolerance: The tolerances about its x, y, z [rad]; pi and more allow any turn. Where they
            allow it about one axis, and are equal about both others, they limit the tilt of that
            axis.
    """

    link: str
    rotation: FloatArray
    tolerance: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class PositionBox:
    """The origin of a link or an attached object stays in a box.

    Attributes:
        pose: T_world_box, of its middle.
        size: Along its x, y, z, full [m].
    """

    link: str
    pose: SE3
    size: tuple[float, float, float]


@dataclass(frozen=True)
class JointBand:
    """A joint stays between two positions [rad or m]."""

    joint: str
    lower: float
    upper: float


@dataclass(frozen=True, eq=False)
class PathConstraints:
    """What must hold all along a motion."""

    orientation: OrientationBand | None = None
    position: PositionBox | None = None
    joints: tuple[JointBand, ...] = ()
