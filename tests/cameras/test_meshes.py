"""Mesh files come out as coloured triangles."""

import numpy as np
import pytest

from harness.cameras.meshes import coarsen, load_obj, mesh_parts
from harness.core.geometry import Mesh
from harness.robot.mesh_file import read_triangles
from tests.robot.test_mesh_file import DAE, STL, sorted_rows, write

CUBE_SIDES = """
mtllib two.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
usemtl grey
f 1/1/1 2/2/1 3/3/1
f 1/1/1 3/3/1 4/4/1
usemtl black
f -5 -4 -1
"""
MATERIALS = """
newmtl grey
Ka 1 1 1
Kd 0.2176 0.2176 0.2176
newmtl black
Kd 0 0 0
"""


def test_parts_have_the_colours_of_their_materials(tmp_path):
    (tmp_path / "two.obj").write_text(CUBE_SIDES)
    (tmp_path / "two.mtl").write_text(MATERIALS)
    grey, black = load_obj(Mesh(tmp_path / "two.obj", (0.1, 0.1, 0.2)))
    assert grey.rgba == pytest.approx((0.5, 0.5, 0.5, 1.0), abs=1e-3)  # linear to sRGB
    assert black.rgba == (0.0, 0.0, 0.0, 1.0)
    assert grey.faces.shape == (2, 3)
    corners = {tuple(np.round(corner, 6)) for corner in black.vertices}
    assert corners == {(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.0, 0.2)}


def test_a_large_file_is_read_once_as_long_as_it_and_its_colours_stay_the_same(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("harness.cameras.meshes.LARGE", 0)
    (tmp_path / "two.obj").write_text(CUBE_SIDES)
    for materials, count in ((MATERIALS, 1), (MATERIALS, 1), (MATERIALS.replace("0.2", "0.3"), 2)):
        (tmp_path / "two.mtl").write_text(materials)
        parts = load_obj(Mesh(tmp_path / "two.obj"))
        assert len(list((tmp_path / "cache").rglob("*.npz"))) == count
    (tmp_path / "two.obj").write_text(CUBE_SIDES.replace("usemtl black", "usemtl grey"))
    parts = load_obj(Mesh(tmp_path / "two.obj"))
    assert len({part.rgba for part in parts}) == 1, "the file has changed"
    monkeypatch.setattr("harness.cameras.meshes.LARGE", 1e9)
    for part, other in zip(parts, load_obj(Mesh(tmp_path / "two.obj")), strict=True):
        assert part.rgba == other.rgba
        np.testing.assert_array_equal(part.vertices, other.vertices)
        np.testing.assert_array_equal(part.faces, other.faces)


def test_polygons_become_fans(tmp_path):
    (tmp_path / "quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    (part,) = load_obj(Mesh(tmp_path / "quad.obj"))
    assert part.rgba is None
    assert part.faces.shape == (2, 3)
    a, b, c = (part.vertices[part.faces[:, i]] for i in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(1.0)


CORNERS = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
FACES = "f 1 2 3\nf 1 2 4\nusemtl red\nf 1 3 4\n"


@pytest.mark.parametrize("after", ["", " 1.0", " 0.2 0.4 0.6"], ids=["plain", "weight", "colour"])
def test_numbers_after_a_vertex_and_faces_before_the_first_material_are_read(tmp_path, after):
    text = "".join(f"v {each}{after}\n" for each in CORNERS) + FACES
    first, second = load_obj(write(tmp_path, "a.obj", text))
    assert (len(first.faces), len(second.faces)) == (2, 1)
    assert sorted_rows(first.vertices) == pytest.approx(
        sorted_rows(read_triangles(write(tmp_path, "b.obj", text)).vertices)
    )


def test_coarsening_merges_near_vertices_and_keeps_the_shape():
    angles = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    rim = 0.05 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    vertices = np.vstack([np.zeros(3), rim])
    faces = np.array([(0, i, i % 2000 + 1) for i in range(1, 2001)])
    coarse, fewer = coarsen(vertices, faces)
    assert len(fewer) < 400
    a, b, c = (coarse[fewer[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(np.pi * 0.05**2, rel=0.02)


PAINTED = (
    DAE.format(unit=0.01)
    .replace('<triangles count="4">', '<triangles count="4" material="paint">')
    .replace("<library_geometries>", """<library_effects><effect id="e"><profile_COMMON>
<technique sid="t"><lambert><diffuse><color>0.8 0.1 0.2 1</color></diffuse></lambert></technique>
</profile_COMMON></effect></library_effects><library_materials><material id="m">
<instance_effect url="#e"/></material></library_materials><library_geometries>""")
    .replace('<instance_geometry url="#g"/>', """<instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="paint" target="#m"/></technique_common>
</bind_material></instance_geometry>""")
)  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text", "rgba"),
    [
        ("a.stl", STL, None),
        ("a.dae", DAE.format(unit=1), None),
        ("b.dae", PAINTED, (0.8, 0.1, 0.2, 1.0)),
    ],
)
def test_a_mesh_looks_as_large_as_what_touches_and_has_its_colour(tmp_path, name, text, rgba):
    mesh = write(tmp_path, name, text)
    (part,) = mesh_parts(mesh)
    assert part.rgba == (rgba and pytest.approx(rgba))
    assert part.faces.shape == (4, 3)
    touching = sorted_rows(read_triangles(mesh).vertices)
    assert sorted_rows(part.vertices) == pytest.approx(touching, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.dae", "<COLLADA"),
        ("b.dae", DAE.format(unit=1).split("<scene>")[0] + "</COLLADA>"),
        ("c.dae", f"<!--{'x' * 20_000}--><!DOCTYPE a [<!ENTITY b 'c'>]>{DAE.format(unit=1)}"),
        ("d.stl", "solid\n"),
        ("e.obj", "v 0 0\nf 1 2 3\n"),
    ],
)
def test_a_mesh_that_cannot_be_read_shows_nothing(tmp_path, name, text):
    assert mesh_parts(write(tmp_path, name, text)) == ()
