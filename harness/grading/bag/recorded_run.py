"""Converts a recording to a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.types import BoolArray, FloatArray
from harness.core.world import WorldObject
from harness.grading.bag.clocks import Timeline
from harness.grading.bag.content import BagContent, BagTopics
from harness.grading.bag.doubts import (
    Doubt,
    jump_doubts,
    publisher_doubts,
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
    joint_rows,
    joints_of_frames,
    reference_track,
    sample_times,
)
from harness.grading.bag.message_files import bag_error
from harness.grading.bag.reader import read_bag
from harness.recording.link_poses import replayed_link_poses
from harness.recording.robot_record import RobotRecord
from harness.recording.run import Finding, ObjectRecord, Run
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

NEVER_THERE = (
    *("contact_forces", "presses", "frictions", "support_forces"),
    *("clearances", "planned_clearances", "link_overlaps"),
)
"""Signals that no recording contains."""
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
        raise _no_joints(path, topics, content, known)
    timeline = Timeline(reference)
    times = sample_times(reference, content, timeline)
    if len(times) < 2:
        raise bag_error(path, "has joints at a single time; at least two samples are needed")
    placements = {placement.link: placement for placement in known.robot.placements}
    if content.joints:
        measured = joint_rows(
            content.joints, known.description, timeline, times, topics.joint_states
        )
    else:
        content.notes.append("there are no joint states; the joints are read from /tf")
        measured = joints_of_frames(content, placements, known.description, timeline, times)
    commanded = joint_rows(content.commands, known.description, timeline, times, "/joint_commands")
    links = replayed_link_poses(known.robot, measured.positions, _links_needed(known, content))
    frames = Frames(content, links, timeline, times)
    events = timed_events(content, timeline)
    present = {obj.name: presence_of(events, obj.name, times) for obj in known.objects}
    poses = {
        obj.name: np.where(
            is_present(present[obj.name], times)[:, None], frames.pose(obj.name), np.nan
        )
        for obj in known.objects
        if frames.knows(obj.name)
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
    doubts = [
        *publisher_doubts(content, known.description, timeline, set(poses)),
        *_frame_doubts(frames, list(poses), {obj.name for obj in known.objects if obj.is_static}),
        *_step_doubts(events, steps),
    ]
    twice = {name for doubt in doubts if doubt.kind == "publishers" for name in doubt.names}
    if not _is_of_this_program(events):  # its steps may put objects somewhere
        doubts += jump_doubts(content, timeline, set(poses) - twice)
    if content.joints:
        doubts += tf_doubts(content, placements, known.description, timeline, times, measured)
        if not any(doubt.kind == "publishers" for doubt in doubts):  # jumps are no motion
            doubts += velocity_doubts(known.description, known.robot.arm_joints, times, measured)
    notes = [
        *content.notes,
        *timeline.notes,
        *frames.notes,
        *foreign_links(content, placements),
        *_gaps(known, signals, present),
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


def _frame_doubts(frames: Frames, objects: Sequence[str], static: set[str]) -> list[Doubt]:
    names = {name: frames.assumed_below(name) for name in objects}
    once = [name for name in objects if name not in static and frames.is_published_once(name)]
    return [
        *(
            Doubt("once", f"{name} has one pose in all; it counts as its pose all along", (name,))
            for name in once
        ),
        *_unknown_roots(frames, names),
    ]


def _unknown_roots(frames: Frames, names: Mapping[str, str]) -> list[Doubt]:
    return [
        Doubt(
            "frames",
            f"frame '{frame}' has no parent; it counts as the world",
            tuple(name for name in names if names[name] == frame),
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
    return (*names, *NEVER_THERE)


def _object_record(
    obj: WorldObject,
    known: Recorded,
    poses: Mapping[str, FloatArray],
    present: tuple[StepInterval, ...],
) -> ObjectRecord:
    """An object's record, with the scenario's pose if the object is static and not recorded."""
    is_known = obj.name not in poses and obj.is_static and obj.name in known.at_start
    return ObjectRecord.of(obj, present, obj.pose if is_known else None)


def _gaps(
    known: Recorded, signals: Signals, present: Mapping[str, tuple[StepInterval, ...]]
) -> list[str]:
    """Messages about gaps in joints and objects."""
    messages: list[str] = []
    unknown: BoolArray = np.isnan(signals.joint_positions)
    names = [joint.name for joint in known.robot.joints]
    without = [
        name for name, gone in zip(names, np.all(unknown, axis=0).tolist(), strict=True) if gone
    ]
    if without:
        messages.append(f"the recording lacks the joints {', '.join(without)}")
    for column, name in enumerate(names):
        gone = unknown[:, column]
        if gone.any() and name not in without:
            messages.append(f"{name} has a gap that begins at t={signals.times[gone][0]:.3f} s")
    for name, poses in sorted(signals.object_poses.items()):
        there = is_present(present[name], signals.times)
        gone = np.isnan(poses[:, 0]) & there
        if gone.any():
            share = 100 * float(gone.sum() / there.sum())
            first = signals.times[gone][0]
            messages.append(
                f"{name}: no pose for {share:.0f} % of the time, first at t={first:.3f} s"
            )
    dynamic = [obj.name for obj in known.objects if not obj.is_static]
    lost = [name for name in dynamic if name not in signals.object_poses]
    if lost:
        messages.append(f"the recording lacks poses of {', '.join(lost)}")
    return messages


def _whole(poses: FloatArray, times: FloatArray) -> FloatArray:
    return np.array(np.broadcast_to(poses, (len(times), 7)))


def _no_joints(path: Path, topics: BagTopics, content: BagContent, known: Recorded) -> Exception:
    expected = known.robot.arm_joints
    if content.joints:
        seen = sorted({name for names in content.joints for name in names})
        return bag_error(
            path,
            f"{topics.joint_states} names none of the robot's joints, but {', '.join(seen[:12])}",
            f"expected: {', '.join(expected)}",
        )
    others = [n for n, (kind, _) in sorted(content.topics.items()) if kind.endswith("/JointState")]
    if others:
        hint = f"topics of joint states: {', '.join(others)} (--joint-states TOPIC)"
    else:
        hint = (
            f"its topics: {', '.join(sorted(content.topics)[:20])}"
            if content.topics
            else "it has no messages"
        )
    return bag_error(path, f"has no {topics.joint_states} and no frames of this robot in /tf", hint)
