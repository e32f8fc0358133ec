"""OBJ files come out as coloured triangles."""

import numpy as np
import pytest

from harness.cameras.meshes import coarsen, load_obj
from harness.core.geometry import Mesh

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


def test_polygons_become_fans(tmp_path):
    (tmp_path / "quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    (part,) = load_obj(Mesh(tmp_path / "quad.obj"))
    assert part.rgba is None
    assert part.faces.shape == (2, 3)
    a, b, c = (part.vertices[part.faces[:, i]] for i in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(1.0)


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
