"""The closed form of OpenMANIPULATOR-X as a solver."""

from __future__ import annotations

from typing import ClassVar, cast

import numpy as np

from harness.core.types import FloatArray
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.closed_forms.arm_frames import arm_joints, base_pose, fixed_offset
from harness.plugins.closed_forms.branch_name import elbow_branch
from harness.plugins.closed_forms.planar_arm import (
    PlanarArm,
    headings,
    is_planar_arm,
    pitch_in_plane,
    pitches_below,
    solve_planar,
)
from harness.ports.goals import PoseGoal
from harness.ports.kinematics import IkRequest, IkResult, IkSolver

PITCH_SAMPLES = 73
"""Pitches tried for a position goal that leaves the pitch free: every 5 degrees of a whole turn."""


class PlanarArmSolver(IkSolver):
    """Closed form of OpenMANIPULATOR-X: position and pitch, four branches."""

    name: ClassVar[str] = "open_manipulator_x"
    title: ClassVar[str] = "closed form of OpenMANIPULATOR-X"
    is_closed_form: ClassVar[bool] = True

    @classmethod
    def fits(cls, request: IkRequest) -> bool:
        """Whether four joints are a turntable and three parallel joints."""
        joints = arm_joints(request)
        return len(joints) == 4 and is_planar_arm(joints, fixed_offset(request))

    def solve(self, request: IkRequest) -> IkResult:
        """Solve for every heading and pitch that the goal allows."""
        goal = request.goal
        arm = PlanarArm.of_joints(arm_joints(request), fixed_offset(request))
        T_base_world = base_pose(request).inverse()
        target = goal.pose.translation if isinstance(goal, PoseGoal) else goal.position
        position = T_base_world.apply(np.asarray(target, dtype=float))
        found: list[np.ndarray] = []
        excesses: list[float] = []
        for heading in headings(arm, position):
            if isinstance(goal, PoseGoal):
                x_axis = T_base_world.rotation @ goal.pose.rotation[:, 0]
                pitches = [pitch_in_plane(heading, x_axis)]
            elif goal.pitch is not None:
                down = T_base_world.rotation @ np.array([0.0, 0.0, -1.0])
                pitches = list(pitches_below(heading, down, goal.pitch))
            else:
                now = float(request.seed_positions[1:].sum())
                pitches = [now, *np.linspace(-np.pi, np.pi, PITCH_SAMPLES)]
            for pitch in pitches:
                answer = solve_planar(arm, position, heading, pitch)
                found.extend(answer.solutions)
                excesses.append(answer.excess)
        return IkResult(tuple(found), min(excesses, default=0.0))

    @classmethod
    def branch_name(cls, request: IkRequest, positions: FloatArray) -> str:
        """The side and the elbow."""
        return elbow_branch(cast("GroupSpace", request.space), positions)
