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
"""A set point that changed by more was commanded to move [rad or m]."""


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
    for number, step in enumerate(steps):
        later = steps[number + 1 :]
        faults = [
            record.receipt(fault, step, _first_reset(fault, later))
            for fault in step.result.get("faults", ())
        ]
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


def _first_reset(fault: dict[str, Any], later: Sequence[StepRecord]) -> int | None:
    """The first sample at which another `inject` has set the same; None if none does."""
    for step in later:
        for other in step.result.get("faults", ()):
            if (other["fault"], other["target"]) == (fault["fault"], fault["target"]):
                return step.start_index
    return None


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

    def receipt(
        self, fault: dict[str, Any], step: StepRecord, set_again: int | None
    ) -> dict[str, Any]:
        """The fault with `receipt` and `evidence`.

        Args:
            fault: What was set, and what it was before.
            step: The record of the `inject` step.
            set_again: Sample at which the same was set to something else; what happens from there
                on is none of this fault's doing.
        """
        if fault["before"] == fault["after"]:
            return {**fault, "receipt": "no_effect", "evidence": "it was so already"}
        first = max(0, step.end_index - 1)
        last = len(self.signals.times) if set_again is None else max(set_again, first + 1)
        rows = slice(first, last)
        if fault["fault"] == "push":
            rows = slice(step.start_index, max(step.end_index, step.start_index + 1))
        landed, evidence = getattr(self, f"_{fault['fault']}")(fault, rows)
        if not landed and set_again is not None:
            evidence = evidence.replace("afterwards", "before it was set again")
        return {**fault, "receipt": "landed" if landed else "no_effect", "evidence": evidence}

    def _friction(self, fault: dict[str, Any], rows: slice) -> tuple[bool, str]:
        name = fault["target"]
        rubbed = self._touched(name, self.robot.link_names, rows)
        moving = self._speed(name, rows) > MOVING
        for pair, force in self.signals.contact_forces.items():
            if name in pair:
                rubbed |= (force[rows] > 0) & moving
        if not rubbed.any():
            return False, "nothing pulled at it afterwards"
        return True, f"it was gripped, or slid in contact, for {self._seconds(rubbed)} afterwards"

    def _gripper_effort(self, fault: dict[str, Any], rows: slice) -> tuple[bool, str]:
        gripper = self.robot.gripper
        fingers = [] if gripper is None else [x for side in gripper.sides.values() for x in side]
        pressed = np.zeros(len(self.signals.times[rows]), dtype=bool)
        for name in self.is_static:
            pressed |= self._touched(name, fingers, rows)
        if not pressed.any():
            return False, "the gripper pressed on nothing afterwards"
        seconds, share = self._seconds(pressed), float(fault["after"])
        return True, f"the gripper pressed for {seconds} with {share:.0%} of its effort"

    def _joint_stall(self, fault: dict[str, Any], rows: slice) -> tuple[bool, str]:
        joint = self.joints.index(fault["target"])
        commanded = float(np.ptp(self.signals.joint_commands[rows, joint]))
        if commanded <= COMMANDED:
            return False, "it was not commanded to move afterwards"
        moved = float(np.ptp(self.signals.joint_positions[rows, joint]))
        unit = "m" if self.robot.joints[joint].kind == "prismatic" else "rad"
        return True, f"commanded to move by {commanded:.3g} {unit}, it moved by {moved:.2g} {unit}"

    def _push(self, fault: dict[str, Any], rows: slice) -> tuple[bool, str]:
        speed = self._speed(fault["target"], rows)
        before, fastest = float(speed[0]), float(speed.max())
        if fastest - before <= MOVING:
            return False, "it did not move: friction or a hand held it"
        return True, f"it reached {fastest:.3g} m/s"

    def _sensor_noise(self, fault: dict[str, Any], rows: slice) -> tuple[bool, str]:
        if fault["after"] == 0.0:
            return True, "set back"
        errors = np.abs(self.signals.joint_positions - self.signals.joint_commands)[rows][1:]
        if not len(errors):
            return False, "no time passed afterwards"
        return True, f"joints were up to {float(np.nanmax(errors)):.3g} rad off their set points"

    def _command_latency(self, fault: dict[str, Any], rows: slice) -> tuple[bool, str]:
        if fault["after"] == 0.0:
            return True, "set back"
        commands = self.signals.joint_commands[rows]
        moved = np.nan_to_num(np.ptp(commands, axis=0)) > COMMANDED
        if not moved.any():
            return False, "no joint was commanded to move afterwards"
        errors = np.abs(self.signals.joint_positions[rows] - commands)[:, moved]
        return (
            True,
            f"joints lagged up to {float(np.nanmax(errors)):.3g} rad behind their set points",
        )

    def _touched(self, name: str, others: Sequence[str], rows: slice) -> BoolArray:
        touched = np.zeros(len(self.signals.times[rows]), dtype=bool)
        for (one, two), force in self.signals.contact_forces.items():
            if (one == name and two in others) or (two == name and one in others):
                touched |= force[rows] > 0
        return touched

    def _speed(self, name: str, rows: slice) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Of an object's origin, between samples [m/s], of every row."""
        positions = self.signals.object_poses[name][rows, :3]
        steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
        return np.nan_to_num(np.append(steps, 0.0)) / max(self.step_time, 1e-9)

    def _seconds(self, rows: BoolArray) -> str:
        return f"{np.count_nonzero(rows) * self.step_time:.2f} s"
