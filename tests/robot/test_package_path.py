"""Where package:// leads: folders given, the robot's own package and those next to it, Python's."""

import os
import re

import pytest

from harness.cli.main import main
from harness.core.errors import RobotError, SpecError
from harness.core.geometry import Mesh
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.robot.arm_files import SHAPE, SRDF, URDF
from tests.world.sdf_files import TETRAHEDRON

LOOK = (
    '<collision><geometry><mesh filename="package://looks/meshes/part.obj"/></geometry></collision>'
)


def package(folder, name, *, manifest=True):
    """A package's folder, by its manifest called as `name`."""
    folder.mkdir(parents=True)
    if manifest:
        (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")
    return folder


def looks(folder, **words):
    """A package with a mesh."""
    made = package(folder, "looks", **words) / "meshes"
    made.mkdir()
    (made / "part.obj").write_text(TETRAHEDRON)
    return folder


def arm(folder):
    """A package with an arm that collides as the mesh of another one."""
    (package(folder, "arm") / "urdf").mkdir()
    (folder / "urdf" / "arm.urdf").write_text(URDF.replace(SHAPE, SHAPE + LOOK))
    (folder / "urdf" / "arm.srdf").write_text(SRDF)
    return folder / "urdf" / "arm.urdf"


def mesh(base, urdf, **words):
    """The mesh with which the arm's first link collides."""
    found = load_robot(RobotSpec.model_validate({"urdf": str(urdf), **words}), base)
    _, seen = next(link for link in found.links if link.name == "upper").collisions
    assert isinstance(seen.geometry, Mesh)
    return seen.geometry.path


@pytest.mark.parametrize(
    ("place", "given"),
    [
        ("given/looks", "given"),
        ("given/looks", "given/looks"),
        ("given/src/group/called_otherwise", "given"),
        ("given/share/looks", "given"),
        ("given/looks/share/looks", "given"),
    ],
)
def test_a_given_folder_holds_packages_or_is_one(tmp_path, monkeypatch, place, given):
    urdf = arm(tmp_path / "arm")
    folder = looks(tmp_path / place)
    expected = folder / "meshes" / "part.obj"
    assert mesh(tmp_path, urdf, packages=[given]) == expected
    monkeypatch.setenv("HARNESS_PACKAGE_PATH", str(tmp_path / given))
    assert mesh(tmp_path, urdf) == expected


def test_a_package_next_to_the_robots_own_is_found(tmp_path):
    urdf = arm(tmp_path / "src" / "arm")
    folder = looks(tmp_path / "src" / "looks", manifest=False)
    assert mesh(tmp_path, urdf) == folder / "meshes" / "part.obj"


def test_a_package_installed_apart_next_to_the_robots_own_is_found(tmp_path):
    urdf = arm(tmp_path / "install" / "arm" / "share" / "arm")
    folder = looks(tmp_path / "install" / "looks" / "share" / "looks")
    assert mesh(tmp_path, urdf) == folder / "meshes" / "part.obj"


def test_the_robots_own_package_is_known_by_its_manifest(tmp_path):
    urdf = arm(tmp_path / "called_otherwise")
    folder = tmp_path / "called_otherwise"
    (folder / "meshes").mkdir()
    (folder / "meshes" / "part.obj").write_text(TETRAHEDRON)
    urdf.write_text(urdf.read_text().replace("package://looks", "package://arm"))
    assert mesh(tmp_path, urdf) == folder / "meshes" / "part.obj"


@pytest.mark.parametrize("inside", ["urdf", ".", "robots/urdf"])
def test_a_folder_of_the_packages_name_around_the_robots_file_is_the_package(tmp_path, inside):
    folder = looks(tmp_path / "looks", manifest=False)
    urdf = folder / inside / "bare.urdf"
    urdf.parent.mkdir(parents=True, exist_ok=True)
    urdf.write_text(URDF.replace(SHAPE, SHAPE + LOOK))
    assert mesh(tmp_path, urdf) == folder / "meshes" / "part.obj"


@pytest.mark.parametrize("file", ["bare.urdf", "bare.xacro"])
def test_a_package_that_is_nowhere_is_the_folder_around_the_robots_file_that_has_the_path(
    tmp_path, file
):
    folder = looks(tmp_path / "copied", manifest=False)
    robot = folder / "urdf" / "bare.urdf"
    robot.parent.mkdir()
    text = URDF.replace(SHAPE, SHAPE + LOOK)
    if file == "bare.xacro":
        (folder / "urdf" / "part.xacro").write_text(text)
        text = (
            '<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">'
            '<xacro:include filename="$(find looks)/urdf/part.xacro"/></robot>'
        )
        robot = robot.with_suffix(".xacro")
    robot.write_text(text)
    found = load_robot(RobotSpec.model_validate({robot.suffix[1:]: str(robot)}))
    _, seen = next(link for link in found.links if link.name == "upper").collisions
    assert seen.geometry.path == folder / "meshes" / "part.obj"
    assert f"the package 'looks' is not found: {folder} is read instead" in found.notes


@pytest.mark.parametrize(("folder", "is_its"), [("urdf", True), ("xacro", False)])
def test_a_folder_of_descriptions_that_has_not_the_robots_file_makes_no_package(
    tmp_path, folder, is_its
):
    (tmp_path / "xacro").mkdir()
    robot = tmp_path / "urdf" / "deeper" / "bare.xacro"
    if not is_its:
        robot = tmp_path / "elsewhere" / "bare.xacro"
    robot.parent.mkdir(parents=True)
    (tmp_path / folder / "part.xacro").write_text(URDF)
    robot.write_text(
        '<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">'
        f'<xacro:include filename="$(find looks)/{folder}/part.xacro"/></robot>'
    )
    spec = RobotSpec.model_validate({"xacro": str(robot)})
    if is_its:
        assert load_robot(spec).name
    else:
        with pytest.raises(SpecError, match="the package 'looks' is not found"):
            load_robot(spec)


def test_a_package_next_to_a_folder_around_the_robots_file_is_found(tmp_path):
    looks(tmp_path / "many" / "looks", manifest=False)
    urdf = tmp_path / "many" / "arm" / "urdf" / "bare.urdf"
    urdf.parent.mkdir(parents=True)
    urdf.write_text(URDF.replace(SHAPE, SHAPE + LOOK))
    assert mesh(tmp_path, urdf) == tmp_path / "many" / "looks" / "meshes" / "part.obj"


@pytest.mark.parametrize(
    ("place", "home"),
    [
        ("looks/a/b/c/d", "home"),
        ("looks/user/urdf", "looks/user"),
        ("looks/urdf", "looks"),
    ],
)
def test_a_folder_far_above_or_a_users_home_is_no_package(tmp_path, monkeypatch, place, home):
    looks(tmp_path / "looks", manifest=False)
    urdf = tmp_path / place / "bare.urdf"
    urdf.parent.mkdir(parents=True)
    urdf.write_text(URDF.replace(SHAPE, SHAPE + LOOK))
    monkeypatch.setenv("HOME", str(tmp_path / home))
    with pytest.raises(SpecError, match="the package 'looks' is not found"):
        mesh(tmp_path, urdf)


def test_an_installed_python_package_is_found(tmp_path):
    found = load_robot(RobotSpec(urdf="package://airo_models/arms/ur5e/ur5e.urdf"), tmp_path)
    assert found.groups["arm"].tip_link == "tool0"


def test_a_folder_is_given_with_set_on_the_command_line(tmp_path, capsys):
    urdf = arm(tmp_path / "arm")
    looks(tmp_path / "elsewhere" / "looks")
    scenario = tmp_path / "cell.scenario.yaml"
    scenario.write_text(
        f"scenario: Look\nrobot: {{urdf: {urdf}}}\n"
        "steps: [{move_to: {joints: {bend: 0.3}}}]\n"
    )
    assert main(["check", str(scenario)]) == 2
    assert "the package 'looks' is not found; give" in capsys.readouterr().out
    given = f"robot.packages=[{tmp_path / 'elsewhere'}]"
    assert main(["check", str(scenario), "--set", given]) == 0, capsys.readouterr().out


@pytest.mark.nightly(only=["run"])
@pytest.mark.parametrize("command", ["check", "explain", "run"])
def test_a_folder_is_given_as_an_option_of_commands_on_scenarios(
    tmp_path, monkeypatch, capsys, command
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HARNESS_PACKAGE_PATH", raising=False)
    urdf = arm(tmp_path / "arm")
    looks(tmp_path / "elsewhere" / "looks")
    steps = "steps: [{move_to: {joints: {bend: 0.3}}}]\nexpect: [{never: collision}]"
    scenario = tmp_path / "cell.scenario.yaml"
    scenario.write_text(f"scenario: Look\nrobot: {{urdf: {urdf}}}\n{steps}\n")
    words = [command, str(scenario), *(["--no-report"] if command == "run" else [])]
    assert main(words) == 2
    said = capsys.readouterr()
    assert "is not found; give the folder that holds it with --package-path" in said.out + said.err
    assert main([*words, "--package-path", "elsewhere"]) == 0, capsys.readouterr()
    assert "HARNESS_PACKAGE_PATH" not in os.environ


def test_a_folder_that_is_not_there_is_wrong_usage(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["check", "cell.scenario.yaml", "--package-path", str(tmp_path / "gone")])
    assert ended.value.code == 2
    assert "--package-path: there is no folder" in capsys.readouterr().err


def test_what_is_nowhere_is_reported_with_the_ways_out(tmp_path):
    urdf = arm(tmp_path / "arm")
    with pytest.raises(SpecError) as caught:
        mesh(tmp_path, urdf)
    problem = caught.value.problems[0]
    assert (problem.path, problem.line) == (str(urdf), 4)
    assert "the package 'looks' is not found; give the folder that holds it" in problem.message
    with pytest.raises(RobotError, match="there is no folder"):
        mesh(tmp_path, urdf, packages=["gone"])


def test_a_robot_named_by_its_package_reads_in_all_of_it(tmp_path):
    """Without a package.xml, as in a wheel."""
    name = "../meshes/part.obj"
    shape = f'<collision><geometry><mesh filename="{name}"/></geometry></collision>'
    for folder in ("wheel/urdf", "wheel/meshes"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "wheel/meshes/part.obj").write_text(TETRAHEDRON)
    (tmp_path / "wheel/urdf/arm.urdf").write_text(URDF.replace(SHAPE, SHAPE + shape, 1))
    with pytest.raises(SpecError, match="lies outside"):
        load_robot(RobotSpec(urdf="wheel/urdf/arm.urdf"), tmp_path)
    words = {"urdf": "package://wheel/urdf/arm.urdf", "packages": ["other"]}
    (tmp_path / "other").mkdir()
    (tmp_path / "other/wheel").symlink_to(tmp_path / "wheel")
    load_robot(RobotSpec.model_validate(words), tmp_path)


def test_a_link_out_of_the_packages_is_not_followed(tmp_path):
    urdf = arm(tmp_path / "src" / "arm")
    (tmp_path / "secret.obj").write_text(TETRAHEDRON)
    inside = package(tmp_path / "src" / "looks", "looks") / "meshes"
    inside.mkdir()
    (inside / "part.obj").symlink_to(tmp_path / "secret.obj")
    advice = f"if it may be read, give --package-path {tmp_path}, or add that folder"
    with pytest.raises(SpecError, match=re.escape(advice)):
        mesh(tmp_path, urdf)
    assert mesh(tmp_path, urdf, packages=[str(tmp_path)])


@pytest.mark.parametrize(
    "name",
    ["a" * 300 + ".stl", "package://x/" + "ä" * 140 + ".stl", "package://" + "b" * 256 + "/a.stl"],
)
def test_a_name_that_no_file_can_have_is_refused_at_its_place(tmp_path, name):
    (tmp_path / "arm.urdf").write_text(
        f'<robot name="a"><link name="b"><collision><geometry>\n<mesh filename="{name}"/>'
        "</geometry></collision></link></robot>",
        encoding="utf-8",
    )
    with pytest.raises(SpecError, match=r"is not there|not found") as caught:
        load_robot(RobotSpec.model_validate({"urdf": "arm.urdf"}), tmp_path)
    assert caught.value.problems[0].line == 2
