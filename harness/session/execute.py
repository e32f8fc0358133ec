"""Executes a program step by step, and records the result of each step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from weakref import proxy

from harness.cell.cell import Cell
from harness.cell.program import Program, ProgramStep
from harness.cell.runner import End, Failure, OnStep, RunEndedError
from harness.cell.scene_state import Belief, Presence, StepNotes
from harness.core.details import Details
from harness.core.errors import StepFailed
from harness.core.registry import registry
from harness.ports.external import ExternalSession
from harness.ports.motion_planning import PlanningPorts
from harness.ports.simulation import Simulator
from harness.recording.execution_failures import TimeoutFailure
from harness.recording.explanation import Explanation
from harness.recording.run import AttachmentRecord, ObjectRecord
from harness.recording.step_record import StepRecord, StepStatus
from harness.recording.step_results import SceneChange
from harness.steps import _tracker


@dataclass(frozen=True)
class Execution:
    """What executing a program leaves, besides the simulator's signals.

    Attributes:
        beliefs: Where objects of the planning scene alone stood, in order of time.
    """

    steps: tuple[StepRecord, ...]
    objects: tuple[ObjectRecord, ...]
    attachments: tuple[AttachmentRecord, ...]
    beliefs: Mapping[str, Sequence[Belief]]
    ended_early: str


@dataclass
class _Runner:
    on_step: OnStep
    keep_going: bool
    timestep: float
    cell: Cell = field(init=False)
    records: list[StepRecord] = field(default_factory=list[StepRecord])
    depth: int = 0

    def run(self, steps: Sequence[ProgramStep]) -> None:
        """Carry out steps in order; the first unexpected failure ends it."""
        for step in steps:
            self._run_step(step)

    def begin(self, step: ProgramStep) -> End:
        """Begin the record of a step; returns what completes it from the cell's notes."""
        cell = self.cell
        self.on_step(step, None)
        place = len(self.records)
        self.records.append(_not_reached(step))
        # the sample at the step's start belongs to it, so that no step is without samples
        start_time, start_index = cell.simulator.time, max(0, cell.simulator.sample_count - 1)

        def end(inner: Failure | None) -> None:
            failure = _own(inner) or _too_long(
                step, cell.simulator.time - start_time, self.timestep
            )
            status, message = _judge_step(step, failure)
            notes = cell.notes
            self.records[place] = replace(
                self.records[place],
                status=status,
                error_code=failure.code if failure else "",
                message=message,
                start_time=start_time,
                end_time=cell.simulator.time,
                start_index=start_index,
                end_index=cell.simulator.sample_count,
                trajectory=notes.trajectory,
                planner=notes.planner,
                explanation=notes.explanation + _details(step, failure, cell),
                result=notes.result,
            )
            self.on_step(step, self.records[place])
            if status == "failed" and (self.depth or not self.keep_going):
                if isinstance(inner, RunEndedError):
                    raise inner
                raise RunEndedError(failure or StepFailed("FAILURE", message), step.summary)

        return end

    def _run_step(self, step: ProgramStep) -> None:
        self.cell.step, self.cell.notes = step, StepNotes()
        end = self.begin(step)
        end(self._attempt(step))

    def _attempt(self, step: ProgramStep) -> Failure | None:
        self.depth += 1
        try:
            _tracker.execute(step, self.cell)
        except (StepFailed, RunEndedError) as failure:
            return failure
        finally:
            self.depth -= 1
        return None


class ProgramExecution:
    """A program on adapters that stand at its start state; steps are run one after the other.

    Attributes:
        program: What is executed; one that differs only in steps and expectations may replace it.
        ended_early: The failure that ended the execution; empty while there is none.
    """

    def __init__(
        self,
        program: Program,
        ports: PlanningPorts,
        simulator: Simulator,
        on_step: OnStep,
        *,
        keep_going: bool = False,
        external: ExternalSession | None = None,
    ) -> None:
        """Put the world's objects into the scene.

        Args:
            ports: The planning scene is empty; the world's objects are added here.
            simulator: The simulator at the start state, with every object of the program prepared
                and the world's objects present.
            keep_going: Whether a failed step of the file does not prevent the next one; a
                step made of others ends with the first of them that fails.
            external: Programs to which a step may hand the robot over; None: such a step does
                nothing.
        """
        self.program = program
        self.ended_early = ""
        self._runner = _Runner(on_step, keep_going, program.world.timestep)
        self.cell = self._runner.cell = Cell(
            robot=program.description,
            scene=ports.scene,
            kinematics=ports.kinematics,
            planner=ports.planner,
            simulator=simulator,
            later_objects=program.later_objects,
            runner=proxy(self._runner),  # no cycle: memory is free without the collector
            cameras=program.cameras,
            external=external,
        )
        for obj in program.world.objects:
            self.cell.presence[obj.name] = Presence(obj, obj.pose, [[0.0, float("inf")]])
            self.cell.believe(obj.name, obj.pose)
            if obj.in_planning:
                ports.scene.add_object(obj, obj.pose)

    @property
    def records(self) -> list[StepRecord]:
        return self._runner.records

    def run(self, steps: Sequence[ProgramStep]) -> None:
        """Carry out steps in order; the first unexpected failure ends it, as `ended_early` says."""
        try:
            self._runner.run(steps)
        except RunEndedError as ended:
            self.ended_early = str(ended.failure)
        if self.ended_early or [step.path for step in steps[-1:]] == [self.program.steps[-1].path]:
            self._show_last_change()

    def _show_last_change(self) -> None:
        """Let the physics show what the last step did where it put, added or removed objects."""
        simulator = self.cell.simulator
        changes = (record for record in self.records if record.result.find(SceneChange))
        if any(record.end_index == simulator.sample_count for record in changes):
            simulator.hold(self.program.world.timestep)

    def finish(self) -> Execution:
        """What the steps so far leave; those that were not run are not reached."""
        cell = self.cell
        presences = cell.presence.values()
        return Execution(
            steps=_with_unreached(self.program, self.records, cell.simulator),
            objects=tuple(presence.record(cell.simulator.time) for presence in presences),
            attachments=tuple(cell.attachments),
            beliefs=cell.beliefs,
            ended_early=self.ended_early,
        )


def _own(failure: Failure | None) -> StepFailed | None:
    """A step's failure; of a failed step inside it, only its name, since that step has its own."""
    if isinstance(failure, RunEndedError):
        return StepFailed(failure.failure.code, f"its step `{failure.summary}` failed")
    return failure


def _details(step: ProgramStep, failure: StepFailed | None, cell: Cell) -> Details:
    """A failure's details, with what to do about it where that is known."""
    if failure is None:
        return Details()
    explainers = registry("explainer").values()
    with cell.inside(step):
        text = next((said for each in explainers if (said := each().advice(failure, cell))), "")
    return failure.details + Details.of(Explanation(advice=text) if text else None)


def _too_long(step: ProgramStep, seconds: float, timestep: float) -> StepFailed | None:
    """The failure of a step that ended, but a step of the physics or more after its timeout."""
    timeout = step.spec.timeout
    if timeout is None or seconds - timeout < (1 - 1e-6) * timestep:
        return None
    return StepFailed(
        "TIMED_OUT",
        f"the step took {seconds:.3f} s, its timeout is {timeout:g} s",
        TimeoutFailure(seconds, timeout),
    )


def _not_reached(step: ProgramStep) -> StepRecord:
    return StepRecord(
        id=step.id,
        path=step.path,
        verb=step.spec.verb,
        summary=step.summary,
        line=step.line,
        status="not reached",
        expected_error=step.spec.expect_error or "",
        arm=step.arm,
    )


def _judge_step(step: ProgramStep, failure: StepFailed | None) -> tuple[StepStatus, str]:
    """Whether a step did what the file says, and what to say when it did not."""
    expected = step.spec.expect_error
    if expected is None:
        return ("failed", failure.message) if failure else ("passed", "")
    if failure is None:
        return "failed", f"expected to fail with {expected}, but it succeeded"
    if failure.code != expected:
        return "failed", f"expected {expected}, but it failed with {failure}"
    return "expected error", failure.message


def _with_unreached(
    program: Program, records: list[StepRecord], simulator: Simulator
) -> tuple[StepRecord, ...]:
    """Records in execution order, then the steps of the file that were never reached."""
    reached = {record.path for record in records}
    end = {"start_time": simulator.time, "end_time": simulator.time}
    index = {"start_index": simulator.sample_count, "end_index": simulator.sample_count}
    unreached = [
        replace(_not_reached(step), **end, **index)
        for step in program.all_steps()
        if step.path not in reached
    ]
    return (*records, *unreached)
