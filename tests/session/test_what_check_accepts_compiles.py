"""Masses, inertias, sizes and places on the edge: `check` refuses them, or they run."""

import pytest

from harness.session.check import check_file
from tests.robot.arm_files import INERTIAL, SRDF, URDF, write_arm
from tests.running import run_case

BOX = "box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.5, 0, 0.5]}"


def scene(folder, obj, robot="ur3e"):
    text = f"scenario: edges\nrobot: {robot}\nobjects:\n  - {{name: body, {obj}}}\n"
    path = folder / "test.scenario.yaml"
    path.write_text(f"{text}steps: [{{wait: 0.02}}]\n", encoding="utf-8")
    return path


def an_inertia(xx, yy, zz, xy=0.0):
    return f"{BOX}, mass: 0.1, inertia: {{ixx: {xx}, iyy: {yy}, izz: {zz}, ixy: {xy}}}"


def arm_with(folder, inertial=None, length="0.14"):
    """A scenario whose arm has another inertial on its wrist, or shapes of another length."""
    urdf = URDF
    if inertial is not None:
        urdf = urdf.replace(f'<link name="wrist">{INERTIAL}', f'<link name="wrist">{inertial}')
    urdf = urdf.replace('length="0.14"', f'length="{length}"')
    assert urdf != URDF
    write_arm(folder, urdf, SRDF)
    return scene(folder, BOX, "{urdf: arm.urdf, srdf: arm.srdf}")


def a_wrist(mass, xx, yy, zz, xy=0.0, rpy="0 0 0"):
    return (
        f'<inertial><origin rpy="{rpy}"/><mass value="{mass}"/><inertia ixx="{xx}" iyy="{yy}"'
        f' izz="{zz}" ixy="{xy}"/></inertial>'
    )


@pytest.mark.nightly(but=["0 0 0-tensor3"])
@pytest.mark.parametrize(
    "tensor",
    [
        (9e-6, 1e-6, 1e-5, -1e-6),  # outer_knuckle of the Robotiq 2F-85
        (1.0, 1.0, 2.0),  # a thin disc
        (1e-9, 1.0, 1.0),  # a thin rod
        (0.01234, 0.02345, 0.0358),  # rounded to four digits
    ],
)
@pytest.mark.parametrize("rpy", ["0 0 0", "0.3 -0.2 1"])
def test_a_body_on_the_edge_of_the_triangle_inequality_runs(tmp_path, tensor, rpy):
    if rpy == "0 0 0":
        file = scene(tmp_path, an_inertia(*tensor))
        assert not check_file(file).problems
        assert run_case(file).outcome == "passed"
    file = arm_with(tmp_path, a_wrist(0.1, *tensor, rpy=rpy))
    found = check_file(file)
    assert not found.problems
    assert run_case(file).outcome == "passed"


@pytest.mark.parametrize(
    ("obj", "words"),
    [
        (an_inertia(1, 1, 2.01), "principal moments are 1, 1, 2.01 kg m^2"),
        (an_inertia(0, 0, 0), "no body has this inertia"),
        (an_inertia(1e-16, 1e-16, 1e-16), "smallest principal moment of inertia is 1e-16"),
        ("box: {size: [0.1 mm, 0.1 mm, 0.1 mm]}", "moment of inertia is 1.67e-18 kg m^2"),
        ("sphere: {radius: 1.0e-9}", "a mass of 4.19e-24 kg"),
    ],
)
def test_what_the_physics_refuses_is_refused_at_the_object(tmp_path, obj, words):
    file = scene(tmp_path, obj)
    [problem] = check_file(file).problems
    assert (problem.line, problem.column) == (4, 5)
    assert problem.message.startswith("object 'body': ")
    assert words in problem.message
    result = run_case(file)
    assert (result.outcome, result.problems) == ("invalid", (problem,))


@pytest.mark.parametrize(
    ("obj", "column", "words"),
    [
        (f"{BOX}, mass: 1.0e-20", 82, "1e-20 is too small"),
        (f"{BOX}, mass: 1.0e+308", 82, "1e+308 is too large"),
        ("box: {size: [1.0e+150, 1.0e+150, 1]}", 30, "1e+150 is too large"),
        ("box: {size: [5.0e-324, 1, 1]}, static: true", 31, "is too small"),
        ("sphere: {radius: 1}, pose: {xyz: [1.0e+300, 0, 0]}", 51, "1e+300 is too large"),
    ],
)
def test_a_number_beyond_what_any_scene_has_is_refused_where_it_stands(
    tmp_path, obj, column, words
):
    file = scene(tmp_path, obj)
    [problem] = check_file(file).problems
    assert (problem.line, problem.column) == (4, column)
    assert words in problem.message
    assert run_case(file).problems == (problem,)


@pytest.mark.parametrize(
    ("inertial", "words"),
    [
        (a_wrist("1e-12", 0, 0, 0), "link 'wrist': the physics refuses it: "),
        (a_wrist("1e-16", 1e-3, 1e-3, 1e-3), "link 'wrist': the physics refuses it: "),
        (a_wrist("1e308", 0.01, 0.01, 0.01), "its acceleration at the start exceeds 1e+10"),
    ],
)
def test_what_the_physics_refuses_of_a_robot_is_refused_at_the_robot(tmp_path, inertial, words):
    file = arm_with(tmp_path, inertial)
    [problem] = check_file(file).problems
    assert problem.line == 2
    assert words in problem.message
    assert run_case(file).problems == (problem,)


def test_shapes_of_a_robot_that_are_too_small_are_left_out(tmp_path):
    file = arm_with(tmp_path, length="5e-324")
    assert not check_file(file).problems
    assert run_case(file).outcome == "passed"


@pytest.mark.parametrize("name", ["shoulder_pan_joint", "wrist_3_joint", "forearm_link", "world"])
def test_an_object_does_not_take_the_name_of_a_part_of_the_robot(tmp_path, name):
    file = scene(tmp_path, BOX)
    file.write_text(file.read_text().replace("name: body", f"name: {name}"), encoding="utf-8")
    [problem] = check_file(file).problems
    assert problem.line == 4
    assert f"'{name}' is a robot " in problem.message
    assert run_case(file).outcome == "invalid"
