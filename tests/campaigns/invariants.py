"""What holds of every run, whatever its steps were and however they ended."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from harness.recording.run import Run
from harness.recording.step_record import StepRecord

CHANGING = frozenset({
    "attach_object", "detach_object", "grasp", "release", "pick", "place", "gripper", "open",
    "remove_object", "clear_objects", "parallel", "sequence", "repeat", "include",
})  # fmt: skip
"""Steps that may change what is attached, and steps of which such are a part."""
ROUNDING = 1e-6  # rad or m, and rad/s or m/s; the limits themselves are given with 4 digits


def assert_invariants(run: Run) -> None:
    """Commands are within limits, and what is attached changes by steps that say so."""
    _commands_within_limits(run)
    for step in run.steps:
        if step.trajectory is not None:
            _trajectory_within_limits(run, step)
    _nothing_attached_is_forgotten(run)


def _commands_within_limits(run: Run) -> None:
    """Every commanded position is within the limits of its joint."""
    for number, joint in enumerate(run.robot.movable_joints):
        commands = run.signals.joint_commands[:, number]
        commands = commands[~np.isnan(commands)]
        if commands.size and not joint.is_mimic:
            start = run.signals.joint_positions[0, number]  # a scenario may begin outside
            low, high = min(joint.lower, start), max(joint.upper, start)
            assert commands.min() >= low - 1e-4, (joint.name, commands.min(), low)
            assert commands.max() <= high + 1e-4, (joint.name, commands.max(), high)


def _trajectory_within_limits(run: Run, step: StepRecord) -> None:
    """The set points of a motion are within position, velocity and acceleration limits, in order.

    Velocities are compared with differences of the positions, too, so that they cannot be wrong
    together.
    """
    plan = step.trajectory
    joints = {each.name: each for each in run.robot.joints}
    assert plan is not None
    assert (np.diff(plan.times) > 0).all(), step.id
    for column, name in enumerate(plan.joint_names):
        joint, positions = joints[name], plan.positions[:, column]
        assert positions.min() >= joint.lower - 1e-4, (step.id, name)
        assert positions.max() <= joint.upper + 1e-4, (step.id, name)
        velocities = np.abs(plan.velocities[:, column])
        assert velocities.max() <= joint.velocity * 1.001 + ROUNDING, (step.id, name)
        if len(positions) > 1:
            means = np.abs(np.diff(positions) / np.diff(plan.times))
            assert means.max() <= joint.velocity * 1.001 + ROUNDING, (step.id, name)
        accelerations = np.abs(plan.accelerations[:, column])
        assert accelerations.max() <= joint.acceleration * 1.01 + ROUNDING, (step.id, name)


def _nothing_attached_is_forgotten(run: Run) -> None:
    """Attachments begin and end in steps that change them, one of an object at a time."""
    spans = [
        (step.start_time, step.end_time)
        for step in run.steps
        if step.verb in CHANGING and step.status in ("passed", "failed")
    ]
    for each in run.attachments:
        for moment in (each.start_time, each.end_time):
            is_change = any(begin - 1e-9 <= moment <= end + 1e-9 for begin, end in spans)
            assert moment == np.inf or is_change, (each.object, moment)
    for name in {each.object for each in run.attachments}:
        own = sorted(
            (each.start_time, each.end_time) for each in run.attachments if each.object == name
        )
        assert all(end <= begin for (_, end), (begin, _) in pairwise(own)), name
    for step in run.steps:
        _has_its_effect(run, step)


def _has_its_effect(run: Run, step: StepRecord) -> None:
    """After a pick or an attachment that passed something is held that was not before."""
    if step.status != "passed" or step.error_code or step.verb not in ("pick", "attach_object"):
        return
    taken = [
        each.object
        for each in run.attachments
        if step.start_time - 1e-9 <= each.start_time <= step.end_time + 1e-9
        and each.end_time >= step.end_time - 1e-9
    ]
    assert taken, step.id
