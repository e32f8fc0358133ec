"""The parts of a recording that make up a run: joints, frames and events."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.core.types import FloatArray, IntArray


@dataclass
class RecordedTrack:
    """Rows of numbers, each with two times.

    Attributes:
        logged: Times of the recorder's clock [ns].
        stamps: Times of the sender's clock [ns]; 0 where a message has none.
        numbers: The numbers of all rows, concatenated.
        width: Length of a row.
    """

    width: int
    logged: array[int] = field(default_factory=lambda: array("q"))
    stamps: array[int] = field(default_factory=lambda: array("q"))
    numbers: array[float] = field(default_factory=lambda: array("d"))

    def rows(self) -> FloatArray:
        """The rows in the order of the recording, shape (N, width)."""
        return np.array(self.numbers, dtype=float).reshape(-1, self.width)

    def times(self) -> tuple[IntArray, IntArray]:
        """`logged` and `stamps` as arrays, shape (N,) each."""
        return np.array(self.logged, dtype=np.int64), np.array(self.stamps, dtype=np.int64)


def joined_tracks(tracks: Sequence[RecordedTrack]) -> RecordedTrack:
    """The times of several tracks as one, without their numbers where there are several."""
    if len(tracks) == 1:
        return tracks[0]
    times = RecordedTrack(0)
    for track in tracks:
        times.logged.extend(track.logged)
        times.stamps.extend(track.stamps)
    return times


Tracks = dict[tuple[str, ...], RecordedTrack]  # by joints of a message, or parent and child frame


@dataclass
class BagContent:
    """The content of a recording.

    Attributes:
        joints: Tracks by the joint names of a message; a row has all positions, then velocities,
            then efforts, NaN where the message has none.
        commands: Tracks of commanded joints in the same form.
        edges: T_parent_child (xyz, quat wxyz) by frames, from the frame tree.
        static_edges: The same for static transforms.
        objects: T_frame_object by (frame, object), from the topics that the user named.
        wrenches: Forces [N] and torques [N m] by (topic, frame).
        events: (logged [ns], content) of events in this program's form.
        topics: Type and number of messages of each topic.
    """

    joints: Tracks = field(default_factory=dict[tuple[str, ...], RecordedTrack])
    commands: Tracks = field(default_factory=dict[tuple[str, ...], RecordedTrack])
    edges: Tracks = field(default_factory=dict[tuple[str, ...], RecordedTrack])
    static_edges: Tracks = field(default_factory=dict[tuple[str, ...], RecordedTrack])
    objects: Tracks = field(default_factory=dict[tuple[str, ...], RecordedTrack])
    wrenches: Tracks = field(default_factory=dict[tuple[str, ...], RecordedTrack])
    events: list[tuple[int, dict[str, Any]]] = field(
        default_factory=list[tuple[int, dict[str, Any]]]
    )
    topics: dict[str, tuple[str, int]] = field(default_factory=dict[str, tuple[str, int]])
    notes: list[str] = field(default_factory=list[str])


@dataclass(frozen=True)
class BagTopics:
    """The topics to read, and what they call the robot's joints.

    Attributes:
        joint_states: Topic of the measured joints.
        joint_prefix: Recorded names of joints and links begin with it; those of the scenario lack
            it.
        joint_names: The scenario's name of a joint, by its recorded name.
        objects: Topics whose messages contain object names and poses.
        object_poses: Topic of the pose of one object, by the object's name.
        arms: The joints of the robot, by the name of each of several arms. A topic of joints below
            `/ARM` is that of one arm, whose recorded joints may lack the arm's name and `_`.
        csv_period: Time between the rows of a CSV without a column of times [s].
        reads_wrenches: Whether the robot has sensors of force and torque, so that their topics
            are read.
    """

    joint_states: str = "/joint_states"
    joint_prefix: str = ""
    joint_names: Mapping[str, str] = field(default_factory=dict[str, str])
    objects: tuple[str, ...] = ()
    object_poses: Mapping[str, str] = field(default_factory=dict[str, str])
    arms: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    csv_period: float = 0.01
    reads_wrenches: bool = False
