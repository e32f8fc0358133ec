"""SDF worlds as a scenario's: run, checked, reported in report and check."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.core.geometry import Box, Mesh
from harness.language.reading.load import parse_scenario
from harness.plugins.formats.sdf.round_meshes import CONE, SPHERE
from harness.plugins.formats.stl import cone, stl_bytes
from harness.recording.read_run import read_run
from harness.robot.mesh_file import hull_points, hull_solid, read_triangles
from harness.session.prepare import prepare
from tests.running import run_case
from tests.world.sdf_files import ASCII_STL, COLLADA, CRATE, load, text_with, write

TABLE_AND_CYLINDER = """<?xml version="1.0"?>
<sdf version="1.8">
 <world name="cell">
  <physics name="1ms" type="ode"><max_step_size>0.001</max_step_size>
   <real_time_factor>1</real_time_factor></physics>
  <include><uri>model://sun</uri></include>
  <include><uri>model://ground_plane</uri></include>
  <model name="Table"><static>true</static><pose>0.4 0 0 0 0 0</pose>
   <link name="link"><collision name="surface"><pose>0 0 1 0 0 0</pose>
    <geometry><box><size>1.5 1.6 0.03</size></box></geometry>
    <surface><friction><ode><mu>0.6</mu></ode></friction></surface></collision></link></model>
  <model name="green_cylinder"><pose>0.32 -0.168 1.065 0 0 0</pose>
   <link name="link"><inertial><mass>0.1</mass>
     <inertia><ixx>1.0583e-4</ixx><iyy>1.0583e-4</iyy><izz>4.5e-5</izz></inertia></inertial>
    <collision name="c"><geometry><cylinder><radius>0.03</radius><length>0.1</length></cylinder>
     </geometry><surface><friction><ode><mu>30</mu></ode></friction></surface></collision>
   </link></model>
 </world>
</sdf>
"""
SCENARIO = """scenario: In an SDF world
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: WORLD
steps:
  - move_to: mogi_home
  - pick: green_cylinder
expect:
  - lifted: {object: green_cylinder, above: 9 cm}
"""


@pytest.fixture
def cell(tmp_path):
    """A scenario that picks up a cylinder in an SDF world."""
    (tmp_path / "cell.sdf").write_text(TABLE_AND_CYLINDER, encoding="utf-8")
    path = tmp_path / "pick.scenario.yaml"
    path.write_text(SCENARIO.replace("WORLD", "cell.sdf"), encoding="utf-8")
    return path


@pytest.mark.nightly
def test_a_cylinder_is_picked_up_in_an_sdf_world_and_the_report_reports_what_is_left_out(cell):
    report = cell.parent / "report"
    result = run_case(cell, report_dir=report, stills=False, page=False)
    assert result.outcome == "passed", result
    found = [item.message for item in read_run(report).run.findings if item.kind == "note"]
    left_out = f"{cell.parent / 'cell.sdf'}:5: <real_time_factor> of <physics> is left out"
    assert [message.startswith(left_out) for message in found] == [True]
    again = run_case(report / "scenario.resolved.yaml", stills=False)
    assert again.digest == result.digest


def test_check_reports_what_is_left_out(cell, capsys):
    assert main(["check", str(cell)]) == 0
    assert "note: " in capsys.readouterr().out
    assert main(["check", "--json", str(cell)]) == 0
    (file,) = json.loads(capsys.readouterr().out)["files"]
    assert file["notes"][0].endswith("<real_time_factor> of <physics> is left out")


def test_a_mistake_of_the_world_is_reported_at_its_line_with_exit_code_2(cell, capsys):
    world = cell.parent / "cell.sdf"
    world.write_text(TABLE_AND_CYLINDER.replace("<mass>0.1</mass>", "<mass>zero</mass>"))
    assert main(["run", str(cell), "--no-report"]) == 2
    assert (
        f"{world}:13:33: <mass>: expected a finite number, found `zero`" in capsys.readouterr().out
    )


@pytest.mark.parametrize("uri", ["model://box", "file://box", "file://models/box"])
@pytest.mark.parametrize("given", ["scenario", "environment"])
def test_models_are_found_on_the_model_path(tmp_path, monkeypatch, given, uri):
    """Gazebo Classic looks up relative paths of `file://` there, too."""
    folder = tmp_path / "elsewhere" / uri.partition("://")[2]
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text(CRATE)
    (tmp_path / "here").mkdir()
    text = text_with("world", f"<include><uri>{uri}</uri></include>")
    write(tmp_path / "here", text)
    world = "{name: world.sdf, model_path: [../elsewhere]}" if given == "scenario" else "world.sdf"
    if given == "environment":
        monkeypatch.setenv("GZ_SIM_RESOURCE_PATH", f"/nowhere:{tmp_path / 'elsewhere'}")
    text = text.replace("<include><uri>model://crate</uri></include>", "")
    (tmp_path / "here" / "world.sdf").write_text(text)
    path = tmp_path / "here" / "a.scenario.yaml"
    path.write_text(f"scenario: x\nrobot: ur3e\nworld: {world}\nsteps: [wait: 0.1 s]\n")
    objects = prepare(path).program.world.objects
    assert [item.name for item in objects] == ["crate", "m"]


def test_a_fuel_address_leads_to_gazebos_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("GZ_FUEL_CACHE_PATH", str(tmp_path / "fuel"))
    for version in ("2", "10"):
        folder = tmp_path / "fuel/fuel.gazebosim.org/openrobotics/models/box" / version
        folder.mkdir(parents=True)
        (folder / "model.sdf").write_text(CRATE.replace("crate", f"box{version}"))
    address = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Box"
    (tmp_path / "w").mkdir()
    text = text_with("world", f"<include><uri>{address}</uri></include>")
    write(tmp_path / "w", text)
    path = tmp_path / "w" / "a.scenario.yaml"
    path.write_text("scenario: x\nrobot: ur3e\nworld: world.sdf\nsteps: [wait: 0.1 s]\n")
    objects = prepare(path).program.world.objects
    assert [item.name for item in objects] == ["box10", "m", "crate"]


@pytest.mark.parametrize("name", ["Sun", "Ground%20Plane"])
def test_the_bundled_models_stand_for_those_of_fuel(tmp_path, monkeypatch, name):
    monkeypatch.setenv("GZ_FUEL_CACHE_PATH", str(tmp_path / "fuel"))
    address = f"https://fuel.gazebosim.org/1.0/OpenRobotics/models/{name}"
    found = load(tmp_path, text_with("world", f"<include><uri>{address}</uri></include>"))
    assert len(found.world.lights) == (2 if name == "Sun" else 1)
    names = [item.name for item in found.world.objects]
    assert ("ground_plane" in names) == (name != "Sun")


def test_the_world_is_said_by_its_name_or_its_keys():
    folder = Path(__file__).parent
    text = "scenario: x\nrobot: ur3e\nworld: {name: a.sdf, model_path: [b]}\nsteps: [settle]\n"
    world = parse_scenario(text, folder / "x.scenario.yaml").scenario.world
    assert (world.name, world.model_path) == ("a.sdf", ("b",))


@pytest.mark.parametrize(("name", "content"), [("part.stl", ASCII_STL), ("part.dae", COLLADA)])
def test_meshes_of_every_kind_touch_as_the_same_solid(tmp_path, name, content):
    (tmp_path / name).write_text(content)
    write(tmp_path, text_with("mesh", f"<uri>{name}</uri>"))
    path = tmp_path / "a.scenario.yaml"
    path.write_text("scenario: x\nrobot: ur3e\nworld: world.sdf\nsteps: [wait: 0.1 s]\n")
    mesh = prepare(path).program.world.objects[0].shapes[1].geometry
    points = sorted(hull_points(mesh).round(6).tolist())
    assert points == [[0, 0, 0], [0, 0, 0.1], [0, 0.1, 0], [0.1, 0, 0]]


def test_a_mesh_that_cannot_be_touched_is_reported_at_its_line_in_the_sdf_file(tmp_path):
    text = text_with("mesh", "\n<uri>flat.obj</uri>")
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(SpecError, match="is flat: it encloses nothing") as caught:
        load(tmp_path, text)
    assert text.splitlines()[caught.value.problems[0].line - 1].startswith("<uri>flat.obj")


def test_an_object_that_lacks_its_mesh_is_refused_alone_unless_it_is_replaced(tmp_path):
    text = text_with("mesh", "\n<uri>gone.stl</uri>")
    write(tmp_path, text)
    path = tmp_path / "a.scenario.yaml"
    scenario = "scenario: x\nrobot: ur3e\nworld: world.sdf\nsteps: [wait: 0.1 s]\n"
    path.write_text(scenario)
    with pytest.raises(SpecError) as caught:
        prepare(path)
    [problem] = caught.value.problems
    assert text.splitlines()[problem.line - 1].startswith("<uri>gone.stl")
    assert problem.hint.startswith("name its folder in `world: {name: ..., model_path: [...]}`")
    name = re.search("`name: (.+)` with `replace: true` in `objects`", problem.hint)[1]
    box = "box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [1, 0, 0.1]}"
    path.write_text(scenario + f"objects: [{{name: {name}, replace: true, {box}}}]\n")
    [obj] = [each for each in prepare(path).program.world.objects if each.name == name]
    assert isinstance(obj.shapes[0].geometry, Box)


def test_a_missing_visual_mesh_is_a_note(tmp_path):
    gone = "<visual name='gone'><geometry><mesh><uri>gone.stl</uri></mesh></geometry></visual>"
    found = load(tmp_path, text_with("link", gone))
    assert any("a visual is not drawn: " in str(note) for note in found.notes)


ROUND = """<?xml version="1.0"?>
<sdf version="1.12"><world name="w"><include><uri>model://ground_plane</uri></include>
 <model name="egg"><pose>1 0 0.0515 0 0 0</pose><link name="l">
  <inertial><mass>0.2</mass><inertia><ixx>3e-4</ixx><iyy>3e-4</iyy><izz>3e-4</izz></inertia></inertial>
  <collision name="c"><geometry><ellipsoid><radii>0.1 0.08 0.05</radii></ellipsoid></geometry>
  </collision></link></model>
 <model name="hat"><pose>1 1 0.1005 0 0 0</pose><link name="l">
  <inertial><mass>0.2</mass><pose>0 0 -0.05 0 0 0</pose>
   <inertia><ixx>4e-4</ixx><iyy>4e-4</iyy><izz>4e-4</izz></inertia></inertial>
  <collision name="c"><geometry><cone><radius>0.1</radius><length>0.2</length></cone></geometry>
  </collision></link></model>
</world></sdf>
"""


def test_an_ellipsoid_and_a_cone_come_to_rest_where_their_shapes_say(tmp_path):
    (tmp_path / "round.sdf").write_text(ROUND, encoding="utf-8")
    path = tmp_path / "round.scenario.yaml"
    path.write_text("scenario: x\nrobot: ur3e\nworld: round.sdf\nsteps: [settle: {}]\n")
    result = run_case(path, report_dir=tmp_path / "report", stills=False, page=False)
    assert result.outcome == "passed"
    poses = read_run(tmp_path / "report").run.signals.object_poses
    heights = [float(poses[name][-1, 2]) for name in ("egg", "hat")]
    assert heights == pytest.approx([0.05, 0.1], abs=4e-4)


def test_the_round_meshes_are_what_their_formulas_give():
    solids = [(CONE, math.pi / 3), (SPHERE, 4 / 3 * math.pi)]
    for file, volume in solids:
        assert hull_solid(Mesh(file))[0] == pytest.approx(volume, rel=0.01)
    corners = read_triangles(Mesh(SPHERE)).vertices
    assert np.linalg.norm(corners, axis=1) == pytest.approx(np.ones(len(corners)), abs=1e-6)
    assert CONE.read_bytes() == stl_bytes(cone(1.0, 1.0))


def test_a_collision_keeps_its_friction_of_1_next_to_collisions_of_others(tmp_path):
    def collision(name, mu):
        surface = f"<surface><friction><ode><mu>{mu}</mu></ode></friction></surface>"
        shape = "<geometry><sphere><radius>0.1</radius></sphere></geometry>"
        return f'<collision name="{name}">{shape}{surface}</collision>'

    more = collision("c1", 0.5) + collision("c2", 1.0) + collision("c3", 0.0)
    objects = {item.name: item for item in load(tmp_path, text_with("link", more)).world.objects}
    assert objects["m"].friction == 0.5
    named = {shape.name: shape.friction for shape in objects["m"].shapes}
    assert (named["c1"], named["c2"], named["c3"]) == (None, 1.0, 0.0)
