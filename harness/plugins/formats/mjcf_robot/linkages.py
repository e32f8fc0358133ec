"""Closed linkages of MJCF grippers: joints that `connect` equalities move, as mimic joints."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.robot.mechanism import Mimic

POSITIONS = 9  # Positions of the driven joint at which a linkage is settled
SETTLING = 1.0  # Simulated time in which a linkage comes to rest at each position [s]
HELD = 1e3  # Inertia of the driven joint while a linkage settles [kg m^2]

TOLERANCE = 0.1
"""Largest deviation of a joint of a linkage from a straight line, in the unit of the joint."""


def linkage_mimics(
    model: Any, mimics: Mapping[str, Mimic], notes: list[str]
) -> tuple[dict[str, Mimic], int]:
    """The joints that a driven joint moves through closed linkages, and the number of linkages.

    A tree of links cannot hold the loop that a `connect` equality closes. So MuJoCo settles the
    linkage at positions of its driven joint, with the file's springs and limits and without
    gravity, contacts and actuators; each other joint of the loop follows a line through these.

    Args:
        model: The model that MuJoCo compiled from the file.
        mimics: The joints that follow others already.
        notes: Receives how far joints are from their lines.
    """
    import mujoco

    loops: dict[str, list[int]] = {}
    count = 0
    for number in np.flatnonzero(model.eq_type == int(mujoco.mjtEq.mjEQ_CONNECT)):
        joints = _loop(model, int(model.eq_obj1id[number]), int(model.eq_obj2id[number]))
        leader = _leader(model, joints, mimics)
        if leader:
            loops.setdefault(leader, []).extend(joints)
            count += 1
    found: dict[str, Mimic] = {}
    for leader, joints in loops.items():
        led = {name: mimic for name, mimic in mimics.items() if mimic.joint == leader}
        passive = [j for j in dict.fromkeys(joints) if model.joint(j).name not in {leader, *led}]
        values, settled = _settled(model, leader, led, passive)
        for joint, positions in zip(passive, settled.T, strict=True):
            name = str(model.joint(joint).name)
            slope, offset = (float(value) for value in np.polyfit(values, positions, 1))
            deviation = float(np.abs(slope * values + offset - positions).max())
            what = f"joint '{name}' follows '{leader}' in a closed linkage"
            if deviation > TOLERANCE:
                notes.append(f"{what}: this is ignored, since no line is within {TOLERANCE} of it")
                continue
            notes.append(f"{what}: a line is used, at most {deviation:.2g} rad off")
            found[name] = Mimic(leader, slope, offset)
    return found, count


def _loop(model: Any, first: int, second: int) -> list[int]:
    """The joints between two bodies: those of both up to the body that carries both."""
    ways: list[list[int]] = []
    for body in (first, second):
        way = [body]
        while way[-1]:
            way.append(int(model.body_parentid[way[-1]]))
        ways.append(way)
    apart = set(ways[0]) ^ set(ways[1])
    return [joint for joint in range(model.njnt) if int(model.jnt_bodyid[joint]) in apart]


def _leader(model: Any, joints: list[int], mimics: Mapping[str, Mimic]) -> str:
    """The one joint of a loop that an actuator or another joint drives, or what that follows."""
    import mujoco

    names = [str(model.joint(joint).name) for joint in joints]
    driven = {mimics[name].joint for name in names if name in mimics}
    driven |= {mimic.joint for mimic in mimics.values() if mimic.joint in names}
    for actuator in range(model.nu):
        target = int(model.actuator_trnid[actuator, 0])
        is_joint = int(model.actuator_trntype[actuator]) == int(mujoco.mjtTrn.mjTRN_JOINT)
        if is_joint and target in joints:
            name = str(model.joint(target).name)
            driven.add(mimics[name].joint if name in mimics else name)
    [leader] = driven if len(driven) == 1 else [""]
    is_limited = leader and model.jnt_limited[model.joint(leader).id]
    return leader if is_limited else ""


def _settled(
    model: Any, leader: str, led: Mapping[str, Mimic], passive: list[int]
) -> tuple[FloatArray, FloatArray]:
    """Positions of the leader, shape (N,), and those of passive joints at rest there, (N, P)."""
    import mujoco

    model = copy.deepcopy(model)
    model.opt.gravity[:] = 0.0
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    for name in (leader, *led):  # what is held gives way to no constraint
        model.dof_armature[model.joint(name).dofadr] = HELD
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    lower, upper = model.jnt_range[model.joint(leader).id]
    values = np.linspace(float(lower), float(upper), POSITIONS)
    address = model.jnt_qposadr[passive]
    found = np.empty((POSITIONS, len(passive)))
    for row, value in enumerate(values):
        held = {leader: value} | {n: m.multiplier * value + m.offset for n, m in led.items()}
        for _ in range(int(SETTLING / model.opt.timestep)):
            for name, position in held.items():
                data.joint(name).qpos, data.joint(name).qvel = position, 0.0
            mujoco.mj_step(model, data)
        found[row] = data.qpos[address]
    return values, found
