"""Efforts that a motion takes of the joints, by inverse dynamics, with what the robot holds."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from harness.core.types import FloatArray
from harness.planning.robot_model import GroupSpace, pin_from_se3
from harness.planning.scene import Payload


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """Of a group's joints, the rest of the robot at rest; friction is left out.

    Attributes:
        joint_names: Of the group.
        limits: Of its joints' efforts [N m or N], shape (dof,); inf where there is none.
    """

    joint_names: tuple[str, ...]
    limits: FloatArray
    _space: GroupSpace
    _model: pin.Model

    @classmethod
    def of(cls, space: GroupSpace, payloads: Sequence[Payload]) -> InverseDynamics | None:
        """None when no joint of the group has an effort limit."""
        description = space.robot.description
        limits = np.array([description.joint_by_name[name].effort for name in space.joint_names])
        if not np.any(np.isfinite(limits)):
            return None
        model = space.robot.model
        if payloads:
            model = model.copy()
            for payload in payloads:
                inertia = pin.Inertia(payload.mass, payload.center_of_mass, payload.inertia)
                placement = space.robot.placement(payload.link) @ payload.pose
                joint = space.robot.parent_joint(payload.link)
                model.appendBodyToJoint(joint, inertia, pin_from_se3(placement))
        return cls(space.joint_names, limits, space, model)

    def efforts(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> FloatArray:
        """Efforts of a motion, shape (N, dof), for rows (N, dof) of its states."""
        space, model, data = self._space, self._model, self._model.createData()
        columns = space.robot.velocity_columns
        found = np.empty_like(positions)
        velocity, acceleration = np.zeros(model.nv), np.zeros(model.nv)
        for row, position in enumerate(positions):
            velocity[columns] = space.matrix @ velocities[row]
            acceleration[columns] = space.matrix @ accelerations[row]
            configuration = space.robot.configuration(space.whole(position))
            efforts = pin.rnea(model, data, configuration, velocity, acceleration)
            found[row] = space.matrix.T @ efforts[columns]
        return found
