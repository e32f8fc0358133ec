"""What came of injected faults, read from the record: `landed`, or `no_effect` and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.types import BoolArray
from harness.recording.run import Finding, ObjectRecord, RobotRecord, Signals, StepRecord

MOVING = 1e-3
"""A body faster than this moves [m/s]."""

COMMANDED = 1e-4
"""A set point that changed by more was told to move [rad or m]."""


def with_receipts(
    steps: Sequence[StepRecord],
    signals: Signals,
    robot: RobotRecord,
    objects: Sequence[ObjectRecord],
) -> tuple[tuple[StepRecord, ...], tuple[Finding, ...]]:
    """The steps with a receipt on every fault, and a finding for each that had no effect."""
    record = _Record(signals, robot, objects)
    done: list[StepRecord] = []
    findings: list[Finding] = []
    for step in steps:
        faults = [record.receipt(fault, step) for fault in step.result.get("faults", ())]
        if not faults:
            done.append(step)
            continue
        done.append(replace(step, result={**step.result, "faults": faults}))
        findings += [
            Finding(
                "fault_without_effect",
                f"{_words(fault)} had no effect: {fault['evidence']}",
                step.start_time,
                step.id,
                fault,
            )
            for fault in faults
            if fault["receipt"] == "no_effect"
        ]
    return tuple(done), tuple(findings)


def _words(fault: dict[str, Any]) -> str:
    name = str(fault["fault"]).replace("_", " ")
    return f"{name} of {fault['target']}" if fault["target"] else name


class _Record:
    def __init__(
        self, signals: Signals, robot: RobotRecord, objects: Sequence[ObjectRecord]
    ) -> None:
        self.signals = signals
        self.robot = robot
        self.is_static = {obj.name: obj.is_static for obj in objects}
        self.joints = [joint.name for joint in robot.joints]
        self.step_time = float(signals.times[1] - signals.times[0]) if len(signals.times) > 1 else 0

    def receipt(self, fault: dict[str, Any], step: StepRecord) -> dict[str, Any]:
        """The fault with `receipt` and `evidence`."""
        if fault["before"] == fault["after"]:
            return {**fault, "receipt": "no_effect", "evidence": "it was so already"}
        first = max(0, step.end_index - 1)
        if fault["fault"] == "push":
            first = step.start_index
        landed, evidence = getattr(self, f"_{fault['fault']}")(fault, first, step)
        return {**fault, "receipt": "landed" if landed else "no_effect", "evidence": evidence}

    def _friction(self, fault: dict[str, Any], first: int, _: StepRecord) -> tuple[bool, str]:
        name = fault["target"]
        rubbed = self._touched(name, self.robot.link_names, first)
        moving = self._speed(name, first) > MOVING
        for pair, force in self.signals.contact_forces.items():
            if name in pair:
                rubbed |= (force[first:] > 0) & moving
        if not rubbed.any():
            return False, "nothing pulled at it afterwards"
        seconds = self._seconds(rubbed)
        return True, f"it was gripped, or slid in contact, for {seconds} afterwards"

    def _gripper_effort(self, fault: dict[str, Any], first: int, _: StepRecord) -> tuple[bool, str]:
        gripper = self.robot.gripper
        fingers = [] if gripper is None else [x for side in gripper.sides.values() for x in side]
        pressed = np.zeros(len(self.signals.times) - first, dtype=bool)
        for name in self.is_static:
            pressed |= self._touched(name, fingers, first)
        if not pressed.any():
            return False, "the gripper pressed on nothing afterwards"
        seconds, share = self._seconds(pressed), float(fault["after"])
        return True, f"the gripper pressed for {seconds} with {share:.0%} of its effort"

    def _joint_stall(self, fault: dict[str, Any], first: int, _: StepRecord) -> tuple[bool, str]:
        joint = self.joints.index(fault["target"])
        asked = float(np.ptp(self.signals.joint_commands[first:, joint]))
        if asked <= COMMANDED:
            return False, "it was not told to move afterwards"
        moved = float(np.ptp(self.signals.joint_positions[first:, joint]))
        unit = "m" if self.robot.joints[joint].kind == "prismatic" else "rad"
        return True, f"told to move by {asked:.3g} {unit}, it moved by {moved:.2g} {unit}"

    def _push(self, fault: dict[str, Any], first: int, step: StepRecord) -> tuple[bool, str]:
        name = fault["target"]
        speed = self._speed(name, first)[: step.end_index - first]
        before, fastest = float(speed[0]), float(speed.max())
        if fastest - before <= MOVING:
            return False, "it did not move: friction or a hand held it"
        return True, f"it reached {fastest:.3g} m/s"

    def _sensor_noise(self, fault: dict[str, Any], first: int, _: StepRecord) -> tuple[bool, str]:
        if fault["after"] == 0.0:
            return True, "set back"
        errors = np.abs(self.signals.joint_positions - self.signals.joint_commands)[first + 1 :]
        if not len(errors):
            return False, "the run ended with it"
        return True, f"joints were up to {float(np.nanmax(errors)):.3g} rad off their set points"

    def _command_latency(
        self, fault: dict[str, Any], first: int, _: StepRecord
    ) -> tuple[bool, str]:
        if fault["after"] == 0.0:
            return True, "set back"
        moved = np.nan_to_num(np.ptp(self.signals.joint_commands[first:], axis=0)) > COMMANDED
        if not moved.any():
            return False, "no joint was told to move afterwards"
        errors = np.abs(self.signals.joint_positions - self.signals.joint_commands)[first:, moved]
        return (
            True,
            f"joints lagged up to {float(np.nanmax(errors)):.3g} rad behind their set points",
        )

    def _touched(self, name: str, others: Sequence[str], first: int) -> BoolArray:
        touched = np.zeros(len(self.signals.times) - first, dtype=bool)
        for (one, two), force in self.signals.contact_forces.items():
            if (one == name and two in others) or (two == name and one in others):
                touched |= force[first:] > 0
        return touched

    def _speed(self, name: str, first: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Of an object's origin, between samples [m/s]; shape (N - first,)."""
        positions = self.signals.object_poses[name][first:, :3]
        steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
        return np.nan_to_num(np.append(steps, 0.0)) / max(self.step_time, 1e-9)

    def _seconds(self, rows: BoolArray) -> str:
        return f"{np.count_nonzero(rows) * self.step_time:.2f} s"
