"""Mesh files: the same hull for planner and physics, whatever the format."""

import coal
import mujoco
import numpy as np
import pytest
import trimesh

from harness.core.errors import RobotError
from harness.core.geometry import Mesh, Shape
from harness.robot.mesh_file import exact_surface, hull_points, read_triangles
from harness.robot.solids import coal_geometry
from harness.simulation.geoms import add_mesh

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], dtype=float)
SHIFT = np.array([10, 0, 0])
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(
    f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES
)
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    + "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
    + "".join(f"3 {a} {b} {c}\n" for a, b, c in FACES)
)
STL = (
    "solid tetra\n"
    + "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in CORNERS[list(face)])
        + "endloop\nendfacet\n"
        for face in FACES
    )
    + "endsolid tetra\n"
)
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="{unit}" meter="{unit}"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>10 0 0</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def write(folder, name, text):
    (folder / name).write_text(text, encoding="utf-8")
    return Mesh(folder / name)


def sorted_rows(points):
    return np.array(sorted(map(tuple, np.round(points, 5) + 0.0)))


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.obj", OBJ, CORNERS),
        ("a.ply", PLY, CORNERS),
        ("a.stl", STL, CORNERS),
        ("a.dae", DAE.format(unit=1), CORNERS + SHIFT),
        ("b.dae", DAE.format(unit=0.01), 0.01 * (CORNERS + SHIFT)),
    ],
)
def test_stl_obj_ply_and_dae_give_the_same_solid_in_metres(tmp_path, name, text, expected):
    mesh = write(tmp_path, name, text)
    assert sorted_rows(hull_points(mesh)) == pytest.approx(sorted_rows(expected), abs=1e-7)
    triangles = read_triangles(mesh)
    assert triangles.faces.shape == (4, 3)


def test_a_glb_file_is_read_in_its_own_axes(tmp_path):
    scene = trimesh.Scene()
    part = trimesh.Trimesh(CORNERS, FACES, process=False)
    scene.add_geometry(part, transform=trimesh.transformations.translation_matrix(SHIFT))
    (tmp_path / "a.glb").write_bytes(scene.export(file_type="glb"))
    points = hull_points(Mesh(tmp_path / "a.glb"))
    assert sorted_rows(points) == pytest.approx(sorted_rows(CORNERS + SHIFT), abs=1e-6)


def test_every_material_and_object_of_a_file_is_part_of_its_surface(tmp_path):
    second = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS + SHIFT)
    faces = "".join(f"f {a + 5} {b + 5} {c + 5}\n" for a, b, c in FACES)
    text = f"mtllib none.mtl\nusemtl red\n{OBJ}usemtl blue\n{second}{faces}o third\nf 1 2 8\n"
    mesh = write(tmp_path, "a.obj", text)
    triangles = read_triangles(mesh)
    assert len(triangles.faces) == 9
    used = triangles.vertices[triangles.faces].reshape(-1, 3)
    assert used.max(axis=0) == pytest.approx([11, 2, 3])
    surface = exact_surface(mesh)
    place = coal.Transform3s(np.eye(3), np.array([10.2, 0.2, 0.0]))
    result = coal.CollisionResult()
    ball = coal.Sphere(0.1)
    coal.collide(surface, coal.Transform3s(), ball, place, coal.CollisionRequest(), result)
    assert result.isCollision()


def test_planner_and_physics_touch_the_same_hull(tmp_path):
    mesh = Mesh(write(tmp_path, "a.obj", OBJ).path, (1.0, -1.0, 0.5))
    hull = coal_geometry(Shape(mesh))
    assert isinstance(hull, coal.Convex)
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=add_mesh(spec, mesh))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    placed = model.mesh_vert @ data.geom_xmat[0].reshape(3, 3).T + data.geom_xpos[0]
    assert sorted_rows(placed) == pytest.approx(sorted_rows(CORNERS * [1, -1, 0.5]), abs=1e-6)
    assert sorted_rows(hull_points(mesh)) == pytest.approx(sorted_rows(placed), abs=1e-6)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.stl", "", "damaged or not in STL format"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "is flat"),
        ("a.obj", OBJ.replace("0.0", "nan", 1), "corners that are not finite numbers"),
        ("a.dae", "<!DOCTYPE a>" + DAE.format(unit=1), "a DOCTYPE, and with it"),
        ("a.ply", "ply", "damaged or not in PLY format"),
        ("a.3ds", "3ds", "not a STL, OBJ, DAE, PLY or GLB file"),
        ("a.stl", "x" * 64_000_001, "at most 64 MB"),
    ],
)
def test_a_file_that_makes_no_solid_is_refused(tmp_path, name, text, words):
    mesh = write(tmp_path, name, text)
    with pytest.raises(RobotError, match=words):
        hull_points(mesh)
