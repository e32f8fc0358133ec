"""A bag written: a folder that `ros2 bag`, RViz, Foxglove and rerun open."""

from __future__ import annotations

import heapq
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Literal

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from harness.core.errors import HarnessError
from harness.core.types import IntArray
from harness.plugins.ros.bag import cameras
from harness.plugins.ros.bag.events import event_messages
from harness.plugins.ros.bag.frames import moving_tf, static_tf
from harness.plugins.ros.bag.layouts import foxglove_layout, rviz_configuration
from harness.plugins.ros.bag.markers import scene_markers
from harness.plugins.ros.bag.messages import TYPESTORE, joint_state, message, nanoseconds, stamp
from harness.plugins.ros.bag.plans import planned, tcp_paths
from harness.plugins.ros.bag.samples import Message, samples_at
from harness.plugins.ros.bag.topics import (
    CLOCK,
    JOINT_COMMANDS,
    JOINT_STATES,
    ROBOT_DESCRIPTION,
    Topic,
)
from harness.plugins.ros.bag.urdf import MeshAddresses, urdf_of
from harness.plugins.ros.bag.wrenches import wrenches
from harness.recording.files import disk_advice
from harness.recording.run import Run
from harness.recording.stored_run import StoredRun

VERSION = 8
"""Of rosbag2's metadata. Version 9 says QoS in words, which Humble and Iron cannot read; Jazzy and
later read both."""

BAG = "bag"  # the folder of a bag that is written with its run
Storage = Literal["mcap", "sqlite3"]
ROBOT, LAYOUT, RVIZ = "robot.urdf", "foxglove.json", "view.rviz"


@dataclass(frozen=True)
class BagOptions:
    """How a bag is written.

    Attributes:
        storage: `mcap` is compressed (zstd chunks); `sqlite3` is what Humble writes by default.
        rate: The rate of joints, frames and clock [Hz].
        has_raw_images: Whether videos are written uncompressed too.
        meshes: How the URDF names mesh files.
    """

    storage: Storage = "mcap"
    rate: float = 100.0
    has_raw_images: bool = False
    meshes: MeshAddresses = "package"


def write_bag(folder: Path, stored: StoredRun, options: BagOptions | None = None) -> None:
    """Write a run as a rosbag2; equal runs and options give equal bytes.

    The bag's files are called as the folder is. Next to them lie the URDF, a layout for Foxglove
    and a configuration for RViz.

    Args:
        folder: Must not be there yet.
        stored: A saved run; nothing else is read.

    Raises:
        HarnessError: The disk is full, or the place is not writable or taken.
    """
    options = options or BagOptions()
    if folder.exists():
        raise HarnessError(f"{folder} is there already; a bag needs a new folder")
    try:
        _write_messages(folder, stored, options)
        run = stored.run
        _text(folder / ROBOT, urdf_of(run, options.meshes))
        _text(folder / LAYOUT, foxglove_layout(stored))
        _text(folder / RVIZ, rviz_configuration(stored))
    except (OSError, sqlite3.OperationalError) as error:  # the storage says that a disk is full
        advice = disk_advice(error) if isinstance(error, OSError) else "free some space there, or "
        raise HarnessError(
            f"the bag cannot be written to {folder}: {getattr(error, 'strerror', None) or error};"
            f" {advice}choose another place"
        ) from error


def _write_messages(folder: Path, stored: StoredRun, options: BagOptions) -> None:
    plugin = StoragePlugin.MCAP if options.storage == "mcap" else StoragePlugin.SQLITE3
    writer = Writer(folder, version=VERSION, storage_plugin=plugin)
    if options.storage == "mcap":
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    for key, value in _about(stored).items():
        writer.set_custom_data(key, value)
    connections: dict[str, Connection] = {}
    with writer:
        for each in _messages(stored, options):
            topic = each.topic
            if topic.name not in connections:
                connections[topic.name] = _connection(writer, topic)
            content = TYPESTORE.serialize_cdr(each.content, topic.msgtype)
            writer.write(connections[topic.name], nanoseconds(each.time), content)


def _connection(writer: Writer, topic: Topic) -> Connection:
    qos = [topic.qos()]
    return writer.add_connection(
        topic.name, topic.msgtype, typestore=TYPESTORE, offered_qos_profiles=qos
    )


def _about(stored: StoredRun) -> dict[str, str]:
    """What the bag's metadata says of the run; nothing of the wall clock."""
    run = stored.run
    about = {"scenario": run.scenario, "seed": str(run.seed), "outcome": stored.outcome}
    return about | {"digest": stored.digest, **run.versions}


def _messages(stored: StoredRun, options: BagOptions) -> Iterator[Message]:
    """Everything in order of time; what is latched comes before what moves."""
    run = stored.run
    indices = samples_at(run.signals.times, options.rate)
    streams = [
        iter([_description(run, options), static_tf(run)]),
        _clock(run, indices),
        _measured_states(run, indices),
        _commanded(run, indices),
        *(wrenches(run, each, indices) for each in run.robot.wrench_sensors.values()),
        moving_tf(run, indices),
        _in_order(planned(run)),
        scene_markers(stored),
        cameras.captures(run),
        *(
            cameras.video_frames(stored, video, is_raw=options.has_raw_images)
            for video in stored.drawings.videos
        ),
        *tcp_paths(run),
        event_messages(stored),
    ]
    return heapq.merge(*streams, key=attrgetter("time"))


def _in_order(messages: Iterator[Message]) -> Iterator[Message]:
    return iter(sorted(messages, key=attrgetter("time")))


def _description(run: Run, options: BagOptions) -> Message:
    content = message("std_msgs/msg/String", data=urdf_of(run, options.meshes))
    return Message(float(run.signals.times[0]), ROBOT_DESCRIPTION, content)


def _text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="")


def _clock(run: Run, indices: IntArray) -> Iterator[Message]:
    """Simulation time, for nodes with `use_sim_time`."""
    for time in run.signals.times[indices].tolist():
        yield Message(time, CLOCK, message("rosgraph_msgs/msg/Clock", clock=stamp(time)))


def _measured_states(run: Run, indices: IntArray) -> Iterator[Message]:
    """Positions, velocities and efforts of every movable joint."""
    signals = run.signals
    names = run.robot.joint_names
    for index in indices:
        time = float(signals.times[index])
        yield Message(
            time,
            JOINT_STATES,
            joint_state(
                time,
                names,
                signals.joint_positions[index],
                velocity=signals.joint_velocities[index],
                effort=signals.joint_efforts[index],
            ),
        )


def _commanded(run: Run, indices: IntArray) -> Iterator[Message]:
    """Positions and velocities of every joint that had a command."""
    signals = run.signals
    names = np.array(run.robot.joint_names)
    for index in indices:
        time, positions = float(signals.times[index]), signals.joint_commands[index]
        given = ~np.isnan(positions)
        if given.any():
            velocities = signals.joint_command_velocities[index][given]
            state = joint_state(time, names[given].tolist(), positions[given], velocity=velocities)
            yield Message(time, JOINT_COMMANDS, state)
