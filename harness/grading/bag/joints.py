"""Joints of a recording in the robot's order, at the times of the arm's messages."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.pose_arrays import relative, rotation_vector
from harness.core.types import FloatArray
from harness.grading.bag.clocks import Timeline
from harness.grading.bag.content import BagContent, RecordedTrack, Tracks, joined_tracks
from harness.grading.bag.sampling import gap_limit, rows_at, with_gaps_filled
from harness.recording.robot_record import LinkPlacement
from harness.robot.description import RobotDescription


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


def sample_times(reference: RecordedTrack, content: BagContent, timeline: Timeline) -> FloatArray:
    """Times of the run's samples [s], rising, from 0; in gaps too, where the joints are NaN.

    A gap lasts to the end of the recording where the joints fall silent before other topics do.
    """
    times, is_judged = timeline.rows(reference)
    found = np.unique(times[is_judged])
    if len(found) < 2:
        return found
    others = [*content.joints.values(), *content.edges.values(), *content.objects.values()]
    last = max(float(timeline.rows(track)[0].max()) for track in others)
    whole = with_gaps_filled(np.append(found, last) if last > found[-1] else found)
    is_silent = last - found[-1] > gap_limit(found)
    return whole if is_silent else whole[whole <= found[-1]]


def joint_rows(
    tracks: Tracks, description: RobotDescription, timeline: Timeline, times: FloatArray, name: str
) -> JointRows:
    """All joints from the messages of all publishers.

    The position of a mimic joint that no message names follows from the joint that it mimics.
    """
    joints = description.movable_joints
    values = np.full((3, len(times), len(joints)), np.nan)
    for column, joint in enumerate(joints):
        seconds, rows = rows_of_joint(joint.name, tracks, timeline, name)
        for kind in range(3):
            known = ~np.isnan(rows[:, kind])
            if known.any():
                found = rows_at(seconds[known], rows[known, kind : kind + 1], times)
                values[kind, :, column] = found[:, 0]
    index = description.joint_index
    for column, joint in enumerate(joints):
        if joint.mimic is not None and np.isnan(values[0, :, column]).all():
            followed = values[:, :, index[joint.mimic.joint]]
            values[0, :, column] = joint.mimic.multiplier * followed[0] + joint.mimic.offset
            values[1, :, column] = joint.mimic.multiplier * followed[1]
    return JointRows(*values)


def rows_of_joint(
    joint: str, tracks: Tracks, timeline: Timeline, name: str
) -> tuple[FloatArray, FloatArray]:
    """Times and (position, velocity, effort) of a joint in all messages that name it."""
    times: list[FloatArray] = []
    rows: list[FloatArray] = []
    for names, track in tracks.items():
        if joint in names:
            place, count = names.index(joint), len(names)
            seconds, is_judged = timeline.rows(track, name)
            times.append(seconds[is_judged])
            rows.append(track.rows()[is_judged][:, [place, count + place, 2 * count + place]])
    if not times:
        return np.zeros(0), np.zeros((0, 3))
    return np.concatenate(times), np.concatenate(rows)


def joints_of_frames(
    content: BagContent,
    placements: Mapping[str, LinkPlacement],
    description: RobotDescription,
    timeline: Timeline,
    times: FloatArray,
) -> JointRows:
    """Joint positions from the transforms of the links, for recordings without joint states."""
    positions = np.full((len(times), len(description.movable_joints)), np.nan)
    for column, joint in enumerate(description.movable_joints):
        track = content.edges.get((joint.parent, joint.child))
        if track is None:
            continue
        placement = placements[joint.child]
        moved = relative(np.array([placement.pose]), track.rows())
        axis = np.array(placement.axis)
        values = (moved[:, :3] if placement.slides else rotation_vector(moved[:, 3:])) @ axis
        seconds, is_judged = timeline.rows(track, "/tf")
        if is_judged.any():
            order = np.argsort(seconds[is_judged], kind="stable")
            turned = values[is_judged][order]
            turned = turned if placement.slides else np.unwrap(turned)
            positions[:, column] = rows_at(seconds[is_judged][order], turned[:, None], times)[:, 0]
    unknown = np.full_like(positions, np.nan)
    return JointRows(positions, unknown, unknown.copy())


def foreign_links(content: BagContent, placements: Mapping[str, LinkPlacement]) -> list[str]:
    """Differences between the recording's transforms and this robot's link placements.

    The position of a link in its parent does not change while its revolute joint turns.
    """
    differences: list[str] = []
    for edges in (content.edges, content.static_edges):
        for (parent, child), track in sorted(edges.items()):
            placement = placements.get(child)
            if placement is None or placement.parent != parent or placement.slides:
                continue
            place, recorded = np.array(placement.pose[:3]), track.rows()[0, :3]
            apart = float(np.linalg.norm(recorded - place))
            if apart > 0.005:
                differences.append(
                    f"the recording has {child} {1000 * apart:.0f} mm away from its place on"
                    f" {parent} of this robot: is it the same robot, on the same base?"
                )
    return differences
