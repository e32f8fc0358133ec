"""Motions keep their margins everywhere: also where only a state in between is too near."""

from itertools import product

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Shape, Sphere
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import JointBand, JointGoal, PathConstraints, PoseGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion, JointMotion, LinearMotion
from tests.planning.lesson import TCP, Cell, at, gantry_cell, thing, ur

START = np.array([-0.86, -1.5, 1.6, -1.7, -1.57, -1.6])
END = START + np.array([0.8, -0.2, 0.3, 0.0, 0.1, 0.5])
PADDED, UNPADDED = 1 / 384, 1 / 1024  # [rad] between states of which none is too near
SIDE = 0.04  # [m] of the cube in the hand
CRUMB, OVERLAP = 2e-5, 1e-5  # [m] radius, and by how much it is too near


def bent_arm():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(START)
    return cell


def take_cube(cell, place):
    """Attach a cube of which no edge is parallel to the motion."""
    link = cell.description.tcp_link
    pose = cell.kinematics.link_pose(cell.state, link) @ place
    cell.add(thing("cube", pose, Shape(Box((SIDE, SIDE, SIDE)))))
    cell.scene.attach_object("cube", link, cell.description.gripper.links, cell.state)


def planned(cell, motion, padding):
    options = PlanningOptions(velocity_scaling=0.4, acceleration_scaling=0.4, padding=padding)
    group = cell.description.arm_group
    return cell.planner.plan(MotionRequest(group, cell.state, motion, options)).trajectory


def states_of(cell, trajectory, resolution):
    """States at equal distances over a whole trajectory, its start included."""
    space = GroupSpace(cell.kinematics.robot, cell.description.arm_group, cell.state)
    steps = np.linalg.norm(np.diff(trajectory.positions, axis=0) * space.metric, axis=1)
    travelled = np.append(0.0, np.cumsum(steps))
    places = np.linspace(0.0, travelled[-1], int(np.ceil(travelled[-1] / resolution)) + 1)
    columns = [np.interp(places, travelled, column) for column in trajectory.positions.T]
    return space.whole(np.column_stack(columns))


def put_crumb(cell, before, after, padding):
    """Put a crumb where a corner of the cube is too near it only midway between two states."""
    middle = 0.5 * (before + after)
    poses = [cell.scene.object_pose("cube", state) for state in (before, middle, after)]
    found = []
    for signs in product((-1.0, 1.0), repeat=3):
        corner = 0.5 * SIDE * np.array(signs)
        way = poses[2].apply(corner) - poses[0].apply(corner)
        normals = poses[1].rotation * signs  # of the three sides, pointing outwards
        outwards = normals.sum(axis=1)
        outwards -= way * (outwards @ way) / (way @ way)
        outwards /= np.linalg.norm(outwards)
        place = poses[1].apply(corner) + outwards * (padding + CRUMB - OVERLAP)
        found.append((float((normals.T @ outwards).min()), place))
    place = max(found, key=lambda each: each[0])[1]
    cell.add(thing("crumb", at(*place), Shape(Sphere(CRUMB))))


def nearest(cell, states):
    """The least distance of the cube from the crumb at the states where it is near [m]."""
    crumb = cell.scene.object_pose("crumb", cell.state).translation
    centers = [cell.scene.object_pose("cube", state).translation for state in states]
    away = np.linalg.norm(np.array(centers) - crumb, axis=1)
    found = [
        touch.distance
        for state in states[away < SIDE]
        for touch, _ in cell.scene.distances(state)
        if {touch.first, touch.second} == {"cube", "crumb"}
    ]
    return min(found, default=np.inf)


def crumb_between(cell, motion, padding):
    """A crumb that a motion meets only between its states halfway."""
    states = states_of(cell, planned(cell, motion, padding), PADDED if padding else UNPADDED)
    row = len(states) // 2
    put_crumb(cell, states[row], states[row + 1], padding)
    assert nearest(cell, states[row - 20 : row + 20]) > padding + 5e-6
    assert nearest(cell, 0.5 * (states[row : row + 1] + states[row + 1])) < padding - 5e-6


def line(cell):
    there = cell.kinematics.link_pose(cell.state, TCP)
    return LinearMotion(PoseGoal(TCP, at(0.1, 0.12, 0.03) @ there))


@pytest.mark.nightly(but=["lin-0.001", "ptp-0.0"])
@pytest.mark.parametrize("padding", [0.0, 0.001])
@pytest.mark.parametrize("kind", ["ptp", "lin"])
def test_a_motion_that_is_too_near_only_between_two_states_is_refused(kind, padding):
    cell = bent_arm()
    take_cube(cell, at(0.0, 0.0, 0.06, (0.5, 0.7, 0.2)))
    motion = JointMotion(END) if kind == "ptp" else line(cell)
    crumb_between(cell, motion, padding)
    with pytest.raises(PlanningFailed, match="cube and crumb") as caught:
        planned(cell, motion, padding)
    assert caught.value.code == "INVALID_MOTION_PLAN"


def test_a_prismatic_joint_does_not_pass_either(tmp_path):
    gantry = gantry_cell(tmp_path)
    take_cube(gantry, at(0.0, 0.0, -0.08, (0.5, 0.7, 0.2)))
    motion = JointMotion(np.array([0.2, 0.3]))
    crumb_between(gantry, motion, 0.0)
    with pytest.raises(PlanningFailed, match="cube and crumb"):
        planned(gantry, motion, 0.0)


WIDE = PathConstraints(joints=(JointBand("wrist_3_joint", -3.0, 3.0),))


@pytest.mark.nightly(but=["0.0-constrained"])
@pytest.mark.parametrize("constraints", [None, WIDE], ids=["free", "constrained"])
@pytest.mark.parametrize("padding", [0.0, 0.001])
def test_a_free_motion_goes_around(padding, constraints):
    cell = bent_arm()
    take_cube(cell, at(0.0, 0.0, 0.06, (0.5, 0.7, 0.2)))
    motion = FreeMotion(JointGoal(END), constraints)
    crumb_between(cell, motion, padding)
    around = planned(cell, motion, padding)
    assert nearest(cell, states_of(cell, around, 1 / 16384)) > padding - 1e-6
