"""Adds the world's objects as MuJoCo bodies; objects that appear later are parked at the start."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco

from harness.core.spatial import SE3
from harness.core.world import ObjectJoint, WorldObject
from harness.robot.mechanism import Inertial
from harness.simulation.geoms import add_collision_geom
from harness.simulation.robot_mjcf import set_inertia

COMPILED_SURFACE = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""A surface that moves: MuJoCo ignores those that do not when the model is compiled."""

WELD_SOLIMP = (0.999, 0.9999, 0.001, 0.5, 2.0)  # Impedance of what is nearly rigid


def parking_pose(index: int) -> SE3:
    """The parking pose of the object with an index: far below, apart from the others."""
    return SE3.from_xyz_rpy((10.0 * index, 0.0, -100.0))


def weld_name(name: str) -> str:
    """Name of the weld constraint that is reserved for a dynamic object."""
    return f"weld {name}"


def add_object(spec: mujoco.MjSpec, obj: WorldObject, pose: SE3) -> None:
    """Add an object as a body of its name, fixed if static, else free.

    A part of a fixture has its hinge or slide, and does not touch the fixture. Free bodies have a
    gravity compensation that acts while they are parked; what moves has a weld constraint that acts
    while it is welded to a link. All geoms collide when compiled, because MuJoCo
    prepares contacts only for those; the caller disables them.
    """
    body = spec.worldbody.add_body(name=obj.name)
    if obj.joint is not None:
        pose = obj.joint.pose(0.0)
    body.pos = pose.translation
    body.quat = pose.quat_wxyz
    for shape in obj.shapes:
        add_collision_geom(spec, body, shape)
    if obj.surface_motion is not None:
        for geom in body.geoms:
            geom.surfacevel = COMPILED_SURFACE
    if obj.is_static:
        return
    if obj.joint is None:
        body.add_freejoint(name=obj.name)
        body.gravcomp = 1.0
    else:
        _add_joint(spec, body, obj.joint)
    set_inertia(body, Inertial(obj.mass, obj.center_of_mass, obj.inertia))
    weld = spec.add_equality(
        name=weld_name(obj.name),
        type=mujoco.mjtEq.mjEQ_WELD,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        name1="world",
        name2=obj.name,
        active=False,
    )
    weld.solref = (0.004, 1.0)
    weld.solimp = WELD_SOLIMP


def _add_joint(spec: mujoco.MjSpec, body: mujoco.MjsBody, joint: ObjectJoint) -> None:
    body.add_joint(
        name=body.name,
        type=getattr(mujoco.mjtJoint, f"mjJNT_{joint.kind.upper()}"),
        axis=joint.axis,
        pos=joint.point,
        limited=True,
        range=(joint.lower, joint.upper),
        frictionloss=joint.friction,
        damping=joint.damping,
        stiffness=joint.stiffness,
        springref=joint.rest,
        solref_friction=(2 * spec.option.timestep, 1.0),
        solimp_friction=WELD_SOLIMP,  # what friction holds creeps with the softness of this
    )
    spec.add_exclude(bodyname1=joint.fixture, bodyname2=body.name)
