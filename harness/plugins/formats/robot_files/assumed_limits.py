"""Limits of imported arms that their files lack, and effort limits that cannot be true."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import replace

import numpy as np

from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint
from harness.robot.urdf.write import write_urdf

ACCELERATION = (5.0, "rad/s^2"), (1.0, "m/s^2")
"""Acceleration limits of revolute and of prismatic joints, which URDF lacks; 5 rad/s^2 as MoveIt's
Setup Assistant suggests. A motion is slower where its efforts require it."""

VELOCITY = (1.5, "rad/s"), (0.2, "m/s")
"""Velocity limits of revolute and of prismatic joints without one in the file."""

SAMPLES = 60
"""Random configurations, the same in every run, in which the efforts against gravity are known."""

LEAST_JOINTS = 3  # Fewest joints of an arm whose equal effort limits are no coincidence


def with_plausible_efforts(description: RobotDescription) -> RobotDescription:
    """The robot without the effort limits of its arm where they are a placeholder.

    They are one if they are the same for all joints and do not hold the arm in a sampled
    configuration. Other joints that cannot hold the arm are noted.
    """
    driven = [joint for joint in description.movable_joints if joint.mimic is None]
    if not any(np.isfinite(joint.effort) for joint in driven):
        return description
    gravity = _gravity_efforts(description, driven)
    names = description.arm_joints
    efforts = {description.joint_by_name[name].effort for name in names}
    heaviest = max(names, key=gravity.__getitem__)
    is_equal = len(names) >= LEAST_JOINTS and len(efforts) == 1
    if not is_equal or gravity[heaviest] <= min(efforts):
        notes = tuple(
            f"joint '{joint.name}' cannot hold the arm everywhere: gravity alone needs up to "
            f"{gravity[joint.name]:.3g} of its {joint.effort:.3g}"
            for joint in driven
            if gravity[joint.name] >= joint.effort
        )
        return replace(description, notes=(*description.notes, *notes))
    joints = tuple(
        replace(joint, effort=np.inf, effort_source="") if joint.name in names else joint
        for joint in description.joints
    )
    note = (
        f"the effort limit of {min(efforts):g} of all joints of the arm counts as none: gravity"
        f" alone needs up to {gravity[heaviest]:.3g} of {heaviest}; give those of the data sheet,"
        f" as `joint_limits: {{{heaviest}: {{max_effort: ...}}}}` in `robot:`"
    )
    return replace(
        description,
        joints=joints,
        urdf=write_urdf(description.name, description.links, joints),
        notes=(*description.notes, note),
    )


def with_assumed_limits_listed(description: RobotDescription, known: Set[str]) -> RobotDescription:
    """The robot with notes on the velocity and acceleration limits that no file has.

    Args:
        description: The robot with all its limits.
        known: Joints whose acceleration is given and not assumed.
    """
    driven = [joint for joint in description.movable_joints if joint.mimic is None]
    slow = [joint for joint in driven if joint.is_velocity_assumed]
    free = [joint for joint in driven if joint.name not in known]
    notes: list[str] = []
    if slow:
        notes.append(f"no velocity limits of {_names(slow)}: {_both(VELOCITY, slow)}")
    if free:
        whose = "" if len(free) == len(driven) else f" of {_names(free)}"
        notes.append(f"no acceleration limits{whose}: {_both(ACCELERATION, free)}")
    return replace(description, notes=(*description.notes, *notes))


def _names(joints: Sequence[Joint]) -> str:
    return ", ".join(joint.name for joint in joints)


def _both(limits: tuple[tuple[float, str], ...], joints: Sequence[Joint]) -> str:
    """The limits that are assumed for joints."""
    kinds = sorted({joint.kind == "prismatic" for joint in joints})
    stated = [f"{limits[kind][0]:g} {limits[kind][1]}" for kind in kinds]
    return f"{' and '.join(stated)} {'is' if len(joints) == 1 else 'are'} assumed"


def _gravity_efforts(description: RobotDescription, joints: Sequence[Joint]) -> dict[str, float]:
    """The largest effort of each driven joint against gravity in sampled configurations."""
    import pinocchio as pin  # here: bundled robots do not need it

    model = pin.buildModelFromXML(write_urdf("robot", description.links, description.joints))
    data = model.createData()
    limits = model.lowerPositionLimit, model.upperPositionLimit
    lower, upper = np.clip(-np.pi, *limits), np.clip(np.pi, *limits)
    rng = np.random.default_rng(0)
    efforts = [
        np.abs(pin.computeGeneralizedGravity(model, data, pin.normalize(model, drawn)))
        for drawn in (rng.uniform(lower, upper) for _ in range(SAMPLES))
    ]
    most = np.max(efforts, axis=0)
    return {
        joint.name: float(most[model.joints[model.getJointId(joint.name)].idx_v])
        for joint in joints
    }
