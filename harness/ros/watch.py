"""Whether the expectation holds that ends a step, from what the physics recorded so far."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.assertions.judge import judge
from harness.assertions.placed import PlacedExpectation
from harness.language.expectation import ExpectationFields
from harness.ports.external import ExternalRequest
from harness.recording.robot_record import RobotRecord
from harness.recording.run import ObjectRecord, Run
from harness.recording.step_record import StepRecord

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator

EVERY, SHARE = 0.5, 0.05
"""Simulated time between two looks [s], and at least this share of the step's time: a look reads
the whole record. Wall time has no part in it, so that a replay ends alike."""


@dataclass
class Watch:
    """Looks at one step's `until`."""

    request: ExternalRequest
    recorder: MujocoSimulator
    robot: RobotRecord
    objects: tuple[ObjectRecord, ...]

    def __post_init__(self) -> None:
        self._begin = self.recorder.time
        self._first = max(0, self.recorder.sample_count - 1)
        self._next = EVERY

    @property
    def elapsed(self) -> float:
        """Simulated time since the step began [s]."""
        return self.recorder.time - self._begin

    def holds(self) -> bool:
        """Whether the expectation passes now; False between two looks."""
        until = self.request.until
        if not isinstance(until, ExpectationFields) or self.elapsed < self._next - 1e-9:
            return False
        self._next = self.elapsed + max(EVERY, SHARE * self.elapsed)
        step = StepRecord(
            id=self.request.step,
            path=self.request.step,
            verb="",
            summary="",
            line=self.request.line,
            status="passed",
            start_time=self._begin,
            end_time=self.recorder.time,
            start_index=self._first,
            end_index=self.recorder.sample_count,
        )
        run = Run(
            scenario="",
            file="",
            case="",
            seed=0,
            robot=self.robot,
            objects=self.objects,
            attachments=(),
            steps=(step,),
            signals=self.recorder.finish(),
            unrecorded=("clearances", "planned_clearances"),
        )
        placed = PlacedExpectation.of(until, self.request.step, self.request.line)
        return judge(run, [placed])[0].status == "passed"
