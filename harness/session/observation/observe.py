"""What is observed on an executed run, before it is judged."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

from harness.core.registry import registry
from harness.judging.facts import remembered_facts
from harness.recording.run import Finding, Run
from harness.recording.signals import Signals
from harness.session.observation.observer import Observer
from harness.session.observation.tracking import as_commanded, plan_against_physics
from harness.session.prepare import Prepared


@remembered_facts()
def observed_signals(prepared: Prepared, run: Run) -> Signals:
    """The signals with distances, as verdicts and the digest need them."""
    from harness.session.observation.clearance import CoalClearance
    from harness.session.observation.held_clearance import with_held_distances
    from harness.session.observation.link_overlaps import with_excluded_links

    description, needed = prepared.program.description, prepared.observations
    cutoff, bodies = needed.recorded_cutoff, (run.objects, run.attachments)
    observer = CoalClearance(description)
    found = observer.observe(run.signals, *bodies, cutoff)
    signals = with_held_distances(run, with_excluded_links(found, description), observer)
    if not needed.planned_clearances:
        return signals
    commanded = as_commanded(run, prepared.ports.kinematics)
    planned = with_excluded_links(observer.observe(commanded, *bodies, cutoff), description)
    return replace(signals, planned_clearances=planned.clearances)


@remembered_facts()
def report_findings(prepared: Prepared, run: Run, signals: Signals) -> tuple[Finding, ...]:
    """The findings that only a report shows."""
    from harness.session.observation.clearance import CoalClearance

    description, cutoff = prepared.program.description, signals.clearance_cutoff
    observer = CoalClearance(description)
    differences = plan_against_physics(
        run,
        signals,
        as_commanded(run, prepared.ports.kinematics),
        lambda motion, pairs: observer.distances(
            motion, run.objects, run.attachments, cutoff, pairs
        ),
    )
    measured, observers = replace(run, signals=signals), registry(Observer.plugin_kind).values()
    found = chain.from_iterable(each().report(measured, prepared.program) for each in observers)
    return (*found, *differences)
