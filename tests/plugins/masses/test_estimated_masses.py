"""Robots without <inertial>: masses come from the volume of their shapes, and are reported."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from tests.robot.arm_files import INERTIAL, SHAPE, URDF, load_arm, write_arm
from tests.robot.vessels import vessel, write_obj
from tests.session.front_door import run
from tests.world.sdf_files import TETRAHEDRON

BARE = URDF.replace(INERTIAL, "")


def link(arm, name):
    return next(each for each in arm.links if each.name == name)


def test_a_link_without_a_mass_weighs_its_shapes(tmp_path):
    write_arm(tmp_path, BARE)
    arm = load_arm(tmp_path)
    volume = math.pi * 0.03**2 * 0.14
    upper = link(arm, "upper").inertial
    assert upper.mass == pytest.approx(1000 * volume)
    assert upper.center_of_mass == pytest.approx([0, 0, 0.1])
    assert upper.inertia[2, 2] == pytest.approx(1000 * volume * 0.03**2 / 2)
    assert link(arm, "base_link").inertial is None, "it does not move"
    note = "no mass is given for upper, lower, wrist: 1.19 kg in all, from the volume of their"
    assert any(each.startswith(note) for each in arm.notes)


def test_two_shapes_are_one_body(tmp_path):
    """Two cubes of 0.1 m, 0.2 m apart: the parallel axis theorem."""
    cube = '<collision><origin xyz="{0} 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry>'
    cubes = "".join(cube.format(x) + "</collision>" for x in (-0.1, 0.1))
    write_arm(tmp_path, BARE.replace(SHAPE, cubes))
    inertial = link(load_arm(tmp_path), "upper").inertial
    assert inertial.mass == pytest.approx(2.0)
    assert np.diag(inertial.inertia) == pytest.approx([2 / 600, 2 / 600 + 0.02, 2 / 600 + 0.02])


def test_meshes_and_visuals_give_a_mass_too(tmp_path):
    (tmp_path / "part.obj").write_text(TETRAHEDRON)
    mesh = '<visual><geometry><mesh filename="part.obj" scale="0.1 0.1 0.1"/></geometry></visual>'
    write_arm(tmp_path, BARE.replace(SHAPE, mesh))
    mass = link(load_arm(tmp_path), "upper").inertial.mass
    assert 0 < mass < 1


def test_a_hollow_mesh_weighs_its_convex_parts(tmp_path):
    """A bin of 10 cm: its floor and walls are about a quarter of its hull."""
    vertices, faces = vessel(sides=4, outer=0.1, inner=0.09, height=0.1, floor=0.01)
    write_obj(tmp_path / "bin.obj", vertices, faces)
    mesh = '<collision><geometry><mesh filename="bin.obj"/></geometry></collision>'
    write_arm(tmp_path, BARE.replace(SHAPE, mesh))
    hull = 1000 * 2 * 0.1**2 * 0.1  # of a square with corners 0.1 m from its middle
    hollow = hull - 1000 * 2 * 0.09**2 * 0.09
    assert hollow < link(load_arm(tmp_path), "upper").inertial.mass < 1.2 * hollow < 0.5 * hull


def test_given_masses_stay(tmp_path):
    write_arm(tmp_path, URDF.replace(INERTIAL + SHAPE, SHAPE, 1))
    arm = load_arm(tmp_path)
    assert link(arm, "lower").inertial.mass == 1
    assert any("no mass is given for upper: " in note for note in arm.notes)


def test_a_link_between_two_joints_that_is_only_a_frame_gets_a_bead(tmp_path):
    """As where two joints share an axis point: the first one's link is empty."""
    write_arm(tmp_path, URDF.replace(INERTIAL + SHAPE, "", 1))
    arm = load_arm(tmp_path)
    carried = link(arm, "lower").inertial.mass + link(arm, "wrist").inertial.mass
    assert link(arm, "upper").inertial.mass == pytest.approx(1e-3 * carried)
    note = "moving links without a mass and a shape get 0.1% of what they carry: upper"
    assert note in arm.notes
    run(tmp_path, "- move_to: {joints: {turn: 0.3}}", robot="{urdf: arm.urdf, srdf: arm.srdf}")


def test_an_arm_without_masses_moves(tmp_path):
    write_arm(tmp_path, BARE)
    result, _ = run(
        tmp_path,
        "- move_to: {joints: {turn: 1, bend: 0.2, reach: 0.1}}",
        robot="{urdf: arm.urdf, srdf: arm.srdf}",
        rest="""
        expect:
          - always: within_limits
        """,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


@pytest.mark.nightly
def test_parts_that_overlap_weigh_no_more_than_the_hull(tmp_path):
    """Triangles without an inside, across a cube of 10 cm, as in some vendors' files."""
    rng = np.random.default_rng(1)
    vertices = rng.uniform(-0.05, 0.05, (900, 3))
    write_obj(tmp_path / "soup.obj", vertices, np.arange(900).reshape(-1, 3))
    mesh = '<collision><geometry><mesh filename="soup.obj"/></geometry></collision>'
    write_arm(tmp_path, BARE.replace(SHAPE, mesh))
    hull = ConvexHull(vertices).volume
    assert link(load_arm(tmp_path), "upper").inertial.mass == pytest.approx(1000 * hull, rel=1e-3)
