"""Resolves the goals of a file to goals of a planner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.state_words import stated_name
from harness.core.suggestion import did_you_mean
from harness.core.types import FloatArray
from harness.language.goals import CartesianLimitsSpec, GoalFields, GoalTolerance
from harness.language.poses import Pose, Position
from harness.ports.goals import (
    Goal,
    JointGoal,
    PoseGoal,
    PositionGoal,
)
from harness.ports.motions import CartesianLimits as LinkLimits
from harness.robot.description import RobotDescription
from harness.robot.task_space import TaskSpace

DEFAULT_TOLERANCE = GoalTolerance()


@dataclass(frozen=True)
class TcpGoal:
    """The goal of the TCP in a composite step: a pose, or a position and a pitch [rad]."""

    target: Pose | Position
    pitch: float | None = None

    @property
    def keys(self) -> dict[str, Any]:
        """The goal as the keys of a motion step."""
        if isinstance(self.target, Pose):
            return {"pose": self.target}
        return {"position": self.target, "pitch": self.pitch}


def group_of(cell: Cell, group: str | None) -> str:
    """The step's planning group: its own, else the robot's default."""
    return cell.description.default_group if group is None else group


def task_space_of(description: RobotDescription, group: str | None) -> TaskSpace:
    """What a step's planning group can hold of a pose."""
    return description.task_space(description.default_group if group is None else group)


def resolve_goal(goal: GoalFields, group: str, cell: Cell) -> Goal:
    """The goal with every number known, in the world, for the present state of the cell."""
    if goal.named_target is not None:
        states = cell.description.states_of(group)
        state = states[stated_name(goal.named_target, states)]
        return JointGoal(_joint_positions(cell, group, dict(state.positions)))
    if goal.joints is not None:
        names = cell.description.groups[group].joint_names
        if others := [name for name in goal.joints if name not in names]:  # of a step in Python
            hint = did_you_mean(others[0], names, "joints")
            reason = f"there is no joint '{others[0]}' of '{group}'; {hint}"
            raise StepFailed("INVALID_GOAL_CONSTRAINTS", reason)
        return JointGoal(_joint_positions(cell, group, goal.joints))
    if goal.pose is not None:
        return pose_goal(goal.pose, goal.link, goal.tolerance, cell)
    if goal.position is None:
        raise StepFailed("UNRECOGNIZED_GOAL_TYPE", "the step has no goal")
    tolerance = goal.tolerance or DEFAULT_TOLERANCE
    return PositionGoal(
        link=goal.link or cell.description.tcp_link,
        position=world_point(goal.position, cell),
        pitch=goal.pitch,
        position_tolerance=tolerance.position,
        pitch_tolerance=_largest(tolerance),
    )


def pose_goal(
    pose: Pose, link: str | None, tolerance: GoalTolerance | None, cell: Cell
) -> PoseGoal:
    """A pose goal; `link` may be a held object, as Task Constructor's ik_frame."""
    limits = tolerance or DEFAULT_TOLERANCE
    target = cell.world_pose(pose)
    name = link or cell.description.tcp_link
    attached = cell.scene.attached()
    if name in attached:
        start = cell.planning_start()
        carrier = attached[name]
        in_carrier = cell.kinematics.link_pose(start, carrier).inverse() @ cell.scene.object_pose(
            name, start
        )
        name, target = carrier, target @ in_carrier.inverse()
    axes = limits.orientation if isinstance(limits.orientation, tuple) else None
    return PoseGoal(name, target, limits.position, _largest(limits), axes)


def _largest(tolerance: GoalTolerance) -> float:
    given = tolerance.orientation
    return max(given) if isinstance(given, tuple) else given


def world_point(position: Position, cell: Cell) -> FloatArray:
    """A point that a file gives in some frame, in the world, shape (3,)."""
    return cell.frame(position.frame).apply(np.array(position.xyz))


def link_limits(limits: CartesianLimitsSpec | None) -> LinkLimits:
    """A step's Cartesian limits as the planner takes them."""
    if limits is None:
        return LinkLimits()
    return LinkLimits(limits.max_trans_vel, limits.max_trans_acc, limits.max_rot_vel)


def _joint_positions(cell: Cell, group: str, positions: dict[str, float]) -> FloatArray:
    """The positions of a group's joints; those that are not named stay."""
    start = cell.planning_start()
    index = cell.description.joint_index
    names = cell.description.groups[group].joint_names
    return np.array([positions.get(name, float(start[index[name]])) for name in names])
