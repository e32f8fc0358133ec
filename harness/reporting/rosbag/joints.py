"""Joints as they were measured and commanded, and the clock."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from harness.core.types import IntArray
from harness.recording.run import Run
from harness.reporting.rosbag.messages import joint_state, message, stamp
from harness.reporting.rosbag.samples import Message
from harness.reporting.rosbag.topics import CLOCK, JOINT_COMMANDS, JOINT_STATES


def clock(run: Run, indices: IntArray) -> Iterator[Message]:
    """Simulation time, for nodes with `use_sim_time`."""
    for time in run.signals.times[indices].tolist():
        yield Message(time, CLOCK, message("rosgraph_msgs/msg/Clock", clock=stamp(time)))


def measured_states(run: Run, indices: IntArray) -> Iterator[Message]:
    """Positions, velocities and efforts of every movable joint."""
    signals = run.signals
    names = [joint.name for joint in run.robot.joints]
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


def commanded(run: Run, indices: IntArray) -> Iterator[Message]:
    """Positions and velocities of every joint that had a command."""
    signals = run.signals
    names = np.array([joint.name for joint in run.robot.joints])
    for index in indices:
        time, positions = float(signals.times[index]), signals.joint_commands[index]
        given = ~np.isnan(positions)
        if given.any():
            velocities = signals.joint_command_velocities[index][given]
            state = joint_state(time, names[given].tolist(), positions[given], velocity=velocities)
            yield Message(time, JOINT_COMMANDS, state)
