"""`harness import`: what it writes loads, and means the same."""

from pathlib import Path

import pytest

from harness.cli.main import main
from harness.language.reading.load import load_world
from harness.plugins.formats.moveit_scene.scene import load_scene
from harness.plugins.formats.sdf.world import load_sdf
from harness.robot.mesh_file import read_triangles
from harness.session.prepare import prepare
from tests.world.sdf_files import TETRAHEDRON, text_with, write
from tests.world.test_scene import NEW, OLD

FRAMES = Path(__file__).parents[1] / "world" / "files" / "frames.sdf"
MESHED = """meshed
* part
0 0 1
0 0 0 1
1
mesh
4 4
0 0 0
1 0 0
0 1 0
0 0 1
0 2 1
0 1 3
0 3 2
1 2 3
0 0 0
0 0 0 1
0 0 0 0
0
.
"""


def a_scenario(folder, world):
    path = folder / f"{Path(world).stem}_{Path(world).suffix[1:]}.scenario.yaml"
    path.write_text(f"scenario: x\nrobot: ur3e\nworld: {world}\nsteps: [wait: 0.1 s]\n")
    return path


def test_an_imported_sdf_world_means_what_the_sdf_file_does(tmp_path, capsys):
    written = tmp_path / "out" / "frames.yaml"
    assert main(["import", "sdf", str(FRAMES), "-o", str(written)]) == 0
    said = capsys.readouterr().out
    assert f"wrote {written}: 6 objects; `world: frames.yaml`" in said
    assert "the revolute joint 'j' is held in its initial position" in said
    world = load_world("frames.yaml", written.parent).model
    assert world == load_sdf(FRAMES).world
    assert "#   " + said.splitlines()[0].removeprefix("note: ") in written.read_text()


def test_meshes_are_named_from_where_the_world_file_is(tmp_path):
    (tmp_path / "in").mkdir()
    source = write(tmp_path / "in", text_with(), "a.sdf")
    assert main(["import", "sdf", str(source), "-o", str(tmp_path / "out" / "a.yaml")]) == 0
    assert "file: ../in/part.obj" in (tmp_path / "out" / "a.yaml").read_text()
    objects = [
        prepare(path).program.world.objects
        for path in (a_scenario(tmp_path / "out", "a.yaml"), a_scenario(tmp_path / "in", "a.sdf"))
    ]
    meshes = [read_triangles(found[0].shapes[1].geometry).vertices for found in objects]
    assert (meshes[0] == meshes[1]).all()
    assert [item.mass for item in objects[0]] == [item.mass for item in objects[1]]


@pytest.mark.parametrize("text", [NEW, OLD])
def test_an_imported_scene_means_what_the_scene_does(tmp_path, text):
    source = tmp_path / "a.scene"
    source.write_text(text)
    assert main(["import", "scene", str(source)]) == 0
    assert load_world("a.yaml", tmp_path).model == load_scene(source).imported.world
    assert prepare(a_scenario(tmp_path, "a.yaml")).program.world.objects


def test_a_scenes_meshes_are_written_next_to_its_world(tmp_path):
    source = tmp_path / "a.scene"
    source.write_text(MESHED)
    assert main(["import", "scene", str(source)]) == 0
    shape = prepare(a_scenario(tmp_path, "a.yaml")).program.world.objects[0].shapes[0]
    triangles = read_triangles(shape.geometry)
    corners = triangles.vertices[triangles.faces]
    assert sorted(corners.reshape(-1, 9).tolist()) == sorted(
        load_scene(source).meshes["part_0.stl"].reshape(-1, 9).tolist()
    )


def test_nothing_is_overwritten_unless_requested(tmp_path, capsys):
    source = tmp_path / "a.scene"
    source.write_text(MESHED)
    (tmp_path / "part_0.stl").write_text("mine")
    assert main(["import", "scene", str(source)]) == 2
    assert "part_0.stl' exists already; nothing was written" in capsys.readouterr().err
    assert not (tmp_path / "a.yaml").exists()
    assert (tmp_path / "part_0.stl").read_text() == "mine"
    assert main(["import", "scene", str(source), "--force"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.scene", "a.yaml", "part_0.stl"]


def test_a_mistake_of_the_file_is_reported_at_its_line_and_nothing_written(tmp_path, capsys):
    source = tmp_path / "a.scene"
    source.write_text(NEW.replace("cylinder", "torus"))
    assert main(["import", "scene", str(source)]) == 2
    assert "a.scene:11:1: a shape cannot be a `torus`" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["a.scene"]


def test_models_are_looked_up_on_the_given_path(tmp_path, capsys):
    (tmp_path / "models").mkdir()
    write(tmp_path / "models", "")
    source = tmp_path / "w" / "a.sdf"
    source.parent.mkdir()
    (source.parent / "part.obj").write_text(TETRAHEDRON)
    source.write_text(text_with())
    assert main(["import", "sdf", str(source)]) == 2
    assert "`model://crate` is not found" in capsys.readouterr().err
    assert main(["import", "sdf", str(source), "--model-path", str(tmp_path / "models")]) == 0


@pytest.mark.parametrize("name", ["a.sdf", "none.sdf"])
def test_a_world_file_is_called_yaml_and_a_missing_file_reported(tmp_path, capsys, name):
    output = ["-o", str(tmp_path / "b.sdf")] if name == "a.sdf" else []
    write(tmp_path, text_with(), "a.sdf")
    assert main(["import", "sdf", str(tmp_path / name), *output]) == 2
    assert ("ends in .yaml" if output else "none.sdf") in capsys.readouterr().err


def test_an_imported_cone_has_its_mesh_next_to_the_world_file(tmp_path):
    shape = "<cone><radius>0.1</radius><length>0.5</length></cone>"
    source = write(tmp_path, text_with("geometry", shape), "a.sdf")
    target = tmp_path / "out" / "a.yaml"
    assert main(["import", "sdf", str(source), "-o", str(target)]) == 0
    assert (target.parent / "cone.stl").is_file()
    assert "file: cone.stl" in target.read_text(encoding="utf-8")
    prepare(a_scenario(tmp_path / "out", "a.yaml"))
