"""The robot's bodies, joints, mimic couplings and contacts as a MuJoCo specification."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from functools import cache
from itertools import combinations

import mujoco
import numpy as np

from harness.core.geometry import Friction
from harness.core.types import FloatArray
from harness.robot.collision_shapes import convex_shapes
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Inertial, Joint
from harness.robot.tree import excluded_contacts
from harness.simulation.geoms import add_collision_geom
from harness.simulation.independence import add_idle_joints

LINK_FRICTION = Friction()  # Surface of robot links other than the finger pads

TRIANGLE_MARGIN = 1e-9
"""Share of the largest principal moment by which the sum of the two others exceeds it. MuJoCo
rejects flat and thin bodies that violate the triangle inequality by a rounding error."""

MIMIC_SOLREF = (0.01, 1.0)
"""Time constant [s] and damping ratio of a mimic coupling.

Slower than a contact: at two steps, fingers that press on an object chatter from step to step.
"""
MIMIC_SOLIMP = (0.9999, 0.99999, 0.001, 0.5, 2.0)  # Nearly rigid: both fingers press with one force


def link_friction(description: RobotDescription, link: str) -> Friction:
    """Surface of a link; the gripper's pads have a friction of their own."""
    for gripper in description.grippers:
        if link in gripper.pads.values():
            return Friction(sliding=gripper.friction)
    return LINK_FRICTION


def add_robot(spec: mujoco.MjSpec, description: RobotDescription) -> None:
    """Add one body for each link, under the same name and in double precision.

    Args:
        spec: A specification in radians; `world` is its world body.
    """
    bodies, idle = {"world": spec.worldbody}, list[tuple[mujoco.MjsBody, mujoco.MjsBody]]()
    links = {link.name: link for link in description.links}
    for joint in description.joints:
        link = links[joint.child]
        body = bodies[joint.parent].add_body(name=link.name)
        body.pos = joint.pose.translation
        body.quat = joint.pose.quat_wxyz
        if link.inertial is not None:
            set_inertia(body, link.inertial)
        if joint.is_movable:
            _add_joint(body, joint, joint_range(description, joint))
        for shape in convex_shapes(link.collisions):
            add_collision_geom(spec, body, shape)
        bodies[link.name] = body
        if joint.parent == "world" and description.is_cell:
            idle.append((spec.worldbody.add_body(name=f"idle joints of {link.name}"), body))
    for spare, body in idle:
        add_idle_joints(spare, len(body.find_all("joint")))
    for joint in description.joints:
        if joint.mimic is not None:
            _couple(spec, joint)
    _exclude_contacts(spec, description)


def set_inertia(body: mujoco.MjsBody, inertial: Inertial) -> None:
    """Give a body its mass, centre of mass and inertia explicitly."""
    inertia = _inside_the_triangle(inertial.inertia)
    body.explicitinertial = True
    body.mass = inertial.mass
    body.ipos = inertial.center_of_mass
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    body.fullinertia = inertia[rows, columns]


def _inside_the_triangle(inertia: FloatArray) -> FloatArray:
    """The tensor, its smaller principal moments raised to satisfy `TRIANGLE_MARGIN`."""
    moments, axes = np.linalg.eigh(inertia)
    lack = (1 + TRIANGLE_MARGIN) * moments[2] - moments[0] - moments[1]
    if lack <= 0:
        return inertia
    return axes @ np.diag(moments + np.array([lack / 2, lack / 2, 0.0])) @ axes.T


def joint_range(description: RobotDescription, joint: Joint) -> tuple[float, float]:
    """Limits of a joint, narrowed to what the joints that mimic it can follow.

    Limits of a mimic joint that would leave none of the joint's own count for nothing: ROS never
    reads them, and those of PR2's fingers have the wrong sign.
    """
    lower, upper = joint.lower, joint.upper
    for other in description.movable_joints:
        mimic = other.mimic
        if mimic is None or mimic.joint != joint.name or mimic.multiplier == 0:
            continue
        ends = sorted((end - mimic.offset) / mimic.multiplier for end in (other.lower, other.upper))
        if max(lower, ends[0]) < min(upper, ends[1]):
            lower, upper = max(lower, ends[0]), min(upper, ends[1])
    return lower, upper


@cache
def coupling(description: RobotDescription) -> FloatArray:
    """Velocities of all movable joints by those of the actuated ones, shape (n, actuated)."""
    actuated = [joint.name for joint in description.movable_joints if joint.mimic is None]
    matrix = np.zeros((len(description.joint_names), len(actuated)))
    for row, joint in enumerate(description.movable_joints):
        if joint.mimic is None:
            matrix[row, actuated.index(joint.name)] = 1.0
        else:
            matrix[row, actuated.index(joint.mimic.joint)] = joint.mimic.multiplier
    return matrix


def _add_joint(body: mujoco.MjsBody, joint: Joint, limits: tuple[float, float]) -> None:
    prismatic = joint.kind == "prismatic"
    kind = mujoco.mjtJoint.mjJNT_SLIDE if prismatic else mujoco.mjtJoint.mjJNT_HINGE
    added = body.add_joint(name=joint.name, type=kind, axis=joint.axis)
    added.damping[0] = joint.damping
    added.frictionloss = joint.friction
    is_limited = joint.mimic is None and bool(np.all(np.isfinite(limits)))
    added.limited = is_limited
    if is_limited:
        added.range = limits


def _couple(spec: mujoco.MjSpec, joint: Joint) -> None:
    assert joint.mimic is not None
    equality = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT, name1=joint.name, name2=joint.mimic.joint
    )
    equality.objtype = mujoco.mjtObj.mjOBJ_JOINT
    equality.data = [joint.mimic.offset, joint.mimic.multiplier] + 10 * [0.0]
    equality.solref = MIMIC_SOLREF
    equality.solimp = MIMIC_SOLIMP


def _exclude_contacts(spec: mujoco.MjSpec, description: RobotDescription) -> None:
    """Exclude the contacts that the physics leaves out; MuJoCo has none between static links."""
    static = description.static_links
    shaped = [link.name for link in description.links if link.collisions]
    excluded = excluded_contacts(description)
    for first, second in combinations(shaped, 2):
        if frozenset((first, second)) in excluded and not {first, second} <= static:
            spec.add_exclude(bodyname1=first, bodyname2=second)
