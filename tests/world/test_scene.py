"""MoveIt's `.scene` files, old form and new."""

import math
import time

import numpy as np
import pytest
import trimesh

from harness.core.errors import SpecError
from harness.plugins.formats.moveit_scene.scene import load_scene
from tests.waiting import MOST_WORK

NEW = """(noname)+
* table
0.5 0 0.2
0 0 0.7071067811865476 0.7071067811865476
2
box
1 0.6 0.04
0 0 0.38
0 0 0 1
0.5 0.3 0.1 1
cylinder
0.02 0.4
0.4 0.2 0.18
0 0 0 1
0 0 0 0
1
corner
0.5 0.3 0.4
0 0 0 1
* ball
0 0 1
0 0 0 1
1
sphere
0.05
0 0 0
0 0 0 1
1 0 0 1
0
.
"""
OLD = """old scene
* wall
1
box
0.1 2 1
1 0 0.5
0 0 0 1
0 0 0 0
* two things
2
sphere
0.05
0 0 1
0 0 0 1
1 0 0 1
sphere
0.06
0 1 1
0 0 0 1
1 0 0 1
.
"""


def scene(folder, text):
    path = folder / "a.scene"
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def objects(folder, text):
    return {item.name: item for item in scene(folder, text).imported.world.objects}


def test_the_new_form_has_poses_of_objects_and_of_shapes_on_them(tmp_path):
    found = objects(tmp_path, NEW)
    table = found["table"]
    assert table.static
    assert table.pose.xyz == (0.5, 0, 0.2)
    assert table.pose.quat_wxyz == pytest.approx((0.5**0.5, 0, 0, 0.5**0.5))
    top, leg = table.shapes
    assert (top.box.size, top.pose.xyz, top.color) == (
        (1, 0.6, 0.04),
        (0, 0, 0.38),
        (0.5, 0.3, 0.1, 1),
    )
    assert (leg.cylinder.radius, leg.cylinder.length, leg.color) == (0.02, 0.4, None)
    assert found["ball"].sphere.radius == 0.05
    assert found["ball"].color == (1, 0, 0, 1)


def test_subframes_are_reported(tmp_path):
    (note,) = scene(tmp_path, NEW).imported.notes
    assert "a subframe of an object is left out" in str(note)
    assert note.line == 17


def test_the_old_form_has_poses_of_shapes_alone(tmp_path):
    found = objects(tmp_path, OLD)
    assert found["wall"].pose.xyz == (1, 0, 0.5)
    assert found["wall"].box.size == (0.1, 2, 1)
    things = found["two things"]
    assert things.pose.xyz == (0, 0, 0)
    assert [shape.pose.xyz for shape in things.shapes] == [(0, 0, 1), (0, 1, 1)]
    assert things.color == (1, 0, 0, 1)


def test_a_mesh_comes_out_as_triangles(tmp_path):
    mesh = "mesh\n4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n"
    text = f"x\n* part 1\n1\n{mesh}0 0 2\n0 0 0 1\n0 0 0 0\n.\n"
    found = scene(tmp_path, text)
    (item,) = found.imported.world.objects
    assert item.mesh.file == "part_1_0.stl"
    assert item.pose.xyz == (0, 0, 2)
    triangles = found.meshes["part_1_0.stl"]
    assert triangles.shape == (4, 3, 3)
    assert triangles[3].tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_a_cone_is_a_pyramid_about_its_middle(tmp_path):
    found = scene(tmp_path, NEW.replace("cylinder\n0.02 0.4", "cone\n0.02 0.4"))
    [corners] = (mesh.reshape(-1, 3) for mesh in found.meshes.values())
    assert corners.min(axis=0) == pytest.approx([-0.02, -0.02, -0.2])
    assert corners.max(axis=0) == pytest.approx([0.02, 0.02, 0.2])
    assert np.abs(corners[corners[:, 2] > 0, :2]).max() == 0, "the tip is above"
    body = trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3))
    body.merge_vertices()
    assert body.is_watertight
    assert body.volume == pytest.approx(math.pi * 0.02**2 * 0.4 / 3, rel=0.01)


def test_a_plane_is_solid_behind_its_normal_at_its_distance(tmp_path):
    text = "x\n* floor\n1\nplane\n0 2 0 1\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n"
    found = scene(tmp_path, text)
    pose = found.imported.world.objects[0].pose.se3()
    assert pose.rotation[:, 2] == pytest.approx([0, 1, 0])
    assert pose.translation == pytest.approx([0, -0.5, 0])
    assert "MoveIt's is thin" in str(found.imported.notes[0])


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (NEW.replace("\n.\n", "\n"), 29, "expected an object, found the end of the file"),
        (NEW.replace("* ball", "# ball"), 20, "expected an object, found `#`"),
        (NEW.replace("* ball", "* table"), 20, "another object has the name 'table'"),
        (NEW.replace("cylinder", "torus"), 11, "a shape cannot be a `torus`"),
        (NEW.replace("0.05", "-1"), 24, "a shape has sizes above 0"),
        (NEW.replace("0.05", "1e300"), 25, "1e+300 is too large"),
        (NEW.replace("0 0 0 1\n1\nsphere", "0 0 0 1e308\n1\nsphere"), 22, "1e+308 is too large"),
        (NEW.replace("0.05", "1e-20"), 20, "1e-20 is too small"),
        (NEW.replace("* table\n0.5", "* table\n-1e10"), 3, "-1e+10 is too large"),
        (NEW.replace("0.05", "nan"), 25, "expected a finite number, found `nan`"),
        (NEW.replace("0 0 1\n0 0 0 1\n1\nsphere", "0 0 1\n0 0 0 0\n1\nsphere"), 22, "has norm 1"),
        (
            NEW.replace("\n2\nbox", "\n99999999\nbox"),
            5,
            "99999999 shapes; at most 10000 are supported",
        ),
        (NEW.replace("\n2\nbox", "\ntwo\nbox"), 5, "expected a number of shapes, found `two`"),
        ("", 1, "expected an object, found the end of the file"),
        (NEW[: NEW.index("1 0 0 1")], 20, "the file ends inside the object 'ball'"),
        (NEW[: NEW.index("0.05")], 20, "the file ends inside the object 'ball'"),
        (NEW[: NEW.index("0.4 0.2")], 2, "the file ends inside the object 'table'"),
    ],
)
def test_a_mistake_is_reported_at_its_line(tmp_path, text, line, message):
    with pytest.raises(SpecError) as caught:
        scene(tmp_path, text)
    (problem,) = caught.value.problems
    assert message in problem.message
    assert problem.line == line


@pytest.mark.nightly
def test_a_large_scene_is_read_in_seconds_and_a_larger_one_refused(tmp_path):
    rng = np.random.default_rng(1)
    corners = "\n".join(f"{x:.4f} {y:.4f} {z:.4f}" for x, y, z in rng.random((60_000, 3)))
    faces = "\n".join(f"{a} {a + 1} {a + 2}" for a in range(59_998))
    body = f"mesh\n60000 59998\n{corners}\n{faces}\n0 0 0\n0 0 0 1\n0 0 0 0\n"
    started = time.process_time()
    found = scene(tmp_path, f"x\n* a\n1\n{body}.\n")
    assert time.process_time() - started < MOST_WORK
    assert len(found.meshes["a_0.stl"]) == 59_998
    with pytest.raises(SpecError, match="at most 8 MB are read"):
        scene(tmp_path, "x" * 9_000_000)
    assert math.isfinite(found.meshes["a_0.stl"].sum())
