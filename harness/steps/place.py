"""place: approach, lower, release, retreat, as Task Constructor's Place; each is recorded."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, group_of
from harness.cell.grasp_choice import first_that_goes
from harness.cell.grasping import UP, gripper_axes, pitch_of, turn_about
from harness.cell.program import ProgramStep
from harness.cell.scope import At
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.spatial import SE3
from harness.core.symmetry import equal_turns
from harness.core.types import FloatArray
from harness.ports import PositionGoal
from harness.spec.base import Name
from harness.spec.poses import Direction, Pose, Position
from harness.spec.step import Step
from harness.steps.lin import Lin
from harness.steps.move_to import MoveTo
from harness.steps.pick import (
    Travel,
    arm_has_six_joints,
    check_travel,
    relative_step,
    travel_distance,
    world_pose_spec,
)
from harness.steps.release import Release

REFINEMENTS = 4
PUT_DOWN_GAP = 0.001  # [m] above the target, so that the support is touched when the fingers open
TURNS_OF_ROUND = 8
"""As many turns are tried of what is round about the vertical."""
DEFAULT_RETREAT = Travel(min_distance=0.03, max_distance=0.1)


class Place(Step):
    """Approach, lower, release, retreat; expands into the steps it is made of.

    Where the arm cannot lower the object to a `pose` without a rotation, or not open its hand
    there, the object is turned about the vertical, if it looks the same then: by a half, what is
    square by quarters, what is round by eighths; the step reports which `turn` of how many `turns`.
    A `pose` with a rotation is kept to. An arm of fewer than six joints brings the object to the
    position alone, with the pitch that the gripper has: the object turns with the arm.
    """

    verb: ClassVar[str] = "place"

    object: Name | None = Field(
        default=None,
        description="The name of the object; the default is the one that was picked last.",
    )
    pose: Pose = Field(description="The pose at which the object will stand.")
    approach: Travel | None = Field(
        default=None, description="The approach; the default is 10 cm straight down."
    )
    retreat: Travel | None = Field(
        default=None, description="The retreat; the default is 3 to 10 cm back along the gripper."
    )

    def summary(self) -> str:
        return self.object or ""

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`place`")
        at.check_pose(self.pose, "pose")
        if self.object is not None:
            at.scope.check_object(self.object, at.key("object"))
        check_travel(self.approach, at, "approach")
        check_travel(self.retreat, at, "retreat")
        name = self.object or next(reversed(at.scope.attached), None)
        if name is not None:
            at.scope.attached.pop(name, None)

    def execute(self, cell: Cell) -> None:
        """Go above the target, lower straight, release, retreat along the gripper's approach axis.

        Raises:
            StepFailed: INVALID_OBJECT_NAME, when the object is not held.
        """
        name = self.object or (cell.held[-1] if cell.held else None)
        if name is None or name not in cell.scene.attached():
            what = f"'{name}' is not held" if name else "nothing is held"
            raise StepFailed("INVALID_OBJECT_NAME", f"{what}, so nothing can be placed")
        backwards = _retreat_direction(cell)
        children = [
            *_lowering(name, self, cell),
            cell.child("release", Release(object=name), f"release {name}"),
            cell.child(
                "retreat",
                relative_step(self.retreat or DEFAULT_RETREAT, backwards, self.group),
                "move_relative back",
            ),
        ]
        cell.run_children(children)


def _lowering(name: str, step: Place, cell: Cell) -> list[ProgramStep]:
    """The free motion above the place, and the straight one down to it."""
    along = -UP
    if step.approach is not None and step.approach.direction is not None:
        along = cell.world_direction(step.approach.direction)
    back = travel_distance(step.approach) * along
    ways: list[tuple[TcpGoal, TcpGoal]] = []
    for stated in _equal_poses(name, step, cell):
        target = SE3(stated.rotation, stated.translation + PUT_DOWN_GAP * UP)
        before = SE3(target.rotation, target.translation - back)
        ways.append((_tcp_goal(name, before, step, cell), _tcp_goal(name, target, step, cell)))
    chosen = first_that_goes(
        ways,
        group_of(cell, step.group),
        cell,
        padding=0.0,
        may_end=lambda state: _can_open(state, cell),
    )
    cell.notes.result.update(turns=len(ways), turn=chosen + 1)
    before, target = ways[chosen]
    return [
        cell.child(
            "reach", MoveTo(**before.keys, group=step.group), f"move_to above the place of {name}"
        ),
        _touching(cell.child("lower", Lin(**target.keys, group=step.group), f"lin {name}")),
    ]


def _can_open(state: FloatArray, cell: Cell) -> bool:
    """Whether the open hand touches nothing but what it holds, the arm standing so."""
    hand_open = np.array(state)
    hand_open[cell.description.joint_index[cell.gripper.joint]] = cell.gripper.open_position
    return not cell.scene.touches(cell.description.with_mimics(hand_open))


def _equal_poses(name: str, step: Place, cell: Cell) -> list[SE3]:
    """T_world_object of every way to put it there: as stated, then turned further and further.

    An arm of fewer than six joints turns the object as it reaches there: it has one way.
    """
    stated = cell.world_pose(step.pose)
    if step.pose.has_rotation or not arm_has_six_joints(cell, step.group):
        return [stated]
    obj = cell.presence[name].obj
    count = equal_turns(obj.visuals or obj.shapes, stated.rotation) or TURNS_OF_ROUND
    turns = sorted(range(count), key=lambda turn: min(turn, count - turn))
    return [
        SE3(turn_about(UP, 2 * math.pi * turn / count) @ stated.rotation, stated.translation)
        for turn in turns
    ]


def _touching(step: ProgramStep) -> ProgramStep:
    """The step without padding: what is put down comes as near to its support as it will stand."""
    return replace(step, options=replace(step.options, padding=0.0))


def _retreat_direction(cell: Cell) -> Direction:
    """Against the gripper's approach axis, in the TCP's frame, so it is read when it is needed."""
    x, y, z = (-float(value) for value in gripper_axes(cell)[0])
    return Direction(xyz=(x, y, z), frame=cell.description.tcp_link)


def _tcp_goal(name: str, target: SE3, step: Place, cell: Cell) -> TcpGoal:
    """Where the TCP must be so that the held object, as the planner believes it, is at a pose."""
    start = cell.planning_start()
    tcp = cell.kinematics.link_pose(start, cell.description.tcp_link)
    tcp_to_object = tcp.inverse() @ cell.scene.object_pose(name, start)
    if arm_has_six_joints(cell, step.group):
        return TcpGoal(world_pose_spec(target @ tcp_to_object.inverse()))
    pitch = pitch_of(tcp.rotation)
    x, y, z = _tcp_position(target.translation, tcp_to_object, pitch, step, cell)
    return TcpGoal(Position(xyz=(float(x), float(y), float(z))), pitch)


def _tcp_position(
    point: FloatArray, tcp_to_object: SE3, pitch: float, step: Place, cell: Cell
) -> FloatArray:
    """TCP position at which the object's origin is at a point, for arms that choose their own yaw.

    The yaw follows from the position, so the offset is corrected a few times from where the
    solution puts the object.
    """
    group, start = group_of(cell, step.group), cell.planning_start()
    link, position = cell.description.tcp_link, np.array(point)
    for _ in range(REFINEMENTS):
        goal = PositionGoal(link, position, pitch)
        solutions = cell.kinematics.solve(group, goal, start, cell.current.options.seed)
        if not solutions:
            raise PlanningFailed(
                "NO_IK_SOLUTION",
                f"no joint positions put the held object at ({point[0]:.3f}, {point[1]:.3f},"
                f" {point[2]:.3f}) with the gripper pitched {np.degrees(pitch):.1f} degrees",
            )
        state = np.array(start)
        state[list(cell.description.group_indices(group))] = solutions[0]
        tcp = cell.kinematics.link_pose(cell.description.with_mimics(state), link)
        position = position + point - (tcp @ tcp_to_object).translation
    return position
