"""MJCF scenes as worlds: bodies become objects where MuJoCo places them."""

import json

import mujoco
import numpy as np
import pytest

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.core.geometry import Mesh
from harness.core.spatial import SE3
from harness.language.reading.load import load_world
from harness.language.world import FrictionSpec
from harness.plugins.formats.mjcf.scene import load_mjcf
from harness.recording.read_run import read_run
from harness.robot.mesh_file import read_triangles
from harness.world.objects import resolve_object
from tests.running import run_case
from tests.world.sdf_files import TETRAHEDRON

ARM = """<mujoco model="arm"><worldbody>
 <body name="arm_base" pos="1 1 0"><geom name="base_geom" size=".1"/>
  <body name="upper" pos="0 0 .2"><joint name="j1"/><geom size=".05"/>
   <body name="hand" pos="0 0 .2"><geom size=".04"/></body></body></body>
 </worldbody><actuator><motor joint="j1"/></actuator></mujoco>
"""

SCENE = """<mujoco model="kitchen">
 <include file="arm.xml"/>
 <compiler angle="degree" eulerseq="zyx" autolimits="true" meshdir="meshes"/>
 <option timestep="0.002" gravity="0 0.1 -9.7"/>
 <default><geom friction="0.7 0.01 0.0002"/>
  <default class="visual"><geom contype="0" conaffinity="0" group="2"/></default></default>
 <asset><mesh name="m" file="part.obj" scale="1 2 -3" refpos="0.01 0.02 0.03"/>
  <mesh name="turned" file="part.obj" scale="2 2 2" refpos="0.1 0 0" refquat="0.8 0.6 0 0"/>
  <material name="red" rgba="1 0 0 1"/></asset>
 <worldbody>
  <light type="directional" dir="0 1 -1" pos="0 0 3"/>
  <geom name="floor" type="plane" size="2 2 .1" pos="0 0 -0.1"/>
  <geom type="box" size=".1 .2 .3" pos="2 0 .3" euler="30 20 10"/>
  <geom name="table" type="capsule" fromto="2 1 .5 2.5 1 .5" size=".1" rgba=".1 .2 .3 1"/>
  <body name="table" pos=".5 0 .4" euler="90 0 0">
   <geom name="top" type="box" size=".3 .4 .02" material="red"/>
   <frame pos="0 0 -.1" euler="0 10 0">
    <body name="leg" pos="0 .1 -.1" xyaxes="0 1 0 -1 0 0"><geom type="cylinder" size=".02 .18"/>
     <geom class="visual" type="mesh" mesh="turned" pos="0.1 0 0" euler="5 6 7"/></body></frame>
  </body>
  <body name="part" pos=".5 .1 .8" euler="10 20 30"><freejoint/>
   <geom type="mesh" mesh="m" mass="0.3" rgba="0 1 0 1"/>
   <body name="knob" pos="0.1 0 0" euler="0 0 45">
    <geom name="ball" type="ellipsoid" size=".01 .02 .03" friction="1 .005 .0001"/>
    <geom class="visual" type="sphere" size=".05" mass="0"/></body>
  </body>
  <body name="frame_only" pos="1 0 0"/>
  <body name="ghost" pos="1 0 1"><geom class="visual" size=".1"/></body>
  <body name="door" pos="3 0 0"><joint type="hinge" range="0 90"/><geom size=".1"/></body>
 </worldbody>
</mujoco>
"""


@pytest.fixture
def scene(tmp_path):
    """A scene file with an included arm and a mesh."""
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "part.obj").write_text(TETRAHEDRON, encoding="utf-8")
    (tmp_path / "arm.xml").write_text(ARM, encoding="utf-8")
    path = tmp_path / "scene.xml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def compiled(path):
    """MuJoCo's own model of a file, and the scene at its start."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def objects_of(path):
    return {item.name: item for item in load_mjcf(path).world.objects}


def resolved(path, name):
    spec = objects_of(path)[name]
    return resolve_object(spec, spec.pose.se3(), path.parent)


def loaded(tmp_path, body, *, before=""):
    path = tmp_path / "own.xml"
    text = f"<mujoco>{before}\n<worldbody>\n{body}\n</worldbody></mujoco>"
    path.write_text(text, encoding="utf-8")
    return load_mjcf(path)


def test_objects_are_where_mujoco_places_bodies_and_geoms_of_the_world(scene):
    model, data = compiled(scene)
    objects = objects_of(scene)
    names = ["floor", "box", "table_2", "table", "leg", "part", "ghost"]
    assert list(objects) == [*names, "door"]
    for name in ("table", "leg", "part", "ghost"):
        body = model.body(name).id
        expected = SE3.from_xyz_quat(data.xpos[body], data.xquat[body])
        assert max(objects[name].pose.se3().distance_to(expected)) < 1e-9
    for name, geom in (("floor", "floor"), ("box", 1), ("table_2", "table")):
        number = model.geom(geom).id
        expected = SE3(data.geom_xmat[number].reshape(3, 3), data.geom_xpos[number])
        assert max(objects[name].pose.se3().distance_to(expected)) < 1e-9
    assert [name for name in names if not objects[name].static] == ["part"]
    assert objects["box"].box.size == pytest.approx((0.2, 0.4, 0.6))
    assert objects["table_2"].capsule.length == pytest.approx(0.5)
    assert objects["ghost"].visuals
    assert not objects["ghost"].shapes


@pytest.mark.parametrize(("name", "geoms"), [("part", "shapes"), ("leg", "visuals")])
def test_vertices_of_meshes_are_where_mujoco_has_them(scene, name, geoms):
    model, data = compiled(scene)
    shape = next(s for s in getattr(resolved(scene, name), geoms) if isinstance(s.geometry, Mesh))
    pose = objects_of(scene)[name].pose.se3() @ shape.pose
    found = np.array([pose.apply(v) for v in read_triangles(shape.geometry).vertices])
    mesh = model.mesh("m" if name == "part" else "turned").id
    geom = next(g for g in range(model.ngeom) if model.geom_dataid[g] == mesh)
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    place = SE3(data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom])
    expected = np.array([place.apply(v) for v in model.mesh_vert[first : first + count]])
    gaps = np.linalg.norm(found[:, None] - expected[None], axis=2)
    assert max(gaps.min(axis=0).max(), gaps.min(axis=1).max()) < 1e-6


def test_mass_and_inertia_are_those_of_the_free_body_and_what_is_fixed_to_it(scene):
    model, data = compiled(scene)
    part = resolved(scene, "part")
    body = model.body("part").id
    assert part.mass == pytest.approx(model.body_subtreemass[body], rel=1e-9)
    center = part.pose.apply(part.center_of_mass)
    assert center == pytest.approx(data.subtree_com[body], abs=1e-9)
    # the motion about the centre of mass that a torque causes is the inertia's
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    first = model.jnt_dofadr[model.body_jntadr[body]]
    about_origin = full[first + 3 : first + 6, first + 3 : first + 6]
    c = part.center_of_mass
    shifted = part.inertia + part.mass * (c @ c * np.eye(3) - np.outer(c, c))
    assert shifted == pytest.approx(about_origin, rel=1e-6, abs=1e-10)


def test_colours_frictions_lights_and_physics_are_read(scene):
    world = load_mjcf(scene).world
    objects = {item.name: item for item in world.objects}
    assert objects["table"].color == (1.0, 0.0, 0.0, 1.0)
    assert objects["table_2"].color == (0.1, 0.2, 0.3, 1.0)
    assert objects["table"].friction == FrictionSpec(sliding=0.7, torsional=0.01, rolling=0.0002)
    part = resolved(scene, "part")
    assert [shape.friction and shape.friction.sliding for shape in part.shapes] == [None, 1.0]
    assert part.friction.sliding == 0.7
    assert world.world == "kitchen"
    assert world.physics.timestep == 0.002
    assert world.physics.gravity == (0.0, 0.1, -9.7)
    assert world.lights[0].direction == pytest.approx((0, 0.5**0.5, -(0.5**0.5)))
    off = SCENE.replace('.1 -9.7"/>', '.1 -9.7"><flag gravity="disable"/></option>')
    scene.write_text(off, encoding="utf-8")
    assert load_mjcf(scene).world.physics.gravity == (0.0, 0.0, 0.0)


def test_what_is_left_out_has_a_note_at_its_place(scene):
    found = {str(note).removeprefix(f"{scene.parent}/") for note in load_mjcf(scene).notes}
    for begin in (
        "arm.xml:2: the body 'arm_base' and what it carries are left out: a robot is read with",
        "arm.xml:5: <actuator> is left out",
        "scene.xml:14: the geom 'table' is called 'table_2' here: a body has its name",
        "scene.xml:1: a contact takes the smaller friction of its two geoms",
    ):
        assert [note for note in found if note.startswith(begin)], (begin, found)
    assert len(found) == 4


@pytest.mark.parametrize(
    ("body", "note"),
    [
        ("<camera pos='0 0 1'/>", "3: <camera> is left out"),
        ("<site name='s'/>", "3: <site> is left out"),
        ("<light pos='0 0 1'/>", "3: a light is left out"),
        ("<geom size='.1' condim='1'/>", "3: condim of <geom> is left out"),
        ("<geom size='.1' contype='2'/>", "3: masks of contype and conaffinity are left out"),
        ("<body mocap='true'><geom size='.1'/></body>", "3: a mocap body is fixed"),
        ("<body><joint type='ball'/><geom size='.1'/></body>", "3: the body 'body_1' and what"),
        (
            "<body name='b'><freejoint/><geom size='.1'/>\n"
            "<body><joint/><geom size='.1'/></body></body>",
            "3: the body 'b' and what it carries are left out: objects are rigid",
        ),
        ("<body gravcomp='1'><freejoint/><geom size='.1'/></body>", "3: gravcomp is left out"),
        (
            "<body name='b'><freejoint/>"
            "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/></body>",
            "3: the free body 'b' is left out: it has no geoms",
        ),
    ],
)  # fmt: skip
def test_parts_without_an_effect_have_notes(tmp_path, body, note):
    (found,) = loaded(tmp_path, body).notes
    assert str(found).startswith(f"{tmp_path / 'own.xml'}:{note}")


KITCHEN = """<body name="cabinet" pos=".8 .1 .4" euler="0 0 20"><geom type="box" size=".1 .2 .2"/>
  <body name="door" pos="-.13 .2 0" euler="0 0 10">
   <joint name="hinge" axis="0 0 -2" pos=".01 0 0" range="-5 110" frictionloss=".1" damping=".3"
    stiffness="2" springref="60"/>
   <geom type="box" size=".01 .2 .2" pos="-.032 -.2 0"/>
   <body name="knob" pos="-.05 -.3 0"><joint axis="1 0 0"/><geom size=".02"/></body></body></body>
  <body name="flap" pos="0 1 .5"><joint axis="0 1 0"/><geom type="box" size=".1 .1 .01"
   pos=".1 0 0"/></body>
  <body name="rail" pos="0 -1 .5"><geom size=".02"/><body name="slider"><joint name="way"
   type="slide" axis="1 0 1" springref=".1" stiffness="300" ref=".05" range="0 .2" damping="4"/>
   <geom type="box" size=".05 .05 .01" pos="0 0 .05"/></body></body>"""


def test_doors_and_drawers_move_as_in_mujoco(tmp_path):
    imported = loaded(tmp_path, KITCHEN)
    names = {item.name: [each.name for each in item.joints] for item in imported.world.objects}
    assert names == {"cabinet": ["hinge"], "flap": ["joint"], "rail": ["way"]}
    assert [str(note).split(": ", 1)[1] for note in imported.notes] == [
        "the body 'knob' is held where the file puts it: a part has one joint",
        "the joint 'joint' turns or slides from -3.14159 to 3.14159 rad here",
    ]
    (tmp_path / "a.scenario.yaml").write_text(
        "scenario: x\nrobot: {model: open_manipulator_x, base: {xyz: [-2, 0, 0]}}\n"
        "world: own.xml\nsteps: [{wait: 0.36 s}]\n",
        encoding="utf-8",
    )
    run_case(tmp_path / "a.scenario.yaml", report_dir=tmp_path / "run", stills=False, page=False)
    poses = read_run(tmp_path / "run").run.signals.object_poses
    spec = mujoco.MjSpec.from_file(str(tmp_path / "own.xml"))
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.delete(spec.body("knob").joints[0])
    spec.add_exclude(bodyname1="cabinet", bodyname2="door")
    spec.add_exclude(bodyname1="cabinet", bodyname2="knob")
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(180):  # then the flap has not turned so far that its limits matter
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    for part, body in (("cabinet/hinge", "door"), ("flap/joint", "flap"), ("rail/way", "slider")):
        start, end = (SE3.from_vector(poses[part][index]) for index in (0, 180))
        data_now = SE3.from_xyz_quat(data.body(body).xpos, data.body(body).xquat)
        data_start = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data_start)
        before = SE3.from_xyz_quat(data_start.body(body).xpos, data_start.body(body).xquat)
        moved = (end @ start.inverse()).distance_to(data_now @ before.inverse())
        assert moved == pytest.approx((0.0, 0.0), abs=3e-3), part  # friction of joints is stiffer
        assert max(end.distance_to(start)) > 0.03


def test_a_drawer_is_a_joint_of_its_cabinet_and_a_table_stays_without_its_robot(tmp_path):
    cabinet = """<body name="cabinet"><geom type="box" size=".4 .4 .4"/>
      <body name="drawer"><joint type="slide"/><geom size=".1"/></body></body>
      <body name="table" pos="1 0 0"><geom type="box" size=".4 .4 .4"/>
      <body name="base"><geom size=".1"/><body name="link"><joint name="j"/><geom size=".1"/>
      </body><body name="cover"><geom size=".1"/></body></body></body>"""
    actuator = '<actuator><motor joint="j"/></actuator>'
    world = loaded(tmp_path, cabinet, before=actuator).world
    assert [item.name for item in world.objects] == ["cabinet", "table"]
    without = loaded(tmp_path, cabinet).world
    names = ["cabinet", "table", "base", "cover"]
    assert [item.name for item in without.objects] == names
    assert [len(item.joints) for item in without.objects] == [1, 0, 1, 0]


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "no element found"),
        ("<robot/>", 1, "the root element is <robot>, an MJCF's is <mujoco>"),
        ("<mujoco>\n<worldbody>\n<geom size='-1'/></worldbody></mujoco>", 3, "MuJoCo: size"),
        ("<mujoco>\n<worldbody>\n<geon/></worldbody></mujoco>", 3, "MuJoCo: Schema violation"),
        ("<mujoco>\n<include file='no.xml'/></mujoco>", 2, "is not there"),
        ("<mujoco>\n<include file='/etc/passwd'/></mujoco>", 2, "add /etc to `model_path`"),
        ("<mujoco>\n<include file='own.xml'/></mujoco>", 2, "in a circle"),
        ("<mujoco><worldbody>\n<replicate count='1e9'/></worldbody></mujoco>", 2, "copies"),
        ("<mujoco><asset>\n<mesh name='m' file='no.stl'/></asset><worldbody>"
         "<geom type='mesh' mesh='m'/></worldbody></mujoco>", 2, "no.stl"),
        ("<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset><worldbody>\n"
         "<geom type='mesh' mesh='m'/></worldbody></mujoco>", 2, "this mesh is not supported"),
        ("<mujoco><asset><hfield name='h' nrow='2' ncol='2' size='1 1 1 1'/></asset><worldbody>\n"
         "<geom type='hfield' hfield='h'/></worldbody></mujoco>", 2, "hfield is not supported"),
        ("<mujoco><worldbody>\n<geom size='1e-10'/></worldbody></mujoco>", 2, "is too small"),
        ("<mujoco><worldbody>\n<geom size='1' pos='1e12 0 0'/></worldbody></mujoco>", 2, "large"),
        ("<mujoco><worldbody>\n<body><freejoint/><geom size='1' mass='1e12'/></body></worldbody>"
         "</mujoco>", 2, "large"),
        (f"<mujoco><worldbody>\n<body name='{'n' * 101}'><geom size='1'/></body></worldbody>"
         "</mujoco>", 2, "has more than 100 characters"),
        ("<mujoco><worldbody>\n<geom size='1' pos='nan 0 0'/></worldbody></mujoco>", 2,
         "pos of <geom> is not a number"),
        ("<mujoco><option\n timestep='NaN'/></mujoco>", 2, "timestep of <option> is not a number"),
        ("<mujoco><worldbody>\n<body><freejoint/><geom size='1' mass=' -nan '/></body></worldbody>"
         "</mujoco>", 2, "mass of <geom> is not a number"),
        ("<mujoco><option gravity='0 0 1e12'/>\n<worldbody/></mujoco>", 1, "large"),
    ],
)  # fmt: skip
def test_mistakes_are_located(tmp_path, monkeypatch, text, line, message):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "own.xml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        load_mjcf(path)
    problem = caught.value.problems[0]
    assert problem.line == line, problem
    assert message in f"{problem.message} {problem.hint}"
    assert [each.name for each in tmp_path.iterdir()] == ["own.xml"]


CELL = """<mujoco>
 <worldbody>
  <geom name="floor" type="plane" size="2 2 .1"/>
  <body name="table" pos=".35 -.1 .1"><geom type="box" size=".2 .2 .1"/></body>
  <body name="can" pos=".35 -.1 .25"><freejoint/>
   <geom type="cylinder" size=".03 .05" mass=".1" friction="1 .01 .001"/></body>
 </worldbody>
</mujoco>
"""
SCENARIO = """scenario: In a MuJoCo scene
robot: ur3e
world: cell.xml
steps:
  - settle
expect:
  - in_contact: [can, table]
"""


def test_a_scenario_runs_in_a_scene_as_in_its_imported_world(tmp_path, capsys):
    (tmp_path / "cell.xml").write_text(CELL, encoding="utf-8")
    path = tmp_path / "can.scenario.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    assert main(["check", "--json", str(path)]) == 0
    (file,) = json.loads(capsys.readouterr().out)["files"]
    assert ["smaller friction" in note for note in file["notes"]] == [True]
    result = run_case(path, report_dir=tmp_path / "report", stills=False, page=False)
    assert result.outcome == "passed", result
    again = run_case(tmp_path / "report" / "scenario.resolved.yaml", stills=False)
    assert again.digest == result.digest
    assert main(["import", "mjcf", str(tmp_path / "cell.xml")]) == 0
    assert "3 objects" in capsys.readouterr().out
    path.write_text(SCENARIO.replace("cell.xml", "cell.yaml"), encoding="utf-8")
    assert run_case(path, stills=False).digest == result.digest


def test_an_import_writes_ellipsoids_and_is_equal(scene, capsys):
    assert main(["import", "mjcf", str(scene), "-o", str(scene.parent / "w.yaml")]) == 0
    capsys.readouterr()
    assert (scene.parent / "sphere.stl").is_file()
    written = load_world("w.yaml", scene.parent).model
    read = load_mjcf(scene).world
    assert [item.pose for item in written.objects] == [item.pose for item in read.objects]
    assert written.physics == read.physics


@pytest.mark.parametrize("light", ['type="image"', 'type="image" intensity="5"', ""])
def test_a_light_of_a_picture_is_left_out_with_the_picture(tmp_path, light):
    text = f"""<mujoco><asset><texture name="sky" type="cube" builtin="flat" width="8" height="48"/>
     </asset><worldbody><light texture="sky" {light}/><light type="directional" dir="0 0 -1"/>
     <body name="box" pos="0 0 1"><freejoint/><geom size=".1"/></body></worldbody></mujoco>"""
    mujoco.MjModel.from_xml_string(text)
    (tmp_path / "lit.xml").write_text(text)
    world = load_mjcf(tmp_path / "lit.xml").world
    assert [each.name for each in world.objects] == ["box"]
    assert len(world.lights) == 1


def test_a_mistake_ends_with_code_2_and_writes_nothing(tmp_path, capsys):
    (tmp_path / "bad.xml").write_text("<mujoco>\n<worldbody><geom/></worldbody></mujoco>")
    assert main(["import", "mjcf", str(tmp_path / "bad.xml")]) == 2
    assert "bad.xml:2" in capsys.readouterr().err
    assert not (tmp_path / "bad.yaml").exists()
    (tmp_path / "bad.scenario.yaml").write_text("robot: ur3e\nworld: bad.xml\nsteps: [settle]\n")
    assert main(["check", str(tmp_path / "bad.scenario.yaml")]) == 2
