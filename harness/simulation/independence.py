"""What keeps a robot's motion equal to the bit, whatever other robots of its cell do far away.

MuJoCo solves each island of bodies that touch by itself, but two things depend on the whole model.
A contact's speed is a sum over all joints, in `LANES` partial sums: robots have multiples of these.
And one comparison decides whether the solver begins at its last solution: a wheel at its stop does.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

LANES = 4  # of MuJoCo's `mju_dot`, on all processors
DENSE_OBJECTS = 7  # up to which matrices are dense; MuJoCo would count the joints of all robots
WHEEL, INERTIA = "wheel at its stop", 1e8  # [kg m^2]
ACCELERATION = 1e6  # [rad/s^2], without the stop: it costs 5e23, a kilogram at a wall 5e11


def add_idle_joints(body: mujoco.MjsBody, joints: int) -> None:
    """Complete a number of joints to a multiple of `LANES`, by joints that nothing moves."""
    body.explicitinertial, body.mass, body.inertia = True, 1.0, np.ones(3)
    for number in range(-joints % LANES):
        body.add_joint(name=f"{body.name} {number}", axis=np.eye(3)[number])


def make_independent(spec: mujoco.MjSpec, movable: int) -> None:
    """Fix the kind of MuJoCo's matrices and its solver's start; no joint may be added later."""
    kind = mujoco.mjtJacobian
    spec.option.jacobian = kind.mjJAC_DENSE if movable <= DENSE_OBJECTS else kind.mjJAC_SPARSE
    body = spec.worldbody.add_body(name=WHEEL, sleep=mujoco.mjtSleepPolicy.mjSLEEP_NEVER)
    body.explicitinertial, body.mass, body.inertia = True, 1.0, np.ones(3)
    wheel = body.add_joint(name=WHEEL, armature=INERTIA, springref=ACCELERATION)
    wheel.stiffness[0] = INERTIA
    stop = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, name1=WHEEL, data=np.zeros(12))
    stop.objtype = mujoco.mjtObj.mjOBJ_JOINT
    stop.solimp = 0.9999, 0.9999, 0.001, 0.5, 2.0
