"""Distances along a recorded run: robot to objects and itself, attached to other objects."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from harness.core.geometry import Shape
from harness.core.kinematics import LinkPoses
from harness.core.types import BoolArray, FloatArray, IntArray, Pair
from harness.planning.model.robot_model import RobotModel
from harness.recording.motion import Motion
from harness.recording.run import AttachmentRecord, ObjectRecord
from harness.recording.signals import Signals
from harness.robot.description import RobotDescription
from harness.robot.srdf.srdf import link_pair
from harness.session.observation.body_tracks import (
    BodyTrack,
    MovingBody,
    carried_track,
    link_track,
    links_with_shapes,
    object_track,
    tracked_shapes,
)
from harness.session.observation.measured_clearance import MeasuredClearance
from harness.session.observation.nearest import (
    ShapePair,
    largest_travel,
    pairs_between,
    smallest_distances,
)
from harness.session.observation.sampled_clearance import (
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

ROBOT = "robot"
AT_ONCE = 5000  # positions that are measured at once: memory does not grow with them
Bodies = tuple[Sequence[MovingBody], MovingBody]  # and the one that they are measured from


class CoalClearance:
    """Distances along a recorded run, exact wherever they are below the cutoff."""

    def __init__(self, description: RobotDescription) -> None:
        self._robot = _Robot(description)

    def observe(
        self,
        signals: Signals,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
        only: Collection[Pair] | None = None,
    ) -> Signals:
        """The same signals with `clearances` and `clearance_links` filled in.

        Args:
            cutoff: Larger distances are reported as the cutoff [m].
            only: The pairs that are measured; by default all.
        """
        count = len(signals.times)
        if not count:
            return replace(signals, clearance_cutoff=cutoff)
        scene = _Scene(self._robot, objects, attachments, cutoff, only)
        motion = Motion.of(signals)
        samples = scene.knots(motion)
        parts = parts_of_run(motion.times, samples)
        found = MeasuredClearance.joined([scene.measured(motion.at(part)) for part in parts])
        if not found.distances:
            return replace(signals, clearance_cutoff=cutoff)
        near = np.union1d(
            around_smallest(found.distances, samples, count),
            inside_of(samples, largest_dip(found.dips()) > LARGEST_ERROR),
        )
        if len(near):
            stretches = np.cumsum(np.diff(near, prepend=near[:1]) > 1, dtype=np.int64)
            finer = scene.measured(motion.at(near), stretches)
            samples = found.refined(finer, samples, near)
        distances = {
            key: between(samples, values, count) for key, values in found.distances.items()
        }
        _look_between(distances, found, samples, motion, scene)
        links = {
            key: nearest_measured(samples, values, distances[key], cutoff)
            for key, values in found.links.items()
        }
        return replace(
            signals, clearances=distances, clearance_links=links, clearance_cutoff=cutoff
        )

    def distances(
        self,
        motion: Motion,
        objects: Sequence[ObjectRecord],
        attachments: Sequence[AttachmentRecord],
        cutoff: float,
        pairs: Collection[Pair] | None = None,
    ) -> Mapping[Pair, FloatArray]:
        """Distances of all pairs, or of some, at every given sample, as in `Signals.clearances`."""
        return _Scene(self._robot, objects, attachments, cutoff, pairs).measured(motion).distances


def _look_between(
    distances: Mapping[Pair, FloatArray],
    found: MeasuredClearance,
    samples: IntArray,
    motion: Motion,
    scene: _Scene,
) -> None:
    """Lower distances to the smallest before the next sample, where bodies are that fast."""
    dips = largest_dip(found.dips())
    fast = np.flatnonzero((dips > LARGEST_ERROR) & (np.diff(samples) == 1))
    if not len(fast):
        return
    every, shares = parts_of(samples[fast], dips[fast], len(motion.times))
    scene = replace(scene, only=distances.keys())
    put = {record.name: record.put_samples(motion.times) - 1 for record in scene.objects}
    for start in range(0, len(every), AT_ONCE):
        owners = every[start : start + AT_ONCE]
        finer = scene.measured(motion.between(owners, shares[start : start + AT_ONCE]))
        for key, values in finer.distances.items():
            unknown = np.isnan(distances[key][owners])
            for name in key:  # what a step puts somewhere was nowhere in between
                unknown |= np.isin(owners, put.get(name, ()))
            np.fmin.at(distances[key], owners, np.where(unknown, np.nan, values))


class _Robot:
    """The links of a robot that have shapes, and the pairs of them that may come near."""

    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self.shapes = links_with_shapes({link.name: link.collisions for link in description.links})
        self.index = {name: index for index, name in enumerate(description.link_names)}
        self._model = RobotModel(description)
        self._arms = tuple(arm.name for arm in description.arms)

    def by_arms(self, pairs: Sequence[ShapePair], key: Pair) -> dict[Pair, list[ShapePair]]:
        """Pairs of shapes by the arms that they are of.

        Args:
            pairs: The pairs of the robot and itself, or an object.
            key: The names of both; pairs that are of no arm, or of one alone, stay under it.
        """
        arms, arm_of = self._arms, self.description.arm_of_link
        is_self = key[1] == ROBOT
        parts = combinations(arms, 2) if is_self else ((arm, key[1]) for arm in arms)
        found: dict[Pair, list[ShapePair]] = {part: [] for part in (*parts, key)}
        for pair in pairs:
            first = arm_of.get(pair.first.body, "")
            second = arm_of.get(pair.second.body, "") if is_self else key[1]
            part = (first, second) if (first, second) in found else (second, first)
            found[part if part in found else key].append(pair)
        return found

    def is_self_pair(self, first: str, second: str) -> bool:
        """Whether the distance of two links says something: both move, and neither is allowed."""
        if self._model.parent_joint(first) == self._model.parent_joint(second):
            return False
        if link_pair(first, second) in self.description.allowed_collisions:
            return False
        return not any(
            {joint.parent, joint.child} == {first, second} for joint in self.description.joints
        )


@dataclass(frozen=True, eq=False)
class _Scene:
    """What is measured: a robot, the objects and attachments of a run, the cutoff and the pairs."""

    robot: _Robot
    objects: Sequence[ObjectRecord]
    attachments: Sequence[AttachmentRecord]
    cutoff: float
    only: Collection[Pair] | None = None

    def knots(self, motion: Motion) -> IntArray:
        """The samples of a run at which distances are measured first."""
        return knots(motion.times, self.objects, self.attachments)

    def measured(self, motion: Motion, stretches: IntArray | None = None) -> MeasuredClearance:
        found = MeasuredClearance(len(motion.times), only=self.only, stretches=stretches)
        is_of_robot = self.only is None or any(ROBOT in pair for pair in self.only)
        if is_of_robot or any(_during(each, motion).any() for each in self.attachments):
            _Measurement(self, motion, found).measure()
        return found


class _Measurement:
    """The distances of a scene's bodies along one motion."""

    def __init__(self, scene: _Scene, motion: Motion, found: MeasuredClearance) -> None:
        self._scene, self._motion, self._found = scene, motion, found
        self._description = scene.robot.description
        self._links = LinkPoses(self._description.joints, motion.joint_positions)
        self._tracks = {
            record.name: object_track(record, scene.attachments, motion, self._links)
            for record in scene.objects
        }
        self._bodies = {
            link: MovingBody(shapes, link_track(self._links, link), found.stretches)
            for link, shapes in scene.robot.shapes.items()
        }

    def measure(self) -> None:
        """Put the distances of all pairs in."""
        scene, motion = self._scene, self._motion
        self._robot_to_itself()
        for record in scene.objects:
            track = self._tracks[record.name]
            there = track.present
            if not record.in_simulation:  # the hand may grip others in the planning scene alone
                there = there & ~_held(record.name, scene.attachments, motion)
            if there.any():
                self._robot_to_object(record, track.part(there), there)
        for attachment in scene.attachments:
            self._held_to_objects(attachment)

    def _robot_to_itself(self) -> None:
        def bodies() -> Iterator[Bodies]:
            names = list(self._bodies)
            for later, second in enumerate(names):
                firsts = [
                    name for name in names[:later] if self._scene.robot.is_self_pair(name, second)
                ]
                yield [self._bodies[name] for name in firsts], self._bodies[second]

        self._measure((ROBOT, ROBOT), np.ones(self._found.count, dtype=bool), bodies())

    def _robot_to_object(self, record: ObjectRecord, track: BodyTrack, there: BoolArray) -> None:
        def bodies() -> Iterator[Bodies]:
            standing = self._description.static_links if record.is_static else frozenset[str]()
            shapes = tracked_shapes(record.name, record.shapes)
            other = MovingBody(shapes, track, self._found.stretches_of(there))
            links = self._bodies.items()
            yield [body.part(there) for link, body in links if link not in standing], other

        self._measure((ROBOT, record.name), there, bodies())

    def _held_to_objects(self, attachment: AttachmentRecord) -> None:
        """Distances of an attached object: in the physics, and as assumed by the planning scene."""
        motion, tracks, objects = self._motion, self._tracks, self._scene.objects
        during = _during(attachment, motion)
        carrier = link_track(self._links, attachment.link)
        held = {attachment.object: carried_track(carrier, attachment.pose_in_link)}
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
                self._object_to_object(there, both, (track.part(there), other.part(there)))

    def _object_to_object(
        self,
        there: BoolArray,
        shapes: tuple[tuple[str, Sequence[Shape]], tuple[str, Sequence[Shape]]],
        tracks: tuple[BodyTrack, BodyTrack],
    ) -> None:
        """Distances of two objects, where both are there."""

        def bodies() -> Iterator[Bodies]:
            first, second = (
                MovingBody(tracked_shapes(*each), track, self._found.stretches_of(there))
                for each, track in zip(shapes, tracks, strict=True)
            )
            yield [first] if first.shapes else [], second

        (first, _), (second, _) = shapes
        self._measure((first, second), there, bodies())

    def _measure(self, key: Pair, there: BoolArray, bodies: Iterable[Bodies]) -> None:
        """Put the distances of two bodies in, unless others are to be measured alone."""
        found, cutoff = self._found, self._scene.cutoff
        if found.only is not None and key not in found.only:
            return
        some = [each for each in bodies if each[0] and each[1].shapes]
        if not some:
            return
        every = [pair for each in some for pair in pairs_between(*each, cutoff)]
        count = int(np.count_nonzero(there))
        if key[0] != ROBOT:
            distances, _ = smallest_distances(every, cutoff, count)
            found.put(key, there, distances, None, largest_travel(every, cutoff, count))
            return
        nearest, links = np.full(count, cutoff), np.full(count, -1, dtype=np.int64)
        for part, pairs in self._scene.robot.by_arms(every, key).items():
            distances, which = smallest_distances(pairs, cutoff, count)
            index = [self._scene.robot.index.get(pair.first.body, -1) for pair in pairs]
            of_part = np.array([*index, -1])[which]
            if part != key:
                travels = largest_travel(pairs, cutoff, count)
                found.put(part, there, distances, of_part, travels)
            links = np.where(distances < nearest, of_part, links)
            nearest = np.minimum(nearest, distances)
        found.put(key, there, nearest, links, largest_travel(every, cutoff, count))


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
