"""The joints of a recording, in the robot's order, at the times of a run."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.pose_arrays import relative, rotation_vector
from harness.core.types import FloatArray
from harness.plugins.grading.bag.clocks import Timeline
from harness.plugins.grading.bag.content import BagContent, RecordedTrack, Tracks, joined_tracks
from harness.plugins.grading.bag.sampling import Trace, first_of_each
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint

SLACK = {"revolute": 0.02, "continuous": 0.02, "prismatic": 0.002}
"""What noise and rounding may add to a position [rad or m]; a joint that moves by less stands
still."""
APART = {"revolute": 0.1, "continuous": 0.1, "prismatic": 0.01}
"""Difference between a joint and its frame in /tf that no delay of a message explains [rad or m]:
20 ms at 5 rad/s or 0.5 m/s."""
STRETCH_OF_ZEROS = 2.0
"""A joint that moves by half of `APART` within this time has a velocity [s]: 0.025 rad/s is the
smallest one that the motors of small arms report."""


@dataclass(frozen=True, eq=False)
class JointMessages:
    """What was recorded of a joint, by rising time; NaN where a message says nothing.

    Attributes:
        times: Times of the messages [s], shape (N,), N > 0.
        values: Positions, velocities and efforts, shape (N, 3).
    """

    joint: Joint
    times: FloatArray
    values: FloatArray

    @property
    def steps(self) -> FloatArray:
        """Change of the position since the message before, shape (N - 1,)."""
        return self._wrapped(np.diff(self.values[:, 0]))

    def moved_within(self, span: float, steps: FloatArray) -> FloatArray:
        """Sum of some steps over the last `span` seconds at each message, shape (N,)."""
        sums = np.concatenate([[0.0], np.cumsum(steps)])
        return sums - sums[np.searchsorted(self.times, self.times - span)]

    def has_false_zeros(self) -> bool:
        """Whether every velocity is 0 although the joint moves: the driver does not measure it."""
        velocities = self.values[:, 1]
        if np.isnan(velocities).all() or np.nan_to_num(velocities).any():
            return False
        moved = self.moved_within(STRETCH_OF_ZEROS, np.nan_to_num(self.steps))
        return bool((np.abs(moved) > APART[self.joint.kind] / 2).any())

    def traces(self) -> tuple[Trace | None, ...]:
        """Positions, velocities and efforts over time; None of what was not recorded."""
        slack, found = SLACK[self.joint.kind], list[Trace | None]()
        for kind in range(3):
            known = ~np.isnan(self.values[:, kind])
            if not known.any() or (kind == 1 and self.has_false_zeros()):
                found.append(None)
                continue
            times, rows = first_of_each(self.times[known], self.values[known, kind : kind + 1])
            steps, is_moving = np.diff(rows, axis=0), np.zeros(len(rows) - 1, dtype=bool)
            if kind == 0:
                steps = self._wrapped(steps)
                is_moving = np.abs(steps[:, 0]) > slack
            found.append(Trace.of(times, rows, steps, is_moving))
        return tuple(found)

    def _wrapped(self, steps: FloatArray) -> FloatArray:
        """Steps of a joint that turns without end, along the shorter way."""
        return (steps + np.pi) % (2 * np.pi) - np.pi if self.joint.kind == "continuous" else steps


JointTraces = Mapping[str, tuple[Trace | None, ...]]  # `JointMessages.traces` by joint names


@dataclass(frozen=True, eq=False)
class JointRows:
    """Joints at each sample, in description order, shape (N, n); NaN where unknown."""

    positions: FloatArray
    velocities: FloatArray
    efforts: FloatArray


def reference_track(
    content: BagContent, description: RobotDescription, arm_joints: Collection[str]
) -> RecordedTrack | None:
    """The messages that define the run's samples: all with most of the arm's joints, in any order.

    Without joint states, they are the transforms of a link that one of these joints moves.

    Args:
        arm_joints: Joints of the arm; all movable joints of a gripper without an arm.
    """
    arm = set(arm_joints)
    most = max((len(arm.intersection(names)) for names in content.joints), default=0)
    if most:
        best = [names for names in content.joints if len(arm.intersection(names)) == most]
        longest = max(best, key=lambda names: (len(content.joints[names].logged), names))
        same = arm.intersection(longest)
        return joined_tracks([content.joints[names] for names in best if same <= set(names)])
    for joint in description.joints:
        if joint.name in arm and (joint.parent, joint.child) in content.edges:
            return content.edges[joint.parent, joint.child]
    return None


def joint_messages(
    tracks: Tracks, description: RobotDescription, timeline: Timeline, name: str
) -> dict[str, JointMessages]:
    """The messages about each joint, of all publishers.

    Args:
        name: Name of the topic in notes.
    """
    judged: dict[tuple[str, ...], tuple[FloatArray, FloatArray]] = {}
    for names, track in tracks.items():
        seconds, is_judged = timeline.rows(track, name)
        judged[names] = seconds[is_judged], track.rows()[is_judged]
    found: dict[str, JointMessages] = {}
    for joint in description.movable_joints:
        times: list[FloatArray] = []
        values: list[FloatArray] = []
        for names, (seconds, rows) in judged.items():
            if joint.name in names and len(seconds):
                place, count = names.index(joint.name), len(names)
                times.append(seconds)
                values.append(rows[:, [place, count + place, 2 * count + place]])
        if times:
            found[joint.name] = _in_order(joint, np.concatenate(times), np.concatenate(values))
    return found


def traces_of(messages: Mapping[str, JointMessages]) -> JointTraces:
    """The traces of all joints."""
    return {name: each.traces() for name, each in messages.items()}


def messages_of_frames(
    content: BagContent,
    description: RobotDescription,
    timeline: Timeline,
) -> dict[str, JointMessages]:
    """Positions of the joints from the transforms of their links in /tf."""
    found: dict[str, JointMessages] = {}
    for joint in description.movable_joints:
        track = content.edges.get((joint.parent, joint.child))
        if track is None:
            continue
        seconds, is_judged = timeline.rows(track, "/tf")
        slides = joint.kind == "prismatic"
        moved = relative(joint.pose.as_vector()[None], track.rows()[is_judged])
        shift = moved[:, :3] if slides else rotation_vector(moved[:, 3:])
        values = np.full((len(moved), 3), np.nan)
        values[:, 0] = shift @ joint.axis
        if len(values):
            messages = _in_order(joint, seconds[is_judged], values)
            if not slides:
                messages.values[:, 0] = np.unwrap(messages.values[:, 0])
            found[joint.name] = messages
    return found


def _in_order(joint: Joint, times: FloatArray, values: FloatArray) -> JointMessages:
    order = np.argsort(times, kind="stable")
    return JointMessages(joint, times[order], values[order])


def joint_rows(traces: JointTraces, description: RobotDescription, times: FloatArray) -> JointRows:
    """All joints at some times [s].

    Where a position is not known, nothing is known of the joint. The position of a mimic joint that
    no message names follows from the joint that it mimics.
    """
    joints = description.movable_joints
    values = np.full((3, len(times), len(joints)), np.nan)
    for column, joint in enumerate(joints):
        for kind, trace in enumerate(traces.get(joint.name, ())):
            if trace is not None:
                values[kind, :, column] = trace.at(times)[:, 0]
            if kind and not np.isnan(values[0, :, column]).all():
                values[kind, np.isnan(values[0, :, column]), column] = np.nan
    index = description.joint_index
    for column, joint in enumerate(joints):
        if joint.mimic is not None and np.isnan(values[0, :, column]).all():
            followed = values[:, :, index[joint.mimic.joint]]
            values[0, :, column] = joint.mimic.multiplier * followed[0] + joint.mimic.offset
            values[1, :, column] = joint.mimic.multiplier * followed[1]
    return JointRows(*values)


def foreign_links(content: BagContent, description: RobotDescription) -> list[str]:
    """Differences between the recording's transforms and the links of this robot.

    The position of a link in its parent does not change while its revolute joint turns.
    """
    differences: list[str] = []
    placed = {joint.child: joint for joint in description.joints if joint.kind != "prismatic"}
    for edges in (content.edges, content.static_edges):
        for (parent, child), track in sorted(edges.items()):
            joint = placed.get(child)
            if joint is None or joint.parent != parent:
                continue
            apart = float(np.linalg.norm(track.rows()[0, :3] - joint.pose.translation))
            if apart > 0.005:
                differences.append(
                    f"the recording has {child} {1000 * apart:.0f} mm away from its place on"
                    f" {parent} of this robot: is it the same robot, on the same base?"
                )
    return differences
