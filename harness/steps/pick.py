"""pick: approach, grasp, lift, as Task Constructor's Pick; the steps it is made of are recorded."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, group_of
from harness.cell.grasp_choice import first_that_goes
from harness.cell.grasping import grasp_point, gripper_axes, top_grasps
from harness.cell.program import ProgramStep
from harness.cell.scope import At
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.spec.base import Angle, JointEffort, Name, PositiveLength, SpecModel
from harness.spec.poses import Direction, Pose, Position
from harness.spec.step import Step
from harness.steps.grasp import Grasp, GripperAction, check_graspable
from harness.steps.gripper import Gripper
from harness.steps.lin import Lin
from harness.steps.move_relative import MoveRelative
from harness.steps.move_to import MoveTo

DEFAULT_TRAVEL = 0.1  # [m]


class Travel(SpecModel):
    """A straight move of a pick or place."""

    direction: Direction | None = Field(
        default=None, description="The move has this direction; the default depends on the move."
    )
    min_distance: PositiveLength | None = Field(
        default=None, description="The move has at least this length, or the step fails [m]."
    )
    max_distance: PositiveLength | None = Field(
        default=None, description="The move has at most this length [m]."
    )
    distance: PositiveLength | None = Field(
        default=None, description="The move has exactly this length [m]."
    )


class Pick(Step):
    """Approach, grasp, lift; expands into the steps it is made of.

    Without a `grasp_pose` the object's shape gives the grasps from above that are as good as each
    other: half a turn of the gripper, a box's other side if it fits, eight turns about what is
    round. The first that the arm can approach is taken; the step reports which `grasp` of how many
    `grasps`.
    """

    short = "object"

    verb: ClassVar[str] = "pick"

    object: Name = Field(description="The name of the object.")
    grasp_pose: Pose | None = Field(
        default=None,
        description="The pose of the TCP at the grasp; the default follows from the object's "
        "shape.",
    )
    pitch: Angle | None = Field(
        default=None, description="The pitch of the gripper, for arms of fewer than six joints."
    )
    approach: Travel | None = Field(
        default=None, description="The approach; the default is 10 cm along the gripper."
    )
    lift: Travel | None = Field(
        default=None, description="The lift after the grasp; the default is 10 cm up."
    )
    mode: GripperAction = Field(
        default="friction",
        description="`friction` holds the object by contact; `weld` also fixes it in the physics.",
    )
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None,
        description="The effort limit of the gripper's joint while it holds; the default is the "
        "robot's.",
    )

    def summary(self) -> str:
        return self.object

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`pick`")
        check_graspable(self.object, at)
        if self.grasp_pose is not None:
            at.check_pose(self.grasp_pose, "grasp_pose")
        check_travel(self.approach, at, "approach")
        check_travel(self.lift, at, "lift")
        at.scope.attached[self.object] = None

    def execute(self, cell: Cell) -> None:
        """Open, go to where the approach begins, approach straight, grasp, lift."""
        open_hand = Gripper(position=cell.gripper.open_position, max_effort=cell.gripper.max_effort)
        grasp = Grasp(object=self.object, mode=self.mode, max_effort=self.max_effort)
        lift = relative_step(self.lift, Direction(xyz=(0, 0, 1)), self.group)
        children = [
            cell.child("open", open_hand, "gripper open"),
            *_approach(self, cell),
            cell.child("grasp", grasp, f"grasp {self.object}"),
            cell.child("lift", lift, f"move_relative lift {self.object}"),
        ]
        cell.run_children(children)


def check_travel(travel: Travel | None, at: At, key: str) -> None:
    """Report a travel's frame that does not exist."""
    if travel is not None and travel.direction is not None:
        at.scope.check_frame(travel.direction.frame, at.key(key, "direction", "frame"))


def _approach(step: Pick, cell: Cell) -> list[ProgramStep]:
    """The free motion to where the approach begins, and the straight one to the grasp."""
    distance = travel_distance(step.approach)
    ways = [(back_off(target, distance, step, cell), target) for target in grasp_goals(step, cell)]
    chosen = first_that_goes(ways, group_of(cell, step.group), cell)
    cell.notes.result.update(grasps=len(ways), grasp=chosen + 1)
    before, target = ways[chosen]
    return [
        cell.child(
            "reach", MoveTo(**before.keys, group=step.group), f"move_to before {step.object}"
        ),
        cell.child("approach", Lin(**target.keys, group=step.group), f"lin to {step.object}"),
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
