"""A MotionPlanRequest as a motion step: goals, group, scaling factors and start state."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.language.files.source import Located
from harness.plugins.formats.moveit_messages.values import (
    child,
    children,
    joint_positions,
    message_pose,
    quaternion,
    text,
)
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import rounded
from harness.plugins.formats.yaml_data import number, read_data, refuse
from harness.world.imported import Note

KEYS = ("goal_constraints", "start_state", "group_name")
IGNORED = ("path_constraints", "trajectory_constraints", "reference_trajectories")
LEFT_OUT = ("planner_id", "allowed_planning_time", "num_planning_attempts")
SCALING = ("max_velocity_scaling_factor", "max_acceleration_scaling_factor")


@dataclass(frozen=True, eq=False)
class MoveItRequest:
    """A MotionPlanRequest.

    Attributes:
        goals: Goals of a `move_to`; each set of constraints is one, and any may be reached.
        start: Joint positions at the start, by name, with their places; empty for the scene's.
        planning: Scaling factors of the scenario's `planning`.
    """

    group: str
    goals: tuple[dict[str, Any], ...]
    start: dict[str, tuple[float, Located]]
    planning: dict[str, float]
    notes: tuple[Note, ...]


def read_request(path: Path) -> MoveItRequest:
    """The request of a file.

    Raises:
        SpecError: It violates the message's format, or constrains the path; located.
    """
    root = read_data(path, KEYS, "MotionPlanRequest")
    notes = Notes()
    for key in IGNORED:
        found = child(root, key)
        if found is not None and _is_filled(found):
            refuse(found, f"`{key}` is not imported: the request means another motion without it")
    for key in LEFT_OUT:
        if (found := child(root, key)) is not None:
            notes.add(found.place, f"`{key}` is left out: the scenario's `planning` has its own")
    goals = tuple(_goal(item) for item in children(root, "goal_constraints"))
    if not goals:
        refuse(root, "a MotionPlanRequest has `goal_constraints`")
    state = child(root, "start_state")
    factors = {key: number(item) for key in SCALING if (item := child(root, key)) is not None}
    return MoveItRequest(
        group=text(root, "group_name"),
        goals=goals,
        start={} if state is None else joint_positions(state),
        planning={key: value for key, value in factors.items() if 0 < value <= 1},
        notes=notes.all(),
    )


def _is_filled(item: Located) -> bool:
    """Whether a message holds anything but empty lists and names."""
    if isinstance(item.value, dict):
        return any(_is_filled(entry.value) for entry in item.mapping().values())
    return bool(item.value)


def _goal(item: Located) -> dict[str, Any]:
    joints = {
        text(each, "joint_name"): _position(each) for each in children(item, "joint_constraints")
    }
    positions, turns = (children(item, f"{key}_constraints") for key in ("position", "orientation"))
    if joints and not positions and not turns:
        return {"joints": joints}
    if len(positions) != 1 or len(turns) > 1 or joints:
        refuse(item, "a goal is joint positions, or a position of a link and its orientation")
    return _pose_goal(positions[0], turns)


def _position(constraint: Located) -> float:
    value = child(constraint, "position")
    if value is None:
        refuse(constraint, "a joint constraint has a `position`")
    return number(value)


def _pose_goal(position: Located, turns: list[Located]) -> dict[str, Any]:
    """A pose or position of a link, with the tolerances of the constraints."""
    region = child(position, "constraint_region")
    poses = [] if region is None else children(region, "primitive_poses")
    sizes = [] if region is None else children(region, "primitives")
    radii = [number(value) for size in sizes for value in children(size, "dimensions")]
    if len(poses) != 1 or len(sizes) != 1 or not radii:
        refuse(position, "a position constraint has a `constraint_region` of one primitive")
    x, y, z = (rounded(value) for value in message_pose(poses[0]).translation)
    header = child(position, "header")
    place: dict[str, Any] = {"xyz": [x, y, z]}
    frame = "" if header is None else text(header, "frame_id").removeprefix("/")
    if frame:
        place["frame"] = frame
    tolerance: dict[str, Any] = {"position": min(radii)}
    goal: dict[str, Any] = {"position": place, "link": text(position, "link_name")}
    if turns:
        turned = child(turns[0], "orientation")
        quat = [0.0, 0.0, 0.0, 1.0] if turned is None else quaternion(turned)
        place["quat_xyzw"] = [rounded(value) for value in quat]
        axes = [child(turns[0], f"absolute_{axis}_axis_tolerance") for axis in "xyz"]
        tolerance["orientation"] = [0.0 if axis is None else number(axis) for axis in axes]
        goal = {"pose": place, "link": goal["link"]}
    return {**goal, "tolerance": tolerance}
