"""All branches of a UR's inverse kinematics, against eaik's on the same poses."""

import statistics
import time

import numpy as np
import pytest
from eaik.IK_HP import HPRobot

from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.ur import UrGeometry, solve_ur
from harness.ports import PoseGoal
from harness.robot.load import load_robot

GROUP = "ur_manipulator"
POSES = 1000
REPEATS = 4
"""Calls timed at once: the clock's own reading counts less."""

LONGEST = 15e-6  # [s], median


@pytest.mark.benchmark
@pytest.mark.parametrize("model", ["ur5e", "ur3e"])
def test_all_branches_of_a_ur_in_microseconds(model, print_row):
    description = load_robot(RobotSpec.model_validate({"model": model}))
    kinematics = PinocchioKinematics(description)
    joints = [description.joint_by_name[n] for n in description.groups[GROUP].joint_names]
    zero = np.zeros(len(description.joint_names))
    links = [kinematics.link_pose(zero, joint.child) for joint in joints]
    tip = joints[-1].child
    rng = np.random.default_rng(8)
    poses = [kinematics.link_pose(rng.uniform(-np.pi, np.pi, len(zero)), tip) for _ in range(POSES)]
    points = [np.zeros(3), *(link.translation for link in links), links[-1].translation]
    theirs = HPRobot(np.array([link.rotation[:, 2] for link in links]), np.diff(points, axis=0))
    geometry = UrGeometry.of_joints(tuple(joints))
    T_base_world = kinematics.link_pose(zero, joints[0].parent).inverse()
    targets = [T_base_world @ pose for pose in poses]
    matrices = [pose.matrix() for pose in poses]
    goals = [PoseGoal(tip, pose) for pose in poses[::10]]

    ours = _median(lambda target: solve_ur(geometry, target, 0.0), targets)
    counts = [len(solve_ur(geometry, target, 0.0).branches) for target in targets]
    rows = {
        "closed form": (ours, statistics.mean(counts)),
        "eaik": (
            _median(theirs.IK, matrices),
            statistics.mean(len(theirs.IK(m).Q) for m in matrices),
        ),
        "port, polished and turned into the limits": (
            _median(lambda goal: kinematics.solve(GROUP, goal, zero, 0), goals),
            statistics.mean(len(kinematics.solve(GROUP, goal, zero, 0)) for goal in goals),
        ),
    }
    heading = f"inverse kinematics of a {model}, us of CPU time, median"
    print_row(heading, "solver", "us", "branches")
    for name, (median, branches) in rows.items():
        print_row(heading, name, f"{1e6 * median:.1f}", f"{branches:.2f}")
    assert min(counts) >= 1
    assert ours <= LONGEST


def _median(call, arguments) -> float:
    times = []
    for argument in arguments:
        begin = time.process_time_ns()
        for _ in range(REPEATS):
            call(argument)
        times.append((time.process_time_ns() - begin) / REPEATS)
    return 1e-9 * statistics.median(times)
