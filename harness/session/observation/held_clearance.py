"""Distances of what the hand holds or carries in the physics and the planner does not know of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.pose_arrays import IDENTITY
from harness.judging.contacts import attached
from harness.judging.distances import in_grip
from harness.judging.support import carried_by_hand
from harness.judging.temporal import bridged, episodes
from harness.recording.run import AttachmentRecord, Run
from harness.recording.signals import Signals
from harness.session.observation.clearance import CoalClearance


def with_held_distances(run: Run, signals: Signals, observer: CoalClearance) -> Signals:
    """Signals with distances of objects in the hand that are not attached.

    What the hand grips has no distance to the robot.
    """
    signals = _without_gripped(run, signals)
    holds = [] if "contact_forces" in run.unrecorded else _holds(run)
    if not holds:
        return signals
    held = {hold.object for hold in holds}
    pairs = {(name, other.name) for name in held for other in run.objects if other.name != name}
    found = observer.observe(signals, run.objects, holds, signals.clearance_cutoff, only=pairs)
    distances = dict(signals.clearances)
    for pair, values in found.clearances.items():
        known = distances.get(pair, np.full(len(values), np.nan))
        distances[pair] = np.where(np.isnan(known), values, known)
    return replace(signals, clearances=distances)


def _without_gripped(run: Run, signals: Signals) -> Signals:
    """The signals without distances of the robot, or an arm, to what its hand grips."""
    distances, links = dict(signals.clearances), dict(signals.clearance_links)
    names = {record.name for record in run.objects if record.in_simulation}
    arms = run.robot.of_arm
    holders = {"robot": run, **{arm: replace(run, robot=arms[arm]) for arm in arms}}
    for first, name in distances:
        if name not in names or first not in holders:
            continue
        if (mask := in_grip(holders[first], name)).any():
            distances[first, name] = np.where(mask, np.nan, distances[first, name])
            links[first, name] = np.where(mask, -1, links[first, name])
    return replace(signals, clearances=distances, clearance_links=links)


def _holds(run: Run) -> list[AttachmentRecord]:
    """Attachments to the TCP of objects that the hand holds or carries without one."""
    times, tcp = run.signals.times, run.robot.tcp_link
    return [
        AttachmentRecord(
            name, tcp, float(times[start]), float(times[stop - 1]), tuple(IDENTITY), name
        )
        for name, mask in carried_by_hand(run).items()
        for start, stop in bridged(times, episodes(mask & ~attached(run, name)))
    ]
