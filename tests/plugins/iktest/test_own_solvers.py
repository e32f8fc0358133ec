"""The solvers that plans are made with, under the tests that anybody's get."""

from dataclasses import replace

import pytest

from harness.core.spatial import SE3
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.iktest import IkTest, check_ik, run_ik_test
from harness.plugins.iktest.builtin_ik import own_solver
from harness.plugins.iktest.chain import Chain
from harness.ports.goals import PoseGoal
from harness.robot.robot_source import RobotSource, load_source


@pytest.mark.nightly
@pytest.mark.parametrize("robot", ["open_manipulator_x", "ur3e", "ur5e"])
def test_closed_forms_keep_every_property_and_find_every_way(robot):
    check_ik(own_solver(RobotSource(robot)), robot, branches=True, examples=40)


@pytest.mark.nightly
def test_a_tool_attached_to_a_gripper_is_solved_too():
    robot = RobotSource("ur3e", gripper="rh_p12_rn_a")
    check_ik(own_solver(robot), robot, branches=True, examples=30)


@pytest.mark.nightly
def test_the_numeric_solver_never_answers_wrongly():
    """It may find nothing near a singularity; what it answers is right, inside limits, the same."""
    robot = RobotSource("ur3e")
    description = replace(load_source(robot), ik_solver="numeric")
    kinematics, chain = PinocchioKinematics(description), Chain.of(load_source(robot))

    def numeric(matrix, seed):
        goal = PoseGoal(chain.link, SE3.from_matrix(matrix))
        return kinematics.solve(description.arm_group, goal, chain.whole(seed), 0)

    report = run_ik_test(IkTest(numeric, robot, examples=4))
    flawed = {each.name for each in report.properties if each.flawed}
    assert flawed <= {"answers"}
