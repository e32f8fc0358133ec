"""What joints and gripper did, for the plots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.types import FloatArray
from harness.recording.run import Run
from harness.reporting.html.plot_group import MOST_SERIES, Group, Limit
from harness.robot.end_effector import Gripper
from harness.robot.mechanism import Joint


def _arm(run: Run) -> list[tuple[int, Joint]]:
    """Columns and records of the arm's joints; of all of them where no group is the arm's."""
    names = run.robot.arm_joints
    return [(i, joint) for i, joint in enumerate(run.robot.movable_joints) if joint.name in names]


def _angle_unit(joints: Sequence[tuple[int, Joint]]) -> str:
    kinds = {joint.kind == "prismatic" for _, joint in joints}
    return {frozenset({True}): "mm", frozenset({False}): "°"}.get(frozenset(kinds), "° or mm")


def _factor(joint: Joint) -> float:
    return 1e3 if joint.kind == "prismatic" else 180 / math.pi


def _joint_series(run: Run, array: FloatArray) -> dict[str, FloatArray]:
    return {joint.name: _factor(joint) * array[:, column] for column, joint in _arm(run)}


def positions(run: Run) -> Group:
    """Measured positions of the arm, with each joint's limits."""
    limits = [
        Limit(_factor(joint) * value, number)
        for number, (_, joint) in enumerate(_arm(run))
        for value in (joint.lower, joint.upper)
        if math.isfinite(value)
    ]
    series = _joint_series(run, run.signals.joint_positions)
    return Group("position", "joint position", _angle_unit(_arm(run)), series, limits)


def commands(run: Run) -> Group:
    """Commanded positions of the arm."""
    series = _joint_series(run, run.signals.joint_commands)
    return Group("command", "commanded position", _angle_unit(_arm(run)), series)


def _of_limit(run: Run, array: FloatArray, limit: str) -> dict[str, FloatArray]:
    return {
        joint.name: 100 * array[:, column] / getattr(joint, limit)
        for column, joint in _arm(run)
        if 0 < getattr(joint, limit) < math.inf
    }


def velocities(run: Run) -> Group:
    """Velocities of the arm against their limits."""
    series = _of_limit(run, run.signals.joint_velocities, "velocity")
    return Group("velocity", "velocity", "% of limit", series, [Limit(-100.0), Limit(100.0)])


def efforts(run: Run) -> Group:
    """Efforts of the arm against their limits."""
    series = _of_limit(run, run.signals.joint_efforts, "effort")
    limits = [Limit(-100.0), Limit(100.0)]
    return Group(
        "effort", "effort", "% of limit", series, limits, 1.0, "effort", 100.0, is_signed=True
    )


def plain_velocities(run: Run) -> Group:
    """Velocities of the arm, also of joints without a limit."""
    series = _joint_series(run, run.signals.joint_velocities)
    unit = f"{_angle_unit(_arm(run))}/s"
    return Group("plain_velocity", "joint velocity", unit, series, least=0.1)


def plain_efforts(run: Run) -> Group:
    """Efforts of the arm, also of joints without a limit."""
    series = {joint.name: run.signals.joint_efforts[:, column] for column, joint in _arm(run)}
    return Group("plain_effort", "joint effort", "N m or N", series, least=0.01)


def tracking(run: Run) -> Group:
    """Measured less commanded positions of the arm."""
    errors = run.signals.joint_positions - run.signals.joint_commands
    return Group(
        "tracking",
        "tracking error",
        _angle_unit(_arm(run)),
        _joint_series(run, errors),
        least=0.02,
        measure="tracking error",
        factor=180 / math.pi,
        is_signed=True,
    )


def gripper(run: Run) -> Group | None:
    """The gap between the pads where it is known, else the joint's position."""
    group, series = None, dict[str, FloatArray]()
    for arm, hand in _hands(run):
        column = run.robot.joint_index[hand.joint]
        actual = run.signals.joint_positions[:, column]
        command = run.signals.joint_commands[:, column]
        joint = run.robot.movable_joints[column]
        if len(hand.widths):
            opening, commanded = _opening(hand, actual), _opening(hand, command)
            names = "opening", "commanded"
            rows = opening, np.where(np.isnan(command), np.nan, commanded)
            title, unit = "gripper opening", "mm"
        else:
            names, rows = (
                ("measured", "commanded"),
                (_factor(joint) * actual, _factor(joint) * command),
            )
            title, unit = "gripper", "mm" if joint.kind == "prismatic" else "°"
        series |= {f"{arm} {name}".strip(): row for name, row in zip(names, rows, strict=True)}
        group = Group("gripper", title, unit, series)
    return group


def _hands(run: Run) -> Iterator[tuple[str, Gripper]]:
    """Every gripper with the name of its arm; empty for the only one."""
    robot = run.robot
    hands = [(arm.name, arm.gripper) for arm in robot.arms] or [("", robot.gripper)]
    yield from ((arm, hand) for arm, hand in hands if hand and hand.joint in robot.joint_index)


def _opening(hand: Gripper, positions: FloatArray) -> FloatArray:
    """Gap between the pads at joint positions [mm]."""
    return 1e3 * hand.gap_at(positions)


def gripper_effort(run: Run) -> Group | None:
    """Efforts of the grippers' joints, against their limits if they have some."""
    joints = [run.robot.joint_by_name[hand.joint] for _, hand in _hands(run)]
    if not joints:
        return None
    is_limited = all(0 < joint.effort < math.inf for joint in joints)
    series = {
        joint.name: run.signals.joint_efforts[:, run.robot.joint_index[joint.name]]
        * (100 / joint.effort if is_limited else 1.0)
        for joint in joints
    }
    unit = "% of limit" if is_limited else "N m or N"
    limits = [Limit(-100.0), Limit(100.0)] if is_limited else []
    return Group("gripper_effort", "gripper effort", unit, series, limits)


def velocity_errors(run: Run) -> Group:
    """Measured less commanded velocities of the arm."""
    errors = run.signals.joint_velocities - run.signals.joint_command_velocities
    unit = f"{_angle_unit(_arm(run))}/s"
    return Group("velocity_error", "velocity error", unit, _joint_series(run, errors), least=0.1)


def other_velocities(run: Run) -> Group:
    """Velocities of the joints that are not the arm's."""
    series = _of_others(run, run.signals.joint_velocities)
    return Group(
        "other_velocity", "other joints' velocity", f"{_angle_unit(_others(run))}/s", series
    )


def other_positions(run: Run) -> Group:
    """Positions of the joints that are not the arm's: fingers and their followers."""
    unit, rows = _angle_unit(_others(run)), run.signals.joint_positions
    return Group("other_position", "other joints' position", unit, _of_others(run, rows))


def _others(run: Run) -> list[tuple[int, Joint]]:
    arm = {column for column, _ in _arm(run)}
    return [(i, joint) for i, joint in enumerate(run.robot.movable_joints) if i not in arm]


def _of_others(run: Run, array: FloatArray) -> dict[str, FloatArray]:
    return {joint.name: _factor(joint) * array[:, i] for i, joint in _others(run)[:MOST_SERIES]}
