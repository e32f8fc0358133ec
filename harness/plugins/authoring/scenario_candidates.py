"""Numbers of a first scenario: where a box is picked, where the arm starts and moves to."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from harness.cell.approach import approach_axis
from harness.core.pose_arrays import rotations_of
from harness.core.types import FloatArray
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.authoring.robot_findings import moving_mass
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper
from harness.robot.random_positions import sample_robot_positions

SAMPLES = 5000  # Random configurations that measure the reach

DISTANCES, HEIGHTS = (0.25, 0.35, 0.45, 0.55, 0.65), (0.03, 0.1, 0.2, 0.35, 0.5)
"""Distances from the base and heights above it where the box is tried, as shares of the reach."""

NEAR = 0.08  # Distance up to which a random configuration shows that a place is reached, likewise
DOWNWARD = math.radians(10)  # [rad], of a gripper from the vertical that points downward, roughly
MOST_PLACES = 6  # Places of the box that are tried in a direction
CLEAR = 0.25  # Distance of the box from the hand at the start, as a share of the reach

HEADINGS = (0.0, 0.5 * math.pi)
SHORTEST_APPROACH = 0.03  # [m]
LEAST_LIFT = 0.6  # Shortest lift as a share of the longest; half of it is expected
WIDEST_BOX, TALLEST_BOX = 0.05, 0.08  # [m]
JAW_TURN = 0.35  # [rad], of a single jaw at the box's width; more, and it presses down
HEAVIEST_BOX, LIGHTEST_BOX = 0.1, 0.01  # [kg]
GRIP_SHARE = 0.1  # of what the friction of both fingers carries; a heavier box creeps down
ARM_SHARE, ARM_LEAST = 0.05, 0.03
"""Weight of the box as a share of the moving mass of the robot, but at least this [kg]: a light
arm holds a light box still, and the lightest boxes turn when fingers push them."""
SLIDING = 0.3  # friction of a box that a jaw pushes to the palm; with more it jams on the stand
GRAVITY = 9.81  # [m/s^2]
GAP_STEP = 1e-3  # [m], of the gap between pads over which a transmission is measured
MOTIONS = 10  # random joint goals of a generated test

MARGIN = 0.02  # Distance of joint goals from the limits, as a share of the range
DIGITS = 4  # Decimals of joint positions in the file
PADDING = 0.002  # Distance of bodies at the start [m], as planning keeps by default
FLOOR_CLEARANCE = 0.05  # [m], of the lowest moving link at the start, at least

STAND = """\
  - name: stand
    static: true
    pose: {{xyz: [{x:.4g}, {y:.4g}, {middle:.4g}]}}
    box: {{size: [{side:.4g}, {side:.4g}, {top:.4g}]}}
    color: [0.72, 0.53, 0.34, 1]
"""


class Candidates:
    """What fills the templates, the likeliest first."""

    def __init__(self, description: RobotDescription) -> None:
        self._description = description
        self._kinematics = PinocchioKinematics(description)
        self._scene = CoalScene(description)
        self._samples = sample_robot_positions(description, SAMPLES, np.random.default_rng(0))
        poses = self._kinematics.link_poses(self._samples, (_arm_base(description),))[:, 0]
        self._tcps = self._kinematics.link_poses(self._samples, (description.tcp_link,))[:, 0]
        self._away = self._tcps[:, :3] - poses[:, :3]
        self._reach = float(np.linalg.norm(self._away, axis=1).max())
        self._start = self._free_start()
        self._arm = self._kinematics.link_pose(self._start, _arm_base(description)).translation
        self._base = self._base_height()

    def start_state(self) -> str:
        """The line of the scenario's robot with its start, where the robot's own is not free."""
        if np.array_equal(self._start, self._description.start_positions()):
            return ""
        joints = [joint for joint in self._description.movable_joints if joint.mimic is None]
        names = tuple(joint.name for joint in joints)
        return f"\n  start_state: {{joints: {self._positions(names, self._start)}}}"

    def picks(self) -> Iterator[dict[str, str]]:
        """A box on a stand, then one on the floor; none without an arm's gripper."""
        description = self._description
        if description.gripper is None or not description.arm_group:
            return
        hand = self._kinematics.link_pose(self._start, description.tcp_link).translation
        floor = -(self._base + self._arm[2]) / self._reach
        for heights in (HEIGHTS, (floor,)):
            places = self._places(description.gripper, heights)[:MOST_PLACES]
            for heading, (distance, height) in product(HEADINGS, places):
                level = distance * self._reach
                away = level * math.cos(heading), level * math.sin(heading), height * self._reach
                place = np.round(self._arm + away, 2)
                if np.linalg.norm(place - hand) > CLEAR * self._reach:
                    yield self._pick(place, description.gripper)

    def _pick(self, place: FloatArray, gripper: Gripper) -> dict[str, str]:
        """What fills the template: a box of a size and weight that the gripper can hold."""
        x, y, top = float(place[0]), float(place[1]), self._base + float(place[2])
        width, travel = self._box_width(gripper), _travel(self._reach)
        height, friction = min(TALLEST_BOX, 2.0 * width), SLIDING if gripper.has_single_jaw else 1.0
        carried = 2.0 * friction * _grip_force(gripper, width) / GRAVITY
        light = max(ARM_SHARE * moving_mass(self._description), ARM_LEAST)
        numbers = {
            "base": self._base,
            "x": x,
            "y": y,
            "box_middle": top + height / 2,
            "width": width,
            "height": height,
            "mass": max(
                min(HEAVIEST_BOX, round(min(GRIP_SHARE * carried, light), 2)), LIGHTEST_BOX
            ),
            "friction": friction,
            "least": min(SHORTEST_APPROACH, travel),
            "travel": travel,
            "least_lift": LEAST_LIFT * travel,
            "above": travel / 2,
        }
        side = round(min(0.2, 0.25 * self._reach), 2)
        stand = STAND.format(x=x, y=y, middle=top / 2, side=side, top=top) if top > 0 else ""
        words = {
            "stand": stand,
            "support": "a stand" if stand else "the floor",
            "standing_on": "stand" if stand else "ground_plane",
        }
        return words | {key: f"{value + 0.0:.4g}" for key, value in numbers.items()}

    def _box_width(self, gripper: Gripper) -> float:
        """Width of a box that the gripper can hold, in whole millimetres [m]."""
        opened, closed = gripper.open_position, gripper.closed_position
        least, opening = gripper.gap_at(np.array([closed, opened])).tolist()
        width = min(WIDEST_BOX, max(0.6 * opening, 0.5 * (least + opening)))
        turns = self._description.joint_by_name[gripper.joint].kind != "prismatic"
        if gripper.has_single_jaw and turns:
            turned = closed + math.copysign(JAW_TURN, opened - closed)
            width = min(width, float(gripper.gap_at(turned)))
        return math.floor(1e3 * width) / 1e3

    def _places(self, gripper: Gripper, heights: Sequence[float]) -> list[tuple[float, float]]:
        """Distances, and some heights, that most random configurations reach, the most first.

        An arm of six joints takes a box from above, so the more its gripper points downward there,
        the more a configuration counts; likewise above the place, where the approach starts.
        """
        description = self._description
        away = self._away / self._reach
        opened = self._start.copy()
        opened[description.joint_index[gripper.joint]] = gripper.open_position
        opened = description.with_mimics(opened)
        axis = approach_axis(description, self._kinematics, self._scene, opened)
        cosine = -(rotations_of(self._tcps[:, 3:]) @ axis)[:, 2] / np.linalg.norm(axis)
        weights = np.exp(-((np.arccos(np.clip(cosine, -1.0, 1.0)) / DOWNWARD) ** 2))
        if not description.task_space(description.arm_group).holds_pose:
            weights[:] = 1.0
        reached = np.column_stack([np.hypot(away[:, 0], away[:, 1]), away[:, 2]])

        def weight(*place: float) -> float:
            return float(weights[np.abs(reached - place).max(axis=1) < NEAR].sum())

        above = _travel(self._reach) / self._reach
        grid = [(distance, height) for height in heights for distance in DISTANCES]
        counts = [min(weight(*place), weight(place[0], place[1] + above)) for place in grid]
        order = np.argsort(np.negative(counts), kind="stable")
        return [grid[number] for number in order if counts[number] > 0]

    def motions(self) -> Iterator[dict[str, str]]:
        """Goals of the arm between its start and random configurations, inside the limits."""
        description = self._description
        group = description.groups.get(description.arm_group)
        names = () if group is None else group.joint_names
        for row in self._samples[:MOTIONS]:
            goal = self._inside(self._start + 0.4 * (row - self._start))
            yield {
                "base": f"{self._base:g}",
                "goal": self._positions(names, goal),
                "start": self._positions(names, self._inside(self._start)),
            }

    def _free_start(self) -> FloatArray:
        """Where the robot starts, if it touches nothing there, with its gripper open too.

        Else the middle of the ranges, or the free random configuration next to it.
        """
        start = self._description.start_positions()
        joints = self._description.movable_joints
        ends = np.array([[joint.lower, joint.upper] for joint in joints])
        middle = np.where(np.isfinite(ends).all(axis=1, keepdims=True), ends, 0.0).mean(axis=1)
        near = np.argsort(np.linalg.norm(self._samples - middle, axis=1), kind="stable")
        for row in (start, middle, *self._samples[near]):
            positions = start if row is start else np.round(self._inside(row), DIGITS)
            positions = self._description.with_mimics(positions)
            if not any(self._scene.touches(each, PADDING) for each in self._with_hand(positions)):
                return positions
        return start

    def _with_hand(self, positions: FloatArray) -> list[FloatArray]:
        """The positions, and those with the gripper open."""
        gripper = self._description.gripper
        if gripper is None:
            return [positions]
        opened = positions.copy()
        opened[self._description.joint_index[gripper.joint]] = gripper.open_position
        return [positions, self._description.with_mimics(opened)]

    def _inside(self, positions: FloatArray) -> FloatArray:
        """Positions away from the limits by MARGIN, so that rounded ones are inside too."""
        joints = self._description.movable_joints
        lower = np.array([joint.lower for joint in joints])
        upper = np.array([joint.upper for joint in joints])
        size = np.where(np.isfinite(upper - lower), upper - lower, 0.0)
        return np.clip(positions, lower + MARGIN * size, upper - MARGIN * size)

    def _positions(self, names: tuple[str, ...], positions: FloatArray) -> str:
        index = self._description.joint_index
        values = (f"{name}: {positions[index[name]]:.{DIGITS}f}" for name in names)
        return "{" + ", ".join(values) + "}"

    def _base_height(self) -> float:
        """Height of the base at which the arm starts clear of the floor [m]."""
        description = self._description
        lowest = min(
            float(pose.apply(self._scene.corners(link))[:, 2].min())
            for link in description.link_names
            if link not in description.static_links
            for pose in [self._kinematics.link_pose(self._start, link)]
        )
        return 0.0 if lowest > 0 else math.ceil(10 * (FLOOR_CLEARANCE - lowest)) / 10


def _arm_base(description: RobotDescription) -> str:
    """The link that carries the arm, which can stand far from the robot's root."""
    if not description.arm_group:
        return description.base_link
    first = description.groups[description.arm_group].joint_names[0]
    return description.joint_by_name[first].parent


def _grip_force(gripper: Gripper, width: float) -> float:
    """Force with which each finger presses on a width, by virtual work [N]."""
    positions, gaps = gripper.widths.T
    order = np.argsort(gaps)
    at = np.interp([width, width + GAP_STEP], gaps[order], positions[order])
    return gripper.grip_effort * abs(float(at[1] - at[0])) / GAP_STEP


def _travel(reach: float) -> float:
    """Length of the approach and of the lift of an arm with a reach [m]."""
    return round(min(0.1, 0.1 * reach), 2)
