"""One case from file to report."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from harness.assertions.judge import judge
from harness.assertions.observations import merged
from harness.assertions.placed import PlacedExpectation
from harness.cell.program import Program, ProgramStep
from harness.core.activity import Activity
from harness.core.errors import HarnessError, Problem, SpecError
from harness.core.types import FloatArray
from harness.engine.execute import Execution, execute_program
from harness.language.reading.resolve import resolved_text
from harness.observation.beliefs import believed_poses
from harness.observation.contacts import contact_records
from harness.observation.tracking import as_commanded, plan_against_physics
from harness.ports import Touch
from harness.recording.digest import digest
from harness.recording.run import Outcome, Run, Signals, StepRecord, Verdict
from harness.recording.store import PAGE, StoredRun, write_run
from harness.reporting.explanation import explanation_lines
from harness.reporting.result import CaseResult, ProgressEvent, StepLine
from harness.reporting.terminal import verdict_warnings
from harness.session.camera_pictures import with_camera_pictures
from harness.session.failure_pictures import draw_pictures, with_pictures
from harness.session.physics import overlap_note, start_physics
from harness.session.prepare import Prepared, prepare
from harness.session.record import run_record
from harness.session.timing import Clock

if TYPE_CHECKING:
    from harness.session.timed_simulator import TimedSimulator

MOST_DRAWS = 100
"""Draws of a sample, the first included, until no objects overlap."""

Notify = Callable[[ProgressEvent], None]
Redraw = Callable[[int], Mapping[str, str]]


def run_case(
    path: Path,
    *,
    overrides: Mapping[str, str] | None = None,
    seed: int | None = None,
    report_dir: Path | None = None,
    stills: bool = True,
    page: bool = True,
    bag: bool = False,
    case: str = "",
    only_failed: bool = False,
    text: str | None = None,
    redraw: Redraw | None = None,
    strict: bool = False,
    on_progress: Notify = lambda _: None,
) -> CaseResult:
    """Compile, execute, judge and report one scenario.

    Args:
        path: The scenario file.
        overrides: Dotted path in the file -> new value, as YAML text.
        seed: Instead of the file's.
        report_dir: Folder to write; None writes nothing.
        stills: Whether to render a picture of every step.
        page: Whether the report gets its page.
        bag: Whether the report gets a rosbag2.
        case: Name of the case; empty when the file has one.
        only_failed: Whether to write a report only where the case does not pass.
        text: What would stand in the file; None: what does.
        redraw: Other overrides by the number of the draw, from 1, as long as objects overlap at the
            start; None draws no others.
        strict: Whether a warning of a verdict fails the case.
        on_progress: Told of every step.
    """
    clock = Clock()
    try:
        with clock.part("compile"):
            prepared, simulator, redraws = _started(path, overrides, seed, text, clock, redraw)
            overlaps = simulator.overlaps_at_start
    except SpecError as error:
        return CaseResult(
            str(path), case, path.name, "invalid", problems=tuple(error.problems),
            message="; ".join(problem.message for problem in error.problems[:1]),
        )  # fmt: skip
    program = prepared.program
    on_progress(ProgressEvent("compiled", 0, len(program.steps), program.title, "", 0.0, ""))

    def activity(what: str, done: int, total: int) -> None:
        on_progress(ProgressEvent("activity", done, total, what, "", 0.0, ""))

    try:
        run = _execute(prepared, simulator, str(path), clock, on_progress, report_dir, activity)
        del simulator  # frees the largest thing there is: the run has what it needs of its record
        run = replace(run, case=case)
        placed = _placed(program)
        bare, is_kept = run, report_dir is not None and not only_failed
        with clock.part("render"):
            run = with_camera_pictures(bare, program, placed, is_kept=is_kept, activity=activity)
        activity("judging", 0, 0)
        with clock.part("judge"):
            verdicts = judge(run, placed)
        warned = verdict_warnings(str(path), verdicts)
        outcome = _outcome(run, verdicts, warned if strict else ())
        _tell_verdicts(program, run, outcome, on_progress)
        fingerprint = digest(run, verdicts)
        notes: tuple[str, ...] = ()
        if outcome == "passed" and only_failed:
            report_dir = None
        if report_dir is not None:
            if only_failed:
                with clock.part("render"):
                    run = with_camera_pictures(
                        bare, program, placed, is_kept=True, activity=activity
                    )
            activity("writing the report", 0, 0)
            with clock.part("write"):
                run = with_pictures(run) if stills else run
                notes = _write(
                    report_dir,
                    prepared,
                    run,
                    verdicts,
                    outcome,
                    fingerprint,
                    clock,
                    stills,
                    page,
                    bag,
                    activity,
                )
            on_progress(ProgressEvent("written", 0, 0, "", outcome, run_time(run), str(report_dir)))
    except HarnessError as error:
        return CaseResult(
            str(path), case, program.title, "error", seed=program.seed, message=str(error),
            wall_times=clock.seconds,
        )  # fmt: skip
    return CaseResult(
        file=str(path),
        case=case,
        title=program.title,
        outcome=outcome,
        digest=fingerprint,
        seed=program.seed,
        sim_time=run_time(run),
        report_dir="" if report_dir is None else str(report_dir),
        page=str(report_dir / PAGE) if report_dir is not None and page else "",
        steps=tuple(step_line(step) for step in run.steps),
        verdicts=verdicts,
        message="\n".join(warned) if strict else "",
        notes=(
            *warned,
            *(finding.message for finding in prepared.about_file),
            *(overlap_note(prepared, touch) for touch in overlaps),
            *notes,
        ),
        overlap=-overlaps[0].distance if overlaps else 0.0,
        redraws=redraws,
        wall_times=clock.seconds,
    )


def run_time(run: Run) -> float:
    """Length of a run [s]."""
    return float(run.signals.times[-1])


def step_line(step: StepRecord) -> StepLine:
    """A step in one line."""
    return StepLine(
        id=step.id,
        verb=step.verb,
        summary=step.summary,
        status=step.status,
        error_code=step.error_code,
        message=step.message,
        sim_time=step.end_time - step.start_time,
        line=step.line,
        explanation=explanation_lines(step.explanation, step.message),
        path=step.path,
    )


def _started(
    path: Path,
    overrides: Mapping[str, str] | None,
    seed: int | None,
    text: str | None,
    clock: Clock,
    redraw: Redraw | None,
) -> tuple[Prepared, TimedSimulator, int]:
    """The scenario at its start, and how often it was drawn again until no objects overlapped.

    Raises:
        SpecError: With every problem of the file; or objects overlap in every draw.
    """
    last: list[Problem] = []
    for draw in range(MOST_DRAWS):
        drawn = overrides if redraw is None or not draw else redraw(draw)
        prepared = prepare(path, drawn, seed, text)
        simulator = start_physics(prepared, clock, _observed_links(prepared.program))
        if redraw is None or not simulator.overlaps_at_start:
            return prepared, simulator, draw
        last = [_no_free_draw(prepared, simulator.overlaps_at_start[0])]
    raise SpecError(last)


def _no_free_draw(prepared: Prepared, touch: Touch) -> Problem:
    return prepared.loaded.lines.problem(
        ("redraw_overlaps",),
        f"objects overlap in each of {MOST_DRAWS} draws; in the last one {touch.first} and"
        f" {touch.second} by {-1e3 * touch.distance:.3g} mm",
        "widen the distributions of `randomize`, or move what does not vary",
    )


def _observed_links(program: Program) -> list[str]:
    """Links whose poses the expectations need."""
    needed = merged(each.spec.observations() for each in _placed(program))
    links = set(program.description.link_names)
    return [name for name in needed.frames if name in links]


def _execute(
    prepared: Prepared,
    simulator: TimedSimulator,
    file: str,
    clock: Clock,
    on_progress: Notify,
    report_dir: Path | None,
    activity: Activity,
) -> Run:
    program = prepared.program
    activity("setting up planning and physics", 0, 0)
    needed = merged(each.spec.observations() for each in _placed(program))
    with clock.part("execute"):
        execution = execute_program(
            program,
            prepared.scene,
            prepared.kinematics,
            prepared.planner,
            simulator,
            _step_teller(program, on_progress, simulator),
        )
    activity("measuring distances and contacts", 0, 0)
    with clock.part("judge"):
        signals = simulator.finish()
        believed = believed_poses(execution.beliefs, signals.joint_positions, prepared.kinematics)
        signals = replace(signals, object_poses={**signals.object_poses, **believed})
        signals = _observe(prepared, signals, execution, needed.recorded_cutoff)
    # what is not physics in execution is planning
    executed = clock.seconds.pop("execute")
    clock.seconds["plan"] = max(0.0, executed - clock.seconds.get("simulate", 0.0))
    seeds = {program.step_locs[step.path]: step.options.seed for step in program.all_steps()}
    run = run_record(
        program,
        prepared.kinematics,
        execution,
        signals,
        file=file,
        source=prepared.loaded.text,
        resolved=resolved_text(prepared.loaded, seeds, folder=report_dir),
        notes=prepared.notes,
        overlaps=simulator.overlaps_at_start,
        about_file=prepared.about_file,
    )
    with clock.part("judge"):
        return _compared_with_plan(prepared, run, is_recorded=needed.planned_clearances)


def _compared_with_plan(prepared: Prepared, run: Run, *, is_recorded: bool) -> Run:
    """The run with what planner and physics disagreed on; distances as planned where asked for."""
    from harness.observation.clearance import CoalClearance

    observer = CoalClearance(prepared.program.description)
    cutoff = run.signals.clearance_cutoff

    def distances(signals: Signals) -> Mapping[tuple[str, str], FloatArray]:
        return observer.distances(signals, run.objects, run.attachments, cutoff)

    planned = as_commanded(run, prepared.kinematics)
    findings = plan_against_physics(run, planned, distances)
    signals = run.signals
    if is_recorded:
        observed = observer.observe(planned, run.objects, run.attachments, cutoff)
        signals = replace(signals, planned_clearances=observed.clearances)
    return replace(
        run,
        signals=signals,
        findings=(*run.findings, *findings),
        contacts=contact_records(run),
    )


def _observe(prepared: Prepared, signals: Signals, execution: Execution, cutoff: float) -> Signals:
    from harness.observation.clearance import CoalClearance

    observer = CoalClearance(prepared.program.description)
    return observer.observe(signals, execution.objects, execution.attachments, cutoff)


def _step_teller(program: Program, on_progress: Notify, simulator: TimedSimulator):  # noqa: ANN202
    places = {step.path: index for index, step in enumerate(program.steps)}
    total = len(program.steps)

    def tell(
        kind: Literal["step_started", "step_finished"],
        step: ProgramStep,
        record: StepRecord | None,
    ) -> None:
        on_progress(
            ProgressEvent(
                kind,
                places.get(step.path, -1),
                total,
                step.summary,
                record.status if record else "",
                simulator.time,
                record.message if record else "",
                time.monotonic(),
            )
        )

    return tell


def _placed(program: Program) -> list[PlacedExpectation]:
    return [PlacedExpectation.of(item.spec, item.step, item.line) for item in program.expectations]


def _outcome(run: Run, verdicts: tuple[Verdict, ...], warned: Sequence[str]) -> Outcome:
    is_good = not run.ended_early and all(verdict.status == "passed" for verdict in verdicts)
    is_good = is_good and not warned
    return "passed" if is_good else "failed"


def _tell_verdicts(program: Program, run: Run, outcome: Outcome, on_progress: Notify) -> None:
    total = len(program.steps)
    on_progress(ProgressEvent("judged", total, total, "", outcome, run_time(run), ""))


def _write(
    folder: Path,
    prepared: Prepared,
    run: Run,
    verdicts: tuple[Verdict, ...],
    outcome: Outcome,
    fingerprint: str,
    clock: Clock,
    stills: bool,
    page: bool,
    bag: bool,
    activity: Activity,
) -> tuple[str, ...]:
    """Write the report folder; what a person should know of it comes back as notes."""
    from harness.observation.visuals import mesh_records

    run = replace(run, meshes=mesh_records(run))
    stored = StoredRun(run, verdicts, outcome, fingerprint, dict(clock.seconds))

    def add(target: Path) -> tuple[str, ...]:
        notes = _draw_stills(prepared.program, run, target, activity) if stills else ()
        if page:
            activity("writing the page", 0, 0)
            from harness.reporting.html.write import write_page

            write_page(target, stored)
        if bag:
            activity("writing the bag", 0, 0)
            from harness.reporting.rosbag.write import BAG, write_bag

            write_bag(target / BAG, stored)
        return notes

    return write_run(
        folder, run, verdicts, outcome, fingerprint, stored.wall_times, extra=add
    )  # fmt: skip


def _draw_stills(program: Program, run: Run, target: Path, activity: Activity) -> tuple[str, ...]:
    from harness.cameras.stills import save_stills

    objects = program.all_objects()
    report = save_stills(program.description, objects, run, target / "images", activity=activity)
    draw_pictures(program.description, objects, run, target, activity)
    return (report.note,) if report.note else ()
