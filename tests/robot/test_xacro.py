"""xacro files of people: rendered without ROS, inside bounds, mistakes reported at their place."""

import pytest

from harness.core.errors import RobotError, SpecError
from tests.robot.arm_files import INERTIAL, load_arm, write_arm

HEAD = '<?xml version="1.0"?>\n<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">\n'
ARM = (
    HEAD
    + """  <xacro:arg name="length" default="0.2"/>
  <xacro:include filename="$(find parts)/limb.xacro"/>
  <link name="base_link">"""
    + INERTIAL
    + """</link>
  <xacro:limb name="upper" parent="base_link" length="$(arg length)"/>
  <xacro:limb name="lower" parent="upper" length="${2 * 0.1}"/>
</robot>
"""
)
LIMB = (
    HEAD
    + """  <xacro:macro name="limb" params="name parent length">
    <link name="${name}">"""
    + INERTIAL
    + """</link>
    <joint name="${name}_joint" type="revolute">
      <parent link="${parent}"/><child link="${name}"/>
      <origin xyz="0 0 ${length}"/><axis xyz="0 1 0"/>
      <limit lower="-2" upper="2" velocity="2" effort="30"/>
    </joint>
  </xacro:macro>
</robot>
"""
)


def write(folder, arm=ARM, limb=LIMB):
    write_arm(folder)
    (folder / "parts").mkdir()
    (folder / "parts" / "limb.xacro").write_text(limb, encoding="utf-8")
    (folder / "arm.xacro").write_text(arm, encoding="utf-8")


def load(folder, **options):
    words = {"urdf": None, "srdf": None, "xacro": "arm.xacro", "packages": ["."], **options}
    return load_arm(folder, **words)


def test_a_xacro_file_is_rendered_with_its_arguments(tmp_path):
    write(tmp_path)
    for args, height in (({}, 0.2), ({"length": 0.5}, 0.5)):
        arm = load(tmp_path, args=args)
        assert arm.joint_by_name["upper_joint"].pose.translation[2] == height


def test_a_mistake_of_a_macro_is_reported_in_the_file_that_has_it(tmp_path):
    write(tmp_path, limb=LIMB.replace('lower="-2"', 'lower="low"'))
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    problem = caught.value.problems[0]
    assert problem.path.endswith("parts/limb.xacro")
    assert (problem.line, problem.column) == (8, 21)
    assert "'low' is not a finite number" in problem.message


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("$(find parts)/limb", "arm", "arm.xacro", "files include each other in a circle"),
        ("$(find parts)/limb", "gone", "arm.xacro:4:", "there is no file"),
        ("$(find parts)", "$(find gone)", "arm.xacro:4:", "the package 'gone' is not found"),
        ("$(find parts)/limb.xacro", "/etc/passwd", "arm.xacro:4:", "outside the robot's folder"),
        ("xacro:limb name", "xacro:limp name", "arm.xacro:6:", "limp"),
        ("${2 * 0.1}", "${two * 0.1}", "arm.xacro:7:", "'two' is not defined"),
        ("${2 * 0.1}", "${xacro.load_yaml('/etc/hostname')}", "arm.xacro:7:", "outside"),
        ("${2 * 0.1}", "$(env HOME)", "arm.xacro:7:53", "HOME"),
        ("${2 * 0.1}", "$(arg widht)", "arm.xacro:7:53", "give it: --args widht=VALUE"),
        ("${2 * 0.1}", "${9**9**9**9}", "arm.xacro:7:56", "more than 4096 bits"),
        ("${2 * 0.1}", "${[0] * 10**10}", "arm.xacro:7:53", "more than 10000 items"),
        ("${2 * 0.1}", "${2 * (0.1}", "arm.xacro:7:57", "not an expression"),
        ("${2 * 0.1}", "${2 * 'a' / 2}", "arm.xacro:7:53", "unsupported operand type"),
        ("${2 * 0.1}", "${2", "arm.xacro:7:51", "does not end here"),
        ("</robot>", "</robt>", "arm.xacro:8:3", "not well-formed"),
        (' length="${2 * 0.1}"', "", "arm.xacro:7:4", "lacks its parameter 'length'"),
        (' parent="base_link"', "", "arm.xacro:6:4", "lacks its parameter 'parent'"),
        ('parent="upper"', 'parent="upper" wide="1"', "arm.xacro:7:49", "no parameter 'wide'"),
    ],
)
def test_what_cannot_be_rendered_is_refused_at_its_place(tmp_path, old, new, place, words):
    assert old in ARM
    write(tmp_path, ARM.replace(old, new))
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    assert place in str(caught.value)
    assert words in str(caught.value)
    assert "root:" not in str(caught.value), "nothing of a file outside is shown"


GAZEBO = "<gazebo><plugin><parameters>$(find gone)/a.yaml</parameters></plugin></gazebo></robot>"


def test_a_package_that_only_another_program_needs_may_be_missing(tmp_path):
    write(tmp_path, ARM.replace("</robot>", GAZEBO))
    assert "1 <gazebo> element ignored" in load(tmp_path).notes


@pytest.mark.parametrize("name", ["mesh.stl", "limb.xacro"])
def test_a_missing_package_is_reported_once_and_in_plain_words(tmp_path, name):
    use = f'<xacro:include filename="$(find gone)/{name}"/>'
    if name == "mesh.stl":
        mesh = f'<mesh filename="$(find gone)/{name}"/>'
        use = f'<link name="l"><visual><geometry>{mesh}</geometry></visual></link>'
    write(tmp_path, ARM.replace("</robot>", f"{use}</robot>"))
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    assert caught.value.problems[0].message == (
        "the package 'gone' is not found; give the folder that holds it with "
        "--package-path, in `packages` of `robot:` or in HARNESS_PACKAGE_PATH, or install it"
    )


def test_a_macro_without_an_end_is_refused(tmp_path):
    endless = '<xacro:limb name="a" parent="b" length="1"/></xacro:macro>'
    write(tmp_path, limb=LIMB.replace("</xacro:macro>", endless))
    with pytest.raises(SpecError, match="runs in a circle"):
        load(tmp_path)


def test_an_argument_that_the_file_does_not_take_is_reported(tmp_path):
    write(
        tmp_path,
        ARM.replace('<xacro:include filename="$(find parts)/limb.xacro"/>', LIMB[len(HEAD) : -9]),
    )
    with pytest.raises(RobotError, match="takes no argument 'lenght'"):
        load(tmp_path, args={"lenght": 1})


NAMED = '<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">'


@pytest.mark.parametrize(
    ("arm", "limb", "place"),
    [
        (ARM.replace(HEAD.splitlines()[1], NAMED), LIMB, "arm.xacro:2:16"),
        (ARM, LIMB.replace("${length}", "$(arg name)"), "limb.xacro:7:26"),
        (ARM.replace('"0.2"/>', '"$(arg name)"/>'), LIMB, "arm.xacro:3:39"),
    ],
)
def test_an_argument_without_a_value_says_how_to_give_it(tmp_path, arm, limb, place):
    write(tmp_path, arm, limb)
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    [problem] = caught.value.problems
    assert place in str(problem)
    assert problem.message == "the argument 'name' has no value here"
    assert problem.hint == "give it: --args name=VALUE, or `args: {name: VALUE}` in `robot:`"
    assert load(tmp_path, args={"name": "0.4"}).name
