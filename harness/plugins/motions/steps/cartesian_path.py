"""cartesian_path: straight lines through waypoints, as far as they can be followed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import group_of, link_limits, resolve_goal
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.errors import PlanningFailed
from harness.language.base import Angle, Fraction, Length, Name, PositiveLength, SpecModel
from harness.language.goals import CartesianLimitsSpec, GoalFields
from harness.language.poses import Pose, Position
from harness.ports.goals import JointGoal, PoseGoal, PositionGoal
from harness.ports.motions import CartesianPathOptions, WaypointMotion
from harness.ports.motions import JumpThreshold as PlannedJumpThreshold
from harness.recording.step_results import CartesianPathResult


class JumpThresholdSpec(SpecModel):
    """Largest joint step between neighbouring waypoints."""

    revolute: Annotated[Angle, Field(gt=0)] = Field(
        default=0.5, description="A revolute joint steps by at most this angle [rad]."
    )
    prismatic: PositiveLength = Field(
        default=0.1, description="A prismatic joint steps by at most this length [m]."
    )


class Waypoint(Pose):
    """A pose; without a rotation the link keeps its orientation."""


class CartesianPath(Step):
    """Move the link on straight lines through waypoints: MoveIt's computeCartesianPath.

    Corners are rounded within the precision, so that the link need not stop there. The step reports
    the `fraction` of the path that was followed, the `largest_joint_step` from one pose to the
    next, and the `deviation` of the final samples from the lines.
    """

    verb: ClassVar[str] = "cartesian_path"
    synonyms = ("follow_path", "follow_trajectory", "compute_cartesian_path")
    moves_arm: ClassVar[bool] = True
    has_corners: ClassVar[bool] = True

    waypoints: Annotated[tuple[Waypoint, ...], Field(min_length=1, max_length=1000)] = Field(
        description="The link passes through these poses in order; without a rotation it keeps its "
        "orientation."
    )
    link: Name | None = Field(
        default=None, description="The link that follows the path; the default is the TCP."
    )
    max_step: Annotated[Length, Field(ge=1e-4)] = Field(
        default=0.005,
        description="Inverse kinematics is solved at poses at most this far apart [m].",
    )
    precision: Annotated[Length, Field(ge=1e-4)] = Field(
        default=0.001,
        description="The path deviates at most this far from the straight lines, corners included "
        "[m].",
    )
    min_fraction: Fraction = Field(
        default=1.0, description="The step fails when a smaller share of the path can be followed."
    )
    jump_threshold: JumpThresholdSpec = Field(
        default=JumpThresholdSpec(),
        description="The path ends where a joint jumps by more than this.",
    )
    cartesian_limits: CartesianLimitsSpec | None = Field(
        default=None, description="Limits of the link's speed and acceleration along the path."
    )

    def summary(self) -> str:
        count = len(self.waypoints)
        return f"through {count} waypoint" + ("" if count == 1 else "s")

    def check(self, at: At) -> None:
        at.scope.check_group(self.group, at.key("group"))
        at.scope.check_link_or_held(self.link, at.key("link"))
        for index, waypoint in enumerate(self.waypoints):
            at.check_pose(waypoint, "waypoints", index)

    def execute(self, cell: Cell) -> None:
        """Follow the lines; record the followed share, the joint steps and the deviation."""
        cell.sync_scene()
        group = group_of(cell, self.group)
        goals = [_goal(waypoint, self.link, group, cell) for waypoint in self.waypoints]
        jump = PlannedJumpThreshold(self.jump_threshold.revolute, self.jump_threshold.prismatic)
        path = CartesianPathOptions(self.max_step, self.precision, self.min_fraction, jump)
        options = replace(cell.current.options, cartesian_limits=link_limits(self.cartesian_limits))
        try:
            cell.move(group, WaypointMotion(goals, path), options)
        except PlanningFailed as failure:
            followed = failure.details.find(CartesianPathResult)
            if followed is not None:
                cell.report(replace(followed, min_fraction=None))
            raise


def _goal(waypoint: Waypoint, link: str | None, group: str, cell: Cell) -> PoseGoal | PositionGoal:
    """The waypoint in the world; without a rotation the link keeps its orientation."""
    if waypoint.rpy is None and waypoint.quat_xyzw is None and waypoint.quat_wxyz is None:
        position = Position(xyz=waypoint.xyz, frame=waypoint.frame)
        fields = GoalFields(position=position, link=link)
    else:
        fields = GoalFields(pose=waypoint, link=link)
    goal = resolve_goal(fields, group, cell)
    if isinstance(goal, JointGoal):
        raise TypeError("a waypoint is a pose")
    return goal
