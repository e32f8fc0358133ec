"""external: programs outside command the arm."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.errors import StepFailed
from harness.judging.ends import check_end
from harness.language.base import Name, PositiveDuration
from harness.language.expectation import AnyExpectation, ExpectationFields
from harness.plugins.ros.external_programs import ExternalRequest, ExternalResult
from harness.ports.simulation import RecordingSimulator
from harness.recording.execution_failures import TimeoutFailure

NO_PROGRAMS = (
    "this step hands the arm to ROS 2 nodes; run the scenario with"
    " `harness grade SCENARIO --node COMMAND`, with `harness bridge SCENARIO`, or with"
    " `harness run SCENARIO --node COMMAND`"
)
DEFAULT_TIMEOUT = 60.0  # [s] of simulation


class External(Step):
    """Hand the arm over to ROS 2 nodes until an expectation holds.

    The nodes move the robot through its controllers on the ROS 2 graph, as they move the robot of
    Gazebo or a real one. `harness grade SCENARIO --node COMMAND` and `harness bridge` run a
    scenario with this step; every command is recorded, and `harness replay` repeats the run.
    """

    verb: ClassVar[str] = "external"
    plans: ClassVar[bool] = False
    keys_inside: ClassVar[tuple[str, ...]] = ("timeout",)
    results = (ExternalResult,)

    timeout: PositiveDuration | None = Field(
        default=DEFAULT_TIMEOUT,
        description="Simulated time that the nodes have [s]; without `until`, the step then ends.",
    )
    until: AnyExpectation | None = Field(
        default=None,
        description="The step ends when this holds. It is evaluated twice a simulated second, and "
        "after ten seconds whenever the step has become a twentieth longer.",
    )
    launch: Name | None = Field(
        default=None,
        description="The command that is started, by the name that the user gave it with `--node "
        "NAME=COMMAND`; the default is the only one that was given.",
    )

    def summary(self) -> str:
        return f"nodes, up to {self.timeout or DEFAULT_TIMEOUT:g} s"

    def ends(self) -> Iterator[ExpectationFields]:
        if self.until is not None:
            yield self.until

    def check(self, at: At) -> None:
        at.scope.take_time(self.timeout or DEFAULT_TIMEOUT, at.key("timeout"))
        if self.until is not None:
            check_end(self.until, at)

    def execute(self, cell: Cell) -> None:
        """Hand the arm over.

        Raises:
            StepFailed: TIMED_OUT, when `until` did not become true; COMMUNICATION_FAILURE, when
                nothing outside can be reached.
        """
        if not isinstance(cell.simulator, RecordingSimulator):  # nothing moves: a prediction
            return
        from harness.plugins.ros.handover import HandOver  # loads the physics

        if not isinstance(cell.external, HandOver):
            raise StepFailed("COMMUNICATION_FAILURE", NO_PROGRAMS)
        timeout, step = self.timeout or DEFAULT_TIMEOUT, cell.current
        begin = cell.simulator.time
        request = ExternalRequest(step.id, step.line, timeout, self.until, self.launch or "", cell)
        result = cell.external.hand_over(request)
        cell.report(result)
        if self.until is None or result.ended_by == "until":
            return
        spent = cell.simulator.time - begin
        why = {"exit": "the node ended", "stopped": "the session was stopped"}
        reason = why.get(result.ended_by, f"the nodes had {timeout:g} s")
        detail = f"; {result.detail}" if result.detail else ""
        raise StepFailed(
            "TIMED_OUT",
            f"`until` did not become true: {reason}, after {spent:.2f} s and"
            f" {result.commands} commands{detail}",
            TimeoutFailure(spent, timeout),
        )
