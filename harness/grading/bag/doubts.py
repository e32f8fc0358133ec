"""What makes a recording doubtful: values that contradict each other, and what was assumed."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.types import FloatArray
from harness.grading.bag.clocks import Timeline
from harness.grading.bag.content import BagContent, RecordedTrack, Tracks
from harness.grading.bag.joints import JointRows, joints_of_frames, rows_of_joint
from harness.recording.robot_record import LinkPlacement
from harness.robot.description import RobotDescription

DoubtKind = Literal["publishers", "tf", "frames", "steps", "velocities", "jumps", "once"]

FEWEST_JUMPS = 3
"""Jumps there and back from which on a topic has two publishers; one is a wrong message."""
FASTEST = 3.0
"""A joint that moves faster than this multiple of its velocity limit jumps."""
FASTEST_OBJECT = 5.0
"""And an object above this speed [m/s]."""
SLACK = {"revolute": 0.02, "continuous": 0.02, "prismatic": 0.002}
"""What noise and rounding may add [rad or m]."""
OBJECT_SLACK = 0.02  # [m]
FROM_REST = 20.0
"""Acceleration of an object that rests at two messages and rests elsewhere at the next two
[m/s^2]: twice that of a fall."""
APART = {"revolute": 0.1, "continuous": 0.1, "prismatic": 0.01}
"""Difference between a joint and its frame in /tf that no delay of a message explains [rad or m]:
20 ms at 5 rad/s or 0.5 m/s."""
FEWEST_APART = 0.02
"""Share of the samples that differ by more, from which on the two contradict each other."""

STRETCH = 0.5
"""Motions are compared with the integral of the velocities over this time [s]."""
SHARE_OF_MOTION = 0.2
"""Share of a motion by which filters and coarse sampling may falsify that integral."""


@dataclass(frozen=True)
class Doubt:
    """Why points for what a recording shows are withheld, unless the grader allows it.

    Attributes:
        kind: The word that `--allow` takes.
        message: What was found, and where.
        names: Objects that it concerns; empty where it concerns everything, or steps.
    """

    kind: DoubtKind
    message: str
    names: tuple[str, ...] = ()


def publisher_doubts(
    content: BagContent, description: RobotDescription, timeline: Timeline, objects: set[str]
) -> Iterator[Doubt]:
    """Joints and objects whose messages jump there and back, as those of two publishers do."""
    for joint in description.movable_joints:
        seconds, rows = rows_of_joint(joint.name, content.joints, timeline, "")
        limit = joint.velocity if np.isfinite(joint.velocity) else 2 * np.pi
        first = _first_jump(seconds, rows[:, :1], FASTEST * limit, SLACK[joint.kind])
        if first is not None:
            yield Doubt("publishers", f"{joint.name} {_two_values(first)}")
    for edges in (content.edges, content.objects):
        for (_, child), track in sorted(edges.items()):
            first = _first_jump(*_places(track, timeline), FASTEST_OBJECT, OBJECT_SLACK)
            if child in objects and first is not None:
                yield Doubt("publishers", f"{child} {_two_values(first)}", (child,))
        yield from _doubts_about_parents(edges, objects)


def jump_doubts(content: BagContent, timeline: Timeline, objects: set[str]) -> Iterator[Doubt]:
    """Objects that are elsewhere from one message to the next, as exchanged ones are."""
    for edges in (content.edges, content.objects):
        for (_, child), track in sorted(edges.items()):
            if child not in objects:
                continue
            times, places = _places(track, timeline)
            steps, spans = np.linalg.norm(np.diff(places, axis=0), axis=1), np.diff(times)
            around = np.concatenate([np.zeros(1), steps, np.zeros(1)])
            at_rest = np.maximum(around[:-2], around[2:]) < 0.1 * steps
            far = steps > OBJECT_SLACK + FASTEST_OBJECT * spans
            far |= at_rest & (steps > OBJECT_SLACK + FROM_REST * spans**2 / 2)
            if far.any():
                first = int(np.argmax(far))
                said = (
                    f"{child} jumps by {1000 * steps[first]:.0f} mm at t={times[first + 1]:.3f} s"
                )
                yield Doubt(
                    "jumps", f"{said}: objects were exchanged, or a program put it there", (child,)
                )


def _two_values(time: float) -> str:
    return (
        f"jumps between two values from t={time:.3f} s on: two programs publish it, or its clock"
        " was set back"
    )


def _places(track: RecordedTrack, timeline: Timeline) -> tuple[FloatArray, FloatArray]:
    """Times of the messages in their order [s], shape (N,), and places [m], shape (N, 3)."""
    seconds, is_judged = timeline.rows(track)
    order = np.argsort(seconds[is_judged], kind="stable")
    return seconds[is_judged][order], track.rows()[is_judged, :3][order]


def _first_jump(
    times: FloatArray, values: FloatArray, fastest: float, slack: float
) -> float | None:
    """Time of the first of several jumps there and back; None where there are too few [s].

    Args:
        times: The times of the messages [s], shape (N,), in any order.
        values: The values of the messages, shape (N, k).
        fastest: Speed that is no jump.
        slack: Distance that is no jump at any speed.
    """
    order = np.argsort(times, kind="stable")
    times, steps = times[order], np.diff(values[order], axis=0)
    jumps = np.linalg.norm(steps, axis=1) > slack + fastest * np.diff(times)
    back = np.sum(steps[1:] * steps[:-1], axis=1) < 0
    places = np.flatnonzero(jumps[1:] & jumps[:-1] & back)
    return float(times[places[0] + 1]) if len(places) >= FEWEST_JUMPS else None


def _doubts_about_parents(edges: Tracks, objects: set[str]) -> Iterator[Doubt]:
    parents: dict[str, list[str]] = {}
    for parent, child in edges:
        parents.setdefault(child, []).append(parent)
    for child, several in sorted(parents.items()):
        if child in objects and len(several) > 1:
            said = f"{child} has poses in {' and in '.join(sorted(several))}: two programs say so"
            yield Doubt("publishers", said, (child,))


def tf_doubts(
    content: BagContent,
    placements: Mapping[str, LinkPlacement],
    description: RobotDescription,
    timeline: Timeline,
    times: FloatArray,
    measured: JointRows,
) -> Iterator[Doubt]:
    """Joints whose frames in /tf stand elsewhere than the joint states say."""
    shown = joints_of_frames(content, placements, description, timeline, times).positions
    for column, joint in enumerate(description.movable_joints):
        apart = shown[:, column] - measured.positions[:, column]
        if joint.kind != "prismatic":
            apart = (apart + np.pi) % (2 * np.pi) - np.pi
        known = np.isfinite(apart)
        far = known & (np.abs(apart) > APART[joint.kind])
        if far.any() and far.sum() > FEWEST_APART * known.sum():
            time = float(times[int(np.argmax(far))])
            said = f"/tf and the joint states contradict each other about {joint.name}"
            yield Doubt("tf", f"{said} at {int(far.sum())} samples, first at t={time:.3f} s")


def velocity_doubts(
    description: RobotDescription, arm_joints: Collection[str], times: FloatArray, rows: JointRows
) -> Iterator[Doubt]:
    """Joints of the arm that move otherwise than their recorded velocities say.

    So it is where the clock of a recording runs at another speed, where positions repeat while the
    arm moves, and where joints are exchanged during the recording.

    Args:
        arm_joints: Names of the arm's joints; fingers report velocities that mean little.
        times: Times of the samples [s], shape (N,).
        rows: The measured joints at these times.
    """
    for column, joint in enumerate(description.movable_joints):
        positions, velocities = rows.positions[:, column], rows.velocities[:, column]
        if joint.name not in arm_joints or not np.nan_to_num(velocities).any():
            continue
        means = (velocities[1:] + velocities[:-1]) / 2
        turns = np.diff(positions)
        if joint.kind == "continuous":
            turns = (turns + np.pi) % (2 * np.pi) - np.pi
        steps = np.stack([turns, means * np.diff(times)])
        steps[:, ~np.isfinite(steps).all(axis=0)] = 0.0
        sums = np.concatenate([np.zeros((2, 1)), np.cumsum(steps, axis=1)], axis=1)
        moved, integral = sums - sums[:, np.searchsorted(times, times - STRETCH)]
        allowed = SHARE_OF_MOTION * np.maximum(np.abs(moved), np.abs(integral))
        wrong = np.abs(moved - integral) > APART[joint.kind] / 2 + allowed
        if wrong.any():
            time = float(times[int(np.argmax(wrong))])
            said = f"{joint.name} moves otherwise than its velocities say, first at t={time:.3f} s"
            yield Doubt("velocities", said)
