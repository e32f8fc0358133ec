"""Blended sequences on arms of seven joints from other packages."""

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.ports.goals import PoseGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import MotionSequence, SequenceItem
from harness.robot.load import load_robot
from tests.planning.lesson import Cell

pytestmark = pytest.mark.needs_packages

FOLDER = "package://example-robot-data/robots"
SLOW = PlanningOptions(velocity_scaling=0.2, acceleration_scaling=0.2)
ARMS = {
    "panda_description": ("panda", [0, -0.785, 0, -2.356, 0, 1.571, 0.785]),
    "xarm_description": ("xarm7", [0, -0.3, 0, 0.9, 0, 1.2, 0]),
}


@pytest.mark.parametrize("radius", [0.005, 0.02, 0.05, 0.1, 0.149])
@pytest.mark.parametrize("package", ARMS)
def test_lines_blend_from_5_to_149_mm(package, radius):
    name, start = ARMS[package]
    files = {kind: f"{FOLDER}/{package}/{kind}/{name}.{kind}" for kind in ("urdf", "srdf")}
    description = load_robot(RobotSpec.model_validate(files))
    cell = Cell(description, with_tables=False)
    state = cell.with_arm(start)
    link = description.groups[description.arm_group].tip_link
    here = cell.kinematics.link_pose(state, link)

    def moved(*xyz):
        return PoseGoal(link, SE3(here.rotation, here.translation + np.array(xyz)))

    items = [
        SequenceItem("lin", moved(0, 0.2, 0), None, radius),
        SequenceItem("lin", moved(-0.05, -0.1, -0.2)),
    ]
    plan = cell.planner.plan(
        MotionRequest(description.arm_group, state, MotionSequence(items), SLOW)
    )
    speeds = np.abs(plan.trajectory.velocities[5:-5]).max(axis=1)
    assert speeds.min() > 0.001
