"""States along a polyline, and bounds of how fast bodies approach each other along it."""

import numpy as np
import pytest

from harness.core.geometry import Box, Shape, Sphere
from harness.language.scenario import RobotSpec
from harness.planning.collision.motion_rates import motion_rates
from harness.planning.collision.sampled_motion import COUNTED_RESOLUTION, SampledMotion
from harness.planning.model.robot_model import GroupSpace
from harness.robot.load import load_robot
from tests.planning.lesson import Cell, at, gantry_cell, open_manipulator, thing, ur

METRIC = np.array([1.0, 3.0])
PATH = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.0], [0.1, 0.05], [0.4, 0.45]])


@pytest.mark.parametrize("resolution", [0.013, 0.05, 10.0])
def test_states_are_at_most_as_far_apart_as_requested_and_at_every_corner(resolution):
    motion = SampledMotion.of(PATH, METRIC, resolution)
    states = np.array([motion.state(number) for number in range(motion.last + 1)])
    steps = np.linalg.norm(np.diff([PATH[0], *states], axis=0) * METRIC, axis=1)
    assert steps.max() <= min(resolution, motion.spacing) * (1 + 1e-9)
    assert (
        len(states) < np.linalg.norm(np.diff(PATH, axis=0) * METRIC, axis=1).sum() / resolution + 5
    )
    for number, corner in zip(motion.places[1:], PATH[1:], strict=True):
        assert states[int(number)] == pytest.approx(corner, abs=1e-12)
    rows = [motion.row(number) for number in range(motion.last + 1)]
    assert np.all(np.diff(rows) > 0)
    assert rows[-1] == len(PATH) - 1
    for row, state in zip(rows, states, strict=True):
        columns = [np.interp(row, np.arange(len(PATH)), column) for column in PATH.T]
        assert state == pytest.approx(columns, abs=1e-12)


def test_a_motion_without_length_is_one_state():
    motion = SampledMotion.of(PATH[[1, 1]], METRIC, 0.01)
    assert (motion.last, motion.counted, motion.spacing) == (0, 1, 0.0)
    assert motion.state(0).tolist() == PATH[1].tolist()


def test_states_of_fine_motions_are_counted_at_a_fixed_distance():
    ends = np.array([[0.0, 0.0], [1.0, 0.0]])
    for resolution, count in ((0.1, 10), (1 / 16, 16), (COUNTED_RESOLUTION, 32), (1e-5, 32)):
        assert SampledMotion.of(ends, METRIC, resolution).counted == count


CELLS = {
    "ur3e": lambda _: Cell(ur("ur3e")),
    "open_manipulator_x": lambda _: Cell(open_manipulator()),
    "gantry": gantry_cell,
}


def crowded(cell):
    """The cell with a bar in the hand and a ball in front of it."""
    tip = cell.kinematics.link_pose(cell.state, cell.description.tcp_link)
    cell.add(thing("held", tip @ at(0.1, 0, -0.1), Shape(Box((0.1, 0.02, 0.3)))))
    links = cell.description.gripper.links
    cell.scene.attach_object("held", cell.description.tcp_link, links, cell.state)
    cell.add(thing("ball", at(0.4, 0.2, 1.6), Shape(Sphere(0.05))))
    return cell


@pytest.mark.parametrize("kind", ["arm", "gripper"])
@pytest.mark.parametrize("name", CELLS)
def test_no_pair_approaches_faster_than_its_bound(name, kind, tmp_path):
    cell = crowded(CELLS[name](tmp_path))
    groups = {"arm": cell.description.arm_group, "gripper": cell.description.gripper.group}
    space = GroupSpace(cell.kinematics.robot, groups[kind], cell.state)
    model = cell.scene.collision_model()
    rates = motion_rates(model, space)
    names = [model.names(pair) for pair in range(len(model.pairs))]
    generator = np.random.default_rng(4)
    lower, upper = np.maximum(space.lower, -np.pi), np.minimum(space.upper, np.pi)
    largest = np.zeros(len(names))
    for _ in range(150):
        first = generator.uniform(lower, upper)
        joints = generator.integers(0, 2, space.dof) + 1e-3
        second = first + generator.normal(size=space.dof) * joints * generator.choice([0.01, 0.3])
        second = np.clip(second, lower, upper)
        near, far = (
            {(touch.first, touch.second): touch.distance for touch, _ in cell.scene.distances(q)}
            for q in (space.whole(first), space.whole(second))
        )
        changes = np.array([abs(near[pair] - far[pair]) for pair in names])
        allowed = rates * space.distance(first, second)
        assert np.all(changes <= allowed + 1e-5)
        largest = np.maximum(largest, changes / np.maximum(allowed, 1e-9) * (rates > 0))
    assert largest.max() > 0.1
    assert rates.max() < 5.0


CONTINUOUS = """<robot name="turner">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="plate"/>
    <axis xyz="0 0 1"/><limit effort="50" velocity="1"/></joint>
  <link name="plate"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="plate"/><child link="tip"/>
    <axis xyz="1 0 0"/><limit lower="-0.2" upper="0.5" effort="50" velocity="1"/></joint>
  <link name="tip"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><geometry><sphere radius="0.03"/></geometry></collision></link>
</robot>"""


def arm_rates(cell):
    space = GroupSpace(cell.kinematics.robot, cell.description.arm_group, cell.state)
    model = cell.scene.collision_model()
    names = [model.names(pair) for pair in range(len(model.pairs))]
    return space, dict(zip(names, motion_rates(model, space), strict=True))


def test_a_joint_without_limits_does_not_make_the_bounds_of_others_infinite(tmp_path):
    (tmp_path / "turner.urdf").write_text(CONTINUOUS)
    cell = Cell(
        load_robot(RobotSpec.model_validate({"urdf": str(tmp_path / "turner.urdf")})),
        with_tables=False,
    )
    cell.add(thing("ball", at(1.0, 0, 0), Shape(Sphere(0.05))))
    space, rates = arm_rates(cell)
    reach = 0.03 * np.sqrt(3) + 0.5  # the corner of the sphere's box, and the travel
    assert rates["tip", "ball"] == pytest.approx(np.linalg.norm([reach, 1.0] / space.metric))
