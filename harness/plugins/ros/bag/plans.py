"""What was planned, for RViz's trajectory displays, and the path that the TCP took."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.plugins.ros.bag.frames import WORLD
from harness.plugins.ros.bag.messages import (
    header,
    joint_state,
    message,
    pose_message,
    trajectory_message,
)
from harness.plugins.ros.bag.samples import Message, samples_at
from harness.plugins.ros.bag.topics import (
    DISPLAY_PLANNED_PATH,
    PLANNED_TRAJECTORY,
    TCP_PATH,
    Topic,
)
from harness.recording.link_poses import tcp_tracks
from harness.recording.run import Run
from harness.recording.step_record import StepRecord

PATH_RATE = 5.0
"""How often the course's trajectory server looks where the TCP is, as its UR launch sets it [Hz]
(MOGI-ROS/mogi_trajectory_server, Apache-2.0; so too the next number)."""
PATH_SPACING = 0.02  # how far a pose must be from the last one kept [m]
LONGEST_PUBLISHED = 300  # poses of a path that is published at every look; a longer one less often


def planned(run: Run) -> Iterator[Message]:
    """Each motion's trajectory when it begins, as such and as MoveIt shows it."""
    for step in run.steps:
        if step.trajectory is not None and step.status != "not reached":
            trajectory = trajectory_message(step.trajectory, header=header(step.start_time))
            yield Message(step.start_time, PLANNED_TRAJECTORY, trajectory)
            yield Message(step.start_time, DISPLAY_PLANNED_PATH, _display(run, step, trajectory))


def tcp_paths(run: Run) -> list[Iterator[Message]]:
    """The path of each arm's TCP, in order of time each."""
    tracks = tcp_tracks(run)
    return [_tcp_path(run, tracks[arm], topic) for arm, topic in tcp_path_topics(run).items()]


def tcp_path_topics(run: Run) -> dict[str, Topic]:
    """`/tcp_path` of one arm, under ``; of several arms `/ARM/tcp_path`, by their names."""
    return {
        arm: replace(TCP_PATH, name=f"/{arm}{TCP_PATH.name}") if arm else TCP_PATH
        for arm in tcp_tracks(run)
    }


def _tcp_path(run: Run, poses: FloatArray, topic: Topic) -> Iterator[Message]:
    """The path so far, again and again, as the course's trajectory server publishes it.

    A pose is kept when it is `PATH_SPACING` or more from the last one kept; the path's frame is the
    world.
    """
    kept: list[Any] = []
    last: FloatArray | None = None
    published = 0
    indices = samples_at(run.signals.times, PATH_RATE)
    for number, index in enumerate(indices):
        time, pose = float(run.signals.times[index]), poses[index]
        if np.isnan(pose).any():
            continue
        if last is None or np.linalg.norm(pose[:3] - last[:3]) >= PATH_SPACING:
            last = pose
            content = pose_message(pose.tolist())
            head = header(time, WORLD)
            kept.append(message("geometry_msgs/msg/PoseStamped", header=head, pose=content))
        waits = 1 + len(kept) // LONGEST_PUBLISHED
        if number - published >= waits or number in (0, len(indices) - 1):
            published = number
            path = message(topic.msgtype, header=header(time, WORLD), poses=list(kept))
            yield Message(time, topic, path)


def _display(run: Run, step: StepRecord, trajectory: Any) -> Any:
    """The motion for RViz, from the joint positions at its beginning."""
    time = step.start_time
    index = min(step.start_index, len(run.signals.times) - 1)
    names = run.robot.joint_names
    many, state = (
        "trajectory_msgs/msg/MultiDOFJointTrajectory",
        "sensor_msgs/msg/MultiDOFJointState",
    )
    shown = message(
        "moveit_msgs/msg/RobotTrajectory",
        joint_trajectory=trajectory,
        multi_dof_joint_trajectory=message(many, header=header(time)),
    )
    start = message(
        "moveit_msgs/msg/RobotState",
        joint_state=joint_state(time, names, run.signals.joint_positions[index]),
        multi_dof_joint_state=message(state, header=header(time)),
    )
    return message(
        DISPLAY_PLANNED_PATH.msgtype,
        model_id=run.robot.name,
        trajectory=[shown],
        trajectory_start=start,
    )
