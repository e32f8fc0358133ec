"""`harness describe`: the scene as data agrees with MuJoCo, with `pick`, and with its page."""

import json
import re

import mujoco
import numpy as np
import pytest

from docs import ROOT
from harness.cli.main import main
from harness.session.prepare import prepare
from harness.session.start import start_physics
from harness.simulation.mujoco_simulator import MujocoSimulator

PAGE = (ROOT / "docs/reference/describe.md").read_text(encoding="utf-8")
SCENE = """\
scenario: Three objects and a cup of the planner
robot: {model: ur3e, gripper: rh_p12_rn_a}
world: empty
objects:
  - name: slab
    static: true
    box: {size: [0.4, 0.2, 0.02]}
    pose: {xyz: [0.5, 0, 0.01], rpy: [0, 0, 90 deg]}
  - {name: cube, mass: 0.2, box: {size: [0.04, 0.04, 0.05]}, pose: {xyz: [0.4, 0.1, 0.045]}}
  - {name: brick, mass: 2, box: {size: [0.2, 0.2, 0.2]}, pose: {xyz: [0.3, -0.3, 0.1]}}
  - {name: far, mass: 0.1, sphere: {radius: 0.02}, pose: {xyz: [3, 0, 0.02]}}
steps:
  - add_object:
      {name: cup, in: planning, cylinder: {radius: 0.03, length: 0.1}, pose: {xyz: [0, 1, 1]}}
"""


def described(capsys, *words):
    code = main(["describe", *map(str, words), "--json"])
    printed = capsys.readouterr()
    assert code == 0, printed.err
    return json.loads(printed.out)


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "scene.scenario.yaml"
    file.write_text(SCENE, encoding="utf-8")
    return file


def by_name(facts):
    return {each["name"]: each for each in facts["objects"]}


def test_sizes_poses_and_masses_are_those_of_the_file(scene, capsys):
    facts = described(capsys, scene)
    objects = by_name(facts)
    slab = objects["slab"]
    assert slab["size"] == [0.4, 0.2, 0.02]
    assert np.allclose([slab["low"], slab["high"]], [[0.4, -0.2, 0], [0.6, 0.2, 0.02]])
    assert (slab["mass"], slab["pick"]) == (None, None)
    assert objects["cube"]["mass"] == 0.2
    assert objects["cube"]["pose"]["xyz"] == [0.4, 0.1, 0.045]
    [cup] = facts["added_later"]
    assert (cup["name"], cup["is_in"]) == ("cup", ["planning"])
    assert "pose" not in cup


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("name", "fits", "code"),
    [("cube", True, ""), ("brick", False, "GOAL_STATE_INVALID"), ("far", True, "NO_IK_SOLUTION")],
)
def test_a_pick_that_is_possible_is_one_that_check_accepts(scene, capsys, name, fits, code):
    found = by_name(described(capsys, scene))[name]
    assert [side["fits"] for side in found["level_sides"]] == [fits, fits]
    assert (found["pick"]["error_code"], found["pick"]["is_possible"]) == (code, not code)
    assert bool(found["pick"]["advice"]) == bool(code)
    scene.write_text(f"{SCENE}  - pick: {name}\n", encoding="utf-8")
    assert main(["check", str(scene)]) == bool(code)
    assert code in capsys.readouterr().out


def test_the_clearance_is_the_one_that_mujoco_measures(tmp_path, capsys):
    file = tmp_path / "ball.scenario.yaml"
    file.write_text(
        "scenario: A ball\nrobot: open_manipulator_x\nsteps: [{wait: 0.1}]\nobjects:\n"
        "  - {name: ball, mass: 0.1, sphere: {radius: 0.03}, pose: {xyz: [0.5, 0.1, 0.2]}}\n"
    )
    clearance = by_name(described(capsys, file))["ball"]["clearance"]
    model = start_physics(prepare(file), MujocoSimulator).physics.model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    [ball] = [geom for geom in range(model.ngeom) if model.geom_size[geom][0] == 0.03]
    is_plane = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    others = [
        geom
        for geom in range(model.ngeom)
        if model.geom_contype[geom] and not is_plane[geom] and geom != ball
    ]
    nearest = min(mujoco.mj_geomDistance(model, data, ball, geom, 10, None) for geom in others)
    assert clearance["distance"] == pytest.approx(nearest, abs=1e-4)


def test_the_robot_s_numbers_are_those_of_its_files(capsys):
    robot = described(capsys, "lessons/04_ur_pick_by_friction")["robot"]
    assert (robot["base"]["xyz"], robot["tcp_link"]) == ([0, 0, 1.02], "end_effector_link")
    assert "mogi_home" in robot["named_states"]["ur_manipulator"]
    assert robot["joints"]["rh_r1_joint"]["unit"] == "rad"
    assert (
        0.7 < robot["reach"]["farthest"] < 0.9
    )  # the data sheet: 0.5 m to the wrist, then the hand


@pytest.mark.nightly
def test_the_longest_lesson_is_a_page_that_an_agent_reads(capsys):
    """Sixteen steps among eleven objects: what fits in a row stands in one."""
    assert main(["describe", "lessons/03_ur_sixteen_steps", "--json"]) == 0
    printed = capsys.readouterr().out
    assert len(printed.splitlines()) <= 150
    assert len(json.loads(printed)["objects"]) == 7


@pytest.mark.nightly
def test_values_of_the_command_line_change_the_scene(scene, capsys):
    moved = by_name(described(capsys, scene, "--set", "objects.cube.pose.xyz=[0.3,0.2,0.025]"))
    assert moved["cube"]["pose"]["xyz"] == [0.3, 0.2, 0.025]


def test_the_text_has_every_object_and_why_it_cannot_be_picked(scene, capsys):
    assert main(["describe", str(scene)]) == 0
    printed = capsys.readouterr().out
    assert all(f"\n{name}: " in printed for name in ("slab", "cube", "brick", "far"))
    assert "too wide for the gripper" in printed
    assert "added by a step: cup" in printed


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("world: empty", "world: emty", r"scene\.scenario\.yaml:3:8: .*did you mean `empty`"),
        ("mass: 2,", "mass: 2 m,", r"scene\.scenario\.yaml:10:\d+: `2 m` is a length"),
        ("model: ur3e", "model: ur33", r"scene\.scenario\.yaml:2:"),
    ],
)
def test_a_mistake_of_the_file_is_located(scene, capsys, old, new, message):
    scene.write_text(SCENE.replace(old, new), encoding="utf-8")
    assert main(["describe", str(scene), "--json"]) == 2
    printed = capsys.readouterr()
    assert re.search(message, printed.err, re.DOTALL)
    assert printed.out == ""


@pytest.mark.parametrize("name", ["no_such.scenario.yaml", "lessons"])
def test_what_is_not_one_scenario_is_refused(capsys, name):
    assert main(["describe", name]) == 2
    assert name.split(".")[0] in capsys.readouterr().err


def test_every_key_is_on_the_page_of_the_reference(scene, capsys):
    keys = set()

    def visit(value):
        for key, entry in value.items() if isinstance(value, dict) else ():
            keys.add(key)
            visit(entry) if key not in ("joints", "named_states") else None
        for entry in value if isinstance(value, list) else ():
            visit(entry)

    visit(described(capsys, scene))
    assert [key for key in sorted(keys) if f"`{key}`" not in PAGE] == []
