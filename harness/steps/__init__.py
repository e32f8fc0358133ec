"""What a package needs to add a step of its own, and the built-in steps by their names.

    from harness.steps import Angle, At, Cell, MoveRelative, Step, StepFailed

Each module of this package holds the step of one verb. `harness.core.registry` finds the modules by
their names, so that a new step is a new file; the class of a built-in step is imported when it is
first named.
"""

from typing import Any

from harness.cell.cell import Cell
from harness.cell.goals import group_of, pose_goal, resolve_goal
from harness.cell.scope import At, Scope
from harness.cell.step import Step
from harness.core.details import Detail, Details
from harness.core.errors import StepFailed
from harness.core.registry import built_in_class
from harness.core.spatial import SE3
from harness.language.base import (
    Angle,
    AngleBetween,
    AngularVelocity,
    Count,
    Duration,
    Flag,
    Force,
    Fraction,
    JointValue,
    Length,
    LinearVelocity,
    Mass,
    Name,
    NonNegativeAngle,
    NonNegativeLength,
    Number,
    PositiveDuration,
    PositiveLength,
    Rate,
    SpecModel,
)
from harness.language.goals import GoalFields, GoalTolerance, LineFields
from harness.language.poses import Direction, Pose, Position
from harness.language.step import AnyStep, Block
from harness.language.world import ObjectSpec
from harness.ports.goals import JointGoal, PoseGoal, PositionGoal
from harness.ports.motions import (
    CircularMotion,
    FreeMotion,
    JointMotion,
    LinearMotion,
    RelativeMotion,
)

__all__ = [
    "SE3",
    "Angle",
    "AngleBetween",
    "AngularVelocity",
    "AnyStep",
    "At",
    "Block",
    "Cell",
    "CircularMotion",
    "Count",
    "Detail",
    "Details",
    "Direction",
    "Duration",
    "Flag",
    "Force",
    "Fraction",
    "FreeMotion",
    "GoalFields",
    "GoalTolerance",
    "JointGoal",
    "JointMotion",
    "JointValue",
    "Length",
    "LineFields",
    "LinearMotion",
    "LinearVelocity",
    "Mass",
    "Name",
    "NonNegativeAngle",
    "NonNegativeLength",
    "Number",
    "ObjectSpec",
    "Pose",
    "PoseGoal",
    "Position",
    "PositionGoal",
    "PositiveDuration",
    "PositiveLength",
    "Rate",
    "RelativeMotion",
    "Scope",
    "SpecModel",
    "Step",
    "StepFailed",
    "group_of",
    "pose_goal",
    "resolve_goal",
]


def __getattr__(name: str) -> Any:
    """Import the class of a built-in step, such as `MoveTo`."""
    return built_in_class("step", name)
