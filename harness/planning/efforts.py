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
from harness.planning.collision.native.library import call
from harness.planning.model.robot_model import GroupSpace, RobotModel, pin_from_se3
from harness.recording.motion_failures import OverloadFailure, TrajectoryFailure

ROUNDING = 1e-9  # Share of a limit within which Pinocchio decides


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
        pool, _, _ = _loaded(space.robot, self.payloads)
        v, a, found = np.zeros((3, len(positions), space.robot.model.nv))
        v[:, columns], a[:, columns] = velocities @ space.matrix.T, accelerations @ space.matrix.T
        pin.rneaInParallel(1, pool, q.T, v.T, a.T, found.T)  # on one thread
        return found[:, columns] @ space.matrix

    def are_clearly_within(
        self, share: float, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> bool:
        """Whether efforts of states (N, dof) are surely within a share of the limits; fast."""
        space, gravity = self._space, self._space.robot.model.gravity.linear
        _, joints, _ = _loaded(space.robot, self.payloads)
        drive = space.matrix[np.argsort(space.robot.velocity_columns)]
        states = np.array([positions, velocities, accelerations]) @ drive.T
        states[0] += space.offset[np.argsort(space.robot.velocity_columns)]
        efforts = call("efforts", (joints, gravity, states), np.empty_like(states[0])) @ drive
        return bool(np.all(np.abs(efforts) <= self.limits * (share - ROUNDING)))

    @property
    def holds_anywhere(self) -> bool:
        """Whether the limits exceed what gravity needs at most, however the arm stands."""
        order = np.argsort(self._space.robot.velocity_columns)
        _, _, most = _loaded(self._space.robot, self.payloads)
        return bool(np.all(most @ np.abs(self._space.matrix[order]) < self.limits))

    def can_hold(self, positions: FloatArray) -> bool:
        """Whether the joints can hold the arm still at all positions, shape (N, dof)."""
        still = np.zeros_like(positions)
        if self.holds_anywhere or self.are_clearly_within(1.0, positions, still, still):
            return True
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
) -> tuple[pin.ModelPool, FloatArray, FloatArray]:
    """The model with its payloads, and its joints as native/efforts.c reads them, (nv, 27).

    Last, what gravity needs of each at most: all weight at the end of a straightened chain, (nv,).
    """
    model, joints = robot.model.copy(), robot.description.joint_by_name
    for payload in payloads:
        assert payload.link is not None
        inertia = pin.Inertia(payload.mass, payload.center_of_mass, payload.inertia)
        placement = robot.placement(payload.link) @ payload.pose
        joint = robot.parent_joint(payload.link)
        model.appendBodyToJoint(joint, inertia, pin_from_se3(placement))
    rows: list[FloatArray] = []
    for joint in range(1, model.njoints):
        known, at = joints[model.names[joint]], model.jointPlacements[joint]
        kind = [known.kind == "prismatic", model.parents[joint] - 1]
        body = model.inertias[joint].toDynamicParameters()
        rows.append(np.concatenate([at.rotation.ravel(), at.translation, known.axis, kind, body]))
    most, carried = np.zeros(len(rows)), np.zeros((len(rows) + 1, 2))  # moment, mass; base last
    for joint in reversed(range(len(rows))):
        known, row = joints[model.names[joint + 1]], rows[joint]
        moment, mass = carried[joint] + (np.linalg.norm(row[18:21]), row[17])
        away = max(abs(known.lower), abs(known.upper)) if row[15] else 0.0
        most[joint] = mass if row[15] else moment
        carried[int(row[16])] += moment + (np.linalg.norm(row[9:12]) + away) * mass, mass
    return pin.ModelPool(model, 1), np.array(rows), np.linalg.norm(model.gravity.linear) * most
