"""Numeric inverse kinematics finds what the page of the robots says, singular places included."""

import re
from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import pitch_of
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.pose_table import pose_table
from harness.planning.model.robot_model import GroupSpace, RobotModel
from harness.ports.goals import PoseGoal, PositionGoal
from harness.robot.load import load_robot
from tests.planning.ik_success import ARMS, ATTEMPTS, KINDS, PAGE, POSES, measure

ROW = re.compile(r"(?m)^\| `(\w+)` \| \d \| ([\w ]+) \| (.*) \| 1e-(\d\d) \|$")


def stated():
    """(arm, goal) -> rates [%] as the page has them."""
    return {
        (arm, kind): [float(rate) for rate in re.findall(r"([\d.]+) %", rates)]
        for arm, kind, rates, _ in ROW.findall(PAGE.read_text(encoding="utf-8"))
    }


def test_the_page_states_every_arm_and_goal():
    rates = stated()
    assert list(rates) == [(arm, kind) for arm in ARMS for kind in KINDS]
    assert min(row[-1] for row in rates.values()) >= 99.5
    assert all(int(row[3]) >= 8 for row in ROW.findall(PAGE.read_text(encoding="utf-8")))


@pytest.mark.parametrize("arm", ARMS)
def test_a_sample_of_random_reachable_goals_is_found(arm):
    for kind in KINDS:
        success = measure(arm, kind, 12)
        assert success.found[-1] == success.poses
        assert success.residual < 1e-8


@pytest.mark.nightly
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("arm", ARMS)
def test_the_rates_are_those_of_the_page(arm, kind):
    success = measure(arm, kind, POSES)
    measured = [100 * count / success.poses for count in success.found]
    assert len(measured) == len(ATTEMPTS)
    assert measured == pytest.approx(stated()[arm, kind], abs=0.5)


def test_searches_start_nearest_to_the_goal_wherever_the_gripper_is():
    spec = RobotSpec.model_validate({"model": "ur5e", "gripper": "rh_p12_rn_a"})
    description = load_robot(spec)
    robot, start = RobotModel(description), description.start_positions()
    group, link = description.arm_group, description.tcp_link
    goal = PoseGoal(link, robot.link_pose(start, link))
    spaces = [GroupSpace(robot, group, state) for state in (start, start + 0.1)]
    tables = [pose_table(space, link) for space in spaces]
    assert tables[0] is tables[1]  # joints that do not carry the link make no difference
    found = tables[0].nearest(goal, 1024)
    away = [
        goal.pose.distance_to(robot.link_pose(spaces[0].whole(row), link))
        for row in found[[*range(20), *range(-20, 0)]]
    ]
    shifts, turns = np.array(away).T
    assert shifts[:20].mean() < 0.4 * shifts[20:].mean()
    assert turns[:20].mean() < 0.6 * turns[20:].mean()
    again = pose_table(GroupSpace(RobotModel(description), group, start), link)
    assert np.array_equal(again.nearest(goal, 1024), found)


SINGULAR = {
    "wrist": [0.4, -1.2, 1.3, -0.8, 0.0, 0.7],
    "elbow stretched": [0.4, -1.2, 0.0, -0.8, 1.1, 0.7],
    "shoulder": None,  # the wrist's centre over joint 1: found below
}


def singular_positions(kinematics, name, start):
    """Joint positions at a singularity; for the shoulder's, the reach is brought to joint 1."""
    if SINGULAR[name] is not None:
        return np.array(SINGULAR[name])
    q = np.array([0.4, -1.9, 0.0, -0.8, 1.1, 0.7])

    def ahead(elbow):
        """How far the wrist's centre is in front of joint 1's axis [m]."""
        state = np.array(start)
        state[:6] = [*q[:2], elbow, *q[3:]]
        base = kinematics.link_pose(state, "shoulder_link").inverse()
        return (base @ kinematics.link_pose(state, "wrist_2_link")).translation[0]

    elbows = np.linspace(-2.5, 2.5, 51)
    signs = np.sign([ahead(elbow) for elbow in elbows])
    place = int(np.flatnonzero(np.diff(signs))[0])
    low, high = elbows[place], elbows[place + 1]
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ahead(low) * ahead(middle) > 0 else (low, middle)
    q[2] = low
    return q


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("solver", ["ur", "numeric"])
@pytest.mark.parametrize("name", SINGULAR)
def test_at_and_near_a_singularity_solutions_are_true_finite_and_next_to_the_arm(name, solver, off):
    description = load_robot(RobotSpec.model_validate({"model": "ur5e"}))
    kinematics = PinocchioKinematics(replace(description, ik_solver=solver))
    start = description.start_positions()
    positions = singular_positions(kinematics, name, start)
    positions[[2, 4]] += off
    start[:6] = positions
    pose = kinematics.link_pose(start, description.tcp_link)
    goal = PoseGoal(description.tcp_link, pose, orientation_tolerance=1e-6)
    found = kinematics.solve(description.arm_group, goal, start, 0)
    assert found
    for q in found:
        assert np.all(np.isfinite(q))
        state = np.array(start)
        state[:6] = q
        shift, angle = pose.distance_to(kinematics.link_pose(state, description.tcp_link))
        assert max(shift, angle) < 1e-6
    assert np.abs(found[0] - positions).max() < 2e-3


@pytest.mark.parametrize("degrees", [80, 87.5, 89.5, 89.99, 89.9999, 90, -89.99, -90])
def test_steep_pitches_are_found_as_surely_as_others(degrees):
    description = load_robot(RobotSpec.model_validate({"model": "open_manipulator_x"}))
    kinematics = PinocchioKinematics(replace(description, ik_solver="numeric"))
    start = description.start_positions()
    link, pitch = description.tcp_link, float(np.radians(degrees))
    bent = np.array([0.3, 0.3, 0.3]) if degrees > 0 else np.array([0.3, -0.6, -0.3])
    state = np.array(start)
    state[:4] = [*bent, pitch - bent[1] - bent[2]]
    point = kinematics.link_pose(state, link).translation
    found = kinematics.solve("arm", PositionGoal(link, point, pitch), start, 0)
    assert found
    state = np.array(start)
    state[:4] = found[0]
    pose = kinematics.link_pose(state, link)
    assert np.linalg.norm(pose.translation - point) < 1e-7
    assert pitch_of(pose.rotation) == pytest.approx(pitch, abs=1e-6)
