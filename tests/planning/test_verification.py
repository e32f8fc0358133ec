"""A trajectory is checked as it will be commanded: whatever is wrong with it is found and named."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box, Shape
from harness.core.trajectory import JointTrajectory
from harness.planning.task import make_task
from harness.planning.timing.timing import BlendedPath, time_blended, time_straight
from harness.planning.verification.verify import (
    distances_to_path,
    find_defect,
    find_departure,
)
from harness.plugins.motions.held_constraints import PathBands
from harness.ports.goals import JointBand, PathConstraints
from harness.ports.motion_planning import PlanningOptions
from tests.planning.lesson import ARM, Cell, thing, ur

PALM = "rh_p12_rn_base"
START = np.array([-0.86, -1.5, 1.6, -1.7, -1.57, -1.6])
END = START + np.array([0.8, -0.2, 0.3, 0.0, 0.1, 0.5])


@pytest.fixture(scope="module")
def task():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(START)
    options = PlanningOptions(velocity_scaling=0.4, acceleration_scaling=0.4, max_jerk=50.0)
    return make_task(cell.scene, cell.kinematics.robot, ARM, cell.state, options)


@pytest.fixture
def good(task):
    return time_straight(task.space.joint_names, START, END, task.limits)


def changed(trajectory, **arrays):
    """A trajectory with some of its rows changed: name -> (row, joint, what is added)."""
    copies = {
        name: np.array(getattr(trajectory, name))
        for name in ("times", "positions", "velocities", "accelerations")
    }
    for name, (place, more) in arrays.items():
        copies[name][place] += more
    return JointTrajectory(trajectory.joint_names, **copies)


def broken(task, trajectory, **other):
    defect = find_defect(
        trajectory, task.checker, START, END, other.get("limits", task.limits), other.get("held")
    )
    return None if defect is None else defect.details.plain()["broken"]


MISTAKES = {
    "stamps": {"times": (20, -0.02)},
    "start": {"positions": ((0, 1), 1e-5)},
    "end": {"positions": ((-1, 1), 1e-5)},
    "rest at start": {"velocities": ((0, 2), 1e-4)},
    "rest at end": {"velocities": ((-1, 2), 1e-4)},
    "position limit": {"positions": ((30, 2), 9.0)},
    "velocity limit": {"velocities": ((30, 0), 3.0)},
    "acceleration limit": {"accelerations": ((30, 0), 9.0)},
    "jerk limit": {"accelerations": ((30, 5), 0.6)},
}


def test_a_whole_trajectory_has_no_defect(task, good):
    assert broken(task, good) is None


@pytest.mark.parametrize("what", MISTAKES)
def test_every_mistake_is_found_and_named(task, good, what):
    assert broken(task, changed(good, **MISTAKES[what])) == what


@pytest.mark.parametrize("name", ["times", "positions", "velocities", "accelerations"])
def test_a_number_that_is_none_is_a_defect(task, good, name):
    place = 30 if name == "times" else (30, 0)
    assert broken(task, changed(good, **{name: (place, np.nan)})) is not None


def test_efforts_and_constraints_are_part_of_it(task, good):
    dynamics = task.limits.dynamics
    weak = replace(dynamics, limits=np.full(6, 3.0))
    assert broken(task, good, limits=replace(task.limits, dynamics=weak)) == "standing effort"
    at_rest = np.zeros_like(good.positions)
    standing = np.abs(dynamics.efforts(good.positions, at_rest, at_rest)).max(axis=0)
    enough_to_stand = replace(dynamics, limits=standing + 0.01)
    limits = replace(task.limits, dynamics=enough_to_stand)
    assert broken(task, good, limits=limits) == "effort limit"
    pan = task.space.joint_names[0]
    held = PathConstraints(joints=(JointBand(pan, START[0] - 0.1, START[0] + 0.4),))
    assert (
        broken(task, good, held=PathBands(held, task.space, task.checker.scene.frame))
        == "path constraints"
    )


@pytest.mark.parametrize(("share", "found"), [(0.97, True), (0.995, False), (1.03, False)])
def test_efforts_may_exceed_their_limits_by_a_hundredth(task, good, share, found):
    dynamics = task.limits.dynamics
    efforts = dynamics.efforts(good.positions, good.velocities, good.accelerations)
    limits = np.full(6, np.inf)
    limits[1] = share * np.abs(efforts[:, 1]).max()
    tight = replace(task.limits, dynamics=replace(dynamics, limits=limits))
    assert (broken(task, good, limits=tight) is not None) == found


def test_what_is_in_the_way_is_found_with_its_time(good):
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(START)
    half = len(good.positions) // 2
    tool = cell.kinematics.link_pose(cell.with_arm(good.positions[half]), PALM)
    cell.add(thing("crumb", tool, Shape(Box((0.02, 0.02, 0.02)))))
    task = make_task(cell.scene, cell.kinematics.robot, ARM, cell.state, PlanningOptions())
    defect = find_defect(good, task.checker, START, END, task.limits)
    assert defect is not None
    assert defect.details.plain()["broken"] == "collision"
    assert "and crumb" in defect.message
    assert defect.details.plain()["time"] == pytest.approx(good.times[half], abs=0.2)


def test_a_trajectory_off_the_path_that_was_checked_is_found(task):
    path = np.array([START, START + np.array([0.4, 0.2, 0, 0, 0, 0]), END])
    trajectory = time_blended(task.space.joint_names, BlendedPath(path, 0.05), task.limits)
    away = distances_to_path(trajectory.positions, path)
    assert find_departure(trajectory, away, 0.05) is None
    tight = find_departure(trajectory, away, 0.005)
    assert tight is not None
    assert 0.005 < tight.details.plain()["path_deviation"] <= 0.05
    corner = np.linalg.norm(trajectory.positions - path[1], axis=1).min()
    assert tight.details.plain()["path_deviation"] <= corner + 1e-9
