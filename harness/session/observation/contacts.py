"""Contacts of a run: bodies, first time, duration, peak force."""

from __future__ import annotations

import numpy as np

from harness.judging.collision import colliding
from harness.recording.run import Run
from harness.recording.signals import ContactRecord


def contact_records(run: Run) -> tuple[ContactRecord, ...]:
    """Every pair that touched, allowed or not, the first to touch first."""
    if "contact_forces" in run.unrecorded:
        return ()
    found: list[ContactRecord] = []
    for pair, force in run.signals.contact_forces.items():
        rows = np.flatnonzero(force > 0)
        if len(rows):
            found.append(
                ContactRecord(
                    pair=pair,
                    first_time=float(run.signals.times[rows[0]]),
                    duration=len(rows) * run.timestep,
                    peak_force=float(force[rows].max()),
                    is_collision=bool(colliding(run, pair).any()),
                )
            )
    return tuple(sorted(found, key=lambda contact: (contact.first_time, contact.pair)))
