"""pick: approach, grasp, lift, as Task Constructor's Pick; the steps it is made of are recorded."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.closing import closing_obstacles
from harness.cell.goals import TcpGoal, group_of, task_space_of
from harness.cell.grasp_choice import (
    Approach,
    ChosenApproach,
    GraspSearch,
    choose_approach,
)
from harness.cell.grasping import (
    check_opening,
    grasp_points,
    grasps_at_pitches,
    gripper_axes,
    has_simple_shape,
    is_grasped_by_pitch,
    top_grasps,
    top_grasps_at,
)
from harness.cell.program import ProgramStep
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.base import Angle, Flag, Name
from harness.language.poses import Direction, Pose, Position
from harness.recording.explanation import ApproachFailure
from harness.steps._approach import (
    Travel,
    approach_steps,
    as_reached,
    check_travel,
    relative_step,
    travel_lengths,
    turning_axis,
    world_pose_spec,
)
from harness.steps._tracker import check_track, tracker
from harness.steps.grasp import Grasp, GripperAction, HoldingEffort, check_graspable
from harness.steps.gripper import Gripper
from harness.steps.move_relative import MoveRelative

PITCHES = [math.radians(degrees) for degrees in (0, 15, 30, 45, 60, 75, 90)]
"""Of the gripper of an arm of fewer than six joints, in the order in which they are tried."""


STRAIGHT = 89.5  # [degrees], with the horizontal, from which an approach is straight down, or up


APPROACH_IN_MOTION = Travel(min_distance=0.03, max_distance=0.05)  # shorter: the object moves on


@dataclass(frozen=True)
class GraspChoice(Detail):
    """How many grasps there are, and which of them was taken, from 1."""

    grasps: int
    grasp: int = 1


class Pick(Step):
    """Approach, grasp, lift; expands into the steps it is made of.

    Without a `grasp_pose` the object's shape gives the grasps from above that are as good as each
    other: half a turn of the gripper, a box's other side if it fits, eight turns about what is
    round; a mesh, or several shapes, are taken as the box around them. With a `grasp_pose` that has
    no rotation the same rotations are tried at its point. The first grasp that the arm can
    reach, approach, and lift from, is taken, in the posture for which this was verified; the step
    reports which `grasp` of how many `grasps`.

    An arm of fewer than six joints turns to the object by itself: it grasps the middle of the
    object, or its upper part, with the first pitch of the gripper that works, from level (0) to
    straight down (90 deg); `pitch` states one. It is the pitch of the approach axis, which leads
    from the gripper's palm to its pads; `harness robot check` prints it.

    The planner's `padding` does not apply between the gripper and the object to grasp.

    With `track: true` the object may move on a belt or a turntable. The step predicts where that
    carries it, chooses the first moment at which the arm can be there, waits for it, matches its
    velocity while it approaches, moves with it while the fingers close from a little wider than
    the object, and comes to rest while it lifts. The grasp is verified after the lift.
    """

    short = "object"

    verb: ClassVar[str] = "pick"
    synonyms = ("pick_and_place", "pickup", "pick_up")
    results = (GraspChoice,)

    object: Name = Field(description="The name of the object.")
    grasp_pose: Pose | None = Field(
        default=None,
        description="The pose of the TCP at the grasp, or its position alone; the default follows "
        "from the object's shape.",
    )
    pitch: Angle | None = Field(
        default=None,
        description="The angle of the gripper below the horizontal, for arms of fewer than six "
        "joints; the default is the first of 0 to 90 deg that works.",
    )
    approach: Travel | None = Field(
        default=None,
        description="The approach; the default is along the gripper, 10 cm or as much as the arm "
        "can follow, at least 3 cm.",
    )
    lift: Travel | None = Field(
        default=None, description="The lift after the grasp; the default is 10 cm up."
    )
    mode: GripperAction = "friction"
    max_effort: HoldingEffort = None
    track: Flag = Field(
        default=False,
        description="The object moves on a belt or turntable: the arm meets it, moves with it while"
        " the gripper closes, and lifts it.",
    )

    @model_validator(mode="after")
    def _one_rotation(self) -> Pick:
        if self.pitch is not None and self.grasp_pose is not None and self.grasp_pose.has_rotation:
            raise ValueError(
                "`pitch` goes with a `grasp_pose` without rotation; this one has its own rotation"
            )
        return self

    @property
    def is_made_of_parts(self) -> bool:
        return not self.track

    def summary(self) -> str:
        return self.object

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`pick`")
        check_graspable(self.object, at, self.mode, by_all_cups=self.grasp_pose is None)
        at.scope.check_no_fixture(self.object, at.key("object"))
        if self.grasp_pose is not None:
            at.check_pose(self.grasp_pose, "grasp_pose")
        group = at.scope.check_group(self.group, at.key("group"))
        known = group in at.scope.description.groups
        if (
            self.pitch is not None
            and known
            and task_space_of(at.scope.description, group).holds_pose
        ):
            at.scope.problems.add(
                at.key("pitch"),
                "`pitch` is for arms of fewer than six joints, and this one reaches any rotation",
                "give a `grasp_pose` with a rotation: `rpy`, `quat_xyzw` or `quat_wxyz`",
            )
        check_travel(self.approach, at, "approach")
        check_travel(self.lift, at, "lift")
        check_track(self.track, at)
        at.scope.attached[self.object] = None

    def execute(self, cell: Cell) -> None:
        """Open, go to where the approach begins, approach straight, grasp, lift."""
        if not self.track:
            cell.run_parts(self.parts(cell))
            return
        step = self.model_copy(update={"approach": self.approach or APPROACH_IN_MOTION})
        lift = self._lift()
        tracker().pick(self._grasp(), lift, lambda: chosen_approach(step, lift, cell), cell)

    def _grasp(self) -> Grasp:
        return Grasp(object=self.object, mode=self.mode, max_effort=self.max_effort)

    def _lift(self) -> MoveRelative:
        return relative_step(self.lift, Direction(xyz=(0, 0, 1)), self.group)

    def parts(self, cell: Cell) -> Generator[ProgramStep]:
        lift = self._lift()
        open_hand = Gripper(position=cell.gripper.open_position, max_effort=cell.gripper.max_effort)
        words = f"move_to before {self.object}", "approach", f"lin to {self.object}"
        with cell.unpadded_gripper(self.object):
            opening = cell.child("open", open_hand, "gripper open")
            approach = approach_steps(chosen_approach(self, lift, cell), self.group, words, cell)
            yield from (opening, *approach)
            yield cell.child("grasp", self._grasp(), f"grasp {self.object}")
            yield cell.child("lift", lift, f"move_relative lift {self.object}")


def chosen_approach(step: Pick, lift: MoveRelative, cell: Cell) -> ChosenApproach:
    """The approach to the object where it stands.

    Raises:
        PlanningFailed: There is none; explains the one that is nearest to being possible.
    """
    goals = grasp_goals(step, cell)
    group, axis = group_of(cell, step.group), gripper_axes(cell)[0]
    approaches = [
        Approach(as_reached(back_off(goal, length, step, axis, cell), group, cell), goal, number)
        for length in travel_lengths(step.approach)
        for number, goal in enumerate(goals)
    ]
    cell.report(GraspChoice(len(goals)))
    search = GraspSearch(
        group,
        cell.with_open_gripper(cell.planning_start()),
        cell.current.options,
        then=lambda state: (
            not closing_obstacles(step.object, state, cell) and _can_lift(lift, state, cell)
        ),
    )
    try:
        chosen = choose_approach(approaches, search, cell)
    except PlanningFailed as failure:
        message = failure.message + approach_words(failure)
        raise PlanningFailed(failure.code, message, *failure.details) from failure
    cell.report(GraspChoice(len(goals), chosen.approach.number + 1))
    return chosen


def _can_lift(lift: MoveRelative, state: FloatArray, cell: Cell) -> bool:
    """Whether the arm can make the straight move after the grasp from joint positions."""
    if lift.direction is None or lift.direction.frame != "world":
        return True  # the direction depends on where the grasp leaves the frame
    try:
        lift.plan(state, replace(cell.current.options, path_only=True), cell)
    except PlanningFailed:
        return False
    return True


def approach_words(failure: PlanningFailed) -> str:
    """`, approached 30° below the horizontal`; empty for a failure without an approach."""
    approach = failure.details.find(ApproachFailure)
    if approach is None or approach.approach_direction is None:
        return ""
    down = -math.degrees(math.asin(min(1.0, max(-1.0, approach.approach_direction[2]))))
    if abs(down) > STRAIGHT:
        return f", approached straight {'down' if down > 0 else 'up'}"
    if abs(down) < 90 - STRAIGHT:
        return ", approached horizontally"
    return f", approached {abs(down):.0f}° {'below' if down > 0 else 'above'} the horizontal"


def grasp_goals(step: Pick, cell: Cell) -> list[TcpGoal]:
    """Where the TCP may be to grasp: poses, or position and pitch for arms of fewer joints."""
    given = None if step.grasp_pose is None else cell.world_pose(step.grasp_pose)
    if given is not None and step.grasp_pose is not None and step.grasp_pose.has_rotation:
        return [TcpGoal(world_pose_spec(given))]
    obj, object_pose = cell.presence[step.object].obj, cell.frame(step.object)
    if task_space_of(cell.description, step.group).holds_pose:
        poses = (
            top_grasps(obj, object_pose, cell)
            if given is None
            else top_grasps_at(given.translation, obj, object_pose, cell)
        )
        return [TcpGoal(world_pose_spec(pose)) for pose in poses]
    if given is None or has_simple_shape(obj):
        check_opening(obj, object_pose, cell)
    points = grasp_points(obj, object_pose, cell) if given is None else [given.translation]
    pitches = PITCHES if step.pitch is None else [step.pitch]
    group = group_of(cell, step.group)
    if not is_grasped_by_pitch(cell, group):
        axis = turning_axis(cell, step.group)
        return [
            as_reached(TcpGoal(world_pose_spec(pose)), group, cell)
            for point in points
            for pose in grasps_at_pitches(point, obj, pitches, axis, cell)
        ]
    return [
        TcpGoal(Position(xyz=(float(x), float(y), float(z))), pitch)
        for x, y, z in points
        for pitch in pitches
    ]


def back_off(target: TcpGoal, distance: float, step: Pick, axis: FloatArray, cell: Cell) -> TcpGoal:
    """The goal moved back against the approach direction [m]; `axis` is the gripper's, (3,)."""
    along = None
    if step.approach is not None and step.approach.direction is not None:
        along = cell.world_direction(step.approach.direction)
    if isinstance(target.target, Pose):
        at = target.target.se3()
        if along is None:
            along = at.rotation @ axis
        return TcpGoal(world_pose_spec(SE3(at.rotation, at.translation - distance * along)))
    point, pitch = np.array(target.target.xyz), float(target.pitch or 0.0)
    if along is None:
        away = point - turning_axis(cell, step.group)
        heading = math.atan2(away[1], away[0])
        level = math.cos(pitch)
        along = np.array([level * math.cos(heading), level * math.sin(heading), -math.sin(pitch)])
    x, y, z = (float(value) for value in point - distance * along)
    return TcpGoal(Position(xyz=(x, y, z)), pitch)
