"""Where an object stands and how it moves: placed, on, displaced, upright, static."""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import TOUCH_FORCE, in_hand
from harness.assertions.grasp import robot_contact
from harness.assertions.poses import (
    frame_poses,
    object_poses,
    physical_poses,
    present,
    speeds,
    start_poses,
)
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.support import supports
from harness.assertions.temporal import trailing_max
from harness.assertions.text import amount, amounts
from harness.assertions.window import Window, object_record
from harness.core.pose_arrays import (
    angle_between,
    compose,
    conjugate,
    quat_product,
    rotate,
    rotation_vector,
)
from harness.core.spatial import rotation_from_quat_wxyz
from harness.core.symmetry import ANY, equal_turns
from harness.core.types import BoolArray, FloatArray
from harness.recording.run import Measure, Run
from harness.spec.checks import Displaced, On, Placed, Static, Upright

STILL = 0.05
"""What moves at no time during so long is still; a turning point of a swing is not [s]."""
PLACE_POSITION = 0.01
"""Tolerance of `placed` with a pose and no tolerance [m]."""
PLACE_TILT = 0.1
"""And how far it may lean from the given pose, turns about the vertical free [rad]."""
UP = np.array([0.0, 0.0, 1.0])


@signal.handles(Placed)
def placed(check: Placed, window: Window) -> MarginSignal:
    """Rests on a support from below, untouched by the robot, still, and at the pose if given.

    What is in the hand is no support but for a `placed` that names it.
    """
    run, name = window.run, check.object
    carried = {
        body: force if check.on is not None else np.where(_is_carried(run, body), 0.0, force)
        for body, force in supports(run, name).items()
        if check.on in (None, body)
    }
    support = np.max([np.zeros(len(run.signals.times)), *carried.values()], axis=0)
    force, hold = robot_contact(run, name)
    speed, turning = (
        _calm(window, window.cut(rate)) for rate in speeds(run, object_poses(run, name))
    )
    what = f"support by {check.on or 'anything but the robot'}"
    parts = [
        *_at_pose(check, window),
        Part("speed", speed, check.max_velocity, "<=", "m/s"),
        Part("turning speed", turning, check.max_angular_velocity, "<=", "rad/s"),
        Part(what, window.cut(support), TOUCH_FORCE, ">=", "N"),
        Part("contact with the robot", window.cut(force), TOUCH_FORCE, "<=", "N"),
        Part("attached in the planning scene", window.cut(hold), 0.0, "==", "1"),
    ]

    def text(index: int, tightest: Measure) -> str:
        sample = window.start + index
        bodies = [body for body, force in carried.items() if force[sample] > TOUCH_FORCE]
        stands = f"{name} rests on {' and '.join(bodies)}" if bodies else f"{name} rests on nothing"
        if check.on is not None and not bodies:
            stands = f"{name} does not rest on {check.on}"
        return f"{stands}; {_against(tightest)}"

    return all_of(window, parts, text, present=window.cut(present(run, name)))


def _is_carried(run: Run, body: str) -> BoolArray:
    """Samples at which the robot holds a body, shape (N,)."""
    if all(record.name != body for record in run.objects):
        return np.zeros(len(run.signals.times), dtype=bool)
    return in_hand(run, body)


def _at_pose(check: Placed, window: Window) -> list[Part]:
    if check.pose is None:
        return []
    run = window.run
    target = compose(frame_poses(run, check.pose.frame), check.pose.se3().as_vector())
    actual = object_poses(run, check.object)
    distance = window.cut(np.linalg.norm(actual[:, :3] - target[:, :3], axis=1))
    points = (window.cut(target[:, :3]), window.cut(actual[:, :3]))
    up_in_target = rotate(conjugate(target[:, 3:]), UP)
    up_in_actual = rotate(conjugate(actual[:, 3:]), UP)
    lean = window.cut(angle_between(up_in_target, up_in_actual))
    if check.tolerance is None:
        return [
            Part("position error", distance, PLACE_POSITION, "<=", "m", points=points),
            Part("lean", lean, PLACE_TILT, "<=", "rad"),
        ]
    turns = 1
    if not check.pose.has_rotation:
        stated = rotation_from_quat_wxyz(target[window.stop - 1, 3:])
        turns = equal_turns(object_record(run, check.object).shapes, stated)
    turn = lean if turns == ANY else window.cut(_turned(target[:, 3:], actual[:, 3:], turns))
    return [
        Part("position error", distance, check.tolerance.position, "<=", "m", points=points),
        Part("orientation error", turn, check.tolerance.orientation, "<=", "rad"),
    ]


def _turned(target: FloatArray, actual: FloatArray, turns: int) -> FloatArray:
    """Largest turn about an axis of the target [rad], shape (N,), `turns` about the vertical alike.

    Args:
        target: Quaternions, shape (N, 4).
        actual: Quaternions, shape (N, 4).
        turns: After so many equal turns about the vertical the object has gone round once.
    """
    angles = np.pi * np.arange(turns) / turns  # half of them: of quaternions
    alike = [np.array([np.cos(angle), 0, 0, np.sin(angle)]) for angle in angles]
    off = [quat_product(conjugate(target), quat_product(turn, actual)) for turn in alike]
    return np.min([np.abs(rotation_vector(each)).max(axis=1) for each in off], axis=0)


@signal.handles(On)
def on(check: On, window: Window) -> MarginSignal:
    """Touches the support, which is under it and carries half of its weight or more."""
    run, name = window.run, check.object
    force = supports(run, name).get(check.support, np.zeros(len(run.signals.times)))
    mass = object_record(run, name).mass
    weight = mass * float(np.linalg.norm(run.gravity))
    limit = TOUCH_FORCE if np.isnan(weight) else max(0.5 * weight, TOUCH_FORCE)
    part = Part("support from below", window.cut(force), limit, ">=", "N", detail=check.support)

    def text(_: int, measure: Measure) -> str:
        force, required = amounts(measure.value, limit, "N")
        return f"{check.support} carries {name} with {force} of {required}"

    return all_of(window, [part], text, present=window.cut(present(run, name)))


@signal.handles(Displaced)
def displaced(check: Displaced, window: Window) -> MarginSignal:
    """Distance from where it started [m]."""
    run, name = window.run, check.object
    away = np.linalg.norm(physical_poses(run, name)[:, :3] - start_poses(run, name)[:, :3], axis=1)
    part = Part("distance from the start", window.cut(away), check.at_least, ">=", "m", detail=name)

    def text(_: int, measure: Measure) -> str:
        return f"{name} is {amount(measure.value, 'm')} from its start"

    return all_of(window, [part], text)


@signal.handles(Upright)
def upright(check: Upright, window: Window) -> MarginSignal:
    """Angle of the object's z axis to the vertical [rad]."""
    lean = angle_between(rotate(physical_poses(window.run, check.object)[:, 3:], UP), UP)
    part = Part("lean", window.cut(lean), check.tolerance, "<=", "rad", detail=check.object)

    def text(_: int, measure: Measure) -> str:
        return f"{check.object} leans by {amount(measure.value, 'rad')}"

    return all_of(window, [part], text)


@signal.handles(Static)
def static(check: Static, window: Window) -> MarginSignal:
    """Speeds of an object; by default of every dynamic object and of the robot's joints."""
    run = window.run
    parts: list[Part] = []
    names = [check.object] if check.object is not None else _dynamic(run)
    for name in names:
        here = None if check.object is not None else window.cut(present(run, name))
        linear, angular = (
            _calm(window, window.cut(speed)) for speed in speeds(run, physical_poses(run, name))
        )
        parts += [
            Part("speed", linear, check.max_velocity, "<=", "m/s", None, here, name),
            Part(
                "turning speed",
                angular,
                check.max_angular_velocity,
                "<=",
                "rad/s",
                None,
                here,
                name,
            ),
        ]
    if check.object is None:
        for column, joint in enumerate(run.robot.joints):
            speed = np.abs(window.cut(run.signals.joint_velocities)[:, column])
            slides = joint.kind == "prismatic"
            limit = check.max_velocity if slides else check.max_angular_velocity
            unit = "m/s" if slides else "rad/s"
            parts.append(
                Part("joint speed", _calm(window, speed), limit, "<=", unit, detail=joint.name)
            )

    def text(_: int, measure: Measure) -> str:
        return f"{measure.detail} moves with {amount(measure.value, measure.unit)}"

    return all_of(window, parts, text)


def _dynamic(run: Run) -> list[str]:
    return [record.name for record in run.objects if record.in_simulation and not record.is_static]


def _calm(window: Window, speed: FloatArray) -> FloatArray:
    """The largest speed of the last `STILL` seconds of the window; NaN where it is not known."""
    known = trailing_max(np.nan_to_num(speed, nan=0.0), window.times, STILL)
    return np.where(np.isnan(speed), np.nan, known)


def _against(measure: Measure) -> str:
    if measure.comparison == "==":
        return measure.name
    value, limit = amounts(measure.value, measure.limit, measure.unit)
    detail = f" of {measure.detail}" if measure.detail else ""
    return f"{measure.name}{detail} {value} against {limit}"
