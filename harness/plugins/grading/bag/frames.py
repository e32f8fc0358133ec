"""Object poses from the frames of a recording."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import numpy as np

from harness.core.pose_arrays import IDENTITY, compose
from harness.core.types import FloatArray
from harness.plugins.grading.bag.clocks import Timeline
from harness.plugins.grading.bag.content import BagContent, RecordedTrack
from harness.plugins.grading.bag.sampling import Trace, pose_trace

WORLD = "world"
Edge = tuple[str, RecordedTrack]  # the parent of a frame, and its poses in it


class Frames:
    """World poses of frames, composed along their parents.

    Poses of the robot's links result from the joints. A frame without a parent counts as the world,
    with a note.

    Attributes:
        notes: The assumptions made about frames.
        assumed: Frames that count as the world because they have no parent.
    """

    def __init__(self, content: BagContent, links: Collection[str], timeline: Timeline) -> None:
        self.notes: list[str] = []
        self.assumed: dict[str, None] = {}
        self._roots, self._timeline = {WORLD, *links}, timeline
        self._edges: dict[str, list[Edge]] = {}
        # topics that the user named have precedence
        for edges in (content.objects, content.static_edges, content.edges):
            newest: dict[str, Edge] = {child: (p, track) for (p, child), track in edges.items()}
            for child, edge in newest.items():
                self._edges.setdefault(child, []).append(edge)
        self._static = {id(track) for track in content.static_edges.values()}
        self._traces: dict[int, Trace | None] = {}

    def knows(self, frame: str) -> bool:
        """Whether the recording has a pose of a frame."""
        return frame in self._edges

    def is_published_once(self, frame: str) -> bool:
        """Whether a single pose of a frame that may move counts at all times."""
        tracks = [track for _, track in self._chain(frame)]
        is_once = [self.is_static(track) or len(track.logged) == 1 for track in tracks]
        return all(is_once) if tracks and self.is_static(tracks[0]) else is_once[:1] == [True]

    def is_static(self, track: RecordedTrack) -> bool:
        """Whether a track is from `/tf_static`."""
        return id(track) in self._static

    def assumed_below(self, frame: str) -> str:
        """The frame without a parent that a frame's pose is in; empty where there is none."""
        chain = self._chain(frame)
        return chain[-1][0] if chain and chain[-1][0] in self.assumed else ""

    def moving(self, frames: Iterable[str]) -> list[RecordedTrack]:
        """The tracks that the poses of some frames come from, without static ones."""
        chains = (track for frame in frames for _, track in self._chain(frame))
        return [track for track in chains if not self.is_static(track)]

    def pose(self, frame: str, links: Mapping[str, FloatArray], times: FloatArray) -> FloatArray:
        """T_world_frame at some times [s], NaN where it is unknown, shape (N, 7).

        Args:
            links: T_world_link of the links that frames are attached to, shape (N or 1, 7) each.
        """
        chain = self._chain(frame)
        if chain and chain[-1][0] not in self._roots:
            self.assumed[chain[-1][0]] = None
        return self._composed(chain, links, times)

    def other_poses(
        self, frame: str, links: Mapping[str, FloatArray], times: FloatArray
    ) -> Iterator[FloatArray]:
        """The poses that `pose` gives, from each further topic that has poses of the frame."""
        for edge in self._edges[frame][1:]:
            yield self._composed([edge, *self._chain(edge[0])], links, times)

    def trace(self, track: RecordedTrack) -> Trace | None:
        """The poses of a track over time; None where none of them is judged."""
        if id(track) not in self._traces:
            rows = track.rows()
            seconds, is_judged = self._timeline.rows(track, "the topic of frames or objects")
            if self.is_static(track):
                seconds, rows, is_judged = seconds[-1:], rows[-1:], np.ones(1, dtype=bool)
            found = pose_trace(seconds[is_judged], rows[is_judged]) if is_judged.any() else None
            self._traces[id(track)] = found
        return self._traces[id(track)]

    def _chain(self, frame: str) -> list[Edge]:
        """The parents of a frame with its poses in them, up to a link or the world.

        It is empty where the parents form a cycle.
        """
        chain: list[Edge] = []
        passed: set[str] = set()
        while frame not in self._roots and frame in self._edges:
            if frame in passed:
                note = f"the parents of the frame {frame} form a cycle"
                self.notes += [] if note in self.notes else [note]
                return []
            passed.add(frame)
            frame, track = self._edges[frame][0]
            chain.append((frame, track))
        return chain

    def _composed(
        self, chain: Sequence[Edge], links: Mapping[str, FloatArray], times: FloatArray
    ) -> FloatArray:
        unknown = np.full((len(times), 7), np.nan)
        if not chain:
            return unknown
        pose = np.broadcast_to(links.get(chain[-1][0], IDENTITY), (len(times), 7))
        for _, track in reversed(chain):
            trace = self.trace(track)
            if trace is None:
                return unknown
            step = trace.at(times)
            step[:, 3:] /= np.linalg.norm(step[:, 3:], axis=1, keepdims=True)
            pose = compose(pose, step)
        return pose
