"""What the engine needs from the outside, as protocols; here are those that plug-ins need."""

from harness.ports.goals import JointGoal, PoseGoal, PositionGoal
from harness.ports.joint_control import ControlRequest, ControlResult, JointController
from harness.ports.kinematics import IkRequest, IkResult, IkSolver
from harness.ports.motions import (
    CircularMotion,
    FreeMotion,
    JointMotion,
    LinearMotion,
    RelativeMotion,
)
from harness.ports.path_planning import PathPlanner, PathRequest, PathResult

__all__ = [
    "CircularMotion",
    "ControlRequest",
    "ControlResult",
    "FreeMotion",
    "IkRequest",
    "IkResult",
    "IkSolver",
    "JointController",
    "JointGoal",
    "JointMotion",
    "LinearMotion",
    "PathPlanner",
    "PathRequest",
    "PathResult",
    "PoseGoal",
    "PositionGoal",
    "RelativeMotion",
]
