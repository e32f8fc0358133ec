"""Measures the distances of a run in parts; cases share those whose samples are equal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from harness.core.exact_key import exact_key
from harness.core.sharing import Chain, chain
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.observation.body_tracks import BodyTrack, link_track, object_track
from harness.observation.nearest import Measured, ShapePair, smallest_distances
from harness.observation.sampled_clearance import at_samples
from harness.recording.run import AttachmentRecord, ObjectRecord, Signals
from harness.robot.description import RobotDescription
from harness.robot.forward_kinematics import LinkPoses

PART = 256
"""Samples of a part that cases share."""

LONGEST_PART = 8192
"""Samples of a part that is not shared: what is computed of more would need much memory."""


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """What distances follow from, and the tracks of all bodies.

    Attributes:
        signals: Times, joint positions and object poses at the samples.
    """

    description: RobotDescription
    signals: Signals
    objects: Sequence[ObjectRecord]
    attachments: Sequence[AttachmentRecord]

    def at(self, samples: IntArray) -> MeasuredRun:
        """The run at some of its samples."""
        return replace(self, signals=at_samples(self.signals, samples))

    @cached_property
    def links(self) -> LinkPoses:
        """Poses of the robot's links."""
        return LinkPoses(self.description, self.signals.joint_positions)

    def link(self, name: str) -> BodyTrack:
        """The track of a link."""
        return link_track(self.links, name)

    @cached_property
    def tracks(self) -> Mapping[str, BodyTrack]:
        """The tracks of the objects."""
        return {
            each.name: object_track(each, self.attachments, self.signals, self.links)
            for each in self.objects
        }

    def during(self, attachment: AttachmentRecord) -> BoolArray:
        """Samples in which an object is attached."""
        times = self.signals.times
        return (times >= attachment.start_time) & (times <= attachment.end_time)

    def held(self, name: str, attachments: Sequence[AttachmentRecord]) -> BoolArray:
        """Samples in which an object, or the object that represents it, is attached."""
        held = np.zeros(len(self.signals.times), dtype=bool)
        for attachment in attachments:
            if name in (attachment.object, attachment.represents):
                held |= self.during(attachment)
        return held

    @property
    def is_divisible(self) -> bool:
        """Whether where everything is at a sample follows from that sample alone.

        An object that the physics does not have stays where it was detached.
        """
        poses = self.signals.object_poses
        return all(attachment.object in poses for attachment in self.attachments)

    def place(self, record: ObjectRecord) -> tuple[object, ...]:
        """Where an object is at the samples: input of all distances to it."""
        times, poses = self.signals.times, self.signals.object_poses
        there = [(times >= start) & (times <= end) for start, end in record.present]
        return poses.get(record.name, record.pose), there


@dataclass(frozen=True, eq=False)
class Group:
    """Pairs of shapes whose smallest distance is one signal.

    Attributes:
        name: Its name among the groups of a run.
        key: The names of the two bodies.
        bodies: Inputs that are the same at all samples: the shapes.
        places: Inputs at the samples of a part of the run; None where nothing is measured.
        there: Samples of a part at which both are there.
        pairs: The pairs of shapes at some samples of a part.
        with_links: Whether the links that are nearest are kept.
    """

    name: tuple[str, ...]
    key: tuple[str, str]
    bodies: tuple[object, ...]
    places: Callable[[MeasuredRun], tuple[object, ...] | None]
    there: Callable[[MeasuredRun], BoolArray]
    pairs: Callable[[MeasuredRun, BoolArray], list[ShapePair]]
    with_links: bool = True


@dataclass(frozen=True, eq=False)
class Span:
    """The distances of two bodies at some samples.

    Attributes:
        key: The names of the two bodies.
        samples: Indices of the samples in the run.
        distances: The smallest distances [m], at most the cutoff.
        links: The indices of the nearest links, -1 at the cutoff; None where they are not kept.
        moved: The most that any pair of shapes moves since the sample before [m].
    """

    key: tuple[str, str]
    samples: IntArray
    distances: FloatArray
    links: IntArray | None
    moved: FloatArray


@dataclass(frozen=True, eq=False)
class _Known:
    """What is known of a group.

    Attributes:
        sample: The last sample at which it was measured.
        measured: What is known of its pairs there.
    """

    sample: int
    measured: Measured


@dataclass(frozen=True, eq=False)
class _Part:
    """Distances of a group at consecutive samples, and what is known after the last of them."""

    span: Span | None
    known: _Known | None


def measured_spans(run: MeasuredRun, groups: Sequence[Group], cutoff: float) -> Iterator[Span]:
    """The smallest distances of all groups, each group's in the order of time.

    A part is known by the hash of its samples and of the part before it: what is measured follows
    from nothing else.
    """
    count = len(run.signals.times)
    chains = _chains(run, groups, cutoff)
    size = PART if chains else LONGEST_PART if run.is_divisible else count
    known: dict[tuple[str, ...], _Known] = {}
    for begin in range(0, count, size):
        samples = np.arange(begin, min(begin + size, count))
        part = _PartOfRun(run, samples, tuple(known.values()))
        for group in groups:
            measured = partial(_measured, part, group, cutoff, known.get(group.name))
            shared = chains.get(group.name)
            found = measured() if shared is None else shared.next(part.own, measured)
            if found is None:
                continue
            if found.known is not None:
                known[group.name] = found.known
            if found.span is not None:
                yield found.span


def _chains(
    run: MeasuredRun, groups: Sequence[Group], cutoff: float
) -> dict[tuple[str, ...], _GroupChain]:
    """The parts of each group that cases share; none where nothing is shared."""
    if not run.is_divisible or len(run.signals.times) < PART:
        return {}
    chains: dict[tuple[str, ...], _GroupChain] = {}
    for group in groups:
        results = chain("distances")
        if results is not None:
            chains[group.name] = _GroupChain(group, results, exact_key(group.bodies, cutoff))
    return chains


class _GroupChain:
    """The parts of a group, each known by its inputs and the key of the part before it."""

    def __init__(self, group: Group, results: Chain, key: str) -> None:
        self._group, self._results, self._key = group, results, key

    def next(self, run: MeasuredRun, measured: Callable[[], _Part]) -> _Part | None:
        """The next part, from another case or measured; None where there is nothing to measure."""
        places = self._group.places(run)
        if places is None:
            return None
        if self._results.is_over:
            self._results.note()
            return measured()
        signals = run.signals
        self._key = exact_key(self._key, signals.times, signals.joint_positions, places)
        found = self._results.find(self._key)
        if found is None:
            found = measured()
            self._results.keep(self._key, lambda: found)
        return found


class _PartOfRun:
    """Consecutive samples of a run, and the earlier ones from which groups go on.

    Attributes:
        samples: Indices of the samples.
        needed: Indices of all of them, the earlier ones first.
    """

    def __init__(self, run: MeasuredRun, samples: IntArray, known: Sequence[_Known]) -> None:
        self._run = run
        self.samples = samples
        earlier = sorted({each.sample for each in known})
        self.needed = np.concatenate([np.array(earlier, dtype=np.int64), samples])

    @cached_property
    def own(self) -> MeasuredRun:
        """The run at the samples."""
        return self._run.at(self.samples)

    @cached_property
    def whole(self) -> MeasuredRun:
        """The run at all that are needed."""
        return self._run.at(self.needed)


def _measured(part: _PartOfRun, group: Group, cutoff: float, before: _Known | None) -> _Part:
    """Distances of a group at the samples of a part, after those of which something is known."""
    first = int(part.samples[0])
    there = group.there(part.whole) & (part.needed >= (before.sample if before else first))
    own = part.needed[there]
    if not len(own) or own[-1] < first:
        return _Part(None, before)
    pairs = group.pairs(part.whole, there)
    if not pairs:
        return _Part(None, before)
    found = smallest_distances(pairs, cutoff, before.measured if before else None)
    links = None
    if group.with_links:
        names = {name: index for index, name in enumerate(part.whole.description.link_names)}
        of_pair = np.array([names[pair.first.body] for pair in pairs] + [-1])
        links = of_pair[found.pairs]
    span = Span(group.key, own[own >= first], found.distances, links, found.moved)
    return _Part(span, _Known(int(own[-1]), found.measured))
