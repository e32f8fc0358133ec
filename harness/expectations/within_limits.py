"""within_limits: joints stay within their limits."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from harness.assertions.expectation import Predicate
from harness.assertions.joints import (
    ROUNDING,
    gripper_joints,
    is_measured,
    resting_joints,
    unit_of,
)
from harness.assertions.margins import MarginSignal, Part, all_of
from harness.assertions.text import amount
from harness.assertions.window import NotObservable, Window
from harness.recording.run import JointRecord, Measure
from harness.spec.base import Flag
from harness.spec.expectation import Quantity

STOP_SOFTNESS = 0.02
"""Share of its range by which a joint that rests on its stop may sink into it."""

POSITION = Quantity("position", "rad or m", "between the joint's limits", "position")
VELOCITY = Quantity("velocity", "rad/s or m/s", "at most the joint's limit", "velocity")
EFFORT = Quantity("effort", "N m or N", "at most the joint's limit", "effort")
ACCELERATION = Quantity("acceleration", "rad/s^2 or m/s^2", "at most the joint's limit")


class WithinLimits(Predicate):
    """Joints stay within their limits."""

    judged = "always"
    quantities = (POSITION, VELOCITY, EFFORT, ACCELERATION)

    position: Flag = Field(default=True, description="Whether measured positions are judged.")
    velocity: Flag = Field(default=True, description="Whether measured velocities are judged.")
    acceleration: Flag = Field(
        default=False,
        description="Whether accelerations of the commanded trajectory are judged.",
    )
    effort: Flag = Field(default=True, description="Whether efforts of the motors are judged.")

    def signal(self, window: Window) -> MarginSignal:
        """Measured positions, velocities, efforts and commanded accelerations, against limits."""
        parts: list[Part] = []
        hand, resting = gripper_joints(window.run), resting_joints(window.run)
        for column, joint in enumerate(window.run.robot.joints):
            if self.position:
                parts += _position_parts(window, column, joint, joint.name in resting)
            if self.velocity:
                parts += _rate_part(window, column, joint, VELOCITY)
            if self.effort:
                parts += _rate_part(window, column, joint, EFFORT)
            if self.acceleration and joint.name not in hand and not joint.is_mimic:
                parts += _rate_part(window, column, joint, ACCELERATION)
        if not parts:
            raise NotObservable("no limits of these kinds are known")

        def text(_: int, measure: Measure) -> str:
            value, limit = amount(measure.value, measure.unit), amount(measure.limit, measure.unit)
            return f"{measure.name} of {measure.detail} is {value}, limit {limit}"

        return all_of(window, parts, text, shown=3)


def _position_parts(window: Window, column: int, joint: JointRecord, may_rest: bool) -> list[Part]:
    if not (math.isfinite(joint.lower) and math.isfinite(joint.upper)):
        return []
    recorded = window.run.signals.joint_positions[:, column]
    if not is_measured(recorded, joint, "position"):
        return []
    values = window.cut(recorded)
    softness = STOP_SOFTNESS * (joint.upper - joint.lower) if may_rest else 0.0
    scale = 0.5 * (joint.upper - joint.lower) or 1.0
    lower, upper = joint.lower - softness, joint.upper + softness
    name, unit = joint.name, unit_of(joint)
    return [
        Part(POSITION, values, lower, ">=", scale, detail=name, measured_unit=unit),
        Part(POSITION, values, upper, "<=", scale, detail=name, measured_unit=unit),
    ]


def _rate_part(window: Window, column: int, joint: JointRecord, quantity: Quantity) -> list[Part]:
    signals, unit = window.run.signals, unit_of(joint)
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
    return [Part(quantity, size, most, "<=", limit, detail=joint.name, measured_unit=unit)]
