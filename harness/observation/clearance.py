"""Distances along a recorded run: robot to objects and itself, attached to other objects."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.geometry import Shape
from harness.core.sharing import shared, was_seen
from harness.core.types import BoolArray, FloatArray, IntArray, Pair
from harness.observation.body_tracks import (
    BodyTrack,
    MovingBody,
    carried_track,
    link_track,
    links_with_shapes,
    object_track,
    tracked_shapes,
)
from harness.observation.measured_clearance import MeasuredClearance
from harness.observation.nearest import largest_travel, pairs_between, smallest_distances
from harness.observation.sampled_clearance import (
    LARGEST_ERROR,
    around_smallest,
    between,
    inside_of,
    knots,
    largest_dip,
    nearest_measured,
    parts_of,
    parts_of_run,
)
from harness.planning.model.robot_model import RobotModel
from harness.recording.motion import Motion
from harness.recording.run import AttachmentRecord, ObjectRecord
from harness.recording.signals import Signals
from harness.robot.description import RobotDescription
from harness.robot.forward_kinematics import LinkPoses

ROBOT = "robot"

Bodies = tuple[Sequence[MovingBody], MovingBody]
"""Bodies whose distances from another one are measured."""


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
        measured: Callable[[int], MeasuredClearance | None] = lambda _: None,
        only: Collection[Pair] | None = None,
    ) -> Signals:
        """The same signals with `clearances` and `clearance_links` filled in.

        Args:
            signals: The recording of the run.
            objects: All objects of the run.
            attachments: All attachments of the run.
            cutoff: Larger distances are reported as the cutoff [m].
            measured: What `measured_parts` found in a part of the run, or None.
            only: The pairs that are measured; by default all.
        """
        count = len(signals.times)
        if not count:
            return replace(signals, clearance_cutoff=cutoff)
        motion = Motion.of(signals)
        samples = knots(motion.times, objects, attachments)
        parts = [
            measured(number) or self._measured(motion.at(part), objects, attachments, cutoff, only)
            for number, part in reversed([*enumerate(parts_of_run(motion.times, samples))])
        ]  # the last ones first: others may still be measured by another process
        found = MeasuredClearance.joined(parts[::-1])
        if not found.distances:
            return replace(signals, clearance_cutoff=cutoff)
        near = np.union1d(
            around_smallest(found.distances, samples, count),
            inside_of(samples, largest_dip(found.dips()) > LARGEST_ERROR),
        )
        if len(near):
            stretches = np.cumsum(np.diff(near, prepend=near[:1]) > 1, dtype=np.int64)
            finer = self._measured(
                motion.at(near), objects, attachments, cutoff, only, stretches=stretches
            )
            samples = found.refined(finer, samples, near)
        distances = {
            key: between(samples, values, count) for key, values in found.distances.items()
        }
        self._look_between(distances, found, samples, motion, objects, attachments, cutoff)
        links = {
            key: nearest_measured(samples, values, distances[key], cutoff)
            for key, values in found.links.items()
        }
        return replace(
            signals, clearances=distances, clearance_links=links, clearance_cutoff=cutoff
        )

    def measured_parts(
        self,
        motion: Motion,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
        numbers: range,
    ) -> dict[int, MeasuredClearance]:
        """Distances in complete parts of a running run, by the numbers of the parts."""
        parts = parts_of_run(motion.times, knots(motion.times, objects, attachments))
        return {
            number: self._measured(motion.at(parts[number]), objects, attachments, cutoff)
            for number in numbers
        }

    def _look_between(
        self,
        distances: Mapping[tuple[str, str], FloatArray],
        found: MeasuredClearance,
        samples: IntArray,
        motion: Motion,
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
        finer = self._measured(
            motion.between(owners, shares), objects, attachments, cutoff, distances.keys()
        )
        for key, values in finer.distances.items():
            absent = np.isnan(distances[key][owners])
            np.fmin.at(distances[key], owners, np.where(absent, np.nan, values))

    def distances(
        self,
        motion: Motion,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
        pairs: Collection[Pair] | None = None,
    ) -> Mapping[Pair, FloatArray]:
        """Distances of all pairs, or of some, at every given sample, as in `Signals.clearances`."""
        return self._measured(motion, objects, attachments, cutoff, pairs).distances

    def _measured(
        self,
        motion: Motion,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
        only: Collection[Pair] | None = None,
        stretches: IntArray | None = None,
    ) -> MeasuredClearance:
        """Distances at every given sample; None measures all pairs."""
        found = MeasuredClearance(len(motion.times), only=only, stretches=stretches)
        is_of_robot = only is None or any(ROBOT in pair for pair in only)
        if not (is_of_robot or any(_during(each, motion).any() for each in attachments)):
            return found
        found.may_be_known = was_seen(
            "motion", self.description.key, motion.joint_positions, cutoff, only, stretches
        )
        links = LinkPoses(self.description, motion.joint_positions)
        tracks = {
            record.name: object_track(record, attachments, motion, links) for record in objects
        }
        bodies = {
            link: MovingBody(shapes, link_track(links, link), stretches)
            for link, shapes in self._shapes.items()
        }
        self._robot_to_itself(found, bodies, motion, cutoff)
        for record in objects:
            there = tracks[record.name].present & ~_held(record.name, attachments, motion)
            if there.any():
                track = tracks[record.name]
                self._robot_to_object(found, bodies, record, track, there, motion, cutoff)
        for attachment in attachments:
            self._held_to_objects(found, links, attachment, objects, tracks, motion, cutoff)
        return found

    def _robot_to_itself(
        self,
        found: MeasuredClearance,
        links: Mapping[str, MovingBody],
        motion: Motion,
        cutoff: float,
    ) -> None:
        def bodies() -> Iterator[Bodies]:
            names = list(links)
            for later, second in enumerate(names):
                firsts = [name for name in names[:later] if self._is_self_pair(name, second)]
                yield [links[name] for name in firsts], links[second]

        inputs = self.description.key, motion.joint_positions
        everywhere = np.ones(found.count, dtype=bool)
        self._measure(found, (ROBOT, ROBOT), everywhere, inputs, bodies, cutoff)

    def _robot_to_object(
        self,
        found: MeasuredClearance,
        links: Mapping[str, MovingBody],
        record: ObjectRecord,
        track: BodyTrack,
        there: BoolArray,
        motion: Motion,
        cutoff: float,
    ) -> None:
        track = track.part(there)

        def bodies() -> Iterator[Bodies]:
            standing = self.description.static_links if record.is_static else frozenset()
            shapes = tracked_shapes(record.name, record.shapes)
            other = MovingBody(shapes, track, found.stretches_of(there))
            yield [body.part(there) for link, body in links.items() if link not in standing], other

        inputs = (
            *(self.description.key, motion.joint_positions[there]),
            *(record.shapes, record.is_static, track.rotations, track.translations),
        )
        self._measure(found, (ROBOT, record.name), there, inputs, bodies, cutoff)

    def _held_to_objects(
        self,
        found: MeasuredClearance,
        links: LinkPoses,
        attachment: AttachmentRecord,
        objects: Sequence[ObjectRecord],
        tracks: Mapping[str, BodyTrack],
        motion: Motion,
        cutoff: float,
    ) -> None:
        """Distances of an attached object: in the physics, and as assumed by the planning scene."""
        during = _during(attachment, motion)
        believed = carried_track(link_track(links, attachment.link), attachment.pose_in_link)
        held: dict[str, BodyTrack] = {attachment.object: believed}
        for name in (attachment.object, attachment.represents):
            if name in motion.object_poses and name in tracks:
                held[name] = tracks[name]
        shapes = {record.name: record.shapes for record in objects}
        same = {attachment.object, attachment.represents}
        for name, track in held.items():
            for record in objects:
                other = tracks[record.name]
                there = during & track.present & other.present
                there &= ~_held(record.name, (attachment,), motion)
                if record.name in same or not there.any():
                    continue
                both = (name, shapes.get(name, ())), (record.name, record.shapes)
                tracked = track.part(there), other.part(there)
                self._object_to_object(found, there, both, tracked, cutoff)

    def _object_to_object(
        self,
        found: MeasuredClearance,
        there: BoolArray,
        shapes: tuple[tuple[str, Sequence[Shape]], tuple[str, Sequence[Shape]]],
        tracks: tuple[BodyTrack, BodyTrack],
        cutoff: float,
    ) -> None:
        """Distances of two objects, where both are there."""

        def bodies() -> Iterator[Bodies]:
            first, second = (
                MovingBody(tracked_shapes(*each), track, found.stretches_of(there))
                for each, track in zip(shapes, tracks, strict=True)
            )
            yield [first] if first.shapes else [], second

        inputs = shapes, [(track.rotations, track.translations) for track in tracks]
        (first, _), (second, _) = shapes
        self._measure(found, (first, second), there, inputs, bodies, cutoff)

    def _measure(
        self,
        found: MeasuredClearance,
        key: Pair,
        there: BoolArray,
        inputs: tuple[object, ...],
        bodies: Callable[[], Iterable[Bodies]],
        cutoff: float,
    ) -> None:
        """Distances of two bodies, measured here or by a case in which they moved alike."""
        if found.only is not None and key not in found.only:
            return

        def measured() -> tuple[FloatArray, IntArray, FloatArray] | tuple[()]:
            some = [each for each in bodies() if each[0] and each[1].shapes]
            if not some:
                return ()
            every = [pair for each in some for pair in pairs_between(*each, cutoff)]
            count = int(np.count_nonzero(there))
            distances, which = smallest_distances(every, cutoff, count)
            of_pair = np.array([self._index.get(pair.first.body, -1) for pair in every] + [-1])
            return distances, of_pair[which], largest_travel(every, cutoff, count)

        def facts() -> tuple[object, ...]:
            return *inputs, cutoff, found.stretches

        result = shared("distances", facts, measured, may_be_known=found.may_be_known)
        if result:
            distances, links, moved = result
            found.put(key, there, distances, links if key[0] == ROBOT else None, moved)

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


def _held(name: str, attachments: Sequence[AttachmentRecord], motion: Motion) -> BoolArray:
    """Samples in which an object, or the object that represents it, is attached."""
    held = np.zeros(len(motion.times), dtype=bool)
    for attachment in attachments:
        if name in (attachment.object, attachment.represents):
            held |= _during(attachment, motion)
    return held


def _during(attachment: AttachmentRecord, motion: Motion) -> BoolArray:
    """Samples in which an attachment lasts."""
    return (motion.times >= attachment.start_time) & (motion.times <= attachment.end_time)
