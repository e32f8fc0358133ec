"""Kinematics of the chain that carries a link: pose, Jacobian and reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.errors import RobotError
from harness.core.kinematics import LinkPoses
from harness.core.pose_arrays import times_each
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint
from harness.robot.tree import joints_to

HOME = "home"  # named state that counterexamples shrink towards, if the arm has it


@dataclass(frozen=True, eq=False)
class Chain:
    """A planning group's joints from the world to a link; other joints are at their start position.

    Attributes:
        link: The link at the chain's end.
        joint_names: Joints of the group, from base to tip.
        lower: Smallest positions to draw, shape (dof,) [rad or m]: the joint's limit; -pi for a
            continuous joint, which has none.
        upper: Largest positions to draw, likewise.
        is_turning: False for prismatic joints, shape (dof,).
        home: Named state `home`, or the start positions of runs, shape (dof,).
        way: All joints between the world and the link, fixed ones included.
        before: Pose of each joint's frame at zero in the previous joint's frame.
        axes: Axes of the joints in their frames, shape (dof, 3).
        tip: Pose of the link in the last joint's frame.
    """

    description: RobotDescription
    link: str
    joint_names: tuple[str, ...]
    lower: FloatArray
    upper: FloatArray
    is_turning: BoolArray
    home: FloatArray
    way: tuple[Joint, ...]
    before: tuple[SE3, ...]
    axes: FloatArray
    tip: SE3

    @classmethod
    def of(cls, description: RobotDescription, group: str = "", link: str = "") -> Chain:
        """The chain of a group; by default the arm's, up to its TCP.

        Raises:
            RobotError: The group or link is unknown, or the group does not carry the link.
        """
        group, link = group or description.arm_group, link or description.tcp_link
        if not group:
            raise RobotError(f"'{description.name}' has no arm")
        if group not in description.groups:
            raise RobotError(f"no group '{group}'; groups: {', '.join(description.groups)}")
        if link not in description.link_names:
            raise RobotError(f"no link '{link}'; links: {', '.join(description.link_names)}")
        names = description.groups[group].joint_names
        start = description.start_positions()
        before: list[SE3] = []
        pose = SE3.identity()
        way = joints_to(link, description.joints)
        for joint in way:
            if joint.name in names:
                before.append(pose @ joint.pose)
                pose = SE3.identity()
            elif joint.is_movable:
                if joint.mimic is not None and joint.mimic.joint in names:
                    raise RobotError(f"'{link}' moves with '{joint.name}', which mimics a joint")
                pose = pose @ joint.at(float(start[description.joint_index[joint.name]]))
            else:
                pose = pose @ joint.pose
        if len(before) < len(names) or not names:
            raise RobotError(f"the joints of group '{group}' do not all carry '{link}'")
        joints = [description.joint_by_name[name] for name in names]
        widest = [np.pi if each.kind == "continuous" else np.inf for each in joints]
        states = description.states_of(group)
        home = states[HOME].positions if HOME in states else {}
        return cls(
            description,
            link,
            names,
            np.array([max(j.lower, -most) for j, most in zip(joints, widest, strict=True)]),
            np.array([min(j.upper, most) for j, most in zip(joints, widest, strict=True)]),
            np.array([joint.kind != "prismatic" for joint in joints]),
            np.array([home.get(n, start[description.joint_index[n]]) for n in names]),
            tuple(way),
            tuple(before),
            np.array([joint.axis for joint in joints]),
            pose,
        )

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @property
    def limits(self) -> FloatArray:
        """Position limits, shape (2, dof) [rad or m]; infinite for a continuous joint."""
        joints = [self.description.joint_by_name[name] for name in self.joint_names]
        return np.array([[each.lower, each.upper] for each in joints]).T

    def link_pose(self, joint_positions: FloatArray) -> SE3:
        """T_world_link at the group's positions, shape (dof,)."""
        return self._poses(np.asarray(joint_positions, float)[None]).at(0)[self.link]

    def jacobians(self, samples: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Jacobians in world axes at (N, dof) positions, and R_world_link.

        Returns:
            Rows of [m, rad] per joint, shape (N, 6, dof); rotations, shape (N, 3, 3).
        """
        poses = self._poses(np.asarray(samples, dtype=float))
        tips = poses.translations[self.link]
        columns: list[FloatArray] = []
        for name, is_turning in zip(self.joint_names, self.is_turning, strict=True):
            joint = self.description.joint_by_name[name]
            axes = times_each(poses.rotations[joint.child], joint.axis)
            arms = tips - poses.translations[joint.child]
            linear = np.cross(axes, arms) if is_turning else axes
            columns.append(np.hstack([linear, axes if is_turning else np.zeros_like(axes)]))
        return np.stack(columns, axis=2), poses.rotations[self.link]

    def whole(self, joint_positions: FloatArray) -> FloatArray:
        """Positions of the whole robot in description order; other joints are at their start."""
        placed = zip(self.joint_names, map(float, joint_positions), strict=True)
        return self.description.start_positions(dict(placed))

    def farthest(self) -> tuple[FloatArray, float]:
        """A sphere that the last joint's frame cannot leave: centre (3,) and radius [m].

        The centre is the origin of the last joint that no previous joint moves. From there on the
        link lengths add up at most (triangle inequality), whatever the limits.
        """
        pivot, pose = 0, self.before[0]
        while pivot + 1 < self.dof and self._stays(pivot):
            pose = pose @ self.before[pivot + 1]
            pivot += 1
        later = range(pivot + 1, self.dof)
        radius = sum(float(np.linalg.norm(self.before[index].translation)) for index in later)
        for index in range(pivot, self.dof):
            if not self.is_turning[index]:
                radius += float(max(abs(self.lower[index]), abs(self.upper[index])))
        return pose.translation, radius

    def _stays(self, index: int) -> bool:
        """Whether the next joint's origin lies on this joint's axis, so that rotation keeps it."""
        away = np.cross(self.axes[index], self.before[index + 1].translation)
        return bool(self.is_turning[index]) and float(np.linalg.norm(away)) < 1e-9

    def _poses(self, samples: FloatArray) -> LinkPoses:
        """The poses of the chain's links at positions (N, dof)."""
        whole = np.tile(self.description.start_positions(), (len(samples), 1))
        whole[:, [self.description.joint_index[name] for name in self.joint_names]] = samples
        return LinkPoses(self.description.joints, whole, [self.link])
