"""Where objects stood, from the frames that a recording names."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.core.pose_arrays import IDENTITY, compose
from harness.core.types import FloatArray
from harness.importers.bag.clocks import Timeline
from harness.importers.bag.content import BagContent, Track
from harness.importers.bag.sampling import poses_at

WORLD = "world"


class Frames:
    """Poses in the world, along the frames' parents.

    Links of the robot are where the joints put them; a frame without a parent is taken for the
    world, and a note says so.

    Attributes:
        notes: What was assumed.
    """

    def __init__(
        self,
        content: BagContent,
        links: Mapping[str, FloatArray],
        timeline: Timeline,
        times: FloatArray,
    ) -> None:
        self.notes: list[str] = []
        self._links, self._timeline, self._times = links, timeline, times
        self._parents: dict[str, tuple[str, Track]] = {}
        # what the user named comes last, and counts
        for edges in (content.edges, content.static_edges, content.objects):
            for (parent, child), track in edges.items():
                self._parents[child] = (parent, track)
        self._static = {id(track) for track in content.static_edges.values()}

    def knows(self, frame: str) -> bool:
        """Whether the recording says where a frame is."""
        return frame in self._parents

    def pose(self, frame: str) -> FloatArray:
        """T_world_frame, NaN where it is not known, shape (N, 7)."""
        chain: list[Track] = []
        passed: set[str] = set()
        while frame not in self._links and frame != WORLD and frame in self._parents:
            if frame in passed:
                self.notes.append(f"the frames of {frame} go round in a circle")
                return np.full((len(self._times), 7), np.nan)
            passed.add(frame)
            frame, track = self._parents[frame]
            chain.append(track)
        root = self._links.get(frame)
        if root is None and frame != WORLD:
            note = f"frame '{frame}' has no parent; it is taken for the world"
            if note not in self.notes:
                self.notes.append(note)
        pose = np.broadcast_to(IDENTITY if root is None else root, (len(self._times), 7))
        for track in reversed(chain):
            pose = compose(pose, self._sampled(track))
        return pose

    def _sampled(self, track: Track) -> FloatArray:
        rows = track.rows()
        if id(track) in self._static:
            return np.tile(rows[-1], (len(self._times), 1))
        seconds, is_judged = self._timeline.rows(track, "the topic of frames or objects")
        if not is_judged.any():
            return np.full((len(self._times), 7), np.nan)
        return poses_at(seconds[is_judged], rows[is_judged], self._times)
