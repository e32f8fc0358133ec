"""joints, named_target, gripper: joint positions against where they should be.

A tolerance that the file does not give is meant for angles. For joints that slide, and for widths,
`SLIDING_TOLERANCE` stands in for it: 0.01 of a metre is a third of a small gripper's travel.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.assertions.contacts import finger_gap, gripper_of
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.text import amount
from harness.assertions.window import (
    NotObservable,
    NotReached,
    Window,
    refuse_unrecorded_steps,
)
from harness.recording.run import JointRecord, Measure, Run
from harness.spec.checks import GripperState, Joints, NamedTarget

SLIDING_TOLERANCE = 0.002
"""[m]"""


def joint_column(run: Run, name: str) -> tuple[int, JointRecord]:
    """Place of a joint in the recorded columns, and its record.

    Raises:
        NotObservable: The robot has no such movable joint.
    """
    for column, joint in enumerate(run.robot.joints):
        if joint.name == name:
            return column, joint
    raise NotObservable(f"there is no joint '{name}' in this run")


def unit_of(joint: JointRecord) -> str:
    """Of its position."""
    return "m" if joint.kind == "prismatic" else "rad"


@signal.handles(Joints)
def joints(check: Joints, window: Window) -> MarginSignal:
    """The worst joint's distance from its position [rad or m]."""
    return _near(window, check.positions, check.tolerance, "tolerance" in check.model_fields_set)


@signal.handles(NamedTarget)
def named_target(check: NamedTarget, window: Window) -> MarginSignal:
    """The worst joint's distance from the named state [rad or m]."""
    robot = window.run.robot
    hand = "" if robot.gripper is None else robot.gripper.group
    candidates = [check.group] if check.group is not None else [robot.arm_group, hand]
    candidates += [] if check.group is not None else sorted(robot.named_states)
    for group in candidates:
        state = robot.named_states.get(group, {}).get(check.state)
        if state is not None:
            given = "tolerance" in check.model_fields_set
            return _near(window, state, check.tolerance, given)
    raise NotObservable(f"there is no named state '{check.state}' in this run")


def _near(
    window: Window, targets: Mapping[str, float], tolerance: float, is_given: bool
) -> MarginSignal:
    parts: list[Part] = []
    for name in sorted(targets):
        column, joint = joint_column(window.run, name)
        error = window.cut(window.run.signals.joint_positions)[:, column] - targets[name]
        if joint.kind == "continuous":
            error = np.arctan2(np.sin(error), np.cos(error))
        slides = joint.kind == "prismatic" and not is_given
        limit = min(tolerance, SLIDING_TOLERANCE) if slides else tolerance
        unit = unit_of(joint)
        parts.append(Part("joint position error", np.abs(error), limit, "<=", unit, detail=name))

    def text(_: int, measure: Measure) -> str:
        off, limit = amount(measure.value, measure.unit), amount(measure.limit, measure.unit)
        return f"{measure.detail} is off its target by {off} of {limit}"

    return all_of(window, parts, text)


@signal.handles(GripperState)
def gripper_state(check: GripperState, window: Window) -> MarginSignal:
    """The gripper's joint, or the gap between its pads, or what its last step reported."""
    run = window.run
    hand = gripper_of(run)
    given = "tolerance" in check.model_fields_set
    if check.stalled is not None:
        return _stalled(check.stalled, window)
    if check.named_target is not None:
        state = run.robot.named_states.get(hand.group, {}).get(check.named_target)
        if state is None:
            raise NotObservable(f"there is no named state '{check.named_target}' of the gripper")
        return _near(window, state, check.tolerance, given)
    if check.position is not None:
        return _near(window, {hand.joint: check.position}, check.tolerance, given)
    width = check.width or 0.0
    gap = window.cut(finger_gap(run))
    limit = check.tolerance if given else SLIDING_TOLERANCE
    part = Part("gap error", np.abs(gap - width), limit, "<=", "m")

    def text(index: int, _: Measure) -> str:
        return f"the gap is {amount(float(gap[index]), 'm')}, {amount(width, 'm')} asked for"

    return all_of(window, [part], text)


def _stalled(expected: bool, window: Window) -> MarginSignal:
    """What the last finished gripper step had reported by each sample."""
    run = window.run
    reported = np.full(len(run.signals.times), np.nan)
    for step in run.steps:
        if step.status != "not_reached" and isinstance(step.result.get("stalled"), bool):
            reported[max(step.end_index - 1, 0) :] = float(step.result["stalled"])
    reported = window.cut(reported)
    if np.isnan(reported).all():
        refuse_unrecorded_steps(run)
        raise NotReached("no gripper step has reported yet")
    part = Part("stalled", reported, float(expected), "==", "1")

    def text(_: int, measure: Measure) -> str:
        return "the gripper stalled" if measure.value == 1 else "the gripper did not stall"

    return all_of(window, [part], text, present=~np.isnan(reported))
