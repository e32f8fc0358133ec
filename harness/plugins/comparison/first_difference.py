"""Where the recordings of two runs part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.recording.arrays import arrays_of
from harness.recording.run import Run

DERIVED = ("clearance", "planned_clearances")  # drawn between samples: they part a little too early


OF_JOINTS: dict[str, tuple[str, str | None]] = {
    "joint_positions": ("position", ""),
    "joint_velocities": ("velocity", "/s"),
    "joint_efforts": ("effort", None),
    "joint_commands": ("commanded position", ""),
    "joint_command_velocities": ("commanded velocity", "/s"),
}
"""Signals with a column for each joint, in words, and what follows a position's unit."""

OF_PAIRS: dict[str, tuple[str, str]] = {
    "contact_forces": ("contact force between", "N"),
    "presses": ("push between", "N"),
    "frictions": ("friction between", "N"),
    "pulls": ("pull between", "N"),
    "support_forces": ("support between", "N"),
    "clearances": ("distance between", "m"),
    "planned_clearances": ("planned distance between", "m"),
}
"""Signals of two bodies, in words, and their units."""

POSE = ("x", "y", "z", *(f"{part} of the quaternion" for part in "wxyz"))


@dataclass(frozen=True)
class FirstDifference:
    """Where two recordings part: the first sample, and the signal that differs most there.

    Attributes:
        step: Title of the step it happened in; empty when the runs part before the first.
        signal: Its name, with the column's where it is a joint's or a part of a pose.
        time: The time of the sample [s].
        unit: The unit of the values; empty where none is known.
    """

    step: str
    signal: str
    time: float
    before: float
    after: float
    unit: str = ""


def first_difference(one: Run, two: Run) -> FirstDifference | None:
    """The first sample at which recorded signals differ; None when they are the same bits."""
    ours, theirs = arrays_of(one.signals), arrays_of(two.signals)
    count = min(len(one.signals.times), len(two.signals.times))
    shared = sorted(ours.keys() & theirs.keys())
    recorded = [name for name in shared if not name.startswith(DERIVED)]
    best = _earliest(ours, theirs, recorded, count) or _earliest(ours, theirs, shared, count)
    if best is None:
        return _longer(one, two, count)
    row, name = best
    before, after = np.atleast_1d(ours[name][row]), np.atleast_1d(theirs[name][row])
    apart = np.where(np.isnan(before) & np.isnan(after), 0.0, np.abs(before - after))
    column = int(np.argmax(np.nan_to_num(apart, nan=np.inf)))
    signal, unit = _signal_name(one, name, column, len(before))
    return FirstDifference(
        _step_at(one, row),
        signal,
        float(one.signals.times[row]),
        float(before[column]),
        float(after[column]),
        unit,
    )


def _earliest(
    ours: Mapping[str, np.ndarray[Any, Any]],
    theirs: Mapping[str, np.ndarray[Any, Any]],
    names: Sequence[str],
    count: int,
) -> tuple[int, str] | None:
    best: tuple[int, str] | None = None
    for name in names:
        row = _first_row(ours[name][:count], theirs[name][:count])
        if row is not None and (best is None or row < best[0]):
            best = row, name
    return best


def _first_row(one: np.ndarray[Any, Any], two: np.ndarray[Any, Any]) -> int | None:
    if one.shape != two.shape:
        return 0
    same = (one == two) | (np.isnan(one) & np.isnan(two)) if one.dtype.kind == "f" else one == two
    rows = np.flatnonzero(~same.reshape(len(same), -1).all(axis=1))
    return int(rows[0]) if len(rows) else None


def _longer(one: Run, two: Run, count: int) -> FirstDifference | None:
    if len(one.signals.times) == len(two.signals.times):
        return None
    longer = one if len(one.signals.times) > count else two
    ends = float(one.signals.times[-1]), float(two.signals.times[-1])
    return FirstDifference(_step_at(longer, count), "times", min(ends), *ends)


def _step_at(run: Run, row: int) -> str:
    """The innermost step that a sample belongs to."""
    inside = [step.title for step in run.steps if step.start_index <= row < step.end_index]
    return inside[-1] if inside else ""


def _signal_name(run: Run, name: str, column: int, columns: int) -> tuple[str, str]:
    """A signal in words, and its unit: `velocity of elbow`, `y of red_box`."""
    joints = run.robot.movable_joints
    if name in OF_JOINTS and columns == len(joints):
        unit = joints[column].position_unit
        words, per = OF_JOINTS[name]
        return f"{words} of {joints[column].name}", f"{unit}{per}" if per is not None else ""
    kind, _, body = name.partition("/")
    if kind == "object_poses" and columns == len(POSE):
        return f"{POSE[column]} of {body}", "m" if column < 3 else ""
    if kind in OF_PAIRS:
        words, unit = OF_PAIRS[kind]
        return f"{words} {body.replace('|', ' and ')}", unit
    return name.replace("_", " ").replace("/", " of "), ""
