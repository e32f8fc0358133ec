"""What is observed on an executed run, before it is judged."""

from __future__ import annotations

from dataclasses import replace

from harness.core.activity import Activity
from harness.engine.execute import Execution
from harness.observation.beliefs import believed_poses
from harness.observation.contacts import contact_records
from harness.observation.tracking import as_commanded, plan_against_physics
from harness.recording.run import Finding, MeshRecord, Run, Signals
from harness.session.pictures import camera_pictures, with_picture_names
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest
from harness.session.timing import Clock


def with_distances(prepared: Prepared, execution: Execution, recorded: Signals) -> Signals:
    """The recording with the poses of objects that only the planner knows, and with distances."""
    from harness.observation.clearance import CoalClearance
    from harness.observation.link_overlaps import with_link_overlaps

    believed = believed_poses(execution.beliefs, recorded.joint_positions, prepared.kinematics)
    signals = replace(recorded, object_poses={**recorded.object_poses, **believed})
    description = prepared.program.description
    cutoff = prepared.observations.recorded_cutoff
    observed = CoalClearance(description).observe(
        signals, execution.objects, execution.attachments, cutoff
    )
    return with_link_overlaps(observed, description)


def observed_run(
    request: RunRequest,
    prepared: Prepared,
    executed: Run,
    clock: Clock,
    activity: Activity,
    *,
    is_kept: bool,
) -> Run:
    """The whole run: with findings, contacts, pictures, and meshes where it is kept.

    Args:
        request: Of the case.
        prepared: The scenario.
        executed: What was executed and recorded.
        clock: Takes the time of each part.
        activity: Called with the progress.
        is_kept: Whether the run is written; otherwise only what a verdict reads is drawn.
    """
    with clock.part("judge"):
        signals, findings = _compared_with_plan(prepared, executed)
        contacts = contact_records(executed)
    with clock.part("render"):
        pictures = camera_pictures(executed, prepared, is_kept=is_kept, activity=activity)
        meshes = _mesh_records(executed) if is_kept else ()
        is_drawn = is_kept and request.stills
        steps = with_picture_names(executed.steps) if is_drawn else executed.steps
    return replace(
        executed,
        steps=steps,
        signals=signals,
        findings=(*executed.findings, *_about_shapes(executed), *findings, *pictures.findings),
        contacts=contacts,
        meshes=meshes,
        captures=pictures.captures,
        videos=pictures.videos,
        files=pictures.files,
    )


def _compared_with_plan(prepared: Prepared, run: Run) -> tuple[Signals, tuple[Finding, ...]]:
    """Where planner and physics disagreed; the signals with distances as planned where needed."""
    from harness.observation.clearance import CoalClearance

    observer = CoalClearance(prepared.program.description)
    cutoff = run.signals.clearance_cutoff
    planned = as_commanded(run, prepared.kinematics)
    findings = plan_against_physics(
        run,
        planned,
        lambda signals: observer.distances(signals, run.objects, run.attachments, cutoff),
    )
    if not prepared.observations.planned_clearances:
        return run.signals, findings
    observed = observer.observe(planned, run.objects, run.attachments, cutoff)
    return replace(run.signals, planned_clearances=observed.clearances), findings


def _about_shapes(run: Run) -> tuple[Finding, ...]:
    """Where visuals differ from collision shapes, and links that overlap."""
    from harness.observation.link_overlaps import link_overlap_findings
    from harness.observation.looks_differ import looks_differ

    return (*looks_differ(run.objects), *link_overlap_findings(run))


def _mesh_records(run: Run) -> tuple[MeshRecord, ...]:
    from harness.observation.visuals import mesh_records  # reads mesh files

    return mesh_records(run)
