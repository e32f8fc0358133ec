"""What a plug-in observes on an executed run, before it is judged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from harness.cell.program import Program
from harness.core.registry import Plugin, registry
from harness.recording.run import Finding, ObjectRecord, Run
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

Observed = tuple[tuple[StepRecord, ...], tuple[Finding, ...]]


class Observer(Plugin):
    """Adds to the results of steps what the record shows of them."""

    plugin_kind: ClassVar[str] = "observer"

    def observe(
        self,
        steps: Sequence[StepRecord],
        signals: Signals,
        robot: RobotDescription,
        objects: Sequence[ObjectRecord],
    ) -> Observed:
        """The steps with what was observed, and findings of the whole run."""
        del signals, robot, objects
        return tuple(steps), ()

    def report(self, run: Run, program: Program) -> tuple[Finding, ...]:
        """Findings that a report alone shows, since they take time."""
        del run, program
        return ()


def observed(
    steps: Sequence[StepRecord],
    signals: Signals,
    robot: RobotDescription,
    objects: Sequence[ObjectRecord],
) -> Observed:
    """What all observers see, one after the other."""
    done, findings = tuple(steps), tuple[Finding, ...]()
    for observer in registry(Observer.plugin_kind).values():
        done, more = observer().observe(done, signals, robot, objects)
        findings += more
    return done, findings
