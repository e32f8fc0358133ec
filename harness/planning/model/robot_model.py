"""The robot in Pinocchio's terms, and a planning group's joints inside the whole robot's."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from functools import cached_property, lru_cache

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.robot.description import RobotDescription
from harness.robot.tree import joints_to

METRES_TO_RADIANS = 10.0
"""How much a prismatic joint's metre counts in joint-space distances (0.1 m is like 1 rad)."""


def pin_from_se3(pose: SE3) -> pin.SE3:
    """Convert a pose to Pinocchio's."""
    return pin.SE3(np.asarray(pose.rotation, float), np.asarray(pose.translation, float))


def se3_from_pin(pose: pin.SE3) -> SE3:
    """Copy Pinocchio's pose to an SE3."""
    return SE3(np.array(pose.rotation), np.array(pose.translation))


class RobotModel:
    """Pinocchio's model of a description, and the way between both joint orders.

    Pinocchio orders joints in its own way and gives a continuous joint two configuration numbers
    (cosine, sine); everything outside this module uses description order.
    """

    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self.model = _pinocchio_model(description.urdf)
        self.data = self.model.createData()
        joints = [
            self.model.joints[self.model.getJointId(name)] for name in description.joint_names
        ]
        self.rows: IntArray = np.array([joint.idx_q for joint in joints], dtype=np.int64)
        self.velocity_columns: IntArray = np.array([joint.idx_v for joint in joints], np.int64)
        self.is_circular: BoolArray = np.array([joint.nq == 2 for joint in joints], dtype=bool)
        self._has_circular = bool(self.is_circular.any())

    def configuration(self, joint_positions: FloatArray) -> FloatArray:
        """Pinocchio's configuration of joint positions in description order, (nq,) or (N, nq)."""
        configuration = np.empty((*joint_positions.shape[:-1], self.model.nq))
        configuration[..., self.rows] = joint_positions
        if self._has_circular:
            first, angles = self.rows[self.is_circular], joint_positions[..., self.is_circular]
            configuration[..., first], configuration[..., first + 1] = (
                np.cos(angles),
                np.sin(angles),
            )
        return configuration

    def frame_id(self, link: str) -> int:
        """Pinocchio's frame of a link.

        Raises:
            PlanningFailed: INVALID_LINK_NAME; a step may name an object that is not held.
        """
        if link not in self._frame_ids:
            reason = f"'{link}' is neither a link nor an attached object"
            raise PlanningFailed("INVALID_LINK_NAME", reason)
        return self._frame_ids[link]

    @cached_property
    def _frame_ids(self) -> dict[str, int]:
        return {
            link: int(self.model.getFrameId(link, pin.FrameType.BODY))
            for link in self.description.link_names
        }

    def parent_joint(self, link: str) -> int:
        """Index of the Pinocchio joint a link moves with; 0 for links that stand still."""
        return int(self.model.frames[self.frame_id(link)].parentJoint)

    def placement(self, link: str) -> SE3:
        """T_joint_link: where a link is fixed on the joint it moves with."""
        return se3_from_pin(self.model.frames[self.frame_id(link)].placement)

    def link_pose(self, joint_positions: FloatArray, link: str) -> SE3:
        """T_world_link at joint positions in description order."""
        pin.forwardKinematics(self.model, self.data, self.configuration(joint_positions))
        return se3_from_pin(pin.updateFramePlacement(self.model, self.data, self.frame_id(link)))


@lru_cache(maxsize=4)
def _pinocchio_model(urdf: str) -> pin.Model:
    """The model of a URDF, made once and not changed."""
    return pin.buildModelFromXML(urdf)


class GroupSpace:
    """A planning group's joints, the rest of the robot held where it is.

    Whole-robot positions are `offset + matrix @ group positions`: mimic joints of the group's
    joints follow, all others stay at `reference`.

    Attributes:
        joint_names: The joint names of the group, in its order.
        lower: Position limits, shape (dof,); -inf for continuous joints.
        upper: The upper position limits, shape (dof,).
        velocity: The velocity limits, shape (dof,).
        acceleration: The acceleration limits, shape (dof,).
        metric: Weights of joint-space distances, shape (dof,).
        leverage: Share of the arm's reach that each joint moves, 0.1 to 1, shape (dof,).
        wraps: Whether a whole turn brings each joint to the same place, shape (dof,).
    """

    def __init__(self, robot: RobotModel, group: str, reference: FloatArray) -> None:
        description = robot.description
        self.robot = robot
        self.group = group
        self.joint_names = description.groups[group].joint_names
        self.task_space = description.task_space(group)
        joints = [description.joint_by_name[name] for name in self.joint_names]
        self.lower: FloatArray = np.array([joint.lower for joint in joints], dtype=float)
        self.upper: FloatArray = np.array([joint.upper for joint in joints], dtype=float)
        self.velocity: FloatArray = np.array([joint.velocity for joint in joints], dtype=float)
        self.acceleration: FloatArray = np.array([joint.acceleration for joint in joints], float)
        self.wraps: BoolArray = np.array([joint.kind != "prismatic" for joint in joints], bool)
        self.metric: FloatArray = np.where(self.wraps, 1.0, METRES_TO_RADIANS)
        self.leverage: FloatArray = _leverage(description, self.joint_names)
        self.indices = list(description.group_indices(group))
        self.offset, self.matrix = self._embedding(np.asarray(reference, dtype=float))
        self._at_rest = robot.configuration(self.offset)
        self._drive = np.zeros((robot.model.nv, len(self.indices)))
        self._drive[robot.velocity_columns] = self.matrix
        self._has_followers = bool(np.delete(self.matrix, self.indices, axis=0).any())
        self._rows, self._columns = robot.rows[self.indices], robot.velocity_columns[self.indices]
        self._circular = np.flatnonzero(robot.is_circular[self.indices])

    def _embedding(self, reference: FloatArray) -> tuple[FloatArray, FloatArray]:
        description = self.robot.description
        offset = np.array(reference, dtype=float)
        matrix = np.zeros((len(offset), len(self.indices)))
        offset[self.indices] = 0.0
        matrix[self.indices, np.arange(len(self.indices))] = 1.0
        for index, joint in enumerate(description.movable_joints):
            if joint.mimic is not None and joint.mimic.joint in self.joint_names:
                column = self.joint_names.index(joint.mimic.joint)
                offset[index] = joint.mimic.offset
                matrix[index, column] = joint.mimic.multiplier
        return offset, matrix

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.indices)

    def whole(self, positions: FloatArray) -> FloatArray:
        """Description-order positions of group positions, shape (n,), or (N, n) for (N, dof)."""
        return self.offset + np.asarray(positions) @ self.matrix.T

    def configuration(self, positions: FloatArray) -> FloatArray:
        """Pinocchio's configuration of the whole robot at group positions, shape (nq,)."""
        if self._has_followers:
            return self.robot.configuration(self.whole(positions))
        configuration = self._at_rest.copy()
        configuration[self._rows] = positions
        if len(self._circular):
            angles, cosines = positions[self._circular], self._rows[self._circular]
            configuration[cosines], configuration[cosines + 1] = np.cos(angles), np.sin(angles)
        return configuration

    def jacobian(self, whole: FloatArray) -> FloatArray:
        """A Jacobian by group positions from Pinocchio's, shape (m, dof) from (m, nv)."""
        return whole @ self._drive if self._has_followers else whole.take(self._columns, axis=1)

    def part(self, joint_positions: FloatArray) -> FloatArray:
        """Group positions of description-order positions, shape (dof,)."""
        return np.asarray(joint_positions, dtype=float)[self.indices]

    def distance(self, first: FloatArray, second: FloatArray) -> float:
        """Joint-space distance, metres weighted [rad]."""
        away = (second - first) * self.metric
        return math.sqrt(away.dot(away))

    def effort(self, first: FloatArray, second: FloatArray) -> float:
        """How much of the arm moves: turns weighted by the reach distal to each joint."""
        return float(np.linalg.norm((second - first) * self.metric * self.leverage))


@lru_cache(maxsize=16)
def _leverage(description: RobotDescription, joint_names: tuple[str, ...]) -> FloatArray:
    """Length of the chain distal to each joint over the longest: a wrist's turn counts less."""
    last = description.joint_by_name[joint_names[-1]].child
    tips = [group.tip_link for group in description.groups.values() if group.tip_link]
    chains = [joints_to(tip, description.joints)[::-1] for tip in (*tips, last)]
    names = {*joint_names}
    chains = [chain for chain in chains if names <= {joint.name for joint in chain}]
    if not chains:
        return np.ones(len(joint_names))
    chain = max(chains, key=len)
    lengths = [float(np.linalg.norm(joint.pose.translation)) for joint in chain]
    distal = {joint.name: sum(lengths[:index]) for index, joint in enumerate(chain)}
    reach = np.array([distal[name] for name in joint_names])
    return np.maximum(reach / max(float(reach.max()), 1e-9), 0.1)
