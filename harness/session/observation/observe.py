"""What is observed on an executed run, before it is judged."""

from __future__ import annotations

from dataclasses import replace

from harness.judging.facts import remembered_facts
from harness.recording.run import Run
from harness.recording.signals import Signals
from harness.session.execute import Execution
from harness.session.observation.beliefs import believed_poses
from harness.session.observation.contacts import contact_records
from harness.session.observation.couplings import coupling_findings
from harness.session.observation.tracking import as_commanded, plan_against_physics
from harness.session.prepare import Prepared


def with_believed_poses(prepared: Prepared, execution: Execution, recorded: Signals) -> Signals:
    """The recording with the poses of objects that only the planner knows."""
    kinematics = prepared.ports.kinematics
    believed = believed_poses(execution.beliefs, recorded.joint_positions, kinematics)
    return replace(recorded, object_poses={**recorded.object_poses, **believed})


def observed_run(
    prepared: Prepared,
    executed: Run,
) -> Run:
    """The run with distances, as verdicts and the digest need them.

    Args:
        prepared: The scenario that was executed.
        executed: What was executed and recorded.
    """
    from harness.session.observation.clearance import CoalClearance
    from harness.session.observation.held_clearance import with_held_distances
    from harness.session.observation.link_overlaps import with_excluded_links

    description, needed = prepared.program.description, prepared.observations
    cutoff, bodies = needed.recorded_cutoff, (executed.objects, executed.attachments)
    observer = CoalClearance(description)
    signals = observer.observe(executed.signals, *bodies, cutoff)
    run = replace(executed, signals=with_excluded_links(signals, description))
    run = replace(run, signals=with_held_distances(run, observer))
    if not needed.planned_clearances:
        return run
    commanded = as_commanded(run, prepared.ports.kinematics)
    planned = with_excluded_links(observer.observe(commanded, *bodies, cutoff), description)
    return replace(run, signals=replace(run.signals, planned_clearances=planned.clearances))


@remembered_facts()
def explained_run(prepared: Prepared, run: Run) -> Run:
    """The observed run with its contacts, and the findings that only its report shows."""
    from harness.session.observation.clearance import CoalClearance
    from harness.session.observation.link_overlaps import link_overlap_findings
    from harness.session.observation.looks_differ import looks_differ

    description, cutoff = prepared.program.description, run.signals.clearance_cutoff
    observer = CoalClearance(description)
    planned = as_commanded(run, prepared.ports.kinematics)
    differences = plan_against_physics(
        run,
        planned,
        lambda motion, pairs: observer.distances(
            motion, run.objects, run.attachments, cutoff, pairs
        ),
    )
    findings = (
        *(*run.findings, *looks_differ(run.objects), *link_overlap_findings(run)),
        *(*differences, *coupling_findings(run, description)),
    )
    return replace(run, findings=findings, contacts=contact_records(run))
