"""Motions stay inside the joints' efforts, with what the robot holds."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape
from harness.core.world import WorldObject
from harness.planning.efforts import InverseDynamics
from harness.planning.model.robot_model import GroupSpace
from harness.planning.timing.timing import BlendedPath, Limits, time_blended, time_straight
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion
from harness.recording.motion_failures import OverloadFailure
from tests.planning.lesson import ARM, TCP, Cell, ur

START = np.array([0.0, -0.6, 0.4, -1.4, -1.57, 0.0])
AWAY = np.array([[0, 0, 0, 0, 0, 0], [0.5, -0.6, 0.9, 0.2, 0.1, 0], [1.0, 0.1, 0.2, 0, 0, 1]])
PATH = START + AWAY
OPTIONS = PlanningOptions(seed=1)


def cell_with(mass):
    """A UR3e alone, a mass in its gripper."""
    cell = Cell(ur("ur3e"), with_tables=False)
    cell.state = cell.with_arm(START)
    if mass:
        pose = cell.kinematics.link_pose(cell.state, TCP)
        inertia = 1e-3 * np.eye(3)
        shape = Shape(Box((0.02, 0.02, 0.02)))
        load = WorldObject("load", (shape,), pose, False, mass, np.zeros(3), inertia)
        cell.scene.add_object(load, pose)
        cell.scene.attach_object("load", TCP, cell.description.gripper.links, cell.state)
    return cell


def dynamics_of(cell):
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    return InverseDynamics.of(space, cell.scene.payloads())


def test_efforts_at_rest_hold_the_weight_of_a_load_against_the_work_it_does():
    """By the principle of virtual work: the difference is the load's weight times the Jacobian."""
    still = np.zeros((1, 6))
    bare, loaded = (
        dynamics_of(cell_with(mass)).efforts(START[None], still, still)[0] for mass in (0, 2.0)
    )
    cell = cell_with(0)
    step = 1e-6
    heights = []
    for joint in range(6):
        moved = START.copy()
        moved[joint] += step
        up = cell.kinematics.link_pose(cell.with_arm(moved), TCP).translation[2]
        down = cell.kinematics.link_pose(cell.with_arm(START), TCP).translation[2]
        heights.append((up - down) / step)
    assert np.allclose(loaded - bare, 2.0 * 9.81 * np.array(heights), atol=1e-4)


@pytest.mark.parametrize("mass", [0, 1.0, 40.0])
def test_limits_above_the_bound_of_gravity_hold_the_arm_wherever_it_stands(mass):
    """The bound is above what a thousand positions need, and not above three times of it."""
    dynamics = dynamics_of(cell_with(mass))
    drawn = np.random.default_rng(3).uniform(-np.pi, np.pi, (1000, 6))
    still = np.zeros_like(drawn)
    needed = np.abs(dynamics.efforts(drawn, still, still)).max(axis=0)
    assert not replace(dynamics, limits=needed * 0.99).holds_anywhere
    moves_a_lot = needed > 0.5 * needed.max()  # the shoulder; a wrist's chain is never straight
    limits = np.where(moves_a_lot, 3 * needed, 1e6)
    assert replace(dynamics, limits=limits).holds_anywhere


@pytest.mark.parametrize("way", ["straight", "toppra"])
def test_a_motion_is_slowed_until_its_efforts_are_kept(way):
    dynamics = dynamics_of(cell_with(1.0))
    still = np.zeros_like(PATH)
    standing = np.abs(dynamics.efforts(PATH, still, still)).max(axis=0)
    tight = replace(dynamics, limits=standing * 1.25 + 1.0)
    free = Limits.scaled(np.full(6, np.pi), np.full(6, 20.0), 1.0, 1.0)
    bound = replace(free, dynamics=tight)
    names = dynamics.joint_names

    def timed(limits):
        if way == "straight":
            return time_straight(names, PATH[0], PATH[1], limits)
        return time_blended(names, BlendedPath(PATH, 0.05), limits)

    def share(trajectory):
        efforts = dynamics.efforts(
            trajectory.positions, trajectory.velocities, trajectory.accelerations
        )
        return np.abs(efforts / tight.limits).max()

    fast, slow = timed(free), timed(bound)
    assert share(fast) > 1.2
    assert 0.85 < share(slow) <= 1.01
    assert slow.duration > fast.duration


def test_a_load_that_the_arm_cannot_hold_never_moves():
    cell = cell_with(20.0)
    goal = JointGoal(np.array([0.0, 0.0, 0.0, -1.4, -1.57, 0.0]))
    with pytest.raises(PlanningFailed) as caught:
        cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions()))
    assert caught.value.code == "INVALID_MOTION_PLAN"
    facts = caught.value.facts
    assert "the arm cannot hold load (20 kg) still" in caught.value.message
    assert f"needs {facts['effort']:.1f} N m and has at most 28.0 N m" in caught.value.message
    assert "no slower motion helps: give load a `mass` of at most" in facts["advice"]
    light = cell_with(1.0).planner.plan(
        MotionRequest(ARM, cell.state, FreeMotion(goal), PlanningOptions())
    )
    assert light.trajectory.duration > 0


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_the_largest_mass_that_is_advised_is_the_largest_that_the_arm_holds(share):
    posture = np.array([0.0, 0.0, 0.0, -1.4, -1.57, 0.0])
    _, details = dynamics_of(cell_with(20.0)).standing_overload(posture[None])
    dynamics = dynamics_of(cell_with(share * details.find(OverloadFailure).most_mass))
    still = np.zeros((1, 6))
    efforts = np.abs(dynamics.efforts(posture[None], still, still)[0])
    assert bool(np.all(efforts <= dynamics.limits)) == (share < 1)


def test_an_arm_too_weak_for_itself_is_not_advised_to_hold_less():
    dynamics = dynamics_of(cell_with(0))
    weak = replace(dynamics, limits=np.full(6, 5.0))
    message, details = weak.standing_overload(START[None])
    assert "cannot hold itself still" in message
    assert details.find(OverloadFailure).most_mass is None


def test_the_library_agrees_about_the_whole_robot():
    cell = cell_with(0)
    robot = cell.kinematics.robot
    configuration = robot.configuration(cell.with_arm(START))
    gravity = pin.computeGeneralizedGravity(robot.model, robot.model.createData(), configuration)
    still = np.zeros((1, 6))
    found = dynamics_of(cell).efforts(START[None], still, still)[0]
    arm = robot.velocity_columns[list(cell.description.group_indices(ARM))]
    assert np.allclose(found, gravity[arm])


@pytest.mark.parametrize(
    ("start", "goal"),
    [
        ([0.0, -1.5, 2.3, 1.1, -1.6, 0.0], [0.0, -2.0, -1.1, 1.5, -1.6, 0.0]),
        ([0.0, -1.5, 1.5, -1.1, -1.6, 0.0], [0.0, -2.6, 0.2, -1.2, -1.6, 0.0]),
    ],
)
def test_a_motion_goes_around_postures_in_which_the_arm_cannot_hold_its_load(start, goal):
    """The straight way is free, but the arm with its load would be too far stretched on it."""
    cell = cell_with(5.0)
    dynamics = dynamics_of(cell)
    cell.state = cell.with_arm(start)
    assert not dynamics.can_hold(np.linspace(start, goal, 50))
    request = MotionRequest(ARM, cell.state, FreeMotion(JointGoal(np.array(goal))), OPTIONS)
    plan = cell.planner.plan(request)
    assert dynamics.can_hold(plan.trajectory.positions)
    assert plan.trajectory.positions[-1] == pytest.approx(goal)


def test_a_goal_at_which_the_arm_cannot_hold_its_load_is_named():
    cell = cell_with(8.0)
    cell.state = cell.with_arm([0.0, -1.5, 2.3, 1.1, -1.6, 0.0])
    stretched = JointGoal(np.array([0.0, 0.0, 0.0, -1.4, -1.57, 0.0]))
    with pytest.raises(PlanningFailed, match=r"cannot hold load \(8 kg\) still at the goal"):
        cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(stretched), OPTIONS))
