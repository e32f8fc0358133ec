"""A planning problem, and what every motion is held to: measured on what would be commanded."""

from functools import cache
from itertools import pairwise

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.planning.collision.checker import MARGIN_SLACK, TOUCHING
from harness.planning.verification.verify import EFFORT_TOLERANCE, FINAL_RESOLUTION, LIMIT_TOLERANCE
from harness.ports.goals import PoseGoal
from harness.ports.motion_planning import MotionPlan, MotionRequest, PlanningOptions
from tests.planning.lesson import Cell, at, open_manipulator, thing, ur

SCALING = 0.4
OPTIONS = PlanningOptions(
    velocity_scaling=SCALING,
    acceleration_scaling=SCALING,
    max_state_checks=5_000,
    padding=0.002,  # as scenarios have it when they say nothing
)
FINE = FINAL_RESOLUTION / 3  # [rad]
ROUNDING = 1e-6  # [m] of the distance between two shapes that touch

UR_BENT = (-0.86, -1.5, 1.6, -1.7, -1.57, -1.6)  # the gripper points down, in front of the arm
HOMES = {"ur3e": UR_BENT, "ur5e": UR_BENT, "open_manipulator_x": (0.0, -1.05, 0.35, 0.7)}
LAWFUL = (
    "NO_IK_SOLUTION",
    "GOAL_IN_COLLISION",
    "PLANNING_FAILED",
    "INVALID_MOTION_PLAN",
    "START_STATE_IN_COLLISION",
    "GOAL_VIOLATES_PATH_CONSTRAINTS",
)
"""How planning may fail on a random problem, which may have no solution."""


@cache
def description_of(model):
    return open_manipulator() if model == "open_manipulator_x" else ur(model)


class Problem:
    """An arm near its home on the lesson's tables, and boxes (size, xyz before the base)."""

    def __init__(self, model, off, boxes=()) -> None:
        self.cell = Cell(description_of(model))
        for number, (size, place) in enumerate(boxes):
            pose = at(0, 0, 1.02) @ at(*place)
            self.cell.add(thing(f"box {number}", pose, Shape(Box(tuple(size)))))
        description = self.cell.description
        self.group, self.link = description.arm_group, description.tcp_link
        names = description.groups[self.group].joint_names
        self.joints = [description.joint_by_name[name] for name in names]
        self.home = np.array(HOMES[model])
        self.start = self.from_home(off)
        self.cell.state = self.cell.with_arm(self.start)

    def from_home(self, off):
        """Positions inside the limits, some way from home."""
        lower, upper = np.array([(joint.lower, joint.upper) for joint in self.joints]).T
        return np.clip(self.home + off[: len(self.home)], lower + 0.01, upper - 0.01)

    def pose(self, positions) -> SE3:
        """T_world_link, by Pinocchio."""
        return self.cell.kinematics.link_pose(self.cell.with_arm(positions), self.link)

    def poses(self, plan) -> list[SE3]:
        """Of the link at every sample."""
        return [self.pose(positions) for positions in plan.trajectory.positions]

    def moved(self, shift, turn=(0, 0, 0)) -> PoseGoal:
        """The link's pose at the start, moved and turned in the world's axes."""
        here = self.pose(self.start)
        rotation = pin.exp3(np.array(turn, dtype=float)) @ here.rotation
        return PoseGoal(self.link, SE3(rotation, here.translation + np.array(shift)))

    def block(self, goal, size) -> None:
        """Put a cube where the straight way to joint positions has the link halfway."""
        middle = self.pose(0.5 * (self.start + goal)).translation
        self.cell.add(thing("block", at(*middle), Shape(Box((size, size, size)))))

    def plan(self, motion, options=OPTIONS) -> MotionPlan | None:
        """A plan that keeps what every plan must; None when it failed as planning may."""
        try:
            request = MotionRequest(self.group, self.cell.state, motion, options)
            plan = self.cell.planner.plan(request)
        except PlanningFailed as failure:
            if failure.code not in LAWFUL or not failure.message:
                raise
            return None
        self._check_ends(plan.trajectory)
        self._check_limits(plan.trajectory)
        self._check_efforts(plan.trajectory)
        self._check_free(plan.trajectory.positions)
        return plan

    def _check_ends(self, trajectory) -> None:
        """From where the arm stands, from rest to rest, the stamps rising."""
        assert np.abs(trajectory.positions[0] - self.start).max() < 1e-9
        assert not trajectory.velocities[[0, -1]].any()
        assert trajectory.times[0] == 0
        assert np.all(np.diff(trajectory.times) > 0)

    def _check_limits(self, trajectory) -> None:
        """Of positions, and the scaled ones of speeds and accelerations, differences included."""
        share = SCALING * (1 + LIMIT_TOLERANCE)
        steps = np.diff(trajectory.times)
        for number, joint in enumerate(self.joints):
            path = trajectory.positions[:, number]
            speed = trajectory.velocities[:, number]
            assert joint.lower <= path.min()
            assert path.max() <= joint.upper
            assert np.abs(speed).max() <= share * joint.velocity
            assert np.abs(np.diff(path) / steps).max() <= share * joint.velocity
            assert np.abs(trajectory.accelerations[:, number]).max() <= share * joint.acceleration

    def _check_efforts(self, trajectory) -> None:
        """By inverse dynamics of the whole robot."""
        robot = self.cell.kinematics.robot
        data = robot.model.createData()
        arm = robot.velocity_columns[list(self.cell.description.group_indices(self.group))]
        most = np.array([joint.effort for joint in self.joints]) * (1 + EFFORT_TOLERANCE)
        v, a = np.zeros(robot.model.nv), np.zeros(robot.model.nv)
        for row, positions in enumerate(trajectory.positions):
            v[arm], a[arm] = trajectory.velocities[row], trajectory.accelerations[row]
            q = robot.configuration(self.cell.with_arm(positions))
            assert np.all(np.abs(pin.rnea(robot.model, data, q, v, a)[arm]) <= most)

    def _check_free(self, positions) -> None:
        """No pair touches by its exact shapes, at a third of the planner's finest resolution.

        A pair that touches at the start already may leave, and gets no deeper than `MARGIN_SLACK`.
        """
        scene = self.cell.scene
        near = scene.touches(self.cell.with_arm(positions[0]), TOUCHING)
        at_start = {(touch.first, touch.second): touch.distance for touch in near}
        model = self.cell.scene.collision_model()
        robot, geometry = model.robot, model.geometry
        data, geometry_data = robot.model.createData(), geometry.createData()
        for first, second in pairwise(positions):
            count = max(1, int(np.ceil(np.linalg.norm(second - first) / FINE)))
            for share in np.arange(1, count + 1) / count:
                state = self.cell.with_arm(first + share * (second - first))
                q = robot.configuration(state)
                if pin.computeCollisions(robot.model, data, geometry, geometry_data, q, True):
                    touches = scene.touches(state)
                    assert touches
                    for touch in touches:
                        least = at_start.get((touch.first, touch.second), np.inf) - MARGIN_SLACK
                        assert touch.distance > least - ROUNDING
