"""Path constraints hold on every sample; goals with room and several goals are taken nearest."""

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.ports.goals import (
    AnyGoal,
    JointBand,
    JointGoal,
    OrientationBand,
    PathConstraints,
    PoseGoal,
    PositionBox,
)
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion
from harness.recording.plan_statistics import PlanStatistics
from tests.planning.lesson import ARM, TCP, Cell, at, grasp_goal, thing, ur

OPTIONS = PlanningOptions(seed=3)


@pytest.fixture
def cell():
    """A wall stands in the straight way."""
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm([-0.858, -1.187, 0.474, -0.858, -1.5708, -1.643])
    arm = cell.kinematics.solve(ARM, grasp_goal(0.25, -0.17, 0.22), cell.state, 0)[0]
    cell.state = cell.with_arm(arm)
    cell.add(thing("wall", at(0.32, 0.0, 1.12), Shape(Box((0.1, 0.02, 0.2)))))
    return cell


def here(cell):
    return cell.kinematics.link_pose(cell.state, TCP)


def beyond(cell):
    pose = here(cell)
    return PoseGoal(TCP, SE3(pose.rotation, pose.translation + np.array([0.06, 0.34, -0.08])))


def dense(plan):
    """Every sample, and states between them as the cubic set points go."""
    positions = plan.trajectory.positions
    middles = 0.5 * (positions[1:] + positions[:-1])
    return np.concatenate([positions, middles])


def tilt(reference, pose, axis):
    """Angle between a link's axis and where it was [rad]."""
    return float(np.arccos(np.clip(reference.rotation[:, axis] @ pose.rotation[:, axis], -1, 1)))


@pytest.mark.parametrize("tolerance", [0.2, 0.05])
def test_a_tool_held_level_stays_in_its_cone_on_every_sample(cell, tolerance):
    """Free about the vertical: the tilt alone is held, by its angle, not by any vector."""
    start = here(cell)
    up = int(np.argmax(np.abs(start.rotation[2])))
    bands = [tolerance] * 3
    bands[up] = 4.0
    held = PathConstraints(orientation=OrientationBand(TCP, start.rotation, tuple(bands)))
    options = PlanningOptions(seed=0)  # one whose free motion tilts the tool
    free = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(beyond(cell)), options))
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, FreeMotion(beyond(cell), held), options)
    )
    tilts = [tilt(start, cell.kinematics.link_pose(cell.with_arm(q), TCP), up) for q in dense(plan)]
    unheld = [
        tilt(start, cell.kinematics.link_pose(cell.with_arm(q), TCP), up) for q in dense(free)
    ]
    assert max(tilts) <= tolerance + 1e-6
    assert max(unheld) > tolerance
    end = cell.kinematics.link_pose(cell.with_arm(plan.trajectory.positions[-1]), TCP)
    assert end.distance_to(beyond(cell).pose)[0] < 1e-6


def test_a_link_stays_in_its_box_and_a_joint_in_its_band(cell):
    start, goal = here(cell).translation, beyond(cell)
    low = np.minimum(start, goal.pose.translation) - 0.06
    high = np.maximum(start, goal.pose.translation) + np.array([0.06, 0.06, 0.25])
    box = PositionBox(TCP, at(*(0.5 * (low + high))), tuple(high - low))
    held = PathConstraints(position=box, joints=(JointBand("wrist_2_joint", -1.8, -1.3),))
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal, held), OPTIONS))
    for positions in dense(plan):
        place = cell.kinematics.link_pose(cell.with_arm(positions), TCP).translation
        assert np.all(place >= low - 1e-9)
        assert np.all(place <= high + 1e-9)
        assert -1.8 <= positions[4] <= -1.3


def test_the_same_seed_gives_the_same_constrained_plan(cell):
    held = PathConstraints(orientation=OrientationBand(TCP, here(cell).rotation, (0.2, 0.2, 0.2)))
    first, second = (
        cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(beyond(cell), held), OPTIONS))
        for _ in range(2)
    )
    assert first.statistics.find(PlanStatistics).planner_id == "BalancedConnect, projected"
    assert first.trajectory.positions.tobytes() == second.trajectory.positions.tobytes()


def failure(call, *arguments):
    with pytest.raises(PlanningFailed) as caught:
        call(*arguments)
    return caught.value


def test_a_start_and_a_goal_outside_the_constraints_are_distinguished(cell):
    pose = here(cell)
    turned = (pose @ SE3.from_xyz_rpy((0, 0, 0), (0.3, 0, 0))).rotation
    off = PathConstraints(orientation=OrientationBand(TCP, turned, (0.1, 0.1, 0.1)))
    start = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(beyond(cell), off), OPTIONS)
    )
    assert start.code == "START_STATE_VIOLATES_PATH_CONSTRAINTS"
    assert "turned -17.2 deg about x" in start.message
    held = PathConstraints(orientation=OrientationBand(TCP, pose.rotation, (0.1, 0.1, 0.1)))
    away = PoseGoal(TCP, SE3(turned, pose.translation))
    goal = failure(
        cell.planner.check_goal, MotionRequest(ARM, cell.state, FreeMotion(away, held), OPTIONS)
    )
    assert goal.code == "GOAL_VIOLATES_PATH_CONSTRAINTS"
    assert goal.facts["constraint_value"] == pytest.approx(0.3)


def test_what_cannot_be_held_fails_within_its_budget(cell):
    """A wall across the only lane the tool may use."""
    pose = here(cell)
    lane = PositionBox(TCP, at(*pose.translation), (0.02, 2.0, 0.02))
    goal = PoseGoal(TCP, SE3(pose.rotation, pose.translation + np.array([0, 0.34, 0])))
    cell.add(thing("across", at(0.25, 0.0, 1.14), Shape(Box((0.2, 0.02, 0.3)))))
    few = PlanningOptions(max_state_checks=3000, seed=1)
    error = failure(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(goal, PathConstraints(position=lane)), few),
    )
    assert error.code == "PLANNING_FAILED"
    assert "no free path that satisfies the constraints" in error.message
    assert error.facts["state_checks"] < 4000


def test_of_several_goals_the_nearest_that_can_be_taken_is(cell):
    far, near = cell.named("mogi_home"), cell.state[:6] + 0.1
    out = grasp_goal(1.5, 0, 0.3)
    goals = AnyGoal((out, JointGoal(far), JointGoal(near)))
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goals), OPTIONS))
    assert np.allclose(plan.trajectory.positions[-1], near, atol=1e-6)
    reported = plan.explanation.plain()["alternatives"]
    assert [each["error_code"] for each in reported] == ["NO_IK_SOLUTION", "", ""]
    error = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(AnyGoal((out, out))), OPTIONS)
    )
    assert error.code == "NO_IK_SOLUTION"
    assert error.message.startswith("none of 2 goals is feasible: 1: ")


def test_a_goal_region_is_reached_where_its_middle_cannot_be(cell):
    """A block stands in the middle of the goal; the region has room next to it."""
    middle = grasp_goal(0.25, -0.17, 0.16)
    cell.add(thing("lump", at(*middle.pose.translation, (0, 0, 0)), Shape(Box((0.09, 0.09, 0.05)))))
    blocked = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(middle), OPTIONS)
    )
    assert blocked.code == "GOAL_IN_COLLISION"
    wide = grasp_goal(0.25, -0.17, 0.16, position_tolerance=0.15, orientation_tolerance=0.1)
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(wide), OPTIONS))
    end = cell.kinematics.link_pose(cell.with_arm(plan.trajectory.positions[-1]), TCP)
    shift, turn = wide.pose.distance_to(end)
    assert 0 < shift <= 0.15
    assert turn <= 0.1 * np.sqrt(3)


def test_free_about_an_axis_the_arm_turns_less(cell):
    """A goal turned by 2.5 rad about the gripper's own axis, and that turn declared free."""
    pose = here(cell)
    axis = int(np.argmax(np.abs(pose.rotation[2])))
    turn = [0.0, 0.0, 0.0]
    turn[axis] = 2.5
    goal = pose @ SE3.from_xyz_rpy((0, 0, 0), tuple(turn))
    tolerances = [0.001] * 3
    tolerances[axis] = 4.0
    tight = cell.planner.plan(
        MotionRequest(ARM, cell.state, FreeMotion(PoseGoal(TCP, goal)), OPTIONS)
    )
    free = PoseGoal(TCP, goal, 1e-3, 4.0, tuple(tolerances))
    loose = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(free), OPTIONS))
    assert (
        loose.statistics.find(PlanStatistics).path_length
        < 0.5 * tight.statistics.find(PlanStatistics).path_length
    )
    end = cell.kinematics.link_pose(cell.with_arm(loose.trajectory.positions[-1]), TCP)
    assert tilt(pose, end, axis) < 0.01
