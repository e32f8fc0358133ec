"""Convex parts of vendors' meshes against the exact surfaces, at random configurations.

`pytest -m packages -s` prints the table.
"""

import sys
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from harness.core.geometry import Mesh
from harness.planning.collision.pair_statistics import sample_robot_positions
from harness.planning.collision.scene import CoalScene
from tests.packages.arms import ARMS
from tests.packages.trial import Trial, loaded
from tests.planning.test_false_self_collisions import self_collision

pytestmark = pytest.mark.packages
SAMPLES = 10_000
STATED = {
    "kinova_description/robots/kinova.urdf": 0.01,
    "panda_description/urdf/panda.urdf": 0.01,
    "xarm_description/urdf/xarm7.urdf": 0.01,
    "z1_description/urdf/z1.urdf": 0.01,
    "ur_description/urdf/ur5_robot.urdf": 0.015,
    "franka_robot_model/fr3.urdf": 0.01,
    "xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.xacro": 0.01,
    "xacro/abb_irb140_description/urdf/irb140.urdf": 0.01,
    "xacro/trossen_descriptions/urdf/px100.urdf.xacro": 0.01,
    "xacro/trossen_descriptions/urdf/wx250s.urdf.xacro": 0.01,
}
"""Largest share of configurations that only the parts call a self-collision."""

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


@pytest.mark.parametrize("file", STATED)
def test_parts_miss_no_self_collision_and_report_few_that_are_none(file):
    [arm] = [arm for arm in ARMS if arm.file == file]
    _, description = loaded(arm, Trial())
    parts, surfaces = self_collision(description), self_collision(with_surfaces(description))
    positions = sample_robot_positions(description, SAMPLES, np.random.default_rng(2))
    reported = np.array([parts(each) for each in positions])
    real = np.array([surfaces(each) for each in positions])
    false = (reported & ~real).mean()
    missed = [smallest_distance(description, each) for each in positions[real & ~reported]]
    row = f"{real.mean():.2%} collide, {false:.2%} falsely, missed: {missed} m apart"
    sys.stdout.write(f"\n{file}: {row}\n")
    assert max(missed, default=0.0) <= ERROR
    assert false <= STATED[file]
