"""`harness import moveit`: PlanningScene and MotionPlanRequest files become scenarios that run."""

import json
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.language.reading.load import load_scenario
from harness.plugins.formats.moveit_import import import_moveit
from harness.robot.mesh_file import read_triangles
from harness.robot.robot_source import RobotSource
from harness.session.check import check_file
from harness.session.prepare import prepare
from tests.robot.arm_files import write_arm

LISTS = """
robot_model_name: three
robot_state:
  joint_state: {name: [turn, bend, reach], position: [0.1, 0.2, 0.05]}
allowed_collision_matrix:
  entry_names: [base_link, lower, shelf, wrist]
  entry_values:
    - [false, false, true, false]
    - [false, false, true, false]
    - [true, true, false, false]
    - [false, false, false, false]
world:
  collision_objects:
    - header: {frame_id: base_link}
      id: shelf
      primitives:
        - {type: box, dimensions: [0.2, 0.3, 0.04]}
        - {type: cylinder, dimensions: [0.14, 0.03]}
      primitive_poses:
        - {position: [1.2, 0.1, 0.3], orientation: [0, 0, 0.7071067811865476, 0.7071067811865476]}
        - {position: [1.2, 0.1, 0.5], orientation: [0, 0, 0, 1]}
"""
MAPPINGS = """
name: (noname)+
robot_model_name: three
allowed_collision_matrix:
  entry_names: [lower, shelf]
  entry_values:
    - enabled: [false, true]
    - enabled: [true, false]
world:
  collision_objects:
    - header: {frame_id: /world, stamp: {secs: 0}}
      id: shelf
      pose: {position: {x: 1.2, y: 0, z: 0.3}, orientation: {x: 0, y: 0, z: 0, w: 0}}
      primitives:
        - {type: 3, dimensions: [0.14, 0.03]}
      primitive_poses:
        - {position: {x: 0, y: 0.1, z: 0.2}, orientation: {x: 0, y: 0, z: 0, w: 1}}
      meshes:
        - vertices: [{x: 0, y: 0, z: 0}, {x: 0.1, y: 0, z: 0}, {x: 0, y: 0.1, z: 0}, [0, 0, 0.1]]
          triangles:
            - vertex_indices: [0, 2, 1]
            - vertex_indices: [0, 1, 3]
            - [0, 3, 2]
            - [1, 2, 3]
      mesh_poses: [{}]
  octomap: {octomap: {data: []}}
"""
REQUEST = """
group_name: manipulator
max_velocity_scaling_factor: 0
max_acceleration_scaling_factor: 0.5
planner_id: RRTConnect
start_state:
  joint_state: {name: [turn, bend, reach], position: [0.4, -0.3, 0.1]}
goal_constraints:
  - joint_constraints:
      - {joint_name: turn, position: 1.0, tolerance_above: 0.001}
      - {joint_name: bend, position: 0.5}
      - {joint_name: reach, position: 0.02}
path_constraints: {name: "", joint_constraints: []}
"""
POSE = """
group_name: manipulator
goal_constraints:
  - position_constraints:
      - header: {frame_id: base_link}
        link_name: wrist
        constraint_region:
          primitives: [{type: 2, dimensions: [0.002]}]
          primitive_poses: [{position: {x: 0.1, y: 0.05, z: 0.6}}]
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_arm(tmp_path)
    return tmp_path


def convert(*files, **texts):
    for name, text in texts.items():
        Path(f"{name}.yaml").write_text(text, encoding="utf-8")
    return main(["import", "moveit", *files, "--robot", "arm.urdf", "--srdf", "arm.srdf"])


@pytest.mark.nightly(but=["lists"])
@pytest.mark.parametrize("scene", [LISTS, MAPPINGS], ids=["lists", "mappings"])
def test_a_scene_and_its_request_become_a_scenario_that_runs(folder, capsys, scene):
    assert convert("scene1.yaml", "request1.yaml", scene1=scene, request1=REQUEST) == 0
    file = folder / "scenarios/request1.scenario.yaml"
    program = prepare(file).program
    assert program.description.start_state["turn"] == 0.4
    [shelf] = program.world.objects
    assert shelf.is_static
    corner = (shelf.pose @ shelf.shapes[-1 if scene is LISTS else 0].pose).translation
    assert corner == pytest.approx([1.2, 0.1, 0.5])
    [step] = load_scenario(file).scenario.steps
    assert ("lower", "shelf") in step.pairs
    assert ("base_link", "shelf") not in step.pairs, "base_link has no shape"
    assert step.during[0].joints == {"turn": 1.0, "bend": 0.5, "reach": 0.02}
    assert load_scenario(file).scenario.planning.max_acceleration_scaling_factor == 0.5
    assert main(["run", "--no-report", "--in-process", str(file)]) == 0, capsys.readouterr().out


def test_progress_is_reported_for_each_file(folder):
    names = ("scene1.yaml", "request1.yaml", "request2.yaml")
    for name in names:
        text = LISTS if name.startswith("scene") else REQUEST
        Path(name).write_text(text, encoding="utf-8")
    seen = []
    robot = RobotSource("arm.urdf", srdf="arm.srdf")
    import_moveit([*map(Path, names)], robot, folder / "out", lambda *each: seen.append(each))
    assert seen == [
        *(("reading", done, 3) for done in range(3)),
        *(("converting", done, 2) for done in range(2)),
    ]


def test_cones_and_planes_of_a_scene_are_imported(folder):
    cone = LISTS.replace("type: cylinder", "type: 4")
    floor = """
    - id: floor
      planes: [{coef: [0, 0, 2, 1]}]
      plane_poses: [{position: [0, 0, 0.1], orientation: [0, 0, 0, 1]}]
"""
    assert convert("scene1.yaml", "request1.yaml", scene1=cone + floor, request1=REQUEST) == 0
    program = prepare(folder / "scenarios/request1.scenario.yaml").program
    shelf, ground = program.world.objects
    corners = read_triangles(shelf.shapes[1].geometry).vertices
    assert np.ptp(corners, axis=0) == pytest.approx([0.06, 0.06, 0.14])
    assert (corners[:, 2] > 0.069).sum() == 1
    assert ground.shapes[0].pose.translation == pytest.approx([0, 0, -0.4])


def test_the_start_of_the_scene_is_taken_where_the_request_has_none(folder):
    text = REQUEST[: REQUEST.index("start_state")] + REQUEST[REQUEST.index("goal_") :]
    assert convert("s.yaml", "r.yaml", s=LISTS, r=text) == 0
    program = prepare(folder / "scenarios/r.scenario.yaml").program
    assert program.description.start_state["bend"] == 0.2


def test_many_files_are_paired_by_their_numbers(folder):
    files = {}
    for number in range(1, 31):
        files[f"scene{number:04}"] = LISTS.replace("0.1, 0.3", f"0.1, {0.3 + number / 100}")
        files[f"request{number:04}"] = REQUEST.replace("1.0,", f"{number / 100},")
    assert convert(*(f"{name}.yaml" for name in sorted(files)), **files) == 0
    written = sorted((folder / "scenarios").glob("*.scenario.yaml"))
    assert len(written) == 30
    loaded = load_scenario(written[16]).scenario
    assert loaded.world.name == "scene0017.world.yaml"
    assert loaded.steps[0].during[0].joints["turn"] == pytest.approx(0.17)


def test_a_position_goal_of_a_link_keeps_its_tolerance(folder):
    assert convert("r.yaml", r=POSE) == 0
    file = folder / "scenarios/r.scenario.yaml"
    [step] = load_scenario(file).scenario.steps
    assert (step.link, step.position.frame, step.tolerance.position) == (
        "wrist",
        "base_link",
        0.002,
    )
    assert check_file(file).problems == ()


def test_an_orientation_makes_a_pose_and_several_goals_are_alternatives(folder):
    turned = (
        POSE
        + """    orientation_constraints:
      - orientation: {x: 0, y: 0, z: 0.6, w: 0.8}
        absolute_x_axis_tolerance: 0.1
"""
    )
    goals = turned + "  - joint_constraints: [{joint_name: turn, position: 0.5}]\n"
    assert convert("r.yaml", r=goals) == 0
    [step] = load_scenario(folder / "scenarios/r.scenario.yaml").scenario.steps
    first, second = step.any_of
    assert first.pose.quat_xyzw == (0, 0, 0.6, 0.8)
    assert first.tolerance.orientation == (0.1, 0, 0)
    assert second.joints == {"turn": 0.5}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("reach], position: [0.4", "rich], position: [0.4", "'three' has no joint 'rich'"),
        ("position: 1.0", "position: fast", "expected a number, found 'fast'"),
        ("joint_constraints: []", "joint_constraints: [1]", "`path_constraints` is not imported"),
        ("  - joint_constraints:", "  - visibility_constraints:", "a goal is joint positions, or"),
        ("type: box", "type: cone", "'shelf': a 'cone' of 3 sizes"),
        ("frame_id: base_link", "frame_id: lower", "'shelf' is in the frame 'lower'"),
        ("- [false, false, true, false]", "- [false]", "expected 4 entries"),
        ("robot_model_name", "model", "x"),
        ("      primitive_poses:", "      primitive_poses: [{}, {}, {}]\n      x:", "3 poses"),
        ("[0.2, 0.3, 0.04]", "[0.2, -0.3, 0.04]", "box.size.1: Input should be greater than 0"),
        ("[1.2, 0.1, 0.3]", "[1.2, 0.1, 1e300]", "1e+300 is too large"),
        ("orientation: [0, 0, 0, 1]", "orientation: [0, 1e308, 0, 1]", "1e+308 is too large"),
        ("id: shelf", f"id: {'x' * 500}", "name: String should have at most"),
    ],
)
def test_a_mistake_is_located_and_nothing_is_written(folder, capsys, old, new, said):
    texts = {"scene1": LISTS, "request1": REQUEST}
    name = next(name for name, text in texts.items() if old in text)
    texts[name] = texts[name].replace(old, new, 1)
    code = convert("scene1.yaml", "request1.yaml", **texts)
    if said == "x":  # its name is not needed: `world` shows what it is
        assert code == 0
        return
    assert code == 2
    assert f"{name}.yaml:" in (error := capsys.readouterr().err)
    assert said in error
    assert not (folder / "scenarios").exists()


@pytest.mark.parametrize(
    "triangles", ["[[]]", "[[0, 1]]", "[[0, 1, 2, 3]]", "[[0, 1, 4]]", "[[0, 1, -1]]"]
)
def test_a_mesh_without_triangles_of_its_vertices_is_refused(capsys, triangles):
    begin, end = MAPPINGS.index("          triangles:"), MAPPINGS.index("      mesh_poses")
    scene = f"{MAPPINGS[:begin]}          triangles: {triangles}\n{MAPPINGS[end:]}"
    assert convert("s.yaml", s=scene) == 2
    assert "s.yaml:19:" in (error := capsys.readouterr().err)
    assert "a mesh has triangles of its vertices" in error


@pytest.mark.parametrize("region", ["[]", "[{type: 2}]", "[{type: 2, dimensions: []}]"])
def test_a_position_goal_without_a_region_is_refused(capsys, region):
    request = POSE.replace("[{type: 2, dimensions: [0.002]}]", region)
    assert convert("r.yaml", r=request) == 2
    assert "a `constraint_region` of one primitive" in capsys.readouterr().err


def test_a_shape_without_a_pose_stands_at_the_origin_of_its_object(folder):
    scene = MAPPINGS.replace("position: {x: 0, y: 0.1, z: 0.2}, ", "")
    begin, end = MAPPINGS.index("      primitive_poses"), MAPPINGS.index("      meshes")
    without = MAPPINGS[:begin] + MAPPINGS[end:]
    worlds = []
    for text in (scene, without):
        assert convert("s.yaml", "r.yaml", "--force", s=text, r=REQUEST) == 0
        worlds.append((folder / "scenarios/s.world.yaml").read_text(encoding="utf-8"))
    assert worlds[0] == worlds[1]


def test_several_files_of_another_kind_and_a_missing_robot_are_refused(folder, capsys):
    assert main(["import", "scene", "a.scene", "b.scene"]) == 2
    assert "takes one FILE, not 2" in capsys.readouterr().err
    (folder / "r.yaml").write_text(REQUEST)
    assert main(["import", "moveit", "r.yaml"]) == 2
    assert "--robot FILE or --robot NAME" in capsys.readouterr().err


def test_json_is_yaml_too(folder):
    (folder / "r.json").write_text(json.dumps({"group_name": "manipulator", "goal_constraints": [
        {"joint_constraints": [{"joint_name": "turn", "position": 0.5}]}]}))  # fmt: skip
    assert main(["import", "moveit", "r.json", "--robot", "arm.urdf", "--srdf", "arm.srdf"]) == 0
    assert check_file(folder / "scenarios/r.scenario.yaml").problems == ()
