"""Limits of imported arms that their files lack: what is assumed, and what efforts allow."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.core.types import FloatArray
from harness.robot.description import Joint, RobotDescription
from harness.robot.urdf.write import write_urdf

ACCELERATION = (5.0, "rad/s^2"), (1.0, "m/s^2")
"""Acceleration limits of revolute and of prismatic joints, which URDF lacks; 5 rad/s^2 as MoveIt's
Setup Assistant suggests."""

VELOCITY = (1.5, "rad/s"), (0.2, "m/s")
"""Velocity limits of revolute and of prismatic joints without one in the file."""

SAMPLES = 60
"""Number of random configurations, the same in every run, in which efforts are evaluated."""

SHARE = 0.7
"""Share of the effort beyond gravity that is available for acceleration."""

LEAST_JOINTS = 3
"""Fewest joints of an arm whose equal effort limits are no coincidence."""

LEAST = 0.05
"""Smallest share of the assumed acceleration that remains."""


def without_placeholder_efforts(description: RobotDescription) -> RobotDescription:
    """The robot without the effort limits of its arm where they are a placeholder.

    They are one if they are the same for all joints and do not hold the arm in a sampled
    configuration.
    """
    names = description.groups[description.arm_group].joint_names
    efforts = {description.joint_by_name[name].effort for name in names}
    effort = min(efforts)
    if len(names) < LEAST_JOINTS or len(efforts) > 1 or not np.isfinite(effort):
        return description
    driven = [joint.name for joint in description.movable_joints if joint.mimic is None]
    gravity = dict(zip(driven, _efforts(description)[1].max(axis=0).tolist(), strict=True))
    heaviest = max(names, key=gravity.__getitem__)
    if gravity[heaviest] <= effort:
        return description
    joints = tuple(
        replace(joint, effort=np.inf, effort_source="") if joint.name in names else joint
        for joint in description.joints
    )
    note = (
        f"the effort limit of {effort:g} of all joints of the arm counts as none: gravity alone"
        f" needs up to {gravity[heaviest]:.3g} of {heaviest}; give those of the data sheet, as"
        f" `joint_limits: {{{heaviest}: {{max_effort: ...}}}}` in `robot:`"
    )
    return replace(
        description,
        joints=joints,
        urdf=write_urdf(description.name, description.links, joints),
        notes=(*description.notes, note),
    )


def with_possible_accelerations(
    description: RobotDescription, known: frozenset[str] = frozenset()
) -> RobotDescription:
    """The robot with assumed accelerations lowered to the limits of the joints' efforts.

    In each sampled configuration a joint must hold the arm against gravity and accelerate it with
    all joints at their assumed accelerations at once.

    Args:
        description: The robot with the assumed accelerations.
        known: Joints whose acceleration is given and not assumed.
    """
    driven = [joint for joint in description.movable_joints if joint.mimic is None]
    if all(joint.name in known or not np.isfinite(joint.effort) for joint in driven):
        return description
    needed, gravity = _efforts(description)
    shares: dict[str, float] = {}
    notes: list[str] = []
    for index, joint in enumerate(driven):
        if not np.isfinite(joint.effort) or joint.name in known:
            continue
        left = joint.effort - gravity[:, index]
        share = float(np.min(SHARE * left / np.maximum(needed[:, index], 1e-9)))
        shares[joint.name] = min(1.0, max(LEAST, share))
        if left.min() <= 0:
            notes.append(
                f"joint '{joint.name}' cannot hold the arm everywhere: gravity alone needs up to "
                f"{gravity[:, index].max():.3g} of its {joint.effort:.3g}"
            )
    joints = tuple(
        replace(joint, acceleration=joint.acceleration * shares.get(joint.name, 1.0))
        for joint in description.joints
    )
    return replace(description, joints=joints, notes=(*description.notes, *notes))


def with_assumed_limits_listed(
    description: RobotDescription, known: frozenset[str]
) -> RobotDescription:
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
        lowered = [
            f"{joint.name} {joint.acceleration:.2g}"
            for joint in free
            if joint.acceleration < ACCELERATION[joint.kind == "prismatic"][0]
        ]
        whose = "" if len(free) == len(driven) else f" of {_names(free)}"
        also = f", and what efforts allow: {', '.join(lowered)}" if lowered else ""
        notes.append(f"no acceleration limits{whose}: {_both(ACCELERATION, free)}{also}")
    return replace(description, notes=(*description.notes, *notes))


def _names(joints: Sequence[Joint]) -> str:
    return ", ".join(joint.name for joint in joints)


def _both(limits: tuple[tuple[float, str], ...], joints: Sequence[Joint]) -> str:
    """The limits that are assumed for joints."""
    kinds = sorted({joint.kind == "prismatic" for joint in joints})
    stated = [f"{limits[kind][0]:g} {limits[kind][1]}" for kind in kinds]
    return f"{' and '.join(stated)} {'is' if len(joints) == 1 else 'are'} assumed"


def _efforts(description: RobotDescription) -> tuple[FloatArray, FloatArray]:
    """Efforts of the driven joints for their accelerations and against gravity, (SAMPLES, m)."""
    import pinocchio as pin  # here: bundled robots do not need it

    names = [joint.name for joint in description.movable_joints if joint.mimic is None]
    model = pin.buildModelFromXML(write_urdf("robot", description.links, description.joints))
    data = model.createData()
    joints = [model.joints[model.getJointId(name)] for name in names]
    columns = [joint.idx_v for joint in joints]
    rates = np.array([description.joint_by_name[name].acceleration for name in names])
    limits = model.lowerPositionLimit, model.upperPositionLimit
    lower, upper = np.clip(-np.pi, *limits), np.clip(np.pi, *limits)
    rng = np.random.default_rng(0)
    needed, gravity = np.empty((SAMPLES, len(names))), np.empty((SAMPLES, len(names)))
    for row in range(SAMPLES):
        configuration = pin.normalize(model, rng.uniform(lower, upper))
        mass = np.array(pin.crba(model, data, configuration))
        mass = np.triu(mass) + np.triu(mass, 1).T
        held = pin.computeGeneralizedGravity(model, data, configuration)
        needed[row] = np.abs(mass[np.ix_(columns, columns)]) @ rates
        gravity[row] = np.abs(held[columns])
    return needed, gravity
