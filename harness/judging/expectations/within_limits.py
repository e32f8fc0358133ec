"""within_limits: joints stay within their limits."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from harness.core.amounts import amounts
from harness.core.types import FloatArray
from harness.judging.expectation import Predicate
from harness.judging.joints import ROUNDING, hand_joints, is_measured, resting_joints
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotObservable, Window
from harness.language.base import Flag
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure
from harness.robot.mechanism import Joint

STOP_SOFTNESS = 0.02  # share of its range by which a joint that rests on its stop may sink into it

POSITION_TOLERANCE = {"rad": 1e-3, "m": 1e-4}
"""By which a measured position may exceed its limit [rad or m]: a controller that holds a joint
at its limit deviates a little to either side."""
VELOCITY_TOLERANCE = 1e-3, 1e-2  # least and largest share of a limit that may be exceeded
SERVO_DELAY = 1e-3
"""Time by which a servo follows the end of an acceleration late [s]: between these shares, a
velocity may exceed its limit by what the joint gains in it at its acceleration limit."""

POSITION = Quantity(
    "position",
    "rad or m",
    "between the joint's limits, with a tolerance of 0.001 rad or 0.1 mm",
    "position",
)
COMMAND = Quantity(
    "commanded position", "rad or m", "between the joint's limits, without a tolerance", "position"
)
VELOCITY = Quantity(
    "velocity",
    "rad/s or m/s",
    "at most the joint's limit, with a tolerance of 1 ms at its acceleration limit, 0.1 % to 1 %",
    "velocity",
)
EFFORT = Quantity("effort", "N m or N", "at most the joint's limit", "effort")
ACCELERATION = Quantity("acceleration", "rad/s^2 or m/s^2", "at most the joint's limit")


class WithinLimits(Predicate):
    """Joints stay within their limits.

    A controller that holds a joint at its limit deviates a little to either side: a measured
    position may exceed the limit by 0.001 rad or 0.1 mm. A servo follows the end of a ramp late: a
    measured velocity may exceed the limit by what the joint gains in 1 ms at its acceleration
    limit, at least by 0.1 % and at most by 1 %. Commands and efforts have no tolerance. The
    gripper's joints and idle ones may sink into their stops by 2 % of their range.
    """

    judged = "always"
    sentence = "joints are within limits"
    quantities = (POSITION, COMMAND, VELOCITY, EFFORT, ACCELERATION)

    position: Flag = Field(
        default=True, description="Whether measured and commanded positions are judged."
    )
    velocity: Flag = Field(default=True, description="Whether measured velocities are judged.")
    acceleration: Flag = Field(
        default=False, description="Whether accelerations of the commanded trajectory are judged."
    )
    effort: Flag = Field(default=True, description="Whether efforts of the motors are judged.")

    @model_validator(mode="after")
    def _any(self) -> Self:
        if not (self.position or self.velocity or self.acceleration or self.effort):
            raise ValueError("at least one kind of limit has to be judged")
        return self

    def signal(self, window: Window) -> MarginSignal:
        """Positions, velocities, efforts and commanded accelerations, as shares of their limits."""
        parts: list[Part] = []
        hand, resting = hand_joints(window.run.robot), resting_joints(window.run)
        for column, joint in enumerate(window.run.robot.movable_joints):
            if joint.is_mimic:  # it has no motor: its limits narrow those of the joint it follows
                continue
            if self.position:
                parts += _position_parts(window, column, joint, joint.name in resting)
                parts += _command_parts(window, column, joint)
            if self.velocity:
                parts += _rate_part(window, column, joint, VELOCITY)
            if self.effort:
                parts += _rate_part(window, column, joint, EFFORT)
            if self.acceleration and joint.name not in hand:
                parts += _rate_part(window, column, joint, ACCELERATION)
        if not parts:
            raise NotObservable("no limits of these kinds are known")

        def text(_: int, measure: Measure) -> str:
            value, limit = amounts(measure.value, measure.limit, measure.unit)
            has_tolerance = measure.name in (POSITION.name, VELOCITY.name)
            tolerance = " with its tolerance" if has_tolerance else ""
            return f"{measure.name} of {measure.detail} is {value}, limit {limit}{tolerance}"

        return all_of(window, parts, text, shown=3)


def _position_parts(window: Window, column: int, joint: Joint, may_rest: bool) -> list[Part]:
    if not (math.isfinite(joint.lower) and math.isfinite(joint.upper)):
        return []
    recorded = window.run.signals.joint_positions[:, column]
    if not is_measured(recorded, joint, "position"):
        return []
    values = window.cut(recorded)
    softness = STOP_SOFTNESS * (joint.upper - joint.lower) if may_rest else 0.0
    return _between(POSITION, values, joint, max(softness, POSITION_TOLERANCE[joint.position_unit]))


def _command_parts(window: Window, column: int, joint: Joint) -> list[Part]:
    """Commanded positions where they are beyond a limit, without a tolerance.

    One inside the limits does not count: a command at the limit is as good as any other, and its
    margin of zero would hide those of the measured signals.
    """
    if "joint_commands" in window.run.unrecorded:
        return []
    if not (math.isfinite(joint.lower) and math.isfinite(joint.upper)):
        return []
    recorded = window.run.signals.joint_commands[:, column]
    if not is_measured(recorded, joint, "command"):
        return []
    commands, rounding = window.cut(recorded), ROUNDING * (joint.upper - joint.lower)
    return [
        replace(part, relevant=~(part.margins() >= 0))
        for part in _between(COMMAND, commands, joint, rounding)
    ]


def _between(quantity: Quantity, values: FloatArray, joint: Joint, slack: float) -> list[Part]:
    scale, unit = 0.5 * (joint.upper - joint.lower), joint.position_unit
    lower, upper = joint.lower - slack, joint.upper + slack
    return [
        Part(quantity, values, lower, ">=", scale, detail=joint.name, measured_unit=unit),
        Part(quantity, values, upper, "<=", scale, detail=joint.name, measured_unit=unit),
    ]


def _rate_part(window: Window, column: int, joint: Joint, quantity: Quantity) -> list[Part]:
    signals, unit = window.run.signals, joint.position_unit
    match quantity.name:
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
    if not math.isfinite(limit) or not is_measured(values[:, column], joint, quantity.name):
        return []
    size = np.abs(window.cut(values)[:, column])
    most = limit * (1 + ROUNDING)
    if quantity is VELOCITY:
        least, largest = (share * limit for share in VELOCITY_TOLERANCE)
        gained = SERVO_DELAY * joint.acceleration if math.isfinite(joint.acceleration) else 0.0
        most = limit + min(max(gained, least), largest)
    return [Part(quantity, size, most, "<=", limit, detail=joint.name, measured_unit=unit)]
