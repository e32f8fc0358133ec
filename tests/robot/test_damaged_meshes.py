"""Damaged and adversarial meshes: a message that names the file, in bounded memory, no crash."""

import logging
import struct
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from harness.cameras.meshes import mesh_parts
from harness.cli.main import main
from harness.core.errors import RobotError
from harness.core.geometry import Mesh
from harness.core.memory import limited_memory
from harness.plugins.meshes.solid_grid import MOST_POINTS, solid_grid, surface_points
from harness.robot.mesh_file import convex_hull, read_triangles
from tests.robot.arm_files import SHAPE, URDF, write_arm
from tests.waiting import HANG

SOLID = trimesh.creation.icosphere(subdivisions=1, radius=0.05)


def file_of(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode("latin-1"))
    return Mesh(path)


def exported(kind, **words):
    content = SOLID.export(file_type=kind, **words)
    return content if isinstance(content, bytes) else content.encode()


ASCII_STL = exported("stl_ascii")
TRUNCATED = {
    "cut.stl": exported("stl")[:-30],
    "ascii.stl": ASCII_STL[: len(ASCII_STL) // 2],
    "word.stl": ASCII_STL.replace(b"vertex", b"ver   ", 1),
    "facet.stl": ASCII_STL.replace(b"endfacet", b"endf cet", 1),
    "cut.ply": exported("ply")[:-30],
    "cut.obj": exported("obj")[:400] + b"\nf 1 2 4000000000\n",
    "cut.glb": exported("glb")[:-30],
    "cut.dae": exported("dae")[:-30],
}


@pytest.mark.parametrize("name", TRUNCATED)
def test_a_truncated_or_garbled_file_is_damaged(tmp_path, name):
    with pytest.raises(RobotError, match=f"{name} (cannot be read|has no triangles)"):
        read_triangles(file_of(tmp_path, name, TRUNCATED[name]))


def test_the_reader_does_not_log_its_tracebacks(tmp_path, caplog):
    with caplog.at_level(logging.DEBUG), pytest.raises(RobotError):
        read_triangles(file_of(tmp_path, "a.stl", TRUNCATED["word.stl"]))
    assert not [each for each in caplog.records if each.name.startswith("trimesh")]


HEADER = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
HEADER += b"property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
CORNERS = b"0 0 0\n1 0 0\n0 1 0\n%s\n"
FACES = b"3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 %d\n"


@pytest.mark.parametrize(
    ("corner", "index", "message"),
    [
        (b"0 0 nan", 3, "not finite"),
        (b"0 0 inf", 3, "not finite"),
        (b"0 0 1e30", 3, "farther away than"),
        (b"0 0 1", 4, "cannot be read"),
        (b"0 0 1", -1, "cannot be read"),
    ],
)
def test_corners_that_are_no_points_or_not_there(tmp_path, corner, index, message):
    mesh = file_of(tmp_path, "a.ply", HEADER + CORNERS % corner + FACES % index)
    with pytest.raises(RobotError, match=message):
        read_triangles(mesh)


def stl(triangles):
    """A binary STL file."""
    rows = [struct.pack("<12fH", 0, 0, 0, *np.ravel(each), 0) for each in triangles]
    return b" " * 80 + struct.pack("<I", len(rows)) + b"".join(rows)


def nearly_flat(thickness):
    """Triangles between random points of an oblique plane, and a thickness away from it [m]."""
    rng = np.random.default_rng(0)
    points = rng.uniform(-1, 1, (60, 3))
    points[:, 0] = 0.05 * points[:, 2] + thickness * rng.uniform(-1, 1, 60)
    return points.reshape(-1, 3, 3)


@pytest.mark.nightly(but=["0"])
@pytest.mark.parametrize("thickness", [0, 1e-12, 1e-10, 1e-8])
def test_a_mesh_as_thin_as_its_rounding_is_flat_and_crashes_nothing(tmp_path, thickness):
    """In a process of its own, since Qhull ends with signal 11 on such points."""
    file_of(tmp_path, "thin.stl", stl(nearly_flat(thickness)))
    write_arm(tmp_path, URDF.replace(SHAPE, MESH.format("thin.stl")))
    checked = subprocess.run(
        [sys.executable, "-m", "harness.cli", "robot", "check", "arm.urdf"],
        cwd=tmp_path, capture_output=True, text=True, timeout=HANG,
    )  # fmt: skip
    assert checked.returncode == 2, checked.stderr
    assert "arm.urdf:4:" in checked.stderr
    assert "thin.stl is flat" in checked.stderr


@pytest.mark.nightly
def test_a_thin_mesh_has_a_hull(tmp_path):
    assert convex_hull(file_of(tmp_path, "thin.stl", stl(nearly_flat(1e-4)))).num_points > 4


@pytest.mark.parametrize("size", [1e-30, 1e-12])
def test_a_mesh_of_no_size_is_flat(tmp_path, size):
    triangles = SOLID.vertices[SOLID.faces] * size / 0.05
    with pytest.raises(RobotError, match="is flat"):
        convex_hull(file_of(tmp_path, "dot.stl", stl(triangles)))


MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'


@pytest.mark.parametrize("name", ["cut.stl", "word.stl", "cut.glb", "cut.dae", "cut.ply"])
def test_a_robot_with_a_damaged_mesh_is_refused_at_its_line(tmp_path, capsys, monkeypatch, name):
    file_of(tmp_path, name, TRUNCATED[name])
    write_arm(tmp_path, URDF.replace(SHAPE, MESH.format(name), 1))
    monkeypatch.chdir(tmp_path)
    assert main(["robot", "check", "arm.urdf"]) == 2
    error = capsys.readouterr().err
    assert "arm.urdf:4:" in error
    assert f"mesh {name} " in error
    assert "damaged" in error or "not well-formed" in error
    assert "Traceback" not in error


POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 98284\n"


@pytest.mark.parametrize("name", ["link.stl", "link.dae", "link.obj"])
def test_a_mesh_that_a_clone_left_in_git_lfs_says_how_to_get_it(
    tmp_path, capsys, monkeypatch, name
):
    file_of(tmp_path, name, POINTER)
    write_arm(tmp_path, URDF.replace(SHAPE, MESH.format(name), 1))
    monkeypatch.chdir(tmp_path)
    assert main(["robot", "check", "arm.urdf"]) == 2
    error = " ".join(capsys.readouterr().err.split())
    assert "arm.urdf:4:" in error
    assert f"mesh {name} is a pointer of Git LFS and no mesh" in error
    assert "`git lfs pull`" in error


@pytest.mark.nightly
def test_triangles_without_order_do_not_fill_the_memory():
    rng = np.random.default_rng(0)
    soup = rng.uniform(-0.15, 0.15, (6000, 3, 3))
    sides = np.linalg.norm(np.cross(soup[:, 1] - soup[:, 0], soup[:, 2] - soup[:, 0]), axis=1)
    assert sides.sum() / 2 * (3 / 0.003) ** 2 > 4 * MOST_POINTS, "no soup that needs the limit"
    grid = solid_grid(soup, 0.003)
    assert grid.edge > 0.003
    assert len(surface_points(soup, grid.edge / 3)) < 3 * MOST_POINTS


def test_a_reader_that_takes_too_much_memory_is_stopped():
    with pytest.raises(MemoryError), limited_memory(100_000_000):
        np.empty(1_000_000_000)  # more than the process may have free of what it used before
    assert np.ones(50_000_000).sum() == 50_000_000


def collada(nodes, first="#n0"):
    """A box whose scene shows nodes of a library."""
    content = trimesh.creation.box((0.1, 0.1, 0.1)).export(file_type="dae").decode()
    begin = content.index("<instance_geometry")
    end = content.index("</instance_geometry>") + len("</instance_geometry>")
    geometry = content[begin:end]
    library = f"<library_nodes>{nodes.format(geometry=geometry)}</library_nodes>"
    content = content[:begin] + f'<instance_node url="{first}"/>' + content[end:]
    return content.replace("<library_visual_scenes", f"{library}<library_visual_scenes")


def doubled(levels):
    """Nodes that each show the next one twice."""
    twice = '<instance_node url="#n{0}"/><instance_node url="#n{0}"/>'
    nodes = "".join(f'<node id="n{n}">{twice.format(n + 1)}</node>' for n in range(levels))
    return f'{nodes}<node id="n{levels}">{{geometry}}</node>'


CIRCLE = '<node id="n0"><instance_node url="#n1"/></node><node id="n1"><instance_node url="#n0"/>'
CHAIN = "".join(f'<node id="n{n}"><instance_node url="#n{n + 1}"/></node>' for n in range(20_000))


@pytest.mark.nightly(only=["nodes2-too deeply"])
@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        (doubled(40), "repeats its nodes more than 100000 times"),
        (CIRCLE + "</node>", "contains itself"),
        (CHAIN, "too deeply"),
    ],
)
def test_a_collada_file_that_unfolds_without_end_is_refused(tmp_path, nodes, message):
    mesh = file_of(tmp_path, "bomb.dae", collada(nodes))
    with pytest.raises(RobotError, match=message):
        read_triangles(mesh)
    assert mesh_parts(mesh) == (), "it is not drawn either"


def test_a_collada_file_that_repeats_some_nodes_is_read(tmp_path):
    mesh = file_of(tmp_path, "four.dae", collada(doubled(2)))
    assert len(read_triangles(mesh).faces) == 4 * 12
    assert sum(len(part.faces) for part in mesh_parts(mesh)) > 0


def test_entities_are_refused_wherever_they_are_declared(tmp_path):
    content = exported("dae").decode()
    bomb = "<!DOCTYPE a [<!ENTITY b 'c'>]>"
    first = content.index("<COLLADA")
    content = f"{content[:first]}<!--{' ' * 15_000}-->{bomb}{content[first:]}"
    with pytest.raises(RobotError, match="DOCTYPE"):
        read_triangles(file_of(tmp_path, "late.dae", content))


def test_the_colours_of_an_obj_file_are_read_next_to_it_only(tmp_path):
    (tmp_path / "a").mkdir()
    colour = "newmtl red\nKd 1 0 0\n"
    (tmp_path / "red.mtl").write_text(colour)
    (tmp_path / "a" / "red.mtl").write_text(colour)
    text = exported("obj").decode().replace("\nf ", "\nusemtl red\nf ", 1)
    outside = file_of(tmp_path / "a", "out.obj", f"mtllib ../red.mtl\n{text}")
    inside = file_of(tmp_path / "a", "in.obj", f"mtllib red.mtl\n{text}")
    assert mesh_parts(outside)[0].rgba is None
    assert mesh_parts(inside)[0].rgba == (1.0, 0.0, 0.0, 1.0)


def test_vertices_beyond_all_numbers_are_not_drawn(tmp_path):
    text = "v 0 0 0\nv 1 0 0\nv 0 1e300 0\nf 1 2 3\n"
    assert mesh_parts(file_of(tmp_path, "far.obj", text)) == ()
