"""Straight moves of a pick or place: their lengths and directions, and why there is none."""

from __future__ import annotations

import math
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.goals import TcpGoal, group_of, task_space_of
from harness.cell.grasp_choice import ChosenApproach, with_arm
from harness.cell.program import ProgramStep
from harness.cell.scope import At
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.base import PositiveLength, SpecModel
from harness.language.poses import Direction, Pose
from harness.ports.goals import PoseGoal
from harness.steps.lin import Lin
from harness.steps.move_relative import MoveRelative, check_lengths
from harness.steps.move_to import MoveTo

DEFAULT_TRAVEL = 0.1  # [m]
SHORTEST_TRAVEL = 0.03  # [m]
TRAVELS = 3  # lengths of an approach that are tried where the file leaves a choice
MAX_TURN = math.radians(15)  # [rad], off the direction to an object, for an arm of few joints


class Travel(SpecModel):
    """A straight move of a pick or place."""

    direction: Direction | None = Field(
        default=None, description="The direction of the move; the default depends on the step."
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

    @model_validator(mode="after")
    def _one_length(self) -> Self:
        check_lengths(self.distance, self.min_distance, self.max_distance)
        return self


def check_travel(travel: Travel | None, at: At, key: str) -> None:
    """Report a travel's frame that does not exist."""
    if travel is not None and travel.direction is not None:
        at.scope.check_frame(travel.direction.frame, at.key(key, "direction", "frame"))


def travel_lengths(travel: Travel | None) -> list[float]:
    """Lengths of an approach to try, longest first [m]: the stated one, or several of a range."""
    if travel is not None and travel.distance is not None:
        return [travel.distance]
    most = (travel and travel.max_distance) or DEFAULT_TRAVEL
    least = (travel and travel.min_distance) or min(SHORTEST_TRAVEL, most)
    most = max(most, least)
    return [float(length) for length in np.linspace(most, least, TRAVELS)]


def relative_step(travel: Travel | None, default: Direction, group: str | None) -> MoveRelative:
    """The straight move of a travel."""
    travel = travel or Travel()
    direction = travel.direction or default
    if travel.distance is not None or (travel.min_distance, travel.max_distance) == (None, None):
        return MoveRelative(
            direction=direction, distance=travel.distance or DEFAULT_TRAVEL, group=group
        )
    most = travel.max_distance or travel.min_distance
    return MoveRelative(
        direction=direction, min_distance=travel.min_distance, max_distance=most, group=group
    )


def approach_steps(
    chosen: ChosenApproach, group: str | None, words: tuple[str, str, str], cell: Cell
) -> list[ProgramStep]:
    """The free motion to where an approach begins, and the straight one to its end.

    Args:
        words: The summary of the first, the name of the second, and its summary.
    """
    reach = MoveTo(**chosen.reach_keys, group=group)
    lin = Lin(**chosen.approach.at.keys, group=group)
    return [cell.child("reach", reach, words[0]), cell.child(words[1], lin, words[2])]


def as_reached(goal: TcpGoal, group: str, cell: Cell) -> TcpGoal:
    """A pose goal with the heading that an arm of few joints has there; other goals as they are."""
    if not isinstance(goal.target, Pose) or task_space_of(cell.description, group).holds_pose:
        return goal
    link, pose = cell.description.tcp_link, goal.target.se3()
    start, near = cell.planning_start(), PoseGoal(link, pose, orientation_tolerance=MAX_TURN)
    for positions in cell.kinematics.solve(group, near, start, cell.current.options.seed, enough=1):
        reached = cell.kinematics.link_pose(with_arm(positions, start, group, cell), link)
        return TcpGoal(world_pose_spec(SE3(reached.rotation, pose.translation)))
    return goal


def turning_axis(cell: Cell, group: str | None) -> FloatArray:
    """A point on the axis about which the arm turns to a heading: its first joint's, shape (3,)."""
    first = cell.description.groups[group_of(cell, group)].joint_names[0]
    return cell.frame(cell.description.joint_by_name[first].child).translation


def world_pose_spec(pose: SE3) -> Pose:
    """A pose in the world as a file would write it."""
    x, y, z = (float(value) for value in pose.translation)
    qw, qx, qy, qz = (float(value) for value in pose.quat_wxyz)
    return Pose(xyz=(x, y, z), quat_wxyz=(qw, qx, qy, qz))


def millimetres(metres: float) -> str:
    """`58.1 mm`."""
    return f"{1000 * metres:.1f} mm"
