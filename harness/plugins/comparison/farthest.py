"""How far apart the tool and the objects of two runs come, at equal times."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.core.amounts import amount, is_visible
from harness.core.types import FloatArray
from harness.recording.run import Run
from harness.recording.signals import Signals

TOOL = "the TCP"
MOST_NAMED = 4  # things that are named, those that come farthest apart


@dataclass(frozen=True)
class Farthest:
    """Where one thing is farthest apart in two runs.

    Attributes:
        name: `the TCP`, or the name of an object.
        time: The simulated time of both [s].
        distance: How far apart it is then [m].
    """

    name: str
    time: float
    distance: float

    @property
    def text(self) -> str:
        """`the TCP is farthest apart at t=2.312 s, by 24.1 mm`."""
        distance = amount(self.distance, "m")
        return f"{self.name} is farthest apart at t={self.time:.3f} s, by {distance}"


def farthest_apart(one: Run, two: Run) -> tuple[Farthest, ...]:
    """The tool and the objects that come apart by what people see, the farthest first."""
    found = sorted(_apart(one.signals, two.signals), key=lambda each: -each.distance)
    return tuple(found[:MOST_NAMED])


def _apart(ours: Signals, theirs: Signals) -> Iterator[Farthest]:
    end = min(float(each.times[-1]) if len(each.times) else -np.inf for each in (ours, theirs))
    times = ours.times[ours.times <= end]
    poses = {TOOL: (ours.tcp_pose, theirs.tcp_pose)}
    shared = [name for name in ours.object_poses if name in theirs.object_poses]
    poses |= {name: (ours.object_poses[name], theirs.object_poses[name]) for name in shared}
    for name, (first, second) in poses.items():
        away = first[: len(times), :3] - _positions(second, theirs.times, times)
        distances = np.nan_to_num(np.linalg.norm(away, axis=1))
        if len(distances) and is_visible(float(distances.max()), "m"):
            row = int(distances.argmax())
            yield Farthest(name, float(times[row]), float(distances[row]))


def _positions(poses: FloatArray, times: FloatArray, at: FloatArray) -> FloatArray:
    """Positions at other times, shape (N, 3)."""
    return np.stack([np.interp(at, times, poses[:, axis]) for axis in range(3)], axis=1)
