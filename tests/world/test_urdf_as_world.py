"""URDF files as worlds: cabinets whose doors and drawers move."""

import mujoco
import numpy as np
import pytest

from harness.core.errors import SpecError
from harness.core.spatial import SE3
from harness.plugins.formats.urdf_world.fixture import load_urdf
from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.running import run_case


def link(name, size="", at="0 0 0", mass=""):
    inertia = '<inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/>'
    inertial = f'<inertial><origin xyz="{at}"/><mass value="{mass}"/>{inertia}</inertial>'
    box = f'<origin xyz="{at}"/><geometry><box size="{size}"/></geometry>'
    shape = f"<collision>{box}</collision><visual>{box}</visual>" if size else ""
    return f'<link name="{name}">{inertial if mass else ""}{shape}</link>'


def joint(name, kind, parent, child, at, axis="0 0 1", limits="", rpy="0 0 0", more=""):
    limit = f'<limit {limits} effort="10" velocity="1"/>' if limits else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}" rpy="{rpy}"/><axis xyz="{axis}"/>{limit}{more}</joint>'
    )


CABINET = f"""<robot name="cabinet"><link name="base"/>
{link("body", "0.4 0.5 0.04", mass="5")}
{joint("stand", "fixed", "base", "body", "0.6 0.1 0.3", rpy="0 0 0.4")}
{link("lid", "0.3 0.3 0.02", "0.15 0 0", "0.5")}
{
    joint(
        "lid_hinge",
        "revolute",
        "body",
        "lid",
        "0.2 0 0.1",
        "0 1 0",
        'lower="-1" upper="1.2"',
        more='<dynamics damping="0.2"/>',
    )
}
{link("drawer", "0.2 0.3 0.1", "0 0 0.05", "1.5")}
{
    joint(
        "slide",
        "prismatic",
        "body",
        "drawer",
        "-0.3 0 -0.1",
        "-1 0 -1",
        'lower="0" upper="0.3"',
        rpy="0.2 0 0",
        more='<dynamics damping="3"/>',
    )
}
{link("handle", "0.02 0.1 0.02", "-0.12 0 0.05", "0.1")}
{joint("handle_joint", "fixed", "drawer", "handle", "0 0 0")}
</robot>"""


def loaded(folder, text):
    path = folder / "own.urdf"
    path.write_text(text, encoding="utf-8")
    return load_urdf(path)


def pose_of(data, body):
    return SE3.from_xyz_quat(data.body(body).xpos.copy(), data.body(body).xquat.copy())


def test_parts_move_as_in_mujoco(tmp_path):
    world = loaded(tmp_path, CABINET)
    [cabinet] = world.world.objects
    assert {part.name: len(part.shapes) for part in cabinet.joints} == {"lid_hinge": 1, "slide": 2}
    assert cabinet.joints[1].mass == pytest.approx(1.6)
    (tmp_path / "a.scenario.yaml").write_text(
        "scenario: x\nrobot: {model: open_manipulator_x, base: {xyz: [-2, 0, 0]}}\n"
        "world: own.urdf\nsteps: [{wait: 0.2 s}]\n",
        encoding="utf-8",
    )
    run_case(tmp_path / "a.scenario.yaml", report_dir=tmp_path / "run", stills=False, page=False)
    poses = read_run(tmp_path / "run").run.signals.object_poses
    option = '<mujoco><compiler fusestatic="false" discardvisual="true"/></mujoco>'
    spec = mujoco.MjSpec.from_string(CABINET.replace("</robot>", option + "</robot>"))
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.option.timestep = 0.001
    spec.option.gravity = [0, 0, -9.8]
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    names = {"cabinet/lid_hinge": "lid", "cabinet/slide": "drawer"}
    starts = {body: pose_of(data, body) for body in names.values()}
    mujoco.mj_step(model, data, 200)
    mujoco.mj_kinematics(model, data)
    for part, body in names.items():
        end = pose_of(data, body)
        first, last = (SE3.from_vector(poses[part][index]) for index in (0, 200))
        ours, theirs = last @ first.inverse(), end @ starts[body].inverse()
        assert max(theirs.distance_to(SE3.identity())) > 0.03
        assert ours.distance_to(theirs) == pytest.approx((0.0, 0.0), abs=6e-3), part


def test_what_cannot_move_here_has_a_note(tmp_path):
    more = link("knob", "0.02 0.02 0.02", mass="0.1") + link("frame") + link("rod", mass="0.1")
    more += joint("turn", "continuous", "drawer", "knob", "-0.12 0 0", "1 0 0")
    more += joint("loose", "continuous", "body", "rod", "0 0 1")
    text = CABINET.replace("</robot>", more.replace(link("frame"), "") + "</robot>")
    notes = [note.message for note in loaded(tmp_path, text).notes]
    assert "the joint 'turn' is held where the file puts it: a part has one joint" in notes
    assert "the joint 'loose' and what it moves are left out: nothing of it touches" in notes


def test_an_endless_hinge_turns_half_a_turn_each_way(tmp_path):
    more = link("valve", "0.1 0.1 0.02", mass="0.1")
    more += joint("wheel", "continuous", "body", "valve", "0 0.5 0.2")
    world = loaded(tmp_path, CABINET.replace("</robot>", more + "</robot>"))
    part = next(each for each in world.world.objects[0].joints if each.name == "wheel")
    assert part.hinge.range == pytest.approx((-np.pi, np.pi), abs=1e-5)
    assert any("'wheel' moves from -3.14159 to 3.14159 rad here" in n.message for n in world.notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot name='x'><link name='a'/></robot>", "nothing of it touches"),
        ("<sdf version='1.9'/>", "the root element is <sdf>"),
        (CABINET.replace('size="0.3 0.3 0.02"', 'size="0.3 -0.3 0.02"'), "size"),
    ],
)
def test_mistakes_are_located(text, message, tmp_path):
    with pytest.raises(SpecError) as caught:
        loaded(tmp_path, text)
    [problem] = caught.value.problems
    assert message in problem.message
    assert problem.path.endswith("own.urdf")


def test_a_part_inside_the_robot_at_the_start_is_reported(tmp_path):
    (tmp_path / "own.urdf").write_text(CABINET, encoding="utf-8")
    path = tmp_path / "a.scenario.yaml"
    text = "scenario: x\nrobot: open_manipulator_x\nworld: own.urdf\nsteps: [{wait: 1 s}]\n"
    path.write_text(text, encoding="utf-8")
    notes = list(map(str, check_file(path).notes))
    assert any("cabinet/slide" in note and "overlap" in note for note in notes), notes


def test_a_step_and_an_expectation_know_its_joints(tmp_path):
    (tmp_path / "own.urdf").write_text(CABINET, encoding="utf-8")
    path = tmp_path / "a.scenario.yaml"
    path.write_text(
        "scenario: x\nrobot: {model: open_manipulator_x, base: {xyz: [-1, 0, 0]}}\n"
        "world: own.urdf\nsteps: [{wait: 1 s}]\n"
        "expect: [{joint: {object: cabinet, joint: slide, at_most: 1 cm}}]\n",
        encoding="utf-8",
    )
    assert not check_file(path).problems
    path.write_text(path.read_text().replace("joint: slide", "joint: door"), encoding="utf-8")
    assert "door" in check_file(path).problems[0].message
