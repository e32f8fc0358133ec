"""within_limits, tracking_error, effort: joints against their limits and their commands."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from harness.assertions.joints import unit_of
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.text import amount, amounts
from harness.assertions.window import NotObservable, Window
from harness.core.types import FloatArray
from harness.recording.run import JointRecord, Measure, Run
from harness.spec.checks import Effort, TrackingError, WithinLimits

STOP_SOFTNESS = 0.02
"""Share of its range by which a joint that rests on its stop may sink into it."""
ROUNDING = 1e-9
"""Share of a limit that is rounding: an effort that saturates is at its limit, not beyond."""
POSITION_TOLERANCE = {"rad": 1e-3, "m": 1e-4}
"""By which a measured position may exceed its limit [rad or m]: a controller that holds a joint
at its limit deviates a little to either side."""
VELOCITY_TOLERANCE = 1e-3
"""Share of its limit by which a measured velocity may exceed it, for the same reason."""
MEASURED = ("position", "velocity")
"""Quantities with a tolerance; commands have none."""


def gripper_joints(run: Run) -> frozenset[str]:
    """Joints of the gripper's group, and those that follow them."""
    hand = run.robot.gripper
    if hand is None:
        return frozenset()
    mimics = {joint.name for joint in run.robot.joints if joint.is_mimic}
    return frozenset(run.robot.groups.get(hand.group, ())) | {hand.joint} | mimics


def resting_joints(run: Run) -> frozenset[str]:
    """Joints that may lean on their stops: the gripper's, followers, and idle ones off the arm."""
    names = gripper_joints(run) | {joint.name for joint in run.robot.joints if joint.is_mimic}
    if "joint_commands" in run.unrecorded:
        return names
    others = names | set(run.robot.groups.get(run.robot.arm_group, ()))
    for column, joint in enumerate(run.robot.joints):
        if joint.name in others:
            continue
        commands = run.signals.joint_commands[:, column]
        if commands.size and (commands == commands[0]).all():
            names |= {joint.name}
    return names


@signal.handles(WithinLimits)
def within_limits(check: WithinLimits, window: Window) -> MarginSignal:
    """Positions, velocities, efforts and commanded accelerations, as shares of their limits."""
    parts: list[Part] = []
    hand, resting = gripper_joints(window.run), resting_joints(window.run)
    for column, joint in enumerate(window.run.robot.joints):
        if check.position:
            parts += _position_parts(window, column, joint, joint.name in resting)
            parts += _command_parts(window, column, joint)
        if check.velocity:
            parts += _rate_part(window, column, joint, "velocity")
        if check.effort:
            parts += _rate_part(window, column, joint, "effort")
        if check.acceleration and joint.name not in hand and not joint.is_mimic:
            parts += _rate_part(window, column, joint, "acceleration")
    if not parts:
        raise NotObservable("no limits of these kinds are known")

    def text(_: int, measure: Measure) -> str:
        value, limit = amounts(measure.value, measure.limit, measure.unit)
        tolerance = " with its tolerance" if measure.name in MEASURED else ""
        return f"{measure.name} of {measure.detail} is {value}, limit {limit}{tolerance}"

    return all_of(window, parts, text, shown=3)


def _is_measured(recorded: FloatArray, joint: JointRecord, what: str) -> bool:
    """Whether something is known of a joint in a run; one that follows another has no sensor.

    Raises:
        NotObservable: Nothing is, of a joint of its own.
    """
    if not np.isnan(recorded).all():
        return True
    if joint.is_mimic:
        return False
    raise NotObservable(f"the {what} of {joint.name} was not recorded")


def _position_parts(window: Window, column: int, joint: JointRecord, may_rest: bool) -> list[Part]:
    if not (math.isfinite(joint.lower) and math.isfinite(joint.upper)):
        return []
    recorded = window.run.signals.joint_positions[:, column]
    if not _is_measured(recorded, joint, "position"):
        return []
    values = window.cut(recorded)
    softness = STOP_SOFTNESS * (joint.upper - joint.lower) if may_rest else 0.0
    return _between("position", values, joint, max(softness, POSITION_TOLERANCE[unit_of(joint)]))


def _command_parts(window: Window, column: int, joint: JointRecord) -> list[Part]:
    """Commanded positions where they are beyond a limit, without a tolerance.

    One inside the limits does not count: a command at the limit is as good as any other, and its
    margin of zero would hide those of the measured signals.
    """
    if "joint_commands" in window.run.unrecorded:
        return []
    if not (math.isfinite(joint.lower) and math.isfinite(joint.upper)):
        return []
    recorded = window.run.signals.joint_commands[:, column]
    if not _is_measured(recorded, joint, "command"):
        return []
    commands, rounding = window.cut(recorded), ROUNDING * (joint.upper - joint.lower)
    return [
        replace(part, relevant=~(part.margins() >= 0))
        for part in _between("commanded position", commands, joint, rounding)
    ]


def _between(name: str, values: FloatArray, joint: JointRecord, slack: float) -> list[Part]:
    scale, unit = 0.5 * (joint.upper - joint.lower) or 1.0, unit_of(joint)
    return [
        Part(name, values, joint.lower - slack, ">=", unit, scale, detail=joint.name),
        Part(name, values, joint.upper + slack, "<=", unit, scale, detail=joint.name),
    ]


def _rate_part(window: Window, column: int, joint: JointRecord, kind: str) -> list[Part]:
    signals, unit = window.run.signals, unit_of(joint)
    match kind:
        case "velocity":
            values, limit, unit = signals.joint_velocities, joint.velocity, f"{unit}/s"
        case "effort":
            values, limit = signals.joint_efforts, joint.effort
            unit = "N" if unit == "m" else "N m"
        case _:
            commands = signals.joint_command_velocities
            values = np.zeros_like(commands)
            values[1:] = np.diff(commands, axis=0) / np.diff(signals.times)[:, None]
            limit, unit = joint.acceleration, f"{unit}/s^2"
    if not math.isfinite(limit) or not _is_measured(values[:, column], joint, kind):
        return []
    size = np.abs(window.cut(values)[:, column])
    slack = VELOCITY_TOLERANCE if kind == "velocity" else ROUNDING
    return [Part(kind, size, limit * (1 + slack), "<=", unit, limit, detail=joint.name)]


@signal.handles(TrackingError)
def tracking_error(check: TrackingError, window: Window) -> MarginSignal:
    """Largest distance of a joint from its command [rad or m].

    The gripper's joints are left out: what stalls on an object is meant to stay behind. For joints
    that slide the default is a tenth of the given number, in metres.
    """
    run = window.run
    hand = gripper_joints(run)
    parts: list[Part] = []
    for column, joint in enumerate(run.robot.joints):
        error = np.abs(
            run.signals.joint_positions[:, column] - run.signals.joint_commands[:, column]
        )
        error = window.cut(error)
        known = ~np.isnan(error)
        if joint.name in hand or not known.any():
            continue
        slides = joint.kind == "prismatic" and "max" not in check.model_fields_set
        limit = 0.1 * check.max if slides else check.max
        parts.append(
            Part("tracking error", error, limit, "<=", unit_of(joint), None, known, joint.name)
        )
    if not parts:
        raise NotObservable("no commands of joints other than the gripper's were recorded")
    some = np.any([part.relevant for part in parts if part.relevant is not None], axis=0)

    def text(_: int, measure: Measure) -> str:
        return f"{measure.detail} is {amount(measure.value, measure.unit)} from its command"

    return all_of(window, parts, text, applies=some, shown=3)


@signal.handles(Effort)
def effort(check: Effort, window: Window) -> MarginSignal:
    """Largest share of its effort limit that a joint uses."""
    parts = [
        Part(
            "effort",
            np.abs(window.cut(window.run.signals.joint_efforts)[:, column]) / joint.effort,
            check.max_fraction * (1 + ROUNDING),
            "<=",
            "1",
            detail=joint.name,
        )
        for column, joint in enumerate(window.run.robot.joints)
        if math.isfinite(joint.effort)
        and joint.effort > 0
        and _is_measured(window.run.signals.joint_efforts[:, column], joint, "effort")
    ]
    if not parts:
        raise NotObservable("no effort limits are known")

    def text(_: int, measure: Measure) -> str:
        return f"{measure.detail} uses {100 * measure.value:.1f} % of its effort limit"

    return all_of(window, parts, text, shown=3)
