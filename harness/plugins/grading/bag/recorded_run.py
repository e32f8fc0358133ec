"""Converts a recording to a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.limits import BAG_SIGNALS
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.plugins.grading.bag.clocks import SAME_CLOCK, Timeline
from harness.plugins.grading.bag.content import BagContent, BagTopics, RecordedTrack
from harness.plugins.grading.bag.doubts import (
    Doubt,
    joint_doubts,
    object_doubts,
    source_doubts,
    tf_doubts,
    velocity_doubts,
)
from harness.plugins.grading.bag.events import (
    is_present,
    presence_of,
    steps_of,
    timed_events,
)
from harness.plugins.grading.bag.frames import Frames
from harness.plugins.grading.bag.joint_csv import read_joint_csv
from harness.plugins.grading.bag.joints import (
    foreign_links,
    joint_messages,
    joint_rows,
    messages_of_frames,
    reference_track,
    traces_of,
)
from harness.plugins.grading.bag.message_files import bag_error
from harness.plugins.grading.bag.missing import gaps, no_joints
from harness.plugins.grading.bag.reader import read_bag
from harness.plugins.grading.bag.sampling import Trace, gap_limit, sample_times
from harness.plugins.grading.bag.wrenches import wrench_traces
from harness.recording.link_poses import replayed_link_poses
from harness.recording.run import Finding, ObjectRecord, Run
from harness.recording.signals import UNPUBLISHED, Signals
from harness.robot.description import RobotDescription

JOINT_SIGNALS = (
    "joint_velocities",
    "joint_efforts",
    "joint_commands",
    "joint_command_velocities",
)
FINDING, DOUBT = "recording", "doubt"


@dataclass(frozen=True, eq=False)
class Recorded:
    """The scenario's knowledge about a recording.

    Attributes:
        objects: Objects of the world, then those that steps add.
        at_start: Names of the world's objects.
        frames: Links whose poses expectations need.
        steps: Line and summary of each step, by id and by path.
        gravity: Gravity in world axes [m/s^2].
    """

    description: RobotDescription
    objects: Sequence[WorldObject]
    at_start: frozenset[str]
    frames: Sequence[str]
    steps: Mapping[str, tuple[int, str]]
    title: str
    gravity: tuple[float, float, float]


def run_of_bag(path: Path, topics: BagTopics, known: Recorded) -> Run:
    """Read a recording as a run; `unrecorded` and findings name the missing signals.

    Raises:
        SpecError: It cannot be read, or has no joints of this robot.
    """
    return _Recording(path, topics, known).run()


class _Recording:
    """What is known of a recording's joints, objects and steps at the times that are judged."""

    def __init__(self, path: Path, topics: BagTopics, known: Recorded) -> None:
        self._path, self._known = path, known
        description = known.description
        unknown = sorted(set(topics.joint_names.values()) - set(description.joint_names))
        if unknown:
            hint = f"joints: {', '.join(description.joint_names)}"
            raise bag_error(path, f"the robot has no joint '{unknown[0]}'", hint)
        self._content = content = (
            read_joint_csv(path, topics, description.arm_joints, description.joint_names)
            if path.suffix.lower() == ".csv"
            else read_bag(path, topics)
        )
        reference = reference_track(content, description, description.arm_joints)
        if reference is None:
            raise no_joints(path, topics, content, description.arm_joints)
        self._timeline = timeline = Timeline(reference)
        self._in_frames = messages_of_frames(content, description, timeline)
        self._states = joint_messages(content.joints, description, timeline, topics.joint_states)
        if not self._states:
            content.notes.append("there are no joint states; the joints are read from /tf")
        self._messages = self._states or self._in_frames
        commands = joint_messages(content.commands, description, timeline, "/joint_commands")
        joints, commanded_joints = traces_of(self._messages), traces_of(commands)
        self._frames = frames = Frames(content, description.link_names, timeline)
        self._shapes = {obj.name: obj.shapes for obj in known.objects if frames.knows(obj.name)}
        self._movable = [obj.name for obj in known.objects if not obj.is_static]
        moving = frames.moving(self._shapes)
        kinds = [*joints.values(), *commanded_joints.values()]
        self._wrenches = wrench_traces(content, description.wrench_sensors.values(), timeline)
        traces = [*(trace for each in kinds for trace in each), *map(frames.trace, moving)]
        traces += self._wrenches.values()
        others = (
            *content.joints.values(),
            *content.commands.values(),
            *content.wrenches.values(),
            *moving,
        )
        self._times = times = _judged_times(path, traces, [reference, *others], content, timeline)
        self._refuse_too_many()
        self._measured = joint_rows(joints, description, times)
        self._commanded = joint_rows(commanded_joints, description, times)
        self._links = replayed_link_poses(
            description, self._measured.positions, self._links_needed()
        )
        self._events = timed_events(content, timeline, float(times[0]))
        self._steps = steps_of(self._events, times, known.steps)
        self._present = {
            obj.name: presence_of(self._events, obj.name, times) for obj in known.objects
        }
        self._poses = {name: self._object_poses(name) for name in self._shapes}

    def _refuse_too_many(self) -> None:
        known = self._known
        bodies = len(self._shapes) + len(known.frames) + 1
        if len(self._times) * (5 * len(known.description.joint_names) + 7 * bodies) > BAG_SIGNALS:
            hint = "cut out what is to be graded, with `ros2 bag convert` for example"
            message = f"has messages at {len(self._times)} different times"
            raise bag_error(self._path, message, hint)

    def _links_needed(self) -> set[str]:
        """Links that expectations use, or that other frames are attached to."""
        content, robot = self._content, set(self._known.description.link_names)
        edges = [*content.edges, *content.static_edges, *content.objects]
        carriers = {parent for parent, child in edges if child not in robot}
        return {self._known.description.tcp_link, *self._known.frames, *(carriers & robot)}

    def _object_poses(self, name: str) -> FloatArray:
        here = is_present(self._present[name], self._times)[:, None]
        return np.where(here, self._frames.pose(name, self._links, self._times), np.nan)

    def run(self) -> Run:
        """The recording as a run."""
        known, signals = self._known, self._signals()
        doubts = self._doubts()  # before the notes on what they look at
        return Run(
            scenario=known.title,
            file=str(self._path),
            case="",
            seed=0,
            robot=known.description,
            objects=tuple(map(self._object_record, known.objects)),
            attachments=(),
            steps=self._steps,
            signals=signals,
            gravity=known.gravity,
            timestep=float(np.median(np.diff(self._times))),
            findings=(
                *(Finding(FINDING, note) for note in self._notes(signals)),
                *(
                    Finding(DOUBT, each.message, values={"doubt": each.kind, "names": each.names})
                    for each in doubts
                ),
            ),
            unrecorded=self._unrecorded(signals),
        )

    def _signals(self) -> Signals:
        known, links = self._known, self._links
        measured, commanded = self._measured, self._commanded
        return Signals(
            times=self._times,
            joint_positions=measured.positions,
            joint_velocities=measured.velocities,
            joint_efforts=measured.efforts,
            joint_commands=commanded.positions,
            joint_command_velocities=commanded.velocities,
            tcp_pose=links[known.description.tcp_link],
            frames={name: links[name] for name in known.frames if name in links},
            object_poses=self._poses,
            wrenches={name: trace.at(self._times) for name, trace in self._wrenches.items()},
        )

    def _notes(self, signals: Signals) -> list[str]:
        return [
            *self._content.notes,
            *self._timeline.notes,
            *self._frames.notes,
            *foreign_links(self._content, self._known.description),
            *gaps(self._known.description.joint_names, self._movable, signals, self._present),
        ]

    def _doubts(self) -> list[Doubt]:
        content, timeline = self._content, self._timeline
        times, shapes = self._times, self._shapes
        doubts = [
            *joint_doubts(self._messages),
            *object_doubts(content.edges, timeline, shapes),
            *object_doubts(content.objects, timeline, shapes),
            *self._once_doubts(),
            *self._unknown_roots(),
            *self._step_doubts(),
        ]
        for name, poses in self._poses.items():
            for others in self._frames.other_poses(name, self._links, times):
                doubts += source_doubts(name, shapes[name], times, poses, others)
        if self._states:
            description = self._known.description
            shown = joint_rows(traces_of(self._in_frames), description, times)
            doubts += tf_doubts(description, times, self._measured, shown)
            if not any(doubt.kind == "publishers" for doubt in doubts):  # jumps are no motion
                arm = self._messages.keys() & set(self._known.description.arm_joints)
                doubts += velocity_doubts(
                    {name: each for name, each in self._messages.items() if name in arm}
                )
        return doubts

    def _once_doubts(self) -> Iterator[Doubt]:
        """Movable objects of which a single pose counts at all times."""
        for name in self._movable:
            if name in self._shapes and self._frames.is_published_once(name):
                reason = f"{name} has one pose in all, or one in /tf_static; it counts all along"
                yield Doubt("once", reason, (name,))

    def _unknown_roots(self) -> Iterator[Doubt]:
        for frame in self._frames.assumed:
            names = (name for name in self._shapes if self._frames.assumed_below(name) == frame)
            reason = f"frame '{frame}' has no parent; it counts as the world"
            yield Doubt("frames", reason, tuple(names))

    def _step_doubts(self) -> Iterator[Doubt]:
        """What the recorded program itself said: when steps ran, and when objects were there."""
        if self._steps:
            names = ", ".join(step.id for step in self._steps[:5])
            yield Doubt("steps", f"the recorded program chose when these steps began: {names}")
        for name, spans in self._present.items():
            if spans != ((self._times[0], self._times[-1]),):
                reason = f"the recorded program chose when {name} was there"
                yield Doubt("steps", reason, (name,))

    def _unrecorded(self, signals: Signals) -> tuple[str, ...]:
        """Signals that are missing; what programs say of themselves is not recorded."""
        names = [name for name in JOINT_SIGNALS if np.isnan(getattr(signals, name)).all()]
        names += ["attachments", "step_results" if self._steps else "steps"]
        return (*names, *UNPUBLISHED, "clearances")

    def _object_record(self, obj: WorldObject) -> ObjectRecord:
        """An object's record, with the scenario's pose if the object is static and not recorded."""
        is_known = obj.name not in self._poses and obj.is_static
        pose = obj.pose if is_known and obj.name in self._known.at_start else None
        return ObjectRecord.of(obj, self._present[obj.name], pose)


def _judged_times(
    path: Path,
    traces: Sequence[Trace | None],
    tracks: Sequence[RecordedTrack],
    content: BagContent,
    timeline: Timeline,
) -> FloatArray:
    """Times of the samples [s]: those of every message about a joint or an object.

    Stamps of times before or after the recording, as of a message that was sent once before it, do
    not count. Where every other topic falls silent before the last one, the last sample is its end.

    Args:
        traces: What was recorded of joints and objects.

    Raises:
        SpecError: There are fewer than two, or too many.
    """
    seconds, is_judged = timeline.rows(tracks[0])
    own: FloatArray = np.unique(seconds[is_judged])
    first, last = timeline.recorded(tracks)
    limit = gap_limit(own)
    found = sample_times([trace for trace in traces if trace is not None])
    margin = min(limit, SAME_CLOCK)
    found = found[(found >= min(first, own[0]) - margin) & (found <= max(last, own[-1]) + margin)]
    if len(own) < 2 or len(found) < 2:
        raise bag_error(path, "has joints at a single time; at least two samples are needed")
    ends: list[float] = []
    for track in (*content.joints.values(), *content.edges.values(), *content.objects.values()):
        seconds, is_judged = timeline.rows(track)
        ends.append(float(seconds[is_judged].max(initial=-np.inf)))
    return np.append(found, max(ends)) if max(ends) - found[-1] > limit else found
