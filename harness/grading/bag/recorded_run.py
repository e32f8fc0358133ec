"""Converts a recording to a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.grading.bag.clocks import SAME_CLOCK, Timeline
from harness.grading.bag.content import BagContent, BagTopics, RecordedTrack
from harness.grading.bag.doubts import (
    Doubt,
    joint_doubts,
    object_doubts,
    source_doubts,
    tf_doubts,
    velocity_doubts,
)
from harness.grading.bag.events import (
    StepInterval,
    Timed,
    attachments_of,
    is_present,
    presence_of,
    steps_of,
    timed_events,
)
from harness.grading.bag.frames import Frames
from harness.grading.bag.joints import (
    foreign_links,
    joint_messages,
    joint_rows,
    messages_of_frames,
    reference_track,
    traces_of,
)
from harness.grading.bag.message_files import bag_error
from harness.grading.bag.missing import gaps, no_joints
from harness.grading.bag.reader import read_bag
from harness.grading.bag.sampling import Trace, gap_limit, sample_times
from harness.recording.link_poses import replayed_link_poses
from harness.recording.robot_record import RobotRecord
from harness.recording.run import Finding, ObjectRecord, Run
from harness.recording.signals import UNPUBLISHED, Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

JOINT_SIGNALS = (
    "joint_velocities",
    "joint_efforts",
    "joint_commands",
    "joint_command_velocities",
)
MOST_NUMBERS = 60_000_000
"""Most numbers of all signals of a run (480 MB); ten minutes of twelve joints at 500 Hz and of five
objects at 100 Hz need 40 million."""
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

    robot: RobotRecord
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
    content = read_bag(path, topics)
    reference = reference_track(content, known.description, known.robot.arm_joints)
    if reference is None:
        raise no_joints(path, topics, content, known.robot.arm_joints)
    timeline = Timeline(reference)
    placements = {placement.link: placement for placement in known.robot.placements}
    in_frames = messages_of_frames(content, placements, known.description, timeline)
    states = joint_messages(content.joints, known.description, timeline, topics.joint_states)
    messages = states or in_frames
    if not states:
        content.notes.append("there are no joint states; the joints are read from /tf")
    commands = joint_messages(content.commands, known.description, timeline, "/joint_commands")
    joints, commanded_joints = traces_of(messages), traces_of(commands)
    frames = Frames(content, known.robot.link_names, timeline)
    seen = [obj for obj in known.objects if frames.knows(obj.name)]
    moving = frames.moving(obj.name for obj in seen)
    traces = [
        *(each for some in (joints, commanded_joints) for kinds in some.values() for each in kinds),
        *map(frames.trace, moving),
    ]
    others = (*content.joints.values(), *content.commands.values(), *moving)
    times = _judged_times(path, traces, [reference, *others], content, timeline)
    numbers = len(times) * (5 * len(known.robot.joints) + 7 * (len(seen) + len(known.frames) + 1))
    if numbers > MOST_NUMBERS:
        hint = "cut out what is to be graded, with `ros2 bag convert` for example"
        raise bag_error(path, f"has messages at {len(times)} different times", hint)
    measured = joint_rows(joints, known.description, times)
    commanded = joint_rows(commanded_joints, known.description, times)
    links = replayed_link_poses(known.robot, measured.positions, _links_needed(known, content))
    events = timed_events(content, timeline, float(times[0]))
    present = {obj.name: presence_of(events, obj.name, times) for obj in known.objects}
    poses = {
        obj.name: np.where(
            is_present(present[obj.name], times)[:, None],
            frames.pose(obj.name, links, times),
            np.nan,
        )
        for obj in seen
    }
    signals = Signals(
        times=times,
        joint_positions=measured.positions,
        joint_velocities=measured.velocities,
        joint_efforts=measured.efforts,
        joint_commands=commanded.positions,
        joint_command_velocities=commanded.velocities,
        tcp_pose=_whole(links[known.robot.tcp_link], times),
        frames={name: _whole(links[name], times) for name in known.frames if name in links},
        object_poses=poses,
    )
    steps, attachments = steps_of(events, times, known.steps), attachments_of(events)
    is_own = _is_of_this_program(events)
    shapes = {obj.name: obj.shapes for obj in seen}
    movable = [obj.name for obj in known.objects if not obj.is_static]
    doubts = [
        *joint_doubts(messages, is_own=is_own),
        *object_doubts(content.edges, timeline, shapes, is_own=is_own),
        *object_doubts(content.objects, timeline, shapes, is_own=is_own),
        *_once_doubts(frames, [name for name in movable if name in shapes], is_own=is_own),
        *_unknown_roots(frames, list(shapes)),
        *_step_doubts(events, steps),
    ]
    for name in shapes:
        for others in frames.other_poses(name, links, times):
            doubts += source_doubts(name, shapes[name], times, poses[name], others)
    if states:
        shown = joint_rows(traces_of(in_frames), known.description, times)
        doubts += tf_doubts(known.description, times, measured, shown)
        if not any(doubt.kind == "publishers" for doubt in doubts):  # jumps are no motion
            arm = known.robot.arm_joints
            doubts += velocity_doubts({n: each for n, each in messages.items() if n in arm})
    notes = [
        *content.notes,
        *timeline.notes,
        *frames.notes,
        *foreign_links(content, placements),
        *gaps([joint.name for joint in known.robot.joints], movable, signals, present),
    ]
    return Run(
        scenario=known.title,
        file=str(path),
        case="",
        seed=0,
        robot=known.robot,
        objects=tuple(
            _object_record(obj, known, poses, present[obj.name]) for obj in known.objects
        ),
        attachments=attachments,
        steps=steps,
        signals=signals,
        gravity=known.gravity,
        timestep=float(np.median(np.diff(times))),
        findings=(
            *(Finding(FINDING, note) for note in notes),
            *(
                Finding(DOUBT, doubt.message, values={"doubt": doubt.kind, "names": doubt.names})
                for doubt in doubts
            ),
        ),
        unrecorded=_unrecorded(signals, events, has_steps=bool(steps)),
    )


def _links_needed(known: Recorded, content: BagContent) -> set[str]:
    """Links that expectations use, or that other frames are attached to."""
    robot = set(known.robot.link_names)
    edges = [*content.edges, *content.static_edges, *content.objects]
    carriers = {parent for parent, child in edges if child not in robot}
    return {known.robot.tcp_link, *known.frames, *(carriers & robot)}


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
        path: The recording, for its error.
        traces: What was recorded of joints and objects.
        tracks: Their messages, the joints' first.
        content: What was read of the recording.
        timeline: The times of its messages.

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


def _once_doubts(frames: Frames, names: Sequence[str], *, is_own: bool) -> Iterator[Doubt]:
    """Movable objects of which a single pose counts at all times."""
    for name in names:
        if frames.is_published_once(name) and not is_own:
            reason = f"{name} has one pose in all, or one in /tf_static; it counts all along"
            yield Doubt("once", reason, (name,))


def _unknown_roots(frames: Frames, names: Sequence[str]) -> list[Doubt]:
    return [
        Doubt(
            "frames",
            f"frame '{frame}' has no parent; it counts as the world",
            tuple(name for name in names if frames.assumed_below(name) == frame),
        )
        for frame in frames.assumed
    ]


def _step_doubts(events: list[Timed], steps: Sequence[StepRecord]) -> list[Doubt]:
    """Steps that the recorded program itself said had begun and ended."""
    if not steps or _is_of_this_program(events):
        return []
    names = ", ".join(step.id for step in steps[:5])
    return [Doubt("steps", f"the recorded program chose when these steps began: {names}")]


def _is_of_this_program(events: list[Timed]) -> bool:
    return any(event.get("event") == "run_started" for _, event in events)


def _unrecorded(signals: Signals, events: list[Timed], *, has_steps: bool) -> tuple[str, ...]:
    """Signals that are missing; events of other programs than this one may have steps alone."""
    names = [name for name in JOINT_SIGNALS if np.isnan(getattr(signals, name)).all()]
    if not _is_of_this_program(events):
        names += ["attachments"] if has_steps else ["attachments", "steps"]
    return (*names, *UNPUBLISHED, "clearances")


def _object_record(
    obj: WorldObject,
    known: Recorded,
    poses: Mapping[str, FloatArray],
    present: tuple[StepInterval, ...],
) -> ObjectRecord:
    """An object's record, with the scenario's pose if the object is static and not recorded."""
    is_known = obj.name not in poses and obj.is_static and obj.name in known.at_start
    return ObjectRecord.of(obj, present, obj.pose if is_known else None)


def _whole(poses: FloatArray, times: FloatArray) -> FloatArray:
    return np.array(np.broadcast_to(poses, (len(times), 7)))
