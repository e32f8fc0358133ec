"""Object poses from the frames of a recording."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.core.pose_arrays import IDENTITY, compose
from harness.core.types import FloatArray
from harness.grading.bag.clocks import Timeline
from harness.grading.bag.content import BagContent, RecordedTrack
from harness.grading.bag.sampling import interpolated_poses

WORLD = "world"


class Frames:
    """World poses of frames, composed along their parents.

    Poses of the robot's links result from the joints. A frame without a parent counts as the world,
    with a note.

    Attributes:
        notes: The assumptions made about frames.
        assumed: Frames that count as the world because they have no parent.
    """

    def __init__(
        self,
        content: BagContent,
        links: Mapping[str, FloatArray],
        timeline: Timeline,
        times: FloatArray,
    ) -> None:
        self.notes: list[str] = []
        self.assumed: dict[str, None] = {}
        self._links, self._timeline, self._times = links, timeline, times
        self._parents: dict[str, tuple[str, RecordedTrack]] = {}
        # topics that the user named have precedence
        for edges in (content.edges, content.static_edges, content.objects):
            for (parent, child), track in edges.items():
                self._parents[child] = (parent, track)
        self._static = {id(track) for track in content.static_edges.values()}

    def knows(self, frame: str) -> bool:
        """Whether the recording has a pose of a frame."""
        return frame in self._parents

    def is_published_once(self, frame: str) -> bool:
        """Whether a frame that may move has a single pose, which counts at all times."""
        _, track = self._parents[frame]
        return id(track) not in self._static and len(track.rows()) == 1

    def assumed_below(self, frame: str) -> str:
        """The frame without a parent that a frame's pose is in; empty where there is none."""
        passed: set[str] = set()
        while frame in self._parents and frame not in passed and frame not in self._links:
            passed.add(frame)
            frame = self._parents[frame][0]
        return frame if frame in self.assumed else ""

    def pose(self, frame: str) -> FloatArray:
        """T_world_frame, NaN where it is unknown, shape (N, 7)."""
        chain: list[RecordedTrack] = []
        passed: set[str] = set()
        while frame not in self._links and frame != WORLD and frame in self._parents:
            if frame in passed:
                self.notes.append(f"the parents of the frame {frame} form a cycle")
                return np.full((len(self._times), 7), np.nan)
            passed.add(frame)
            frame, track = self._parents[frame]
            chain.append(track)
        root = self._links.get(frame)
        if root is None and frame != WORLD:
            self.assumed[frame] = None
        pose = np.broadcast_to(IDENTITY if root is None else root, (len(self._times), 7))
        for track in reversed(chain):
            pose = compose(pose, self._sampled(track))
        return pose

    def _sampled(self, track: RecordedTrack) -> FloatArray:
        rows = track.rows()
        if id(track) in self._static:
            return np.tile(rows[-1], (len(self._times), 1))
        seconds, is_judged = self._timeline.rows(track, "the topic of frames or objects")
        if not is_judged.any():
            return np.full((len(self._times), 7), np.nan)
        return interpolated_poses(seconds[is_judged], rows[is_judged], self._times)
