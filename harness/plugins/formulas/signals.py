"""The recorded signals that a formula may name, and its arithmetic, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.pose_arrays import angle_between, rotate
from harness.core.types import FloatArray
from harness.judging.body_motion import rates
from harness.judging.contacts import (
    FORCE_WINDOW,
    bodies,
    could_touch,
    force_between,
    pairs_of,
)
from harness.judging.distances import recorded_distances
from harness.judging.hold import averaged_force
from harness.judging.joints import joint_column
from harness.judging.poses import UP, frame_poses, frame_present, physical_poses
from harness.judging.window import NotObservable, Window
from harness.judging.wrenches import averaged_wrench
from harness.plugins.formulas.language.formula import Arithmetic, Const, Number, Signal
from harness.robot.mechanism import Joint


@dataclass(frozen=True, eq=False)
class Values:
    """A number at each sample, shape (n,); `unit` is empty where it has none or is not known."""

    values: FloatArray
    unit: str


def values_of(
    node: Number, window: Window, *, are_far: bool = False, force_window: float = FORCE_WINDOW
) -> Values:
    """A number of a formula at each sample of a window; NaN where it is not known.

    Args:
        node: The number of a formula, with its operands.
        window: The samples that it is calculated at.
        are_far: Whether distances at the cutoff of the recording, which are at least as much, are
            taken for infinite.
        force_window: Time over which forces are averaged [s].

    Raises:
        NotObservable: The run did not record it.
    """
    match node:
        case Const(value=value, unit=unit):
            return Values(np.full(len(window.times), value), unit)
        case Signal():
            found = _recorded(node, window, force_window)
            values = np.where(np.isfinite(found.values), found.values, np.nan)
            if are_far and node.name == "distance":
                values[values >= window.run.signals.clearance_cutoff] = np.inf
            return Values(values, found.unit)
        case Arithmetic(operator=operator, operands=operands):
            numbers = [
                values_of(each, window, are_far=are_far, force_window=force_window)
                for each in operands
            ]
            return _calculated(operator, numbers)


OPERATIONS: dict[str, np.ufunc] = {
    "neg": np.negative,
    "abs": np.abs,
    "min": np.minimum,
    "max": np.maximum,
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
}


def _calculated(operator: str, operands: list[Values]) -> Values:
    units = [operand.unit for operand in operands]
    unit = next((each for each in units if each), "")
    if (operator == "*" and all(units)) or (operator == "/" and units[1]):
        unit = ""
    with np.errstate(divide="ignore", invalid="ignore"):
        values = OPERATIONS[operator](*(operand.values for operand in operands))
    if operator == "/":
        values = np.where(operands[1].values == 0, np.nan, values)
    return Values(values, unit)


def _recorded(node: Signal, window: Window, force_window: float) -> Values:
    match node.name, node.arguments:
        case "time", _:
            return Values(window.times - window.times[0], "s")
        case "x" | "y" | "z" as axis, (name,):
            column = "xyz".index(axis)
            return Values(window.cut(_poses(window, name))[:, column], "m")
        case "tilt", (name,):
            poses = window.cut(_poses(window, name))
            return Values(angle_between(rotate(poses[:, 3:], UP), UP), "rad")
        case "speed", (name,):
            run = window.run
            speed = rates(run, name, _poses(window, name), frame_present(run, name), _shift)
            return Values(window.cut(speed), "m/s")
        case "force", (first, second):
            run = window.run
            firsts, seconds = bodies(run, first), bodies(run, second)
            together = could_touch(run, pairs_of(firsts, seconds))
            force = averaged_force(run, force_between(run, firsts, seconds), force_window)
            return Values(window.cut(np.where(together, force, np.nan)), "N")
        case "distance", (first, second):
            rows = recorded_distances(window.run, first, second)
            stack = np.stack([window.cut(values) for values in rows.values()])
            return Values(np.where(np.isnan(stack), np.inf, stack).min(axis=0), "m")
        case "force_x" | "force_y" | "force_z" as name, (sensor,):
            return _reading(window, sensor, "xyz".index(name[-1]), "N", force_window)
        case "torque_x" | "torque_y" | "torque_z" as name, (sensor,):
            return _reading(window, sensor, 3 + "xyz".index(name[-1]), "N m", force_window)
        case "surface_velocity", (belt,):
            return Values(_surface(window, belt)[:, 0], "m/s")
        case "surface_rotation", (belt,):
            return Values(_surface(window, belt)[:, 3], "rad/s")
        case name, (joint,):
            return _joint(name, joint, window)
        case _:
            raise NotObservable(f"there is no signal '{node}'")


def _shift(before: FloatArray, after: FloatArray) -> FloatArray:
    """How far the origin of a frame moved [m], shape (N,)."""
    return np.linalg.norm(after[:, :3] - before[:, :3], axis=1)


def _poses(window: Window, name: str) -> FloatArray:
    run = window.run
    if name == "tcp":
        return run.signals.tcp_pose
    if any(record.name == name for record in run.objects):
        return physical_poses(run, name)
    return frame_poses(run, name)


def _reading(window: Window, sensor: str, column: int, unit: str, force_window: float) -> Values:
    return Values(window.cut(averaged_wrench(window.run, sensor, force_window)[:, column]), unit)


def _surface(window: Window, belt: str) -> FloatArray:
    """The velocity of a belt's surface, (n, 4) as in `Signals.surfaces`."""
    if belt not in window.run.signals.surfaces:
        raise NotObservable(f"the surface of '{belt}' was not recorded")
    return window.cut(window.run.signals.surfaces[belt])


def _joint(name: str, joint: str, window: Window) -> Values:
    column, record = joint_column(window.run, joint)
    field, unit = {
        "position": ("joint_positions", record.position_unit),
        "velocity": ("joint_velocities", f"{record.position_unit}/s"),
        "effort": ("joint_efforts", _effort_unit(record)),
        "command": ("joint_commands", record.position_unit),
    }[name]
    recorded = getattr(window.run.signals, field)  # only this one need have been recorded
    return Values(window.cut(recorded)[:, column], unit)


def _effort_unit(joint: Joint) -> str:
    return "N" if joint.position_unit == "m" else "N m"
