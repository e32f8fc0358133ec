"""The objects of a run that pictures and views are about."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.recording.run import Run

MOVED = 0.01  # [m]: farther than objects settle


def touched_objects(run: Run) -> set[str]:
    """Objects that the robot touched or carried, or that moved; without any, those that can."""
    links = set(run.robot.link_names)
    pairs = [contact.pair for contact in run.contacts if links & set(contact.pair)]
    touched = {name for pair in pairs for name in pair if name not in links}
    touched |= {held.represents for held in run.attachments}
    touched |= {name for name, poses in run.signals.object_poses.items() if _moves(poses[:, :3])}
    return touched or {obj.name for obj in run.objects if not obj.is_static}


def _moves(places: FloatArray) -> bool:
    axes = places.T.copy()  # NaN while absent; long rows are reduced fifty times as fast
    return len(places) > 0 and any(np.fmax.reduce(axes, 1) - np.fmin.reduce(axes, 1) > MOVED)
