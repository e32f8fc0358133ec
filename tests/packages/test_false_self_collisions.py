"""Convex parts of vendors' meshes against the exact surfaces, at random configurations.

`pytest -m needs_packages -s` prints the table.
"""

import sys
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from harness.core.geometry import Mesh
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.robot.mesh_file import read_triangles
from harness.robot.random_positions import sample_robot_positions
from tests.packages.arms import ARMS
from tests.packages.trial import Trial, loaded
from tests.planning.test_false_self_collisions import self_collision

pytestmark = pytest.mark.needs_packages
SAMPLES = 10_000
STATED = {
    "kinova_description/robots/kinova.urdf": 0.01,
    "panda_description/urdf/panda.urdf": 0.01,
    "xarm_description/urdf/xarm7.urdf": 0.01,
    "z1_description/urdf/z1.urdf": 0.01,
    "ur_description/urdf/ur5_robot.urdf": 0.01,
    "franka_robot_model/fr3.urdf": 0.01,
    "xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.xacro": 0.01,
    "xacro/trossen_descriptions/urdf/px100.urdf.xacro": 0.01,
    "xacro/trossen_descriptions/urdf/wx250s.urdf.xacro": 0.01,
}
"""Largest share of configurations that only the parts call a self-collision.

The irb140 is not among them: its surfaces take 44 ms a configuration. Of 800, 4.1 % were reported
falsely, all but one between its fourth and its sixth link, by at most 11 mm: the fourth is a fork
whose slot 24 parts narrow, and its meshes are five times as large as the arm.
"""

ERROR = 5e-4
"""Distance up to which parts may be apart where the surfaces touch [m].

One configuration of the kinova is missed although its parts overlap, by 0.015 mm: Coal's check
without contacts stops at its tolerance of 1e-6 and sees it with 1e-7. Checks with contacts, and
those with any padding, see it too.
"""


def with_surfaces(description):
    """The robot with the triangles of its meshes in place of their parts."""
    links = []
    for link in description.links:
        shapes = {}
        for shape in link.collisions:
            mesh = shape.geometry
            if isinstance(mesh, Mesh):
                shape = replace(shape, geometry=replace(mesh, collision="exact", part=None))
            shapes[shape] = None
        links.append(replace(link, collisions=tuple(shapes)))
    return replace(description, links=tuple(links))


def smallest_distance(description, positions):
    """Between the shapes of the pairs that are checked [m]."""
    model = CoalScene(description).collision_model()
    robot, found = model.robot.model, model.geometry.createData()
    configuration = model.robot.configuration(positions)
    pin.computeDistances(robot, robot.createData(), model.geometry, found, configuration)
    return min(each.min_distance for each in found.distanceResults)


def is_inside(point, mesh):
    """Whether a point is inside a closed mesh: the solid angle of its triangles, all around."""
    read = read_triangles(mesh)
    a, b, c = ((read.vertices - point)[read.faces[:, corner]] for corner in range(3))
    x, y, z = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", *pair) for pair in ((a, b), (b, c), (c, a)))
    angles = np.arctan2(volume, x * y * z + ab * z + bc * x + ca * y)
    return abs(angles.sum()) > np.pi


def contains(first, second, pose):
    """Whether a shape of a link, at a pose in the other's frame, is inside one of its meshes.

    Surfaces do not intersect then.
    """
    for shape in second.collisions:
        mesh, at = shape.geometry, pose @ shape.pose
        point = read_triangles(mesh).vertices[0] if isinstance(mesh, Mesh) else np.zeros(3)
        for other in first.collisions:
            if isinstance(other.geometry, Mesh):
                inner = other.pose.inverse().apply(at.apply(point))
                if is_inside(inner, other.geometry):
                    return True
    return False


def is_enclosed(description, positions):
    """Whether of two links that are reported one is inside the other."""
    kinematics = PinocchioKinematics(description)
    links = {link.name: link for link in description.links}
    return any(
        contains(
            links[first],
            links[second],
            kinematics.link_pose(positions, first).inverse()
            @ kinematics.link_pose(positions, second),
        )
        for touch in CoalScene(description).touches(positions)
        for first, second in ((touch.first, touch.second), (touch.second, touch.first))
    )


@pytest.mark.parametrize("file", STATED)
def test_parts_miss_no_self_collision_and_report_few_that_are_none(file):
    [arm] = [arm for arm in ARMS if arm.file == file]
    _, description = loaded(arm, Trial())
    parts, surfaces = self_collision(description), self_collision(with_surfaces(description))
    positions = sample_robot_positions(description, SAMPLES, np.random.default_rng(2))
    reported = np.array([parts(each) for each in positions])
    real = np.array([surfaces(each) for each in positions])
    only_parts = positions[reported & ~real]
    false = sum(not is_enclosed(description, each) for each in only_parts) / SAMPLES
    missed = [smallest_distance(description, each) for each in positions[real & ~reported]]
    row = f"{real.mean():.2%} collide, {false:.2%} falsely, missed: {missed} m apart"
    sys.stdout.write(f"\n{file}: {row}\n")
    assert max(missed, default=0.0) <= ERROR
    assert false <= STATED[file]
