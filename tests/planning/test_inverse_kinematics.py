"""Inverse kinematics against forward kinematics, a second solver, and published joint sets."""

from dataclasses import replace

import numpy as np
import pytest
from eaik.IK_HP import HPRobot

from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.ports.goals import PoseGoal, PositionGoal
from harness.robot.load import load_robot
from tests.planning.lesson import ARM, TCP, grasp_goal, open_manipulator, ur

# Numeric inverse kinematics, 300 random starts, of ur_description 4.3.1 (the lesson's steps).
PUBLISHED = {
    ("ur3e", (0.32, -0.17, 0.3)): [
        [-0.85839, -0.74483, -0.47442, -0.35155, -1.5708, -1.64329],
        [-0.85839, -1.18712, 0.47442, -0.85809, -1.5708, -1.64329],
        [3.02331, -1.95447, -0.47442, -2.2835, 1.5708, -0.90319],
        [3.02331, -2.39676, 0.47442, -2.79004, 1.5708, -0.90319],
    ],
    ("ur3e", (0.0, -0.4, 0.09)): [
        [-1.90459, -1.18623, 1.5233, -1.90787, -1.5708, -2.68949],
        [-1.90459, 0.21051, -1.5233, -0.25801, -1.5708, -2.68949],
        [1.90459, 2.93108, 1.5233, -2.88358, 1.5708, -2.02191],
        [1.90459, -1.95537, -1.5233, -1.23372, 1.5708, -2.02191],
    ],
    ("ur5e", (0.32, -0.17, 0.08)): [
        [-0.86505, 0.57624, -2.45565, 0.30862, -1.5708, -1.64996],
        [-0.86505, -1.65555, 2.45565, -2.3709, -1.5708, -1.64996],
        [-0.86505, 0.60151, -1.95061, 2.9199, 1.5708, 1.49163],
        [-0.86505, -1.23076, 1.95061, 0.85095, 1.5708, 1.49163],
        [3.02998, -1.91083, -1.95061, 2.29064, -1.5708, 2.24507],
        [3.02998, 2.54009, 1.95061, 0.22169, -1.5708, 2.24507],
        [3.02998, 2.56536, 2.45565, 2.83298, 1.5708, -0.89652],
        [3.02998, -1.48604, -2.45565, -0.7707, 1.5708, -0.89652],
    ],
}


def wrapped(angles):
    return (np.asarray(angles) + np.pi) % (2 * np.pi) - np.pi


def whole(description, arm):
    state = np.zeros(len(description.joint_names))
    state[: len(arm)] = arm
    return state


@pytest.mark.parametrize(("model", "xyz"), list(PUBLISHED))
def test_the_lesson_poses_have_the_published_solutions(model, xyz):
    description = ur(model)
    zero = np.zeros(len(description.joint_names))
    found = PinocchioKinematics(description).solve(ARM, grasp_goal(*xyz), zero, 0)
    for published in PUBLISHED[model, xyz]:
        assert min(np.abs(wrapped(q - published)).max() for q in found) < 1e-5
    assert len(found) <= len(PUBLISHED[model, xyz])


@pytest.mark.parametrize("model", ["ur3e", "ur5e"])
def test_all_branches_of_a_ur_are_found_exact_and_inside_the_limits(model):
    """Against eaik, which solves the same arm from the axes of its joints."""
    description = ur(model)
    kinematics = PinocchioKinematics(description)
    group = description.groups[ARM]
    joints = [description.joint_by_name[name] for name in group.joint_names]
    lower, upper = (np.array([getattr(j, side) for j in joints]) for side in ("lower", "upper"))
    zero = np.zeros(len(description.joint_names))
    origins = [kinematics.link_pose(zero, joint.child) for joint in joints]
    tip = kinematics.link_pose(zero, TCP)
    axes = np.array([T.rotation[:, 2] for T in origins])
    points = [np.zeros(3), *(T.translation for T in origins), tip.translation]
    other = HPRobot(axes, np.diff(points, axis=0))
    rng = np.random.default_rng(3)
    for _ in range(40):
        arm = rng.uniform(lower, upper)
        pose = kinematics.link_pose(whole(description, arm), TCP)
        found = kinematics.solve(ARM, PoseGoal(TCP, pose), zero, 0)
        assert min(np.abs(wrapped(q - arm)).max() for q in found) < 1e-6
        for q in found:
            assert np.all((q >= lower) & (q <= upper))
            shift, angle = pose.distance_to(kinematics.link_pose(whole(description, q), TCP))
            assert shift < 1e-9
            assert angle < 1e-9
        target = pose.matrix()
        target[:3, :3] = pose.rotation @ tip.rotation.T  # eaik's tool frame is turned as the base
        theirs = other.IK(target)
        for q, is_approximate in zip(theirs.Q, theirs.is_LS, strict=True):
            inside = [
                np.any((value + turns >= low) & (value + turns <= high))
                for value, low, high in zip(q, lower, upper, strict=True)
                for turns in [2 * np.pi * np.arange(-2, 3)]
            ]
            if not is_approximate and all(inside):
                assert min(np.abs(wrapped(mine - q)).max() for mine in found) < 1e-5


@pytest.mark.parametrize("model", ["ur3e", "ur5e", "ur10e"])
def test_a_stretched_ur_is_solved_next_to_and_at_the_singularity_of_its_wrist(model):
    """Rounded right angles seem to shorten the arm; at the singularity joint 6 must give way."""
    description = ur(model)
    kinematics = PinocchioKinematics(description)
    zero = np.zeros(len(description.joint_names))
    for wrist_2 in (0.0, 1e-9, 1e-6, -1e-4, 1e-2):
        for wrist_3 in (0.0, 0.05, -1.0, 3.0):
            arm = [0.3, -0.5, 0.0, -0.2, wrist_2, wrist_3]
            pose = kinematics.link_pose(whole(description, arm), TCP)
            found = kinematics.solve(ARM, PoseGoal(TCP, pose), zero, 0)
            assert found, (wrist_2, wrist_3)
            for q in found:
                reached = kinematics.link_pose(whole(description, q), TCP)
                assert max(pose.distance_to(reached)) < 1e-6


def test_solutions_are_turned_next_to_the_seed():
    description = ur("ur5e")
    kinematics = PinocchioKinematics(description)
    seed = whole(description, [3.5, -1.2, 1.0, -1.0, -1.5, 5.0])
    pose = kinematics.link_pose(seed, TCP)
    nearest = kinematics.solve(ARM, PoseGoal(TCP, pose), seed, 0)[0]
    assert np.allclose(nearest, seed[:6], atol=1e-7)


def test_the_open_manipulator_is_solved_over_its_whole_workspace():
    description = open_manipulator()
    kinematics = PinocchioKinematics(description)
    joints = [description.joint_by_name[n] for n in description.groups["arm"].joint_names]
    rng = np.random.default_rng(5)
    zero = np.zeros(len(description.joint_names))
    for _ in range(100):
        arm = np.array([rng.uniform(joint.lower, joint.upper) for joint in joints])
        pose = kinematics.link_pose(whole(description, arm), TCP)
        pitch = float(np.arcsin(-pose.rotation[2, 0]))
        for goal in (PoseGoal(TCP, pose), PositionGoal(TCP, pose.translation, pitch)):
            found = kinematics.solve("arm", goal, zero, 0)
            assert min(np.abs(wrapped(q - arm)).max() for q in found) < 1e-6
            for q in found:
                reached = kinematics.link_pose(whole(description, q), TCP)
                assert np.linalg.norm(reached.translation - pose.translation) < 1e-9


def test_a_pose_that_four_joints_cannot_take_has_no_solution():
    description = open_manipulator()
    kinematics = PinocchioKinematics(description)
    pose = kinematics.link_pose(whole(description, [0, 0, 0.3, 0.3]), TCP)
    turned = pose @ SE3.from_xyz_rpy(rpy=(0, 0, 0.2))
    zero = np.zeros(len(description.joint_names))
    assert kinematics.solve("arm", PoseGoal(TCP, turned), zero, 0) == ()


def test_a_free_pitch_leaves_many_solutions_and_the_least_motion_comes_first():
    description = open_manipulator()
    kinematics = PinocchioKinematics(description)
    seed = whole(description, [0.1, -0.3, 0.4, 0.3])
    point = kinematics.link_pose(seed, TCP).translation
    found = kinematics.solve("arm", PositionGoal(TCP, point), seed, 0)
    assert len(found) > 5
    assert np.allclose(found[0], seed[:4], atol=1e-7)


def test_any_chain_is_solved_numerically_and_the_same_every_time():
    description = replace(ur("ur3e"), ik_solver="numeric")
    kinematics = PinocchioKinematics(description)
    seed = np.zeros(len(description.joint_names))
    pose = kinematics.link_pose(whole(description, [0.5, -1.0, 1.0, -0.7, -1.2, 0.3]), "tool0")
    first = kinematics.solve(ARM, PoseGoal("tool0", pose), seed, 4)
    again = kinematics.solve(ARM, PoseGoal("tool0", pose), seed, 4)
    assert first
    assert [q.tobytes() for q in first] == [q.tobytes() for q in again]
    shift, angle = pose.distance_to(kinematics.link_pose(whole(description, first[0]), "tool0"))
    assert max(shift, angle) < 1e-7


def test_the_first_numeric_solution_alone_is_the_one_that_a_spread_begins_with():
    description = replace(ur("ur3e"), ik_solver="numeric")
    kinematics = PinocchioKinematics(description)
    seed = np.zeros(len(description.joint_names))
    reached = whole(description, [0.5, -1.0, 1.0, -0.7, -1.2, 0.3])
    goal = PoseGoal("tool0", kinematics.link_pose(reached, "tool0"))
    [first] = kinematics.solve(ARM, goal, seed, 5, enough=1)
    spread = kinematics.solve(ARM, goal, seed, 5)
    assert len(spread) > 1
    assert any(np.allclose(first, other, atol=1e-9) for other in spread)


def test_link_poses_of_many_samples_are_those_of_pinocchio():
    description = ur("ur3e")
    kinematics = PinocchioKinematics(description)
    rng = np.random.default_rng(1)
    samples = rng.uniform(-1, 1, (5, len(description.joint_names)))
    poses = kinematics.link_poses(samples, description.link_names)
    for row, sample in enumerate(samples):
        for column, link in enumerate(description.link_names):
            expected = kinematics.link_pose(sample, link).as_vector()
            assert np.allclose(poses[row, column], expected, atol=1e-9)


def test_a_pitch_is_against_the_horizontal_of_the_world_on_a_tilted_base_too():
    base = {"xyz": [0.2, 0.1, 0.5], "rpy": [0.1, 0.4, 1.6]}
    spec = RobotSpec.model_validate({"model": "open_manipulator_x", "base": base})
    tilted = load_robot(spec)
    kinematics = PinocchioKinematics(tilted)
    start = tilted.start_positions()
    here = kinematics.link_pose(start, tilted.tcp_link)
    pitch = -float(np.arcsin(here.rotation[2, 0]))
    goal = PositionGoal(tilted.tcp_link, here.translation, pitch)
    solutions = kinematics.solve(tilted.arm_group, goal, start, 0)
    assert solutions
    for solution in solutions:
        state = np.array(start)
        state[list(tilted.group_indices(tilted.arm_group))] = solution
        pose = kinematics.link_pose(state, tilted.tcp_link)
        assert np.linalg.norm(pose.translation - here.translation) < 1e-6
        assert -np.arcsin(pose.rotation[2, 0]) == pytest.approx(pitch, abs=1e-6)
