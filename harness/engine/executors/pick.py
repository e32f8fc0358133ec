"""pick: approach, grasp, lift, as Task Constructor's Pick; the steps it is made of are recorded."""

from __future__ import annotations

import math

import numpy as np

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, group_of
from harness.cell.grasp_choice import first_that_goes
from harness.cell.grasping import grasp_point, gripper_axes, top_grasps
from harness.cell.program import ProgramStep
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.engine.registry import execute
from harness.spec.poses import Direction, Pose, Position
from harness.spec.steps import Grasp, Gripper, MoveRelative, Pick, Travel

DEFAULT_TRAVEL = 0.1  # [m]


@execute.handles(Pick)
def pick(step: Pick, cell: Cell) -> None:
    """Open, go to where the approach begins, approach straight, grasp, lift."""
    children = [
        cell.child(
            "open",
            Gripper(position=cell.gripper.open_position, max_effort=cell.gripper.max_effort),
            "gripper open",
        ),
        *_approach(step, cell),
        cell.child(
            "grasp",
            Grasp(object=step.object, mode=step.mode, max_effort=step.max_effort),
            f"grasp {step.object}",
        ),
        cell.child(
            "lift",
            relative_step(step.lift, Direction(xyz=(0, 0, 1)), step.group),
            f"move_relative lift {step.object}",
        ),
    ]
    cell.run_children(children)


def _approach(step: Pick, cell: Cell) -> list[ProgramStep]:
    """The free motion to where the approach begins, and the straight one to the grasp."""
    distance = travel_distance(step.approach)
    ways = [(back_off(target, distance, step, cell), target) for target in grasp_goals(step, cell)]
    chosen = first_that_goes(ways, group_of(cell, step.group), cell)
    cell.notes.result.update(grasps=len(ways), grasp=chosen + 1)
    before, target = ways[chosen]
    return [
        cell.child("reach", before.move_to(step.group), f"move_to before {step.object}"),
        cell.child("approach", target.lin(step.group), f"lin to {step.object}"),
    ]


def grasp_goals(step: Pick, cell: Cell) -> list[TcpGoal]:
    """Where the TCP may be to grasp: poses, or position and pitch for arms of fewer joints."""
    if step.grasp_pose is not None:
        return [TcpGoal(world_pose_spec(cell.world_pose(step.grasp_pose)))]
    object_pose = cell.frame(step.object)
    if arm_has_six_joints(cell, step.group) and step.pitch is None:
        obj = cell.presence[step.object].obj
        return [TcpGoal(world_pose_spec(pose)) for pose in top_grasps(obj, object_pose, cell)]
    point = grasp_point(cell.presence[step.object].obj, object_pose)
    x, y, z = (float(value) for value in point)
    return [TcpGoal(Position(xyz=(x, y, z)), step.pitch or 0.0)]


def back_off(target: TcpGoal, distance: float, step: Pick, cell: Cell) -> TcpGoal:
    """The goal moved back against the approach direction [m]."""
    along = None
    if step.approach is not None and step.approach.direction is not None:
        along = cell.world_direction(step.approach.direction)
    if isinstance(target.target, Pose):
        at = target.target.se3()
        if along is None:
            along = at.rotation @ gripper_axes(cell)[0]
        return TcpGoal(world_pose_spec(SE3(at.rotation, at.translation - distance * along)))
    point, pitch = np.array(target.target.xyz), float(target.pitch or 0.0)
    if along is None:
        away = point - _turning_axis(cell, step.group)
        heading = math.atan2(away[1], away[0])
        level = math.cos(pitch)
        along = np.array([level * math.cos(heading), level * math.sin(heading), -math.sin(pitch)])
    x, y, z = (float(value) for value in point - distance * along)
    return TcpGoal(Position(xyz=(x, y, z)), pitch)


def _turning_axis(cell: Cell, group: str | None) -> FloatArray:
    """A point on the axis about which the arm turns to a heading: its first joint's, shape (3,)."""
    first = cell.description.groups[group_of(cell, group)].joint_names[0]
    return cell.frame(cell.description.joint_by_name[first].child).translation


def arm_has_six_joints(cell: Cell, group: str | None) -> bool:
    """Whether the arm can reach any pose near it, not only positions at a pitch."""
    return len(cell.description.groups[group_of(cell, group)].joint_names) >= 6


def travel_distance(travel: Travel | None) -> float:
    """How far a travel goes at most [m]."""
    if travel is None:
        return DEFAULT_TRAVEL
    return travel.distance or travel.max_distance or travel.min_distance or DEFAULT_TRAVEL


def relative_step(travel: Travel | None, default: Direction, group: str | None) -> MoveRelative:
    """The straight move of a travel."""
    if travel is None:
        return MoveRelative(direction=default, distance=DEFAULT_TRAVEL, group=group)
    direction = travel.direction or default
    if travel.distance is not None or (travel.min_distance, travel.max_distance) == (None, None):
        return MoveRelative(
            direction=direction, distance=travel.distance or DEFAULT_TRAVEL, group=group
        )
    most = travel.max_distance or travel.min_distance
    return MoveRelative(
        direction=direction, min_distance=travel.min_distance, max_distance=most, group=group
    )


def world_pose_spec(pose: SE3) -> Pose:
    """A pose in the world as a file would write it."""
    x, y, z = (float(value) for value in pose.translation)
    qw, qx, qy, qz = (float(value) for value in pose.quat_wxyz)
    return Pose(xyz=(x, y, z), quat_wxyz=(qw, qx, qy, qz))
