"""Where the robot pressed on something, and how hard, frame by frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.recording.run import Run
from harness.reporting.html.packing import Packer, differences
from harness.reporting.html.scene import FULL, frame_samples

MOST = 12  # pairs that are drawn: those that pressed hardest


def pack_presses(run: Run, packer: Packer) -> list[dict[str, Any]]:
    """Put the contacts of the robot's links in, from the first to the last frame of each pair."""
    _, samples = frame_samples(run.signals.times)
    strengths = {
        pair: np.nan_to_num(np.linalg.norm(rows[:, 3:], axis=1))
        for pair, rows in run.signals.presses.items()
    }
    hardest = sorted(strengths, key=lambda pair: (-strengths[pair].max(initial=0.0), pair))
    packed: list[dict[str, Any]] = []
    for number, pair in enumerate(hardest[:MOST]):
        chosen = _strongest(strengths[pair], samples)
        touched = np.flatnonzero(strengths[pair][chosen] > 0)
        if not len(touched):
            continue
        first, last = int(touched[0]), int(touched[-1]) + 1
        rows = run.signals.presses[pair][chosen[first:last]]
        units = [_unit(rows[:, :3]), _unit(rows[:, 3:])]
        whole = _whole(rows, units)
        packed.append(
            {
                "link": pair[0],
                "body": pair[1],
                "first": first,
                "count": last - first,
                "units": units,
                "buffer": packer.add(f"press.{number}", differences(whole.T)),
            }
        )
    return packed


def _strongest(strength: FloatArray, samples: IntArray) -> IntArray:
    """For every frame: the sample since the frame before in which the force was largest."""
    chosen = samples.copy()
    begins = np.concatenate([[0], samples[:-1] + 1])
    for frame in np.flatnonzero(np.maximum.reduceat(strength, np.minimum(begins, samples)) > 0):
        begin, end = begins[frame], samples[frame] + 1
        if end - begin > 1:
            chosen[frame] = begin + int(np.argmax(strength[begin:end]))
    return chosen


def _unit(values: FloatArray) -> float:
    """What 1 stands for, when the largest value is to fill 16 bits."""
    return max(float(np.nanmax(np.abs(values))) / FULL, 1e-9)


def _whole(rows: FloatArray, units: list[float]) -> IntArray:
    """Rows in units; without contact the place before, and no force."""
    there = np.isfinite(rows).all(axis=1)
    last = np.maximum.accumulate(np.where(there, np.arange(len(rows)), 0))
    filled = np.concatenate([rows[last, :3] / units[0], rows[last, 3:] / units[1]], axis=1)
    filled[~there, 3:] = 0.0
    return np.rint(filled).astype(np.int64)
