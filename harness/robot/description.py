"""The robot as plain data: URDF, SRDF and robot.yaml combined, with its gripper.

The planner (Pinocchio, from `urdf`) and the physics (MuJoCo, from `links` and `joints`, in doubles)
are built from the same description, and a run stores it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from harness.core.amounts import JointUnits
from harness.core.camera import Camera
from harness.core.kinematics import LinkPoses
from harness.core.types import FloatArray
from harness.core.wrench_sensor import WrenchSensor
from harness.robot.end_effector import Gripper
from harness.robot.mechanism import Mechanism
from harness.robot.task_space import TaskSpace, mechanism_rank

ALL_ARMS = "arms"
"""Name of the planning group of the joints of all arms, of a robot with several."""

RENAMED_ROOT = "robot_world"
"""New name of a root link that is named `world` in the robot's file."""

CLOSING_SPEED = 0.075
"""Rate at which the pad gap changes [m/s]; RH-P12-RN(A) specification table, ROBOTIS e-manual."""

VELOCITY_SHARE = 0.8
"""Share of a gripper's velocity limit that is commanded at most: fingers bounce when they meet."""


@dataclass(frozen=True)
class PlanningGroup:
    """An SRDF group.

    Attributes:
        joint_names: Its active joints (movable, not mimic, not passive), from base to tip.
        base_link: First link of a chain group, else the common ancestor.
        tip_link: Last link of a chain group, which pose goals place; empty for joint groups.
    """

    name: str
    joint_names: tuple[str, ...]
    base_link: str = ""
    tip_link: str = ""


@dataclass(frozen=True)
class NamedState:
    """An SRDF group_state: `positions` by joint name."""

    name: str
    group: str
    positions: Mapping[str, float]


@dataclass(frozen=True)
class TrackingTolerances:
    """Tolerances of a JointTrajectoryController for every joint [rad or m]."""

    trajectory: float = 0.2
    goal: float = 0.01
    goal_time: float = 1.0


@dataclass(frozen=True, eq=False)
class Arm:
    """One of several arms of a robot; its name is that of its planning group.

    Attributes:
        name: The name of its planning group.
        tcp_link: The link whose pose is the arm's TCP.
        base_link: The first link of the arm.
        gripper: Its gripper; None for an arm without one.
        controllers: Names of its ROS 2 controllers, as in `RobotDescription`.
        controller_tolerances: Tolerances of its ROS 2 controllers; None where they have none.
        robot_joints: The movable joints of its robot, in a cell of several robots.
    """

    name: str
    tcp_link: str
    base_link: str
    gripper: Gripper | None = None
    controllers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    controller_tolerances: TrackingTolerances | None = None
    robot_joints: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class RobotDescription(Mechanism):
    """A composed robot: arm, gripper if any, base fixed in the world.

    Attributes:
        name: Name for users (`ur3e`, or `ur3e + rh_p12_rn_a`).
        urdf: The composed URDF; its root link is `world`, so poses are in world coordinates.
        srdf: The text of the composed SRDF.
        groups: Groups by name; the arm's group is `arm_group`.
        named_states: The states of all groups.
        allowed_collisions: Link pairs (sorted tuples) that are not checked, with the reason.
        arm_group: Default group of motion steps; empty for a gripper without an arm.
        gripper: The gripper; None for a robot without one.
        tcp_link: The link whose pose is "the TCP".
        base_link: First link of the arm.
        start_state: Joint positions by name at the start of a run.
        cameras: Cameras on links, by name.
        wrench_sensors: Sensors of force and torque between links, by name.
        tracking: Tolerances of the scenario's own motions.
        controller_tolerances: Tolerances of its ROS 2 controllers for trajectories of nodes; None
            where their file has none.
        ik_solver: A plug-in of the kind `ik_solver`, such as `ur`, `open_manipulator_x` or
            `numeric`; or `auto`: the first of these that fits.
        position_only_groups: Groups whose pose goals fix the position alone, as with MoveIt's
            `position_only_ik`.
        controllers: Names of its ROS 2 controllers, of `arm` and `gripper`; MoveIt's by default.
        joint_controller: A plug-in of the kind `controller`, which moves the joints in the physics.
        notes: Notes on ignored elements and assumptions.
        rejected_grippers: Why parts that look like grippers are none, a sentence each.
        arms: The arms of a robot that has several; `arm_group`, `gripper`, `tcp_link` and
            `base_link` are those of the selected arm, or of the first where none is. A run records
            the TCP of the first.
        default_arm: The name of the arm that is selected where none is named; empty where there is
            no such arm.
        selected_arm: The name of the arm that `of_arm` selected; empty for the whole robot.
    """

    name: str
    urdf: str
    srdf: str
    groups: Mapping[str, PlanningGroup]
    named_states: tuple[NamedState, ...]
    allowed_collisions: Mapping[tuple[str, str], str]
    arm_group: str
    gripper: Gripper | None
    tcp_link: str
    base_link: str
    start_state: Mapping[str, float]
    cameras: Mapping[str, Camera] = field(default_factory=dict)
    wrench_sensors: Mapping[str, WrenchSensor] = field(default_factory=dict)
    tracking: TrackingTolerances = field(default_factory=TrackingTolerances)
    controller_tolerances: TrackingTolerances | None = None
    ik_solver: str = "numeric"
    position_only_groups: frozenset[str] = frozenset()
    controllers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    joint_controller: str = "position_servo"
    notes: tuple[str, ...] = ()
    rejected_grippers: tuple[str, ...] = ()
    arms: tuple[Arm, ...] = ()
    default_arm: str = ""
    selected_arm: str = ""

    @property
    def joint_units(self) -> JointUnits:
        """The units of its joint positions; of the gripper of the selected arm."""
        units: dict[str, str] = {joint.name: joint.position_unit for joint in self.movable_joints}
        return JointUnits(units, units.get(self.gripper.joint, "") if self.gripper else "")

    @cached_property
    def static_link_poses(self) -> Mapping[str, FloatArray]:
        """T_world_link of `static_links` (xyz, quat wxyz), shape (7,) each, `world` included."""
        poses = LinkPoses(self.joints, self.start_positions(), self.static_links)
        return {name: poses.rows(name)[0] for name in poses.rotations if name in self.static_links}

    @property
    def grippers(self) -> tuple[Gripper, ...]:
        """Every gripper of the robot."""
        if not self.arms:
            return () if self.gripper is None else (self.gripper,)
        return tuple(arm.gripper for arm in self.arms if arm.gripper is not None)

    def closing_speed(self, gripper: Gripper) -> float:
        """Speed of a gripper's joint that changes its gap at CLOSING_SPEED, within its limit."""
        limit = VELOCITY_SHARE * self.joint_by_name[gripper.joint].velocity
        positions, gaps = gripper.widths[:, 0], gripper.widths[:, 1]
        if len(positions) < 2:
            return min(limit, abs(gripper.closed_position - gripper.open_position))
        steepest = float(np.abs(np.diff(gaps) / np.diff(positions)).max())
        return min(limit, CLOSING_SPEED / steepest)

    @cached_property
    def of_arm(self) -> Mapping[str, RobotDescription]:
        """The same robot with each of its arms selected, by the arm's name."""
        return {
            arm.name: replace(
                self,
                arm_group=arm.name,
                gripper=arm.gripper,
                tcp_link=arm.tcp_link,
                base_link=arm.base_link,
                controllers=arm.controllers,
                controller_tolerances=arm.controller_tolerances,
                selected_arm=arm.name,
            )
            for arm in self.arms
        }

    @cached_property
    def arm_of_link(self) -> Mapping[str, str]:
        """The arm that each link belongs to, of a robot with several; links of no arm are left out.

        A link belongs to the arm that moves it last, or whose base carries it.
        """
        groups = {arm.name: set(self.group_joints(arm.name)) for arm in self.arms}
        bases = [arm.base_link for arm in self.arms]
        of_base = {arm.base_link: arm.name for arm in self.arms if bases.count(arm.base_link) == 1}
        found: dict[str, str] = {}
        for joint in self.joints:  # parents before children
            movers = [arm for arm, names in groups.items() if joint.name in names]
            default = of_base.get(joint.child, found.get(joint.parent, ""))
            found[joint.child] = movers[0] if len(movers) == 1 else "" if movers else default
        return {link: arm for link, arm in found.items() if arm}

    @property
    def controller_names(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the controllers of the selected arm and gripper, of those that there are."""
        groups = {"arm": self.arm_group, "gripper": self.gripper.group if self.gripper else ""}
        return {
            kind: self.controllers.get(kind, (f"{group}_controller",))
            for kind, group in groups.items()
            if group
        }

    @property
    def is_cell(self) -> bool:
        """Whether it is made of the robots of `robots`."""
        return any(arm.robot_joints for arm in self.arms)

    @property
    def recorded_tcp(self) -> str:
        """The link whose pose a run records as the TCP's."""
        return self.arms[0].tcp_link if self.arms else self.tcp_link

    @property
    def needs_arm(self) -> bool:
        """Whether the robot has several arms, and none of them is selected."""
        return bool(self.arms) and not self.selected_arm

    def arm_of_group(self, group: str) -> str:
        """The name of the arm that has all joints of a group; empty where none has."""
        names = set(self.group_joints(group))
        for arm in self.arms:
            own = set(self.group_joints(arm.name))
            if arm.gripper is not None:
                own |= {*self.group_joints(arm.gripper.group), arm.gripper.joint}
            if names and names <= own:
                return arm.name
        return ""

    @property
    def default_group(self) -> str:
        """Default group of steps: the arm, else the gripper."""
        return self.arm_group or (self.gripper.group if self.gripper else "")

    @property
    def arm_joints(self) -> tuple[str, ...]:
        """Joints of the arm, or of all arms; every movable joint of a gripper alone."""
        arms = [arm.name for arm in self.arms] if self.needs_arm else [self.arm_group]
        joints = tuple(joint for arm in arms for joint in self.group_joints(arm))
        return joints or self.joint_names

    def group_joints(self, group: str) -> tuple[str, ...]:
        """Joints of a group, from base to tip; none where there is no such group."""
        return self.groups[group].joint_names if group in self.groups else ()

    def task_space(self, group: str) -> TaskSpace:
        """The parts of the pose of a group's tip that its joints can hold, by the mechanism.

        A group without a tip holds what as many joints of an arm would.
        """
        if group not in self._task_spaces:
            moving, tip, rank = self.group_indices(group), self.groups[group].tip_link, None
            if tip and moving:
                limits = np.array([(each.lower, each.upper) for each in self.movable_joints]).T
                rank = mechanism_rank(self._poses_at, limits, np.array(moving), tip)
            self._task_spaces[group] = TaskSpace.of_joints(len(moving), rank)
        return self._task_spaces[group]

    def _poses_at(self, joint_positions: FloatArray) -> LinkPoses:
        return LinkPoses(self.joints, np.array([self.with_mimics(row) for row in joint_positions]))

    @cached_property
    def _task_spaces(self) -> dict[str, TaskSpace]:
        return {}

    def group_indices(self, group: str) -> tuple[int, ...]:
        """Indices of a group's joints in description order."""
        return tuple(self.joint_index[name] for name in self.groups[group].joint_names)

    def states_of(self, group: str) -> Mapping[str, NamedState]:
        """Named states of a group, by name."""
        return {state.name: state for state in self.named_states if state.group == group}

    def start_positions(self, placed: Mapping[str, float] | None = None) -> FloatArray:
        """`start_state` in description order, mimic joints consistent, missing joints at zero.

        Args:
            placed: Positions of joints that are elsewhere, by name.
        """
        named = {**self.start_state, **(placed or {})}
        return self.with_mimics(np.array([named.get(name, 0.0) for name in self.joint_names]))
