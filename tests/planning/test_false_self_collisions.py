"""Collision shapes of ur3e and ur5e against the true shape of their links."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from harness.core.geometry import Mesh
from harness.language.scenario import RobotSpec
from harness.planning.collision.scene import CoalScene
from harness.robot.load import load_robot
from harness.robot.mesh_file import read_triangles
from harness.robot.solids import nearest_point

SAMPLES = 600
STATED = {"ur3e": 0.0075, "ur5e": 0.0074}
"""Share of random configurations, of 10,000, that only the shapes call a self-collision."""

COVERED = 5e-4
"""Largest distance of a point of a mesh from the shapes of its link [m]."""


def with_true_shapes(description):
    """The robot with the meshes it is drawn with as collision shapes, but for its base."""
    links = []
    for link in description.links:
        meshes = tuple(
            replace(shape, geometry=replace(shape.geometry, collision="exact"))
            for shape in link.visuals
            if isinstance(shape.geometry, Mesh)
        )
        is_drawn = meshes and link.name != "base_link_inertia"
        links.append(replace(link, collisions=meshes) if is_drawn else link)
    return replace(description, links=tuple(links))


def self_collision(description):
    model = CoalScene(description).collision_model()
    data, found = model.robot.model.createData(), model.geometry.createData()
    manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
        model.robot.model, model.geometry, found
    )

    def collides(state, _kept=(model, found)):  # the manager does not keep what it works on
        configuration = model.robot.configuration(state)
        return pin.computeCollisions(model.robot.model, data, manager, configuration, True)

    return collides


@pytest.mark.nightly(but=["ur3e-40"])
@pytest.mark.parametrize(("name", "samples"), [("ur3e", 40), ("ur3e", SAMPLES), ("ur5e", SAMPLES)])
def test_no_self_collision_is_missed_and_false_ones_are_as_rare_as_stated(name, samples):
    spec = RobotSpec.model_validate({"model": name, "gripper": "rh_p12_rn_a"})
    description = load_robot(spec)
    shapes, truth = self_collision(description), self_collision(with_true_shapes(description))
    generator = np.random.default_rng(2)
    false = missed = 0
    for _ in range(samples):
        state = description.start_positions()
        state[:6] = generator.uniform(-np.pi, np.pi, 6)
        state = description.with_mimics(state)
        collides, touches = shapes(state), truth(state)
        false += collides and not touches
        missed += touches and not collides
    two_errors = 2 * np.sqrt(STATED[name] * (1 - STATED[name]) / samples)
    assert missed == 0
    assert false / samples <= STATED[name] + two_errors


@pytest.mark.nightly(but=["ur3e"])
@pytest.mark.parametrize("name", STATED)
def test_the_shapes_cover_the_meshes(name):
    description = load_robot(RobotSpec(model=name))
    generator = np.random.default_rng(3)
    farthest = [
        float(np.linalg.norm(at - nearest_point(link.collisions, at)))
        for link in description.links
        for shape in link.visuals
        if isinstance(shape.geometry, Mesh)
        for point in generator.choice(read_triangles(shape.geometry).vertices, 100)
        for at in [shape.pose.apply(point)]
    ]
    assert len(farthest) == 700
    assert max(farthest) <= COVERED
