"""Groups of many joints: both arms of a robot, and three of them, in one group."""

import re

import numpy as np
import pytest

from harness.core.geometry import Box, Shape
from harness.language.scenario import RobotSpec
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion
from harness.recording.plan_statistics import PlanStatistics
from harness.robot.load import load_robot
from tests.planning.lesson import Cell, at, thing
from tests.planning.seven_joints import seven_joint_urdf


def arms(folder, count):
    """Arms of seven joints next to each other, all in one group."""
    parts, joints = ['<link name="world_base"/>'], []
    for number in range(count):
        text = re.sub(r"^<robot[^>]*>|</robot>$", "", seven_joint_urdf())
        text = re.sub(r'((?:name|link)=")(\w+)"', rf'\g<1>a{number}_\g<2>"', text)
        mount = f'<parent link="world_base"/><child link="a{number}_base"/>'
        place = f'<origin xyz="0 {0.7 * number} 0"/>'
        parts.append(f'{text}<joint name="m{number}" type="fixed">{mount}{place}</joint>')
        joints += [f'<joint name="a{number}_j{joint}"/>' for joint in range(1, 8)]
    (folder / "arms.urdf").write_text(f'<robot name="arms">{"".join(parts)}</robot>')
    group = f'<group name="all">{"".join(joints)}</group>'
    (folder / "arms.srdf").write_text(f'<robot name="arms">{group}</robot>')
    return load_robot(RobotSpec(urdf="arms.urdf", srdf="arms.srdf"), folder)


@pytest.mark.parametrize("count", [2, 3])
def test_arms_in_one_group_are_planned_around_what_stands_between_them(tmp_path, count):
    cell = Cell(arms(tmp_path, count), with_tables=False)
    bent = np.tile([0.0, 0.9, 0.0, 0.9, 0.0, 0.3, 0.0], count)
    start, goal = bent.copy(), bent.copy()
    start[::7], goal[::7] = -0.5, 0.5
    for number in range(count):
        post = thing(f"post {number}", at(0.5, 0.7 * number, 0.3), Shape(Box((0.06, 0.06, 0.9))))
        cell.add(post)
    cell.state[list(cell.description.group_indices("all"))] = start
    request = MotionRequest(
        "all", cell.state, FreeMotion(JointGoal(goal)), PlanningOptions(padding=0.002, seed=1)
    )
    plan = cell.planner.plan(request)
    assert plan.statistics.find(PlanStatistics).planner_id == "BalancedConnect"
    assert plan.trajectory.positions[-1] == pytest.approx(goal)
    assert plan.trajectory.positions.shape[1] == 7 * count
