"""What is observed on an executed run, before it is judged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from harness.assertions.facts import remembered_facts
from harness.engine.execute import Execution
from harness.observation.beliefs import believed_poses
from harness.observation.contacts import contact_records
from harness.observation.couplings import coupling_findings
from harness.observation.tracking import as_commanded, plan_against_physics
from harness.recording.run import Finding, Run
from harness.recording.signals import Signals
from harness.session.prepare import Prepared

if TYPE_CHECKING:
    from harness.observation.clearance import CoalClearance
    from harness.observation.measured_clearance import MeasuredClearance


def with_believed_poses(prepared: Prepared, execution: Execution, recorded: Signals) -> Signals:
    """The recording with the poses of objects that only the planner knows."""
    believed = believed_poses(execution.beliefs, recorded.joint_positions, prepared.kinematics)
    return replace(recorded, object_poses={**recorded.object_poses, **believed})


@remembered_facts()
def observed_run(
    prepared: Prepared,
    executed: Run,
    measured: Callable[[int], MeasuredClearance | None] = lambda _: None,
) -> Run:
    """The run with distances, contacts, and what physics and plan disagree about.

    Args:
        prepared: The scenario that was executed.
        executed: What was executed and recorded.
        measured: The distances in a part of the run that were measured while it went on.
    """
    from harness.observation.clearance import CoalClearance
    from harness.observation.held_clearance import with_held_distances
    from harness.observation.link_overlaps import link_overlap_findings, with_link_overlaps
    from harness.observation.looks_differ import looks_differ

    description = prepared.program.description
    observer = CoalClearance(description)
    signals = observer.observe(
        executed.signals,
        executed.objects,
        executed.attachments,
        prepared.observations.recorded_cutoff,
        measured,
    )
    run = replace(executed, signals=with_link_overlaps(signals, description))
    run = replace(run, signals=with_held_distances(run, observer))
    signals, findings = _compared_with_plan(prepared, run, observer)
    return replace(
        run,
        signals=signals,
        findings=(
            *run.findings,
            *looks_differ(run.objects),
            *link_overlap_findings(run),
            *findings,
        ),
        contacts=contact_records(run),
    )


def _compared_with_plan(
    prepared: Prepared, run: Run, observer: CoalClearance
) -> tuple[Signals, tuple[Finding, ...]]:
    """Where planner and physics disagreed; the signals with distances as planned where needed."""
    cutoff = run.signals.clearance_cutoff
    planned = as_commanded(run, prepared.kinematics)
    findings = plan_against_physics(
        run,
        planned,
        lambda motion, pairs: observer.distances(
            motion, run.objects, run.attachments, cutoff, pairs
        ),
    )
    findings = (*findings, *coupling_findings(run, prepared.program.description))
    if not prepared.observations.planned_clearances:
        return run.signals, findings
    observed = observer.observe(planned, run.objects, run.attachments, cutoff)
    return replace(run.signals, planned_clearances=observed.clearances), findings
