"""The path of the TCP as it was commanded, and where on it the TCP is at each sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.pose_arrays import turn_between
from harness.core.types import FloatArray
from harness.judging.poses import link_poses
from harness.judging.temporal import first_within
from harness.judging.window import NotObservable, Window
from harness.recording.link_poses import replayed_link_poses

LATEST = 0.1
"""A TCP may follow its command by so much later without leaving the path [s].

So much of the path before the command is searched for the nearest point: ten times what a servo
lags, and short enough that a path that crosses or retraces itself is not mistaken for another pass.
"""

SPEED_SPAN = 0.01  # a speed is the way of this time before a sample [s]; a single step would rattle
SHORTEST = 1e-6  # points nearer than this are one [m]


@dataclass(frozen=True, eq=False)
class FollowedPath:
    """How the TCP follows its commanded path at each sample of a window, shape (n,) each.

    Attributes:
        deviation: Distance to the nearest point of the path that was commanded lately [m].
        places: The way that the TCP itself has gone along the path, as a share of its length.
        turn: Angle from the commanded orientation there to the TCP's [rad].
        speed_error: Difference of the TCP's speed from the one commanded there, at least 0 [m/s].
    """

    deviation: FloatArray
    places: FloatArray
    turn: FloatArray
    speed_error: FloatArray


def followed_path(window: Window) -> FollowedPath:
    """Compare the TCP with its commands over a window.

    Raises:
        NotObservable: The commands were not recorded, or their path has no length.
    """
    tcp = window.cut(link_poses(window.run, window.run.robot.tcp_link))
    commanded = _commanded_poses(window)
    steps = np.diff(commanded[:, :3], axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    if lengths.sum() < SHORTEST:
        raise NotObservable("the TCP was commanded to stand still")
    deviation, matched = _nearest(tcp[:, :3], commanded[:, :3], window.times)
    tangents = steps / np.where(lengths > 0, lengths, 1.0)[:, None]
    here = np.clip(np.ceil(matched[1:]).astype(np.int64) - 1, 0, len(steps) - 1)
    forwards = np.sum(np.diff(tcp[:, :3], axis=0) * tangents[here], axis=1)
    rows = np.arange(len(tcp))
    near = np.rint(matched).astype(np.int64)
    speed = np.interp(matched, rows, _speeds(commanded, window.times))
    return FollowedPath(
        deviation,
        np.concatenate([[0.0], np.cumsum(forwards)]) / lengths.sum(),
        turn_between(commanded[near, 3:], tcp[:, 3:]),
        np.abs(_speeds(tcp, window.times) - speed),
    )


def _commanded_poses(window: Window) -> FloatArray:
    """T_world_tcp with every joint at its command, shape (n, 7)."""
    run = window.run
    commands = window.cut(run.signals.joint_commands)
    if np.isnan(commands).all():
        raise NotObservable("commanded positions were not recorded")
    measured = window.cut(run.signals.joint_positions)
    positions = np.where(np.isnan(commands), measured, commands)
    tcp = run.robot.tcp_link
    poses = replayed_link_poses(run.robot, positions, [tcp]).get(tcp)
    if poses is None:
        raise NotObservable(f"how '{tcp}' moves with the joints was not recorded")
    return poses


def _nearest(
    points: FloatArray, path: FloatArray, times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The nearest point of a path's last `LATEST` seconds: distance [m], and row of the path."""
    rows = np.arange(len(points))
    first = first_within(times, LATEST)
    distance, matched = np.linalg.norm(points - path, axis=1), rows.astype(float)
    for back in range(1, int((rows - first).max(initial=0)) + 1):
        begin = rows - back
        there = np.flatnonzero(begin >= first)
        start, along = path[begin[there]], path[begin[there] + 1] - path[begin[there]]
        squared = np.maximum(np.sum(along**2, axis=1), SHORTEST**4)
        share = np.clip(np.sum((points[there] - start) * along, axis=1) / squared, 0.0, 1.0)
        away = np.linalg.norm(points[there] - start - share[:, None] * along, axis=1)
        nearer = away < distance[there]
        distance[there[nearer]] = away[nearer]
        matched[there[nearer]] = (begin[there] + share)[nearer]
    return distance, matched


def _speeds(poses: FloatArray, times: FloatArray) -> FloatArray:
    """Speed of the positions over the last `SPEED_SPAN` seconds [m/s], shape (n,)."""
    rows = np.arange(len(times))
    first = np.minimum(first_within(times, SPEED_SPAN), np.maximum(rows - 1, 0))
    way = np.linalg.norm(poses[:, :3] - poses[first, :3], axis=1)
    return way / np.where(rows > first, times - times[first], 1.0)
