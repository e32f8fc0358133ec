"""What a recording holds that a run is made of: joints, frames, events, compact."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.core.types import FloatArray, IntArray


@dataclass
class Track:
    """Rows of numbers with two times each.

    Attributes:
        logged: By the recorder's clock [ns].
        stamps: By the sender's clock [ns]; 0 where it gave none.
        numbers: Rows one behind the other.
        width: Of a row.
    """

    width: int
    logged: array[int] = field(default_factory=lambda: array("q"))
    stamps: array[int] = field(default_factory=lambda: array("q"))
    numbers: array[float] = field(default_factory=lambda: array("d"))

    def rows(self) -> FloatArray:
        """Shape (N, width), in the order of the recording."""
        return np.array(self.numbers, dtype=float).reshape(-1, self.width)

    def times(self) -> tuple[IntArray, IntArray]:
        """`logged` and `stamps`, shape (N,) each."""
        return np.array(self.logged, dtype=np.int64), np.array(self.stamps, dtype=np.int64)


Tracks = dict[tuple[str, ...], Track]
"""By the joints of a message, or by parent and child frame."""


@dataclass
class BagContent:
    """What was found.

    Attributes:
        joints: By the names of a message: positions, velocities, efforts of each, one after the
            other; NaN where the message has none.
        commands: The same of commanded joints.
        edges: T_parent_child (xyz, quat wxyz) by frames, of the tree of frames.
        static_edges: Those that were said to hold for ever.
        objects: T_frame_object by (frame, object), of topics that the user named.
        events: (logged [ns], content) of the events of this program, or of a student's in the same
            form.
        topics: How many messages each topic has, and of what type they are.
        notes: What a person should know.
    """

    joints: Tracks = field(default_factory=dict[tuple[str, ...], Track])
    commands: Tracks = field(default_factory=dict[tuple[str, ...], Track])
    edges: Tracks = field(default_factory=dict[tuple[str, ...], Track])
    static_edges: Tracks = field(default_factory=dict[tuple[str, ...], Track])
    objects: Tracks = field(default_factory=dict[tuple[str, ...], Track])
    events: list[tuple[int, dict[str, Any]]] = field(
        default_factory=list[tuple[int, dict[str, Any]]]
    )
    topics: dict[str, tuple[str, int]] = field(default_factory=dict[str, tuple[str, int]])
    notes: list[str] = field(default_factory=list[str])


@dataclass(frozen=True)
class BagTopics:
    """Where to look.

    Attributes:
        joint_states: Topic of the measured joints.
        objects: Topics whose messages name the objects that they are about.
        object_poses: Topic of the pose of one object, by the object's name.
    """

    joint_states: str = "/joint_states"
    objects: tuple[str, ...] = ()
    object_poses: Mapping[str, str] = field(default_factory=dict[str, str])
