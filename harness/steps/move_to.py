"""move_to: plan a collision-free motion, then follow it."""

from __future__ import annotations

from itertools import product
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goal_checks import check_goal
from harness.cell.goals import group_of, pose_goal, resolve_goal
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.amounts import JointUnits
from harness.language.base import Name
from harness.language.goals import GOAL_KEYS, GoalFields
from harness.language.plugin_field import KeyModel, PluginModel
from harness.language.poses import Pose
from harness.ports.goals import AnyGoal, JointGoal, PathConstraints
from harness.ports.motions import FreeMotion
from harness.robot.description import ALL_ARMS

MOST_WAYS = 8  # pairs of solutions of both arms that are planned to, least joint motion first


class ConstraintsKey(KeyModel):
    """What holds along a motion."""

    def check(self, group: str | None, at: At) -> None:
        """Report names that the robot or the scene does not have."""
        raise NotImplementedError

    def resolved(self, cell: Cell) -> PathConstraints:
        """The constraints in the world, for the present state of the cell."""
        raise NotImplementedError


class MoveTo(GoalFields, Step):
    """Plan a collision-free motion to a goal, then execute it.

    Where joint positions can be chosen (branches of a pose, several goals, a region), those are
    taken that the arm reaches with the least motion.
    """

    verb: ClassVar[str] = "move_to"
    synonyms = (
        "move",
        "go",
        "goto",
        "go_to",
        "movej",
        "move_j",
        "set_named_target",
        "set_pose_target",
    )
    moves_arm: ClassVar[bool] = True
    one_of = (*GOAL_KEYS, "any_of", "poses")

    any_of: Annotated[tuple[GoalFields, ...], Field(min_length=1, max_length=100)] | None = Field(
        default=None,
        description="The motion goes to the one of these goals that is cheapest to reach.",
    )
    poses: Annotated[dict[Name, Pose], Field(min_length=1)] | None = Field(
        default=None,
        description="The goal is a pose of the TCP of each of these arms, which begin and end "
        "together; the arms' names are the keys. The default `group` is that of all arms.",
    )
    path_constraints: Annotated[ConstraintsKey, PluginModel("path_constraints")] | None = Field(
        default=None, description="Constraints that hold at every sample of the motion."
    )

    def summary_in(self, units: JointUnits) -> str:
        if self.any_of is not None:
            return "any of " + ", ".join(goal.summary_in(units) for goal in self.any_of)
        if self.poses is not None:
            return ", ".join(f"{arm} to {pose.place()}" for arm, pose in self.poses.items())
        return super().summary_in(units)

    def check(self, at: At) -> None:
        if self.poses is not None:
            self._check_poses(self.poses, at)
            return
        check_goal(self, self.group, at)
        for index, goal in enumerate(self.any_of or ()):
            check_goal(goal, self.group, At(at.scope, at.key("any_of", index)))
        if self.path_constraints is not None:
            self.path_constraints.check(self.group, at)

    def _check_poses(self, poses: dict[str, Pose], at: At) -> None:
        """Report names of no arm, arms outside the group, and frames that do not exist."""
        description = at.scope.description
        group = at.scope.check_group(self.group or ALL_ARMS, at.key("group"))
        for arm, pose in poses.items():
            place = at.key("poses", arm)
            at.scope.check_frame(pose.frame, (*place, "frame"))
            if arm not in description.of_arm:
                at.scope.problems.unknown(
                    place, "arm", arm, description.of_arm, is_key=True, needs=("robot",)
                )
            elif not {*description.group_joints(arm)} <= {*description.group_joints(group)}:
                message = f"the joints of '{arm}' are not in the group '{group}'"
                at.scope.problems.add(place, message, needs=("robot",))
        if self.path_constraints is not None:
            self.path_constraints.check(group, at)

    def execute(self, cell: Cell) -> None:
        """Plan from where the arm stands to the goal, time the path, track it."""
        cell.sync_scene()
        constraints = None
        if self.path_constraints is not None:
            constraints = self.path_constraints.resolved(cell)
        if self.poses is not None:
            group = self.group or ALL_ARMS
            cell.move(group, FreeMotion(_goal_of_arms(self.poses, group, cell), constraints))
            return
        group = group_of(cell, self.group)
        goals = tuple(resolve_goal(goal, group, cell) for goal in self.any_of or (self,))
        goal = goals[0] if self.any_of is None else AnyGoal(goals)
        cell.move(group, FreeMotion(goal, constraints))


def _goal_of_arms(poses: dict[str, Pose], group: str, cell: Cell) -> AnyGoal:
    """Joint positions of a group at which the TCP of each arm is at its pose, nearest first.

    Raises:
        PlanningFailed: NO_IK_SOLUTION and others, of the first arm that cannot reach its pose.
    """
    start, robot = cell.planning_start(), cell.robot
    names = robot.group_joints(group)
    ways: list[list[dict[str, float]]] = []
    for arm, pose in poses.items():
        goal = pose_goal(pose, robot.of_arm[arm].tcp_link, None, cell)
        request = cell.motion(arm, FreeMotion(goal))
        solutions = cell.kinematics.solve(arm, goal, start, request.options.seed)
        if not solutions:  # says why
            cell.planner.check_goal(request)
        joints = robot.group_joints(arm)
        ways.append([dict(zip(joints, each.tolist(), strict=True)) for each in solutions])
    rest = {name: float(start[robot.joint_index[name]]) for name in names}
    goals = [{**rest, **{k: v for way in several for k, v in way.items()}}
             for several in product(*(each[:MOST_WAYS] for each in ways))]  # fmt: skip
    goals.sort(key=lambda goal: round(sum(abs(goal[name] - rest[name]) for name in names), 9))
    return AnyGoal(
        tuple(JointGoal(np.array([goal[name] for name in names])) for goal in goals[:MOST_WAYS])
    )
