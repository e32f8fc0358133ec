"""LIN and move_relative: on the line, on one branch, as far as it goes."""

from itertools import pairwise

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.planning.cartesian.line_goals import pitched
from harness.planning.timing.cubic_spline import CubicSpline
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import LinearMotion, RelativeMotion
from tests.planning.lesson import ARM, TCP, Cell, at, grasp_goal, open_manipulator, thing, ur

SLOW = PlanningOptions(velocity_scaling=0.1, acceleration_scaling=0.1)
ABOVE = [-0.858, -1.187, 0.474, -0.858, -1.5708, -1.643]


@pytest.fixture
def cell():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(ABOVE)
    arm = cell.kinematics.solve(ARM, grasp_goal(0.32, -0.17, 0.28), cell.state, 0)[0]
    cell.state = cell.with_arm(arm)
    return cell


def poses(cell, plan):
    return [
        cell.kinematics.link_pose(cell.with_arm(positions), TCP)
        for positions in plan.trajectory.positions
    ]


def test_lin_keeps_the_tool_on_its_line_and_turns_it_evenly(cell):
    here = cell.kinematics.link_pose(cell.state, TCP)
    there = here @ SE3.from_xyz_rpy((0.03, -0.02, 0.12), (0, 0, 0.5))
    options = PlanningOptions(velocity_scaling=0.1)
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, LinearMotion(PoseGoal(TCP, there)), options)
    )
    track = poses(cell, plan)
    axis = there.translation - here.translation
    total = float(np.linalg.norm(axis))
    for pose in track:
        along = float((pose.translation - here.translation) @ axis) / total
        line = here.translation + along * axis / total
        assert np.linalg.norm(pose.translation - line) < 1e-4
        turned = here.distance_to(pose)[1]
        assert turned == pytest.approx(0.5 * along / total, abs=2e-3)
    assert track[-1].distance_to(there)[0] < 1e-6
    turns = [first.distance_to(second)[1] / 0.01 for first, second in pairwise(track)]
    assert max(turns) == pytest.approx(0.157, abs=2e-3)  # a tenth of pilz_cartesian_limits
    assert np.abs(np.diff(plan.trajectory.positions, axis=0)).max() < 0.1


def test_lin_through_an_object_names_what_is_in_the_way(cell):
    cell.add(thing("plate", at(0.32, -0.17, 1.02 + 0.18), Shape(Box((0.02, 0.2, 0.01)))))
    goal = grasp_goal(0.32, -0.17, 0.06)
    with pytest.raises(PlanningFailed) as caught:
        cell.planner.plan(MotionRequest(ARM, cell.state, LinearMotion(goal), SLOW))
    assert "plate" in caught.value.message


def test_a_fixed_relative_motion_covers_its_distance(cell):
    up = np.array([0, 0, -1.0, 0, 0, 0])
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, RelativeMotion(TCP, up, (0.1, 0.1)), SLOW)
    )
    first, last = poses(cell, plan)[0], poses(cell, plan)[-1]
    assert np.allclose(last.translation - first.translation, [0, 0, -0.1], atol=1e-6)
    assert first.distance_to(last)[1] < 1e-6


def test_a_rotation_turns_the_link_in_place(cell):
    turn = np.array([0, 0, 0, 0, 0, 1.0])
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, RelativeMotion(TCP, turn, (0.4, 0.4)), SLOW)
    )
    track = poses(cell, plan)
    assert track[0].distance_to(track[-1])[1] == pytest.approx(0.4, abs=1e-6)
    assert max(pose.distance_to(track[0])[0] for pose in track) < 1e-4


def test_a_relative_motion_goes_as_far_as_it_can_between_its_distances(cell):
    down = np.array([0, 0, -1.0, 0, 0, 0])
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, RelativeMotion(TCP, down, (0.05, 0.6)), SLOW)
    )
    reached = plan.explanation.plain()["distance"]
    assert 0.2 < reached < 0.3  # the fingers stop above the table
    assert "Table_0" in plan.explanation.plain()["stopped_by"]
    with pytest.raises(PlanningFailed) as caught:
        cell.planner.plan(
            MotionRequest(ARM, cell.state, RelativeMotion(TCP, down, (0.5, 0.6)), SLOW)
        )
    assert caught.value.code == "PLANNING_FAILED"
    assert caught.value.facts["reached"] == pytest.approx(reached, abs=0.01)
    assert "not 500.0 mm" in caught.value.message


def test_four_joints_keep_position_and_pitch_on_a_line():
    cell = Cell(open_manipulator())
    cell.state[:4] = [0.0, 0.1, 0.6, -0.7]
    forward = np.array([0, 1.0, 0, 0, 0, 0])
    plan = cell.planner.plan(
        MotionRequest("arm", cell.state, RelativeMotion(TCP, forward, (0.08, 0.08)), SLOW)
    )
    first = cell.kinematics.link_pose(cell.state, TCP)
    for positions in plan.trajectory.positions:
        pose = cell.kinematics.link_pose(cell.with_arm(positions), TCP)
        assert pose.rotation[2, 0] == pytest.approx(first.rotation[2, 0], abs=1e-4)
        assert pose.translation[[0, 2]] == pytest.approx(first.translation[[0, 2]], abs=1e-4)
    assert pose.translation[1] - first.translation[1] == pytest.approx(0.08, abs=1e-6)


def test_the_spline_follows_a_smooth_curve_with_its_derivatives():
    grid = np.linspace(0, 1, 31)
    spline = CubicSpline.even(np.column_stack([np.sin(3 * grid), np.cos(2 * grid)]))
    fine = np.linspace(0, 1, 301)
    value, slope, bend = spline.evaluate(fine)
    assert np.allclose(value[:, 0], np.sin(3 * fine), atol=1e-6)
    assert np.allclose(slope[:, 0], 3 * np.cos(3 * fine), atol=1e-3)
    assert np.allclose(bend[5:-5, 0], -9 * np.sin(3 * fine)[5:-5], atol=3e-2)


def test_a_line_is_slowed_until_every_sample_keeps_the_velocity_limit():
    """Straight up by 6 cm from the lesson's grasp, at full speed: joint 4 limits."""
    cell = Cell(open_manipulator())
    up = np.array([0, 0, 1.0, 0, 0, 0])
    limit = cell.description.joint_by_name["joint4"].velocity
    for height in (0.055, 0.06, 0.065):
        goal = PositionGoal(TCP, np.array([0.25, 0.0, 1.02 + height]), 0.0)
        cell.state[:4] = cell.kinematics.solve("arm", goal, cell.state, 0)[0]
        plan = cell.planner.plan(
            MotionRequest(
                "arm", cell.state, RelativeMotion(TCP, up, (0.06, 0.06)), PlanningOptions()
            )
        )
        assert np.abs(plan.trajectory.velocities).max() <= limit * (1 + 1e-9)


@pytest.mark.parametrize("pitch", [-1.2, 0.0, 0.7, np.pi / 2])
def test_a_pitched_rotation_keeps_its_heading(pitch):
    heading = 0.8
    cosine, sine = np.cos(heading), np.sin(heading)
    level = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    turned = pitched(level, pitch)
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(
        turned[:, 0],
        [np.cos(pitch) * cosine, np.cos(pitch) * sine, -np.sin(pitch)],
        atol=1e-12,
    )
    np.testing.assert_allclose(pitched(turned, 0.0), level, atol=1e-12)
