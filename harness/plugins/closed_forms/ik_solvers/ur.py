"""The closed form of Universal Robots' arms as a solver."""

from __future__ import annotations

from typing import ClassVar, cast

import numpy as np

from harness.core.types import FloatArray
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.closed_forms.arm_frames import arm_joints, base_pose, fixed_offset
from harness.plugins.closed_forms.branch_name import elbow_branch
from harness.plugins.closed_forms.ur_arm import UrGeometry, is_ur_like, solve_ur
from harness.ports.goals import PoseGoal
from harness.ports.kinematics import IkRequest, IkResult, IkSolver


class UrSolver(IkSolver):
    """Closed form of Universal Robots: all eight branches of a pose."""

    name: ClassVar[str] = "ur"
    title: ClassVar[str] = "closed form of Universal Robots"
    is_closed_form: ClassVar[bool] = True
    is_refined: ClassVar[bool] = True

    @classmethod
    def fits(cls, request: IkRequest) -> bool:
        """Whether the goal is a pose, and the six joints are arranged like a UR's."""
        return isinstance(request.goal, PoseGoal) and is_ur_like(arm_joints(request))

    def solve(self, request: IkRequest) -> IkResult:
        """Solve for the branches."""
        goal, joints = request.goal, arm_joints(request)
        if not isinstance(goal, PoseGoal):
            raise TypeError("the goal is no pose")
        T_last_link = fixed_offset(request)
        T_base_wrist3 = base_pose(request).inverse() @ goal.pose @ T_last_link.inverse()
        wrist_3 = float(request.seed_positions[-1])
        answer = solve_ur(UrGeometry.of_joints(joints), T_base_wrist3, wrist_3)
        return IkResult(tuple(answer.branches), max(answer.excess, 0.0))

    @classmethod
    def branch_name(cls, request: IkRequest, positions: FloatArray) -> str:
        """The side, the elbow and the sign of joint 5."""
        elbow = elbow_branch(cast("GroupSpace", request.space), positions)
        is_below = float(np.sin(positions[4])) < 0
        return f"{elbow}, {request.space.joint_names[4]} {'<' if is_below else '>'} 0"
