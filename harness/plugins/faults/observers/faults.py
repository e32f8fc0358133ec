"""The effect of injected faults, read from the record: `landed`, or `no_effect` and why."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from harness.core.amounts import amount
from harness.core.types import BoolArray, FloatArray
from harness.judging.body_motion import balls_of
from harness.recording.faults import FaultKind, InjectedFault, InjectedFaults, faults_of
from harness.recording.run import Finding, ObjectRecord
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription
from harness.session.observation.observer import Observed, Observer

MOVING = 1e-3  # a body faster than this moves [m/s]
COMMANDED = 1e-4  # a set point that changes by more is a command to move [rad or m]


@dataclass(frozen=True)
class Effect:
    """Whether a fault had an effect.

    Attributes:
        landed: Whether it had one.
        evidence: What shows it, or why there is none.
        is_over_time: Whether the evidence holds for the time after the fault began.
    """

    landed: bool
    evidence: str
    is_over_time: bool = False

    def sentence(self, *, is_set_again: bool) -> str:
        """The evidence with the time that it holds for."""
        if not self.is_over_time:
            return self.evidence
        until = "before it was set again" if is_set_again and not self.landed else "afterwards"
        return f"{self.evidence} {until}"


class FaultsObserver(Observer):
    """A receipt on every fault, and a finding for each that had no effect."""

    name: ClassVar[str] = "faults"

    def observe(
        self,
        steps: Sequence[StepRecord],
        signals: Signals,
        robot: RobotDescription,
        objects: Sequence[ObjectRecord],
    ) -> Observed:
        record = _Record(signals, robot, objects)
        done: list[StepRecord] = []
        findings: list[Finding] = []
        for number, step in enumerate(steps):
            later = steps[number + 1 :]
            faults = [
                record.with_receipt(fault, step, _set_again(fault, later))
                for fault in faults_of(step)
            ]
            if not faults:
                done.append(step)
                continue
            done.append(replace(step, result=step.result.replaced(InjectedFaults(tuple(faults)))))
            findings += [
                Finding(
                    "fault_without_effect",
                    f"{fault.name} had no effect: {fault.evidence}",
                    step.start_time,
                    step.id,
                    fault.plain(),
                )
                for fault in faults
                if fault.receipt == "no_effect"
            ]
        return tuple(done), tuple(findings)


def _set_again(fault: InjectedFault, later: Sequence[StepRecord]) -> int | None:
    """The first sample at which another `inject` has set the same; None if none does."""
    for step in later:
        for other in faults_of(step):
            if (other.fault, other.target) == (fault.fault, fault.target):
                return step.start_index
    return None


class _Record:
    def __init__(
        self, signals: Signals, robot: RobotDescription, objects: Sequence[ObjectRecord]
    ) -> None:
        self.signals = signals
        self.robot = robot
        self.objects = {obj.name: obj for obj in objects}
        self.joints = robot.joint_names
        self.step_time = float(signals.times[1] - signals.times[0]) if len(signals.times) > 1 else 0

        self._effects: Mapping[FaultKind, Callable[[InjectedFault, slice], Effect]] = {
            "friction": self._friction,
            "gripper_effort": self._gripper_effort,
            "joint_stall": self._joint_stall,
            "push": self._push,
            "sensor_noise": self._sensor_noise,
            "command_latency": self._command_latency,
        }

    def with_receipt(
        self, fault: InjectedFault, step: StepRecord, set_again: int | None
    ) -> InjectedFault:
        """The fault with `receipt` and `evidence`.

        Args:
            set_again: Sample at which the same was set to something else; what happens after it
                is not an effect of this fault.
        """
        if fault.before == fault.after:
            return replace(fault, receipt="no_effect", evidence="it was so already")
        first = step.end_index - 1
        last = len(self.signals.times) if set_again is None else max(set_again, first + 1)
        rows = slice(first, last)
        if fault.fault == "push":
            after = 2 if step.end_index > step.start_index else 0  # what it did shows one later
            rows = slice(max(step.start_index - 1, 0), step.end_index + after)
        effect = self._effects[fault.fault](fault, rows)
        return replace(
            fault,
            receipt="landed" if effect.landed else "no_effect",
            evidence=effect.sentence(is_set_again=set_again is not None),
        )

    def _friction(self, fault: InjectedFault, rows: slice) -> Effect:
        name = fault.target
        rubbed = self._touched(name, self.robot.link_names, rows)
        moving = self._speed(name, rows) > MOVING
        for pair, force in self.signals.contact_forces.items():
            if name in pair:
                rubbed |= (force[rows] > 0) & moving
        if not rubbed.any():
            return Effect(False, "nothing pulled at it", is_over_time=True)
        evidence = f"it was gripped, or slid in contact, for {self._seconds(rubbed)}"
        return Effect(True, evidence, is_over_time=True)

    def _gripper_effort(self, fault: InjectedFault, rows: slice) -> Effect:
        gripper = self.robot.gripper
        fingers = [] if gripper is None else [x for side in gripper.sides.values() for x in side]
        pressed = np.zeros(len(self.signals.times[rows]), dtype=bool)
        for name in self.objects:
            pressed |= self._touched(name, fingers, rows)
        if not pressed.any():
            return Effect(False, "the gripper pressed on nothing", is_over_time=True)
        seconds, share = self._seconds(pressed), float(fault.after)
        return Effect(True, f"the gripper pressed for {seconds} with {share:.0%} of its effort")

    def _joint_stall(self, fault: InjectedFault, rows: slice) -> Effect:
        joint = self.joints.index(fault.target)
        commanded = float(np.ptp(self.signals.joint_commands[rows, joint]))
        if commanded <= COMMANDED:
            return Effect(False, "it was not commanded to move", is_over_time=True)
        moved = float(np.ptp(self.signals.joint_positions[rows, joint]))
        unit = self.robot.movable_joints[joint].position_unit
        return Effect(
            True, f"commanded to move by {commanded:.3g} {unit}, it moved by {moved:.2g} {unit}"
        )

    def _push(self, fault: InjectedFault, rows: slice) -> Effect:
        speed = self._speed(fault.target, rows, along=np.array(fault.after, dtype=float))
        before, fastest = float(speed[0]) if rows.start else 0.0, float(speed.max())
        if fastest - before <= MOVING:
            return Effect(False, "it did not move: friction or a hand held it")
        return Effect(True, f"it reached {amount(fastest, 'm/s')}")

    def _sensor_noise(self, fault: InjectedFault, rows: slice) -> Effect:
        if fault.after == 0.0:
            return Effect(True, "set back")
        errors = np.abs(self.signals.joint_positions - self.signals.joint_commands)[rows][1:]
        if not len(errors):
            return Effect(False, "no time passed", is_over_time=True)
        return Effect(
            True,
            f"joints were up to {amount(float(np.nanmax(errors)), 'rad')} off their set points",
        )

    def _command_latency(self, fault: InjectedFault, rows: slice) -> Effect:
        if fault.after == 0.0:
            return Effect(True, "set back")
        commands = self.signals.joint_commands[rows]
        moved = np.nan_to_num(np.ptp(commands, axis=0)) > COMMANDED
        if not moved.any():
            return Effect(False, "no joint was commanded to move", is_over_time=True)
        errors = np.abs(self.signals.joint_positions[rows] - commands)[:, moved]
        lag = float(np.nanmax(errors))
        return Effect(True, f"joints lagged up to {amount(lag, 'rad')} behind their set points")

    def _touched(self, name: str, others: Sequence[str], rows: slice) -> BoolArray:
        touched = np.zeros(len(self.signals.times[rows]), dtype=bool)
        for (one, two), force in self.signals.contact_forces.items():
            if (one == name and two in others) or (two == name and one in others):
                touched |= force[rows] > 0
        return touched

    def _speed(
        self, name: str, rows: slice, along: FloatArray | None = None
    ) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Speed of an object's fastest point between samples [m/s], for every row.

        Args:
            name: The name of the object.
            rows: The samples that are looked at.
            along: The direction in which its origin counts as moved: what settles by its weight is
                not moved by a push from the side.
        """
        record, poses = self.objects[name], self.signals.object_poses[name]
        if along is not None:
            axis = along / np.linalg.norm(along)
            poses = np.hstack([np.outer(poses[:, :3] @ axis, axis), poses[:, 3:]])
        steps = balls_of(record).moved(poses[:-1], poses[1:])
        steps[record.put_samples(self.signals.times) - 1] = 0.0
        within = np.append(steps[rows][: len(poses[rows]) - 1], 0.0)
        return np.nan_to_num(within) / max(self.step_time, 1e-9)

    def _seconds(self, rows: BoolArray) -> str:
        return f"{np.count_nonzero(rows) * self.step_time:.2f} s"
