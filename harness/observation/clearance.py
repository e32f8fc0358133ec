"""Distances along a recorded run: robot to objects and itself, attached to other objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.sharing import is_sharing
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.observation.body_tracks import (
    BodyTrack,
    TrackedShape,
    carried_track,
    links_with_shapes,
    relative_track,
    tracked_shapes,
)
from harness.observation.measured_parts import Group, MeasuredRun, Span, measured_spans
from harness.observation.nearest import ShapePair, pairs_between
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

ROBOT = "robot"


@dataclass(eq=False)
class _Clearances:
    """Distances of each pair, and the nearest links, while they are being measured."""

    count: int
    distances: dict[tuple[str, str], FloatArray] = field(default_factory=dict)
    links: dict[tuple[str, str], IntArray] = field(default_factory=dict)
    travels: dict[tuple[str, str], FloatArray] = field(default_factory=dict)

    def put(self, span: Span) -> None:
        """Set a pair's distances and travel at some samples; NaN or 0 elsewhere until set."""
        key, samples = span.key, span.samples
        if key not in self.travels:
            self.travels[key] = np.zeros(self.count)
        self.travels[key][samples] = span.moved
        if key not in self.distances:
            self.distances[key] = np.full(self.count, np.nan)
        self.distances[key][samples] = span.distances
        if span.links is not None:
            if key not in self.links:
                self.links[key] = np.full(self.count, -1, dtype=np.int64)
            self.links[key][samples] = span.links

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
        run = MeasuredRun(self.description, signals, objects, attachments)
        for span in measured_spans(run, self._groups(run), cutoff):
            found.put(span)
        return found

    def _groups(self, run: MeasuredRun) -> list[Group]:
        """What is measured in a run: the robot, it and each object, what it holds and each."""
        own = (ROBOT, ROBOT)
        robot = self.description.key if is_sharing() else ""
        groups = [Group(own, own, (robot,), lambda _: (), _everywhere, self._self_pairs)]
        bodies = {record.name: _Body.of(record) for record in run.objects}
        for body in bodies.values():
            groups.append(self._object_group(body, robot))
        for number, attachment in enumerate(run.attachments):
            groups += _held_groups(number, attachment, bodies, run, robot)
        return groups

    def _self_pairs(self, run: MeasuredRun, there: BoolArray) -> list[ShapePair]:
        names = list(self._shapes)
        pairs: list[ShapePair] = []
        for later, second in enumerate(names):
            for first in names[:later]:
                if self._is_self_pair(first, second):
                    seen = relative_track(run.link(first).part(there), run.link(second).part(there))
                    pairs += pairs_between(self._shapes[first], self._shapes[second], seen)
        return pairs

    def _object_group(self, body: _Body, robot: str) -> Group:
        record = body.record
        standing = self.description.static_links if record.is_static else frozenset[str]()

        def places(run: MeasuredRun) -> tuple[object, ...]:
            return (run.place(record), run.held(record.name, run.attachments))

        def there(run: MeasuredRun) -> BoolArray:
            return run.tracks[record.name].present & ~run.held(record.name, run.attachments)

        def pairs(run: MeasuredRun, there: BoolArray) -> list[ShapePair]:
            track, found = run.tracks[record.name].part(there), list[ShapePair]()
            for link, shapes in self._shapes.items():
                if link not in standing and body.shapes:
                    seen = relative_track(run.link(link).part(there), track)
                    found += pairs_between(shapes, body.shapes, seen)
            return found

        key = (ROBOT, record.name)
        return Group(key, key, (robot, record.is_static, body.inputs), places, there, pairs)

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


@dataclass(frozen=True, eq=False)
class _Body:
    """An object and its collision shapes."""

    record: ObjectRecord
    shapes: tuple[TrackedShape, ...]

    @classmethod
    def of(cls, record: ObjectRecord) -> _Body:
        return cls(record, tracked_shapes(record.name, record.shapes))

    @property
    def inputs(self) -> tuple[object, ...]:
        """What of the object decides distances to it."""
        return tuple((shape.geometry, shape.pose) for shape in self.record.shapes)


def _everywhere(run: MeasuredRun) -> BoolArray:
    return np.ones(len(run.signals.times), dtype=bool)


def _held_groups(
    number: int,
    attachment: AttachmentRecord,
    bodies: Mapping[str, _Body],
    run: MeasuredRun,
    robot: str,
) -> Iterator[Group]:
    """Distances of an attached object: as assumed by the planning scene, and in the physics."""
    own = (attachment.object, attachment.represents)
    in_physics = [name for name in own if name in run.signals.object_poses and name in bodies]
    for name in dict.fromkeys((attachment.object, *in_physics)):
        for other in bodies.values():
            if other.record.name not in own:
                yield _held_group(
                    number, attachment, bodies.get(name), name in in_physics, other, robot
                )


def _held_group(
    number: int,
    attachment: AttachmentRecord,
    held: _Body | None,
    is_in_physics: bool,
    other: _Body,
    robot: str,
) -> Group:
    name = held.record.name if held else attachment.object

    def track(run: MeasuredRun) -> BodyTrack:
        if is_in_physics:
            return run.tracks[name]
        return carried_track(run.link(attachment.link), attachment.pose_in_link)

    def places(run: MeasuredRun) -> tuple[object, ...] | None:
        during = run.during(attachment)
        if not during.any():
            return None
        own = run.place(held.record) if held and is_in_physics else attachment
        return during, own, run.place(other.record), run.held(other.record.name, (attachment,))

    def there(run: MeasuredRun) -> BoolArray:
        both = track(run).present & run.tracks[other.record.name].present
        return run.during(attachment) & both & ~run.held(other.record.name, (attachment,))

    def pairs(run: MeasuredRun, there: BoolArray) -> list[ShapePair]:
        seen = relative_track(track(run).part(there), run.tracks[other.record.name].part(there))
        return pairs_between(held.shapes if held else (), other.shapes, seen)

    key = (name, other.record.name)
    inputs = (robot, held.inputs if held else (), other.inputs)
    return Group((str(number), *key), key, inputs, places, there, pairs, with_links=False)
