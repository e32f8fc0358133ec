"""What the plots can show: recorded signals and what follows from them, in units people use."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.core.pose_arrays import compose
from harness.core.types import FloatArray
from harness.recording.link_poses import link_poses
from harness.recording.run import GripperRecord, JointRecord, Run, Verdict
from harness.reporting.html.extremes import pack, thin
from harness.reporting.html.packing import Packer

MOST_SERIES = 10
STRETCHES_PER_SECOND, FEWEST_STRETCHES, MOST_STRETCHES = 40, 600, 3000
LEAST = {
    "position": 1.0, "velocity": 1.0, "effort": 1.0, "gripper_effort": 1.0, "tracking": 0.02,
    "gripper": 1.0, "clearance": 1.0, "contact": 0.1, "slip": 0.1, "tcp": 1.0, "tcp_speed": 1.0,
    "height": 1.0, "displacement": 1.0, "command": 1.0, "plain_velocity": 0.1,
    "plain_effort": 0.01,
}  # fmt: skip
"""Group -> smallest range of values that its plot shows, in its unit: less is noise."""
NEAR_LIMIT = 0.4
"""Share of a limit that is used before the plot makes room to show it."""


@dataclass(frozen=True, eq=False)
class Limit:
    """A dashed line.

    Attributes:
        series: Whose limit it is; None for everybody's.
    """

    value: float
    series: int | None = None


@dataclass(frozen=True, eq=False)
class Group:
    """Series of one plot, shape (samples,) each."""

    id: str
    title: str
    unit: str
    series: Mapping[str, FloatArray]
    limits: Sequence[Limit] = field(default_factory=list[Limit])


def pack_groups(run: Run, verdicts: Sequence[Verdict], packer: Packer) -> list[dict[str, Any]]:
    """Put every group into the page's data."""
    times = run.signals.times
    duration = float(times[-1])
    stretches = int(min(MOST_STRETCHES, max(FEWEST_STRETCHES, duration * STRETCHES_PER_SECOND)))
    timestep = duration / (len(times) - 1) if len(times) > 1 else run.timestep
    packed: list[dict[str, Any]] = []
    for group in groups_of(run, verdicts):
        columns = np.array([np.asarray(values, dtype=float) for values in group.series.values()])
        thinned = thin(columns, stretches)
        spans = pack(thinned, group.id, packer)
        packed.append(
            {
                "id": group.id,
                "title": group.title,
                "unit": group.unit,
                "least": LEAST[group.id],
                "points": thinned.values.shape[1],
                "bin": thinned.bin,
                "timestep": timestep,
                "start": float(times[0]),
                "series": [
                    {"name": name, **span} for name, span in zip(group.series, spans, strict=True)
                ],
                "limits": [_limit(limit, spans) for limit in group.limits],
            }
        )
    return packed


def _limit(limit: Limit, spans: Sequence[Mapping[str, float]]) -> dict[str, Any]:
    mine = spans if limit.series is None else [spans[limit.series]]
    peak = max(max(abs(s["low"]), abs(s["low"] + s["size"])) for s in mine)
    stretches = limit.series is None and peak >= NEAR_LIMIT * abs(limit.value)
    return {"value": limit.value, "series": limit.series, "stretches": stretches}


def groups_of(run: Run, verdicts: Sequence[Verdict] = ()) -> Iterator[Group]:
    """Every group that has something to show, the usual ones first."""
    makers: Sequence[Callable[[Run], Group | None]] = (
        _positions, _velocities, _efforts, _tracking, _gripper, _clearances, _contacts, _slip,
        _tcp_position, _tcp_speed, _heights, _displacements, _gripper_effort, _commands,
        _plain_velocities, _plain_efforts,
    )  # fmt: skip
    for make in makers:
        group = make(run)
        if group is not None and group.series:
            yield _with_expected(group, verdicts)


EXPECTED = {
    "clearance": ("clearance", 1e3),
    "tracking": ("tracking error", 180 / math.pi),
    "slip": ("slip in the hand", 1e3),
    "effort": ("effort", 100.0),
    "height": ("height gained", 1e3),
}
"""Group -> name of the measures whose limits it shows, and the factor to the plot's unit."""


def _with_expected(group: Group, verdicts: Sequence[Verdict]) -> Group:
    """A group with the limits that the scenario's expectations set."""
    name, factor = EXPECTED.get(group.id, ("", 1.0))
    found = {
        factor * measure.limit
        for verdict in verdicts
        for measure in verdict.measures
        if measure.name == name and math.isfinite(measure.limit) and measure.limit
        and not (group.id == "effort" and measure.unit != "1")
    }  # fmt: skip
    both = {-value for value in found} if group.id in {"tracking", "effort"} else set[float]()
    extra = [Limit(value) for value in sorted(found | both)]
    return Group(group.id, group.title, group.unit, group.series, [*group.limits, *extra])


def _arm(run: Run) -> list[tuple[int, JointRecord]]:
    """Columns and records of the arm's joints; of all of them where no group is the arm's."""
    names = run.robot.groups.get(run.robot.arm_group) or [j.name for j in run.robot.joints]
    return [(i, joint) for i, joint in enumerate(run.robot.joints) if joint.name in names]


def _angle_unit(joints: Sequence[tuple[int, JointRecord]]) -> str:
    kinds = {joint.kind == "prismatic" for _, joint in joints}
    return {frozenset({True}): "mm", frozenset({False}): "°"}.get(frozenset(kinds), "° or mm")


def _factor(joint: JointRecord) -> float:
    return 1e3 if joint.kind == "prismatic" else 180 / math.pi


def _joint_series(run: Run, array: FloatArray) -> dict[str, FloatArray]:
    return {joint.name: _factor(joint) * array[:, column] for column, joint in _arm(run)}


def _positions(run: Run) -> Group:
    limits = [
        Limit(_factor(joint) * value, number)
        for number, (_, joint) in enumerate(_arm(run))
        for value in (joint.lower, joint.upper)
        if math.isfinite(value)
    ]
    series = _joint_series(run, run.signals.joint_positions)
    return Group("position", "joint position", _angle_unit(_arm(run)), series, limits)


def _commands(run: Run) -> Group:
    series = _joint_series(run, run.signals.joint_commands)
    return Group("command", "commanded position", _angle_unit(_arm(run)), series)


def _of_limit(run: Run, array: FloatArray, limit: str) -> dict[str, FloatArray]:
    return {
        joint.name: 100 * array[:, column] / getattr(joint, limit)
        for column, joint in _arm(run)
        if 0 < getattr(joint, limit) < math.inf
    }


def _velocities(run: Run) -> Group:
    series = _of_limit(run, run.signals.joint_velocities, "velocity")
    return Group("velocity", "velocity", "% of limit", series, [Limit(-100.0), Limit(100.0)])


def _efforts(run: Run) -> Group:
    series = _of_limit(run, run.signals.joint_efforts, "effort")
    return Group("effort", "effort", "% of limit", series, [Limit(-100.0), Limit(100.0)])


def _plain_velocities(run: Run) -> Group:
    series = _joint_series(run, run.signals.joint_velocities)
    return Group("plain_velocity", "joint velocity", f"{_angle_unit(_arm(run))}/s", series)


def _plain_efforts(run: Run) -> Group:
    series = {joint.name: run.signals.joint_efforts[:, column] for column, joint in _arm(run)}
    return Group("plain_effort", "joint effort", "N m or N", series)


def _tracking(run: Run) -> Group:
    errors = run.signals.joint_positions - run.signals.joint_commands
    return Group("tracking", "tracking error", _angle_unit(_arm(run)), _joint_series(run, errors))


def _gripper(run: Run) -> Group | None:
    """The gap between the pads where it is known, else the joint's position."""
    hand = run.robot.gripper
    names = [joint.name for joint in run.robot.joints]
    if hand is None or hand.joint not in names:
        return None
    column = names.index(hand.joint)
    actual = run.signals.joint_positions[:, column]
    command = run.signals.joint_commands[:, column]
    if not hand.widths:
        factor = _factor(run.robot.joints[column])
        unit = "mm" if run.robot.joints[column].kind == "prismatic" else "°"
        series = {"measured": factor * actual, "commanded": factor * command}
        return Group("gripper", "gripper", unit, series)
    opening, commanded = _opening(hand, actual), _opening(hand, command)
    series = {"opening": opening, "commanded": np.where(np.isnan(command), np.nan, commanded)}
    return Group("gripper", "gripper opening", "mm", series)


def _opening(hand: GripperRecord, positions: FloatArray) -> FloatArray:
    """Gap between the pads at joint positions [mm]."""
    table = np.array(hand.widths)
    return np.asarray(1e3 * np.interp(positions, table[:, 0], table[:, 1]), dtype=float)


def _gripper_effort(run: Run) -> Group | None:
    hand = run.robot.gripper
    joints = [
        joint for joint in enumerate(run.robot.joints) if hand and joint[1].name == hand.joint
    ]
    if not joints:
        return None
    column, joint = joints[0]
    is_limited = 0 < joint.effort < math.inf
    effort = run.signals.joint_efforts[:, column] * (100 / joint.effort if is_limited else 1.0)
    unit = "% of limit" if is_limited else "N m or N"
    limits = [Limit(-100.0), Limit(100.0)] if is_limited else []
    return Group("gripper_effort", "gripper effort", unit, {joint.name: effort}, limits)


def _clearances(run: Run) -> Group:
    """The pairs that came nearest; those never nearer than the observer looks are left out."""
    lowest = {
        pair: float(np.nanmin(values))
        for pair, values in run.signals.clearances.items()
        if np.isfinite(values).any()
    }
    seen = [pair for pair in lowest if lowest[pair] < run.signals.clearance_cutoff - 1e-9]
    nearest = sorted(seen, key=lambda pair: (lowest[pair], pair))[:MOST_SERIES]
    series = {_pair_name(pair): 1e3 * run.signals.clearances[pair] for pair in nearest}
    return Group("clearance", "clearance", "mm", series)


def _pair_name(pair: tuple[str, str]) -> str:
    return f"{pair[0]} and itself" if pair[0] == pair[1] else f"{pair[0]} and {pair[1]}"


def _contacts(run: Run) -> Group:
    """Forces between bodies; the robot's first, then the hardest."""
    links = set(run.robot.link_names)
    peaks = {pair: float(np.max(force)) for pair, force in run.signals.contact_forces.items()}
    order = sorted(peaks, key=lambda pair: (not links & set(pair), -peaks[pair], pair))
    series = {
        _pair_name(pair): run.signals.contact_forces[pair]
        for pair in order[:MOST_SERIES]
        if peaks[pair] > 0
    }
    return Group("contact", "contact force", "N", series)


def _slip(run: Run) -> Group:
    """How far a held object is from where the planner believes it to be."""
    times = run.signals.times
    series: dict[str, FloatArray] = {}
    for held in run.attachments:
        actual = run.signals.object_poses.get(held.represents)
        if actual is None or not any(p.link == held.link for p in run.robot.placements):
            continue
        rows = np.flatnonzero((times >= held.start_time) & (times <= held.end_time))
        if not len(rows):
            continue
        carrier = link_poses(run.robot, run.signals.joint_positions[rows], [held.link])[held.link]
        believed = compose(carrier, np.array(held.pose_in_link))
        distance = np.full(len(times), np.nan)
        distance[rows] = 1e3 * np.linalg.norm(actual[rows, :3] - believed[:, :3], axis=1)
        stands_for = "" if held.object == held.represents else f" ({held.represents})"
        name = held.object + stands_for
        series[name] = np.fmax(series[name], distance) if name in series else distance
    return Group("slip", "held object, off its place in the plan", "mm", series)


def _tcp_position(run: Run) -> Group:
    series = {axis: 1e3 * run.signals.tcp_pose[:, i] for i, axis in enumerate("xyz")}
    return Group("tcp", "TCP position in world", "mm", series)


def _tcp_speed(run: Run) -> Group | None:
    times = run.signals.times
    if len(times) < 3:
        return None
    speed = np.linalg.norm(np.gradient(run.signals.tcp_pose[:, :3], times, axis=0), axis=1)
    return Group("tcp_speed", "TCP speed", "mm/s", {"speed": 1e3 * speed})


def _moving(run: Run) -> dict[str, FloatArray]:
    """Simulated objects that moved, those that moved most first."""
    found: dict[str, tuple[float, FloatArray]] = {}
    for obj in run.objects:
        poses = run.signals.object_poses.get(obj.name)
        if poses is None or obj.is_static or not obj.in_simulation:
            continue
        known = poses[np.isfinite(poses).all(axis=1), :3]
        travel = float(np.ptp(known, axis=0).max()) if len(known) else 0.0
        if travel > 1e-3:
            found[obj.name] = (travel, poses)
    order = sorted(found, key=lambda name: (-found[name][0], name))[:MOST_SERIES]
    return {name: found[name][1] for name in order}


def _heights(run: Run) -> Group:
    series = {name: 1e3 * (poses[:, 2] - _first(poses)[2]) for name, poses in _moving(run).items()}
    return Group("height", "object height gained", "mm", series)


def _displacements(run: Run) -> Group:
    series = {
        name: 1e3 * np.linalg.norm(poses[:, :3] - _first(poses)[:3], axis=1)
        for name, poses in _moving(run).items()
    }
    return Group("displacement", "object displacement", "mm", series)


def _first(poses: FloatArray) -> FloatArray:
    return poses[int(np.isfinite(poses).all(axis=1).argmax())]
