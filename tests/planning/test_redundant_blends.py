"""Sequences of arms with seven joints: blends arrive where the next motion is."""

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.ports.goals import JointGoal, PoseGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import ArcPoint, MotionSequence, SequenceItem
from tests.planning.lesson import Cell
from tests.planning.seven_joints import seven_joints

BENT = np.array([0.3, 0.6, 0.2, 1.3, -0.2, 0.9, 0.1])
SLOW = PlanningOptions(velocity_scaling=0.3, acceleration_scaling=0.3)


@pytest.fixture(scope="module")
def cell(tmp_path_factory):
    cell = Cell(seven_joints(tmp_path_factory.mktemp("seven")), with_tables=False)
    cell.state = BENT.copy()
    return cell


def moved(cell, x, y, z, turn=0.0):
    here = cell.kinematics.link_pose(cell.state, "tool")
    rotation = here.rotation @ SE3.from_xyz_rpy((0, 0, 0), (0, 0, turn)).rotation
    return PoseGoal("tool", SE3(rotation, here.translation + np.array([x, y, z])))


def items(cell, radius):
    """Lines, an arc and a joint motion, whose middle ones turn the tool."""
    through = moved(cell, -0.02, 0.08, -0.08).pose.translation
    return [
        SequenceItem("lin", moved(cell, 0, 0.08, 0, 0.3), None, radius),
        SequenceItem("circ", moved(cell, -0.04, 0.06, -0.1), ArcPoint("interim", through), radius),
        SequenceItem("lin", moved(cell, -0.02, -0.04, -0.1), None, radius),
        SequenceItem("ptp", JointGoal(tuple(BENT))),
    ]


@pytest.mark.nightly(but=["0.005"])
@pytest.mark.parametrize("radius", [0.005, 0.02, 0.035])
def test_seven_joints_blend_without_a_stop_and_stay_on_the_lines(cell, radius):
    planner = cell.planner
    plan = planner.plan(MotionRequest("arm", cell.state, MotionSequence(items(cell, radius)), SLOW))
    moving = np.abs(plan.trajectory.velocities[5:-5]).max(axis=1)
    assert moving.min() > 0.005
    assert plan.trajectory.positions[-1] == pytest.approx(BENT, abs=1e-6)
    stopped = planner.plan(MotionRequest("arm", cell.state, MotionSequence(items(cell, 0.0)), SLOW))
    assert plan.trajectory.duration < stopped.trajectory.duration


def test_the_plan_is_the_same_every_time(cell):
    first, second = (
        cell.planner.plan(
            MotionRequest("arm", cell.state, MotionSequence(items(cell, 0.02)), SLOW)
        ).trajectory
        for _ in range(2)
    )
    assert np.array_equal(first.positions, second.positions)
