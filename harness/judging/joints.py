"""Joints of a run: their columns, those that may rest on their stops, and distance from targets.

A tolerance that the file does not give is one of angles. For joints that slide, and for widths,
`SLIDING_TOLERANCE` stands in for it: 0.01 of a metre is a third of a small gripper's travel.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.cell.scope import At
from harness.core.amounts import amounts, is_exact
from harness.core.types import FloatArray
from harness.judging.limits import error_range, refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotObservable, Window
from harness.language.expectation import Quantity
from harness.recording.run import Run
from harness.recording.verdict import Measure
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint

SLIDING_TOLERANCE = 0.002  # [m]
STANDING = 0.01  # [rad or m] within which encoders' noise and the sag of a held arm stay
ROUNDING = 1e-9  # share of a limit: an effort that saturates is at its limit, not beyond

POSITION_ERROR = Quantity(
    "joint position error", "rad or m", "at most `tolerance`, for each joint", "position"
)


def check_tolerance(
    at: At, key: str, targets: Mapping[str, float], tolerance: float, is_given: bool
) -> None:
    """Report targets that no joint comes near, and a tolerance that no position exceeds.

    `key` is that of the targets, or of the only one; the others are as of `near`.
    """
    of, largest = "the position error of ", 0.0
    for name, joint in at.scope.description.joint_by_name.items():
        if name in targets:
            turns = joint.kind == "continuous"
            stops = (-np.pi, np.pi) if turns else (joint.lower, joint.upper)
            ends = error_range(0.0 if turns else targets[name], *stops)
            largest, limit = max(largest, ends[1]), _limit_of(joint, tolerance, is_given)
            if limit < ends[0]:
                here, last = (At(at.scope, at.key(key)), name) if key == "positions" else (at, key)
                refuse_decided(here, last, "<=", limit, ends, of + name)
    if largest and is_given:
        of += " or ".join(sorted(targets))
        refuse_decided(at, "tolerance", "<=", tolerance, (0.0, largest), of)


def _limit_of(joint: Joint, tolerance: float, is_given: bool) -> float:
    slides = joint.kind == "prismatic" and not is_given
    return min(tolerance, SLIDING_TOLERANCE) if slides else tolerance


def joint_column(run: Run, name: str) -> tuple[int, Joint]:
    """Place of a joint in the recorded columns, and its record.

    Raises:
        NotObservable: The robot has no such movable joint.
    """
    for column, joint in enumerate(run.robot.movable_joints):
        if joint.name == name:
            return column, joint
    raise NotObservable(f"there is no joint '{name}' in this run")


def hand_joints(robot: RobotDescription) -> frozenset[str]:
    """Joints of the grippers' groups, and those that follow them."""
    if not robot.grippers:
        return frozenset()
    mimics = {joint.name for joint in robot.movable_joints if joint.is_mimic}
    joints = {hand.joint for hand in robot.grippers}
    return frozenset(mimics | joints).union(*(robot.group_joints(h.group) for h in robot.grippers))


def stood_still(run: Run) -> bool:
    """Whether no joint moved; of a run that ended early, no joint of the arm."""
    spared = hand_joints(run.robot) if run.ended_early else frozenset[str]()
    positions = run.signals.joint_positions
    columns = [
        positions[:, column]
        for column, joint in enumerate(run.robot.movable_joints)
        if joint.name not in spared
    ]
    known = [each[np.isfinite(each)] for each in columns]
    return any(map(len, known)) and all(np.ptp(each) < STANDING for each in known if len(each))


def resting_joints(run: Run) -> frozenset[str]:
    """Joints that may lean on their stops: the gripper's, followers, and idle ones off the arm."""
    names = hand_joints(run.robot) | {
        joint.name for joint in run.robot.movable_joints if joint.is_mimic
    }
    if "joint_commands" in run.unrecorded:
        return names
    arms = [arm.name for arm in run.robot.arms] or [run.robot.arm_group]
    others = names.union(*map(run.robot.group_joints, arms))
    for column, joint in enumerate(run.robot.movable_joints):
        if joint.name in others:
            continue
        commands = run.signals.joint_commands[:, column]
        if commands.size and (commands == commands[0]).all():
            names |= {joint.name}
    return names


def is_measured(recorded: FloatArray, joint: Joint, what: str) -> bool:
    """Whether a run has measurements of a joint; a mimic joint has no sensor.

    Raises:
        NotObservable: Nothing is, of a joint of its own.
    """
    if not np.isnan(recorded).all():
        return True
    if joint.is_mimic:
        return False
    raise NotObservable(f"the {what} of {joint.name} was not recorded")


def near(
    window: Window, targets: Mapping[str, float], tolerance: float, is_given: bool
) -> MarginSignal:
    """The worst joint's distance from its position [rad or m]."""
    parts: list[Part] = []
    for name in sorted(targets):
        column, joint = joint_column(window.run, name)
        error = window.cut(window.run.signals.joint_positions)[:, column] - targets[name]
        if joint.kind == "continuous":
            error = np.arctan2(np.sin(error), np.cos(error))
        limit = _limit_of(joint, tolerance, is_given)
        off, unit = np.abs(error), joint.position_unit
        parts.append(Part(POSITION_ERROR, off, limit, "<=", detail=name, measured_unit=unit))

    def text(_: int, measure: Measure) -> str:
        off, limit = amounts(measure.value, measure.limit, measure.unit)
        if is_exact(measure.value, measure.limit, measure.unit):
            return f"{measure.detail} is exactly at its target, {limit} allowed"
        return f"{measure.detail} is off its target by {off} of {limit}"

    return all_of(window, parts, text)
