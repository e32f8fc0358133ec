"""Planned motions of the lesson: found, repeatable, free at a finer step, else explained."""

from contextlib import suppress
from itertools import pairwise

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Cylinder, Shape, Sphere
from harness.planning.collision.checker import MotionChecker
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import JointGoal, PoseGoal, PositionGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion, JointMotion
from harness.recording.plan_statistics import PlanStatistics
from tests.planning.lesson import (
    ARM,
    FIRST_BOXES,
    SECOND_BOX,
    TCP,
    Cell,
    at,
    boxes,
    grasp_goal,
    open_manipulator,
    thing,
    ur,
)

OPTIONS = {"velocity_scaling": 0.3, "acceleration_scaling": 0.3, "seed": 7}


def check_motion(cell, plan, padding=0.0, group=ARM):
    """Everything the planner promises of a plan, checked again from outside and finer."""
    trajectory, start = plan.trajectory, cell.state
    space = GroupSpace(cell.kinematics.robot, group, start)
    checker = MotionChecker(cell.scene, space, space.part(start), padding)
    assert np.allclose(trajectory.positions[0], space.part(start), atol=1e-9)
    assert np.all(np.diff(trajectory.times) > 0)
    assert np.all(trajectory.positions >= space.lower - 1e-9)
    assert np.all(trajectory.positions <= space.upper + 1e-9)
    assert np.abs(trajectory.velocities / space.velocity).max() <= 0.3 * 1.001
    assert np.abs(trajectory.accelerations / space.acceleration).max() <= 0.3 * 1.001
    previous = trajectory.positions[0]
    for positions in trajectory.positions[1:]:
        assert checker.edge_free(previous, positions, 1 / 256)
        previous = positions
    return space.whole(trajectory.positions[-1])


def sixteen_steps(model):
    """The arm's motions of the lesson; yields name, goal, padding after changing the scene."""
    cell = Cell(ur(model))
    yield cell, "mogi_down", JointGoal(cell.named("mogi_down")), 0.0
    cell.add(boxes(*FIRST_BOXES))
    yield cell, "up", JointGoal(cell.named("up")), 0.01
    yield cell, "mogi_home", JointGoal(cell.named("mogi_home")), 0.01
    cell.scene.remove_object("boxes")
    yield cell, "joints", JointGoal(np.array([-1.5707, -1.5707, 0, 0, 0, 0])), 0.0
    yield cell, "step 8", grasp_goal(0.32, -0.17, 0.3), 0.0
    tolerances = {"position_tolerance": 0.002, "orientation_tolerance": 0.001}
    yield cell, "step 10", grasp_goal(0.32, -0.17, 0.08, **tolerances), 0.0
    cell.add(thing("cylinder", at(0.32, -0.168, 1.07), Shape(Cylinder(0.03, 0.1))))
    cell.scene.attach_object("cylinder", TCP, cell.description.gripper.links, cell.state)
    cell.state[6:] = 0.5755
    cell.add(boxes(*SECOND_BOX))
    yield cell, "step 14", grasp_goal(0, -0.4, 0.09), 0.005
    yield cell, "up again", JointGoal(cell.named("up")), 0.005


@pytest.mark.parametrize("model", ["ur3e", "ur5e"])
def test_the_motions_of_the_lesson_are_planned_and_hold(model):
    planners = {}
    for cell, name, goal, padding in sixteen_steps(model):
        plan = cell.planner.plan(
            MotionRequest(
                ARM, cell.state, FreeMotion(goal), PlanningOptions(padding=padding, **OPTIONS)
            )
        )
        end = check_motion(cell, plan, padding)
        planners[name] = plan.statistics.find(PlanStatistics).planner_id
        if isinstance(goal, PoseGoal):
            shift, angle = goal.pose.distance_to(cell.kinematics.link_pose(end, TCP))
            assert max(shift, angle) < 1e-6
        cell.state = end
    assert planners["up"] == "BalancedConnect"  # the boxes stand in the straight way
    assert planners["mogi_down"] == "direct joint motion"


def test_without_the_boxes_the_way_is_another():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(cell.named("mogi_down"))
    goal, options = JointGoal(cell.named("up")), PlanningOptions(padding=0.01, **OPTIONS)
    free = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal), options))
    cell.add(boxes(*FIRST_BOXES))
    around = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal), options))
    assert free.statistics.find(PlanStatistics).planner_id == "direct joint motion"
    assert (
        around.statistics.find(PlanStatistics).path_length
        > free.statistics.find(PlanStatistics).path_length
    )


def test_the_same_plan_comes_out_whatever_was_planned_before():
    def plan_up(before):
        cell = Cell(ur("ur3e"))
        cell.add(boxes(*FIRST_BOXES))
        cell.state = cell.with_arm(cell.named("mogi_down"))
        for seed in before:
            options = PlanningOptions(seed=seed)
            cell.planner.plan(
                MotionRequest(ARM, cell.state, FreeMotion(JointGoal(cell.named("up"))), options)
            )
        options = PlanningOptions(padding=0.01, **OPTIONS)
        plan = cell.planner.plan(
            MotionRequest(ARM, cell.state, FreeMotion(JointGoal(cell.named("up"))), options)
        )
        return plan.trajectory.positions.tobytes(), plan.trajectory.times.tobytes()

    alone = plan_up([])
    assert plan_up([]) == alone
    assert plan_up([3, 1]) == alone


def test_another_seed_gives_another_path():
    lengths = set()
    for seed in (1, 2, 3):
        cell = Cell(ur("ur3e"))
        cell.add(boxes(*FIRST_BOXES))
        cell.state = cell.with_arm(cell.named("mogi_down"))
        plan = cell.planner.plan(
            MotionRequest(
                ARM, cell.state, FreeMotion(JointGoal(cell.named("up"))), PlanningOptions(seed=seed)
            )
        )
        lengths.add(plan.statistics.find(PlanStatistics).raw_path_length)
        raw = np.array(plan.statistics.find(PlanStatistics).raw_path)
        assert np.linalg.norm(np.diff(raw, axis=0), axis=1).sum() == pytest.approx(
            plan.statistics.find(PlanStatistics).raw_path_length
        )
    assert len(lengths) > 1


def failure(call, *args):
    with pytest.raises(PlanningFailed) as caught:
        call(*args)
    return caught.value


def test_a_point_out_of_reach_is_explained_with_its_distance():
    cell = Cell(ur("ur3e"))
    error = failure(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(grasp_goal(1.32, 0, 0.3)), PlanningOptions()),
    )
    assert error.code == "NO_IK_SOLUTION"
    nearest = np.array(error.facts["nearest_position"])
    away = np.linalg.norm(nearest - [1.32, 0, 1.32])
    assert error.facts["point_out_of_reach_by"] == pytest.approx(away)
    assert 0.4 < away < 0.9
    assert f"{1000 * away:.1f} mm" in error.message


def test_an_orientation_out_of_reach_is_distinguished_from_a_point_out_of_reach():
    cell = Cell(ur("ur3e"))
    goal = grasp_goal(0.5, -0.1, 0.3)
    error = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions())
    )
    assert error.code == "NO_IK_SOLUTION"
    assert error.facts["point_out_of_reach_by"] == 0.0
    assert error.facts["orientation_error"] > 0.01 or error.facts["position_error"] > 0.001


def test_solutions_that_limits_reject_name_the_joint_and_how_far():
    cell = Cell(ur("ur3e"))
    found = cell.planner.check_goal(
        MotionRequest(ARM, cell.state, FreeMotion(grasp_goal(0.32, -0.17, 0.08)), PlanningOptions())
    )
    outside = found.explanation.plain()["outside_limits"]
    assert len(outside) + len(found.explanation.plain()["ik_solutions"]) == 8
    for solution in outside:
        assert solution["joint"].endswith("_joint")
        assert solution["excess"] == pytest.approx(abs(solution["value"] - solution["limit"]))
        assert solution["excess"] > 0


def test_a_goal_in_collision_names_every_solution_and_its_pair():
    cell = Cell(ur("ur3e"))
    goal = grasp_goal(0.32, -0.17, -0.02)
    error = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions())
    )
    assert error.code == "GOAL_IN_COLLISION"
    assert len(error.facts["ik_solutions"]) > 1
    for solution in error.facts["ik_solutions"]:
        assert solution["status"] == "in collision"
        assert solution["touches"][0]["distance"] < 0
    assert "Table_0" in error.message


def test_joint_goals_outside_their_limits_or_in_collision_are_refused():
    cell = Cell(ur("ur3e"))
    beyond = JointGoal(np.array([-3.5, -1.57, 0, 0, 0, 0]))
    error = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(beyond), PlanningOptions())
    )
    assert error.code == "GOAL_STATE_INVALID"
    assert error.facts["outside_limits"][0]["joint"] == "shoulder_pan_joint"
    assert error.facts["outside_limits"][0]["excess"] == pytest.approx(3.5 - 3.3406585, abs=1e-6)
    down = JointGoal(np.array([0, 0.6, 0, 0, 0, 0]))
    error = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(down), PlanningOptions())
    )
    assert error.code == "GOAL_IN_COLLISION"
    assert any("Table" in touch["pair"] for touch in error.facts["touches"])


def test_an_exhausted_budget_reports_what_blocks_the_straight_way():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(cell.named("mogi_down"))
    cell.add(boxes(*FIRST_BOXES))
    options = PlanningOptions(max_state_checks=30, attempts=2, seed=1)
    error = failure(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(JointGoal(cell.named("up"))), options),
    )
    assert error.code == "PLANNING_FAILED"
    assert 30 <= error.facts["state_checks"] < 400
    assert 0 < error.facts["straight_way"]["free_share"] < 1
    assert "boxes" in error.facts["straight_way"]["touches"][0]["pair"]
    assert error.facts["gap"] > 0


def test_a_timed_joint_motion_takes_exactly_its_time_or_says_what_it_needs():
    cell = Cell(open_manipulator())
    goal = np.array([0.0, 0.87, -0.195, -0.67])
    plan = cell.planner.plan(
        MotionRequest("arm", cell.state, JointMotion(goal, duration=2.0), PlanningOptions())
    )
    assert plan.trajectory.duration == pytest.approx(2.0, abs=1e-12)
    assert np.all(plan.trajectory.velocities[[0, -1]] == 0)
    middle = plan.trajectory.positions[len(plan.trajectory.times) // 2]
    assert np.allclose(middle, 0.5 * (plan.trajectory.positions[0] + goal), atol=0.02)

    def request(duration, **options):
        motion = JointMotion(goal, duration)
        return MotionRequest("arm", cell.state, motion, PlanningOptions(**options))

    error = failure(cell.planner.plan, request(0.1))
    assert error.code == "INVALID_MOTION_PLAN"
    assert error.facts["joint"] == "joint2"
    needed = error.facts["shortest_duration"]
    again = cell.planner.plan(request(needed + 0.002))
    assert again.trajectory.duration == pytest.approx(needed, abs=0.0041)
    smooth = cell.planner.plan(request(2.0, max_jerk=20.0)).trajectory
    assert smooth.duration == pytest.approx(2.0, abs=1e-12)
    jerks = np.diff(smooth.accelerations, axis=0) / np.diff(smooth.times)[:, None]
    assert np.abs(smooth.accelerations[[0, -1]]).max() < 1e-9
    assert np.abs(jerks).max() <= 20.0
    refused = failure(cell.planner.plan, request(1.0, max_jerk=20.0))
    assert "a jerk of" in refused.message
    slower = cell.planner.plan(request(refused.facts["shortest_duration"] + 0.002, max_jerk=20.0))
    assert slower.trajectory.duration > 1.0


def test_a_joint_motion_through_an_object_is_refused_with_the_pair():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(cell.named("mogi_down"))
    cell.add(boxes(*FIRST_BOXES))
    error = failure(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, JointMotion(cell.named("up")), PlanningOptions()),
    )
    assert error.code == "INVALID_MOTION_PLAN"
    assert any("boxes" in touch["pair"] for touch in error.facts["touches"])


def test_a_motion_to_where_the_arm_stands_is_a_rest():
    cell = Cell(ur("ur3e"))
    goal = JointGoal(cell.state[:6])
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions()))
    assert plan.trajectory.duration < 0.02
    assert np.all(plan.trajectory.velocities == 0)


def test_the_open_manipulator_goes_to_a_position_with_and_without_a_pitch():
    cell = Cell(open_manipulator())
    point = np.array([0.25, 0.0, 1.02 + 0.075])
    for pitch in (0.0, None):
        goal = PositionGoal(TCP, point, pitch)
        plan = cell.planner.plan(
            MotionRequest("arm", cell.state, FreeMotion(goal), PlanningOptions())
        )
        state = cell.state.copy()
        state[:4] = plan.trajectory.positions[-1]
        pose = cell.kinematics.link_pose(state, TCP)
        assert np.linalg.norm(pose.translation - point) < 1e-7
        if pitch is not None:
            assert pose.rotation[2, 0] == pytest.approx(0.0, abs=1e-7)


def test_a_pose_for_four_joints_is_answered_with_what_to_write_instead():
    cell = Cell(open_manipulator())
    pose = at(0.25, 0.0, 1.095, rpy=(0, 0, 0.5))
    error = failure(
        cell.planner.plan,
        MotionRequest("arm", cell.state, FreeMotion(PoseGoal(TCP, pose)), PlanningOptions()),
    )
    assert error.code == "GOAL_CONSTRAINTS_VIOLATED"
    assert "`position` and `pitch`" in error.message
    assert error.facts["orientation_error"] == pytest.approx(0.5)


def test_padding_widens_what_must_be_gone_around():
    cell = Cell(ur("ur3e"))
    wall = thing("wall", at(0.0, 0.0, 0.0), Shape(Box((0.02, 0.02, 0.02))))
    tip = cell.kinematics.link_pose(cell.with_arm(cell.named("mogi_home")), TCP).translation
    cell.scene.add_object(wall, at(tip[0] + 0.06, tip[1], tip[2]))
    goal = JointGoal(cell.named("mogi_home"))
    cell.planner.check_goal(MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions()))
    error = failure(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions(padding=0.08)),
    )
    assert error.code == "GOAL_IN_COLLISION"
    assert error.facts["touches"][0]["distance"] > 0


BENT = np.array([-0.86, -1.5, 1.6, -1.7, -1.57, -1.6])


def bent_away_from_goal(turn):
    """A UR5e turned away from where it shall go, the goal, and the branches that reach it."""
    cell = Cell(ur("ur5e"), with_tables=False)
    goal = PoseGoal(TCP, cell.kinematics.link_pose(cell.with_arm(BENT), TCP))
    cell.state = cell.with_arm([BENT[0] + turn, *BENT[1:]])
    return cell, goal, cell.kinematics.solve(ARM, goal, cell.state, 0)


def test_a_pose_goal_ends_in_the_cheapest_branch_when_the_straight_way_is_free():
    cell, goal, branches = bent_away_from_goal(0.8)
    assert len(branches) >= 4
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    costs = [space.effort(space.part(cell.state), positions) for positions in branches]
    assert costs == sorted(costs)
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions()))
    assert np.allclose(plan.trajectory.positions[-1], branches[0], atol=1e-9)


@pytest.mark.parametrize(
    ("turn", "center", "radius"),
    [
        (0.78, (0.49, -0.12, 1.42), 0.08),  # no straight way is free
        (0.85, (0.58, -0.05, 1.36), 0.08),  # one to a branch twice as far is
        (1.17, (0.58, -0.05, 1.29), 0.08),
    ],
)
def test_a_pose_goal_ends_in_the_cheapest_branch_around_a_ball_too(turn, center, radius):
    cell, goal, branches = bent_away_from_goal(turn)
    cell.add(thing("ball", at(*center), Shape(Sphere(radius))))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)

    def plan_to(goal):
        plan = cell.planner.plan(
            MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions())
        )
        positions = plan.trajectory.positions
        return positions[-1], sum(space.effort(*edge) for edge in pairwise(positions))

    end, taken = plan_to(goal)
    alone = {}
    for number, positions in enumerate(branches):
        with suppress(PlanningFailed):
            alone[number] = plan_to(JointGoal(positions))[1]
    cheapest = min(alone, key=alone.__getitem__)
    assert len(alone) >= 2
    assert np.allclose(end, branches[cheapest], atol=1e-9)
    assert taken < min(length for number, length in alone.items() if number != cheapest)


def test_cheaper_branches_are_searched_within_the_budget_that_is_given():
    cell, goal, branches = bent_away_from_goal(0.85)
    cell.add(thing("ball", at(0.58, -0.05, 1.36), Shape(Sphere(0.08))))
    ample, scarce = (
        cell.planner.plan(
            MotionRequest(
                ARM, cell.state, FreeMotion(goal), PlanningOptions(max_state_checks=checks)
            )
        )
        for checks in (200_000, 1)
    )
    assert np.allclose(ample.trajectory.positions[-1], branches[0], atol=1e-9)
    assert scarce.statistics.find(PlanStatistics).planner_id == "direct joint motion"
    assert (
        scarce.statistics.find(PlanStatistics).state_checks
        < ample.statistics.find(PlanStatistics).state_checks
    )


def test_a_planner_that_is_not_there_is_reported_where_a_straight_way_is_free_too():
    cell, goal, _ = bent_away_from_goal(0.85)
    cell.add(thing("ball", at(0.58, -0.05, 1.36), Shape(Sphere(0.08))))
    error = failure(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions(planner_id="RTT")),
    )
    assert error.code == "PLANNING_FAILED"
    assert "unknown planner 'RTT'" in error.message
