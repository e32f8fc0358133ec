"""Joint efforts of a motion by inverse dynamics, attached payloads included."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pinocchio as pin

from harness.core.details import Details
from harness.core.quantity import distinct
from harness.core.types import FloatArray
from harness.planning.collision.collision_model import SceneObject
from harness.planning.model.robot_model import GroupSpace, RobotModel, pin_from_se3
from harness.recording.motion_failures import OverloadFailure, TrajectoryFailure


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """Inverse dynamics of a group's joints, the other joints at rest; friction is neglected.

    Attributes:
        limits: The effort limits [N m or N], shape (dof,); inf where there is none.
    """

    joint_names: tuple[str, ...]
    limits: FloatArray
    _space: GroupSpace
    payloads: tuple[SceneObject, ...] = ()

    @classmethod
    def of(cls, space: GroupSpace, payloads: Sequence[SceneObject]) -> InverseDynamics | None:
        """Create the inverse dynamics; None when no joint of the group has an effort limit."""
        description = space.robot.description
        limits = np.array([description.joint_by_name[name].effort for name in space.joint_names])
        if not np.any(np.isfinite(limits)):
            return None
        return cls(space.joint_names, limits, space, tuple(payloads))

    def efforts(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> FloatArray:
        """Compute the efforts of a motion, shape (N, dof), from its states, shape (N, dof) each."""
        space = self._space
        columns = space.robot.velocity_columns
        q = space.robot.configuration(space.whole(positions))
        pool, _ = _loaded(space.robot, self.payloads)
        v, a, found = np.zeros((3, len(positions), space.robot.model.nv))
        v[:, columns], a[:, columns] = velocities @ space.matrix.T, accelerations @ space.matrix.T
        pin.rneaInParallel(1, pool, q.T, v.T, a.T, found.T)  # on one thread
        return found[:, columns] @ space.matrix

    @property
    def holds_anywhere(self) -> bool:
        """Whether the limits exceed what gravity needs at most, however the arm stands."""
        space = self._space
        _, most = _loaded(space.robot, self.payloads)
        needed = most[space.robot.velocity_columns] @ np.abs(space.matrix)
        return bool(np.all(needed < self.limits))

    def can_hold(self, positions: FloatArray) -> bool:
        """Whether the joints can hold the arm still at all positions, shape (N, dof)."""
        if self.holds_anywhere:
            return True
        still = np.zeros_like(positions)
        return bool(np.all(np.abs(self.efforts(positions, still, still)) <= self.limits))

    def standing_overload(
        self, positions: FloatArray, where: str = "on the way"
    ) -> tuple[str, Details]:
        """Message and details of the joint with the largest static overload at any of (N, dof).

        They are a TrajectoryFailure and an OverloadFailure.
        """
        efforts = self.efforts(positions, np.zeros_like(positions), np.zeros_like(positions))
        shares = np.abs(efforts) / self.limits
        row = int(np.argmax(shares.max(axis=1)))
        standing, positions, still = efforts[row], positions[row], np.zeros((1, len(self.limits)))
        joint = int(np.argmax(shares[row]))
        name, effort, limit = self.joint_names[joint], standing[joint], float(self.limits[joint])
        unit = "N m" if self._space.wraps[joint] else "N"
        needed, most = distinct(abs(effort), limit, lambda value, more: f"{value:.{1 + more}f}")
        what = " and ".join(f"{load.name} ({load.mass:g} kg)" for load in self.payloads)
        message = (
            f"the arm cannot hold {what or 'itself'} still {where}: {name} needs {needed} {unit}"
            f" and has at most {most} {unit}"
        )
        overload = OverloadFailure(float(abs(effort)), limit)
        if self.payloads:
            bare = replace(self, payloads=()).efforts(positions[None], still, still)
            unloaded = bare[0][joint]
            message += f"; without the load it needs {abs(unloaded):.1f} {unit}"
            share = (np.sign(effort) * limit - unloaded) / (effort - unloaded)
            overload = replace(
                overload,
                held=tuple(load.name for load in self.payloads),
                unloaded=float(abs(unloaded)),
                most_mass=float(share * sum(load.mass for load in self.payloads)),
            )
        return message, Details.of(TrajectoryFailure("standing effort", name), overload)


@lru_cache(maxsize=4)
def _loaded(
    robot: RobotModel, payloads: tuple[SceneObject, ...]
) -> tuple[pin.ModelPool, FloatArray]:
    """The model with its payloads, and what each joint's effort against gravity is at most, (nv,).

    Each body that a joint carries counts with its weight at the end of a straightened chain.
    """
    model, joints = robot.model.copy(), robot.description.joint_by_name
    for payload in payloads:
        assert payload.link is not None
        inertia = pin.Inertia(payload.mass, payload.center_of_mass, payload.inertia)
        placement = robot.placement(payload.link) @ payload.pose
        joint = robot.parent_joint(payload.link)
        model.appendBodyToJoint(joint, inertia, pin_from_se3(placement))
    most, carried = np.zeros(model.nv), np.zeros((model.njoints, 2))  # moment, mass
    for joint in range(model.njoints - 1, 0, -1):
        known, body = joints[model.names[joint]], model.inertias[joint]
        moment, mass = carried[joint] + (np.linalg.norm(body.lever) * body.mass, body.mass)
        slides = known.kind == "prismatic"
        most[model.joints[joint].idx_v] = mass if slides else moment
        away = np.linalg.norm(model.jointPlacements[joint].translation)
        away += max(abs(known.lower), abs(known.upper)) if slides else 0.0
        carried[model.parents[joint]] += moment + away * mass, mass
    return pin.ModelPool(model, 1), np.linalg.norm(model.gravity.linear) * most
