"""Explanations are true: the nearest pose is nearest, what is advised is reached, names differ."""

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3, wxyz_from_xyzw
from harness.planning.ik.nearest_pose import (
    EVEN,
    KEEP_TURN,
    distance_to_goal,
    nearest_pose,
)
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.closed_forms.ik_solvers.ur import UrSolver
from harness.ports.goals import JointGoal, PoseGoal, PositionGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion, JointMotion, LinearMotion, RelativeMotion
from harness.recording.explanation import recorded_explanation
from tests.planning.lesson import (
    ARM,
    TCP,
    Cell,
    at,
    grasp_goal,
    open_manipulator,
    thing,
    ur,
)

OPTIONS = PlanningOptions(seed=3)


def explained(call, *args):
    with pytest.raises(PlanningFailed) as caught:
        call(*args)
    return caught.value


def stage(error, name):
    return {stage.stage: stage for stage in recorded_explanation(error.details).stages}[name]


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("make", "group", "goal"),
    [
        (lambda: ur("ur3e"), ARM, grasp_goal(1.1, 0.2, 0.4)),
        (lambda: ur("ur5e"), ARM, grasp_goal(0.02, 0.03, 0.1)),
        (open_manipulator, "arm", PositionGoal(TCP, np.array([0.5, 0.1, 1.3]), 0.4)),
    ],
)
def test_no_random_state_comes_nearer_than_the_nearest_pose(make, group, goal):
    """Against 4000 states drawn from the whole joint space, and the best of them improved."""
    cell = Cell(make())
    space = GroupSpace(cell.kinematics.robot, group, cell.state)
    found = nearest_pose(space, goal, space.part(cell.state))
    assert np.all((found.positions >= space.lower) & (found.positions <= space.upper))
    pose = cell.kinematics.link_pose(space.whole(found.positions), TCP)
    assert distance_to_goal(goal, pose) == pytest.approx((found.shift, found.turn), abs=1e-9)
    rng = np.random.default_rng(8)
    states = rng.uniform(space.lower, space.upper, (4000, space.dof))
    away = [
        np.hypot(shift, EVEN * turn)
        for q in states
        for shift, turn in [distance_to_goal(goal, cell.kinematics.link_pose(space.whole(q), TCP))]
    ]
    assert np.hypot(found.shift, EVEN * found.turn) <= min(away) + 1e-6
    for index in np.argsort(away)[:20]:  # a descent by a second method from the best of them
        best, step = states[index], 0.05
        cost = away[index]
        while step > 1e-4:
            trials = np.clip(
                best + step * np.vstack([np.eye(space.dof), -np.eye(space.dof)]),
                space.lower,
                space.upper,
            )
            costs = []
            for q in trials:
                shift, turn = distance_to_goal(goal, cell.kinematics.link_pose(space.whole(q), TCP))
                costs.append(np.hypot(shift, EVEN * turn))
            least = int(np.argmin(costs))
            if costs[least] < cost:
                best, cost = trials[least], costs[least]
            else:
                step /= 2
        assert np.hypot(found.shift, EVEN * found.turn) <= cost + 1e-4


def test_a_turn_that_is_kept_is_kept():
    cell = Cell(ur("ur3e"))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    found = nearest_pose(
        space, grasp_goal(0.5, -0.1, 0.3), space.part(cell.state), metres_per_radian=KEEP_TURN
    )
    assert found.turn < 1e-4
    assert found.shift == pytest.approx(0.0884, abs=0.001)


@pytest.mark.nightly(but=["xyz0", "xyz1"])
@pytest.mark.parametrize("xyz", [(0.9, 0, 0.3), (0.5, -0.1, 0.3), (0.2, 0.6, 0.6), (0, 0.05, 0.2)])
def test_a_goal_that_is_advised_is_reached_as_it_is_written(xyz):
    cell = Cell(ur("ur3e"))
    error = explained(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(grasp_goal(*xyz)), OPTIONS)
    )
    assert error.code == "NO_IK_SOLUTION"
    numbers = r"\[([^\]]*)\]"
    found = re.search(rf"frame: world, xyz: {numbers}, quat_xyzw: {numbers}", error.facts["advice"])
    position, quat = (np.array([float(v) for v in group.split(",")]) for group in found.groups())
    pose = SE3.from_xyz_quat(position, wxyz_from_xyzw(quat))
    assert cell.kinematics.solve(ARM, PoseGoal(TCP, pose), cell.state, 0)


@pytest.mark.nightly(but=["xyz0-plan"])
@pytest.mark.parametrize("method", ["plan", "check_goal"])
@pytest.mark.parametrize("xyz", [(0.9, 0, 0.3), (0.2, 0.6, 0.9)])
def test_a_request_that_is_passed_by_its_name_is_explained(method, xyz):
    cell = Cell(ur("ur3e"))
    motion = FreeMotion(goal=grasp_goal(*xyz))
    request = MotionRequest(options=OPTIONS, motion=motion, start=cell.state, group=ARM)
    call = getattr(cell.planner, method)
    errors = [explained(partial(call, request=request)), explained(call, request)]
    assert [error.code for error in errors] == ["NO_IK_SOLUTION", "NO_IK_SOLUTION"]
    stages = [recorded_explanation(error.details).stages for error in errors]
    assert stages[0] == stages[1] != ()


def test_a_goal_in_collision_is_free_where_the_explanation_moves_it():
    cell = Cell(ur("ur3e"))
    goal = grasp_goal(0.32, -0.17, -0.02)
    error = explained(cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(goal), OPTIONS))
    shift = np.array(error.facts["nearest"]["nearest_free"]["shift"])

    def moved(share):
        pose = SE3(goal.pose.rotation, goal.pose.translation + share * shift)
        return replace(goal, pose=pose)

    cell.planner.check_goal(MotionRequest(ARM, cell.state, FreeMotion(moved(1.0)), OPTIONS))
    explained(
        cell.planner.check_goal, MotionRequest(ARM, cell.state, FreeMotion(moved(0.8)), OPTIONS)
    )
    assert f"{np.ceil(1000 * shift[2]):.1f} mm along +z" in error.facts["advice"]


def test_the_branches_of_a_ur_have_eight_names():
    cell = Cell(ur("ur5e"))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    goal = grasp_goal(0.32, -0.17, 0.08)
    request = cell.kinematics.request(space, goal, cell.state, 0)
    found = cell.kinematics.solve(ARM, goal, cell.state, 0)
    names = {UrSolver.branch_name(request, q) for q in found}
    assert len(names) == len(found) == 8
    zero = UrSolver.branch_name(request, np.array([0.3, -1.2, 1.5, -1.0, 1.0, 0]))
    assert zero == "forwards, elbow up, wrist_2_joint > 0"
    over = UrSolver.branch_name(request, np.array([0.3, -1.9, -1.5, -1.0, -1.0, 0]))
    assert over == "backwards, elbow up, wrist_2_joint < 0"


@pytest.mark.nightly
@pytest.mark.parametrize("place", [(0.3, 0.0, 1.1), (0.2, 0.15, 1.15)])
def test_branches_of_one_name_are_listed_with_their_joint_positions(place):
    cell = Cell(open_manipulator())
    start = cell.kinematics.link_pose(cell.state, "link4").translation
    cell.scene.add_object(thing("crate", at(*start), Shape(Box((0.02, 0.02, 0.02)))), at(*start))
    goal = PositionGoal(TCP, np.array(place))
    error = explained(
        cell.planner.plan, MotionRequest("arm", cell.state, FreeMotion(goal), OPTIONS)
    )
    listed = stage(error, "inverse kinematics").details[:-1]  # the last counts the others
    names = [line.partition(":")[0] for line in listed]
    assert len(set(names)) == len(names) > 2
    postures = {name.partition(" [")[0] for name in names}
    assert len(postures) < len(names)


def test_a_start_in_collision_is_reported_next_to_what_is_known_of_the_goal():
    cell = Cell(ur("ur3e"))
    tip = cell.kinematics.link_pose(cell.state, "wrist_1_link").translation
    cell.scene.add_object(thing("crate", at(*tip), Shape(Box((0.2, 0.2, 0.2)))), at(*tip))
    error = explained(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(grasp_goal(0.9, 0, 0.3)), OPTIONS),
    )
    assert error.code == "START_STATE_IN_COLLISION"
    assert stage(error, "reach").code == "NO_IK_SOLUTION"
    assert stage(error, "start state").code == "START_STATE_IN_COLLISION"
    assert any("crate" in line for line in stage(error, "start state").details)
    assert stage(error, "path").status == "skipped"


def test_limits_that_forbid_every_branch_are_reported_with_joint_and_excess():
    narrow = ur("ur3e")
    joints = tuple(
        replace(joint, lower=-0.2, upper=0.2) if joint.name == "wrist_2_joint" else joint
        for joint in narrow.joints
    )
    cell = Cell(replace(narrow, joints=joints))
    error = explained(
        cell.planner.plan,
        MotionRequest(ARM, cell.state, FreeMotion(grasp_goal(0.32, -0.17, 0.3)), OPTIONS),
    )
    assert error.code == "NO_IK_SOLUTION"
    branches = stage(error, "inverse kinematics")
    assert branches.code == "NO_IK_SOLUTION"
    assert "0 free, 4 beyond a joint limit" in branches.text
    beyond = [line for line in branches.details if "wrist_2_joint would be at" in line]
    assert len(beyond) >= 3
    assert "1.371 rad (78.5°) beyond its limit" in beyond[0]


def test_four_joints_report_what_of_a_pose_they_miss_and_take_it_where_that_is_allowed():
    cell = Cell(open_manipulator())
    pose = at(0.25, 0.0, 1.095, rpy=(0, 0, 0.02))
    error = explained(
        cell.planner.plan,
        MotionRequest("arm", cell.state, FreeMotion(PoseGoal(TCP, pose)), OPTIONS),
    )
    assert error.code == "GOAL_CONSTRAINTS_VIOLATED"
    assert error.facts["orientation_error"] == pytest.approx(0.02)
    allowed = PoseGoal(TCP, pose, orientation_tolerance=0.03)
    found = cell.planner.plan(
        MotionRequest("arm", cell.state, FreeMotion(allowed), OPTIONS)
    ).explanation.plain()
    assert found["ik_task"] == "position and pitch"
    for solution in found["ik_solutions"]:
        assert solution["residual"]["orientation"] == pytest.approx(0.02)
        assert solution["residual"]["position"] < 1e-9


def test_tolerances_about_axes_are_kept_one_by_one():
    """Turned by 0.5 rad about z, where the arm cannot follow: room about x and y does not help."""
    cell = Cell(open_manipulator())
    pose = at(0.25, 0.0, 1.095, rpy=(0, 0, 0.5))
    for about_z in (0.6, 3.15):
        goal = PoseGoal(TCP, pose, 1e-3, about_z, (0.01, 0.01, about_z))
        assert (
            cell.planner.plan(
                MotionRequest("arm", cell.state, FreeMotion(goal), OPTIONS)
            ).trajectory.duration
            > 0
        )
    wrong = PoseGoal(TCP, pose, 1e-3, 0.6, (0.6, 0.6, 0.4))
    error = explained(
        cell.planner.plan, MotionRequest("arm", cell.state, FreeMotion(wrong), OPTIONS)
    )
    assert error.code == "GOAL_CONSTRAINTS_VIOLATED"
    assert "34.4°, 34.4°, 22.9° about x, y, z are allowed" in error.message


def test_joints_are_reported_in_their_own_units():
    cell = Cell(ur("ur3e"))
    beyond = JointGoal(np.array([-3.5, -1.57, 0, 0, 0, 0]))
    error = explained(
        cell.planner.plan, MotionRequest(ARM, cell.state, FreeMotion(beyond), OPTIONS)
    )
    [line] = stage(error, "reach").details
    assert "at -3.500 rad (-200.5°), 0.159 rad (9.1°) beyond its limit -3.341 rad" in line
    nearest = error.facts["nearest"]["joint_positions"]
    assert nearest["shoulder_pan_joint"] == pytest.approx(-3.3406585, abs=1e-6)


FAR = grasp_goal(1.1, 0.2, 0.4)
MOTIONS = {
    "a free motion": FreeMotion(FAR),
    "a free motion without constraints": FreeMotion(FAR, None),
    "a line": LinearMotion(FAR),
}


@pytest.mark.nightly(but=["a line"])
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_every_motion_to_a_goal_explains_it_alike(motion):
    cell = Cell(ur("ur3e"))
    error = explained(cell.planner.plan, MotionRequest(ARM, cell.state, motion, OPTIONS))
    assert error.code == "NO_IK_SOLUTION"
    reach = stage(error, "reach")
    assert reach.status == "failed"
    free = MotionRequest(ARM, cell.state, FreeMotion(FAR), OPTIONS)
    assert reach == stage(explained(cell.planner.check_goal, free), "reach")


@pytest.mark.parametrize("kind", [np.array, list, tuple])
def test_joint_positions_are_explained_in_whatever_form_they_are_given(kind):
    cell = Cell(ur("ur3e"))
    positions = kind([0.0, -1.5, 4.0, -1.7, -1.57, 0.0])
    error = explained(
        lambda: cell.planner.plan(MotionRequest(ARM, cell.state, JointMotion(positions), OPTIONS))
    )
    assert error.code == "GOAL_STATE_INVALID"
    assert "elbow_joint would be at 4.000 rad" in stage(error, "reach").details[0]
    assert error.facts["advice"].startswith("give elbow_joint at most")


def test_a_motion_without_a_goal_of_its_own_is_explained_by_keywords():
    cell = Cell(ur("ur3e"))
    error = explained(
        lambda: cell.planner.plan(
            MotionRequest(
                ARM,
                cell.state,
                RelativeMotion(TCP, np.array([1.0, 0, 0, 0, 0, 0]), (3.0, 3.0)),
                OPTIONS,
            )
        )
    )
    assert recorded_explanation(error.details).stages[0].stage == "start state"
    assert stage(error, "path").status == "failed"
