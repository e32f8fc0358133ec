"""Distances along a recorded run: robot to objects and itself, attached to other objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.observation.body_tracks import (
    BodyTrack,
    TrackedShape,
    carried_track,
    link_track,
    links_with_shapes,
    object_track,
    relative_track,
    tracked_shapes,
)
from harness.observation.nearest import (
    ShapePair,
    largest_travel,
    pairs_between,
    smallest_distances,
)
from harness.observation.sampled_clearance import (
    LARGEST_ERROR,
    around_smallest,
    at_samples,
    between,
    inside_of,
    interpolated,
    knots,
    largest_dip,
    nearest_measured,
    parts_of,
)
from harness.planning.model.robot_model import RobotModel
from harness.recording.run import AttachmentRecord, ObjectRecord, Signals
from harness.robot.description import RobotDescription
from harness.robot.forward_kinematics import LinkPoses

ROBOT = "robot"


@dataclass(eq=False)
class _Clearances:
    """Distances of each pair, and the nearest links, while they are being measured."""

    count: int
    distances: dict[tuple[str, str], FloatArray] = field(default_factory=dict)
    links: dict[tuple[str, str], IntArray] = field(default_factory=dict)
    travels: dict[tuple[str, str], FloatArray] = field(default_factory=dict)

    def put(
        self,
        key: tuple[str, str],
        samples: BoolArray,
        distances: FloatArray,
        links: IntArray | None,
        travel: FloatArray,
    ) -> None:
        """Set a pair's distances and travel at some samples; NaN or 0 elsewhere until set."""
        if key not in self.travels:
            self.travels[key] = np.zeros(self.count)
        self.travels[key][samples] = travel
        if key not in self.distances:
            self.distances[key] = np.full(self.count, np.nan)
        self.distances[key][samples] = distances
        if links is not None:
            if key not in self.links:
                self.links[key] = np.full(self.count, -1, dtype=np.int64)
            self.links[key][samples] = links

    def refined(self, finer: _Clearances, samples: IntArray, near: IntArray) -> IntArray:
        """Merge measurements at further samples; returns all samples in order."""
        merged = np.union1d(samples, near)
        old, new = np.searchsorted(merged, samples), np.searchsorted(merged, near)
        for key, values in self.distances.items():
            whole = np.full(len(merged), np.nan)
            whole[old] = values
            whole[new] = finer.distances.get(key, np.nan)
            self.distances[key] = whole
        for key, values in self.links.items():
            indices = np.full(len(merged), -1, dtype=np.int64)
            indices[old] = values
            indices[new] = finer.links.get(key, -1)
            self.links[key] = indices
        follows = np.diff(near, prepend=-2) == 1  # the others' travel is since an earlier one
        for key, values in self.travels.items():
            travel = np.zeros(len(merged))
            travel[old] = values
            if key in finer.travels:
                travel[new[follows]] = finer.travels[key][follows]
            self.travels[key] = travel
        self.count = len(merged)
        return merged

    def dips(self) -> dict[tuple[str, str], FloatArray]:
        """By how much each distance may be smaller before the next sample than at both [m].

        Two bodies that are d1 and d2 apart at the ends of an interval in which they move by s
        against each other are at least (d1 + d2 - s) / 2 apart in it.
        """
        return {
            key: np.nan_to_num((self.travels[key][1:] - np.abs(np.diff(values))) / 2)
            for key, values in self.distances.items()
        }


class CoalClearance:
    """Distances along a recorded run, exact wherever they are below the cutoff."""

    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self._robot = RobotModel(description)
        self._shapes = links_with_shapes({link.name: link.collisions for link in description.links})
        self._index = {name: index for index, name in enumerate(description.link_names)}

    def observe(
        self,
        signals: Signals,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
    ) -> Signals:
        """The same signals with `clearances` and `clearance_links` filled in."""
        count = len(signals.times)
        if not count:
            return replace(signals, clearance_cutoff=cutoff)
        samples = knots(signals.times, objects, attachments)
        found = self._measured(at_samples(signals, samples), objects, attachments, cutoff)
        if not found.distances:
            return replace(signals, clearance_cutoff=cutoff)
        near = np.union1d(
            around_smallest(found.distances, samples, count),
            inside_of(samples, largest_dip(found.dips()) > LARGEST_ERROR),
        )
        if len(near):
            finer = self._measured(at_samples(signals, near), objects, attachments, cutoff)
            samples = found.refined(finer, samples, near)
        distances = {
            key: between(samples, values, count) for key, values in found.distances.items()
        }
        self._look_between(distances, found, samples, signals, objects, attachments, cutoff)
        links = {
            key: nearest_measured(samples, values, distances[key], cutoff)
            for key, values in found.links.items()
        }
        return replace(
            signals, clearances=distances, clearance_links=links, clearance_cutoff=cutoff
        )

    def _look_between(
        self,
        distances: Mapping[tuple[str, str], FloatArray],
        found: _Clearances,
        samples: IntArray,
        signals: Signals,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
    ) -> None:
        """Lower distances to the smallest before the next sample, where bodies are that fast."""
        dips = largest_dip(found.dips())
        fast = np.flatnonzero((dips > LARGEST_ERROR) & (np.diff(samples) == 1))
        if not len(fast):
            return
        owners, shares = parts_of(samples[fast], dips[fast])
        finer = self._measured(interpolated(signals, owners, shares), objects, attachments, cutoff)
        for key, values in finer.distances.items():
            absent = np.isnan(distances[key][owners])
            np.fmin.at(distances[key], owners, np.where(absent, np.nan, values))

    def distances(
        self,
        signals: Signals,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
    ) -> Mapping[tuple[str, str], FloatArray]:
        """Distances at every given sample, by pair as in `Signals.clearances`."""
        return self._measured(signals, objects, attachments, cutoff).distances

    def _measured(
        self,
        signals: Signals,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
    ) -> _Clearances:
        """Distances at every given sample."""
        found = _Clearances(len(signals.times))
        links = LinkPoses(self.description, signals.joint_positions)
        tracks = {
            record.name: object_track(record, attachments, signals, links) for record in objects
        }
        shapes = {record.name: tracked_shapes(record.name, record.shapes) for record in objects}
        self._robot_to_itself(found, links, cutoff)
        for record in objects:
            there = tracks[record.name].present & ~_held(record.name, attachments, signals)
            self._robot_to_object(
                found, links, record, tracks[record.name], shapes[record.name], there, cutoff
            )
        for attachment in attachments:
            self._held_to_objects(
                found, links, attachment, objects, tracks, shapes, signals, cutoff
            )
        return found

    def _robot_to_itself(self, found: _Clearances, links: LinkPoses, cutoff: float) -> None:
        names = list(self._shapes)
        pairs: list[ShapePair] = []
        for later, second in enumerate(names):
            for first in names[:later]:
                if self._is_self_pair(first, second):
                    seen = relative_track(link_track(links, first), link_track(links, second))
                    pairs += pairs_between(self._shapes[first], self._shapes[second], seen)
        if pairs:
            everywhere = np.ones(found.count, dtype=bool)
            self._measure(found, (ROBOT, ROBOT), everywhere, pairs, cutoff)

    def _robot_to_object(
        self,
        found: _Clearances,
        links: LinkPoses,
        record: ObjectRecord,
        track: BodyTrack,
        shapes: Sequence[TrackedShape],
        there: BoolArray,
        cutoff: float,
    ) -> None:
        if not there.any() or not shapes:
            return
        standing = self.description.static_links if record.is_static else frozenset()
        pairs: list[ShapePair] = []
        for link, link_shapes in self._shapes.items():
            if link not in standing:
                seen = relative_track(link_track(links, link).part(there), track.part(there))
                pairs += pairs_between(link_shapes, shapes, seen)
        if pairs:
            self._measure(found, (ROBOT, record.name), there, pairs, cutoff)

    def _held_to_objects(
        self,
        found: _Clearances,
        links: LinkPoses,
        attachment: AttachmentRecord,
        objects: Sequence[ObjectRecord],
        tracks: Mapping[str, BodyTrack],
        shapes: Mapping[str, Sequence[TrackedShape]],
        signals: Signals,
        cutoff: float,
    ) -> None:
        """Distances of an attached object: in the physics, and as assumed by the planning scene."""
        times = signals.times
        during = (times >= attachment.start_time) & (times <= attachment.end_time)
        believed = carried_track(link_track(links, attachment.link), attachment.pose_in_link)
        held: dict[str, BodyTrack] = {attachment.object: believed}
        for name in (attachment.object, attachment.represents):
            if name in signals.object_poses and name in tracks:
                held[name] = tracks[name]
        same = {attachment.object, attachment.represents}
        for name, track in held.items():
            for record in objects:
                other = tracks[record.name]
                there = during & track.present & other.present
                there &= ~_held(record.name, (attachment,), signals)
                if record.name in same or not there.any():
                    continue
                seen = relative_track(track.part(there), other.part(there))
                pairs = pairs_between(shapes.get(name, ()), shapes[record.name], seen)
                if pairs:
                    distances, _ = smallest_distances(pairs, cutoff)
                    moved = largest_travel(pairs)
                    found.put((name, record.name), there, distances, None, moved)

    def _measure(
        self,
        found: _Clearances,
        key: tuple[str, str],
        there: BoolArray,
        pairs: Sequence[ShapePair],
        cutoff: float,
    ) -> None:
        distances, which = smallest_distances(pairs, cutoff)
        of_pair = np.array([self._index[pair.first.body] for pair in pairs] + [-1])
        found.put(key, there, distances, of_pair[which], largest_travel(pairs))

    def _is_self_pair(self, first: str, second: str) -> bool:
        robot = self._robot
        if robot.parent_joint(first) == robot.parent_joint(second):
            return False
        key = (first, second) if first <= second else (second, first)
        if key in self.description.allowed_collisions:
            return False
        return not any(
            {joint.parent, joint.child} == {first, second} for joint in self.description.joints
        )


def _held(name: str, attachments: Sequence[AttachmentRecord], signals: Signals) -> BoolArray:
    """Samples in which an object, or the object that represents it, is attached."""
    times = signals.times
    held = np.zeros(len(times), dtype=bool)
    for attachment in attachments:
        if name in (attachment.object, attachment.represents):
            held |= (times >= attachment.start_time) & (times <= attachment.end_time)
    return held
