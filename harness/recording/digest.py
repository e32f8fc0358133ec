"""The digest of a run: equal bytes of what was commanded, recorded and judged, equal digest."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from harness.core.trajectory import JointTrajectory
from harness.recording.arrays import arrays_of
from harness.recording.run import Run
from harness.recording.verdict import Verdict

VERSION = b"armharness-digest/1"


def digest(run: Run, verdicts: Sequence[Verdict]) -> str:
    """SHA-256 over commanded trajectories, recorded signals and verdicts, in hex.

    Numbers enter bit by bit (little-endian float64 and int64; every NaN alike), each with its name
    and shape, signals sorted by name. No wall clock, title, path, line or wording enters.
    """
    hasher = hashlib.sha256(VERSION)
    for chunk in _chunks(run, verdicts):
        hasher.update(struct.pack("<Q", len(chunk)))
        hasher.update(chunk)
    return hasher.hexdigest()


def _chunks(run: Run, verdicts: Sequence[Verdict]) -> Iterator[bytes]:
    for step in run.steps:
        if step.trajectory is not None:
            yield b"trajectory"
            yield from _trajectory(step.trajectory)
    for name, array in sorted(arrays_of(run.signals).items()):
        yield name.encode()
        yield from _array(array)
    yield from _array(np.array([run.signals.clearance_cutoff]))
    for verdict in verdicts:
        yield b"verdict"
        yield verdict.status.encode()
        yield verdict.unit.encode()
        yield from _array(np.array([verdict.margin, verdict.time]))


def _array(array: np.ndarray[Any, Any]) -> Iterator[bytes]:
    if array.dtype.kind == "f":
        canonical = np.ascontiguousarray(array, dtype="<f8")
        missing = np.isnan(canonical)
        if missing.any():
            canonical = np.where(missing, np.nan, canonical)
    else:
        canonical = np.ascontiguousarray(array, dtype="<i8")
    yield f"{canonical.dtype.str}{array.shape}".encode()
    yield canonical.tobytes()


def _trajectory(trajectory: JointTrajectory) -> Iterator[bytes]:
    """Its parts in the order of their names."""
    for name in sorted(entry.name for entry in fields(trajectory)):
        yield name.encode()
        if name == "joint_names":
            yield from (joint.encode() for joint in trajectory.joint_names)
        else:
            yield from _array(getattr(trajectory, name))
