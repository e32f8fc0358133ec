"""MJCF's hinges, slides and joint equalities as joints."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.errors import Problem, SpecError
from harness.core.pose_arrays import rotations_about
from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.mjcf_robot.linkages import linkage_mimics
from harness.robot.mechanism import Joint, Mimic, fixed_joint

SLIDE = 2  # of mjtJoint


def body_chain(
    model: Any, elements: Mapping[tuple[str, str], XmlElement], body: int, parent: str, name: str
) -> tuple[list[str], list[Joint]]:
    """The body's joints in series, and the links between them.

    MuJoCo turns a body about an anchor in its own frame; here a joint's frame is the anchor,
    so a fixed joint leads from the last anchor back to the body's frame.

    Raises:
        SpecError: A slide joint has no range.
    """
    pose = mjcf_pose(model.body_pos[body], model.body_quat[body])
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    anchor = np.zeros(3)
    between: list[str] = []
    joints: list[Joint] = []
    for number in range(first, first + count):
        here = np.array(model.jnt_pos[number])
        is_last = number == first + count - 1
        child = name if is_last and not here.any() else f"{name}_{number}"
        pose = pose @ SE3(np.eye(3), here - anchor)
        joints.append(_joint(model, elements, number, parent, child, pose))
        anchor, parent, pose = here, child, SE3.identity()
        if child != name:
            between.append(child)
    if parent != name:
        back = pose @ SE3(np.eye(3), -anchor)
        joints.append(fixed_joint(f"{name}_fixed", parent, name, back))
    return between, joints


def _joint(
    model: Any,
    elements: Mapping[tuple[str, str], XmlElement],
    number: int,
    parent: str,
    child: str,
    pose: SE3,
) -> Joint:
    name = model.joint(number).name or f"joint_{number}"
    slides = int(model.jnt_type[number]) == SLIDE
    axis, zero = np.array(model.jnt_axis[number]), float(model.qpos0[model.jnt_qposadr[number]])
    if zero:
        back = (
            SE3(np.eye(3), -zero * axis)
            if slides
            else SE3(rotations_about(axis, -zero), np.zeros(3))
        )
        pose = pose @ back
    lower, upper = -np.inf, np.inf
    if model.jnt_limited[number]:
        lower, upper = (float(end) for end in model.jnt_range[number])
    elif slides:
        message = f"joint '{name}' slides and has no range"
        if ("joint", name) in elements:
            elements["joint", name].refuse(message, "give it a range")
        raise SpecError([Problem("MJCF", 0, 0, message)])
    dof = int(model.jnt_dofadr[number])
    bounded = np.isfinite(lower)
    kind = "prismatic" if slides else "revolute" if bounded else "continuous"
    joint = Joint(name, kind, parent, child, pose, axis, lower, upper)
    return replace(
        joint,
        effort=_effort(model, number),
        damping=float(model.dof_damping[dof].item()),
        friction=float(model.dof_frictionloss[dof].item()),
    )


def _effort(model: Any, joint: int) -> float:
    """Force limit of the joint, or of its actuators; inf without a limit."""
    import mujoco

    if model.jnt_actfrclimited[joint]:
        return float(np.abs(model.jnt_actfrcrange[joint]).max())
    most = 0.0
    for actuator in range(model.nu):
        kind, target = int(model.actuator_trntype[actuator]), model.actuator_trnid[actuator, 0]
        gear = abs(float(model.actuator_gear[actuator, 0]))
        if kind == int(mujoco.mjtTrn.mjTRN_TENDON):
            gear *= abs(tendon_joints(model, int(target)).get(joint, 0.0))
        elif kind != int(mujoco.mjtTrn.mjTRN_JOINT) or target != joint:
            continue
        if model.actuator_forcelimited[actuator]:
            most += gear * float(np.abs(model.actuator_forcerange[actuator]).max())
        elif model.actuator_ctrllimited[actuator] and not model.actuator_biasprm[actuator].any():
            gain = abs(float(model.actuator_gainprm[actuator, 0]))
            most += gear * gain * float(np.abs(model.actuator_ctrlrange[actuator]).max())
    return most or np.inf


def tendon_joints(model: Any, tendon: int) -> dict[int, float]:
    """Coefficients of the joints of a fixed tendon; none for a spatial one."""
    import mujoco

    first = int(model.tendon_adr[tendon])
    wraps = range(first, first + int(model.tendon_num[tendon]))
    joint = int(mujoco.mjtWrap.mjWRAP_JOINT)
    return {
        int(model.wrap_objid[wrap]): float(model.wrap_prm[wrap])
        for wrap in wraps
        if int(model.wrap_type[wrap]) == joint
    }


def _driven_together(model: Any, followed: Container[str]) -> dict[str, Mimic]:
    """The second of two joints that one actuator pulls by a fixed tendon, following the first."""
    found: dict[str, Mimic] = {}
    for pulled in pulled_pairs(model):
        (first, slope), (second, other_slope) = pulled.items()
        names = [str(model.joint(joint).name) for joint in (first, second)]
        if not any(name in followed for name in names):
            found[names[1]] = Mimic(names[0], other_slope / slope)
    return found


def pulled_pairs(model: Any) -> list[dict[int, float]]:
    """Coefficients of the two joints of each fixed tendon of two that an actuator pulls."""
    import mujoco

    pulled = [
        tendon_joints(model, int(model.actuator_trnid[actuator, 0]))
        for actuator in range(model.nu)
        if int(model.actuator_trntype[actuator]) == int(mujoco.mjtTrn.mjTRN_TENDON)
    ]
    return [each for each in pulled if len(each) == 2 and all(each.values())]


def with_mimics(model: Any, joints: Iterable[Joint], notes: list[str]) -> list[Joint]:
    """Joints that follow others: by linear equalities, by one tendon, or in closed linkages."""
    import mujoco

    mimics: dict[str, Mimic] = {}
    ignored: list[str] = []
    for number in range(model.neq):
        kind = mujoco.mjtEq(int(model.eq_type[number]))
        if kind != mujoco.mjtEq.mjEQ_JOINT or model.eq_obj2id[number] < 0:
            ignored.append(kind.name.removeprefix("mjEQ_").lower())
            continue
        offset, slope, *curve = (float(value) for value in model.eq_data[number][:5])
        first, second = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        name, other = model.joint(first).name, model.joint(second).name
        if any(curve):
            notes.append(
                f"joint '{name}' follows '{other}' by a polynomial: its linear term is used"
            )
        # The polynomial relates displacements from both joints' references.
        zero, other_zero = (float(model.qpos0[model.jnt_qposadr[j]]) for j in (first, second))
        mimics[name] = Mimic(other, slope, zero + offset - slope * other_zero)
    followed = set(mimics) | {mimic.joint for mimic in mimics.values()}
    for name, mimic in _driven_together(model, followed).items():
        notes.append(f"joint '{name}' follows '{mimic.joint}': one actuator pulls both by a tendon")
        mimics[name] = mimic
    linked, count = linkage_mimics(model, mimics, notes)
    for _ in range(count):
        ignored.remove("connect")
    notes += [f"an equality of the kind {word} is ignored" for word in ignored]
    mimics |= linked
    followers = [replace(j, mimic=mimics[j.name]) if j.name in mimics else j for j in joints]
    ranges = {joint.name: (joint.lower, joint.upper) for joint in followers}
    return [_widened(j, ranges) if j.name in linked else j for j in followers]


def _widened(joint: Joint, ranges: Mapping[str, tuple[float, float]]) -> Joint:
    """A joint of a linkage whose limits do not stop its leader: the file's linkage reaches both."""
    if joint.mimic is None:
        return joint
    ends = [joint.mimic.multiplier * end + joint.mimic.offset for end in ranges[joint.mimic.joint]]
    return replace(joint, lower=min(joint.lower, *ends), upper=max(joint.upper, *ends))


def mjcf_pose(position: Any, quat_wxyz: Any) -> SE3:
    """A pose from MuJoCo's arrays."""
    return SE3.from_xyz_quat(np.array(position, dtype=float), np.array(quat_wxyz, dtype=float))
