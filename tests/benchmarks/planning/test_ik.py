"""Inverse kinematics: all branches of a UR against eaik's, and seven arms without a closed form."""

import statistics
import time

import numpy as np
import pinocchio as pin
import pytest
from eaik.IK_HP import HPRobot

from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.numeric import solve_numeric
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.closed_forms.ur_arm import UrGeometry, solve_ur
from harness.plugins.motions.held_constraints import random_positions
from harness.ports.goals import PoseGoal
from harness.robot.load import load_robot
from tests.installed import is_installed
from tests.packages.arms import ARMS

GROUP = "ur_manipulator"
POSES = 1000
REPEATS = 4
"""Calls timed at once: the clock's own reading counts less."""

CLOSED_GOAL = "closed form 15 us"


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
    heading = f"inverse kinematics of a {model}, us of CPU time, median (goal: {CLOSED_GOAL})"
    print_row(heading, "solver", "us", "branches")
    for name, (median, branches) in rows.items():
        print_row(heading, name, f"{1e6 * median:.1f}", f"{branches:.2f}")
    assert min(counts) >= 1


NUMERIC = (
    "panda_description/urdf/panda.urdf",
    "xarm_description/urdf/xarm7.urdf",
    "kinova_description/robots/kinova.urdf",
    "franka_robot_model/fr3.urdf",
    "so_arm_description/urdf/so100.urdf",
    "talos_data/robots/talos_left_arm.urdf",
    "urdf/lbr_iiwa_14_r820.xacro",
)
"""Arms of six and seven joints in the packages of the extra `packages`."""

NUMERIC_POSES, SPREADS = 1000, 100
DAMPING, ITERATIONS, RESTARTS, REACHED = 1e-6, 20, 200, 1e-6
"""Of the baseline; the damping and the iterations with which a Panda takes the least time."""
GOAL = "first 0.25 ms, 99.9 % solved, a spread 3 ms"


@pytest.mark.benchmark
@pytest.mark.parametrize("file", NUMERIC)
def test_numeric_solutions_of_random_reachable_poses(file, print_row):
    arm = next(arm for arm in ARMS if arm.file.endswith(file))
    if not is_installed(arm.package):
        pytest.skip(f"{arm.package} is in the extra `packages`")
    description = load_robot(RobotSpec.model_validate(arm.words(with_srdf=False)))
    kinematics, start = PinocchioKinematics(description), description.start_positions()
    space = GroupSpace(kinematics.robot, description.arm_group, start)
    rng, first, spread, solved, counts = np.random.default_rng(3), [], [], 0, []
    baseline = []
    for number in range(NUMERIC_POSES):
        positions = space.whole(random_positions(space, rng))
        goal = PoseGoal(description.tcp_link, kinematics.link_pose(positions, description.tcp_link))
        begin = time.process_time_ns()
        solved += bool(solve_numeric(space, goal, space.part(start), enough=1))
        first.append(time.process_time_ns() - begin)
        if number < SPREADS:
            begin = time.process_time_ns()
            counts.append(len(solve_numeric(space, goal, space.part(start))))
            spread.append(time.process_time_ns() - begin)
            begin = time.process_time_ns()
            _restarted_least_squares(space, goal, np.random.default_rng(number))
            baseline.append(time.process_time_ns() - begin)
    heading = f"numeric inverse kinematics, ms of CPU time (goal: {GOAL})"
    if file == NUMERIC[0]:
        print_row(heading, "arm", "joints", "solved", "first", "95 %", "spread", "solutions",
                  "damped least squares, first", "to ours")  # fmt: skip
    print_row(
        heading,
        file.rpartition("/")[2].split(".")[0],
        f"{space.dof}",
        f"{100 * solved / NUMERIC_POSES:.1f} %",
        f"{1e-6 * statistics.median(first):.2f}",
        f"{1e-6 * np.percentile(first, 95):.2f}",
        f"{1e-6 * statistics.median(spread):.2f}",
        f"{statistics.mean(counts):.1f}",
        f"{1e-6 * statistics.median(baseline):.2f}",
        f"{statistics.median(baseline) / statistics.median(first):.1f}x",
    )
    assert solved >= 0.99 * NUMERIC_POSES


def _restarted_least_squares(
    space: GroupSpace, goal: PoseGoal, rng: np.random.Generator
) -> np.ndarray | None:
    """The usual loop around Pinocchio: steps inside the limits, from random positions."""
    model, data = space.robot.model, space.robot.data
    frame, target = space.robot.frame_id(goal.link), pin.SE3(goal.pose.matrix())
    damping = DAMPING * np.eye(6)
    for _ in range(RESTARTS):
        positions = random_positions(space, rng)
        for _ in range(ITERATIONS):
            configuration = space.configuration(positions)
            pin.forwardKinematics(model, data, configuration)
            missing = pin.updateFramePlacement(model, data, frame).actInv(target)
            error = pin.log6(missing).vector
            if np.linalg.norm(error) < REACHED:
                return positions
            moves = pin.computeFrameJacobian(model, data, configuration, frame, pin.LOCAL)
            jacobian = pin.Jlog6(missing.inverse()) @ space.jacobian(moves)
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping, error)
            positions = np.clip(positions + step, space.lower, space.upper)
    return None


def _median(call, arguments) -> float:
    times = []
    for argument in arguments:
        begin = time.process_time_ns()
        for _ in range(REPEATS):
            call(argument)
        times.append((time.process_time_ns() - begin) / REPEATS)
    return 1e-9 * statistics.median(times)
