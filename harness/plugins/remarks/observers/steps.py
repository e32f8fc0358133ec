"""Waits that took no time, and motions that began nearer than planned."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from harness.recording.explanation import LoweredMargins
from harness.recording.run import Finding, ObjectRecord
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription
from harness.session.observation.observer import Observed, Observer


class Steps(Observer):
    """Waits that took no time, and pairs that may start a motion nearer than planned."""

    name: ClassVar[str] = "steps"

    def observe(
        self,
        steps: Sequence[StepRecord],
        signals: Signals,
        robot: RobotDescription,
        objects: Sequence[ObjectRecord],
    ) -> Observed:
        del signals, robot, objects
        return tuple(steps), findings_of(steps)


def findings_of(steps: Sequence[StepRecord]) -> tuple[Finding, ...]:
    """Waits that took no time, and pairs that may start a motion nearer than planned.

    Task Constructor allows the pair object-support while lifting; here it may stay as near as it
    stood, and no nearer.
    """
    found: list[Finding] = []
    for step in steps:
        if step.verb == "wait" and step.status == "passed" and step.end_time == step.start_time:
            message = f"`{step.summary}` held at once, so that nothing was waited for"
            found.append(Finding("held_at_once", message, step.start_time, step.id))
        lowered = step.explanation.find(LoweredMargins)
        for entry in lowered.lowered_margins if lowered else ():
            first, second = entry.pair
            distance = entry.start_distance * 1e3
            stood = f"{-distance:.1f} mm deep" if distance < 0 else f"{distance:.1f} mm apart"
            found.append(
                Finding(
                    kind="lowered_margin",
                    message=f"{first} and {second} stood {stood} when the motion began, and were"
                    " let stay so near, no nearer",
                    time=step.start_time,
                    step=step.id,
                    values=entry.plain(),
                )
            )
    return tuple(found)
