"""What makes a recording doubtful: values that contradict each other, and what was assumed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.geometry import Shape, Sphere
from harness.core.pose_arrays import (
    angle_between,
    conjugate,
    quat_product,
    rotate,
    rotation_angle,
)
from harness.core.symmetry import ANY, equal_turns
from harness.core.types import BoolArray, FloatArray
from harness.plugins.grading.bag.clocks import Timeline
from harness.plugins.grading.bag.content import RecordedTrack, Tracks
from harness.plugins.grading.bag.joints import APART, SLACK, JointMessages, JointRows
from harness.plugins.grading.bag.sampling import gap_limit
from harness.robot.description import RobotDescription

DoubtKind = Literal["publishers", "tf", "frames", "steps", "velocities", "jumps", "once"]

FEWEST_JUMPS = 3  # there and back, of two publishers; one is a wrong message
FASTEST = 3.0  # a joint that moves faster than this multiple of its velocity limit jumps
UNKNOWN_LIMIT = 2 * np.pi  # [rad/s or m/s], where a description has none, or 0
SHORTEST_TIME = 0.02
"""Less time between two messages counts as this in the search for a single jump of a joint [s]: a
message that is up to 60 ms late is no jump at the velocity limit."""
FASTEST_OBJECT, OBJECT_SLACK = 5.0, 0.02
"""And an object above this speed [m/s], by more than this [m]."""
FASTEST_TURN, FASTEST_FLIP, TURN_SLACK = 25.0, 12.0, 0.35
"""And one that turns faster [rad/s], for a single jump and there and back, by more than this [rad]:
a cube of 4 cm that tips over lands with 12 rad/s, and a camera is off by 20 degrees at times."""
FROM_REST, TURN_FROM_REST = 20.0, 400.0
"""Acceleration of an object that rests at two messages and rests elsewhere at the next two
[m/s^2, rad/s^2]: twice that of a fall, and of a cube of 4 cm that tips over."""
FEWEST_APART = 0.02  # share of samples further apart than `APART` that is a contradiction
OBJECT_APART, OBJECT_TURNED_APART = 0.02, 0.2
"""Difference between two topics with the pose of an object [m, rad]: a joint's twice."""

STRETCH = 0.5  # motions are compared with the integral of the velocities over this time [s]
SHARE_OF_MOTION = 0.2  # by which filters and coarse sampling may falsify that integral


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


def joint_doubts(messages: Mapping[str, JointMessages]) -> Iterator[Doubt]:
    """Joints whose messages jump, there and back or once, or which are in degrees."""
    for name, recorded in messages.items():
        if _is_in_degrees(recorded):
            most = f"{name} reaches {np.nanmax(np.abs(recorded.values[:, 0])):.0f} rad"
            yield Doubt("jumps", f"{most}: these look like degrees, and JointState has radians")
            continue
        joint, spans = recorded.joint, np.diff(recorded.times)
        fastest = FASTEST * (joint.velocity if 0 < joint.velocity < np.inf else UNKNOWN_LIMIT)
        sizes, slack = np.abs(recorded.steps), SLACK[joint.kind]
        is_back = recorded.steps[1:] * recorded.steps[:-1] < 0
        both = _there_and_back(sizes > slack + fastest * spans, is_back)
        if both is not None:
            yield Doubt("publishers", f"{name} {_two_values(recorded.times[both])}")
            continue
        far = sizes > slack + fastest * np.maximum(spans, SHORTEST_TIME)
        if far.any():
            first = int(np.argmax(far))
            factor, unit = (1000, "mm") if joint.kind == "prismatic" else (180 / np.pi, "deg")
            when = f"by {factor * sizes[first]:.0f} {unit} at t={recorded.times[first + 1]:.3f} s"
            why = "a program put it there, or messages are missing"
            yield Doubt(
                "jumps", f"{name} jumps {when}, faster than {FASTEST:g} times its limit: {why}"
            )


def _is_in_degrees(recorded: JointMessages) -> bool:
    """Whether positions are more than a turn beyond the joint's limits, and as degrees are not."""
    joint, values = recorded.joint, recorded.values[~np.isnan(recorded.values[:, 0]), 0]

    def beyond(values: FloatArray) -> float:
        return np.maximum(joint.lower - values, values - joint.upper).max(initial=-np.inf)

    is_turn = joint.kind != "prismatic"
    return is_turn and beyond(values) > 2 * np.pi and beyond(np.radians(values)) <= 0


@dataclass(frozen=True, eq=False)
class _Moves:
    """Changes between messages of an object, shape (N - 1,): time [s], way [m] and turn [rad]."""

    times: FloatArray
    spans: FloatArray
    ways: FloatArray
    turns: FloatArray
    is_way_back: BoolArray
    is_turn_back: BoolArray

    @classmethod
    def of(cls, track: RecordedTrack, timeline: Timeline, shapes: tuple[Shape, ...]) -> _Moves:
        seconds, is_judged = timeline.rows(track)
        order = np.argsort(seconds[is_judged], kind="stable")
        times, poses = seconds[is_judged][order], track.rows()[is_judged][order]
        steps, quats = np.diff(poses[:, :3], axis=0), poses[:, 3:]
        turns = angles_between(quats[:-1], quats[1:], shapes)
        return cls(
            times,
            np.diff(times),
            np.linalg.norm(steps, axis=1),
            turns,
            np.sum(steps[1:] * steps[:-1], axis=1) < 0,
            angles_between(quats[:-2], quats[2:], shapes) < turns[1:],
        )


def angles_between(a: FloatArray, b: FloatArray, shapes: tuple[Shape, ...]) -> FloatArray:
    """Angles between orientations of an object, as far as they can be seen [rad], shape (N,)."""
    if shapes and all(isinstance(shape.geometry, Sphere) for shape in shapes):
        return np.zeros(len(a))
    if equal_turns(shapes, np.eye(3)) == ANY:
        axis = np.array([0.0, 0.0, 1.0])
        return angle_between(rotate(a, axis), rotate(b, axis))
    return rotation_angle(quat_product(conjugate(a), b))


def object_doubts(
    edges: Tracks,
    timeline: Timeline,
    objects: Mapping[str, tuple[Shape, ...]],
) -> Iterator[Doubt]:
    """Objects whose messages jump or flip there and back, or once, as exchanged ones do.

    Args:
        edges: Tracks of poses, by parent and child frame.
        objects: Shapes of the objects by name.
    """
    parents: dict[str, list[str]] = {}
    for (parent, child), track in sorted(edges.items()):
        if child not in objects:
            continue
        parents.setdefault(child, []).append(parent)
        moves = _Moves.of(track, timeline, objects[child])
        ways, turns, spans = moves.ways, moves.turns, moves.spans
        far = ways > OBJECT_SLACK + FASTEST_OBJECT * spans
        flipped = turns > TURN_SLACK + FASTEST_FLIP * spans
        both = _there_and_back(far, moves.is_way_back)
        both = both if both is not None else _there_and_back(flipped, moves.is_turn_back)
        if both is not None:
            yield Doubt("publishers", f"{child} {_two_values(moves.times[both])}", (child,))
            continue
        far |= _is_at_rest(ways) & (ways > OBJECT_SLACK + FROM_REST * spans**2 / 2)
        turned = turns > TURN_SLACK + FASTEST_TURN * spans
        turned |= _is_at_rest(turns) & (turns > TURN_SLACK + TURN_FROM_REST * spans**2 / 2)
        if (far | turned).any():
            first = int(np.argmax(far | turned))
            jump = f"{1000 * ways[first]:.0f} mm and {np.degrees(turns[first]):.0f} deg"
            yield Doubt(
                "jumps",
                f"{child} jumps by {jump} at t={moves.times[first + 1]:.3f} s: objects were"
                " exchanged, or a program put it there",
                (child,),
            )
    for child, several in sorted(parents.items()):
        if len(several) > 1:
            reason = f"{child} has poses in {' and in '.join(several)}: two programs say so"
            yield Doubt("publishers", reason, (child,))


def _two_values(time: float) -> str:
    return (
        f"jumps between two values from t={time:.3f} s on: two programs publish it, or its clock"
        " was set back"
    )


def _there_and_back(jumps: BoolArray, is_back: BoolArray) -> int | None:
    """The message of the first of several jumps there and back; None where there are too few.

    Args:
        jumps: Whether each step is a jump, shape (N - 1,).
        is_back: Whether each step but the first undoes the one before it, shape (N - 2,).
    """
    places = np.flatnonzero(jumps[1:] & jumps[:-1] & is_back)
    return int(places[0]) + 1 if len(places) >= FEWEST_JUMPS else None


def _is_at_rest(steps: FloatArray) -> BoolArray:
    """Whether a step is much larger than the one before it and the one after it."""
    around = np.concatenate([np.zeros(1), steps, np.zeros(1)])
    return np.maximum(around[:-2], around[2:]) < 0.1 * steps


def tf_doubts(
    description: RobotDescription, times: FloatArray, measured: JointRows, shown: JointRows
) -> Iterator[Doubt]:
    """Joints whose frames in /tf stand elsewhere than the joint states say."""
    for column, joint in enumerate(description.movable_joints):
        apart = shown.positions[:, column] - measured.positions[:, column]
        if joint.kind != "prismatic":
            apart = (apart + np.pi) % (2 * np.pi) - np.pi
        found = _contradiction(times, np.abs(apart) / APART[joint.kind])
        if found:
            reason = f"/tf and the joint states contradict each other about {joint.name} {found}"
            yield Doubt("tf", reason)


def source_doubts(
    name: str, shapes: tuple[Shape, ...], times: FloatArray, poses: FloatArray, others: FloatArray
) -> Iterator[Doubt]:
    """An object of which two topics have different poses at the samples, shape (N, 7) each."""
    apart = np.linalg.norm(poses[:, :3] - others[:, :3], axis=1) / OBJECT_APART
    turned = angles_between(poses[:, 3:], others[:, 3:], shapes) / OBJECT_TURNED_APART
    found = _contradiction(times, np.maximum(apart, turned))
    if found:
        yield Doubt("tf", f"two topics contradict each other about {name} {found}", (name,))


def _contradiction(times: FloatArray, shares: FloatArray) -> str:
    """Where two topics differ, as shares of what may be, at too many samples; NaN is unknown."""
    known, far = np.isfinite(shares), np.nan_to_num(shares) > 1
    if not far.any() or far.sum() <= FEWEST_APART * known.sum():
        return ""
    return f"at {int(far.sum())} samples, first at t={times[int(np.argmax(far))]:.3f} s"


def velocity_doubts(messages: Mapping[str, JointMessages]) -> Iterator[Doubt]:
    """Joints that move otherwise than their recorded velocities say, or in spite of zeros.

    So it is where the clock of a recording runs at another speed, where positions repeat while the
    arm moves, and where joints are exchanged during the recording.

    Args:
        messages: What was recorded of the arm's joints; fingers report velocities that mean little.
    """
    for name, recorded in messages.items():
        velocities, spans = recorded.values[:, 1], np.diff(recorded.times)
        if recorded.has_false_zeros():
            text = f"{name} moves, and its velocities are all 0: they count as not recorded"
            yield Doubt("velocities", text)
            continue
        steps = np.stack([recorded.steps, (velocities[1:] + velocities[:-1]) / 2 * spans])
        steps[:, ~np.isfinite(steps).all(axis=0) | (spans > gap_limit(recorded.times))] = 0.0
        moved, integral = (recorded.moved_within(STRETCH, each) for each in steps)
        allowed = SHARE_OF_MOTION * np.maximum(np.abs(moved), np.abs(integral))
        wrong = np.abs(moved - integral) > APART[recorded.joint.kind] / 2 + allowed
        if wrong.any():
            time = float(recorded.times[int(np.argmax(wrong))])
            text = f"{name} moves otherwise than its velocities say, first at t={time:.3f} s"
            yield Doubt("velocities", text)
