"""place: approach, lower, release, retreat, as Task Constructor's Place; each is recorded."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, group_of, task_space_of
from harness.cell.grasp_choice import Approach, GraspSearch, choose_approach, with_arm
from harness.cell.grasping import UP, gripper_axes, is_grasped_by_pitch
from harness.cell.program import ProgramStep
from harness.cell.scope import At
from harness.cell.step import Step
from harness.cell.supports import places_on
from harness.core.details import Detail
from harness.core.errors import StepFailed
from harness.core.geometry import Plane
from harness.core.pose_arrays import rotations_about
from harness.core.spatial import SE3, pitch_of
from harness.core.symmetry import equal_turns
from harness.core.types import FloatArray
from harness.language.base import Flag, Name
from harness.language.poses import Direction, Pose, Position
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.scene import Touch
from harness.recording.execution_failures import NotHeldFailure
from harness.recording.explanation import Explanation
from harness.recording.goal_failures import CollisionFailure, TouchRecord
from harness.steps._approach import (
    MAX_TURN,
    Travel,
    approach_steps,
    as_reached,
    check_travel,
    millimetres,
    relative_step,
    travel_lengths,
    turning_axis,
    world_pose_spec,
)
from harness.steps._tracker import check_track, tracker
from harness.steps.release import Release, refuse_other_holder

REFINEMENTS = 4  # rounds in which a pose and the joints that reach it settle
PUT_DOWN_GAP = 0.001  # [m] above the target, so that the support is touched when the fingers open
DEEPEST_OPENING = 0.002  # [m], of the opening gripper; deeper, nothing is put down
TURNS_OF_ROUND = 8  # tried about the vertical of what is round
DEFAULT_RETREAT = Travel(min_distance=0.03, max_distance=0.1)


@dataclass(frozen=True)
class TurnChoice(Detail):
    """How many turns of the object there are, and which of them was taken, from 1."""

    turns: int
    turn: int = 1


class Place(Step):
    """Approach, lower, release, retreat; expands into the steps it is made of.

    Where the arm cannot lower the object to a `pose` without a rotation, or not open its hand
    there, the object is also tried turned about the vertical, provided that it stands upright and
    looks the same after the turn: by half turns, square ones by quarters, round ones by eighths;
    the step reports which `turn` of how many `turns`.
    A `pose` with a rotation is kept to. With `on`, the place nearest to the middle of the support's
    top is taken that is free and that the arm can reach. An arm of fewer than six joints brings the
    object to the position alone, with the pitch that the gripper has: the object turns with the
    arm.
    """

    verb: ClassVar[str] = "place"
    results = (TurnChoice,)

    object: Name | None = Field(
        default=None,
        description="The name of the object; the default is the one that was picked last.",
    )
    pose: Pose | None = Field(
        default=None, description="The pose at which the object will stand; or `on`."
    )
    on: Name | None = Field(
        default=None,
        description="The object stands on the top of this one, upright, at the free place that is "
        "nearest to the middle.",
    )
    approach: Travel | None = Field(
        default=None,
        description="The approach; the default is straight down, 10 cm or as much as the arm can "
        "follow, at least 3 cm.",
    )
    retreat: Travel | None = Field(
        default=None, description="The retreat; the default is 3 to 10 cm back along the gripper."
    )
    track: Flag = Field(
        default=False,
        description="There is a belt or turntable under the place: the arm moves with its surface "
        "while it lowers the object by 5 cm and lets go.",
    )

    @model_validator(mode="after")
    def _one_place(self) -> Place:
        if (self.pose is None) == (self.on is None):
            raise ValueError("exactly one of `pose`, and `on` with the name of a support")
        return self

    @property
    def is_made_of_parts(self) -> bool:
        return not self.track

    def summary(self) -> str:
        return " on ".join(filter(None, (self.object or "", self.on)))

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`place`")
        if self.pose is not None:
            at.check_pose(self.pose, "pose")
        if self.object is not None:
            at.scope.check_object(self.object, at.key("object"))
        if self.on is not None:
            _check_support(self.on, self.object, at)
        check_travel(self.approach, at, "approach")
        check_travel(self.retreat, at, "retreat")
        check_track(self.track, at)
        group = at.scope.check_group(self.group, at.key("group"))
        known = group in at.scope.description.groups
        if self.track and known and not task_space_of(at.scope.description, group).holds_pose:
            at.scope.problems.add(
                at.key("track"),
                "an arm of fewer than six joints cannot keep the object's heading on a belt",
                "leave out `track`, and stop the belt with a `conveyor` step before",
            )
        name = self.object or next(reversed(at.scope.attached), None)
        if name is not None:
            at.scope.attached.pop(name, None)

    def execute(self, cell: Cell) -> None:
        """Go above the target, lower straight, release, retreat along the gripper's approach axis.

        Raises:
            StepFailed: INVALID_OBJECT_NAME, when the object is not held.
        """
        if not self.track:
            cell.run_parts(self.parts(cell))
            return
        name = self.object_placed(cell)
        up = Direction(xyz=(0, 0, 1))
        back = relative_step(self.retreat or DEFAULT_RETREAT, up, self.group)
        distance = back.distance or back.max_distance or 0.0
        targets, group = placings(name, self, cell), group_of(cell, self.group)
        tracker().place(name, targets, distance, group, cell)

    def object_placed(self, cell: Cell) -> str:
        """The name of the object that the step places."""
        held = cell.held_objects
        name = self.object or (held[-1] if held else None)
        if name is None or name not in cell.scene.attached():
            what = f"'{name}' is not held" if name else "nothing is held"
            raise StepFailed(
                "INVALID_OBJECT_NAME",
                f"{what}, so nothing can be placed",
                NotHeldFailure(name),
                Explanation(advice=f"put a step that takes it before: `- pick: {name or '...'}`"),
            )
        refuse_other_holder(name, cell)
        return name

    def parts(self, cell: Cell) -> Generator[ProgramStep]:
        name, backwards = self.object_placed(cell), _retreat_direction(cell)
        yield from _lowering(name, self, cell)
        yield cell.child("release", Release(object=name), f"release {name}")
        retreat = relative_step(self.retreat or DEFAULT_RETREAT, backwards, self.group)
        yield cell.child("retreat", retreat, "move_relative back")


def _check_support(name: str, held: str | None, at: At) -> None:
    """Report a support that is not there, or has no middle."""
    at.scope.check_present(name, at.key("on"))
    support, message = at.scope.objects.get(name), ""
    if name == held:
        message = f"'{name}' cannot stand on itself"
    elif support is not None and any(isinstance(each.geometry, Plane) for each in support.shapes):
        message = f"'{name}' has no middle that something could be put on"
    elif support is not None and not support.in_planning:
        message = f"'{name}' is unknown to the planner"
    if message:
        hint = (
            "give a place in its stead: `pose: {xyz: [X, Y, Z]}`, where the object's origin will be"
        )
        at.scope.problems.add(at.key("on"), message, hint)


def _lowering(name: str, step: Place, cell: Cell) -> list[ProgramStep]:
    """The free motion above the place, and the straight one down to it."""
    along = -UP
    if step.approach is not None and step.approach.direction is not None:
        along = cell.world_direction(step.approach.direction)
    targets = placings(name, step, cell)
    goals = [_tcp_goal(name, target, step, cell) for target in targets]
    approaches = [
        Approach(
            _tcp_goal(name, SE3(target.rotation, target.translation - length * along), step, cell),
            goal,
            number,
        )
        for length in travel_lengths(step.approach)
        for number, (target, goal) in enumerate(zip(targets, goals, strict=True))
    ]
    cell.report(TurnChoice(len(targets)))
    refused: list[Touch] = []
    search = GraspSearch(
        group_of(cell, step.group),
        cell.planning_start(),
        replace(cell.current.options, padding=0.0),
        may_end=lambda state: _can_open(state, refused, cell),
    )
    chosen = choose_approach(approaches, search, cell)
    least = max(refused, key=lambda touch: touch.distance, default=None)
    if least is not None and least.distance < -DEEPEST_OPENING:
        raise _no_room(name, least)
    cell.report(TurnChoice(len(targets), chosen.approach.number + 1))
    words = f"move_to above the place of {name}", "lower", f"lin {name}"
    reach, lower = approach_steps(chosen, step.group, words, cell)
    return [reach, replace(lower, options=replace(lower.options, padding=0.0))]


def placings(name: str, step: Place, cell: Cell) -> list[SE3]:
    """T_world_object of each way to put an object down, a little above its support."""
    stated = places_on(name, step.on, cell) if step.on else [cell.world_pose(_pose_of(step))]
    return [
        SE3(equal.rotation, equal.translation + PUT_DOWN_GAP * UP)
        for each in stated
        for equal in _equal_poses(name, each, step, cell)
    ]


def _can_open(state: FloatArray, refused: list[Touch], cell: Cell) -> bool:
    """Whether the open gripper touches nothing but what it holds; keeps the deepest pair if not."""
    touches = cell.scene.touches(cell.with_open_gripper(state))
    if touches:
        refused.append(touches[0])
        return False
    refused.clear()
    return True


def _no_room(name: str, touch: Touch) -> StepFailed:
    """Where the arm can put the object down, but not let go of it."""
    depth = millimetres(-touch.distance)
    return StepFailed(
        "GOAL_IN_COLLISION",
        f"the gripper has no room to open where '{name}' is put down: open, {touch.first} and"
        f" {touch.second} would be {depth} inside each other",
        CollisionFailure((TouchRecord((touch.first, touch.second), touch.distance),)),
        Explanation(
            advice=f"put it down farther from '{touch.second}', or where there is {depth} more room"
            " on that side of the gripper"
        ),
    )


def _pose_of(step: Place) -> Pose:
    if step.pose is None:
        raise ValueError("the model has a pose, or a support")
    return step.pose


def _equal_poses(name: str, stated: SE3, step: Place, cell: Cell) -> list[SE3]:
    """T_world_object of every way to put it there: as stated, then turned further and further.

    An arm of fewer than six joints turns the object as it reaches there: it has one way.
    """
    is_turned = step.pose is not None and step.pose.has_rotation
    if is_turned or not task_space_of(cell.description, step.group).holds_pose:
        return [stated]
    obj = cell.presence[name].obj
    count = equal_turns((*obj.shapes, *obj.visuals), stated.rotation) or TURNS_OF_ROUND
    turns = sorted(range(count), key=lambda turn: min(turn, count - turn))
    return [
        SE3(rotations_about(UP, 2 * math.pi * turn / count) @ stated.rotation, stated.translation)
        for turn in turns
    ]


def _retreat_direction(cell: Cell) -> Direction:
    """Against the gripper's approach axis, in the TCP's frame, so it is read when it is needed."""
    x, y, z = (-float(value) for value in gripper_axes(cell)[0])
    return Direction(xyz=(x, y, z), frame=cell.description.tcp_link)


def _tcp_goal(name: str, target: SE3, step: Place, cell: Cell) -> TcpGoal:
    """Where the TCP must be so that the held object, as the planner believes it, is at a pose."""
    start = cell.planning_start()
    tcp = cell.kinematics.link_pose(start, cell.description.tcp_link)
    tcp_to_object = tcp.inverse() @ cell.scene.object_pose(name, start)
    if task_space_of(cell.description, step.group).holds_pose:
        return TcpGoal(world_pose_spec(target @ tcp_to_object.inverse()))
    if is_grasped_by_pitch(cell, group_of(cell, step.group)):
        pitch = pitch_of(tcp.rotation)
        goal_at = partial(PositionGoal, cell.description.tcp_link, pitch=pitch)
        x, y, z = _tcp_position(target.translation, tcp_to_object, goal_at, step, cell)
        return TcpGoal(Position(xyz=(float(x), float(y), float(z))), pitch)
    axis = turning_axis(cell, step.group)

    def turned(position: FloatArray) -> PoseGoal:
        headings = [math.atan2(*(at - axis)[1::-1]) for at in (tcp.translation, position)]
        rotation = rotations_about(UP, headings[1] - headings[0]) @ tcp.rotation
        pose = SE3(rotation, position)
        return PoseGoal(cell.description.tcp_link, pose, orientation_tolerance=MAX_TURN)

    position = _tcp_position(target.translation, tcp_to_object, turned, step, cell)
    return as_reached(
        TcpGoal(world_pose_spec(turned(position).pose)), group_of(cell, step.group), cell
    )


def _tcp_position(
    point: FloatArray,
    tcp_to_object: SE3,
    goal_at: Callable[[FloatArray], PoseGoal | PositionGoal],
    step: Place,
    cell: Cell,
) -> FloatArray:
    """TCP position at which the object's origin is at a point, for arms that choose their own yaw.

    The yaw follows from the position, so the offset is corrected a few times from where the
    solution puts the object.
    """
    group, start = group_of(cell, step.group), cell.planning_start()
    link, position = cell.description.tcp_link, np.array(point)
    for _ in range(REFINEMENTS):
        goal, seed = goal_at(position), cell.current.options.seed
        solutions = cell.kinematics.solve(group, goal, start, seed)
        if not solutions:
            break  # the search for an approach explains it
        tcp = cell.kinematics.link_pose(with_arm(solutions[0], start, group, cell), link)
        position = position + point - (tcp @ tcp_to_object).translation
    return position
