"""One case from file to report: load, compile, execute, observe, judge, write."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from harness.core.errors import HarnessError, SpecError
from harness.core.memory import return_memory
from harness.judging.facts import remembered_facts
from harness.judging.joints import stood_still
from harness.judging.judge import judge
from harness.ports.scene import Touch
from harness.ports.simulation import RecordingSimulator
from harness.recording.digest import digest as digest_of
from harness.recording.run import Run
from harness.recording.stored_run import PAGE, StoredRun
from harness.recording.write_run import run_folder, write_document
from harness.reporting.progress_events import Compiled, Drawing, Judged
from harness.reporting.reporter import Reports
from harness.reporting.result import CaseResult, StepLine
from harness.reporting.terminal import verdict_warnings
from harness.session.execute import ProgramExecution
from harness.session.observation.tracking import never_held
from harness.session.pictures import Pictures
from harness.session.prepare import Prepared
from harness.session.progress import Notify, Progress
from harness.session.run_builder import RunBuilder
from harness.session.run_request import RunRequest
from harness.session.start import Start, overlap_note, start_simulated
from harness.session.timing import Clock


def run_case(
    request: RunRequest,
    notify: Notify = lambda _: None,
    start: Callable[[RunRequest, Clock], Start[RecordingSimulator]] = start_simulated,
) -> CaseResult:
    """Load, compile, execute, observe, judge and report one case.

    Args:
        start: Prepares the case, with the simulator or a robot in its place.
    """
    clock = Clock()
    try:
        with clock.part("compile"):
            begun = start(request, clock)
    except SpecError as error:
        return _invalid(request, error)
    prepared = begun.prepared
    progress = Progress(notify, _reports(request), prepared.program)
    progress.notify(Compiled())
    try:
        with closing(Pictures(request, prepared)) as pictures:
            case = _Case(request, prepared, clock, progress, pictures)
            builder, refusal = case.execute(begun)
            overlaps, draw = begun.simulator.overlaps_at_start, begun.draw
            del begun  # the simulator is the largest object; the builder holds its recording
            return_memory()
            with remembered_facts():
                run = case.observe(builder)
                result = case.judge(run, overlaps, draw, refusal)
            progress.notify(Judged(result))
            if request.report_dir is None or (request.only_failed and result.outcome == "passed"):
                return result
            return case.report(request.report_dir, run, builder.resolved, result)
    except HarnessError as error:
        return _broken(request, prepared, clock, error)


@dataclass(frozen=True)
class _Case:
    """The stages of a case that was started, in their order."""

    request: RunRequest
    prepared: Prepared
    clock: Clock
    progress: Progress
    pictures: Pictures

    def execute(self, start: Start[RecordingSimulator]) -> tuple[RunBuilder, str]:
        """Plan and simulate the steps; the record, and why external programs are not judged."""
        prepared, simulator, session = self.prepared, start.simulator, start.open_session()
        self.progress.activity("setting up planning and physics")
        with self.clock.part("plan"):  # what is not physics in execution
            on_step = partial(self.progress.step, simulator)
            execution = ProgramExecution(
                prepared.program, prepared.ports, simulator, on_step, external=session
            )
            execution.run(prepared.program.steps)
            done = execution.finish()
        commands = session.commands if session is not None else ()
        builder = RunBuilder(self.request, prepared, done, simulator, commands)
        self.pictures.executed(builder.record)
        return builder, session.refusal() if session is not None else ""

    def observe(self, builder: RunBuilder) -> Run:
        """The run, with what is measured on it and the pictures that verdicts read."""
        self.progress.activity("measuring distances")
        with self.clock.part("judge"):
            builder.observe()
        with self.clock.part("render"):
            return builder.build(self.pictures.captured(self.progress.activity))

    def judge(self, run: Run, overlaps: Sequence[Touch], draw: int, refusal: str) -> CaseResult:
        """The outcome, before a report is written; a strict request fails with a warning."""
        self.progress.activity("judging")
        request, program = self.request, self.prepared.program
        with self.clock.part("judge"):
            verdicts = judge(run, self.prepared.expectations)
            warned = verdict_warnings(request.shown_file, verdicts)
            is_good = not run.ended_early and all(each.status == "passed" for each in verdicts)
            is_good = is_good and not (request.strict and warned)
            outcome = "passed" if is_good else "error" if refusal else "failed"
            digest = digest_of(run, verdicts)
        message = "\n".join(warned) if request.strict else ""
        return CaseResult(
            file=request.shown_file,
            case=request.case,
            title=program.title,
            outcome=outcome,
            digest=digest,
            seed=program.seed,
            sim_time=run.duration,
            steps=tuple(StepLine.of(step) for step in run.steps),
            verdicts=verdicts,
            message=refusal if outcome == "error" else message,
            notes=(*warned, *_notes(self.prepared, overlaps), *never_held(run), *_noted(run)),
            is_idle=stood_still(run),
            overlap=-overlaps[0].distance if overlaps else 0.0,
            redraws=draw,
            values=request.redraw(draw).values if request.redraw and draw else {},
            wall_times=dict(self.clock.seconds),
        )

    def report(self, folder: Path, run: Run, resolved: str, result: CaseResult) -> CaseResult:
        """The result of a case with its report, which is written here.

        Raises:
            HarnessError: The folder cannot be written, or a reporter fails.
        """
        clock, activity, verdicts = self.clock, self.progress.activity, result.verdicts
        activity("writing the report")
        self.pictures.begin()
        with clock.part("write"), run_folder(folder, run) as target:
            self.progress.reports.hear(Drawing(run, verdicts))  # in this process alone
            with clock.part("render"):
                drawings = self.pictures.drawn(activity)
            stored = StoredRun(
                run, verdicts, result.outcome, result.digest, clock.seconds, resolved, drawings
            )
            write_document(target, stored)
            self.progress.reports.write(target, stored, activity)
        return replace(
            result,
            report_dir=str(folder),
            page=str(folder / PAGE) if self.request.page else "",
            notes=(*result.notes, drawings.note) if drawings.note else result.notes,
            wall_times=clock.seconds,
        )


def _reports(request: RunRequest) -> Reports:
    if request.report_dir is None:
        return Reports(())
    return Reports((*["html"] * request.page, *["rosbag"] * request.bag, *request.reporters))


def _notes(prepared: Prepared, overlaps: Sequence[Touch]) -> tuple[str, ...]:
    """What the user should know of the scenario file, and of objects that overlap."""
    about_file = (finding.message for finding in prepared.about_file)
    return (*about_file, *(overlap_note(prepared, touch) for touch in overlaps))


def _noted(run: Run) -> tuple[str, ...]:
    """What observers found that makes a run worthless, whatever its verdicts say."""
    return tuple(each.message for each in run.findings if each.kind == "fallen_part")


def _invalid(request: RunRequest, error: SpecError) -> CaseResult:
    return CaseResult(
        request.shown_file,
        request.case,
        Path(request.shown_file).name,
        "invalid",
        problems=tuple(error.problems),
        message="; ".join(problem.message for problem in error.problems[:1]),
    )


def _broken(
    request: RunRequest, prepared: Prepared, clock: Clock, error: HarnessError
) -> CaseResult:
    return CaseResult(
        request.shown_file,
        request.case,
        prepared.program.title,
        "error",
        seed=prepared.program.seed,
        message=str(error),
        wall_times=clock.seconds,
    )
