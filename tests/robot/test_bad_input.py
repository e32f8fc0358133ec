"""Files that are broken, hostile or huge, as `harness check` reports them: place, exit code 2.

Each in bounded memory, and long before a hang. (SDF: tests/world/test_sdf_bad_input.py.)
"""

import re
import subprocess
import sys
import time

import pytest

from harness.cli.main import main
from tests.robot.arm_files import SHAPE, SRDF, URDF
from tests.robot.mjcf_arm import MJCF, TIP
from tests.waiting import HANG, MOST_WORK

MEMORY = 600e6
"""Bytes; the program itself takes about a third of them."""

XACRO = URDF.replace(
    '<robot name="three">', '<robot name="three" xmlns:xacro="http://www.ros.org/wiki/xacro">'
)
MESH = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
TOUCHED = MESH.replace("visual", "collision")
TWICE = "<include file='level{0}.xml'/><include file='level{0}.xml'/>"
FILES = {"arm.urdf": URDF, "arm.srdf": SRDF, "arm.xacro": XACRO, "arm.xml": MJCF}
ROBOTS = {
    "arm.urdf": "{urdf: arm.urdf, srdf: arm.srdf}",
    "arm.srdf": "{urdf: arm.urdf, srdf: arm.srdf}",
    "arm.xacro": "{xacro: arm.xacro, srdf: arm.srdf}",
    "arm.xml": "{mjcf: arm.xml}",
}
STEP = "move_to: {joints: {bend: 0.5}}"
BOMB = (
    "<!DOCTYPE b [<!ENTITY a 'aaaaaaaaaa'>"
    + "".join(f"<!ENTITY {chr(98 + n)} '{f'&{chr(97 + n)};' * 10}'>" for n in range(9))
    + "]>"
)


def write(folder, file, text):
    """A cell whose arm is described by good files, and one that is not."""
    (folder / "assets").mkdir()
    (folder / "assets" / "t.obj").write_text(TIP, encoding="utf-8")
    for name, good in (FILES | {file: text}).items():
        (folder / name).write_text(good, encoding="utf-8")
    step = STEP if file != "arm.xml" else STEP.replace("bend", "elbow")
    scenario = folder / "cell.scenario.yaml"
    scenario.write_text(
        f"scenario: Bad\nrobot: {ROBOTS[file]}\nsteps: [{{{step}}}]\n", encoding="utf-8"
    )
    return scenario


@pytest.mark.parametrize("file", FILES)
def test_the_files_are_fine_before_they_are_broken(tmp_path, file, capsys):
    assert main(["check", str(write(tmp_path, file, FILES[file]))]) == 0, capsys.readouterr().out


CASES = {
    "broken XML": [
        ("arm.urdf", "</robot>", "</robt>", "23:3: not well-formed XML: mismatched tag"),
        ("arm.srdf", "</robot>", "", "12:1: not well-formed XML: no element found"),
        ("arm.xacro", 'type="fixed">', "type=fixed>", "20:26: not well-formed XML"),
        ("arm.xml", "</mujoco>", "</mujocoo>", "37:3: not well-formed XML: mismatched tag"),
    ],
    "a state that is out of all measure": [
        ("arm.srdf", 'value="0.1"', 'value="1e308"', "5:31: 1e+308 is too large; at most 1e+09"),
        ("arm.srdf", 'value="0.7"', 'value="-1e300"', "6:31: -1e+300 is too large"),
        ("arm.srdf", 'value="0.05"', 'value="2e9"', "7:32: 2e+09 is too large"),
    ],
    "a missing mesh": [
        (
            "arm.urdf", SHAPE, SHAPE + TOUCHED.format("gone.stl"),
            "4:270: link 'upper': mesh 'gone.stl' is not there",
        ),
        (
            "arm.urdf", SHAPE, SHAPE + TOUCHED.format("package://gone/a.stl"),
            "4:270: link 'upper': mesh 'package://gone/a.stl': the package 'gone' is not found",
        ),
        (
            "arm.xacro", SHAPE, SHAPE + TOUCHED.format("gone.stl"),
            "4:270: link 'upper': mesh 'gone.stl' is not there",
        ),
        ("arm.xml", 'file="t.obj"', 'file="gone.obj"', "3:33: mesh 'gone.obj' is not there"),
    ],
    "an unknown joint": [
        (
            "arm.srdf", '<joint name="bend"', '<joint name="bond"',
            "6:18: state 'home' names the unknown joint 'bond'",
        ),
        (
            "arm.srdf", "<chain", '<joint name="bond"/><chain',
            "3:42: group 'manipulator': names the unknown joint 'bond'",
        ),
        (
            "arm.srdf", "<virtual_joint", '<passive_joint name="bond"/><virtual_joint',
            "9:24: passive_joint names the unknown joint 'bond'",
        ),
        (
            "arm.urdf", '<limit lower="0"', '<mimic joint="bond"/><limit lower="0"',
            "18:19: joint 'reach' mimics the unknown joint 'bond'",
        ),
        ("arm.xacro", '<limit lower="0"', '<mimic joint="bond"/><limit lower="0"', "18:19:"),
        ("arm.xml", 'joint2="slide"', 'joint2="slade"', "34:3: MuJoCo: unknown element 'slade'"),
        (
            "arm.xml", 'name="a1" joint="pan"', 'name="a1" joint="pun"',
            "30:5: MuJoCo: unknown transmission target 'pun'",
        ),
    ],
    "a circle": [
        (
            "arm.urdf", '<child link="upper"/>', '<child link="base_link"/>',
            "3:4: joints run in a circle: base_link - base_link",
        ),
        (
            "arm.urdf", '<link name="base_link">', '<link name="a"/><link name="base_link">',
            "3:20: a robot has one root link, found a, base_link",
        ),
        (
            "arm.xacro", '<parent link="base_link"/>', '<parent link="tool"/>',
            "5:4: joints run in a circle: lower - wrist - tool - upper - lower",
        ),
        (
            "arm.srdf", '<group name="manipulator">',
            '<group name="b"><group name="manipulator"/></group>'
            '<group name="manipulator"><group name="b"/>',
            "3:93: group 'manipulator': groups contain each other in a circle: ",
        ),
    ],
    "no mass": [
        (
            "arm.urdf", '<mass value="1"/>', '<mass value="-1"/>',
            "3:72: link 'base_link' weighs -1 kg",
        ),
        (
            "arm.xml", 'size="0.02 0.03 0.1"', 'size="0.02 0.03 0.1" mass="0"',
            "12:9: MuJoCo: mass and inertia of moving bodies must be larger than mjMINVAL: 'lower'",
        ),
    ],
    "an include of itself": [
        (
            "arm.xacro", "</robot>", '<xacro:include filename="arm.xacro"/></robot>',
            "23:26: files include each other in a circle: 'arm.xacro' includes",
        ),
        (
            "arm.xml", "<equality>", '<include file="arm.xml"/><equality>',
            "34:18: files include each other in a circle: arm.xml - arm.xml",
        ),
    ],
    "a bomb of entities": [
        ("arm.urdf", '<?xml version="1.0"?>', BOMB, "1:13: a DOCTYPE, and with it entities"),
        ("arm.srdf", '<?xml version="1.0"?>', BOMB, "1:13: a DOCTYPE, and with it entities"),
        ("arm.xacro", '<?xml version="1.0"?>', BOMB, "1:13: a DOCTYPE, and with it entities"),
        ("arm.xml", "<mujoco", BOMB + "<mujoco", "1:13: a DOCTYPE, and with it entities"),
    ],
    "a path outside": [
        (
            "arm.urdf", SHAPE, SHAPE + TOUCHED.format("/etc/passwd.stl"),
            "4:270: link 'upper': mesh '/etc/passwd.stl' lies outside",
        ),
        (
            "arm.urdf", SHAPE, SHAPE + TOUCHED.format("../../a.stl"),
            "4:270: link 'upper': mesh '../../a.stl' lies outside",
        ),
        (
            "arm.xacro", SHAPE, SHAPE + TOUCHED.format("/etc/passwd.stl"),
            "4:270: link 'upper': mesh '/etc/passwd.stl' lies outside",
        ),
        (
            "arm.xacro", "</robot>", '<xacro:include filename="/etc/passwd"/></robot>',
            "23:26: '/etc/passwd' lies outside",
        ),
        ("arm.xml", 'file="t.obj"', 'file="/etc/passwd"', "3:33: mesh '/etc/passwd' lies outside"),
        ("arm.xml", 'meshdir="assets"', 'meshdir="../.."', "3:33: mesh 't.obj' lies outside"),
        (
            "arm.xml", "<equality>", '<include file="/etc/passwd"/><equality>',
            "34:18: '/etc/passwd' lies outside",
        ),
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "file", "old", "new", "reported"),
    [(kind, *case) for kind, cases in CASES.items() for case in cases],
)
def test_a_bad_file_is_reported_at_its_place(tmp_path, capsys, kind, file, old, new, reported):
    assert old in FILES[file]
    scenario = write(tmp_path, file, FILES[file].replace(old, new))
    began = time.process_time()
    assert main(["check", str(scenario)]) == 2
    assert time.process_time() - began < MOST_WORK
    out = capsys.readouterr().out
    assert f"{tmp_path / file}:{reported}" in out.splitlines()[0], kind
    assert "^" in out or "not closed before" in out, "the place is shown"


@pytest.mark.parametrize("key", ["mass", "density"])
def test_a_moving_body_of_an_mjcf_without_mass_is_refused_with_what_to_write(tmp_path, capsys, key):
    """As the doors of cabinets whose masses a program sets after it has read the file."""
    weightless = FILES["arm.xml"].replace('size="0.02 0.03 0.1"', f'size="0.02 0.03 0.1" {key}="0"')
    assert main(["check", str(write(tmp_path, "arm.xml", weightless))]) == 2
    out = " ".join(capsys.readouterr().out.replace("|", "").split())
    assert "give its geoms a `mass` or a `density` above 0, or the body an `inertial`" in out


@pytest.mark.parametrize(
    ("old", "new", "reported"),
    [
        ("<equality>", "<worldbody><replicate count='1000'><replicate count='2'>"
         "<geom size='1'/></replicate></replicate></worldbody><equality>", "more than 1000 copies"),
        ("</asset>", "<hfield name='h' size='1 1 1 1' nrow='90000' ncol='2'/></asset>", "nrow"),
        ("</asset>", "<texture type='2d' width='90000' height='9'/></asset>", "width"),
        ("</asset>", "<mesh name='s' builtin='supersphere' params='1e5 1 1'/></asset>", "params"),
        ("</asset>", "<model name='m' file='arm.xml'/></asset>", "other files are not attached"),
        ("<compiler", "<size nkey='1e9'/><compiler", "nkey above 1000"),
        ("<equality>", "<worldbody><flexcomp name='f'/></worldbody><equality>", "deformable"),
        ("<equality>", f"<a {' '.join(f'b{n}=' + repr('1') for n in range(300))}/><equality>",
         "has more than 200 attributes"),
    ],
)  # fmt: skip
def test_an_mjcf_that_needs_endless_memory_is_refused_before_it_is_compiled(
    tmp_path, capsys, old, new, reported
):
    assert main(["check", str(write(tmp_path, "arm.xml", MJCF.replace(old, new)))]) == 2
    assert reported in capsys.readouterr().out.splitlines()[0]


def test_mjcf_files_that_include_others_twice_each_end_at_a_number(tmp_path, capsys):
    scenario = write(
        tmp_path, "arm.xml", MJCF.replace("<equality>", TWICE.format(0) + "<equality>")
    )
    for level in range(18):
        text = f"<mujoco>{TWICE.format(level + 1)}</mujoco>"
        (tmp_path / f"level{level}.xml").write_text(text, encoding="utf-8")
    (tmp_path / "level18.xml").write_text("<mujoco/>", encoding="utf-8")
    assert main(["check", str(scenario)]) == 2
    assert "more than 200 files are included" in capsys.readouterr().out


CHECK = """
import re, sys
from pathlib import Path
from harness.cli.main import main
code = main(["check", sys.argv[1]])
print("peak", re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
sys.exit(code)
"""


def checked(scenario):
    """What `harness check` says in a process of its own, and that one's largest memory [bytes]."""
    done = subprocess.run(
        [sys.executable, "-c", CHECK, str(scenario)],
        capture_output=True, text=True, timeout=HANG, check=False,
    )  # fmt: skip
    assert done.returncode == 2, done.stdout + done.stderr
    return done.stdout, 1000 * int(done.stdout.rpartition("peak ")[2])


@pytest.mark.nightly
@pytest.mark.parametrize("file", [*FILES, "assets/t.obj"])
def test_a_file_of_a_hundred_megabytes_is_refused_in_little_memory(tmp_path, file):
    scenario = write(tmp_path, file if file in FILES else "arm.xml", FILES.get(file, MJCF))
    with (tmp_path / file).open("r+b") as written:
        written.truncate(100_000_000)
    out, peak = checked(scenario)
    first = out.splitlines()[0]
    assert "100 MB" in first
    assert str(tmp_path / ("arm.xml:3:33" if file not in FILES else file)) in first
    assert peak < MEMORY


@pytest.mark.nightly
@pytest.mark.parametrize("file", FILES)
def test_a_bomb_takes_little_memory(tmp_path, file):
    out, peak = checked(write(tmp_path, file, BOMB + FILES[file].partition("?>")[2]))
    assert "a DOCTYPE" in out.splitlines()[0]
    assert peak < MEMORY


GONE = TOUCHED.format("gone.stl") + TOUCHED.format("package://three/lost.stl")


def test_all_missing_meshes_are_reported_together(tmp_path, capsys):
    urdf = FILES["arm.urdf"].replace(SHAPE, SHAPE + GONE)
    assert main(["check", str(write(tmp_path, "arm.urdf", urdf))]) == 2
    said = capsys.readouterr().out
    assert said.count("'gone.stl' is not there") == urdf.count("gone.stl") == 3
    assert said.count("package 'three' is not found") == 3


def test_all_missing_meshes_of_an_mjcf_are_reported_together(tmp_path, capsys):
    mesh = '<mesh name="tip" file="gone.obj"/><mesh name="lost" file="lost.obj"/>'
    mjcf = re.sub(r"<mesh [^>]*/>", mesh, FILES["arm.xml"], count=1)
    mjcf = mjcf.replace("<geom", '<geom type="mesh" mesh="lost"/><geom', 1)
    assert main(["check", str(write(tmp_path, "arm.xml", mjcf))]) == 2
    said = capsys.readouterr().out
    assert "'gone.obj' is not there" in said
    assert "'lost.obj' is not there" in said


SUBSTITUTED = FILES["arm.urdf"].replace(SHAPE, SHAPE + TOUCHED.format("$(find gone)/a.stl"))


def test_a_urdf_with_substitutions_is_a_xacro_file(tmp_path, capsys):
    assert main(["check", str(write(tmp_path, "arm.urdf", SUBSTITUTED))]) == 2
    said = capsys.readouterr().out
    assert "`$(find gone)` is xacro, and this is read as a URDF" in said
    assert "name the file with `xacro`, not with `urdf`" in said
    assert main(["robot", "check", str(tmp_path / "arm.urdf")]) == 2
    assert "the package 'gone' is not found" in capsys.readouterr().err
