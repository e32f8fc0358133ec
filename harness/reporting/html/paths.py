"""TCP paths of the replay: as recorded, as planned, and goals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.types import FloatArray, Floats
from harness.recording.explanation import recorded_explanation
from harness.recording.link_poses import planned_tcp_poses, replayed_link_poses
from harness.recording.plan_statistics import PlanStatistics
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.reporting.html.first_view import rounded
from harness.reporting.html.packing import Packer

TCP_POINTS = 1500  # of a drawn path: as many as a page has pixels across
PLAN_POINTS = 150  # of a planned path, which bends at few places


def pack_tcp_path(run: Run, packer: Packer) -> None:
    """Put the recorded path in, with its times."""
    rows = _spread(len(run.signals.times), TCP_POINTS)
    packer.add("tcp", run.signals.tcp_pose[rows, :3].astype(np.float32))
    packer.add("tcp.times", run.signals.times[rows].astype(np.float32))


def pack_plan(run: Run, step: StepRecord, index: int, packer: Packer) -> dict[str, Any]:
    """A step's planned TCP path, the path before shortening, and its goal, each if known."""
    poses = _planned_poses(run, step)
    found = _raw_poses(run, step)
    nearest = _nearest(run, step)
    goal = None if nearest is None else nearest["target"]
    if goal is None and poses is not None:
        goal = rounded(poses[-1])
    return {
        "plan": None if poses is None else packer.add(f"plan.{index}", _points(poses)),
        "rawPlan": None if found is None else packer.add(f"raw.{index}", _points(found)),
        "goal": goal,
        "nearest": nearest,
    }


def _planned_poses(run: Run, step: StepRecord) -> FloatArray | None:
    if step.trajectory is None:
        return None
    positions = step.trajectory.positions
    shown = positions[_spread(len(positions), PLAN_POINTS)]
    return planned_tcp_poses(run, step, step.trajectory.joint_names, shown)


def _raw_poses(run: Run, step: StepRecord) -> FloatArray | None:
    """Poses along the path as the search found it, in straight lines between its waypoints."""
    plan = step.planner.find(PlanStatistics)
    if plan is None or not plan.raw_path or step.trajectory is None:
        return None
    names = step.trajectory.joint_names
    if len(plan.raw_path) < 2 or any(len(row) != len(names) for row in plan.raw_path):
        return None
    waypoints = np.array(plan.raw_path)
    places = np.linspace(0, len(waypoints) - 1, PLAN_POINTS)
    before = np.minimum(places.astype(int), len(waypoints) - 2)
    share = (places - before)[:, None]
    between = (1 - share) * waypoints[before] + share * waypoints[before + 1]
    return planned_tcp_poses(run, step, names, between)


def _nearest(run: Run, step: StepRecord) -> dict[str, Any] | None:
    """The state that explains a failure: the whole robot there, and how far it is from the goal."""
    nearest = recorded_explanation(step.explanation).nearest
    names = run.robot.joint_names
    if nearest is None or not set(names) <= set(nearest.joint_positions):
        return None
    row = np.array([[nearest.joint_positions[name] for name in names]])
    poses = replayed_link_poses(run.robot, row, [*run.robot.link_visuals, run.robot.tcp_link])
    return {
        "shows": nearest.shows,
        "bodies": {name: rounded(pose[0]) for name, pose in poses.items()},
        "place": _numbers(nearest.pose, 7),
        "target": _target(nearest.target),
    }


def explained_points(plans: Sequence[Mapping[str, Any]]) -> list[list[float]]:
    """Where the states that explain failures have the robot's links, and their goals."""
    states = [plan["nearest"] for plan in plans if plan["nearest"] is not None]
    poses = [pose for each in states for pose in (*each["bodies"].values(), each["target"])]
    return [pose[:3] for pose in poses if pose is not None]


def _target(target: Floats | None) -> list[float] | None:
    """The target of a link: a pose, or a point without an orientation."""
    pose, point = _numbers(target, 7), _numbers(target, 3)
    return pose or (None if point is None else [*point, 1.0, 0.0, 0.0, 0.0])


def _numbers(values: Floats | None, count: int) -> list[float] | None:
    if values is None or len(values) != count:
        return None
    array = np.array(values)
    return rounded(array) if np.isfinite(array).all() else None


def _spread(count: int, most: int) -> np.ndarray[Any, Any]:
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(int))


def _points(poses: FloatArray) -> np.ndarray[Any, Any]:
    return poses[:, :3].astype(np.float32)
