"""One case from file to report: load, compile, execute, observe, judge, write."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from functools import partial
from pathlib import Path

from harness.core.errors import HarnessError, SpecError
from harness.core.memory import free_memory
from harness.judging.facts import remembered_facts
from harness.judging.judge import judge
from harness.ports.scene import Touch
from harness.recording.digest import digest
from harness.recording.files import write_files
from harness.recording.run import Run
from harness.recording.stored_run import PAGE, StoredRun
from harness.recording.write_run import write_run
from harness.reporting.reporter import Reports
from harness.reporting.result import CaseResult, StepLine
from harness.reporting.terminal import verdict_warnings
from harness.session.execute import ProgramExecution
from harness.session.external import ExternalSession, MakeSession, NoPrograms
from harness.session.observation.observe import explained_run, observed_run, with_believed_poses
from harness.session.observation.tracking import never_held
from harness.session.pictures import Drawings, Pictures
from harness.session.prepare import Prepared
from harness.session.progress import Notify, Progress
from harness.session.record import executed_run, resolved_scenario
from harness.session.run_request import RunRequest
from harness.session.start import Start, overlap_note, start_case
from harness.session.timing import Clock


def run_case(
    request: RunRequest,
    notify: Notify = lambda _: None,
    make_session: MakeSession = NoPrograms,
    start: Callable[[RunRequest, Clock], Start] = start_case,
) -> CaseResult:
    """Load, compile, execute, observe, judge and report one case.

    Args:
        request: The case, and what is written of it.
        notify: Called with the case's progress.
        make_session: Makes the session of the programs to which a step hands the robot over.
        start: Prepares the case, with the simulator or a robot in its place.
    """
    clock = Clock()
    try:
        with clock.part("compile"):
            begun = start(request, clock)
    except SpecError as error:
        return _invalid(request, error)
    prepared, overlaps, draw = begun.prepared, begun.simulator.overlaps_at_start, begun.draw
    progress = Progress(notify, prepared.program)
    progress.compiled()
    try:
        with ExitStack() as stack:
            pictures = stack.enter_context(closing(Pictures(request, prepared)))
            session = make_session(prepared, begun.simulator)
            executed = _executed(request, begun, clock, progress, session)
            refusal = session.refusal()
            del begun, session  # the simulator is the largest object; the run holds its recording
            pictures.executed(executed)
            free_memory()
            judged = _judged(request, executed, prepared, pictures, clock, progress)
            if refusal and judged.outcome != "passed":
                judged = replace(judged, outcome="error")
            result = _result(request, prepared, judged, overlaps, draw, refusal)
            progress.judged(result)
            if request.report_dir is None or (request.only_failed and result.outcome == "passed"):
                return result
            with clock.part("judge"):
                run = replace(judged.run, resolved=resolved_scenario(request, prepared))
                judged = replace(judged, run=explained_run(prepared, run))
            return _reported(request, request.report_dir, judged, result, pictures, clock, progress)
    except HarnessError as error:
        return _broken(request, prepared, clock, error)


def _executed(
    request: RunRequest,
    start: Start,
    clock: Clock,
    progress: Progress,
    session: ExternalSession,
) -> Run:
    """Plan and simulate the steps, and record what happens."""
    prepared, simulator, _ = start
    progress.activity("setting up planning and physics")

    with clock.part("execute"):
        program_execution = ProgramExecution(
            prepared.program,
            prepared.ports,
            simulator,
            partial(progress.step, simulator),
            external=session,
        )
        program_execution.run(prepared.program.steps)
        execution = program_execution.finish()
    # what is not physics in execution is planning
    executed = clock.seconds.pop("execute")
    clock.seconds["plan"] = max(0.0, executed - clock.seconds.get("simulate", 0.0))
    signals = with_believed_poses(prepared, execution, simulator.finish())
    run = executed_run(request, prepared, execution, signals, simulator.overlaps_at_start)
    return replace(
        run,
        commands=session.commands,
        timestep=simulator.timestep,
        unrecorded=simulator.unrecorded,
    )


@remembered_facts()
def _judged(
    request: RunRequest,
    executed: Run,
    prepared: Prepared,
    pictures: Pictures,
    clock: Clock,
    progress: Progress,
) -> StoredRun:
    """The observed run with its verdicts; a strict request fails with a warning."""
    progress.activity("measuring distances")
    with clock.part("judge"):
        run = observed_run(prepared, executed)
    with clock.part("render"):
        run = pictures.captured(run, progress.activity)
    progress.activity("judging")
    with clock.part("judge"):
        verdicts = judge(run, prepared.expectations)
        is_good = not run.ended_early and all(verdict.status == "passed" for verdict in verdicts)
        if request.strict and verdict_warnings(str(request.file), verdicts):
            is_good = False
        outcome = "passed" if is_good else "failed"
        return StoredRun(run, verdicts, outcome, digest(run, verdicts), clock.seconds)


def _result(
    request: RunRequest,
    prepared: Prepared,
    judged: StoredRun,
    overlaps: Sequence[Touch],
    draw: int,
    refusal: str,
) -> CaseResult:
    """The outcome of a judged case of which no report is written yet."""
    warned = verdict_warnings(str(request.file), judged.verdicts)
    message = "\n".join(warned) if request.strict else ""
    return CaseResult(
        file=str(request.file),
        case=request.case,
        title=prepared.program.title,
        outcome=judged.outcome,
        digest=judged.digest,
        seed=prepared.program.seed,
        sim_time=judged.run.duration,
        steps=tuple(StepLine.of(step) for step in judged.run.steps),
        verdicts=judged.verdicts,
        message=refusal if judged.outcome == "error" else message,
        notes=(*warned, *_notes(prepared, overlaps), *never_held(judged.run)),
        overlap=-overlaps[0].distance if overlaps else 0.0,
        redraws=draw,
        values=request.redraw.redrawn(draw).values if request.redraw is not None and draw else {},
        wall_times=dict(judged.wall_times),
    )


def _reported(
    request: RunRequest,
    folder: Path,
    judged: StoredRun,
    result: CaseResult,
    pictures: Pictures,
    clock: Clock,
    progress: Progress,
) -> CaseResult:
    """The result of a case with its report, which is written here.

    Raises:
        HarnessError: The folder cannot be written, or a reporter fails.
    """
    progress.activity("writing the report")
    pictures.begin()
    drawings, rendered = Drawings(), clock.seconds.get("render", 0.0)
    names = (*["html"] * request.page, *["rosbag"] * request.bag, *request.reporters)
    reports = Reports(names)

    def complete() -> StoredRun:
        nonlocal judged, drawings
        reports.begin(judged)
        with clock.part("render"):
            run, drawings = pictures.drawn(judged.run, progress.activity)
        judged = replace(judged, run=run)
        return judged

    def add(target: Path) -> None:
        write_files(target, drawings.images)
        reports.write(target, judged, progress.activity)

    with clock.part("write"):
        write_run(folder, judged, add, complete)
    clock.seconds["write"] -= clock.seconds["render"] - rendered  # what was waited for
    progress.written(judged, str(folder))
    return replace(
        result,
        report_dir=str(folder),
        page=str(folder / PAGE) if request.page else "",
        notes=(*result.notes, drawings.note) if drawings.note else result.notes,
        wall_times=clock.seconds,
    )


def _notes(prepared: Prepared, overlaps: Sequence[Touch]) -> tuple[str, ...]:
    """What the user should know of the scenario file, and of objects that overlap."""
    about_file = (finding.message for finding in prepared.about_file)
    return (*about_file, *(overlap_note(prepared, touch) for touch in overlaps))


def _invalid(request: RunRequest, error: SpecError) -> CaseResult:
    return CaseResult(
        str(request.file),
        request.case,
        request.file.name,
        "invalid",
        problems=tuple(error.problems),
        message="; ".join(problem.message for problem in error.problems[:1]),
    )


def _broken(
    request: RunRequest, prepared: Prepared, clock: Clock, error: HarnessError
) -> CaseResult:
    return CaseResult(
        str(request.file),
        request.case,
        prepared.program.title,
        "error",
        seed=prepared.program.seed,
        message=str(error),
        wall_times=clock.seconds,
    )
